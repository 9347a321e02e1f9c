"""Where every support is on the mesh, found once; and the footprints of points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from signorini.discretise.places import edge_sides, located, mesh_edges, points_in_holes
from signorini.discretise.quadrature import LineQuadrature, Quadrature, area_quadrature, off_plate
from signorini.discretise.rows import Floats, Ints, Rows, interpolated
from signorini.errors import InputError, Place, Problems, point
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import BoxTree
from signorini.model import Model, Support
from signorini.model.where import Acting
from signorini.shapes import Circle, Whole
from signorini.shapes.outlines import closed
from signorini.shapes.regions import inside as within
from signorini.shapes.regions import overlap

_GAUSS = 3
_LEAST = 1e-9
"""Size of a footprint, over the plate's, below which its coordinates have not the digits to tell it from a point."""
_HOLE_SLACK = 1e-3
"""Relative tolerance for the area of a hole in the mesh."""
_OFF_MIDDLE = 0.01
"""Largest distance of a footprint's middle from its point, relative to its width; its force then acts at the point."""
_PARALLEL = 1e-9
"""Sine of the angle up to which directions are one."""


class Footprints:
    """Footprints on a mesh; of all supports those on edges say where edges of symmetry are.

    A footprint that an edge of symmetry cuts through its middle counts as far as it is on the plate: there the plate
    stands for two or four of them. Holes in it are no part of it: a washer is an annulus.
    """

    def __init__(self, mesh: Mesh, supports: Sequence[Support]) -> None:
        self._mesh = mesh
        self._supports = supports

    def of(self, item: Acting, place: Place) -> list[Quadrature]:
        """Quadrature over the footprint of every point, all on the plate; none where points are points."""
        points, shapes = item.where.points, item.where.footprints
        if not shapes:
            return []
        mesh, (across, _) = self._mesh, item.width
        if across < _LEAST * mesh.size:
            key = "patch" if item.radius is None else "radius"
            raise InputError(
                f"The footprint is {across:g} across, less than a billionth of the plate's size. Leave {key} out for a "
                "point, or give a larger one.",
                place=(*place, key),
            )
        result, problems = [], Problems()
        with problems.collected():
            located(mesh, points, (*place, "at"), in_holes=True)
        for index in np.flatnonzero(
            mesh.locate(np.array(points)).inside | points_in_holes(mesh, np.array(points))
        ).tolist():
            at, shape = points[index], shapes[index]
            result.append(area_quadrature(mesh, shape, _GAUSS))
            with problems.collected():
                self._require_on_plate(at, shape, result[-1], (*place, "at", *([index] if len(points) > 1 else [])))
        problems.raise_collected()
        return result

    def _require_on_plate(self, at: tuple[float, float], shape: Whole, over: Quadrature, place: Place) -> None:
        """Refuse a footprint beyond the plate; it may cover the hole that its point is in, and holes within it."""
        mesh, said = self._mesh, f"The footprint of the point {point(at, self._mesh.size)}"
        if over.total == 0.0:
            raise InputError(f"{said} lies in a hole. Make it larger than the hole, or move the point.", place=place)
        hollow, part = self._hollow(at, shape), self._on_plate(at, shape)
        missing = off_plate(mesh, shape, over, part)
        if missing > (1.0 + _HOLE_SLACK) * part * hollow:
            raise InputError(
                f"{said} has {100 * (missing - part * hollow) / shape.area:.3g} % of its area off the plate. Move the "
                "point or make the footprint smaller. A hole may be within it, and an edge of symmetry may cut it "
                "through its middle.",
                place=place,
            )
        middle = over.weights @ over.positions / over.total
        if hollow and part == 1.0 and math.dist(middle, at) > _OFF_MIDDLE * math.sqrt(shape.area):
            raise InputError(
                f"{said} has its middle at {point(middle, mesh.size)}, without the holes in it. Put the point into the "
                "middle of the hole, or move the footprint off the hole.",
                place=place,
            )

    def _hollow(self, at: tuple[float, float], shape: Whole) -> float:
        """Area of a footprint over holes of the plate that are within it, and over the one that its point is in."""
        (around,), result = shape.loops, 0.0
        for hole in self._mesh.holes:
            if (hole.min(axis=0) > around.max(axis=0)).any() or (hole.max(axis=0) < around.min(axis=0)).any():
                continue
            common, size = overlap(around, hole), overlap(hole, hole)
            if common >= (1.0 - _HOLE_SLACK) * size or within(np.array([at]), closed(hole.tolist()))[0]:
                result += common
        return result

    def _on_plate(self, at: tuple[float, float], shape: Whole) -> float:
        """Part of a footprint that has to be on the plate: all, unless edges of symmetry cut it through its middle."""
        begin, ahead = self._axes[:, 0], self._axes[:, 1] - self._axes[:, 0]
        length = np.hypot(*ahead.T)
        normals = np.column_stack([-ahead[:, 1], ahead[:, 0]]) / length[:, None]
        off, along = np.abs(((at - begin) * normals).sum(axis=1)), ((at - begin) * ahead).sum(axis=1) / length
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
        """Ends (k, 2, 2) of the sides of elements along edges of symmetry, the plate on their left."""
        triples = [np.zeros((0, 3), np.int64)]
        for index, support in enumerate(self._supports):
            if support.edge is not None and "slope" in support.fixed and "w" not in support.fixed:
                triples.append(edge_sides(self._mesh, support.edge, ("support", index)))
        return np.asarray(self._mesh.points[np.concatenate(triples)[:, [0, 2]]])


def means_over(mesh: Mesh, frames: Floats | None, footprints: Sequence[Quadrature], field: int = 0) -> Rows:
    """Rows of the mean of w, θx or θy (field 0, 1, 2) over each footprint, which spread a force or couple evenly."""
    over, owners = Quadrature.join(footprints), np.repeat(np.arange(len(footprints)), [len(one) for one in footprints])
    parts = over.weights / np.repeat([one.total for one in footprints], [len(one) for one in footprints])
    rows = interpolated(mesh, frames, over.elements, over.xi, field)
    return Rows.over(owners, over.elements, parts[:, None] * rows.coefficients, mesh.elements)


@dataclass(frozen=True, eq=False)
class Placed:
    """A support, at a place of the model, on the mesh.

    ``nodes`` (q,) are those that its ``points`` coincide with, −1 where there is none; ``sides`` (k, 3) those of
    elements along its edge, line or circle, if the mesh follows it; ``footprints`` what each of its points is spread
    over, if it is: such points coincide with no node.
    """

    place: Place
    support: Support
    points: LineQuadrature | None
    nodes: Ints
    sides: Ints | None
    footprints: list[Quadrature]

    @property
    def index(self) -> int:
        """Which support of the model it is."""
        return int(self.place[1])


def placed(model: Model, mesh: Mesh, problems: Problems) -> list[Placed]:
    """Place every support on the plate, including those between it and other plates; collect misplaced ones."""
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
                holds = support.fix is not None or support.resists in (None, "both")
                points, nodes = _at_one_place(mesh, points, taken if holds else taken[both])
                taken = np.concatenate([taken, points.positions])
                both = np.append(both, np.full(len(points.positions), holds))
            result.append(
                Placed(place, support, points, nodes, mesh_edges(mesh, model.plate, support.where, place), footprints)
            )
    return result


def _at_one_place(mesh: Mesh, sampled: LineQuadrature, taken: Floats) -> tuple[LineQuadrature, Ints]:
    """Put points that are all but at a node, or at a point (k, 2) that is taken, at just that; return the nodes too.

    Where one of two points holds both ways, what they say of the plate is then the same, and not nearly the same, which
    rounding would take for two things. Of two that only press one may always let go.
    """
    nodes = mesh.nodes_at(sampled.positions)
    positions = np.where((nodes >= 0)[:, None], mesh.points[nodes], sampled.positions)
    if len(taken):
        reach = mesh.near.place * np.array([-1.0, -1.0, 1.0, 1.0])
        mine, others = BoxTree.build(np.tile(taken, 2) + reach).pairs(positions)
        # Of several the first, which others are at too.
        for point, other in sorted(zip(mine.tolist(), others.tolist(), strict=True), reverse=True):
            positions[point] = positions[point] if nodes[point] >= 0 else taken[other]
    if (positions == sampled.positions).all():
        return sampled, nodes
    where = mesh.locate(positions)
    return replace(sampled, elements=where.elements, xi=where.xi), nodes
