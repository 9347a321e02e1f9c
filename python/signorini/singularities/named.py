"""Singularities by name: what of a combination has no limit as the mesh is refined, where, and what to do."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.errors import point
from signorini.model import Support
from signorini.shapes import Circle, Curve, Polyline, Region, Ring
from signorini.singularities.boundary import boundary_of, shears_grow
from signorini.singularities.lines import ends_of_line, ends_of_load, of_cut_elements, of_held_slopes
from signorini.singularities.singularity import Singularity, as_places, at_peaks

_FOOTPRINT = "Give it a footprint, patch or radius."
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


def singularities(discretisation: Discretisation, cases: Collection[str] | None = None) -> tuple[Singularity, ...]:
    """Name the singularities under some load cases, under all if none are given.

    Supports are there whether they act or not: that is known only when it is solved.
    """
    acting = [case for case in discretisation.cases if cases is None or case in cases]
    return (
        *(one for case in acting for one in singularities_of(discretisation, case)),
        *singularities_of(discretisation),
    )


@kept
def excluding(discretisation: Discretisation, number: str, cases: frozenset[str]) -> tuple[Singularity, ...]:
    """Name those under some load cases around which extremes of "moment" or "shear" leave out nodes.

    None on a plate that is all around them: its extremes are over all nodes.
    """
    result: list[Singularity] = []
    for plate, own in zip(discretisation.plates or (None,), discretisation.each, strict=True):
        those = [one for one in singularities(own, cases) if one.excludes(number)]
        if not at_peaks(own.mesh, those, number).all():
            result += [replace(one, plate=plate.name) if plate else one for one in those]
    return tuple(result)


@kept
def singularities_of(discretisation: Discretisation, case: str | None = None) -> tuple[Singularity, ...]:
    """Name those of one load case alone; of none those that are always there."""
    if discretisation.plates:
        each = discretisation.plates
        return tuple(replace(one, plate=plate.name) for plate in each for one in singularities_of(plate.own, case))
    if case is not None:
        return _measured(discretisation, _of_loads(discretisation, case))
    always = *_of_supports(discretisation), *_of_corners(discretisation), *_of_zones(discretisation)
    within = *of_cut_elements(discretisation), *of_held_slopes(discretisation)
    return *_measured(discretisation, always), *within


def _measured(discretisation: Discretisation, named: Iterable[Singularity]) -> tuple[Singularity, ...]:
    def within(one: Singularity) -> float:
        return discretisation.thickness.least_at(discretisation.mesh, np.array(one.where).reshape(-1, 2))

    return tuple(replace(one, within=within(one)) for one in named)


def _of_loads(discretisation: Discretisation, case: str) -> Iterator[Singularity]:
    for index, load in enumerate(discretisation.model.load):
        if load.case != case:
            continue
        place = f"load[{index + 1}]"
        if load.at is not None and not load.has_footprint:
            couple, at = load.couple is not None, _off_bodies(discretisation, load.at)
            if at and (any(load.couple or ()) if couple else load.force):
                kind = "Couple" if couple else "Force"
                numbers = ("deflection", *(("rotation",) if couple else ()), "moment", "shear")
                yield Singularity(at, f"{kind} at a point of {place}", numbers, _FOOTPRINT, case)
                yield from _on_rigid_areas(discretisation, at, f"{kind} at a point of {place}")
        elif load.at is not None:
            yield from _unresolved(discretisation, load.at, load.width[1], f"footprint of {place}", case)
        elif load.line_load is not None:
            if (along := load.where.curve) is not None:
                yield from _unresolved_shape(discretisation, along, place, case)
            if ends := _off_bodies(discretisation, ends_of_load(discretisation, load), outline=False):
                what = f"End or corner of the line load of {place}"
                yield Singularity(ends, what, ("shear",), "Take shears from beside it.", case)
    for moving in discretisation.model.moving:
        travelled = moving.positions.get(case)
        if travelled is not None:
            wheels = np.array([at for at, _, _ in moving.wheels(travelled)])
            on = _off_bodies(discretisation, as_places(wheels[discretisation.mesh.locate(wheels).inside]))
            if moving.patch is not None:
                name = f"footprint of wheels of {moving.case}"
                yield from _unresolved(discretisation, wheels, max(moving.patch), name, case)
            elif on:
                numbers = ("deflection", "moment", "shear")
                yield Singularity(on, f"Wheels of {moving.case}", numbers, "Give them a patch.", case)
                yield from _on_rigid_areas(discretisation, on, f"Wheels of {moving.case}")


def _of_supports(discretisation: Discretisation) -> Iterator[Singularity]:
    determinate = _determinate(discretisation)
    for support in discretisation.model.support:
        if support.at is not None:
            if not support.has_footprint and (at := _off_bodies(discretisation, support.at)):
                slopes = "slope" in support.fixed
                numbers = ("deflection", *(("rotation",) if slopes else ()), "moment", "shear")
                numbers += () if determinate else ("reaction",)
                advice = "Clamp an edge or a line." if slopes else _FOOTPRINT
                yield Singularity(at, f"{support.name} at a point", numbers, advice, support.name)
                yield from _on_rigid_areas(discretisation, at, f"{support.name} at a point")
            elif support.has_footprint:
                name = f"footprint of {support.name}"
                yield from _unresolved(discretisation, support.at, support.width[1], name, support.name)
            continue
        yield from _of_outline(discretisation, support)
        steps = any(level.jumps for one in (support.settlement, support.gap) for level in one.levels)
        if steps and support.is_rigid:
            what = f"Step of the settlement or gap of {support.name}"
            numbers = ("moment", "shear", "pressure", "reaction")
            yield Singularity((), what, numbers, "Give it a ramp, or the support a stiffness.", support.name)


def _off_bodies(
    discretisation: Discretisation, at: tuple[tuple[float, float], ...], outline: bool = True
) -> tuple[tuple[float, float], ...]:
    """Places that are not in a rigid zone, nor on its ``outline``: what acts there acts on a rigid body."""
    mesh, rigid = discretisation.mesh, discretisation.held.bodies.rigid
    if not at or not rigid.any():
        return at
    point, where = mesh.holding(np.array(at))
    around = np.bincount(point, minlength=len(at))
    of_bodies = np.bincount(point, rigid[where.elements], len(at))
    on = (of_bodies > 0) & (outline | (of_bodies == around))
    return tuple(place for place, drop in zip(at, on.tolist(), strict=True) if not drop)


def _on_rigid_areas(
    discretisation: Discretisation, at: tuple[tuple[float, float], ...], what: str
) -> Iterator[Singularity]:
    """What acts at points on rigid areas, which take it within a thickness."""
    for support in discretisation.model.support:
        if support.area is None or not support.is_rigid or support.can_yield:
            continue
        on = support.where.covers(np.array(at).reshape(-1, 2))
        if on.any():
            where = tuple(place for place, inside in zip(at, on.tolist(), strict=True) if inside)
            name = f"{what} on the rigid area of {support.name}"
            yield Singularity(where, name, ("pressure",), "Give the area a stiffness.", support.name)


def _unresolved(
    discretisation: Discretisation, at: Sequence[tuple[float, float]] | Floats, size: float, name: str, source: str
) -> Iterator[Singularity]:
    """Footprints, circles, lines and areas of supports that are much smaller than the elements that they are in."""
    places = np.array(_off_bodies(discretisation, as_places(np.array(at).reshape(-1, 2)))).reshape(-1, 2)
    here = discretisation.mesh.locate(places)
    coarse = here.inside & (size < _RESOLVED * np.sqrt(discretisation.mesh.element_area[here.elements]))
    if coarse.any():
        what, advice = f"The {name}, {size:.3g} wide,", f"Take elements of {0.5 * size:.2g} there (mesh.refine)."
        yield Singularity(as_places(places[coarse]), what, ("moment", "shear"), advice, source, limited=True)


def _unresolved_shape(
    discretisation: Discretisation, shape: Curve | Region, name: str, source: str
) -> Iterator[Singularity]:
    what = {Ring: "circle", Polyline: "line"}.get(type(shape), "area")
    x0, y0, x1, y1 = shape.bounds
    middle, width = (0.5 * (x0 + x1), 0.5 * (y0 + y1)), max(x1 - x0, y1 - y0)
    yield from _unresolved(discretisation, [middle], width, f"{what} of {name}", source)


def _of_outline(discretisation: Discretisation, support: Support) -> Iterator[Singularity]:
    """Ends and corners of lines, and outlines of rigid areas."""
    rigid, along, shape = support.is_rigid, support.where.curve, support.where.region
    if support.where.shape is not None:
        yield from _unresolved_shape(discretisation, support.where.shape, support.name, support.name)
    if along is not None:
        for numbers, points in ends_of_line(discretisation, along, support).items():
            if not (ends := _off_bodies(discretisation, points, outline=False)):
                continue
            advice = "Give it a stiffness, or take values from beside it." if rigid else "Take values from beside it."
            yield Singularity(ends, f"End or corner of the line of {support.name}", numbers, advice, support.name)
    if support.area is None or not rigid or support.can_yield:
        return
    advice = "Give the area a stiffness."
    if shape is None or shape.contains(discretisation.mesh.points).all():
        yield from _of_edges_on(discretisation, support, advice)
    else:
        for drawn in shape.loops:
            closed, what = as_places(np.concatenate([drawn, drawn[:1]])), f"Outline of the rigid area of {support.name}"
            if _off_bodies(discretisation, closed, outline=False):
                yield Singularity(closed, what, ("pressure",), advice, support.name, True)
        mesh, edge = discretisation.mesh, boundary_of(discretisation)
        inside = [at for at in shape.corners if mesh.locate(at[None]).inside[0] and not len(edge.at(at))]
        if corners := _off_bodies(discretisation, as_places(np.array(inside).reshape(-1, 2)), outline=False):
            what = f"Corner of the rigid area of {support.name}"
            yield Singularity(corners, what, ("shear",), advice, support.name)


def _of_edges_on(discretisation: Discretisation, support: Support, advice: str) -> Iterator[Singularity]:
    """Edges that a bent plate stands on where it is all on a rigid area; one that is only pressed lies flat."""
    model, edge = discretisation.model, boundary_of(discretisation)
    flat = len(model.support) == 1 and support.gap.is_constant
    if flat and all(load.kind in ("pressure", "self_weight") for load in model.load):
        return
    for loop in edge.loops():
        what = f"Edge of the plate on the rigid area of {support.name}"
        yield Singularity(as_places(loop), what, ("pressure",), advice, support.name, True)
    corners = [
        discretisation.mesh.points[edge.sides[side, 2]]
        for side in np.flatnonzero(edge.angles != np.pi).tolist()
        if shears_grow(float(edge.angles[side]), True, False, along=False)
    ]
    if corners:
        what = f"Corner of the plate on the rigid area of {support.name}"
        yield Singularity(as_places(np.array(corners)), what, ("shear",), advice, support.name)


def _of_corners(discretisation: Discretisation) -> Iterator[Singularity]:
    """Corners that are alike in what has no limit there are one; an outline of chords has many."""
    alike: dict[tuple[bool, bool, tuple[str, ...]], list[tuple[tuple[float, float], float]]] = {}
    for at, degrees, rigid, numbers in boundary_of(discretisation).corners():
        alike.setdefault((rigid, abs(degrees - 180) < 1, numbers), []).append((at, degrees))
    for (rigid, straight, numbers), those in alike.items():
        where = tuple(at for at, _ in those)
        angles = sorted(degrees for _, degrees in those)
        of = " to ".join(dict.fromkeys(f"{angle:.4g}°" for angle in (angles[0], angles[-1])))
        what = "Change of the edge's support" if straight else f"Corner of {of} of the plate"
        what = "Corner of a rigid zone" if rigid else what
        places = _listed_places(where, discretisation.mesh.size)
        yield Singularity(where, f"{what} at {places}", numbers, "Take values from beside it.", "plate")


def _listed_places(where: Sequence[tuple[float, float]], size: float) -> str:
    places = ", ".join(point(at, size) for at in where[:_MOST_PLACES])
    return places + (f" and {len(where) - _MOST_PLACES} more" if len(where) > _MOST_PLACES else "")


def _of_zones(discretisation: Discretisation) -> Iterator[Singularity]:
    """Corners of borders inside the plate, at which thickness or stiffness jump."""
    edge, mesh = boundary_of(discretisation), discretisation.mesh
    for number, zone in enumerate(discretisation.model.zone, 1):
        corners = np.zeros((0, 2)) if isinstance(zone.region, Circle) else zone.region.corners
        around = corners[:, None] + _AROUND * mesh.size * _EIGHT
        elements = mesh.locate(around.reshape(-1, 2)).elements.reshape(-1, len(_EIGHT))
        inside = (elements >= 0).all(axis=1)
        points = around[inside].reshape(-1, 2)
        made = discretisation.zones.at(elements[inside].ravel(), points)
        thickness = discretisation.zones.thickness(made, points).reshape(-1, len(_EIGHT))
        jumps = (np.ptp(thickness, axis=1) > _ALIKE * thickness.max(axis=1)) | (
            np.ptp(made.rigidity.reshape(-1, len(_EIGHT)), axis=1) > 0
        )
        places = as_places(np.array([at for at in corners[inside][jumps] if not len(edge.at(at))]).reshape(-1, 2))
        if at := _off_bodies(discretisation, places, outline=False):
            what = f"Corner of the border of zone {number} at {_listed_places(at, mesh.size)}"
            yield Singularity(at, what, ("moment", "shear"), "Take values from beside it.", "plate")


def _determinate(discretisation: Discretisation) -> bool:
    """Whether three points are all that holds the deflection, so that reactions follow from equilibrium."""
    holding = [support for support in discretisation.model.support if support.holds_w]
    slopes = any(support.holds_rotation for support in discretisation.model.support)
    return not slopes and all(s.at is not None for s in holding) and sum(len(s.where.points) for s in holding) == 3
