"""Where supports and loads act: from the words of the model to points of the mesh."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from signorini.discretise.quadrature import (
    LineQuadrature,
    Quadrature,
    area_quadrature,
    curve_quadrature,
    edge_quadrature,
    off_plate,
)
from signorini.discretise.quadrature.stepped import OFF, Levels
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import InputError, Place, length, point, unknown
from signorini.mesh import Mesh
from signorini.model import AnnulusPlate, Area, DiscPlate, Load, Plate, Support
from signorini.model.places import curve
from signorini.shapes import Circle, Curve, Hollow, Polyline, Region, Ring
from signorini.shapes.distances import distances
from signorini.shapes.regions import overlap

_SECTOR_SLACK = 1e-3
"""Part of a circle that a sector's outline, made of parabolas, may leave out; and of a hole that its own may."""


@dataclass(frozen=True, eq=False)
class Sampled:
    """Points (q, 2) of the plate with their elements, reference points, weights (1, length or area) and tangents.

    ``within`` (q, 2) is where formulas that jump are evaluated: at the point, or beside it in what it stands for.
    """

    elements: Ints
    xi: Floats
    weights: Floats
    positions: Floats
    tangents: Floats
    within: Floats


def region(area: Area | str | None) -> Region | None:
    """The region of the plane that an area names; None for the whole plate."""
    return area.region if isinstance(area, Area) else None


def located(mesh: Mesh, at: tuple[tuple[float, float], ...], place: Place) -> Sampled:
    """Points given by their coordinates.

    Raises
    ------
    InputError
        If a point is not on the plate.
    """
    positions = np.array(at, dtype=np.float64)
    where = mesh.locate(positions)
    if not where.inside.all():
        (left, bottom), (right, top) = (
            [length(part, mesh.size) for part in corner]
            for corner in (mesh.points.min(axis=0), mesh.points.max(axis=0))
        )
        off = np.flatnonzero(~where.inside).tolist()
        lowest, highest = mesh.points.min(axis=0), mesh.points.max(axis=0)
        among = ((positions >= lowest) & (positions <= highest)).all(axis=1)
        within = f"which lies within x = {left} to {right}, y = {bottom} to {top}"
        hole = "but in a hole or beyond an edge of it"
        raise InputError.of(
            [
                InputError(
                    f"The point {point(at[i])} is not on the plate, "
                    f"{hole if among[i] else within}. Move the point onto the plate.",
                    place=(*place, i) if len(at) > 1 else place,
                )
                for i in off
            ]
        )
    # A point of a circle is all but on the curved side that stands for it.
    xi = mesh.onto_curved_sides(where, mesh.near.written)
    return Sampled(where.elements, xi, np.ones(len(positions)), positions, np.zeros_like(positions), positions)


def edge_sides(mesh: Mesh, names: tuple[str, ...], place: Place) -> Ints:
    """Sides of elements (k, 3) that make up edges.

    Raises
    ------
    InputError
        If the mesh has no edge of that name.
    """
    problems = [
        InputError(unknown("edge", name, mesh.edges, "This mesh"), place=(*place, "edge", position))
        for position, name in enumerate(names)
        if name not in mesh.edges
    ]
    if problems:
        raise InputError.of(problems)
    return np.concatenate([mesh.edges[name] for name in names])


def mesh_edges(mesh: Mesh, plate: Plate, item: Support | Load, place: Place) -> Ints | None:
    """Sides of elements (k, 3) that make up the item's edge, line or circle; None if the mesh does not follow it.

    Raises
    ------
    InputError
        If the mesh has no edge of that name, or the circle leaves the plate.
    """
    if item.edge is not None:
        return edge_sides(mesh, item.edge, place)
    along = curve(item)
    sides = None if along is None else mesh.edges_along(along)
    if sides is not None and sides[0, 0] != sides[-1, 2] and isinstance(along, Ring):
        on_plate = curve_quadrature(mesh, along, order=1)
        _require_on_plate(mesh, plate, along, on_plate, "The circle", (*place, "circle"))
    return sides


def sides_beside(mesh: Mesh, item: Support | Load, followed: Ints | None) -> Ints:
    """Sides (k, 3) that the item's line or circle parts: all of those that follow it, else those it covers by half.

    A line that ends a little beside a node is not followed, but parts the sides that it covers all the same.
    """
    if followed is not None:
        return followed
    along = curve(item)
    return np.zeros((0, 3), np.int64) if along is None else mesh.sides_on(along)


def along_curve(
    mesh: Mesh,
    plate: Plate,
    item: Support | Load,
    place: Place,
    sides: Ints | None,
    order: int,
    at_ends: int = 0,
    levels: Levels = (),
) -> Sampled:
    """Gauss points of the item's edge, line or circle, divided where levels change sign; weights are lengths.

    ``sides`` are those of `mesh_edges`.

    If ``at_ends`` is not 0, so many points of Lobatto's rule on pieces at ends and corners.

    Raises
    ------
    InputError
        If the curve leaves the plate.
    """
    if sides is not None:
        return _sampled(edge_quadrature(mesh, sides, order, at_ends > 0, levels))
    along = curve(item)
    assert along is not None  # an item on a curve has an edge, a line or a circle
    points = curve_quadrature(mesh, along, order, at_ends, levels)
    key = "line" if item.line is not None else "circle"
    _require_on_plate(mesh, plate, along, points, f"The {key}", (*place, key))
    return _sampled(points)


def in_area(
    mesh: Mesh,
    plate: Plate,
    area: Area | str | None,
    place: Place,
    order: int,
    to_outline: Bools | None = None,
    levels: Levels = (),
    off: float = OFF,
    follow: bool = False,
) -> Quadrature:
    """Quadrature of an area, whose elements are cut where levels change sign; weights are areas.

    Elements (ne,) marked have points on its outline. Arcs that the mesh follows may be the sides that stand for them.

    Raises
    ------
    InputError
        If the area leaves the plate.
    """
    wanted = region(area)
    points = area_quadrature(mesh, wanted, order, to_outline, levels, off, follow)
    if wanted is not None:
        _require_on_plate(mesh, plate, wanted, points, "The area", (*place, "area"))
    return points


def _require_on_plate(
    mesh: Mesh, plate: Plate, shape: Region | Curve, points: Quadrature, what: str, place: Place
) -> None:
    """Refuse what leaves the plate, but for areas over its holes, of which the inside of an annulus is one.

    A sector stands for the whole plate and cuts circles about its center.
    """
    if points.total == 0:
        raise InputError(f"{what} is not on the plate. Move it onto the plate.", place=place)
    whole = shape.length if isinstance(shape, Polyline | Ring) else shape.area
    missing = off_plate(mesh, shape, points)
    beyond = slack = 0.0
    match plate, shape:
        case ((DiscPlate() | AnnulusPlate()), (Circle() | Ring())) if shape.center == plate.center:
            beyond, slack = (1.0 - plate.sector / 360.0) * whole, _SECTOR_SLACK * whole
            if isinstance(plate, AnnulusPlate) and isinstance(shape, Circle) and plate.sector < 360:
                beyond += 0.5 * math.radians(plate.sector) * min(plate.inner, shape.radius) ** 2
        case ((DiscPlate() | AnnulusPlate()), Hollow(around=Circle(), holes=(Circle(),))) if (
            len(shape.radii(plate.center)) == 2
        ):
            beyond, slack = (1.0 - plate.sector / 360.0) * whole, _SECTOR_SLACK * whole
    if missing > 0 and not isinstance(shape, Polyline | Ring):
        around, *holes = shape.loops
        over = sum(overlap(around, one) - sum(overlap(hole, one) for hole in holes) for one in mesh.holes)
        beyond, slack = beyond + over, slack + _SECTOR_SLACK * over
    missing = missing - beyond if missing > beyond + slack else 0.0
    if missing > 0:
        off = f"has {100 * missing / whole:.3g} % of its size off the plate{_how_far(mesh, shape)}"
        raise InputError(f"{what} {off}. Cut it to the plate.", place=place)


def _how_far(mesh: Mesh, shape: Region | Curve) -> str:
    """Say which corner of an outline is farthest off the plate, and how far."""
    corners = shape.outline.segments.reshape(-1, 2) if isinstance(shape, Polyline | Ring) else shape.loops[0]
    corners = corners[~mesh.locate(corners).inside]
    if not len(corners):
        return ""
    sides = mesh.points[np.concatenate([mesh.boundary[:, :2], mesh.boundary[:, 1:]])]
    begin, end = sides.transpose(1, 0, 2)
    far = distances(corners, begin, end).min(axis=1)
    return f", up to {far.max():.3g} beyond it at {point(corners[far.argmax()], mesh.size)}"


def _sampled(points: LineQuadrature) -> Sampled:
    return Sampled(points.elements, points.xi, points.weights, points.positions, points.tangents, points.within)


@dataclass(frozen=True, eq=False)
class OnNodes:
    """Nodes (q,) of mesh edges and the lengths (q,) they stand for."""

    nodes: Ints
    weights: Floats


def edge_nodes(mesh: Mesh, triples: Ints) -> OnNodes:
    """Every node of mesh edges once; its length is the integral of its quadratic shape function along them."""
    a, m, b = (mesh.points[triples[:, i]] for i in range(3))
    root = np.sqrt(0.6)
    length = np.zeros((len(triples), 3))
    for s, weight in ((-root, 5 / 9), (0.0, 8 / 9), (root, 5 / 9)):
        shape = np.array([0.5 * s * (s - 1), 1 - s * s, 0.5 * s * (s + 1)])
        slope = (s - 0.5) * a - 2 * s * m + (s + 0.5) * b
        length += weight * np.hypot(slope[:, 0], slope[:, 1])[:, None] * shape
    nodes, inverse = np.unique(triples, return_inverse=True)
    return OnNodes(nodes, np.bincount(inverse.ravel(), length.ravel()).astype(np.float64))


def quadratic_tangents(mesh: Mesh, triples: Ints) -> Floats:
    """Unit tangents (k, 3, 2) of mesh edges at their three nodes."""
    a, m, b = (mesh.points[triples[:, i]] for i in range(3))
    slopes = np.stack([4 * m - 3 * a - b, b - a, a - 4 * m + 3 * b], axis=1)
    return np.asarray(slopes / np.linalg.norm(slopes, axis=2, keepdims=True))
