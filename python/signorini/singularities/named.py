"""All singularities of a plate under load cases: their cause, place, singular results, and advice."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.laws import base_jumps, has_constant_base, is_unyielding
from signorini.discretise.rows import Floats
from signorini.errors import point
from signorini.model import Support
from signorini.shapes import Circle, Curve, Polyline, Region, Ring
from signorini.singularities.boundary import boundary_of, shears_grow
from signorini.singularities.lines import ends_of_line, ends_of_load, of_cut_elements, of_held_slopes
from signorini.singularities.singularity import Singularity, as_places, at_peaks

_FOOTPRINT = "Replace the point by a footprint, patch or radius."
_AROUND = 1e-5
"""Distance from a corner of a zone, relative to the plate's size, at which the sections around the corner are compared.
"""
_ALIKE = 1e-3
"""Smallest relative difference of thicknesses around a corner of a zone that counts as a jump."""
_EIGHT = np.array([[np.cos(a), np.sin(a)] for a in np.radians(22.5 + 45.0 * np.arange(8))])
"""Unit vectors in eight directions, in which thickness and rigidity around a zone's corner are compared."""
_RESOLVED = 0.5
"""Smallest width of a footprint, relative to its element, at which moments are resolved. Moments are too small by a
fifth at a width of 1/3 of the element, by a third at 1/10."""
_MOST_PLACES = 6
"""Largest number of places that a sentence lists; results.json lists more."""


def singularities(discretisation: Discretisation, cases: Collection[str] | None = None) -> tuple[Singularity, ...]:
    """Singularities under the load cases ``cases``, or under all if it is None.

    The singularities of supports are always included, whether or not the supports are in contact.
    """
    acting = [case for case in discretisation.cases if cases is None or case in cases]
    return (
        *(singularity for case in acting for singularity in singularities_of(discretisation, case)),
        *singularities_of(discretisation),
    )


@kept
def excluding(discretisation: Discretisation, number: str, cases: frozenset[str]) -> tuple[Singularity, ...]:
    """Singularities around which nodes are excluded from extremes of "moment" or "shear", under given load cases.

    The tuple is empty if all nodes would be excluded: extremes are then over all nodes.
    """
    result: list[Singularity] = []
    for plate in discretisation.members:
        excluded = [singularity for singularity in singularities(plate.own, cases) if singularity.excludes(number)]
        if not at_peaks(plate.own.mesh, excluded, number).all():
            result += [replace(singularity, plate=plate.name) for singularity in excluded]
    return tuple(result)


@kept
def singularities_of(discretisation: Discretisation, case: str | None = None) -> tuple[Singularity, ...]:
    """Singularities of one load case or, if ``case`` is None, those of supports, corners and zones."""
    if discretisation.plates:
        each = discretisation.plates
        return tuple(
            replace(singularity, plate=plate.name)
            for plate in each
            for singularity in singularities_of(plate.own, case)
        )
    if case is not None:
        return _measured(discretisation, _of_loads(discretisation, case))
    always = *_of_supports(discretisation), *_of_corners(discretisation), *_of_zones(discretisation)
    within = *of_cut_elements(discretisation), *of_held_slopes(discretisation)
    return *_measured(discretisation, always), *within


def _measured(discretisation: Discretisation, named: Iterable[Singularity]) -> tuple[Singularity, ...]:
    def within(singularity: Singularity) -> float:
        return discretisation.thickness.least_at(discretisation.mesh, np.array(singularity.where).reshape(-1, 2))

    return tuple(replace(singularity, within=within(singularity)) for singularity in named)


def _of_loads(discretisation: Discretisation, case: str) -> Iterator[Singularity]:
    for index, load in enumerate(discretisation.model.load):
        if load.case != case:
            continue
        place = f"load[{index + 1}]"
        if load.at is not None and not load.has_footprint:
            couple, places = load.couple is not None, _off_bodies(discretisation, load.at)
            if places and (any(load.couple or ()) if couple else load.force):
                kind = "Couple" if couple else "Force"
                numbers = ("deflection", *(("rotation",) if couple else ()), "moment", "shear")
                yield Singularity(places, f"{kind} at a point of {place}", numbers, _FOOTPRINT, case)
                yield from _on_rigid_areas(discretisation, places, f"{kind} at a point of {place}")
        elif load.at is not None:
            yield from _unresolved(discretisation, load.at, load.width[1], f"footprint of {place}", case)
        elif load.line_load is not None:
            if (along := load.where.curve) is not None:
                yield from _unresolved_shape(discretisation, along, place, case)
            if ends := _off_bodies(discretisation, ends_of_load(discretisation, load), outline=False):
                subject = f"End or corner of the line load of {place}"
                yield Singularity(ends, subject, ("shear",), "Take shears from beside it.", case)
    for moving in discretisation.model.moving:
        travelled = moving.positions.get(case)
        if travelled is not None:
            wheels = np.array([places for places, _, _ in moving.wheels(travelled)])
            wheels_on_plate = _off_bodies(discretisation, as_places(wheels[discretisation.mesh.locate(wheels).inside]))
            if moving.patch is not None:
                name = f"footprint of wheels of {moving.case}"
                yield from _unresolved(discretisation, wheels, max(moving.patch), name, case)
            elif wheels_on_plate:
                numbers = ("deflection", "moment", "shear")
                yield Singularity(wheels_on_plate, f"Wheels of {moving.case}", numbers, "Give them a patch.", case)
                yield from _on_rigid_areas(discretisation, wheels_on_plate, f"Wheels of {moving.case}")


def _of_supports(discretisation: Discretisation) -> Iterator[Singularity]:
    determinate = _determinate(discretisation)
    for support in discretisation.model.support:
        if support.at is not None:
            if not support.has_footprint and (places := _off_bodies(discretisation, support.at)):
                slopes = "slope" in support.fixed
                numbers = ("deflection", *(("rotation",) if slopes else ()), "moment", "shear")
                numbers += () if determinate else ("reaction",)
                advice = "Clamp an edge or a line." if slopes else _FOOTPRINT
                yield Singularity(places, f"{support.name} at a point", numbers, advice, support.name)
                yield from _on_rigid_areas(discretisation, places, f"{support.name} at a point")
            elif support.has_footprint:
                name = f"footprint of {support.name}"
                yield from _unresolved(discretisation, support.at, support.width[1], name, support.name)
            continue
        yield from _of_outline(discretisation, support)
        if support.is_rigid and base_jumps(support):
            subject = f"Step of the settlement or gap of {support.name}"
            numbers = ("moment", "shear", "pressure", "reaction")
            yield Singularity(
                (), subject, numbers, "Replace the step by a ramp, or give the support a stiffness.", support.name
            )


def _off_bodies(
    discretisation: Discretisation, places: tuple[tuple[float, float], ...], outline: bool = True
) -> tuple[tuple[float, float], ...]:
    """Positions that are outside rigid zones; if ``outline``, positions on the outline of a rigid zone are dropped too.

    Forces on rigid bodies cause no singularity.
    """
    mesh, rigid = discretisation.mesh, discretisation.held.bodies.rigid
    if not places or not rigid.any():
        return places
    point, where = mesh.holding(np.array(places))
    around = np.bincount(point, minlength=len(places))
    of_bodies = np.bincount(point, rigid[where.elements], len(places))
    dropped = (of_bodies > 0) & (outline | (of_bodies == around))
    return tuple(position for position, drop in zip(places, dropped.tolist(), strict=True) if not drop)


def _on_rigid_areas(
    discretisation: Discretisation, places: tuple[tuple[float, float], ...], subject: str
) -> Iterator[Singularity]:
    """Yield a singularity of pressure for point forces on rigid areas."""
    for support in discretisation.model.support:
        if support.area is None or not is_unyielding(support):
            continue
        covered = support.where.covers(np.array(places).reshape(-1, 2))
        if covered.any():
            where = tuple(position for position, inside in zip(places, covered.tolist(), strict=True) if inside)
            name = f"{subject} on the rigid area of {support.name}"
            yield Singularity(where, name, ("pressure",), "Give the area a stiffness.", support.name)


def _unresolved(
    discretisation: Discretisation, middles: Sequence[tuple[float, float]] | Floats, size: float, name: str, source: str
) -> Iterator[Singularity]:
    """Yield a singularity for footprints, circles, lines or areas that are much smaller than their elements."""
    places = np.array(_off_bodies(discretisation, as_places(np.array(middles).reshape(-1, 2)))).reshape(-1, 2)
    location = discretisation.mesh.locate(places)
    coarse = location.inside & (size < _RESOLVED * np.sqrt(discretisation.mesh.element_area[location.elements]))
    if coarse.any():
        subject, advice = f"The {name}, {size:.3g} wide,", f"Take elements of {0.5 * size:.2g} there (mesh.refine)."
        yield Singularity(as_places(places[coarse]), subject, ("moment", "shear"), advice, source, limited=True)


def _unresolved_shape(
    discretisation: Discretisation, shape: Curve | Region, name: str, source: str
) -> Iterator[Singularity]:
    kind = {Ring: "circle", Polyline: "line"}.get(type(shape), "area")
    x0, y0, x1, y1 = shape.bounds
    middle, width = (0.5 * (x0 + x1), 0.5 * (y0 + y1)), max(x1 - x0, y1 - y0)
    yield from _unresolved(discretisation, [middle], width, f"{kind} of {name}", source)


def _of_outline(discretisation: Discretisation, support: Support) -> Iterator[Singularity]:
    """Yield singularities of the ends and corners of a support's line, and of the outline of its rigid area."""
    rigid, along, shape = support.is_rigid, support.where.curve, support.where.region
    if support.where.shape is not None:
        yield from _unresolved_shape(discretisation, support.where.shape, support.name, support.name)
    if along is not None:
        for numbers, points in ends_of_line(discretisation, along, support).items():
            if not (ends := _off_bodies(discretisation, points, outline=False)):
                continue
            advice = (
                "Give the line a stiffness, or take values from beside it." if rigid else "Take values from beside it."
            )
            yield Singularity(ends, f"End or corner of the line of {support.name}", numbers, advice, support.name)
    if support.area is None or not is_unyielding(support):
        return
    advice = "Give the area a stiffness."
    if shape is None or shape.contains(discretisation.mesh.points).all():
        yield from _of_edges_on(discretisation, support, advice)
    else:
        for drawn in shape.loops:
            closed, subject = (
                as_places(np.concatenate([drawn, drawn[:1]])),
                f"Outline of the rigid area of {support.name}",
            )
            if _off_bodies(discretisation, closed, outline=False):
                yield Singularity(closed, subject, ("pressure",), advice, support.name, True)
        mesh, edge = discretisation.mesh, boundary_of(discretisation)
        inside = [
            corner for corner in shape.corners if mesh.locate(corner[None]).inside[0] and not len(edge.at(corner))
        ]
        if corners := _off_bodies(discretisation, as_places(np.array(inside).reshape(-1, 2)), outline=False):
            subject = f"Corner of the rigid area of {support.name}"
            yield Singularity(corners, subject, ("shear",), advice, support.name)


def _of_edges_on(discretisation: Discretisation, support: Support, advice: str) -> Iterator[Singularity]:
    """Yield edges and corners of a plate on a rigid area, unless the plate lies flat under pressure only."""
    model, edge = discretisation.model, boundary_of(discretisation)
    flat = len(model.support) == 1 and has_constant_base(support)
    if flat and all(load.kind in ("pressure", "self_weight") for load in model.load):
        return
    for loop in edge.loops():
        subject = f"Edge of the plate on the rigid area of {support.name}"
        yield Singularity(as_places(loop), subject, ("pressure",), advice, support.name, True)
    corners = [
        discretisation.mesh.points[edge.sides[side, 2]]
        for side in np.flatnonzero(edge.angles != np.pi).tolist()
        if shears_grow(float(edge.angles[side]), True, False, along=False)
    ]
    if corners:
        subject = f"Corner of the plate on the rigid area of {support.name}"
        yield Singularity(as_places(np.array(corners)), subject, ("shear",), advice, support.name)


def _of_corners(discretisation: Discretisation) -> Iterator[Singularity]:
    """Yield corners of edges, grouped by the names of the singular results, since a polygonal outline may have many."""
    groups: dict[tuple[bool, bool, tuple[str, ...]], list[tuple[tuple[float, float], float]]] = {}
    for position, degrees, rigid, numbers in boundary_of(discretisation).corners():
        groups.setdefault((rigid, abs(degrees - 180) < 1, numbers), []).append((position, degrees))
    for (rigid, straight, numbers), corners in groups.items():
        where = tuple(position for position, _ in corners)
        angles = sorted(degrees for _, degrees in corners)
        range_of_angles = " to ".join(dict.fromkeys(f"{angle:.4g}°" for angle in (angles[0], angles[-1])))
        subject = "Change of the edge's support" if straight else f"Corner of {range_of_angles} of the plate"
        subject = "Corner of a rigid zone" if rigid else subject
        places = _listed_places(where, discretisation.mesh.size)
        yield Singularity(where, f"{subject} at {places}", numbers, "Take values from beside it.", "plate")


def _listed_places(where: Sequence[tuple[float, float]], size: float) -> str:
    places = ", ".join(point(position, size) for position in where[:_MOST_PLACES])
    return places + (f" and {len(where) - _MOST_PLACES} more" if len(where) > _MOST_PLACES else "")


def _of_zones(discretisation: Discretisation) -> Iterator[Singularity]:
    """Yield corners of the borders of zones inside the plate, if thickness or stiffness jumps there."""
    edge, mesh = boundary_of(discretisation), discretisation.mesh
    for number, zone in enumerate(discretisation.model.zone, 1):
        corners = np.zeros((0, 2)) if isinstance(zone.region, Circle) else zone.region.corners
        around = corners[:, None] + _AROUND * mesh.size * _EIGHT
        elements = mesh.locate(around.reshape(-1, 2)).elements.reshape(-1, len(_EIGHT))
        inside = (elements >= 0).all(axis=1)
        points = around[inside].reshape(-1, 2)
        section = discretisation.zones.at(elements[inside].ravel(), points)
        thickness = discretisation.zones.thickness(section, points).reshape(-1, len(_EIGHT))
        jumps = (np.ptp(thickness, axis=1) > _ALIKE * thickness.max(axis=1)) | (
            np.ptp(section.rigidity.reshape(-1, len(_EIGHT)), axis=1) > 0
        )
        places = as_places(
            np.array([off_bodies for off_bodies in corners[inside][jumps] if not len(edge.at(off_bodies))]).reshape(
                -1, 2
            )
        )
        if off_bodies := _off_bodies(discretisation, places, outline=False):
            subject = f"Corner of the border of zone {number} at {_listed_places(off_bodies, mesh.size)}"
            yield Singularity(off_bodies, subject, ("moment", "shear"), "Take values from beside it.", "plate")


def _determinate(discretisation: Discretisation) -> bool:
    """Whether three points alone hold the deflection, so that reactions are statically determinate."""
    holding = [support for support in discretisation.model.support if support.holds_w]
    slopes = any(support.holds_rotation for support in discretisation.model.support)
    return not slopes and all(s.at is not None for s in holding) and sum(len(s.where.points) for s in holding) == 3
