"""Placement of supports on the mesh, and footprints of their points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from signorini.discretise.places import edge_sides, located, mesh_edges, points_in_holes
from signorini.discretise.quadrature import GAUSS, LineQuadrature, Quadrature, area_quadrature, off_plate
from signorini.discretise.rows import Floats, Ints, Rows, interpolated
from signorini.errors import InputError, Place, Problems, point
from signorini.mesh import Mesh
from signorini.model import Model, Support
from signorini.model.where import Acting
from signorini.shapes import Circle, Whole
from signorini.shapes.boxes import BoxTree
from signorini.shapes.regions import inside as within
from signorini.shapes.regions import overlap

_LEAST = 1e-9
"""Least size of a footprint relative to the plate's size; smaller footprints are lost in the rounding of coordinates.
"""
_HOLE_SLACK = 1e-3
"""Relative tolerance for the area of a hole, whose curved edges the mesh approximates."""
_OFF_MIDDLE = 0.01
"""Largest distance of a footprint's middle from its point, relative to the square root of the footprint's area."""
_PARALLEL = 1e-9
"""Sine of the largest angle between directions that count as parallel."""


class Footprints:
    """Footprints on a mesh; ``supports`` define the edges of symmetry.

    A footprint may lie half outside an edge of symmetry through its middle; only the part on the plate counts. Holes of
    the plate are not part of a footprint: a washer over a hole is an annulus.
    """

    def __init__(self, mesh: Mesh, supports: Sequence[Support]) -> None:
        self._mesh = mesh
        self._supports = supports

    def of(self, item: Acting, place: Place) -> list[Quadrature]:
        """Quadrature over the footprint of each point of a support or load; empty if the points have no footprints."""
        points, shapes = item.where.points, item.where.footprints
        if not shapes:
            return []
        mesh, (across, _) = self._mesh, item.width
        if across < _LEAST * mesh.size:
            key = "patch" if item.radius is None else "radius"
            raise InputError(
                f"The footprint is {across:g} across, less than a billionth of the plate's size. Give a larger "
                f"footprint, or a point without {key}.",
                place=(*place, key),
            )
        result, problems = [], Problems()
        with problems.collected():
            located(mesh, points, (*place, "at"), in_holes=True)
        for index in np.flatnonzero(
            mesh.locate(np.array(points)).inside | points_in_holes(mesh, np.array(points))
        ).tolist():
            centre, shape = points[index], shapes[index]
            result.append(area_quadrature(mesh, shape, GAUSS))
            with problems.collected():
                self._require_on_plate(centre, shape, result[-1], (*place, "at", *([index] if len(points) > 1 else [])))
        problems.raise_collected()
        return result

    def _require_on_plate(
        self, centre: tuple[float, float], shape: Whole, quadrature: Quadrature, place: Place
    ) -> None:
        """Refuse a footprint beyond the plate; only holes inside it, and the hole around its point, may be covered."""
        mesh, subject = self._mesh, f"The footprint of the point {point(centre, self._mesh.size)}"
        if quadrature.total == 0.0:
            advice = "Make the footprint larger than the hole, or move the point."
            raise InputError(f"{subject} lies in a hole. {advice}", place=place)
        hollow, part = self._hollow(centre, shape), self._on_plate(centre, shape)
        missing = off_plate(mesh, shape, quadrature, part)
        if missing > (1.0 + _HOLE_SLACK) * part * hollow:
            raise InputError(
                f"{subject} has {100 * (missing - part * hollow) / shape.area:.3g} % of its area off the plate. Move "
                "the point or make the footprint smaller. A footprint may contain a hole, and an edge of symmetry may "
                "cut its middle.",
                place=place,
            )
        middle = quadrature.centroid
        if hollow and part == 1.0 and math.dist(middle, centre) > _OFF_MIDDLE * math.sqrt(shape.area):
            raise InputError(
                f"{subject} without the holes in it has its middle at {point(middle, mesh.size)}, not at the point. "
                "Put the point into the middle of the hole, or move the footprint off the hole.",
                place=place,
            )

    def _hollow(self, centre: tuple[float, float], shape: Whole) -> float:
        """Area of a footprint over holes of the plate: over holes inside it, and over the hole around its point."""
        (around,), result = shape.loops, 0.0
        for hole in self._mesh.holes:
            if (hole.min(axis=0) > around.max(axis=0)).any() or (hole.max(axis=0) < around.min(axis=0)).any():
                continue
            common, size = overlap(around, hole), overlap(hole, hole)
            if common >= (1.0 - _HOLE_SLACK) * size or within(np.array([centre]), hole)[0]:
                result += common
        return result

    def _on_plate(self, centre: tuple[float, float], shape: Whole) -> float:
        """Fraction of a footprint that must be on the plate: 1, or less if edges of symmetry cut its middle."""
        begin, direction = self._axes[:, 0], self._axes[:, 1] - self._axes[:, 0]
        length = np.hypot(*direction.T)
        normals = np.column_stack([-direction[:, 1], direction[:, 0]]) / length[:, None]
        off, along = (
            np.abs(((centre - begin) * normals).sum(axis=1)),
            ((centre - begin) * direction).sum(axis=1) / length,
        )
        slack = self._mesh.near.place
        through = np.unique(normals[(off <= slack) & (along >= -slack) & (along <= length + slack)].round(9), axis=0)
        if not isinstance(shape, Circle):
            side = shape.corners[1] - shape.corners[0]
            sines = np.stack([through @ side, through @ [-side[1], side[0]]]) / np.hypot(*side)
            if (np.abs(sines) > _PARALLEL).all(axis=0).any():
                return 1.0
        if len(through) == 2:
            return math.acos(float(np.clip(-through[0] @ through[1], -1.0, 1.0))) / (2 * math.pi)
        return 0.5 if len(through) == 1 else 1.0

    @cached_property
    def _axes(self) -> Floats:
        """Ends (k, 2, 2) of the element sides along edges of symmetry, with the plate on the left of each side."""
        triples = [np.zeros((0, 3), np.int64)]
        for index, support in enumerate(self._supports):
            if support.edge is not None and "slope" in support.fixed and "w" not in support.fixed:
                triples.append(edge_sides(self._mesh, support.edge, ("support", index)))
        return np.asarray(self._mesh.points[np.concatenate(triples)[:, [0, 2]]])


def means_over(mesh: Mesh, frames: Floats | None, footprints: Sequence[Quadrature], field: int = 0) -> Rows:
    """Rows of the mean of w, θx or θy (``field`` 0, 1, 2) over each footprint.

    The transpose of a row spreads a force evenly over the footprint.
    """
    points, owners = (
        Quadrature.join(footprints),
        np.repeat(np.arange(len(footprints)), [len(footprint) for footprint in footprints]),
    )
    parts = points.weights / np.repeat(
        [footprint.total for footprint in footprints], [len(footprint) for footprint in footprints]
    )
    rows = interpolated(mesh, frames, points.elements, points.xi, field)
    return Rows.summed(owners, points.elements, parts[:, None] * rows.coefficients, mesh.elements)


@dataclass(frozen=True, eq=False)
class Placed:
    """A support on the mesh; ``place`` is the path of the support in the model.

    ``nodes`` (q,) are the nodes at its ``points``, −1 for a point between nodes or with a footprint. ``sides`` (k, 3)
    are element sides along its edge, line or circle; None if the mesh does not follow the line. ``footprints`` is the
    quadrature over each point's footprint.
    """

    place: Place
    support: Support
    points: LineQuadrature | None
    nodes: Ints
    sides: Ints | None
    footprints: list[Quadrature]

    @property
    def index(self) -> int:
        """Index of the support in the model."""
        return int(self.place[1])


def placed(model: Model, mesh: Mesh, problems: Problems) -> list[Placed]:
    """Place every support of the plate on the mesh, also supports to other plates; ``problems`` collects errors."""
    result = []
    on_mesh = Footprints(mesh, model.support)
    taken, both = np.zeros((0, 2)), np.zeros(0, np.bool_)
    for index, support in enumerate(model.support):
        place = ("support", index)
        with problems.collected():
            points, nodes = None, np.zeros(0, np.int64)
            footprints = on_mesh.of(support, place)
            if support.at is not None:
                points = located(mesh, support.at, (*place, "at"), in_holes=support.has_footprint)
                nodes = np.full(len(support.at), -1)
            if points is not None and not footprints and support.between is None:
                holds = support.direction == "both"
                points, nodes = _at_one_place(mesh, points, taken if holds else taken[both])
                taken = np.concatenate([taken, points.positions])
                both = np.append(both, np.full(len(points.positions), holds))
            result.append(
                Placed(place, support, points, nodes, mesh_edges(mesh, model.plate, support.where, place), footprints)
            )
    return result


def _at_one_place(mesh: Mesh, sampled: LineQuadrature, taken: Floats) -> tuple[LineQuadrature, Ints]:
    """Move points within tolerance of a node, or of a point in ``taken`` (k, 2), exactly onto it.

    Return the points and their nodes, −1 for points between nodes. Two-sided points at one place then have equal rows;
    rows that are only nearly equal would count as independent. One-sided points are not moved onto each other.
    """
    nodes = mesh.nodes_at(sampled.positions)
    positions = np.where((nodes >= 0)[:, None], mesh.points[nodes], sampled.positions)
    if len(taken):
        reach = mesh.near.place * np.array([-1.0, -1.0, 1.0, 1.0])
        indices, others = BoxTree(np.tile(taken, 2) + reach).pairs(positions)
        # In reverse order, the first of several points in ``taken`` within tolerance is assigned last, and remains.
        for point, other in sorted(zip(indices.tolist(), others.tolist(), strict=True), reverse=True):
            positions[point] = positions[point] if nodes[point] >= 0 else taken[other]
    if (positions == sampled.positions).all():
        return sampled, nodes
    where = mesh.locate(positions)
    return replace(sampled, elements=where.elements, xi=where.xi), nodes
