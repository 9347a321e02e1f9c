"""Supports as springs and contact points, and which of these are each support's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from signorini import _core
from signorini.base.brief import Brief
from signorini.discretise.averages import MOST, STRIP, OutlinePoints, PlateStiffness, missing_corners, outline_points
from signorini.discretise.held import Held, holds_deflection, prescribed_rotations, tangents_at_nodes
from signorini.discretise.placed import Placed, mean_deflections
from signorini.discretise.places import along_curve, edge_nodes, in_area
from signorini.discretise.quadrature import LineQuadrature
from signorini.discretise.quadrature.stepped import INSIDE
from signorini.discretise.rows import Bools, Floats, Ints, Rows, Table
from signorini.errors import Place, Problems
from signorini.expression.levels import Level
from signorini.mesh import Mesh
from signorini.model import Plate, Support

_GAUSS = 3
_GAUSS_RIGID = 2
"""Points on each piece of a rigid line that the mesh does not follow: no more than the dofs that can answer."""
_ROW = 3
"""Elements in which a rigid line that cannot let go holds means: two points in each of a row lock the plate between
them, and share their force as rounding has it, thousands of its sum. In fewer, means would let the plate turn."""
_STIFF = 1e3
"""Stiffness of a bed, over the plate's between elements, from which the plate lies on their means. Points within them
then outnumber what can answer them, and settle ever more slowly; what is left of the deflection is that of the mesh."""
STIFFEST_SPRING = 1e8
"""Stiffness of a spring, over the plate's in shear, beyond which it makes no difference to eight digits. In K it would
drown the plate's own; one that lets go is rigid, or its force would be that of penetrations that are rounding."""
_NONE = 1e-12
"""Coefficient of a row that counts as none."""
_NOT_SHARED = np.full((0, 4), -1, np.int64)

_OFF = 0.02
"""How far a cut may lie from a curved step of a support, over an element's side: finer cuts are many contact points."""


@dataclass(frozen=True, eq=False, repr=False)
class Springs(Table, Brief):
    """Linear springs: stiffness and base (m,); position (m, 2), weight and support of each, ``numbers`` as below."""

    rows: Rows
    stiffness: Floats
    base: Floats
    positions: Floats
    weights: Floats
    support: Ints
    numbers: Ints

    @property
    def direction(self) -> Floats:
        """Which way (m,) each pushes the plate that presses it: up."""
        return np.ones(len(self))

    @property
    def averaged(self) -> Bools:
        """Which (m,) act on means of elements: none."""
        return np.zeros(len(self), np.bool_)

    @property
    def arrays(self) -> tuple[Ints, Floats, Ints, Floats, Floats]:
        """Springs the way the core takes them."""
        return *self.rows.arrays, self.stiffness, self.base


@dataclass(frozen=True, eq=False, repr=False)
class ContactPoints(Table, Brief):
    """Contact points: row·u + gap − compliance·reaction = distance.

    Of ``distance`` the part ``settlement`` is that of the base in the row's direction; the rest is free travel.
    ``direction`` is +1 where the support pushes the plate up and −1 where it holds it down (its row is turned round);
    ``two_sided`` marks equations; other points only push.
    ``slope`` marks two-sided points that hold a slope instead of the deflection. ``shared`` (m, 4) names the elements
    of which points of an averaged area stand for part, by their areas; −1 where there is none. ``numbers`` (m,) say
    which of its support's points each is, as the input lists them from 0; 0 along lines and on areas.
    """

    rows: Rows
    distance: Floats
    settlement: Floats
    compliance: Floats
    two_sided: Bools
    direction: Floats
    slope: Bools
    positions: Floats
    weights: Floats
    support: Ints
    shared: Ints
    numbers: Ints

    @property
    def averaged(self) -> Bools:
        """Which (m,) are of areas that act on means of elements, and at points on their outline."""
        return self.shared[:, 0] >= 0


@dataclass(frozen=True, eq=False)
class _Acting:
    """Points of one support with the rows that they act through, and where formulas that jump are evaluated.

    ``slope`` (k,) are the values at which a slope is held, None where the rows are of the deflection.
    """

    rows: Rows
    positions: Floats
    within: Floats
    weights: Floats
    slope: Floats | None = None
    shared: Ints | None = None
    numbers: Ints | None = None

    @classmethod
    def of(cls, rows: Rows, sampled: LineQuadrature, slope: Floats | None = None, numbers: Ints | None = None) -> Self:
        """Rows of points of the plate."""
        return cls(rows, sampled.positions, sampled.within, sampled.weights, slope, None, numbers)


def springs_and_contacts(
    shape: Plate,
    mesh: Mesh,
    plate: _core.Plate,
    held: Held,
    of_elements: PlateStiffness,
    supports: Sequence[Placed],
    problems: Problems,
) -> tuple[Springs, ContactPoints]:
    """What the supports do beyond the dofs that they hold at nodes."""
    none = np.zeros(0)
    flags, who, place = np.zeros(0, np.bool_), np.zeros(0, np.int64), np.zeros((0, 2))
    springs = [Springs(Rows.join([]), none, none, place, none, who, who)]
    contacts = [ContactPoints(Rows.join([]), none, none, none, flags, none, flags, place, none, who, _NOT_SHARED, who)]
    for placed in supports:
        with problems.collected():
            for acting in _acting(mesh, shape, plate, held, of_elements, placed):
                result = _springs_or_contacts(of_elements, placed, acting)
                if isinstance(result, Springs):
                    springs.append(result)
                else:
                    contacts += result
    return Springs.join(springs), ContactPoints.join(contacts)


def can_let_go(support: Support) -> bool:
    """Whether there are deflections at which the support does not act."""
    if support.fix is not None:
        return False
    return support.resists != "both" or not (support.gap.is_constant and support.gap.value == 0)


def _acting(
    mesh: Mesh,
    shape: Plate,
    plate: _core.Plate,
    held: Held,
    of_elements: PlateStiffness,
    placed: Placed,
) -> list[_Acting]:
    """Points and rows of one support, for what no node holds."""
    support, place, triples = placed.support, placed.place, placed.sides
    deflection = support.holds_w
    if support.area is not None:
        return [_on_area(mesh, shape, plate, held.dofs, of_elements, support, place)]
    if placed.points is not None:
        at_nodes = (placed.nodes >= 0) & ~held.bodies.inside[placed.nodes]
        at_nodes &= holds_deflection(support) or not deflection
        (numbers,) = np.nonzero(~at_nodes)
        sampled = placed.points.pick(numbers)
        rows = mean_deflections(mesh, placed.footprints) if placed.footprints else _rows(plate, sampled, 0)
        result = [_Acting.of(rows, sampled, numbers=numbers)] if deflection else []
        if "slope" in support.fixed:
            rotation = prescribed_rotations(placed, sampled.positions)
            result += [
                _Acting.of(_rows(plate, sampled, part), sampled, rotation[:, part - 1], numbers) for part in (1, 2)
            ]
        return result
    in_means, turned = False, None
    if support.stiffness is not None:
        at_ends = _GAUSS + 1 if can_let_go(support) else 0
        sampled = along_curve(mesh, shape, support, place, triples, _GAUSS, at_ends, _steps(support))
    elif triples is None:
        at_ends = _GAUSS_RIGID if can_let_go(support) else 0
        sampled = along_curve(mesh, shape, support, place, None, _GAUSS_RIGID, at_ends)
        sampled = _once(mesh, sampled)
        in_means = not can_let_go(support) and len(np.unique(sampled.elements)) >= _ROW
    else:
        on = edge_nodes(mesh, triples)
        held_there = bool(support.fixed) or holds_deflection(support)
        some = np.flatnonzero(held.bodies.inside[on.nodes] | (not held_there))
        if not len(some):
            return []
        at = mesh.points[on.nodes[some]]
        where = mesh.locate(at)
        sampled = LineQuadrature(where.elements, where.xi, on.weights[some], at, np.zeros_like(at), at)
        if support.fixed:
            tangents = tangents_at_nodes(mesh, triples)
            each = [tangents[node] for node in on.nodes[some].tolist()]
            number = np.repeat(np.arange(len(each)), [len(directions) for directions in each])
            turned = replace(sampled.pick(number), tangents=np.concatenate(each))
    result = [_Acting.of(_rows(plate, sampled, 0), sampled)] if deflection else []
    turned = sampled if turned is None else turned
    tx, ty = turned.tangents.T
    for component, directions in (("slope", (ty, -tx)), ("twist", (tx, ty))):
        if component in support.fixed:
            rows = _along(plate, turned, *directions)
            rotation = prescribed_rotations(placed, turned.positions)
            result.append(_Acting.of(rows, turned, (np.column_stack(directions) * rotation).sum(axis=1)))
    return [replace(_means(acting), shared=None) for acting in result] if in_means else result


def _steps(support: Support) -> list[Level]:
    """Where an elastic support's stiffness, gap or settlement jumps; the points of a rigid one are what they are."""
    formulas = (support.stiffness, support.gap, support.settlement) if support.stiffness is not None else ()
    return [level for formula in formulas if formula is not None for level in formula.levels if level.jumps]


def _on_area(
    mesh: Mesh,
    shape: Plate,
    plate: _core.Plate,
    held: Bools,
    of_elements: PlateStiffness,
    support: Support,
    place: Place,
) -> _Acting:
    """Points of an area, or means of elements where it is as good as rigid; if it lets go, they reach its outline."""
    elastic, one_sided = support.stiffness is not None, can_let_go(support)
    # Where nodes hold the plate a point of the outline could do nothing.
    free_corners = np.asarray(~held[3 * mesh.elements[:, :4]].any(axis=1))
    to_outline = free_corners if elastic and one_sided else None
    points = in_area(mesh, shape, support.area, place, _GAUSS, to_outline, _steps(support), _OFF, follow=True)
    no_tangents, within = np.broadcast_to(0.0, points.positions.shape), points.positions
    if _steps(support):
        within = mesh.map(points.elements, mesh.inward(points.elements, points.xi, INSIDE))
    sampled = LineQuadrature(points.elements, points.xi, points.weights, points.positions, no_tangents, within)
    through = _Acting.of(_rows(plate, sampled, 0), sampled)
    covered = np.bincount(sampled.elements, minlength=len(mesh.elements)) > 0
    if elastic and not one_sided:
        return through
    if support.stiffness is not None:
        stiffness = support.stiffness(*within.T, above=0.0, place=(*place, "stiffness"))
        if (stiffness < _STIFF * of_elements.in_waves[sampled.elements]).all():
            tips = missing_corners(mesh, shape, support, covered, through.positions)
            return _with(mesh, plate, held, through, tips)
    return _with(mesh, plate, held, _means(through), outline_points(mesh, shape, support, covered))


def _springs_or_contacts(of_elements: PlateStiffness, placed: Placed, acting: _Acting) -> Springs | list[ContactPoints]:
    support, place = placed.support, placed.place
    positions, weights, count = acting.positions, acting.weights, len(acting.rows)
    at = acting.within if _steps(support) else positions
    slope = acting.slope is not None
    settlement = support.settlement(*at.T, place=(*place, "settlement")) if acting.slope is None else acting.slope
    gap = support.gap(*at.T, at_least=0.0, place=(*place, "gap"))
    who = np.full(count, placed.index, dtype=np.int64)
    numbers = np.zeros(count, np.int64) if acting.numbers is None else acting.numbers
    compliance = np.zeros(count)
    two_way = support.fix is not None or support.resists == "both"
    if support.stiffness is not None:
        shear = of_elements.in_shear[acting.rows.elements]
        stiffness = weights * support.stiffness(*at.T, above=0.0, place=(*place, "stiffness"))
        if two_way and not gap.any():
            stiffness = np.minimum(stiffness, STIFFEST_SPRING * shear)
            return Springs(acting.rows, stiffness, settlement, positions, weights, who, numbers)
        compliance = np.where(stiffness < STIFFEST_SPRING * shear, 1.0 / stiffness, 0.0)
    pushes_up, holds_down = (1.0, settlement), (-1.0, -settlement)
    shared = np.broadcast_to(-1, (count, 4)) if acting.shared is None else acting.shared
    equation = two_way and not gap.any()
    sides = {"down": [pushes_up], "up": [holds_down]}.get(
        support.resists or "both", [pushes_up] if equation else [pushes_up, holds_down]
    )
    return [
        ContactPoints(
            acting.rows if sign > 0 else -acting.rows,
            gap + base,
            base,
            compliance,
            np.full(count, equation),
            np.full(count, sign),
            np.full(count, slope),
            positions,
            weights,
            who,
            shared,
            numbers,
        )
        for sign, base in sides
    ]


def _rows(plate: _core.Plate, sampled: LineQuadrature, field: int) -> Rows:
    coefficients, _ = plate.interpolation_rows(sampled.elements, sampled.xi, field)
    return Rows(sampled.elements, coefficients)


def _along(plate: _core.Plate, sampled: LineQuadrature, dx: Floats, dy: Floats) -> Rows:
    """Rows of the slope along directions (dx, dy)."""
    x, y = _rows(plate, sampled, 1), _rows(plate, sampled, 2)
    return Rows(x.elements, dx[:, None] * x.coefficients + dy[:, None] * y.coefficients)


def _means(through: _Acting) -> _Acting:
    """The mean of every element; see `averages`."""
    elements, inverse = np.unique(through.rows.elements, return_inverse=True)
    area = np.bincount(inverse, through.weights).astype(np.float64)

    def mean(values: Floats) -> Floats:
        return np.stack([np.bincount(inverse, through.weights * column) / area for column in values.T], axis=1)

    slope = None if through.slope is None else mean(through.slope[:, None])[:, 0]
    shared = np.column_stack([elements, np.full((len(elements), 3), -1)])
    middle = mean(through.positions)
    return _Acting(Rows(elements, mean(through.rows.coefficients)), middle, middle, area, slope, shared)


def _with(mesh: Mesh, plate: _core.Plate, held: Bools, acting: _Acting, result: OutlinePoints) -> _Acting:
    """Give points on the outline a part of what the support has in the elements that share them."""
    if not len(result.positions):
        return acting
    where = result.shared[:, 0]
    xi = mesh.invert(where, result.positions)
    coefficients, _ = plate.interpolation_rows(where, xi, 0)
    rows = Rows(where, coefficients)
    free = np.asarray(((np.abs(rows.coefficients) > _NONE) & ~held[rows.dofs(mesh.elements)]).any(axis=1))
    rows, positions, shared = rows[free], result.positions[free], result.shared[free]
    within = mesh.map(where, mesh.inward(where, xi, INSIDE))[free]
    area = np.bincount(acting.rows.elements, acting.weights, len(mesh.elements)).astype(np.float64)
    some = shared >= 0
    count = np.bincount(shared[some], minlength=len(area))
    parts = np.where(some, (np.minimum(STRIP, MOST / np.maximum(count, 1)) * area)[shared], 0.0)
    given = np.bincount(shared[some], parts[some], len(area))
    kept = 1.0 - given[acting.rows.elements] / area[acting.rows.elements]
    return _Acting(
        Rows.join([acting.rows, rows]),
        np.concatenate([acting.positions, positions]),
        np.concatenate([acting.within, within]),
        np.concatenate([kept * acting.weights, parts.sum(axis=1)]),
        None,
        None if acting.shared is None else np.concatenate([acting.shared, shared]),
    )


def _once(mesh: Mesh, sampled: LineQuadrature) -> LineQuadrature:
    """Points of a line each once, where its pieces share them."""
    _, first, point = np.unique(
        np.round(sampled.positions / mesh.near.place), axis=0, return_index=True, return_inverse=True
    )
    order = np.sort(first)
    weights = np.bincount(point.ravel(), sampled.weights).astype(np.float64)[point.ravel()]
    once = replace(sampled, weights=weights)
    return once.pick(np.isin(np.arange(len(weights)), order))


@dataclass(frozen=True, eq=False)
class Parts:
    """What is one support's, by number: nodes (h,) whose deflection it holds, and springs (s,).

    ``rows`` (ways, c) are its contact points that hold no slope; a point with travel both ways has two, the first
    pushing the plate up. ``order`` (h + s + c,) leads from nodes, springs and contact points, one behind the other, to
    the order of the input.
    """

    nodes: Ints
    springs: Ints
    rows: Ints
    order: Ints


def parts_of(count: int, held: Held, springs: Springs, points: ContactPoints) -> tuple[Parts, ...]:
    """Part what acts among so many supports."""
    columns = zip(
        _grouped(held.holders[:, 1], count),
        _grouped(springs.support, count),
        _grouped(np.where(points.slope, count, points.support), count),
        strict=True,
    )
    result = []
    for holding, own, mine in columns:
        rows = _by_ways(mine, points)
        given = np.concatenate([held.numbers[holding], springs.numbers[own], points.numbers[rows[0]]])
        result.append(Parts(held.holders[holding, 0], own, rows, np.argsort(given, kind="stable")))
    return tuple(result)


def _by_ways(mine: Ints, points: ContactPoints) -> Ints:
    """Rows (ways, c) of a support: where it has travel both ways, one behind the other those of one point."""
    up = points.direction[mine] > 0
    if up.all() or not up.any():
        return mine.reshape(1, -1)
    return np.stack([mine[up], mine[~up]])


def _grouped(owner: Ints, count: int) -> list[Ints]:
    """Numbers of the entries of each of so many owners, in order; of any others none."""
    order = np.argsort(owner, kind="stable")
    return np.split(order, np.searchsorted(owner[order], np.arange(1, count + 1)))[:count]
