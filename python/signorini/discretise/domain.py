"""The domain of validity (docs/domain.md): what lies outside is refused before anything is assembled."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from signorini.discretise.held import Held, rounding_of
from signorini.discretise.points import ContactPoints, Springs
from signorini.discretise.quadrature.lines import PartOfCircle, arcs_of
from signorini.discretise.rows import Bools, Floats, Ints, null_space
from signorini.discretise.thickness import Thickness
from signorini.discretise.zones import Zones
from signorini.errors import InputError, Place, Problems, format_place, point
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import BoxTree
from signorini.mesh.sides import Sides
from signorini.model import Model, OutlinedPlate, Support
from signorini.model.plate import MAX_ASPECT_RATIO
from signorini.shapes import Region
from signorini.shapes.distances import Targets, depth, edges_of
from signorini.shapes.extent import Tolerances

LONGEST = 1000.0
"""Long side of an element over its short side, or over its thickness if that is more: bending across is stiffer than
along by the fourth power of the ratio, and of sixteen digits four are left."""
THICKEST = 10.0
"""Thickness over a plate's width: of a wall on its edge bending across is rounding beside shear."""
FLOATING = 1e-10
"""Least stiffness λL⁴/D of elastic supports that alone hold the plate: its rigid motions are then free of strain."""
THIN = 1e-19
"""The same over (L/h)²·L²/A: beside the plate's stiffness in shear, which rounds what strains it. Found by trial."""
TURNING = 1e-6
"""The same where rigid supports hold the plate against some motions: rounding strains the plate in the others."""
SOFTEST = 1e-14
"""Least stiffness KL⁴/(AD) of an elastic support in all beside rigid ones that hold the plate: what a softer one
carries is rounding of what they do."""
RIGID = 1e12
"""Stiffness KL⁴/(AD) of a support in all from which on it counts as rigid."""
_ROUNDING = 1e-9
"""Part by which a limit may be exceeded: coordinates and formulas are rounded."""
_RANK = 1e-9
"""Part of the largest singular value of rows below which they do not hold a motion."""
_ALONG = 0.02
"""Slope of the distance between two lines up to which one runs along the other. Lines that meet or cross at more, which
is about a degree, are at one place there: they pry no more than parallel ones at the least distance."""
_AROUND = 64
"""Directions in which the plate is looked for around a place."""
_HALF_AT_POINT, _HALF_ON_LINE = 0.375, 0.625
"""Parts of a turn: a corner of the plate has less than the first, 135°, and its edge less than the second."""
_OF_SIDE, _OF_CIRCLE, _MOST = 8, 64, 1000
"""Pieces of a side of a line and of a circle that are looked at, at least, and of either, about at most."""


class _Hold(NamedTuple):
    """What supports do in the rigid motions w = 1, (x − x₀)/L, (y − y₀)/L."""

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
    springs: Springs,
    contacts: ContactPoints,
    problems: Problems,
) -> None:
    """Put among the problems what of a model lies outside the domain of validity.

    The thickness itself is judged where it is evaluated.
    """
    with problems.collected():
        _require_wide(mesh, thickness)
    with problems.collected():
        _require_short_elements(mesh, thickness)
    unit = np.array([rigidity.in_waves for rigidity in zones.rigidities])[zones.of_elements.rigidity]
    bending = float((unit * np.broadcast_to(thickness.at_points.mean(axis=1), len(unit)) ** 3).max())
    hold = _hold(mesh, held, springs, contacts)
    free = null_space(hold.rigid, _RANK)
    if free.shape[1]:
        with problems.collected():
            _require_stiff_enough(model, mesh, bending, thickness.min(), hold, free)
    # Over the plate's stiffness step by step, since the fourth power of a length may leave all numbers.
    per_bed = mesh.size / float(mesh.element_area.sum()) * mesh.size * (mesh.size * mesh.size / bending)
    total = np.asarray(np.bincount(hold.support, hold.stiffness, len(model.support)) * per_bed, np.float64)
    if not free.shape[1]:
        with problems.collected():
            _require_no_softer(model, total)
    rigid = {i for i, one in enumerate(model.support) if one.is_rigid}
    rigid |= set(contacts.support[(contacts.compliance == 0) & ~contacts.slope].tolist())
    rigid |= set(np.flatnonzero(total > RIGID).tolist())
    nominal = np.broadcast_to(thickness.nominal.min(axis=1), len(mesh.elements))
    least = np.asarray((1.0 - _ROUNDING) * Tolerances(mesh.diameter, nominal).apart)
    for error in _opposed(model, mesh, held, contacts, least):
        with problems.collected():
            raise error
    # What is between two plates says nothing of where one is held.
    for between in dict.fromkeys(model.support[index].between for index in sorted(rigid)):
        alike = [index for index in sorted(rigid) if model.support[index].between == between]
        for error in _too_near(model, mesh, alike, least):
            with problems.collected():
                raise error


def _require_wide(mesh: Mesh, thickness: Thickness) -> None:
    width, thickest = float(mesh.element_area.sum()) / mesh.size, float(thickness.nominal.max())
    if mesh.size > (1.0 + _ROUNDING) * MAX_ASPECT_RATIO * width:
        raise InputError(
            f"The plate is {mesh.size:.6g} long and {width:.3g} wide (area over length); the largest ratio in the "
            f"domain is {MAX_ASPECT_RATIO:g} to 1. Calculate a beam.",
            place=("plate",),
        )
    if thickest > (1.0 + _ROUNDING) * THICKEST * width:
        raise InputError(
            f"Found the thickness {thickest:.6g} of a plate {width:.3g} wide, its area over its length; at most "
            f"{THICKEST:g} times that is in the domain. Calculate a beam.",
            place=("plate", "thickness"),
        )


def _require_short_elements(mesh: Mesh, thickness: Thickness) -> None:
    corners = mesh.points[mesh.elements[:, :4]]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    lengths = np.linalg.norm(middles[:, [1, 2]] - middles[:, [3, 0]], axis=2)
    of = mesh.triangles
    longest = np.linalg.norm(corners[of] - np.roll(corners[of], -1, axis=1), axis=2).max(axis=1)
    lengths[of] = np.column_stack([longest, 2.0 * mesh.element_area[of] / longest])
    nominal = np.broadcast_to(thickness.nominal.min(axis=1), len(mesh.elements))
    ratio = lengths.max(axis=1) / np.maximum(lengths.min(axis=1), nominal)
    worst = int(ratio.argmax())
    if ratio[worst] <= (1.0 + _ROUNDING) * LONGEST:
        return
    long, short = lengths[worst].max(), max(lengths[worst].min(), nominal[worst])
    times = math.ceil((1.0 - _ROUNDING) * ratio[worst] / LONGEST)
    raise InputError(
        f"The element at {point(corners[worst].mean(axis=0))} is {long:.6g} long and {short:.6g} wide or thick, "
        f"{ratio[worst]:.6g} to 1; at most {LONGEST:g} to 1 are in the domain. Take {times} times as many along their "
        "longer sides, or fewer across; or calculate a beam.",
        place=("mesh",),
    )


def _hold(mesh: Mesh, held: Held, springs: Springs, contacts: ContactPoints) -> _Hold:
    size = np.array([1.0, mesh.size, mesh.size])
    at_nodes = held.rigid_motions(mesh.points, mesh.middle)[held.dofs] / size
    # A slope is compared with deflections over the plate.
    at_nodes *= np.tile(size, mesh.node_count)[held.dofs, None]

    def motions(positions: Floats) -> Floats:
        return np.column_stack([np.ones(len(positions)), (positions - mesh.middle) / mesh.size])

    slopes = contacts.pick(contacts.slope)
    of_slopes = slopes.rows.matrix(mesh.elements, 3 * mesh.node_count) @ held.rigid_motions(mesh.points, mesh.middle)
    soft = contacts.compliance > 0
    rigid = np.concatenate([at_nodes, of_slopes, motions(contacts.positions[~soft & ~contacts.slope])])
    turning = springs.rows.matrix(mesh.elements, 3 * mesh.node_count) @ held.rigid_motions(mesh.points, mesh.middle)
    of_springs = np.where(springs.slope[:, None], turning, motions(springs.positions))
    return _Hold(
        rigid,
        np.concatenate([of_springs, motions(contacts.positions[soft])]),
        np.concatenate(
            [springs.stiffness / np.where(springs.slope, mesh.size, 1.0) ** 2, 1.0 / contacts.compliance[soft]]
        ),
        np.concatenate([springs.support, contacts.support[soft]]),
    )


def _require_no_softer(model: Model, total: Floats) -> None:
    """Refuse elastic supports that carry nothing, by their KL⁴/(AD)."""
    for i in np.flatnonzero((total > 0.0) & (total < (1.0 - _ROUNDING) * SOFTEST)).tolist():
        raise InputError(
            f"{model.support[i].name} is as soft as a bed under all of the plate with kL⁴/D = {total[i]:.2g}; it must "
            f"be {SOFTEST:g} or more. Leave it out, since it carries nothing, or give {SOFTEST / total[i]:.2g} times "
            "the stiffness.",
            place=("support", i, "stiffness" if model.support[i].law is None else "law"),
        )


def _require_stiff_enough(model: Model, mesh: Mesh, bending: float, thinnest: float, hold: _Hold, free: Floats) -> None:
    """Refuse elastic supports that the plate would float on, by the least λ of motions (3, d) that they alone hold."""
    # What nothing holds is a mechanism, and told as one.
    if null_space(np.concatenate([hold.rigid, hold.elastic]), _RANK).shape[1]:
        return
    # λ = Σ k w² / ∫ w² is the modulus of a bed under the whole plate that would hold the motion w as firmly.
    corners = mesh.points[mesh.elements[:, :4]]
    # By Simpson's rule in effect: exact for moments of inertia of rectangles.
    at = (np.concatenate([corners.mean(axis=1)[:, None], corners], axis=1) - mesh.middle) / mesh.size
    weight = (mesh.element_area / mesh.element_area.sum())[:, None] * np.array([8.0, 1.0, 1.0, 1.0, 1.0]) / 12.0
    over = np.concatenate([np.ones((*weight.shape, 1)), at], axis=2).reshape(-1, 3) @ free
    mean = _triangle(np.sqrt(weight.reshape(-1, 1)) * over)
    # Roots keep the least λ beside others 1e30 times as large.
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
    what = "the plate" if floats else "the plate against a motion that rigid supports leave free"
    raise InputError(
        f"The stiffness of {names} alone holds {what}, as firmly as a bed under all of it with kL⁴/D = {result:.2g}; "
        f"it must be {least:g} or more. Give {least / result:.2g} times the stiffness, or hold the plate rigidly.",
        place=("support", which[0], "stiffness"),
    )


def _triangle(rows: Floats) -> Floats:
    """The triangle R (3, d) of rows (n, d), which has their products RᵀR and keeps small singular values."""
    return np.asarray(np.linalg.qr(rows, mode="r"))


@dataclass(frozen=True, eq=False)
class _Rigid:
    """What of a rigid support others may be near: its edges, its line, or the outline of what it covers."""

    index: int
    targets: Targets | Sides
    edges: Mapping[str, Targets | Sides]
    covers: Region | None = None

    def has(self, at: Floats) -> Bools:
        """Which places are within it."""
        return np.zeros(len(at), np.bool_) if self.covers is None else self.covers.contains(at)


def _too_near(model: Model, mesh: Mesh, rigid: Sequence[int], least: Floats) -> Iterator[InputError]:
    """Pairs of rigid supports, by number, nearer than the least distance (ne,) of the element there, the first of each.

    Points are those of footprints too, by their middles, since these are what a plate turns about.
    """
    most = float(least.max())
    yield from _points(model, mesh, rigid, least)
    drawn = [_drawn(model, mesh, i, most) for i in rigid]
    lines = [one for one in drawn if one is not None]
    if not lines:
        return
    boxes = np.array([one.targets.bounds for one in lines]) + most * np.array([-1.0, -1.0, 1.0, 1.0])
    told = set[tuple[int, int]]()
    for index in rigid:
        support = model.support[index]
        for other in (lines[number] for number in _reached(support, boxes)):
            pair = min(index, other.index), max(index, other.index)
            if other.index == index or pair in told:
                continue
            for places, along in _looked_at(support, other.targets, most):
                if (near := _nearest(mesh, support, places, along, other, least)) is not None:
                    told.add(pair)
                    what = _name(model.support[other.index], other, near[0])
                    yield _in_words(model, ("support", index, support.place), *near, what)
                    break


def _opposed(model: Model, mesh: Mesh, held: Held, contacts: ContactPoints, least: Floats) -> Iterator[InputError]:
    """Pairs of a rigid one-sided area and a rigid support on it that holds the plate against it.

    With w ≤ g on the area and w ≥ g at the support, the only lever is the distance to the next point of the area.
    """
    nodes, holders = held.holders.T
    at, who = np.concatenate([mesh.points[nodes], contacts.positions]), np.append(holders, contacts.support)
    value = np.append(held.values[3 * nodes], contacts.direction * contacts.distance)
    pushes, holds = (np.append(np.ones(len(nodes), np.bool_), one & ~contacts.slope) for one in contacts.rigid_ways)
    told = set[frozenset[int]]()
    rounding = rounding_of(float(np.abs(value).max(initial=0.0)), mesh.points)
    for index in np.unique(contacts.support).tolist():
        floor, own = model.support[index], who == index
        up = bool(pushes[own].any())
        if floor.area is None or up == bool(holds[own].any()) or up != (floor.resists == "down"):
            continue
        others = np.flatnonzero((holds if up else pushes) & ~own & _against(model, mesh, floor, at, who))
        places = at[others].T
        gap = floor.gap(*places, at_least=0.0, place=("support", index, "gap"))
        level = floor.settlement(*places, place=("support", index, "settlement")) + (gap if up else -gap)
        others = others[np.abs(value[others] - level) <= rounding]
        both = np.unique(who[others[(pushes & holds)[others]]])
        if any(
            _covers(model, mesh, other, at[own]) and (other in both or _covers(model, mesh, index, at[who == other]))
            for other in np.unique(who[others]).tolist()
        ):
            # w = g on all of the area: nothing turns there.
            continue
        others = others[_can_turn(model, mesh, held, contacts, least, others)]
        for other in np.unique(who[others]).tolist():
            if frozenset((index, other)) in told:
                continue
            told.add(frozenset((index, other)))
            found = at[others[who[others] == other][0]]
            support, (holding, pushing) = model.support[other], ("down", "up") if up else ("up", "down")
            yield InputError(
                f"{support.name} holds the plate {holding} at {point(found, mesh.size)}, where {floor.name}, "
                f"{format_place(('support', index))}, pushes it {pushing}; both are rigid. Their reactions grow "
                "without limit as elements become smaller. Give one of the two a stiffness.",
                place=("support", other, support.place),
            )


def _covers(model: Model, mesh: Mesh, index: int, at: Floats) -> bool:
    """Whether a support, by number, is an area that covers positions (q, 2)."""
    region = model.support[index].where.region
    if model.support[index].area is None or region is None:
        return model.support[index].area is not None
    return bool((depth(region, at) >= -mesh.near.place).all())


def _against(model: Model, mesh: Mesh, floor: Support, at: Floats, who: Ints) -> Bools:
    """Which points (q,) at positions (q, 2), of supports (q,), are on an area; points of areas must be inside it."""
    may = np.array([one.between == floor.between for one in model.support], np.bool_)
    # A line that holds its slope needs no lever.
    may &= [one.at is not None or "slope" not in one.fixed for one in model.support]
    if floor.where.region is None:
        return np.asarray(may[who])
    areas = np.array([one.area is not None for one in model.support], np.bool_)[who]
    return np.asarray(may[who] & (depth(floor.where.region, at) >= np.where(areas, 1.0, -1.0) * mesh.near.place))


def _can_turn(model: Model, mesh: Mesh, held: Held, contacts: ContactPoints, least: Floats, which: Ints) -> Bools:
    """Which (k,) of held nodes and, behind them, contact points have plate that bends around them on both sides.

    Those do not that are within a rigid zone, at a corner of the plate or, of lines, on its edge.
    """
    nodes, holders = held.holders.T
    who = np.append(holders, contacts.support)[which]
    spread = np.array([not support.on_nodes for support in model.support], np.bool_)[who]
    rows = contacts.rows
    bends = (held.bodies.rigid[rows.elements] == 0).astype(np.int64)
    np.add.at(bends, rows.further.owners, ~held.bodies.rigid[rows.further.elements])
    result = np.append(np.zeros(len(nodes), np.bool_), bends > 0)[which]
    alone = np.flatnonzero(~spread)
    middle = mesh.nearest(np.concatenate([mesh.points[nodes], contacts.positions])[which[alone]])
    turn = 2.0 * np.pi / _AROUND * (0.5 + np.arange(_AROUND))
    arms = least[middle.elements][:, None, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    where = mesh.locate((mesh.map(middle.elements, middle.xi)[:, None] + arms).reshape(-1, 2))
    inside, rigid = where.inside.reshape(-1, _AROUND), held.bodies.rigid[where.elements].reshape(-1, _AROUND)
    points = np.array([support.at is not None for support in model.support], np.bool_)[who[alone]]
    around = inside.sum(axis=1) >= np.where(points, _HALF_AT_POINT, _HALF_ON_LINE) * _AROUND
    result[alone] = around & (inside & ~rigid).any(axis=1)
    return result


def _in_words(model: Model, place: Place, at: Floats, distance: float, least: float, other: str) -> InputError:
    snap = "a larger mesh.snap" if model.mesh.snap else f"mesh.snap = {2.0 * distance:.1g}"
    return InputError(
        f"{model.support[int(place[1])].name} holds the plate rigidly at {point(at.tolist())}, {distance:.3g} from "
        f"{other}. Rigid supports must be at one place, or at least a tenth of the thickness apart, here {least:.3g}. "
        f"Join them by {snap}, move one, or give one a stiffness.",
        place=place,
    )


def _points(model: Model, mesh: Mesh, rigid: Sequence[int], least: Floats) -> Iterator[InputError]:
    """Points near other ones, the first of each two supports."""
    of = [(i, j) for i in rigid for j in range(len(model.support[i].at or ()))]
    if len(of) < 2:
        return
    at = np.array([place for i in rigid for place in model.support[i].at or ()])
    same = mesh.near.place
    # Any number of points may be at one place; of those one in each cell stands for all.
    _, first = np.unique(np.round((at - mesh.middle) / same), axis=0, return_index=True)
    first = np.sort(first)
    some, reach = at[first], float(least.max()) * np.array([-1.0, -1.0, 1.0, 1.0])
    one, neighbour = BoxTree.build(np.tile(some, 2) + reach).pairs(some)
    distance, limit = np.hypot(*(some[one] - some[neighbour]).T), _limit(mesh, some, least)[one]
    told = set[tuple[int, int]]()
    for number in np.lexsort((neighbour, distance, one)).tolist():
        a, b = int(first[one[number]]), int(first[neighbour[number]])
        pair = min(of[a][0], of[b][0]), max(of[a][0], of[b][0])
        if same < distance[number] < limit[number] and pair not in told:
            told.add(pair)
            place, others = (("support", of[k][0], "at", of[k][1]) for k in (a, b))
            other = f"the point {point(at[b].tolist())} of {model.support[of[b][0]].name}, {format_place(others)}"
            yield _in_words(model, place, at[a], float(distance[number]), float(limit[number]), other)


def _limit(mesh: Mesh, at: Floats, least: Floats) -> Floats:
    """The least distance (q,) at places (q, 2); off the plate there is none."""
    if (least == least[0]).all():
        return np.full(len(at), least[0])
    where = mesh.locate(at)
    return np.where(where.inside, least[where.elements], 0.0)


def _drawn(model: Model, mesh: Mesh, index: int, within: float) -> _Rigid | None:
    """The edges, line, circle or outline of an area that a support has."""
    where = model.support[index].where
    if where.edges:
        if isinstance(model.plate, OutlinedPlate):
            drawn = edges_of(model.plate.contours, set(where.edges))
            return _Rigid(index, Targets.join(list(drawn.values())), drawn)
        meshed = {name: Sides(mesh.points[mesh.edges[name]], within) for name in where.edges}
        return _Rigid(index, Sides(np.concatenate([one.nodes for one in meshed.values()]), within), meshed)
    return None if where.shape is None else _Rigid(index, Targets.along(where.outline), {}, where.region)


def _name(support: Support, drawn: _Rigid, at: Floats) -> str:
    """What of a support is nearest to a place (2,)."""
    apart = {name: float(one.nearest(at[None])[1][0]) for name, one in drawn.edges.items()}
    what = f"{support.place} {min(apart, key=lambda name: apart[name], default='')}".rstrip()
    return f"the {what} of {support.name}, {format_place(('support', drawn.index, support.place))}"


def _reached(support: Support, boxes: Floats) -> list[int]:
    """Which of some boxes (k, 4) a support may reach; those on edges are looked at from the other side."""
    where = support.where
    if not where.points and where.shape is None:
        return []
    x0, y0, x1, y1 = Targets.join([Targets.of(where.points), Targets.along(where.outline)]).bounds
    return np.flatnonzero(((boxes[:, :2] <= [x1, y1]) & (boxes[:, 2:] >= [x0, y0])).all(axis=1)).tolist()


def _looked_at(support: Support, beside: Targets | Sides, most: float) -> Iterator[tuple[Floats, bool]]:
    """Places of a support by themselves, such as points and ends; then those along its lines."""
    if support.at is not None:
        yield np.array(support.at), False
    if support.where.shape is None:
        return
    outline = support.where.outline
    yield np.concatenate([outline.segments.reshape(-1, 2), outline.arcs[:, ::2].reshape(-1, 2)]), False
    # A circle is nearest on the ray from its centre to the nearest place.
    to, far = beside.nearest(outline.circles[:, :2])
    some = (far > 0.0) & np.isfinite(far)
    x, y, radius = outline.circles[some].T
    centre = np.column_stack([x, y])
    yield centre + (to[some] - centre) * (radius / far[some])[:, None], False
    for arc in arcs_of(outline):
        fewest = _OF_CIRCLE if isinstance(arc, PartOfCircle) and arc.closed else _OF_SIDE
        count = max(fewest, math.ceil(arc.length / max(0.5 * most, arc.length / _MOST)))
        yield arc.at(np.linspace(0.0, arc.length, count + 1))[0], True


def _nearest(
    mesh: Mesh, support: Support, at: Floats, along: bool, other: _Rigid, least: Floats
) -> tuple[Floats, float, float] | None:
    """The nearest of the places that are too near to another support and no part of it; how far, and the limit."""
    to, apart = other.targets.nearest(at)
    on = max(mesh.near.place, other.targets.off_arcs if isinstance(other.targets, Sides) else 0.0)
    near = (apart > on) & (apart < least.max())
    if along:
        # Where the distance hardly changes from one place to the next, on both sides.
        change = np.abs(np.diff(np.minimum(apart, 2.0 * float(least.max()))))
        flat = change <= _ALONG * np.hypot(*np.diff(at, axis=0).T)
        near &= np.append(flat, True) & np.insert(flat, 0, True)
    if not near.any():
        return None
    near &= apart < _limit(mesh, at, least)
    near &= ~other.has(at)
    if support.where.region is not None:
        near[near] &= ~support.where.region.contains(to[near])
    if not near.any():
        return None
    chosen = int(np.where(near, apart, np.inf).argmin())
    return at[chosen], float(apart[chosen]), float(_limit(mesh, at[[chosen]], least)[0])
