"""Supports as springs and contact points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from signorini import _core
from signorini.discretise.held import Held, holds_deflection, prescribed_rotations, tangents_at_nodes
from signorini.discretise.laws import LAWS, Law, acts_both_ways, can_let_go, laws_of
from signorini.discretise.placed import Placed, means_over
from signorini.discretise.places import (
    MOST,
    STRIP,
    OutlinePoints,
    along_curve,
    edge_nodes,
    in_area,
    missing_corners,
    outline_points,
)
from signorini.discretise.points import ContactPoints, Springs, partition
from signorini.discretise.quadrature import LineQuadrature, Quadrature, area_quadrature
from signorini.discretise.quadrature.stepped import INSIDE
from signorini.discretise.rows import Bools, Floats, Ints, Rows, Table, interpolated
from signorini.discretise.thickness import PlateStiffness
from signorini.errors import InputError, Place, Problems, point
from signorini.expression import Expression, Field
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
_LEAST_PART = 0.1
"""Part of a support to which a field gives a stiffness, up to which it is refused: most likely in other units."""
_NONE = 1e-12
"""Coefficient of a row that counts as none."""

_OFF = 0.02
"""How far a cut may lie from a curved step of a support, over an element's side: finer cuts are many contact points."""


@dataclass(frozen=True, eq=False)
class _Acting(Table):
    """Points of one support with the rows that they act through, and where formulas that jump are evaluated.

    ``slope`` are the values at which a slope is held, NaN where the rows are of the deflection; ``shared`` and
    ``numbers`` are those of `ContactPoints`.
    """

    rows: Rows
    positions: Floats
    within: Floats
    weights: Floats
    slope: Floats
    shared: Ints
    numbers: Ints

    @classmethod
    def of(cls, rows: Rows, points: LineQuadrature, slope: Floats | float = np.nan, numbers: Ints | int = 0) -> _Acting:
        """Rows of points of the plate."""
        count = len(rows)
        values = np.broadcast_to(slope, count), np.full((count, 4), -1), np.broadcast_to(numbers, count)
        return cls(rows, points.positions, points.within, points.weights, *values)


@dataclass(frozen=True, eq=False)
class Ground:
    """A plate on its mesh, how it is held at nodes and how stiff it is, for supports to act on.

    What acts between it and another plate takes the deflection over that one, which is ``beneath``, and whose elements
    are then numbered behind those of this one.
    """

    shape: Plate
    mesh: Mesh
    plate: _core.Plate
    held: Held
    stiffness: PlateStiffness
    beneath: Ground | None = None

    def rows(self, points: Quadrature, field: int) -> Rows:
        """Rows of the deflection, or of a slope, at points."""
        coefficients, _ = self.plate.interpolation_rows(points.elements, points.xi, field)
        rows = Rows(points.elements, coefficients)
        if self.beneath is None:
            return rows
        where = self.beneath.mesh.nearest(points.positions)
        coefficients, _ = self.beneath.plate.interpolation_rows(where.elements, where.xi, field)
        return rows.beside(Rows(where.elements, -coefficients), len(self.mesh.elements))

    def means(self, placed: Placed, field: int = 0) -> Rows:
        """Rows of the mean deflection, or of a mean slope, over each footprint of a support."""
        rows = means_over(self.mesh, self.held.frames, placed.footprints, field)
        if self.beneath is None:
            return rows
        mesh, frames = self.beneath.mesh, self.beneath.held.frames
        below = [area_quadrature(mesh, shape, _GAUSS) for shape in placed.support.where.footprints]
        return rows.beside(-means_over(mesh, frames, below, field), len(self.mesh.elements))


def springs_and_contacts(
    shape: Plate,
    mesh: Mesh,
    plate: _core.Plate,
    held: Held,
    stiffness: PlateStiffness,
    supports: Sequence[Placed],
    problems: Problems,
) -> tuple[Springs, ContactPoints]:
    """Partition the points of all supports, beyond the dofs that these hold at nodes."""
    tightened = [placed.index for placed in supports if placed.support.is_bolt]
    points = points_of(Ground(shape, mesh, plate, held, stiffness), supports, problems)
    return partition(points, np.array(tightened, np.int64))


def points_of(on: Ground, supports: Sequence[Placed], problems: Problems) -> ContactPoints:
    """Points with row and law of every support, beyond the dofs that it holds at nodes.

    Between a plate and the one beneath it their rows are over both, see `Rows.beside`.
    """
    result = [ContactPoints.none()]
    for placed in supports:
        with problems.collected():
            for acting in _acting(on, placed):
                result += _with_law(on, placed, acting)
            if placed.support.rotational_stiffness is not None:
                result += _turning(on, placed, placed.support.rotational_stiffness)
    return ContactPoints.join(result)


def _places(support: Support, acting: _Acting) -> Floats:
    """Where formulas are evaluated (q, 2): beside a jump within the element that a point is of."""
    return acting.within if _jumps(support) else acting.positions


def _require_covered(on: Ground, placed: Placed) -> None:
    """Refuse a table of stiffness that does not cover all of the support, by the covered part of its measure."""
    field, where, place = placed.support.stiffness, placed.support.where, placed.place
    if not isinstance(field, Field) or field.outside is not None:
        return
    over: Quadrature
    if placed.points is not None:
        measure, over = "points", placed.points
    elif where.key == "area":
        measure, over = "area", in_area(on.mesh, on.shape, where.region, place, _GAUSS, levels=[field.depth])
    else:
        line = on.mesh, on.shape, where, place, placed.sides, _GAUSS
        measure, over = "length", along_curve(*line, levels=[field.depth])
    inside = field.depth(over.positions) >= 0.0
    if inside.all():
        return
    reach = f"; the table reaches from {point(field.box[0])} to {point(field.box[1])}"
    if placed.points is not None:
        reach = f"; {point(over.positions[int(inside.argmin())])} lies beyond the table"
    part = 100.0 * float(over.weights[inside].sum() / over.total)
    raise InputError(
        f"{field} covers {part:.4g} % of the {measure} of {placed.support.name}{reach}. It must cover all of the "
        'support. Add points, or say what holds beyond them: outside = "nearest", the value at the nearest place of '
        "the table, or outside = 0, no stiffness.",
        place=_stiffness_place(placed, field),
    )


def _stiffness_place(placed: Placed, field: Field) -> Place:
    return (*placed.place, "stiffness", *(["file"] if field.file else []))


def _acting(on: Ground, placed: Placed) -> list[_Acting]:
    """Points and rows of one support, for what no node holds."""
    _require_covered(on, placed)
    if placed.support.area is not None:
        return [_on_area(on, placed)]
    result = _at_points(on, placed, placed.points) if placed.points is not None else _along_line(on, placed)
    return [_on_soil(placed, acting) for acting in result]


def _on_soil(placed: Placed, acting: _Acting) -> _Acting:
    """Leave out points at which a field has no stiffness; one that the input names must have some."""
    field = placed.support.stiffness
    if not isinstance(field, Field):
        return acting
    place = _stiffness_place(placed, field)
    some = field(*_places(placed.support, acting).T, place=place) > 0.0
    part = float(acting.weights[some].sum() / acting.weights.sum())
    if placed.points is not None and not some.all():
        at = point(acting.positions[int(some.argmin())])
        raise InputError(f"{field} gives no stiffness at {at}. Leave that point out, or give it one.", place=place)
    if part <= _LEAST_PART:
        raise InputError(
            f"{field} gives a stiffness to {part:.2g} of the support; it must be more than {_LEAST_PART:g}. Make the "
            "support smaller, or give more of it a stiffness: beyond the points of a table there is none.",
            place=place,
        )
    return acting.pick(some)


def _at_points(on: Ground, placed: Placed, points: LineQuadrature) -> list[_Acting]:
    support, deflection = placed.support, placed.support.holds_w
    at_nodes = (placed.nodes >= 0) & ~on.held.bodies.inside[placed.nodes]
    at_nodes &= holds_deflection(support) or not deflection
    (numbers,) = np.nonzero(~at_nodes)
    points = points.pick(numbers)
    rows = on.means(placed) if placed.footprints else on.rows(points, 0)
    result = [_Acting.of(rows, points, numbers=numbers)] if deflection else []
    if "slope" in support.fixed:
        rotation = prescribed_rotations(placed, points.positions)
        result += [_Acting.of(on.rows(points, part), points, rotation[:, part - 1], numbers) for part in (1, 2)]
    return result


def _along_line(on: Ground, placed: Placed) -> list[_Acting]:
    """Points along an edge, a line or a circle; where a mesh follows it, those of nodes that are not held."""
    support, mesh = placed.support, on.mesh
    in_means, turned = False, None
    if support.modulus is not None:
        at_ends = 0 if acts_both_ways(support) else _GAUSS + 1
        line = (mesh, on.shape, support.where, placed.place, placed.sides)
        points = along_curve(*line, _GAUSS, at_ends, _steps(support))
    elif placed.sides is None:
        at_ends = _GAUSS_RIGID if can_let_go(support) else 0
        points = _once(mesh, along_curve(mesh, on.shape, support.where, placed.place, None, _GAUSS_RIGID, at_ends))
        in_means = not can_let_go(support) and len(np.unique(points.elements)) >= _ROW
    else:
        nodes, lengths = edge_nodes(mesh, placed.sides)
        # Nodes hold nothing against another plate.
        held_there = on.beneath is None and (bool(support.fixed) or holds_deflection(support))
        some = np.flatnonzero(on.held.bodies.inside[nodes] | (not held_there))
        if not len(some):
            return []
        at = mesh.points[nodes[some]]
        where = mesh.locate(at)
        points = LineQuadrature(where.elements, where.xi, lengths[some], at, np.zeros_like(at), at)
        if support.fixed:
            tangents = tangents_at_nodes(mesh, placed.sides)
            each = [tangents[node] for node in nodes[some].tolist()]
            number = np.repeat(np.arange(len(each)), [len(directions) for directions in each])
            turned = replace(points.pick(number), tangents=np.concatenate(each))
    result = [_Acting.of(on.rows(points, 0), points)] if support.holds_w else []
    turned = points if turned is None else turned
    tx, ty = turned.tangents.T
    for component, directions in (("slope", (ty, -tx)), ("twist", (tx, ty))):
        if component in support.fixed:
            along = np.column_stack(directions)
            x, y = on.rows(turned, 1), on.rows(turned, 2)
            rows = x.turned(along, y)
            rotation = prescribed_rotations(placed, turned.positions)
            result.append(_Acting.of(rows, turned, (along * rotation).sum(axis=1)))
    means = [_means(on, one) for one in result] if in_means else ()
    return [replace(one, shared=np.full_like(one.shared, -1)) for one in means] or result


def _jumps(support: Support) -> list[Level]:
    """Where an elastic support's stiffness, limit, gap or settlement jumps; a rigid one's points are what they are."""
    if support.modulus is None:
        return []
    formulas = support.modulus, support.limit, support.gap, support.settlement
    return [level for formula in formulas if formula is not None for level in formula.levels if level.jumps]


def _steps(support: Support) -> list[Level]:
    """Curves at which pieces of the quadrature end: jumps, and kinks of a limit and of the stiffness beside it.

    The limit load is the integral of the limit over the soil.
    """
    if support.modulus is None or support.limit is None:
        return _jumps(support)
    kinks = [one for formula in (support.modulus, support.limit) for one in formula.levels if not one.jumps]
    return _jumps(support) + kinks


def _on_area(on: Ground, placed: Placed) -> _Acting:
    """Points of an area, or means of elements where it is as good as rigid.

    The points of an area that acts one way only reach its outline.
    """
    support, place = placed.support, placed.place
    mesh, elastic, one_sided = on.mesh, support.modulus is not None, not acts_both_ways(support)
    # Where nodes hold the plate a point of the outline could do nothing.
    free_corners = np.asarray(~on.held.dofs[3 * mesh.elements[:, :4]].any(axis=1))
    to_outline = free_corners if elastic and one_sided else None
    over = in_area(mesh, on.shape, support.where.region, place, _GAUSS, to_outline, _steps(support), _OFF, follow=True)
    within = over.positions
    if _jumps(support):
        within = mesh.map(over.elements, mesh.inward(over.elements, over.xi, INSIDE))
    points = LineQuadrature(over.elements, over.xi, over.weights, over.positions, np.zeros_like(over.positions), within)
    through = _on_soil(placed, _Acting.of(on.rows(points, 0), points))
    covered = np.bincount(through.rows.elements, minlength=len(mesh.elements)) > 0
    if elastic and not can_let_go(support):
        return through
    if support.modulus is not None:
        stiffness = support.modulus(*through.within.T, above=0.0, place=(*place, "stiffness"))
        if (stiffness < _STIFF * on.stiffness.in_waves[through.rows.elements]).all():
            if not one_sided:
                return through
            return _with(
                on, placed, through, missing_corners(mesh, on.shape, support.where, covered, through.positions)
            )
    return _with(on, placed, _means(on, through), outline_points(mesh, on.shape, support.where, covered))


def _with_law(on: Ground, placed: Placed, acting: _Acting) -> list[ContactPoints]:
    """Give points the law of their support; free travel both ways makes one table for each direction."""
    support, place, count = placed.support, placed.place, len(acting)
    at = _places(support, acting)
    slope = ~np.isnan(acting.slope)
    settlement = acting.slope if slope.any() else support.settlement(*at.T, place=(*place, "settlement"))
    gap = support.gap(*at.T, at_least=0.0, place=(*place, "gap"))
    both = (support.fix is not None or support.resists == "both") and not gap.any()
    elastic, stiffness = np.zeros(count, np.bool_), np.ones(count)
    if support.modulus is not None:
        most = STIFFEST_SPRING * on.stiffness.in_shear[acting.rows.elements]
        stiffness = acting.weights * support.modulus(*at.T, above=0.0, place=(*place, "stiffness"))
        if support.law is not None and (stiffness >= most).any():
            steepest = float(support.modulus(0.0, 0.0))
            raise InputError(
                f"found a part that rises by {steepest:.4g} for a travel of 1, which is as good as rigid. Draw it "
                "without travel, or less steep.",
                place=(*place, "law"),
            )
        elastic = stiffness < most
        if both and support.limit is None:
            # A spring, however stiff, is no equation.
            elastic, stiffness = np.ones(count, np.bool_), np.minimum(stiffness, most)
    laws: tuple[Law, ...] = LAWS
    law = np.where(elastic, *(LAWS.index(law) for law in laws_of(both=both, limited=support.limit is not None)))
    scale, unit = np.where(elastic, stiffness, 1.0), np.ones(count)
    if support.limit is not None:
        scale = acting.weights * support.limit(*at.T, above=0.0, place=(*place, "limit"))
        unit = np.where(elastic, scale / stiffness, 1.0)
    if support.law is not None:
        laws, law = (Law.drawn(support.law, both=both),), np.zeros(count, np.int64)
        scale, unit = acting.weights, np.ones(count)
    ways = [1.0] * (both or support.resists != "up") + [-1.0] * (not both and support.resists != "down")
    return [_points(placed, acting, way, gap, settlement, (law, scale, unit), laws, slope) for way in ways]


def _turning(on: Ground, placed: Placed, stiffness: Sequence[Expression]) -> list[ContactPoints]:
    """Springs on the slope across a line, or on both slopes at points, interpolated from the nodes as in results."""
    mesh, support, place = on.mesh, placed.support, (*placed.place, "rotational_stiffness")
    if placed.points is None:
        line = (mesh, on.shape, support.where, placed.place, placed.sides)
        points = along_curve(*line, _GAUSS, 0, [level for level in stiffness[0].levels if level.jumps])
        ty, tx = points.tangents[:, 1], points.tangents[:, 0]
        numbers, each = np.zeros(len(points.elements), np.int64), [(stiffness[0], np.column_stack([ty, -tx]))]
    else:
        points, numbers = placed.points, np.arange(len(placed.points.elements))
        # What turns about x is the slope along y.
        axes = [np.broadcast_to(axis, (len(numbers), 2)) for axis in ((0.0, 1.0), (1.0, 0.0))]
        each = list(zip((stiffness[0], stiffness[-1]), axes, strict=True))
    x, y = (
        on.means(placed, field)
        if placed.footprints
        else interpolated(mesh, on.held.frames, points.elements, points.xi, field)
        for field in (1, 2)
    )
    rotation = prescribed_rotations(placed, points.positions)
    most = STIFFEST_SPRING * on.stiffness.in_shear[points.elements] * mesh.element_area[points.elements]
    count, (linear, _) = len(points.elements), laws_of(both=True, limited=False)
    result = []
    for formula, along in each:
        rows = x.turned(along, y)
        values = points.weights * formula(*points.within.T, above=0.0, place=place)
        graph = np.zeros(count, np.int64), np.minimum(values, most), np.ones(count)
        acting = _Acting.of(rows, points, (along * rotation).sum(axis=1), numbers)
        slope = np.ones(count, np.bool_)
        result.append(_points(placed, acting, 1.0, np.zeros(count), acting.slope, graph, (linear,), slope))
    return result


def _points(
    placed: Placed,
    acting: _Acting,
    way: float,
    gap: Floats,
    settlement: Floats,
    graph: tuple[Ints, Floats, Floats],
    laws: tuple[Law, ...],
    slope: Bools,
) -> ContactPoints:
    """Points that push the plate one way; ``graph`` is the law's number, scale and unit of each (m,)."""
    count = len(acting)
    return ContactPoints(
        acting.rows if way > 0 else -acting.rows,
        gap + way * settlement,
        way * settlement,
        np.zeros(count),
        np.zeros(count),
        *graph,
        np.full(count, way),
        slope,
        acting.positions,
        acting.weights,
        np.full(count, placed.index, np.int64),
        acting.shared,
        acting.numbers,
        laws,
    )


def _means(on: Ground, through: _Acting) -> _Acting:
    """The mean of every element; see `places`."""
    elements, inverse = np.unique(through.rows.elements, return_inverse=True)
    area = np.bincount(inverse, through.weights).astype(np.float64)

    def mean(values: Floats) -> Floats:
        return np.stack([np.bincount(inverse, through.weights * column) / area for column in values.T], axis=1)

    shared = np.column_stack([elements, np.full((len(elements), 3), -1)])
    middle, slope = mean(through.positions), mean(through.slope[:, None])[:, 0]
    rows = Rows(elements, mean(through.rows.coefficients))
    if on.beneath is not None:
        first = len(on.mesh.elements)
        _, other = through.rows.parted(first)
        parts = (through.weights / area[inverse])[:, None] * other.coefficients
        rows = rows.beside(Rows.over(inverse, other.elements, parts, on.beneath.mesh.elements), first)
    return _Acting(rows, middle, middle, area, slope, shared, np.zeros(len(elements), np.int64))


def _with(on: Ground, placed: Placed, acting: _Acting, result: OutlinePoints) -> _Acting:
    """Give points on the outline a part of what the support has in the elements that share them."""
    if isinstance(field := placed.support.stiffness, Field):
        some = field(*result.positions.T) > 0.0
        result = OutlinePoints(result.positions[some], result.shared[some])
    if not len(result.positions):
        return acting
    mesh, where = on.mesh, result.shared[:, 0]
    xi = mesh.invert(where, result.positions)
    within = mesh.map(where, mesh.inward(where, xi, INSIDE))
    nowhere = np.zeros_like(xi)
    points = LineQuadrature(where, xi, np.zeros(len(xi)), result.positions, nowhere, within)
    outer = replace(_Acting.of(on.rows(points, 0), points), shared=result.shared)
    dofs = Rows(outer.rows.elements, outer.rows.coefficients).dofs(mesh.elements)
    outer = outer.pick(np.asarray(((np.abs(outer.rows.coefficients) > _NONE) & ~on.held.dofs[dofs]).any(axis=1)))
    area = np.bincount(acting.rows.elements, acting.weights, len(mesh.elements)).astype(np.float64)
    some = outer.shared >= 0
    count = np.bincount(outer.shared[some], minlength=len(area))
    parts = np.where(some, (np.minimum(STRIP, MOST / np.maximum(count, 1)) * area)[outer.shared], 0.0)
    given = np.bincount(outer.shared[some], parts[some], len(area))
    kept = 1.0 - given[acting.rows.elements] / area[acting.rows.elements]
    in_means = (acting.shared >= 0).any()
    outer = replace(outer, weights=parts.sum(axis=1), shared=np.where(in_means, outer.shared, -1))
    return _Acting.join([replace(acting, weights=kept * acting.weights), outer])


def _once(mesh: Mesh, points: LineQuadrature) -> LineQuadrature:
    """Points of a line each once, where its pieces share them."""
    at = np.round(points.positions / mesh.near.place)
    _, first, point = np.unique(at, axis=0, return_index=True, return_inverse=True)
    weights = np.bincount(point.ravel(), points.weights).astype(np.float64)[point.ravel()]
    return replace(points, weights=weights).pick(np.sort(first))
