"""Singularities by name: what of a combination has no limit as the mesh is refined, where, and what to do."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from weakref import WeakKeyDictionary

import numpy as np

from signorini.discretise import Discretisation
from signorini.discretise.places import curve, region
from signorini.discretise.rows import Bools, Floats
from signorini.errors import point
from signorini.mesh import Mesh
from signorini.model import AnnulusPlate, DiscPlate, Load, Support
from signorini.model.footprint import KEYS as FOOTPRINT
from signorini.shapes import Circle, Curve, Polyline, Ring
from signorini.singularities.boundary import Boundary
from signorini.singularities.corners import moments_grow, shears_grow, slopes_held

_STRAIGHT = np.radians(1.0)
_ENDS = 1e-9
"""Part of a line load's size at its points below which it has come to nothing at its end."""
_TURN = 72
"""Points of a circle that is named."""


@dataclass(frozen=True)
class Singularity:
    """Numbers that have no limit as the mesh is refined.

    Parameters
    ----------
    where : tuple of (x, y)
        Points; or, if ``line``, the vertices of a line all along which it is so.
    what : str
        What it is, in words.
    numbers : tuple of str
        What has no limit there: "deflection", "rotation", "moment", "shear", "pressure" (per area, or along a line per
        length) or "reaction" (of a support at points).
    advice : str
        What to do about it.
    source : str
        The support's name, the load case, or "plate".
    line : bool
    limited : bool
        Whether it has a limit, of which elements of this size know nothing: a footprint smaller than they are.
    within : float
        How far from there numbers are taken for its peak: the plate's thickness; 0 of nodes of cut elements.
    """

    where: tuple[tuple[float, float], ...]
    what: str
    numbers: tuple[str, ...]
    advice: str
    source: str
    line: bool = False
    limited: bool = False
    within: float = 0.0

    def __str__(self) -> str:
        """Say it in a sentence."""
        if self.limited:
            return (
                f"{self.what} acts as a point on this mesh: {_listed(self.numbers)} at it are too small. {self.advice}"
            )
        have = "have" if len(self.numbers) > 1 else "has"
        return f"{self.what}: {_listed(self.numbers)} {have} no limit as the mesh is refined. {self.advice}"


_FOOTPRINT = "Give it a footprint, patch or radius."
_MESH_ALONG = (
    "They are those of a laminate of both sides there. Take values from beside these elements, or a border along lines "
    "of the mesh"
)
_OF_POLYGON = '; that of shape = "polygon" follows circles of zones too'
_AROUND = 1e-5
"""Part of the plate's size at which it is looked around a corner of a zone."""
_ALIKE = 1e-3
"""Part of the thickness by which it may vary around there without a jump."""
_EIGHT = np.array([[np.cos(a), np.sin(a)] for a in np.radians(22.5 + 45.0 * np.arange(8))])
_RESOLVED = 0.5
"""Part of the element around it that a footprint is at least: a mesh line follows its sides then. Under a third of an
element moments are a fifth too small, under a tenth a third."""
_MOST_PLACES = 6
"""Places that a sentence names; results.json has all."""


def singularities(found: Discretisation, cases: Collection[str] | None = None) -> tuple[Singularity, ...]:
    """Name the singularities under some load cases, under all if none are given.

    Supports are there whether they act or not: that is known only when it is solved.

    Examples
    --------
    >>> from signorini import Model
    >>> from signorini.discretise import discretise
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     support=[{"edge": ["left", "right"], "fix": "hard"}],
    ...     load=[{"force": 20e3, "at": [2, 1.5]}, {"force": 20e3, "at": [2, 2.5], "patch": [0.3, 0.3]}],
    ... )
    >>> for one in singularities(discretise(model)):
    ...     print(one.where, one)
    ((2.0, 1.5),) Force at a point of load[1]: deflection, moment and shear have no limit as the mesh is refined. ...
    """
    acting = [case for case in found.cases if cases is None or case in cases]
    return (*(one for case in acting for one in singularities_of(found, case)), *singularities_of(found))


def singularities_of(found: Discretisation, case: str | None = None) -> tuple[Singularity, ...]:
    """Name those of one load case alone; of none those that are always there."""
    known = _KNOWN.setdefault(found, {})
    if case not in known:
        if case is None:
            measured = _measured(found, (*_of_supports(found), *_of_corners(found), *_of_zones(found)))
            known[case] = (*measured, *_of_cut_elements(found))
        else:
            known[case] = _measured(found, _of_loads(found, case))
    return known[case]


def away_from(mesh: Mesh, named: Iterable[Singularity], number: str) -> Bools:
    """Which nodes (n,) are no part of a peak of "moment", "shear" or another number without a limit.

    They are farther than ``within`` from where it has none, however fine the mesh. Nodes of larger elements there stay,
    although their values are partly of what is there: to leave them out would leave out more of the plate the coarser
    its mesh is. Where no node is left, all are.
    """
    away = ~at_peaks(mesh, named, number)
    return away if away.any() else np.ones_like(away)


def at_peaks(mesh: Mesh, named: Iterable[Singularity], number: str) -> Bools:
    """Which nodes (n,) are part of the peak of a number without a limit."""
    found = np.zeros(mesh.node_count, np.bool_)
    peaks = [one for one in named if number in one.numbers and not (one.line or one.limited)]
    if not peaks:
        return found
    order = np.argsort(mesh.points[:, 0])
    x, y = mesh.points[order].T
    for one in peaks:
        for at in one.where:
            # Only nodes of a strip about it may be so near.
            low, high = at[0] - 1.01 * one.within, at[0] + 1.01 * one.within
            near = slice(np.searchsorted(x, low), np.searchsorted(x, high, side="right"))
            found[order[near]] |= np.hypot(x[near] - at[0], y[near] - at[1]) <= one.within
    return found


def _measured(found: Discretisation, named: Iterable[Singularity]) -> tuple[Singularity, ...]:
    within = float(found.thickness.max())
    return tuple(replace(one, within=within) for one in named)


def _of_loads(found: Discretisation, case: str) -> Iterator[Singularity]:
    for index, load in enumerate(found.model.load):
        if load.case != case:
            continue
        place = f"load[{index + 1}]"
        if load.at is not None and not load.given(FOOTPRINT):
            couple = load.couple is not None
            if (any(load.couple or ()) if couple else load.force) and load.at:
                kind = "Couple" if couple else "Force"
                numbers = ("deflection", *(("rotation",) if couple else ()), "moment", "shear")
                yield Singularity(load.at, f"{kind} at a point of {place}", numbers, _FOOTPRINT, case)
                yield from _on_rigid_areas(found, load.at, f"{kind} at a point of {place}")
        elif load.at is not None:
            yield from _unresolved(found, load.at, _width(load), f"footprint of {place}", case)
        elif load.line_load is not None:
            if (along := curve(load)) is not None:
                yield from _unresolved_line(found, along, place, case)
            if ends := _ends_of_load(found, load):
                what = f"End or corner of the line load of {place}"
                yield Singularity(ends, what, ("shear",), "Take shears from beside it.", case)
    for moving in found.model.moving:
        travelled = moving.positions.get(case)
        if travelled is not None:
            wheels = np.array([at for at, _, _ in moving.wheels(travelled)])
            on = found.mesh.locate(wheels).inside
            if moving.patch is not None:
                yield from _unresolved(found, wheels, max(moving.patch), f"footprint of wheels of {moving.case}", case)
            elif on.any():
                places = _points(wheels[on])
                numbers = ("deflection", "moment", "shear")
                yield Singularity(places, f"Wheels of {moving.case}", numbers, "Give them a patch.", case)
                yield from _on_rigid_areas(found, places, f"Wheels of {moving.case}")


def _of_supports(found: Discretisation) -> Iterator[Singularity]:
    determinate = _determinate(found)
    for support in found.model.support:
        if support.at is not None:
            if not support.given(FOOTPRINT):
                slopes = "slope" in support.fixed
                numbers = ("deflection", *(("rotation",) if slopes else ()), "moment", "shear")
                numbers += () if determinate else ("reaction",)
                advice = "Clamp an edge or a line." if slopes else _FOOTPRINT
                yield Singularity(support.at, f"{support.name} at a point", numbers, advice, support.name)
                yield from _on_rigid_areas(found, support.at, f"{support.name} at a point")
            else:
                yield from _unresolved(found, support.at, _width(support), f"footprint of {support.name}", support.name)
            continue
        yield from _of_outline(found, support)
        steps = any(level.jumps for one in (support.settlement, support.gap) for level in one.levels)
        if steps and _rigid(support):
            what = f"Step of the settlement or gap of {support.name}"
            numbers = ("moment", "shear", "pressure", "reaction")
            yield Singularity((), what, numbers, "Give it a ramp, or the support a stiffness.", support.name)


def _on_rigid_areas(found: Discretisation, at: tuple[tuple[float, float], ...], what: str) -> Iterator[Singularity]:
    """What acts at points on rigid areas, which take it within a thickness."""
    for support in found.model.support:
        if support.area is None or not _rigid(support):
            continue
        shape, points = region(support.area), np.array(at).reshape(-1, 2)
        on = np.ones(len(points), np.bool_) if shape is None else shape.contains(points)
        if on.any():
            where = tuple(place for place, inside in zip(at, on.tolist(), strict=True) if inside)
            yield Singularity(
                where,
                f"{what} on the rigid area of {support.name}",
                ("pressure",),
                "Give the area a stiffness.",
                support.name,
            )


def _unresolved(
    found: Discretisation, at: Sequence[tuple[float, float]] | Floats, size: float, name: str, source: str
) -> Iterator[Singularity]:
    """Footprints, circles and lines that are much smaller than the elements that they are in."""
    places = np.array(at).reshape(-1, 2)
    here = found.mesh.locate(places)
    coarse = here.inside & (size < _RESOLVED * np.sqrt(found.mesh.element_area[here.elements]))
    if coarse.any():
        what, advice = (
            f"The {name}, {size:.3g} wide,",
            f"Take elements of {0.5 * size:.2g} there (mesh.refine).",
        )
        yield Singularity(_points(places[coarse]), what, ("moment", "shear"), advice, source, limited=True)


def _unresolved_line(found: Discretisation, along: Curve, name: str, source: str) -> Iterator[Singularity]:
    if isinstance(along, Ring):
        yield from _unresolved(found, [along.center], 2.0 * along.radius, f"circle of {name}", source)
    else:
        low, high = np.min(along.points, axis=0), np.max(along.points, axis=0)
        yield from _unresolved(found, 0.5 * (low + high), float((high - low).max()), f"line of {name}", source)


def _of_outline(found: Discretisation, support: Support) -> Iterator[Singularity]:
    """Ends and corners of lines, and outlines of rigid areas."""
    rigid = _rigid(support)
    along, shape = curve(support), region(support.area)
    if along is not None:
        yield from _unresolved_line(found, along, support.name, support.name)
        for numbers, ends in _ends_of_line(found, along, support).items():
            advice = "Give it a stiffness, or take values from beside it." if rigid else "Take values from beside it."
            yield Singularity(ends, f"End or corner of the line of {support.name}", numbers, advice, support.name)
    if not rigid or support.area is None:
        return
    advice = "Give the area a stiffness."
    if shape is None or shape.contains(found.mesh.points).all():
        yield from _of_edges_on(found, support, advice)
    else:
        for drawn in shape.loops:
            closed = _points(np.concatenate([drawn, drawn[:1]]))
            yield Singularity(
                closed, f"Outline of the rigid area of {support.name}", ("pressure",), advice, support.name, True
            )
        if len(shape.corners):
            corners = [
                at for at in shape.corners if found.mesh.locate(at[None]).inside[0] and not len(_boundary(found).at(at))
            ]
            if corners:
                what = f"Corner of the rigid area of {support.name}"
                yield Singularity(_points(np.array(corners)), what, ("shear",), advice, support.name)


def _of_edges_on(found: Discretisation, support: Support, advice: str) -> Iterator[Singularity]:
    """Edges that a bent plate stands on where it is all on a rigid area; one that is only pressed lies flat."""
    model, edge = found.model, _boundary(found)
    flat = len(model.support) == 1 and (support.gap is None or support.gap.is_constant)
    if flat and all(load.kind in ("pressure", "self_weight") for load in model.load):
        return
    for loop in edge.loops():
        what = f"Edge of the plate on the rigid area of {support.name}"
        yield Singularity(_points(loop), what, ("pressure",), advice, support.name, True)
    corners = [
        found.mesh.points[edge.sides[side, 2]]
        for side in np.flatnonzero(edge.angles != np.pi).tolist()
        if shears_grow(float(edge.angles[side]), True, False, along=False)
    ]
    if corners:
        what = f"Corner of the plate on the rigid area of {support.name}"
        yield Singularity(_points(np.array(corners)), what, ("shear",), advice, support.name)


def _rigid(support: Support) -> bool:
    return support.stiffness is None and support.holds_w


def _of_corners(found: Discretisation) -> Iterator[Singularity]:
    """Corners that are alike in what has no limit there are one; an outline of chords has many."""
    alike: dict[tuple[bool, tuple[str, ...]], list[tuple[tuple[float, float], float]]] = {}
    for at, degrees, numbers in _boundary(found).corners():
        alike.setdefault((abs(degrees - 180) < 1, numbers), []).append((at, degrees))
    for (straight, numbers), those in alike.items():
        where = tuple(at for at, _ in those)
        angles = sorted(degrees for _, degrees in those)
        of = " to ".join(dict.fromkeys(f"{angle:.4g}°" for angle in (angles[0], angles[-1])))
        what = "Change of the edge's support" if straight else f"Corner of {of} of the plate"
        places = _listed_places(where, found.mesh.size)
        yield Singularity(where, f"{what} at {places}", numbers, "Take values from beside it.", "plate")


def _listed_places(where: Sequence[tuple[float, float]], size: float) -> str:
    places = ", ".join(point(at, size) for at in where[:_MOST_PLACES])
    return places + (f" and {len(where) - _MOST_PLACES} more" if len(where) > _MOST_PLACES else "")


def _of_zones(found: Discretisation) -> Iterator[Singularity]:
    """Corners of borders inside the plate, at which thickness or stiffness jump."""
    edge, mesh = _boundary(found), found.mesh
    for number, zone in enumerate(found.model.zone, 1):
        corners = np.zeros((0, 2)) if isinstance(zone.region, Circle) else zone.region.corners
        around = corners[:, None] + _AROUND * mesh.size * _EIGHT
        elements = mesh.locate(around.reshape(-1, 2)).elements.reshape(-1, len(_EIGHT))
        inside = (elements >= 0).all(axis=1)
        points = around[inside].reshape(-1, 2)
        made = found.zones.at(elements[inside].ravel(), points)
        thickness = found.zones.thickness(made, points).reshape(-1, len(_EIGHT))
        jumps = (np.ptp(thickness, axis=1) > _ALIKE * thickness.max(axis=1)) | (
            np.ptp(made.rigidity.reshape(-1, len(_EIGHT)), axis=1) > 0
        )
        at = np.array([corner for corner in corners[inside][jumps] if not len(edge.at(corner))])
        if len(at):
            what = f"Corner of the border of zone {number} at {_listed_places(_points(at), mesh.size)}"
            yield Singularity(_points(at), what, ("moment", "shear"), "Take values from beside it.", "plate")


def _of_cut_elements(found: Discretisation) -> Iterator[Singularity]:
    """Nodes of elements inside which thickness or stiffness jump: their moments are of neither side."""
    mesh, zones = found.mesh, found.zones
    cut = found.thickness.layered[0] if found.thickness.layered is not None else np.zeros(0, np.int64)
    parted = zones.parted[:, cut]
    parts = {f"Border of zone {number}": mine for number, mine in enumerate(parted, 1)}
    parts["Jump of the thickness"] = ~parted.any(axis=0)
    for what, mine in parts.items():
        if mine.any():
            elements = mesh.elements[cut[mine]]
            count = f"{len(elements)} element{'s' if len(elements) > 1 else ''}"
            where = _points(mesh.points[np.unique(elements)])
            advice = f"{_MESH_ALONG}{'' if found.model.plate.shape == 'polygon' else _OF_POLYGON}."
            yield Singularity(where, f"{what} within {count}", ("moment", "shear"), advice, "plate")


def _determinate(found: Discretisation) -> bool:
    """Whether three points are all that holds the deflection, so that reactions follow from equilibrium."""
    holding = [support for support in found.model.support if support.holds_w]
    slopes = any({"slope", "twist"} & set(support.fixed) for support in found.model.support)
    return not slopes and all(s.at is not None for s in holding) and sum(len(s.at or ()) for s in holding) == 3


def _ends_of_load(found: Discretisation, load: Load) -> tuple[tuple[float, float], ...]:
    """Ends and corners of a line load at which shears grow as the logarithm of the distance."""
    assert load.line_load is not None
    edge = _boundary(found)
    along = curve(load)
    if along is None:
        return _ends_on_edges(found, load)
    points, directions_of = _points_along(found, along)
    value = np.abs(load.line_load(*points.T))
    acts = value > _ENDS * value.max(initial=0.0)
    chosen = []
    for at, directions, act in zip(points, directions_of, acts, strict=True):
        ends = _bends(*directions) if len(directions) == 2 else _load_ends(edge, at, directions[0])
        if act and ends:
            chosen.append(at)
    return _points(np.array(chosen).reshape(-1, 2))


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


def _ends_on_edges(found: Discretisation, load: Load) -> tuple[tuple[float, float], ...]:
    """Ends of a load on edges where the edge runs on straight, or into one that is held at a right angle."""
    assert load.line_load is not None
    edge, mesh = _boundary(found), found.mesh
    middles = np.concatenate([mesh.edges[name] for name in load.edge or ()])[:, 1]
    loaded = np.isin(edge.sides[:, 1], middles)
    other = edge.following
    ends = np.flatnonzero(loaded != loaded[other])
    pairs = [(side, int(other[side])) if loaded[side] else (int(other[side]), side) for side in ends.tolist()]
    grows = np.array([_grows_on_edge(edge, *pair) for pair in pairs], np.bool_)
    at = mesh.points[edge.sides[ends, 2]]
    value = np.abs(load.line_load(*at.T)) if len(at) else np.zeros(0)
    return _points(at[grows & (value > _ENDS * value.max(initial=0.0))])


def _ends_of_line(
    found: Discretisation, along: Curve, support: Support
) -> dict[tuple[str, ...], tuple[tuple[float, float], ...]]:
    """Ends and corners of a line that supports the plate, by the numbers that have no limit there."""
    edge = _boundary(found)
    own = slopes_held("slope" in support.fixed, "twist" in support.fixed)
    rigid, acts = _rigid(support), support.holds_w
    of_deflection = ("shear", "pressure") if rigid else ("shear",) if acts else ()
    places: dict[tuple[str, ...], list[Floats]] = {}
    for at, directions in zip(*_points_along(found, along), strict=True):
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
            grows = not held.all() and (askew or "twist" not in support.fixed) if rigid else held.any() or askew
            numbers = (("moment",) if own != "free" and bends else ()) + (of_deflection if grows else ())
        if numbers:
            places.setdefault(numbers, []).append(at)
    return {numbers: _points(np.array(those)) for numbers, those in places.items()}


def _points_along(found: Discretisation, along: Curve) -> tuple[Floats, list[list[Floats]]]:
    """Points (n, 2) of a line, and its directions (2,) from each: one at an end; of a circle those on the plate."""
    if isinstance(along, Polyline):
        points = np.array(along.points)
        return points, _directions(points)
    plate = found.model.plate
    sector = 360.0
    if isinstance(plate, DiscPlate | AnnulusPlate) and along.center == plate.center:
        sector = plate.sector
    points = _around(along.center, along.radius, sector)
    tangents = np.column_stack([along.center[1] - points[:, 1], points[:, 0] - along.center[0]]) / along.radius
    directions = [[-tangent, tangent] for tangent in tangents]
    if sector < 360:
        directions[0], directions[-1] = [tangents[0]], [-tangents[-1]]
    return points, directions


def _directions(points: Floats) -> list[list[Floats]]:
    """Directions from every point of a polyline along it; both pieces' where it begins and ends if it is closed."""
    steps = np.diff(points, axis=0)
    units = steps / np.hypot(*steps.T)[:, None]
    found = [[units[0]], *([-a, b] for a, b in pairwise(units)), [-units[-1]]]
    if (points[0] == points[-1]).all():
        found[0] = found[-1] = [-units[-1], units[0]]
    return found


def _bends(back: Floats, on: Floats) -> bool:
    return bool(-back @ on < np.cos(_STRAIGHT))


def _around(center: tuple[float, float], radius: float, degrees: float = 360.0) -> Floats:
    turn = np.radians(np.linspace(0.0, degrees, _TURN + 1))
    return np.asarray(center + radius * np.column_stack([np.cos(turn), np.sin(turn)]))


def _width(item: Load | Support) -> float:
    """The longer side of an item's footprint."""
    return 2.0 * item.radius if item.radius is not None else max(item.patch or (0.0,))


def _points(places: Floats) -> tuple[tuple[float, float], ...]:
    return tuple((float(x), float(y)) for x, y in places)


def _listed(words: tuple[str, ...]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else list(words))


def _boundary(found: Discretisation) -> Boundary:
    if found not in _BOUNDARIES:
        _BOUNDARIES[found] = Boundary.of(found)
    return _BOUNDARIES[found]


_KNOWN: WeakKeyDictionary[Discretisation, dict[str | None, tuple[Singularity, ...]]] = WeakKeyDictionary()
_BOUNDARIES: WeakKeyDictionary[Discretisation, Boundary] = WeakKeyDictionary()
