"""All sections of a model, those across strips too, as rows over what a solution gives."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array, vstack

from signorini import _core
from signorini.base.remade import Brief
from signorini.discretise.held import Held
from signorini.discretise.points import ContactPoints, Springs
from signorini.discretise.quadrature import Quadrature, area_quadrature, curve_quadrature
from signorini.discretise.quadrature.stepped import Levels
from signorini.discretise.rows import Bools, Floats, Ints, interpolated
from signorini.discretise.sections.cut import BESIDE, Cut, cut, placed
from signorini.errors import InputError, Place, Problems, point
from signorini.mesh import Mesh
from signorini.model import Model, Support
from signorini.shapes import Polyline
from signorini.shapes.cuts import Part
from signorini.shapes.outlines import Point

_ORDER = 3
_FLAT = 1e-9
"""Part of the largest below which what an area has of an element is too narrow to tell the slope of a pressure."""
_AT_SIDE = 1e-6
"""How near a side, in reference coordinates, a point is on it."""
_BESIDE = 1e-3
"""Part of half a strip's width: where so near to its middle line there is no plate, the line is on an edge."""


@dataclass(frozen=True, eq=False)
class Spread:
    """A pressure over a region, or over the plate, at points (q, 2) of elements (q,); it may jump where levels do.

    For ``field`` 1 or 2 it is a couple per area, on θx or θy.
    """

    region: Part | None
    order: int
    levels: Levels
    pressure: Callable[[Ints, Floats], Floats]
    field: int = 0

    @classmethod
    def even(cls, shape: Part, pressure: float, field: int = 0) -> Spread:
        """One pressure over a footprint."""
        return cls(shape, _ORDER, (), lambda _, at: np.full(len(at), pressure), field)


@dataclass(frozen=True, eq=False, repr=False)
class Sections(Brief):
    """Lines (s,) across the plate: those of sections, and behind them those of strips at their stations.

    Moment, twist and shear of each are linear in nodal forces and stresses of ``elements`` (k,), in loads and in
    reactions.
    """

    mesh: Mesh
    cuts: tuple[Cut, ...]
    per: Floats
    """1, or the length (s,) over which a strip has its mean."""
    frames: Floats | None = None
    """Those of `Held`."""

    @classmethod
    def of(cls, model: Model, mesh: Mesh, plate: _core.Plate, held: Held, problems: Problems) -> Sections:
        """Cut the plate; lines that cannot be are among the problems."""
        lines: list[tuple[Sequence[Point], Place]] = [(one.line, ("section", i)) for i, one in enumerate(model.section)]
        lines += [(ends, ("strip", i)) for i, strip in enumerate(model.strip) for ends in strip.across]
        result: list[Cut] = []
        for points, place in lines:
            with problems.collected():
                _require_on_plate(mesh, points, place)
                result.append(_cut(mesh, plate, model, held, points, place))
        lengths = np.array([one.length for one in result])
        per = np.where(np.arange(len(result)) < len(model.section), 1.0, lengths)
        return cls(mesh, tuple(result), per, held.frames)

    def __len__(self) -> int:
        """Count the lines."""
        return len(self.cuts)

    @property
    def lengths(self) -> Floats:
        """Length (s,) of each line on the plate."""
        return np.array([one.length for one in self.cuts])

    @cached_property
    def elements(self) -> Ints:
        """The elements (k,) that any line meets."""
        return np.unique(np.concatenate([np.zeros(0, np.int64), *(one.elements for one in self.cuts)]))

    def within(self, plate: _core.Plate, hi: Floats, lo: Floats, curvature: Floats, couples: Floats) -> Floats:
        """Give the part (3s,) of nodal forces and stresses at displacements hi + lo."""
        if not self.cuts:
            return np.zeros(0)
        kx, ky, kxy = curvature.tolist()
        forces, stress = plate.element_forces(self.elements, hi, lo, (kx, ky, kxy), couples)
        return np.asarray(self._of_forces @ forces.ravel() + self._of_stress @ stress.ravel())

    def of_points(self, forces: Quadrature) -> Floats:
        """Give the part (3s,) of forces, down, that points weigh."""
        some = forces.pick(self._met[forces.elements])
        return self.of_rows(some.elements, some.positions, _deflections(self.mesh, some))

    def of_rows(self, elements: Ints, positions: Floats, rows: Floats) -> Floats:
        """Give the part (3s,) of forces or couples with rows (q, 24) at points (q, 2) of elements (q,)."""

        def part(one: Cut) -> Floats:
            place, some = placed(one.elements, elements)
            return np.asarray(one.work(place, rows[some], one.lefts(positions[some])).sum(axis=0))

        return self._sum(elements, part)

    def of_line(self, whole: Quadrature, divided: Callable[[Levels], Quadrature]) -> Floats:
        """Give the part (3s,) of forces along a line, that are given once more, divided where levels change sign."""
        if not self._met[whole.elements].any():
            return np.zeros(3 * len(self.cuts))
        crossed = divided([one.level for one in self.cuts])

        def part(one: Cut) -> Floats:
            place, some = placed(one.elements, whole.elements)
            here = whole.pick(some)
            left = np.where(one.divided()[place], 0.0, one.lefts(here.positions))
            result = one.work(place, _deflections(self.mesh, here), left).sum(axis=0)
            place, some = placed(one.elements, crossed.elements)
            here = crossed.pick(some)
            on_left = _deflections(self.mesh, here.times(one.lefts(here.positions)))
            return np.asarray(result - np.einsum("qcd,qd->c", one.motion[place], on_left))

        return self._sum(whole.elements, part)

    def of_spread(self, forces: Quadrature, spread: Spread) -> Floats:
        """Give the part (3s,) of a pressure of which nodal forces are those that points weigh."""
        return self._sum(forces.elements, lambda one: self._of_spread(one, forces, spread))

    def of_supports(self, supports: Sequence[Support], acting: ContactPoints | Springs) -> csr_array:
        """Give the parts (3s, m) of reactions of 1, up, along rows (m,) of supports."""
        if not (self.cuts and len(acting)):
            return csr_array((3 * len(self.cuts), len(acting)))
        prints = {}
        for index, support in enumerate(supports):
            shapes, rows = support.where.footprints, np.flatnonzero(acting.support == index)
            fields = np.zeros(len(rows), np.int64)
            # Springs about x, which act on θy, stand before those about y.
            fields[acting.slope[rows]] = np.repeat([2, 1], np.count_nonzero(acting.slope[rows]) // 2)
            for row, field in zip(rows.tolist(), fields.tolist(), strict=True) if shapes else ():
                shape = shapes[acting.numbers[row]]
                over = area_quadrature(self.mesh, shape, _ORDER)
                pressure = -float(acting.direction[row]) / over.total
                prints[row] = over.times(pressure), Spread.even(shape, pressure, field)
        parts = []
        for one in self.cuts:
            part = _of_supports(one, self.mesh, supports, acting)
            for row, (forces, spread) in prints.items():
                part[row] = self._of_spread(one, forces, spread)
            parts.append(csr_array(part.T))
        return csr_array(vstack(parts))

    def _of_spread(self, cut: Cut, forces: Quadrature, spread: Spread) -> Floats:
        """Moment, twist and shear (3,) at a line of a pressure, given by weights of points with known nodal forces."""
        place, some = placed(cut.elements, forces.elements)
        if not len(place):
            return np.zeros(3)
        nodal = self._forces(forces.pick(some), spread.field)
        left = cut.on_left(self.mesh, spread.region, spread.order, spread.levels)
        on = cut.elements[left.elements]
        density = spread.pressure(on, left.positions)
        share = self._forces(replace(left, elements=on).times(density), spread.field)
        on_left = np.einsum("qcd,qd->c", cut.motion[left.elements], share)
        return np.asarray(cut.work(place, nodal, np.zeros(len(place))).sum(axis=0) - on_left)

    def _forces(self, forces: Quadrature, field: int) -> Floats:
        """Rows (q, 24) of w, θx or θy at points, times the forces or couples that they weigh."""
        rows = interpolated(self.mesh, self.frames, forces.elements, forces.xi, field)
        return np.asarray(forces.weights[:, None] * rows.coefficients)

    def _sum(self, elements: Ints, part: Callable[[Cut], Floats]) -> Floats:
        """Parts of all lines, of what acts in some elements (q,)."""
        if not self._met[elements].any():
            return np.zeros(3 * len(self.cuts))
        return np.concatenate([part(one) for one in self.cuts])

    @cached_property
    def _met(self) -> Bools:
        met = np.zeros(len(self.mesh.elements), np.bool_)
        met[self.elements] = True
        return met

    @cached_property
    def _of_forces(self) -> csr_array:
        return self._rows([one.of_forces for one in self.cuts])

    @cached_property
    def _of_stress(self) -> csr_array:
        return self._rows([np.moveaxis(one.of_stress, -1, 1) for one in self.cuts])

    def _rows(self, parts: Sequence[Floats]) -> csr_array:
        """Rows (3s, k·n) of what every line has in its elements, (k, 3, ...) each."""
        width = int(np.prod(parts[0].shape[2:]))
        values = [part.reshape(len(part), 3, width) for part in parts]
        rows, columns = [], []
        for number, (one, value) in enumerate(zip(self.cuts, values, strict=True)):
            place = width * np.searchsorted(self.elements, one.elements)
            row = 3 * number + np.arange(3)
            rows.append(np.broadcast_to(row[:, None], value.shape).ravel())
            columns.append(np.broadcast_to(place[:, None, None] + np.arange(width), value.shape).ravel())
        every = np.concatenate([value.ravel() for value in values])
        shape = 3 * len(self.cuts), width * len(self.elements)
        return csr_array((every, (np.concatenate(rows), np.concatenate(columns))), shape=shape)


def _cut(mesh: Mesh, plate: _core.Plate, model: Model, held: Held, points: Sequence[Point], place: Place) -> Cut:
    try:
        return cut(mesh, plate, model.plate.element, held, points)
    except InputError as error:
        raise InputError(error.message, (*place, "line") if place[0] == "section" else place) from None


def _require_on_plate(mesh: Mesh, points: Sequence[Point], place: Place) -> None:
    """Refuse a line whose end is off the plate; those across strips may end in a hole, not beyond the plate."""
    ends = np.array([points[0], points[-1]])
    inward = np.array([points[1], points[-2]]) - ends
    inward *= BESIDE * mesh.size / np.hypot(*inward.T)[:, None]
    inside = mesh.locate(ends).inside | mesh.locate(ends + inward).inside
    if place[0] == "strip":
        away = 2.0 * mesh.size * (ends - ends[::-1]) / math.dist(*points)
        for end, outward in zip(np.flatnonzero(~inside), away[~inside], strict=True):
            ray = Polyline((tuple(ends[end].tolist()), tuple((ends[end] + outward).tolist())))
            inside[end] = curve_quadrature(mesh, ray, 1).total > 0.0
    if inside.all():
        return
    end = ends[~inside][0]
    at = point(end, mesh.size)
    if place[0] == "section":
        message = f"The line ends at {at}, off the plate. Let it end on the plate; it may cross holes."
        raise InputError(message, (*place, "line"))
    middle = ends.mean(axis=0)
    said = f"The strip reaches beyond the plate at {at}, beside its station {point(middle, mesh.size)}"
    if mesh.locate(middle[None] + _BESIDE * (end - middle)).inside.all():
        raise InputError(f"{said}. Make it narrower, or move its line or the line's ends.", place=(*place, "width"))
    advice = ", which is on an edge: no width is narrow enough. Let its line end short of it, or move it off."
    raise InputError(f"{said}{advice}", place=(*place, "line"))


def _of_supports(
    cut: Cut,
    mesh: Mesh,
    supports: Sequence[Support],
    acting: ContactPoints | Springs,
) -> Floats:
    """Moment, twist and shear (m, 3) of a unit reaction, up, along each row (m,); footprints are not included."""
    result = np.zeros((len(acting), 3))
    place, rows = placed(cut.elements, acting.rows.elements)
    areas = [index for index, support in enumerate(supports) if support.area is not None]
    spread = np.isin(acting.support[rows], areas) & ~_on_outline(mesh, acting, rows)
    left = np.where(spread, 0.0, cut.lefts(acting.positions[rows]))
    result[rows] = -cut.work(place, acting.rows.coefficients[rows], left)
    rows = rows[spread]
    for index in np.unique(acting.support[rows]).tolist() if cut.divided().any() else ():
        for own, shares in _shares(cut, mesh, supports[index], acting, rows[acting.support[rows] == index]):
            result[own] += shares
    return result


def _on_outline(mesh: Mesh, acting: ContactPoints | Springs, rows: Ints) -> Bools:
    """Which of some rows (q,) stand for points on the outline of an area that acts on means of elements."""
    # Others, footprints among them, need not be in their first element.
    result = acting.averaged[rows]
    rows = rows[result]
    elements = acting.rows.elements[rows]
    x, y = mesh.invert(elements, acting.positions[rows]).T
    in_triangles = np.minimum(np.minimum(x, y), 1.0 - x - y)
    inside = np.where(mesh.triangles[elements], in_triangles, 1.0 - np.maximum(np.abs(x), np.abs(y)))
    result[result] = inside < _AT_SIDE
    return result


def _shares(
    cut: Cut, mesh: Mesh, support: Support, acting: ContactPoints | Springs, own: Ints
) -> Iterator[tuple[Ints, Floats]]:
    """Yield the work that reactions of an area's rows, spread over their elements, do on the left (k, 3)."""
    covered = support.where.region
    left = cut.on_left(mesh, covered, _ORDER, ())
    over = area_quadrature(mesh.part(cut.elements), covered, _ORDER)
    rows = _deflections(mesh, replace(left, elements=cut.elements[left.elements]))
    work = np.einsum("qcd,qd->qc", cut.motion[left.elements], rows)
    for at in np.unique(left.elements).tolist():
        here, all_over = left.elements == at, over.elements == at
        mine = own[acting.rows.elements[own] == cut.elements[at]]
        middle, size = over.positions[all_over].mean(axis=0), np.sqrt(over.weights[all_over].sum())
        # The pressure that is linear over what the area has of the element, with the resultants of its points.
        linear, every, points = (
            np.column_stack([np.ones(len(p)), (p - middle) / size])
            for p in (left.positions[here], over.positions[all_over], acting.positions[mine])
        )
        inverse = np.linalg.pinv(every.T @ (over.weights[all_over, None] * every), rcond=_FLAT, hermitian=True)
        yield mine, acting.direction[mine, None] * (points @ inverse @ (linear.T @ work[here]))


def _deflections(mesh: Mesh, forces: Quadrature) -> Floats:
    """Rows (q, 24) of the deflection at points, times the forces that they weigh."""
    rows = np.zeros((len(forces), 24))
    rows[:, ::3] = forces.weights[:, None] * mesh.shape_functions(forces.elements, forces.xi)
    return rows
