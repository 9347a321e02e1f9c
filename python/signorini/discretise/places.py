"""Where supports and loads act: keys of the model are converted to points of the mesh.

A rigid area acts on the mean deflection of every element, and at points on its outline. More points within an element
would outnumber its free deflections. Forces on means act at least half an element inside the outline, but a tipping
plate rests on the outline. So corners of elements on the outline carry forces too. The midsides between these corners
remain free to satisfy the means, so that pressures are as accurate as with means alone (docs/theory.md, section 5).
"""

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
from signorini.discretise.quadrature.lines import arcs_of, breaks
from signorini.discretise.quadrature.rules import gauss
from signorini.discretise.quadrature.stepped import OFF, Levels
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import InputError, Place, Problems, length, point, unknown
from signorini.mesh import Location, Mesh
from signorini.model import AnnulusPlate, DiscPlate, MeshPlate, Plate
from signorini.model.where import Where
from signorini.shapes import Circle, Curve, Hollow, Polyline, Region, Ring, Rounded
from signorini.shapes.boxes import BoxTree
from signorini.shapes.distances import Targets, distances
from signorini.shapes.extent import hull
from signorini.shapes.outlines import Point, along_arc
from signorini.shapes.regions import inside, overlap

_SECTOR_SLACK = 1e-3
"""Relative tolerance for parts of circles beyond a sector, and for areas over holes: elements approximate arcs by
parabolas.
"""
_TURN = 360
"""Number of chords of a full circle; their distance from the circle is at most 4e-5 of the radius."""
STRIP = 1e-2
"""Area that each point on the outline represents, relative to its element's area."""
MOST = 0.25
"""Largest area that all outline points of an element represent together, relative to the element's area."""
_ON_OUTLINE = 1e-4
"""Tolerance for points on a convex hull, relative to the plate's diameter.

Circles are replaced by polygons, so that points on a circle are slightly off the hull.
"""
_APART = 0.25
"""Least distance between points on an outline, relative to the element's size."""
_FOUR = 4
"""Least number of points on the convex hull of an area; with fewer, points nearer than `_APART` are added.

Four points resist both slopes equally, on a circle and on a rectangle.
"""
_NUDGE = 1e-4
"""Distance from a point at which the elements around it are searched, relative to the element's size."""
_WITH_FOOTPRINTS = ("support", "load", "contact")
"""Keys of the tables whose points may have footprints."""
_ROUND = np.radians(22.5 + 45.0 * np.arange(8))
"""Angles in radians of the eight directions in which elements around a point are searched."""


def located(
    mesh: Mesh, coordinates: tuple[tuple[float, float], ...], place: Place, in_holes: bool = False
) -> LineQuadrature:
    """Locate points by their coordinates; refuse points off the plate or in a hole.

    With ``in_holes``, as for points with footprints, a point in a hole belongs to the nearest element.
    """
    positions = np.array(coordinates, dtype=np.float64)
    where = mesh.locate(positions)
    if not where.inside.all():
        low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
        (left, bottom), (right, top) = ([length(part, mesh.size) for part in corner] for corner in (low, high))
        beyond = f"but beyond its edges; the plate lies within x = {left} to {right}, y = {bottom} to {top}"
        holes, problems = points_in_holes(mesh, positions), Problems()
        washer = " For a washer over the hole give a radius larger than the hole." * (place[0] in _WITH_FOOTPRINTS)
        for i in np.flatnonzero(~where.inside & ~(holes & in_holes)).tolist():
            reason = (
                f"{'but in a hole' if holes[i] else beyond}. Move the point onto the plate.{washer * bool(holes[i])}"
            )
            with problems.collected():
                raise InputError(
                    f"The point {point(coordinates[i])} is not on the plate, {reason}",
                    place=(*place, i) if len(coordinates) > 1 else place,
                )
        problems.raise_collected()
        elements = mesh.nearest(positions).elements
        middles = mesh.inward(elements, np.zeros_like(positions), 0.0)
        where = Location(elements, np.where(where.inside[:, None], where.xi, middles))
    # A point that the input gives on a circle is moved onto the parabola that approximates the circle.
    xi = mesh.onto_curved_sides(where, mesh.near.written)
    return LineQuadrature(where.elements, xi, np.ones(len(positions)), positions, np.zeros_like(positions), positions)


def points_in_holes(mesh: Mesh, points: Floats) -> Bools:
    """Mask of points (q, 2) in a hole of the plate."""
    result = np.zeros(len(points), np.bool_)
    for hole in mesh.holes:
        result |= inside(points, hole)
    return result


def edge_sides(mesh: Mesh, names: tuple[str, ...], place: Place) -> Ints:
    """Element sides (k, 3) along the edges ``names``; refuse names of edges that the mesh does not have."""
    problems = [
        InputError(unknown("edge", name, mesh.edges, "This mesh"), place=(*place, "edge", position))
        for position, name in enumerate(names)
        if name not in mesh.edges
    ]
    if problems:
        raise InputError.combined(problems)
    sides = np.concatenate([mesh.edges[name] for name in names])
    if len(np.unique(sides[:, 1])) < len(sides):
        listed = ", ".join(f'"{name}"' for name in names)
        raise InputError(f"{listed} have sides in common. Name each part of the boundary once.", place=(*place, "edge"))
    return sides


def mesh_edges(mesh: Mesh, plate: Plate, where: Where, place: Place) -> Ints | None:
    """Element sides (k, 3) along edges, a line or a circle; None if the mesh does not follow the line or circle."""
    if where.edges:
        return edge_sides(mesh, where.edges, place)
    along = where.curve
    sides = None if along is None else mesh.edges_along(along)
    if sides is not None and sides[0, 0] != sides[-1, 2] and isinstance(along, Ring):
        on_plate = curve_quadrature(mesh, along, order=1)
        _require_on_plate(mesh, plate, along, on_plate, "The circle", (*place, "circle"))
    return sides


def sides_beside(mesh: Mesh, where: Where, followed: Ints | None) -> Ints:
    """Sides (k, 3) across which a line load makes shears jump: ``followed``, or if None the sides that the line covers.

    A line that ends between nodes is not followed by the mesh, but shears jump across the sides that it covers.
    """
    if followed is not None:
        return followed
    return np.zeros((0, 3), np.int64) if where.curve is None else mesh.sides_on(where.curve)


def along_curve(
    mesh: Mesh,
    plate: Plate,
    where: Where,
    place: Place,
    sides: Ints | None,
    order: int,
    at_ends: int = 0,
    levels: Levels = (),
) -> LineQuadrature:
    """Gauss points of edges, a line or a circle, divided where level functions change sign; weights are lengths.

    ``sides`` is the result of `mesh_edges`. ``at_ends``, unless 0, is the number of points of Lobatto's rule on pieces
    at ends and corners.
    """
    if sides is not None:
        return edge_quadrature(mesh, sides, order, at_ends > 0, levels)
    assert where.curve is not None  # Without edges, ``where`` has a line or a circle.
    points = curve_quadrature(mesh, where.curve, order, at_ends, levels)
    _require_on_plate(mesh, plate, where.curve, points, f"The {where.key}", (*place, where.key))
    return points


def in_area(
    mesh: Mesh,
    plate: Plate,
    region: Region | None,
    place: Place,
    order: int,
    to_outline: Bools | None = None,
    levels: Levels = (),
    off: float = OFF,
    follow: bool = False,
) -> Quadrature:
    """Quadrature of a region, or of the whole plate, with elements cut where ``levels`` change sign; weights are areas.

    Elements marked in ``to_outline`` (ne,) have points on the outline. With ``follow``, arcs that the mesh follows are
    replaced by element sides.
    """
    points = area_quadrature(mesh, region, order, to_outline, levels, off, follow)
    if region is not None:
        _require_on_plate(mesh, plate, region, points, "The area", (*place, "area"))
    return points


def _require_on_plate(
    mesh: Mesh, plate: Plate, shape: Region | Curve, points: Quadrature, subject: str, place: Place
) -> None:
    """Refuse geometry that leaves the plate; areas may cover holes, including the inside of an annulus.

    A sector represents the whole plate, so circles about the sector's center may leave it.
    """
    if points.total == 0:
        apart = length(_apart(mesh, shape), mesh.size)
        raise InputError(
            f"{subject} is not on the plate: it misses the plate by {apart}. Move it onto the plate.", place=place
        )
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
        over_holes = sum(overlap(around, hole) - sum(overlap(inner, hole) for inner in holes) for hole in mesh.holes)
        beyond, slack = beyond + over_holes, slack + _SECTOR_SLACK * over_holes
    missing = missing - beyond if missing > beyond + slack else 0.0
    if missing > 0:
        off = f"has {100 * missing / whole:.3g} % of its size off the plate{_how_far(mesh, shape)}"
        raise InputError(f"{subject} {off}. Cut it to the plate.", place=place)


def _apart(mesh: Mesh, shape: Region | Curve) -> float:
    """Distance between the plate and a shape that lies entirely off the plate."""
    drawn = Targets.along(shape.outline)
    begin, end = mesh.points[np.concatenate([mesh.boundary[:, :2], mesh.boundary[:, 1:]])].transpose(1, 0, 2)
    ends = np.concatenate([shape.outline.segments.reshape(-1, 2), shape.outline.arcs.reshape(-1, 2)])
    return float(min(drawn.nearest(begin)[1].min(), distances(ends, begin, end).min(initial=np.inf)))


def _how_far(mesh: Mesh, shape: Region | Curve) -> str:
    """Text for messages: the corner of an outline that is farthest off the plate, and its distance from the plate."""
    corners = shape.outline.segments.reshape(-1, 2) if isinstance(shape, Polyline | Ring) else shape.loops[0]
    corners = corners[~mesh.locate(corners).inside]
    if not len(corners):
        return ""
    sides = mesh.points[np.concatenate([mesh.boundary[:, :2], mesh.boundary[:, 1:]])]
    begin, end = sides.transpose(1, 0, 2)
    distance = distances(corners, begin, end).min(axis=1)
    return f", up to {distance.max():.3g} beyond it at {point(corners[distance.argmax()], mesh.size)}"


def edge_nodes(mesh: Mesh, triples: Ints) -> tuple[Ints, Floats]:
    """Nodes (q,) of mesh edges, each once, and their lengths (q,): the integrals of their shape functions."""
    nodes, inverse = np.unique(triples, return_inverse=True)
    return nodes, np.bincount(inverse.ravel(), side_lengths(mesh, triples).ravel()).astype(np.float64)


def side_lengths(mesh: Mesh, triples: Ints) -> Floats:
    """Integrals (k, 3) along mesh edges of the quadratic shape functions of their three nodes."""
    s, weights = gauss(3)
    slopes = np.column_stack([s - 0.5, -2 * s, s + 0.5]) @ mesh.points[triples]
    shapes = np.column_stack([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2])
    return np.asarray((weights * np.hypot(slopes[..., 0], slopes[..., 1])) @ shapes)


def quadratic_tangents(mesh: Mesh, triples: Ints) -> Floats:
    """Unit tangents (k, 3, 2) of mesh edges at their three nodes."""
    a, m, b = (mesh.points[triples[:, i]] for i in range(3))
    slopes = np.stack([4 * m - 3 * a - b, b - a, a - 4 * m + 3 * b], axis=1)
    return np.asarray(slopes / np.linalg.norm(slopes, axis=2, keepdims=True))


def outline(mesh: Mesh, plate: Plate, where: Where) -> Floats:
    """Corners (k, 2), in order, of the convex hull of a support's or load's geometry; for listed points the points.

    Circles are polygons. The geometry is that of the input, independent of the mesh, unless the plate is read from a
    mesh file.
    """
    if where.points:
        return np.array(where.points, dtype=np.float64)
    if where.shape is not None:
        points = _of_shape(plate, where.shape)
    else:
        points = np.concatenate([_edge(mesh, plate, name) for name in where.edges or (None,)])
    return hull(points)


def _of_shape(plate: Plate, shape: Region | Curve) -> Floats:
    """Points (k, 2) on the outline of a region or curve; circles about the center of a sector are cut to the sector."""
    drawn = shape.outline
    points = [drawn.segments.reshape(-1, 2)]
    points += [along_arc(*arc) for arc in drawn.arcs.tolist()]
    for x, y, radius in drawn.circles:
        if isinstance(plate, DiscPlate | AnnulusPlate) and (x, y) == tuple(plate.center):
            points.append(_arc(plate.center, radius, plate.sector))
            if plate.sector < 360:
                inner = plate.inner if isinstance(plate, AnnulusPlate) else 0.0
                points.append(_arc(plate.center, min(inner, radius), plate.sector))
        else:
            points.append(_arc((x, y), radius, 360.0))
    return np.concatenate(points)


def _edge(mesh: Mesh, plate: Plate, name: str | None) -> Floats:
    """Points (k, 2) along an edge of the plate; if ``name`` is None, along all edges."""
    if isinstance(plate, MeshPlate):
        return mesh.points[np.unique(mesh.boundary if name is None else mesh.edges[name])]
    if name is None:
        return plate.outline.points()
    return np.concatenate([contour.points(name) for contour in plate.contours if name in contour.edges])


def _arc(center: Point, radius: float, sector: float) -> Floats:
    """Points (k, 2) of an arc that starts on the x axis, with both ends; the angle ``sector`` is in degrees."""
    turn = np.radians(np.linspace(0.0, sector, 1 + int(np.ceil(_TURN * sector / 360.0))))
    return np.asarray(center + radius * np.column_stack([np.cos(turn), np.sin(turn)]))


@dataclass(frozen=True, eq=False)
class OutlinePoints:
    """Points on the convex hull of an area: positions (v, 2), and the elements (v, 4) around each point.

    Up to four elements are listed; the rest of the row is −1.
    """

    positions: Floats
    shared: Ints


def outline_points(mesh: Mesh, plate: Plate, where: Where, covered: Bools) -> OutlinePoints:
    """Points on the convex hull of an area: corners of the area, and corners of elements on its outline.

    ``covered`` (ne,) marks the elements in the area.
    """
    size = float(np.sqrt(mesh.element_area[covered].mean()))
    corners, all_of_them = outline(mesh, plate, where), _candidates(mesh, where.region)
    candidates = _spread(all_of_them, _APART * size)
    if len(candidates) < _FOUR:
        # In an area of one or two elements, points `_APART` apart may all be on one line, and resist one slope only.
        candidates = _spread(all_of_them, _APART * float(np.ptp(corners, axis=0).min()))
    return _around(mesh, candidates[_off_hull(corners, candidates) <= _ON_OUTLINE * mesh.diameter], size, covered)


def missing_corners(mesh: Mesh, plate: Plate, where: Where, covered: Bools, reached: Floats) -> OutlinePoints:
    """Sharp corners of an area's convex hull at which there is no quadrature point among ``reached`` (q, 2)."""
    corners = np.zeros((0, 2)) if where.region is None else _corners(where.region)
    corners = corners[_off_hull(outline(mesh, plate, where), corners) <= _ON_OUTLINE * mesh.diameter]
    near = mesh.near.place
    along = np.sort(corners[:, 0])
    beside = np.searchsorted(along, reached[:, 0] - near) < np.searchsorted(along, reached[:, 0] + near, "right")
    if beside.any():
        reached_corners, _ = BoxTree(np.hstack([reached[beside] - near, reached[beside] + near])).pairs(corners)
        corners = np.delete(corners, reached_corners, axis=0)
    if not len(corners):
        return OutlinePoints(corners, np.zeros((0, 4), np.int64))
    return _around(mesh, corners, float(np.sqrt(mesh.element_area[covered].min())), covered)


def _around(mesh: Mesh, points: Floats, size: float, covered: Bools) -> OutlinePoints:
    """Points with up to four covered elements around each; points without a covered element are left out."""
    around = np.concatenate([np.zeros((1, 2)), _NUDGE * size * np.column_stack([np.cos(_ROUND), np.sin(_ROUND)])])
    near = mesh.locate((points[:, None] + around).reshape(-1, 2)).elements.reshape(len(points), len(around))
    near = np.sort(np.where((near >= 0) & covered[near], near, -1), axis=1)[:, ::-1]
    near[:, 1:][near[:, 1:] == near[:, :-1]] = -1
    shared = np.sort(near, axis=1)[:, :-5:-1]
    covered_points = shared[:, 0] >= 0
    return OutlinePoints(points[covered_points], shared[covered_points])


def _candidates(mesh: Mesh, shape: Region | None) -> Floats:
    """Corners (v, 2) of an area, then points on its outline: element corners and crossings with element sides."""
    if shape is None:
        return np.asarray(mesh.points[np.unique(mesh.boundary[:, [0, 2]])])
    along = _rim(shape)
    corners = _corners(shape)
    triples = mesh.edges_along(along)
    if triples is not None:
        return np.concatenate([corners, mesh.points[np.unique(triples[:, [0, 2]])]])
    arcs = arcs_of(along.outline)
    return np.concatenate([corners, *(arc.at(breaks(arc, mesh.points[mesh.unique_sides]))[0] for arc in arcs)])


def _corners(shape: Region) -> Floats:
    """Corners (c, 2) of a region; arcs and circles contribute their extreme points in x and y."""
    if isinstance(shape, Hollow):
        return _corners(shape.around)
    if isinstance(shape, Circle):
        return np.asarray(shape.center + shape.radius * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]))
    return shape.tips if isinstance(shape, Rounded) else shape.drawn


def _rim(shape: Region) -> Curve:
    if isinstance(shape, Hollow):
        return _rim(shape.around)
    if isinstance(shape, Circle):
        return Ring(shape.center, shape.radius)
    points = [(x, y) for x, y in shape.drawn.tolist()]
    return Polyline((*points, points[0]))


def _spread(points: Floats, apart: float) -> Floats:
    """Leave out each of the points (v, 2) that is nearer than ``apart`` to a previous point that is kept."""
    from scipy.spatial import cKDTree

    keep = np.ones(len(points), np.bool_)
    for i, j in sorted(cKDTree(points).query_pairs(apart)):
        keep[j] &= not keep[i]
    return np.asarray(points[keep])


def _off_hull(corners: Floats, points: Floats) -> Floats:
    """Distance (v,) of points (v, 2) from the boundary of the convex hull with the corners (k, 2), in order."""
    return np.asarray(distances(points, corners, np.roll(corners, -1, axis=0)).min(axis=1))
