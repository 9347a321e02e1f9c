"""The domain of validity (docs/domain.md): inputs outside this domain are refused before assembly."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from signorini.discretise.held import Held, rounding_of
from signorini.discretise.laws import levels_of, stiffness_place
from signorini.discretise.points import ContactPoints
from signorini.discretise.quadrature.lines import PartOfCircle, arcs_of
from signorini.discretise.rows import Bools, Floats, Ints, null_space
from signorini.discretise.thickness import Thickness
from signorini.discretise.zones import Zones
from signorini.errors import InputError, Place, Problems, format_place, point
from signorini.mesh import Mesh
from signorini.mesh.sides import Sides
from signorini.model import Model, OutlinedPlate, Support
from signorini.model.plate import MAX_ASPECT_RATIO
from signorini.shapes import Region
from signorini.shapes.boxes import BoxTree
from signorini.shapes.distances import Targets, depth, edges_of
from signorini.shapes.extent import Tolerances

LONGEST = 1000.0
"""Largest aspect ratio of an element: long side over short side, or over the thickness if that is more.

At 1000, an element's stiffnesses in its two directions differ by 1000⁴ = 1e12: four of sixteen digits remain."""
THICKEST = 10.0
"""Largest thickness relative to the plate's width.

In a thicker plate, the bending stiffness across the width is lost in the rounding of the shear stiffness.
"""
FLOATING = 1e-10
"""Least relative stiffness λL⁴/D of elastic supports if no rigid support holds any rigid motion of the plate.

λ is the stiffness per area of a bed under the whole plate that is as stiff against the motion that is held least.
"""
THIN = 1e-19
"""Least relative stiffness λL⁴/D of the elastic supports of a thin plate, divided by (L/h)²·L²/A; λ as in `FLOATING`.

On softer supports, rounding of the plate's shear stiffness strains the plate. The value was found by experiment.
"""
TURNING = 1e-6
"""Least relative stiffness λL⁴/D of elastic supports if rigid supports hold some rigid motions of the plate, but not
all; λ as in `FLOATING`."""
SOFTEST = 1e-14
"""Least relative stiffness KL⁴/(AD) of an elastic support beside rigid supports that hold the plate.

K is the total stiffness of the support; A, L and D are area, size and bending stiffness of the plate.

The force of a softer support is below the rounding of the rigid supports' reactions."""
RIGID = 1e12
"""Smallest relative stiffness KL⁴/(AD), with the total stiffness K, of an elastic support that counts as rigid."""
_ROUNDING = 1e-9
"""Relative tolerance of all limits of the domain, since coordinates and formulas are rounded."""
_ALONG = 0.02
"""Largest slope of one line relative to another, about 1°, at which the lines count as parallel.

Parallel lines need a least distance. Lines at a larger angle may meet or cross: their reactions are no larger than
those of parallel lines with the least distance.
"""
_AROUND = 64
"""Number of directions around a support's point in which a nearby position is tested: is it on the plate?"""
_HALF_AT_POINT, _HALF_ON_LINE = 0.375, 0.625
"""Least fractions of directions around a support's point that lead onto the plate, if the plate can bend there.

The first is for listed points and excludes corners of the plate up to 135°; the second, for lines, also its edges.
"""
_OF_SIDE, _OF_CIRCLE, _MOST = 8, 64, 1000
"""Least numbers of equal parts of a side and of a circle, at whose ends the distance from other supports is measured.

The third number is the largest number of parts.
"""


class _Hold(NamedTuple):
    """Displacements of supports in the three rigid motions w = 1, w = (x − x₀)/L, w = (y − y₀)/L.

    ``rigid`` (r, 3) are displacements of held dofs and rigid points. ``elastic`` (e, 3) are displacements of springs
    and elastic points, with ``stiffness`` (e,) and index of the ``support`` (e,).
    """

    rigid: Floats
    elastic: Floats
    stiffness: Floats
    support: Ints


def require_domain(
    model: Model,
    mesh: Mesh,
    zones: Zones,
    thickness: Thickness,
    held: Held,
    springs: ContactPoints,
    contacts: ContactPoints,
    problems: Problems,
) -> None:
    """Report as problems all inputs outside the domain of validity; the thickness is checked where it is evaluated."""
    with problems.collected():
        _require_wide(mesh, thickness)
    with problems.collected():
        _require_short_elements(mesh, thickness)
    unit = np.array([rigidity.in_waves for rigidity in zones.rigidities])[zones.of_elements.rigidity]
    bending = float((unit * np.broadcast_to(thickness.at_points.mean(axis=1), len(unit)) ** 3).max())
    hold = _hold(mesh, held, springs, contacts)
    free = null_space(hold.rigid)
    if free.shape[1]:
        with problems.collected():
            _require_stiff_enough(model, mesh, bending, thickness.min(), hold, free)
    # L⁴/(AD) is multiplied step by step, since the fourth power of a length may overflow.
    per_bed = mesh.size / float(mesh.element_area.sum()) * mesh.size * (mesh.size * mesh.size / bending)
    total = np.asarray(np.bincount(hold.support, hold.stiffness, len(model.support)) * per_bed, np.float64)
    if not free.shape[1]:
        with problems.collected():
            _require_no_softer(model, total)
    rigid = {i for i, support in enumerate(model.support) if support.is_rigid}
    rigid |= set(contacts.support[(contacts.compliance == 0) & ~contacts.slope].tolist())
    rigid |= set(np.flatnonzero(total > RIGID).tolist())
    nominal = np.broadcast_to(thickness.nominal.min(axis=1), len(mesh.elements))
    least = np.asarray((1.0 - _ROUNDING) * Tolerances(mesh.diameter, nominal).apart)
    for error in _opposed(model, mesh, held, contacts, least):
        with problems.collected():
            raise error
    # Two supports are compared if both hold the same plate, or both act between the same two plates.
    for between in dict.fromkeys(model.support[index].between for index in sorted(rigid)):
        same_plates = [index for index in sorted(rigid) if model.support[index].between == between]
        for error in _too_near(model, mesh, same_plates, least):
            with problems.collected():
                raise error


def _require_wide(mesh: Mesh, thickness: Thickness) -> None:
    width, thickest = float(mesh.element_area.sum()) / mesh.size, float(thickness.nominal.max())
    if mesh.size > (1.0 + _ROUNDING) * MAX_ASPECT_RATIO * width:
        raise InputError(
            f"The plate is {mesh.size:.6g} long and {width:.3g} wide (area over length); the largest "
            f"allowed ratio is {MAX_ASPECT_RATIO:g} to 1. Calculate a beam.",
            place=("plate",),
        )
    if thickest > (1.0 + _ROUNDING) * THICKEST * width:
        raise InputError(
            f"The plate is {thickest:.6g} thick and {width:.3g} wide (area over length); the largest "
            f"allowed ratio is {THICKEST:g} to 1. Calculate a beam.",
            place=("plate", "thickness"),
        )


def _require_short_elements(mesh: Mesh, thickness: Thickness) -> None:
    corners = mesh.points[mesh.elements[:, :4]]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    lengths = np.linalg.norm(middles[:, [1, 2]] - middles[:, [3, 0]], axis=2)
    triangles = mesh.triangles
    longest = np.linalg.norm(corners[triangles] - np.roll(corners[triangles], -1, axis=1), axis=2).max(axis=1)
    lengths[triangles] = np.column_stack([longest, 2.0 * mesh.element_area[triangles] / longest])
    nominal = np.broadcast_to(thickness.nominal.min(axis=1), len(mesh.elements))
    ratio = lengths.max(axis=1) / np.maximum(lengths.min(axis=1), nominal)
    worst = int(ratio.argmax())
    if ratio[worst] <= (1.0 + _ROUNDING) * LONGEST:
        return
    long, short = lengths[worst].max(), max(lengths[worst].min(), nominal[worst])
    times = math.ceil((1.0 - _ROUNDING) * ratio[worst] / LONGEST)
    raise InputError(
        f"The element at {point(corners[worst].mean(axis=0))} is {long:.6g} long and {short:.6g} wide or thick, "
        f"{ratio[worst]:.6g} to 1; at most {LONGEST:g} to 1 is in the domain. Take {times} times as many elements "
        "along their longer sides, or fewer across; or calculate a beam.",
        place=("mesh",),
    )


def _hold(mesh: Mesh, held: Held, springs: ContactPoints, contacts: ContactPoints) -> _Hold:
    size, modes = np.array([1.0, mesh.size, mesh.size]), held.rigid_motions(mesh.points, mesh.middle)
    # A slope is multiplied by the plate's size L, to be compared with deflections.
    at_nodes = modes[held.dofs] / size * np.tile(size, mesh.node_count)[held.dofs, None]

    def motions(points: ContactPoints) -> Floats:
        result = np.column_stack([np.ones(len(points)), (points.positions - mesh.middle) / mesh.size])
        result[points.slope] = points.rows[points.slope].matrix(mesh.elements, len(modes)) @ modes
        return result

    soft = contacts.compliance > 0
    elastic = ContactPoints.join([springs, contacts.pick(soft)])
    stiffness = elastic.stiffness / np.where(elastic.slope, mesh.size, 1.0) ** 2
    rigid = np.concatenate([at_nodes, motions(contacts.pick(~soft))])
    return _Hold(rigid, motions(elastic), stiffness, elastic.support)


def _require_no_softer(model: Model, total: Floats) -> None:
    """Refuse elastic supports that are too soft to carry a load; ``total`` is KL⁴/(AD) of each support."""
    for i in np.flatnonzero((total > 0.0) & (total < (1.0 - _ROUNDING) * SOFTEST)).tolist():
        raise InputError(
            f"{model.support[i].name} is as soft as a bed under the whole plate with kL⁴/D = {total[i]:.2g}; it must "
            f"be {SOFTEST:g} or more. Leave the support out, since it carries no load, or give "
            f"{SOFTEST / total[i]:.2g} times the stiffness.",
            place=stiffness_place(model.support[i], ("support", i)),
        )


def _require_stiff_enough(model: Model, mesh: Mesh, bending: float, thinnest: float, hold: _Hold, free: Floats) -> None:
    """Refuse elastic supports that alone resist the rigid motions ``free`` (3, d) if the least λ is too small.

    λ is the stiffness per area of a bed under the whole plate that resists a motion as the supports do.
    """
    # Rigid motions that no support resists (mechanisms) are reported by `rigid_freedom`.
    if null_space(np.concatenate([hold.rigid, hold.elastic])).shape[1]:
        return
    # λ = Σ k w² / ∫ w² is the modulus of a bed under the whole plate with the same stiffness against the motion w.
    corners = mesh.points[mesh.elements[:, :4]]
    # Simpson's rule is exact for moments of inertia of rectangles.
    positions = (np.concatenate([corners.mean(axis=1)[:, None], corners], axis=1) - mesh.middle) / mesh.size
    weight = (mesh.element_area / mesh.element_area.sum())[:, None] * np.array([8.0, 1.0, 1.0, 1.0, 1.0]) / 12.0
    modes = np.concatenate([np.ones((*weight.shape, 1)), positions], axis=2).reshape(-1, 3) @ free
    mean = _triangle(np.sqrt(weight.reshape(-1, 1)) * modes)
    # Singular values √λ, in place of eigenvalues λ, resolve the least λ beside others that are 1e30 times as large.
    scaled = np.sqrt(hold.stiffness / hold.stiffness.max())[:, None] * (hold.elastic @ free)
    roots = np.linalg.svd(np.linalg.solve(mean.T, _triangle(scaled).T), compute_uv=False)
    largest = hold.stiffness.max() / float(mesh.element_area.sum()) * mesh.size * mesh.size
    result = float(roots.min()) ** 2 * largest * (mesh.size * mesh.size / bending)
    floats = free.shape[1] == 3
    slender = (mesh.size / thinnest) ** 2 * mesh.size / float(mesh.element_area.sum()) * mesh.size
    least = max(FLOATING if floats else TURNING, THIN * slender)
    if result >= (1.0 - _ROUNDING) * least:
        return
    which = np.unique(hold.support).tolist()
    names = " and ".join(model.support[i].name for i in which)
    held_part = "the plate" if floats else "the plate against a motion that rigid supports leave free"
    raise InputError(
        f"The stiffness of {names} alone holds {held_part}, as stiffly as a bed under the whole plate with kL⁴/D = "
        f"{result:.2g}; it must be {least:g} or more. Give {least / result:.2g} times the stiffness, or hold the plate "
        "rigidly.",
        place=stiffness_place(model.support[which[0]], ("support", which[0])),
    )


def _triangle(rows: Floats) -> Floats:
    """R (3, d) of the QR factorization of rows A (n, d); AᵀA would lose small singular values."""
    return np.asarray(np.linalg.qr(rows, mode="r"))


@dataclass(frozen=True, eq=False)
class _Rigid:
    """Geometry of a rigid support: its edges, its line, or the outline of its area."""

    index: int
    targets: Targets | Sides
    edges: Mapping[str, Targets | Sides]
    covers: Region | None = None

    def has(self, positions: Floats) -> Bools:
        """Mask (q,) of positions (q, 2) within the support's area; all False for edges and lines."""
        return np.zeros(len(positions), np.bool_) if self.covers is None else self.covers.contains(positions)


def _too_near(model: Model, mesh: Mesh, rigid: Sequence[int], least: Floats) -> Iterator[InputError]:
    """Yield an error for each pair of rigid supports that are too near to each other.

    ``least`` (ne,) is the least distance in each element. A footprint counts as its middle, about which the plate
    turns.
    """
    most = float(least.max())
    yield from _points(model, mesh, rigid, least)
    drawn = [_drawn(model, mesh, i, most) for i in rigid]
    lines = [geometry for geometry in drawn if geometry is not None]
    if not lines:
        return
    boxes = np.array([geometry.targets.bounds for geometry in lines]) + most * np.array([-1.0, -1.0, 1.0, 1.0])
    reported = set[tuple[int, int]]()
    for index in rigid:
        support = model.support[index]
        for other in (lines[number] for number in _reached(support, boxes)):
            pair = min(index, other.index), max(index, other.index)
            if other.index == index or pair in reported:
                continue
            for places, along in _looked_at(support, other.targets, most):
                if (near := _nearest(mesh, support, places, along, other, least)) is not None:
                    reported.add(pair)
                    other_name = _name(model.support[other.index], other, near[0])
                    yield _in_words(model, ("support", index, support.place), *near, other_name)
                    break


def _opposed(model: Model, mesh: Mesh, held: Held, contacts: ContactPoints, least: Floats) -> Iterator[InputError]:
    """Yield an error for each rigid one-sided area against which a rigid support presses the plate.

    The area requires w ≤ g and the support w ≥ g, or the reverse. Their opposite reactions are only one element apart,
    and grow without limit as the mesh is refined.
    """
    every = ContactPoints.join([held.points, contacts])
    positions, support_of, value = every.positions, every.support, every.direction * every.distance
    pushes, holds = (flags & ~every.slope for flags in every.rigid_ways)
    reported = set[frozenset[int]]()
    rounding = rounding_of(float(np.abs(value).max(initial=0.0)), mesh.points)
    for index in np.unique(contacts.support).tolist():
        floor, of_floor = model.support[index], support_of == index
        up = bool(pushes[of_floor].any())
        if floor.area is None or up == bool(holds[of_floor].any()) or up != (floor.direction == "down"):
            continue
        others = np.flatnonzero(
            (holds if up else pushes) & ~of_floor & _against(model, mesh, floor, positions, support_of)
        )
        pushed_from, held_from = levels_of(floor, positions[others], ("support", index))
        level = pushed_from if up else held_from
        others = others[np.abs(value[others] - level) <= rounding]
        both = np.unique(support_of[others[(pushes & holds)[others]]])
        if any(
            _covers(model, mesh, other, positions[of_floor])
            and (other in both or _covers(model, mesh, index, positions[support_of == other]))
            for other in np.unique(support_of[others]).tolist()
        ):
            # The two areas together prescribe w = g on the whole area, so that the plate cannot rotate at the support.
            continue
        others = others[_can_turn(model, mesh, held, every.pick(others), least)]
        for other in np.unique(support_of[others]).tolist():
            if frozenset((index, other)) in reported:
                continue
            reported.add(frozenset((index, other)))
            position = positions[others[support_of[others] == other][0]]
            support, (holding, pushing) = model.support[other], ("down", "up") if up else ("up", "down")
            yield InputError(
                f"{support.name} holds the plate {holding} at {point(position, mesh.size)}, where {floor.name}, "
                f"{format_place(('support', index))}, pushes it {pushing}; both are rigid. Their reactions grow "
                "without limit as elements become smaller. Give one of the two a stiffness.",
                place=("support", other, support.place),
            )


def _covers(model: Model, mesh: Mesh, index: int, positions: Floats) -> bool:
    """Whether the support with index ``index`` is an area that covers all positions (q, 2)."""
    region = model.support[index].where.region
    if model.support[index].area is None or region is None:
        return model.support[index].area is not None
    return bool((depth(region, positions) >= -mesh.near.place).all())


def _against(model: Model, mesh: Mesh, floor: Support, positions: Floats, support_of: Ints) -> Bools:
    """Mask (q,) of points that lie on the area ``floor`` and can act against it; points of areas must lie inside it."""
    may = np.array([support.between == floor.between for support in model.support], np.bool_)
    # A line that holds its slope carries a moment by itself, without opposite reactions of the area.
    may &= [support.at is not None or "slope" not in support.fixed for support in model.support]
    if floor.where.region is None:
        return np.asarray(may[support_of])
    areas = np.array([support.area is not None for support in model.support], np.bool_)[support_of]
    return np.asarray(
        may[support_of] & (depth(floor.where.region, positions) >= np.where(areas, 1.0, -1.0) * mesh.near.place)
    )


def _can_turn(model: Model, mesh: Mesh, held: Held, points: ContactPoints, least: Floats) -> Bools:
    """Mask (k,) of the points around which the plate can bend on both sides.

    The plate cannot do so in a rigid zone, at a corner of the plate or, for points on lines, at an edge of the plate.
    """
    spread = np.array([not support.on_nodes for support in model.support], np.bool_)[points.support]
    rows = points.rows
    bends = (held.bodies.rigid[rows.elements] == 0).astype(np.int64)
    np.add.at(bends, rows.further.owners, ~held.bodies.rigid[rows.further.elements])
    result, alone = np.asarray(bends > 0), np.flatnonzero(~spread)
    middle = mesh.nearest(points.positions[alone])
    turn = 2.0 * np.pi / _AROUND * (0.5 + np.arange(_AROUND))
    arms = least[middle.elements][:, None, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    where = mesh.locate((mesh.map(middle.elements, middle.xi)[:, None] + arms).reshape(-1, 2))
    inside, rigid = where.inside.reshape(-1, _AROUND), held.bodies.rigid[where.elements].reshape(-1, _AROUND)
    at_points = np.array([support.at is not None for support in model.support], np.bool_)[points.support[alone]]
    around = inside.sum(axis=1) >= np.where(at_points, _HALF_AT_POINT, _HALF_ON_LINE) * _AROUND
    result[alone] = around & (inside & ~rigid).any(axis=1)
    return result


def _in_words(model: Model, place: Place, position: Floats, distance: float, least: float, other: str) -> InputError:
    snap = "a larger mesh.snap" if model.mesh.snap else f"mesh.snap = {2.0 * distance:.1g}"
    return InputError(
        f"{model.support[int(place[1])].name} holds the plate rigidly at {point(position.tolist())}, {distance:.3g} "
        f"from {other}. Rigid supports must be at one place, or at least a tenth of the thickness apart, here "
        f"{least:.3g}. Join them by {snap}, move one support, or give one a stiffness.",
        place=place,
    )


def _points(model: Model, mesh: Mesh, rigid: Sequence[int], least: Floats) -> Iterator[InputError]:
    """Yield an error for each pair of supports with points too near to each other, about their first such pair."""
    owners = [(i, j) for i in rigid for j in range(len(model.support[i].at or ()))]
    if len(owners) < 2:
        return
    positions = np.array([place for i in rigid for place in model.support[i].at or ()])
    same = mesh.near.place
    # Many points may coincide. Positions are rounded to cells, and only one point of each cell is compared.
    _, first = np.unique(np.round((positions - mesh.middle) / same), axis=0, return_index=True)
    first = np.sort(first)
    cells, reach = positions[first], float(least.max()) * np.array([-1.0, -1.0, 1.0, 1.0])
    cell, neighbour = BoxTree(np.tile(cells, 2) + reach).pairs(cells)
    distance, limit = np.hypot(*(cells[cell] - cells[neighbour]).T), _limit(mesh, cells, least)[cell]
    reported = set[tuple[int, int]]()
    for number in np.lexsort((neighbour, distance, cell)).tolist():
        a, b = int(first[cell[number]]), int(first[neighbour[number]])
        pair = min(owners[a][0], owners[b][0]), max(owners[a][0], owners[b][0])
        if same < distance[number] < limit[number] and pair not in reported:
            reported.add(pair)
            place, others = (("support", owners[k][0], "at", owners[k][1]) for k in (a, b))
            neighbour_name = model.support[owners[b][0]].name
            other = f"the point {point(positions[b].tolist())} of {neighbour_name}, {format_place(others)}"
            yield _in_words(model, place, positions[a], float(distance[number]), float(limit[number]), other)


def _limit(mesh: Mesh, positions: Floats, least: Floats) -> Floats:
    """Least distance (q,) allowed between rigid supports at positions (q, 2); 0 off the plate."""
    if (least == least[0]).all():
        return np.full(len(positions), least[0])
    where = mesh.locate(positions)
    return np.where(where.inside, least[where.elements], 0.0)


def _drawn(model: Model, mesh: Mesh, index: int, within: float) -> _Rigid | None:
    """Geometry of a support: its edges, line, circle or the outline of its area; None for a support at points."""
    where = model.support[index].where
    if where.edges:
        if isinstance(model.plate, OutlinedPlate):
            drawn = edges_of(model.plate.contours, set(where.edges))
            return _Rigid(index, Targets.join(list(drawn.values())), drawn)
        meshed = {name: Sides(mesh.points[mesh.edges[name]], within) for name in where.edges}
        return _Rigid(index, Sides(np.concatenate([sides.nodes for sides in meshed.values()]), within), meshed)
    return None if where.shape is None else _Rigid(index, Targets.along(where.outline), {}, where.region)


def _name(support: Support, drawn: _Rigid, position: Floats) -> str:
    """Text that names the edge, line or area of a support that is nearest to a position (2,)."""
    apart = {name: float(target.nearest(position[None])[1][0]) for name, target in drawn.edges.items()}
    part = f"{support.place} {min(apart, key=lambda name: apart[name], default='')}".rstrip()
    return f"the {part} of {support.name}, {format_place(('support', drawn.index, support.place))}"


def _reached(support: Support, boxes: Floats) -> list[int]:
    """Indices of the boxes (k, 4) that meet the bounding box of a support's points or outline; none for edges."""
    where = support.where
    if not where.points and where.shape is None:
        return []
    x0, y0, x1, y1 = Targets.join([Targets.of(where.points), Targets.along(where.outline)]).bounds
    return np.flatnonzero(((boxes[:, :2] <= [x1, y1]) & (boxes[:, 2:] >= [x0, y0])).all(axis=1)).tolist()


def _looked_at(support: Support, beside: Targets | Sides, most: float) -> Iterator[tuple[Floats, bool]]:
    """Yield positions (q, 2) of a support at which its distance from ``beside`` is measured, and a flag.

    The flag is False for listed points, ends of lines and nearest points of circles, True for positions along a line.
    """
    if support.at is not None:
        yield np.array(support.at), False
    if support.where.shape is None:
        return
    outline = support.where.outline
    yield np.concatenate([outline.segments.reshape(-1, 2), outline.arcs[:, ::2].reshape(-1, 2)]), False
    # The point of a circle nearest to a target lies on the ray from the circle's centre to the target.
    nearest, distances = beside.nearest(outline.circles[:, :2])
    off_centre = (distances > 0.0) & np.isfinite(distances)
    x, y, radius = outline.circles[off_centre].T
    centre = np.column_stack([x, y])
    yield centre + (nearest[off_centre] - centre) * (radius / distances[off_centre])[:, None], False
    for arc in arcs_of(outline):
        fewest = _OF_CIRCLE if isinstance(arc, PartOfCircle) and arc.closed else _OF_SIDE
        count = max(fewest, math.ceil(arc.length / max(0.5 * most, arc.length / _MOST)))
        yield arc.at(np.linspace(0.0, arc.length, count + 1))[0], True


def _nearest(
    mesh: Mesh, support: Support, positions: Floats, along: bool, other: _Rigid, least: Floats
) -> tuple[Floats, float, float] | None:
    """Position of ``support`` nearest to ``other``, its distance from ``other``, and the least distance allowed.

    None if no position is outside ``other`` and too near to it.
    """
    feet, apart = other.targets.nearest(positions)
    rounding = max(mesh.near.place, other.targets.off_arcs if isinstance(other.targets, Sides) else 0.0)
    near = (apart > rounding) & (apart < least.max())
    if along:
        # Only positions at which the lines are parallel count: the distance hardly changes to a neighbouring position.
        change = np.abs(np.diff(np.minimum(apart, 2.0 * float(least.max()))))
        flat = change <= _ALONG * np.hypot(*np.diff(positions, axis=0).T)
        near &= np.append(flat, True) & np.insert(flat, 0, True)
    if not near.any():
        return None
    near &= apart < _limit(mesh, positions, least)
    near &= ~other.has(positions)
    if support.where.region is not None:
        near[near] &= ~support.where.region.contains(feet[near])
    if not near.any():
        return None
    chosen = int(np.where(near, apart, np.inf).argmin())
    return positions[chosen], float(apart[chosen]), float(_limit(mesh, positions[[chosen]], least)[0])
