"""Lines of loads and supports: singular ends and bends, and elements cut by lines, whose moments average both sides."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.meshing import to_follow
from signorini.discretise.quadrature import curve_quadrature
from signorini.discretise.quadrature.lines import arc_of
from signorini.discretise.rows import Floats, Ints
from signorini.model import AnnulusPlate, DiscPlate, Load, Support
from signorini.shapes import Curve, Polyline, Ring
from signorini.singularities.boundary import STRAIGHT, Boundary, boundary_of, moments_grow, shears_along, slopes_held
from signorini.singularities.singularity import Singularity, as_places

_ENDS = 1e-9
"""Smallest line load at the end of a line at which the end is singular, relative to the load's largest value."""
_BESIDE = "take values from beside these elements."
_AS_ZONE = "Or define the jump by a zone, whose border the mesh follows."
_ON_SIDE = 1e-6
"""Largest distance from a side of an element at which a line counts as along the side, in reference coordinates."""


def ends_of_load(discretisation: Discretisation, load: Load) -> tuple[tuple[float, float], ...]:
    """Ends and corners of a line load at which shears grow as the logarithm of the distance."""
    assert load.line_load is not None
    edge = boundary_of(discretisation)
    along = load.where.curve
    if along is None:
        return _ends_on_edges(discretisation, load)
    points, directions_of = _points_along(discretisation, along)
    value = np.abs(load.line_load(*points.T))
    acts = value > _ENDS * value.max(initial=0.0)
    chosen = []
    for point, directions, act in zip(points, directions_of, acts, strict=True):
        ends = _bends(*directions) if len(directions) == 2 else _load_ends(edge, point, directions[0])
        if act and ends:
            chosen.append(point)
    return as_places(np.array(chosen).reshape(-1, 2))


def _load_ends(edge: Boundary, point: Floats, into: Floats) -> bool:
    """Whether shears are singular at an end of a line load; ``into`` (2,) is the line's direction from this end."""
    sides = edge.at(point)
    if not len(sides):
        return True
    along = np.abs([edge.tangent(int(side)) @ into for side in sides])
    along_line = sides[along > np.cos(STRAIGHT)]
    if len(along_line):
        beside = np.setdiff1d(sides, along_line)
        return _grows_on_edge(edge, int(along_line[0]), int(beside[0]) if len(beside) else int(along_line[0]))
    # The mirror image of a normal line load continues it past a free edge, and has the opposite sign at a held edge.
    return bool(edge.held[sides].any() or (along > np.sin(STRAIGHT)).any())


def _grows_on_edge(edge: Boundary, loaded: int, beside: int) -> bool:
    """Whether shears are singular where a line load on the side ``loaded`` ends, next to the side ``beside``.

    If both sides are the same, the load ends within the side.
    """
    if edge.held[loaded]:
        return False
    angle = np.pi
    if loaded != beside:
        angle = edge.angles[loaded if edge.following[loaded] == beside else beside]
    return bool(angle >= 0.5 * np.pi - STRAIGHT if edge.held[beside] else abs(angle - np.pi) <= STRAIGHT)


def _ends_on_edges(discretisation: Discretisation, load: Load) -> tuple[tuple[float, float], ...]:
    """Singular ends of a load on edges: the edge continues straight there, or meets a held edge at a right angle."""
    assert load.line_load is not None
    edge, mesh = boundary_of(discretisation), discretisation.mesh
    middles = np.concatenate([mesh.edges[name] for name in load.where.edges])[:, 1]
    loaded = np.isin(edge.sides[:, 1], middles)
    other = edge.following
    ends = np.flatnonzero(loaded != loaded[other])
    pairs = [(side, int(other[side])) if loaded[side] else (int(other[side]), side) for side in ends.tolist()]
    grows = np.array([_grows_on_edge(edge, *pair) for pair in pairs], np.bool_)
    points = mesh.points[edge.sides[ends, 2]]
    value = np.abs(load.line_load(*points.T)) if len(points) else np.zeros(0)
    return as_places(points[grows & (value > _ENDS * value.max(initial=0.0))])


def ends_of_line(
    discretisation: Discretisation, along: Curve, support: Support
) -> dict[tuple[str, ...], tuple[tuple[float, float], ...]]:
    """Singular ends and corners of a line support, grouped by the singular results."""
    edge = boundary_of(discretisation)
    held_slopes = slopes_held("slope" in support.fixed, "twist" in support.fixed)
    rigid, acts = support.is_rigid, support.holds_w
    of_deflection = ("shear", "pressure") if rigid else ("shear",) if acts else ()
    places: dict[tuple[str, ...], list[Floats]] = {}
    for point, directions in zip(*_points_along(discretisation, along), strict=True):
        rays = edge.rays(point) if len(directions) == 1 else []
        within = [float(np.arccos(np.clip(ray @ directions[0], -1.0, 1.0))) for _, ray in rays]
        along_edge = any(min(angle, np.pi - angle) <= STRAIGHT for angle in within)
        if along_edge or (len(directions) == 2 and not _bends(*directions)):
            continue  # `Boundary.corners` finds corners of edges; a straight point is regular
        if not rays:
            numbers = (("moment",) if held_slopes != "free" else ()) + of_deflection
        else:
            held = np.array([edge.held[side] for side, _ in rays])
            askew = any(abs(angle - 0.5 * np.pi) > STRAIGHT for angle in within)
            # At a right angle to the edge, the slopes are the sum of a part even and a part odd about the line.
            # By symmetry one of the two slopes is 0 on the line in the even part, and the other one in the odd part.
            # If the line also holds the other slope of the even or odd part, the plate is clamped there for this part.
            bends = any(
                moments_grow(angle, "clamped", edge.slopes(side), float(edge.poisson[side]))
                for angle, (side, _) in zip(within, rays, strict=True)
            )
            # A rigid line and an edge form a corner of the plate; an elastic line acts as a line load.
            sheared = shears_along(support, point[None], np.array(directions), discretisation.mesh.size).any()
            strained = "twist" not in support.fixed or sheared
            grows = not held.all() and (askew or strained) if rigid else held.any() or askew
            numbers = (("moment",) if held_slopes != "free" and bends else ()) + (of_deflection if grows else ())
        if numbers:
            places.setdefault(numbers, []).append(point)
    return {numbers: as_places(np.array(points)) for numbers, points in places.items()}


def _points_along(discretisation: Discretisation, along: Curve) -> tuple[Floats, list[list[Floats]]]:
    """Points (n, 2) of a line, and the directions (2,) in which the line leaves each: one at an end, otherwise two."""
    if isinstance(along, Polyline):
        return np.array(along.points), _directions(along)
    plate = discretisation.model.plate
    if not isinstance(plate, DiscPlate | AnnulusPlate) or along.center != plate.center or plate.sector == 360:
        return np.zeros((0, 2)), []
    turn = np.radians([0.0, 0.5 * plate.sector, plate.sector])
    outward = np.column_stack([np.cos(turn), np.sin(turn)])
    begin, middle, end = np.column_stack([-outward[:, 1], outward[:, 0]])
    return along.center + along.radius * outward, [[begin], [-middle, middle], [-end]]


def _directions(along: Polyline) -> list[list[Floats]]:
    """Directions in which a polyline leaves each of its points; two at the first point of a closed polyline."""
    tangents = [side.at(np.array([0.0, side.length]))[1] for side in map(arc_of, along.sides)]
    result = [[tangents[0][0]], *([-before[1], after[0]] for before, after in pairwise(tangents)), [-tangents[-1][1]]]
    if along.points[0] == along.points[-1]:
        result[0] = result[-1] = [-tangents[-1][1], tangents[0][0]]
    return result


def _bends(backward: Floats, forward: Floats) -> bool:
    return bool(-backward @ forward < np.cos(STRAIGHT))


def of_cut_elements(discretisation: Discretisation) -> Iterator[Singularity]:
    """Yield, as singular, the nodes of elements in which thickness or stiffness jumps: moments of a laminate."""
    zones = discretisation.zones
    cut = discretisation.thickness.layered[0] if discretisation.thickness.layered is not None else np.zeros(0, np.int64)
    parted = zones.parted[:, cut]
    borders = {f"Border of zone {number}": elements for number, elements in enumerate(parted, 1)}
    for subject, elements in (borders | {"Jump of the thickness": ~parted.any(axis=0)}).items():
        advice = f"Moments and shears within them are those of a laminate of both sides; {_BESIDE} "
        advice += to_follow(discretisation.model) if subject in borders else _AS_ZONE
        yield from _within(discretisation, cut[elements], subject, advice, "plate")


def of_held_slopes(discretisation: Discretisation) -> Iterator[Singularity]:
    """Yield, as singular, the nodes of elements cut by a line that holds slopes; moments jump across such a line."""
    for support in discretisation.model.support:
        along = support.where.curve
        if along is None or not support.holds_rotation:
            continue
        subject = f"The {'circle' if isinstance(along, Ring) else 'line'} of {support.name}"
        advice = f"Moments and shears within them are means of both sides; {_BESIDE} {to_follow(discretisation.model)}"
        yield from _within(discretisation, _crossed(discretisation, along), subject, advice, support.name)


def _within(
    discretisation: Discretisation, elements: Ints, subject: str, advice: str, source: str
) -> Iterator[Singularity]:
    if len(elements):
        count = f"{len(elements)} element{'s' if len(elements) > 1 else ''}"
        where = as_places(discretisation.mesh.points[np.unique(discretisation.mesh.elements[elements])])
        yield Singularity(where, f"{subject} within {count}", ("moment", "shear"), advice, source)


def _crossed(discretisation: Discretisation, along: Curve) -> Ints:
    """Elements (k,) that a line cuts; elements with the line along a side are not cut."""
    mesh = discretisation.mesh
    if mesh.edges_along(along) is not None:
        return np.zeros(0, np.int64)
    pieces = curve_quadrature(mesh, along, order=1)
    off = np.abs(mesh.past(pieces.elements, pieces.xi))
    return np.unique(pieces.elements[off.min(axis=1) > _ON_SIDE])
