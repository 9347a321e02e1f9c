"""Ends and bends of lines that support or load the plate, where its numbers have no limit."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.quadrature.arcs import arc_of
from signorini.discretise.rows import Floats
from signorini.model import AnnulusPlate, DiscPlate, Load, Support
from signorini.model.places import curve
from signorini.shapes import Curve, Polyline
from signorini.singularities.boundary import Boundary, boundary_of, shears_along
from signorini.singularities.corners import moments_grow, slopes_held
from signorini.singularities.singularity import as_places

_STRAIGHT = np.radians(1.0)
_ENDS = 1e-9
"""Part of a line load's size at its points below which it has come to nothing at its end."""
_TURN = 72
"""Points of a circle that is named."""


def ends_of_load(discretisation: Discretisation, load: Load) -> tuple[tuple[float, float], ...]:
    """Ends and corners of a line load at which shears grow as the logarithm of the distance."""
    assert load.line_load is not None
    edge = boundary_of(discretisation)
    along = curve(load)
    if along is None:
        return _ends_on_edges(discretisation, load)
    points, directions_of = _points_along(discretisation, along)
    value = np.abs(load.line_load(*points.T))
    acts = value > _ENDS * value.max(initial=0.0)
    chosen = []
    for at, directions, act in zip(points, directions_of, acts, strict=True):
        ends = _bends(*directions) if len(directions) == 2 else _load_ends(edge, at, directions[0])
        if act and ends:
            chosen.append(at)
    return as_places(np.array(chosen).reshape(-1, 2))


def _load_ends(edge: Boundary, at: Floats, into: Floats) -> bool:
    """Whether shears grow at the end of a line load that runs on in a direction (2,)."""
    sides = edge.at(at)
    if not len(sides):
        return True
    along = np.abs([edge.tangent(int(side)) @ into for side in sides])
    mine = sides[along > np.cos(_STRAIGHT)]
    if len(mine):
        beside = np.setdiff1d(sides, mine)
        return _grows_on_edge(edge, int(mine[0]), int(beside[0]) if len(beside) else int(mine[0]))
    # Mirrored at a free edge a load across it runs on straight; at a held one its sign changes.
    return bool(edge.held[sides].any() or (along > np.sin(_STRAIGHT)).any())


def _grows_on_edge(edge: Boundary, mine: int, beside: int) -> bool:
    """Whether shears grow where a load on a side ends and another, or the same, goes on without."""
    if edge.held[mine]:
        return False
    angle = np.pi
    if mine != beside:
        angle = edge.angles[mine if edge.following[mine] == beside else beside]
    return bool(angle >= 0.5 * np.pi - _STRAIGHT if edge.held[beside] else abs(angle - np.pi) <= _STRAIGHT)


def _ends_on_edges(discretisation: Discretisation, load: Load) -> tuple[tuple[float, float], ...]:
    """Ends of a load on edges where the edge runs on straight, or into one that is held at a right angle."""
    assert load.line_load is not None
    edge, mesh = boundary_of(discretisation), discretisation.mesh
    middles = np.concatenate([mesh.edges[name] for name in load.edge or ()])[:, 1]
    loaded = np.isin(edge.sides[:, 1], middles)
    other = edge.following
    ends = np.flatnonzero(loaded != loaded[other])
    pairs = [(side, int(other[side])) if loaded[side] else (int(other[side]), side) for side in ends.tolist()]
    grows = np.array([_grows_on_edge(edge, *pair) for pair in pairs], np.bool_)
    at = mesh.points[edge.sides[ends, 2]]
    value = np.abs(load.line_load(*at.T)) if len(at) else np.zeros(0)
    return as_places(at[grows & (value > _ENDS * value.max(initial=0.0))])


def ends_of_line(
    discretisation: Discretisation, along: Curve, support: Support
) -> dict[tuple[str, ...], tuple[tuple[float, float], ...]]:
    """Ends and corners of a line that supports the plate, by the numbers that have no limit there."""
    edge = boundary_of(discretisation)
    own = slopes_held("slope" in support.fixed, "twist" in support.fixed)
    rigid, acts = support.is_rigid, support.holds_w
    of_deflection = ("shear", "pressure") if rigid else ("shear",) if acts else ()
    places: dict[tuple[str, ...], list[Floats]] = {}
    for at, directions in zip(*_points_along(discretisation, along), strict=True):
        rays = edge.rays(at) if len(directions) == 1 else []
        within = [float(np.arccos(np.clip(ray @ directions[0], -1.0, 1.0))) for _, ray in rays]
        if any(min(angle, np.pi - angle) <= _STRAIGHT for angle in within) or not (
            rays or len(directions) == 1 or _bends(*directions)
        ):
            continue  # along an edge, which has corners of its own, or straight on
        if not rays:
            numbers = (("moment",) if own != "free" else ()) + of_deflection
        else:
            held = np.array([edge.held[side] for side, _ in rays])
            askew = any(abs(angle - 0.5 * np.pi) > _STRAIGHT for angle in within)
            sides = zip(within, rays, strict=True)
            # At a right angle slopes part into those even about the line and those odd; where one is held, the other is
            # zero by symmetry, so that one of both parts is clamped.
            bends = any(
                moments_grow(a, "clamped", edge.slopes(side), float(edge.poisson[side])) for a, (side, _) in sides
            )
            # A rigid line and an edge are a corner; an elastic one acts as a line load does.
            strained = (
                "twist" not in support.fixed
                or shears_along(support, at[None], np.array(directions), discretisation.mesh.size).any()
            )
            grows = not held.all() and (askew or strained) if rigid else held.any() or askew
            numbers = (("moment",) if own != "free" and bends else ()) + (of_deflection if grows else ())
        if numbers:
            places.setdefault(numbers, []).append(at)
    return {numbers: as_places(np.array(those)) for numbers, those in places.items()}


def _points_along(discretisation: Discretisation, along: Curve) -> tuple[Floats, list[list[Floats]]]:
    """Points (n, 2) of a line, and its directions (2,) from each: one at an end; of a circle those on the plate."""
    if isinstance(along, Polyline):
        return np.array(along.points), _directions(along)
    plate = discretisation.model.plate
    sector = 360.0
    if isinstance(plate, DiscPlate | AnnulusPlate) and along.center == plate.center:
        sector = plate.sector
    points = _around(along.center, along.radius, sector)
    tangents = np.column_stack([along.center[1] - points[:, 1], points[:, 0] - along.center[0]]) / along.radius
    directions = [[-tangent, tangent] for tangent in tangents]
    if sector < 360:
        directions[0], directions[-1] = [tangents[0]], [-tangents[-1]]
    return points, directions


def _directions(along: Polyline) -> list[list[Floats]]:
    """Directions from every point of a polyline along it; both sides' where it begins and ends if it is closed."""
    tangents = [side.at(np.array([0.0, side.length]))[1] for side in map(arc_of, along.sides)]
    result = [[tangents[0][0]], *([-before[1], after[0]] for before, after in pairwise(tangents)), [-tangents[-1][1]]]
    if along.points[0] == along.points[-1]:
        result[0] = result[-1] = [-tangents[-1][1], tangents[0][0]]
    return result


def _bends(back: Floats, on: Floats) -> bool:
    return bool(-back @ on < np.cos(_STRAIGHT))


def _around(center: tuple[float, float], radius: float, degrees: float = 360.0) -> Floats:
    turn = np.radians(np.linspace(0.0, degrees, _TURN + 1))
    return np.asarray(center + radius * np.column_stack([np.cos(turn), np.sin(turn)]))
