"""Points of supports, each with a row of G and a law; partition of the points into springs and contact points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from signorini import _core
from signorini.discretise.held import Held, held_at, tangents_at_nodes
from signorini.discretise.laws import (
    Graphs,
    acts_both_ways,
    can_let_go,
    field_of,
    graphs_of,
    jumps_of,
    modulus_at,
    on_soil,
    partition,
    slopes_at,
    steps_of,
    stiffness_place,
)
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
from signorini.discretise.points import ContactPoints
from signorini.discretise.quadrature import GAUSS, LineQuadrature, Quadrature, area_quadrature
from signorini.discretise.quadrature.stepped import INSIDE
from signorini.discretise.rows import Floats, Ints, Rows, Table, interpolated
from signorini.discretise.thickness import PlateStiffness
from signorini.errors import InputError, Problems, point
from signorini.mesh import Mesh
from signorini.model import Plate, Support

_GAUSS_RIGID = 2
"""Number of points per element on a rigid line that crosses elements.

More points could outnumber the free dofs of an element.
"""
_ROW = 3
"""Least number of elements across which a rigid two-sided line acts on element means.

Two points in each element of a row would lock the plate, with reactions determined by rounding. In fewer elements, the
means would not hold the slopes of the plate.
"""
_STIFF = 1e3
"""Least stiffness of an elastic area that acts on element means, relative to `PlateStiffness.in_waves`.

Several points would outnumber the free deflections of an element. The variation of the deflection about its mean within
an element is part of the mesh error.
"""
STIFFEST_SPRING = 1e8
"""Largest stiffness of a spring relative to the plate's stiffness in shear.

A stiffer spring changes no result in eight digits, but increases rounding in K. A stiffer one-sided spring becomes
rigid, since its force would be the rounding of penetrations.
"""
_LEAST_PART = 0.1
"""Least part of a support (of its points, length or area) to which a table must give a stiffness.

A smaller part suggests wrong units of the table.
"""
_NONE = 1e-12
"""Largest coefficient of a row that counts as zero; the shape functions in a row have the sum 1."""

_OFF = 0.02
"""Largest deviation of cuts along curved steps of a support, relative to an element's side.

A smaller deviation would make too many points.
"""


_BEYOND = 0.05
"""Largest distance of a point from the lower of two plates, relative to the size of the upper plate's element.

Outlines of both plates are approximated by parabolas, or by polygons with a point per degree.
"""


@dataclass(frozen=True, eq=False)
class _SupportPoints(Table):
    """Points of one support with their rows, before they get the support's law.

    ``within`` (q, 2) are points inside the element, beside a jump, at which formulas are evaluated. ``slope`` (q,) are
    prescribed slopes, NaN where the row is the deflection. ``shared`` and ``numbers`` are as in `ContactPoints`.
    """

    rows: Rows
    positions: Floats
    within: Floats
    weights: Floats
    slope: Floats
    shared: Ints
    numbers: Ints

    @classmethod
    def of(
        cls, rows: Rows, points: LineQuadrature, slope: Floats | float = np.nan, numbers: Ints | int = 0
    ) -> _SupportPoints:
        """Make the points of a support from quadrature points and their rows."""
        count = len(rows)
        values = np.broadcast_to(slope, count), np.full((count, 4), -1), np.broadcast_to(numbers, count)
        return cls(rows, points.positions, points.within, points.weights, *values)


@dataclass(frozen=True, eq=False)
class SupportedPlate:
    """A plate on its mesh with held dofs and stiffness, on which supports act.

    If a plate is ``beneath``, rows are differences of the two plates' deflections, and the lower plate's element
    indices follow those of this plate.
    """

    shape: Plate
    mesh: Mesh
    core: _core.Plate
    held: Held
    stiffness: PlateStiffness
    beneath: SupportedPlate | None = None

    def rows(self, points: Quadrature, field: int) -> Rows:
        """Rows of w, θx or θy (``field`` 0, 1, 2) at points."""
        coefficients, _ = self.core.interpolation_rows(points.elements, points.xi, field)
        rows = Rows(points.elements, coefficients)
        if self.beneath is None:
            return rows
        where = self.beneath.mesh.nearest(points.positions)
        apart = np.hypot(*(self.beneath.mesh.map(where.elements, where.xi) - points.positions).T)
        off = apart > _BEYOND * np.sqrt(self.mesh.element_area[points.elements])
        if off.any():
            raise InputError(
                f"{point(points.positions[int(off.argmax())])} is on the upper plate, but off the lower one: beyond an "
                "edge or in a hole. Leave this part out."
            )
        coefficients, _ = self.beneath.core.interpolation_rows(where.elements, where.xi, field)
        return rows.extended(Rows(where.elements, -coefficients), len(self.mesh.elements))

    def means(self, placed: Placed, field: int = 0) -> Rows:
        """Rows of the mean of w, θx or θy (``field`` 0, 1, 2) over each footprint of a support."""
        rows = means_over(self.mesh, self.held.frames, placed.footprints, field)
        if self.beneath is None:
            return rows
        mesh, frames = self.beneath.mesh, self.beneath.held.frames
        below = [area_quadrature(mesh, shape, GAUSS) for shape in placed.support.where.footprints]
        lower = means_over(mesh, frames, below, field)
        if not field:
            # The meshes approximate a round hole in the footprint differently. With the lower plate's mean moved to the
            # upper footprint's centroid, the forces on both plates have one line of action.
            arms = np.array(
                [above.centroid - own.centroid for above, own in zip(placed.footprints, below, strict=True)]
            )
            x, y = (means_over(mesh, frames, below, part) for part in (1, 2))
            lower += x.slope_along(arms, y)
        return rows.extended(-lower, len(self.mesh.elements))


def require_on_plate(plate: SupportedPlate, placed: Placed) -> None:
    """Refuse a support's area, line or circle that leaves the plate; areas may cover holes."""
    where = placed.support.where
    if placed.support.area is not None:
        in_area(plate.mesh, plate.shape, where.region, placed.place, GAUSS)
    elif where.curve is not None:
        along_curve(plate.mesh, plate.shape, where, placed.place, placed.sides, GAUSS)


def springs_and_contacts(
    plate: SupportedPlate, supports: Sequence[Placed], problems: Problems
) -> tuple[ContactPoints, ContactPoints]:
    """Divide the points of all supports into springs and contact points; held dofs, in ``plate.held``, are left out."""
    points = points_of(plate, supports, problems)
    bolts = [placed.index for placed in supports if placed.support.is_bolt]
    moved = ~points.slope & np.isin(points.support, np.array(bolts, np.int64))
    _, springs, contacts = partition(points.two_sided, points.compliance > 0.0, np.zeros_like(moved), moved)
    return points.pick(springs), points.pick(contacts)


def points_of(plate: SupportedPlate, supports: Sequence[Placed], problems: Problems) -> ContactPoints:
    """Points of every support with row and law, except points that are held dofs.

    Rows of supports between two plates are over both plates, see `Rows.extended`.
    """
    result = [ContactPoints.none()]
    for placed in supports:
        with problems.collected():
            for acting in _acting(plate, placed):
                result += _with_law(plate, placed, acting)
            result += _turning(plate, placed)
    return ContactPoints.join(result)


def _places(support: Support, acting: _SupportPoints) -> Floats:
    """Positions (q, 2) at which formulas are evaluated: inside each point's element if a formula jumps."""
    return acting.within if jumps_of(support) else acting.positions


def _require_covered(plate: SupportedPlate, placed: Placed) -> None:
    """Refuse a table of stiffness that does not cover the whole support."""
    field, where, place = field_of(placed.support), placed.support.where, placed.place
    if field is None or field.outside is not None:
        return
    quadrature: Quadrature
    if placed.points is not None:
        measure, quadrature = "points", placed.points
    elif where.key == "area":
        measure, quadrature = (
            "area",
            in_area(plate.mesh, plate.shape, where.region, place, GAUSS, levels=[field.depth]),
        )
    else:
        line = plate.mesh, plate.shape, where, place, placed.sides, GAUSS
        measure, quadrature = "length", along_curve(*line, levels=[field.depth])
    inside = field.depth(quadrature.positions) >= 0.0
    if inside.all():
        return
    reach = f"; the table reaches from {point(field.box[0])} to {point(field.box[1])}"
    if placed.points is not None:
        reach = f"; {point(quadrature.positions[int(inside.argmin())])} lies beyond the table"
    part = 100.0 * float(quadrature.weights[inside].sum() / quadrature.total)
    raise InputError(
        f"{field} covers {part:.4g} % of the {measure} of {placed.support.name}{reach}. The table must cover the whole "
        'support. Add points, or give the value outside the table: outside = "nearest" takes the nearest value, '
        "outside = 0 no stiffness.",
        place=stiffness_place(placed.support, placed.place),
    )


def _acting(plate: SupportedPlate, placed: Placed) -> list[_SupportPoints]:
    """Points of one support with their rows, except points that are held dofs."""
    _require_covered(plate, placed)
    if placed.support.area is not None:
        return [_on_area(plate, placed)]
    result = _at_points(plate, placed, placed.points) if placed.points is not None else _along_line(plate, placed)
    return [_on_soil(placed, acting) for acting in result]


def _on_soil(placed: Placed, acting: _SupportPoints) -> _SupportPoints:
    """Leave out points at which a table gives no stiffness; if the input lists these points, refuse this."""
    field, place = field_of(placed.support), stiffness_place(placed.support, placed.place)
    if field is None:
        return acting
    supported = on_soil(placed.support, _places(placed.support, acting), placed.place)
    part = float(acting.weights[supported].sum() / acting.weights.sum())
    if placed.points is not None and not supported.all():
        position = point(acting.positions[int(supported.argmin())])
        raise InputError(
            f"{field} gives no stiffness at {position}. Leave that point out, or give it a stiffness.", place=place
        )
    if part <= _LEAST_PART:
        raise InputError(
            f"{field} gives a stiffness to {part:.2g} of the support; this part must be more than {_LEAST_PART:g}. "
            "Make the support smaller, or give a larger part a stiffness: outside a table the stiffness is 0.",
            place=place,
        )
    return acting.pick(supported)


def _at_points(plate: SupportedPlate, placed: Placed, points: LineQuadrature) -> list[_SupportPoints]:
    support, deflection = placed.support, placed.support.holds_w
    (numbers,) = np.nonzero(~held_at(placed, placed.nodes, plate.held.bodies))
    points = points.pick(numbers)
    rows = plate.means(placed) if placed.footprints else plate.rows(points, 0)
    result = [_SupportPoints.of(rows, points, numbers=numbers)] if deflection else []
    if "slope" in support.fixed:
        rotation = slopes_at(placed.support, points.positions, placed.place)
        result += [
            _SupportPoints.of(plate.rows(points, part), points, rotation[:, part - 1], numbers) for part in (1, 2)
        ]
    return result


def _along_line(plate: SupportedPlate, placed: Placed) -> list[_SupportPoints]:
    """Points along an edge, a line or a circle.

    A rigid line that the mesh follows acts at nodes, except nodes that are held dofs.
    """
    support, mesh = placed.support, plate.mesh
    in_means, turned = False, None
    if support.is_elastic:
        at_ends = 0 if acts_both_ways(support) else GAUSS + 1
        line = (mesh, plate.shape, support.where, placed.place, placed.sides)
        points = along_curve(*line, GAUSS, at_ends, steps_of(support))
    elif placed.sides is None:
        at_ends = _GAUSS_RIGID if can_let_go(support) else 0
        points = _once(mesh, along_curve(mesh, plate.shape, support.where, placed.place, None, _GAUSS_RIGID, at_ends))
        in_means = not can_let_go(support) and len(np.unique(points.elements)) >= _ROW
    else:
        nodes, lengths = edge_nodes(mesh, placed.sides)
        free = np.flatnonzero(~held_at(placed, nodes, plate.held.bodies))
        if not len(free):
            return []
        positions = mesh.points[nodes[free]]
        where = mesh.locate(positions)
        points = LineQuadrature(where.elements, where.xi, lengths[free], positions, np.zeros_like(positions), positions)
        if support.fixed:
            tangents = tangents_at_nodes(mesh, placed.sides)
            tangents_of_nodes = [tangents[node] for node in nodes[free].tolist()]
            number = np.repeat(np.arange(len(tangents_of_nodes)), [len(directions) for directions in tangents_of_nodes])
            turned = replace(points.pick(number), tangents=np.concatenate(tangents_of_nodes))
    result = [_SupportPoints.of(plate.rows(points, 0), points)] if support.holds_w else []
    turned = points if turned is None else turned
    tx, ty = turned.tangents.T
    for component, directions in (("slope", (ty, -tx)), ("twist", (tx, ty))):
        if component in support.fixed:
            along = np.column_stack(directions)
            x, y = plate.rows(turned, 1), plate.rows(turned, 2)
            rows = x.slope_along(along, y)
            rotation = slopes_at(support, turned.positions, placed.place)
            result.append(_SupportPoints.of(rows, turned, (along * rotation).sum(axis=1)))
    means = [_means(plate, applied) for applied in result] if in_means else ()
    return [replace(applied, shared=np.full_like(applied.shared, -1)) for applied in means] or result


def _on_area(plate: SupportedPlate, placed: Placed) -> _SupportPoints:
    """Points of an area: Gauss points of an elastic area, element means and outline points of a nearly rigid area.

    One-sided areas have points on their outline.
    """
    support, place = placed.support, placed.place
    mesh, elastic, one_sided = plate.mesh, support.is_elastic, not acts_both_ways(support)
    # Elements with a held corner get no points on the outline, since these might have no free dof.
    free_corners = np.asarray(~plate.held.dofs[3 * mesh.elements[:, :4]].any(axis=1))
    to_outline = free_corners if elastic and one_sided else None
    quadrature = in_area(
        mesh, plate.shape, support.where.region, place, GAUSS, to_outline, steps_of(support), _OFF, follow=True
    )
    elements, xi, weights, positions = quadrature.elements, quadrature.xi, quadrature.weights, quadrature.positions
    inner = mesh.map(elements, mesh.inward(elements, xi, INSIDE)) if jumps_of(support) else positions
    points = LineQuadrature(elements, xi, weights, positions, np.zeros_like(positions), inner)
    through = _on_soil(placed, _SupportPoints.of(plate.rows(points, 0), points))
    covered = np.bincount(through.rows.elements, minlength=len(mesh.elements)) > 0
    if elastic and not can_let_go(support):
        return through
    modulus, geometry = modulus_at(support, through.within, place), (mesh, plate.shape, support.where, covered)
    stiff = _STIFF * plate.stiffness.in_waves[through.rows.elements]
    if modulus is None or not (modulus < stiff).all():
        return _with(plate, placed, _means(plate, through), outline_points(*geometry))
    return _with(plate, placed, through, missing_corners(*geometry, through.positions)) if one_sided else through


def _with_law(plate: SupportedPlate, placed: Placed, acting: _SupportPoints) -> list[ContactPoints]:
    """Give points the law of their support: one table, or two if the support has a gap in both directions."""
    stiffest = STIFFEST_SPRING * plate.stiffness.in_shear[acting.rows.elements]
    positions = _places(placed.support, acting)
    graphs = graphs_of(placed.support, positions, acting.weights, stiffest, acting.slope, placed.place)
    return [_points(placed, acting, graph) for graph in graphs]


def _turning(plate: SupportedPlate, placed: Placed) -> list[ContactPoints]:
    """Rotational springs on the slope normal to a line, or on both slopes at points; empty if the support has none."""
    mesh, support, place = plate.mesh, placed.support, (*placed.place, "rotational_stiffness")
    stiffness = support.rotational
    if not stiffness:
        return []
    if placed.points is None:
        line = (mesh, plate.shape, support.where, placed.place, placed.sides)
        points = along_curve(*line, GAUSS, 0, [level for level in stiffness[0].levels if level.jumps])
        ty, tx = points.tangents[:, 1], points.tangents[:, 0]
        numbers, stiffnesses = np.zeros(len(points.elements), np.int64), [(stiffness[0], np.column_stack([ty, -tx]))]
    else:
        points, numbers = placed.points, np.arange(len(placed.points.elements))
        # A rotation about x is the slope along y.
        axes = [np.broadcast_to(axis, (len(numbers), 2)) for axis in ((0.0, 1.0), (1.0, 0.0))]
        stiffnesses = list(zip((stiffness[0], stiffness[-1]), axes, strict=True))
    x, y = (
        plate.means(placed, field)
        if placed.footprints
        else interpolated(mesh, plate.held.frames, points.elements, points.xi, field)
        for field in (1, 2)
    )
    rotation = slopes_at(placed.support, points.positions, placed.place)
    most = STIFFEST_SPRING * plate.stiffness.in_shear[points.elements] * mesh.element_area[points.elements]
    result = []
    for formula, along in stiffnesses:
        rows = x.slope_along(along, y)
        values = points.weights * formula(*points.within.T, above=0.0, place=place)
        acting = _SupportPoints.of(rows, points, (along * rotation).sum(axis=1), numbers)
        result.append(_points(placed, acting, Graphs.linear(np.minimum(values, most), acting.slope)))
    return result


def _points(placed: Placed, acting: _SupportPoints, graphs: Graphs) -> ContactPoints:
    """Contact points of a support: its points ``acting`` with the laws ``graphs``."""
    where = ~np.isnan(acting.slope), acting.positions, acting.weights, np.full(len(acting), placed.index, np.int64)
    return ContactPoints.of(graphs, acting.rows, *where, acting.shared, acting.numbers)


def _means(plate: SupportedPlate, through: _SupportPoints) -> _SupportPoints:
    """Replace the points of each element by one point, with weighted means of their rows, positions and slopes."""
    elements, inverse = np.unique(through.rows.elements, return_inverse=True)
    area = np.bincount(inverse, through.weights).astype(np.float64)

    def mean(values: Floats) -> Floats:
        return np.stack([np.bincount(inverse, through.weights * column) / area for column in values.T], axis=1)

    shared = np.column_stack([elements, np.full((len(elements), 3), -1)])
    middle, slope = mean(through.positions), mean(through.slope[:, None])[:, 0]
    rows = Rows(elements, mean(through.rows.coefficients))
    if plate.beneath is not None:
        first = len(plate.mesh.elements)
        _, other = through.rows.split(first)
        parts = (through.weights / area[inverse])[:, None] * other.coefficients
        rows = rows.extended(Rows.summed(inverse, other.elements, parts, plate.beneath.mesh.elements), first)
    return _SupportPoints(rows, middle, middle, area, slope, shared, np.zeros(len(elements), np.int64))


def _with(plate: SupportedPlate, placed: Placed, acting: _SupportPoints, result: OutlinePoints) -> _SupportPoints:
    """Add outline points ``result``; their weights are subtracted from points of the elements around them."""
    supported = on_soil(placed.support, result.positions)
    result = OutlinePoints(result.positions[supported], result.shared[supported])
    if not len(result.positions):
        return acting
    mesh, where = plate.mesh, result.shared[:, 0]
    xi = mesh.invert(where, result.positions)
    within = mesh.map(where, mesh.inward(where, xi, INSIDE))
    nowhere = np.zeros_like(xi)
    points = LineQuadrature(where, xi, np.zeros(len(xi)), result.positions, nowhere, within)
    outer = replace(_SupportPoints.of(plate.rows(points, 0), points), shared=result.shared)
    dofs = Rows(outer.rows.elements, outer.rows.coefficients).dofs(mesh.elements)
    outer = outer.pick(np.asarray(((np.abs(outer.rows.coefficients) > _NONE) & ~plate.held.dofs[dofs]).any(axis=1)))
    area = np.bincount(acting.rows.elements, acting.weights, len(mesh.elements)).astype(np.float64)
    shared_by = outer.shared >= 0
    count = np.bincount(outer.shared[shared_by], minlength=len(area))
    parts = np.where(shared_by, (np.minimum(STRIP, MOST / np.maximum(count, 1)) * area)[outer.shared], 0.0)
    taken = np.bincount(outer.shared[shared_by], parts[shared_by], len(area))
    kept = 1.0 - taken[acting.rows.elements] / area[acting.rows.elements]
    in_means = (acting.shared >= 0).any()
    outer = replace(outer, weights=parts.sum(axis=1), shared=np.where(in_means, outer.shared, -1))
    return _SupportPoints.join([replace(acting, weights=kept * acting.weights), outer])


def _once(mesh: Mesh, points: LineQuadrature) -> LineQuadrature:
    """Merge points at which two pieces of a line meet, and add their weights."""
    rounded = np.round(points.positions / mesh.near.place)
    _, first, point = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    weights = np.bincount(point.ravel(), points.weights).astype(np.float64)[point.ravel()]
    return replace(points, weights=weights).pick(np.sort(first))
