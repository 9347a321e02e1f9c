"""All sections of a model, including strips: section forces as linear functions of displacements and reactions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array, vstack

from signorini import _core
from signorini.base.remade import Brief
from signorini.discretise.held import Held
from signorini.discretise.points import ContactPoints
from signorini.discretise.quadrature import GAUSS, Quadrature, area_quadrature, curve_quadrature
from signorini.discretise.quadrature.stepped import Levels
from signorini.discretise.rows import Bools, Floats, Ints, interpolated
from signorini.discretise.sections.cut import BESIDE, Cut, cut, placed
from signorini.errors import InputError, Place, Problems, point
from signorini.mesh import Mesh
from signorini.model import Model, Support
from signorini.shapes import Polyline
from signorini.shapes.cuts import Part
from signorini.shapes.outlines import Point

_FLAT = 1e-9
"""Relative rank tolerance for the fit of a linear pressure to the part of an element that an area support covers. If
the part is narrow, the pressure is constant across it.
"""
_AT_SIDE = 1e-6
"""Largest distance of a point on a side from this side, in reference coordinates."""
_BESIDE = 1e-3
"""Distance of a test point from a strip's center line, relative to half of the strip's width.

If the test point is off the plate, the center line is on an edge.
"""


@dataclass(frozen=True, eq=False)
class Spread:
    """A pressure over a region, or over the plate, as a function of elements (q,) and positions (q, 2).

    The pressure may jump where ``levels`` change sign. For ``field`` 1 or 2 it is a couple per area, on θx or θy.
    """

    region: Part | None
    order: int
    levels: Levels
    pressure: Callable[[Ints, Floats], Floats]
    field: int = 0

    @classmethod
    def even(cls, shape: Part, pressure: float, field: int = 0) -> Spread:
        """Make a constant pressure over a footprint."""
        return cls(shape, GAUSS, (), lambda _, positions: np.full(len(positions), pressure), field)


@dataclass(frozen=True, eq=False, repr=False)
class Sections(Brief):
    """Lines (s,) across the plate: the lines of sections, then the cross lines of strips at their stations.

    With `Reinforcement.face` cross lines at faces of columns follow. ``faces`` are their ends, and the stations whose
    bars are designed for them, by number among the stations of all strips.

    The section forces of a line are moment, twist and shear. They are linear in nodal forces and stresses of
    ``elements`` (k,), in loads and in reactions. ``frames`` are those of `Held`.
    """

    mesh: Mesh
    cuts: tuple[Cut, ...]
    per: Floats
    """Divisor (s,) of the section forces: 1 for sections; for strips, which have means, the length on the plate."""
    frames: Floats | None = None
    faces: tuple[tuple[int, tuple[Point, Point]], ...] = ()

    @classmethod
    def of(cls, model: Model, mesh: Mesh, plate: _core.Plate, held: Held, problems: Problems) -> Sections:
        """Cut the plate along all lines of a model; errors of lines are collected in ``problems``."""
        lines: list[tuple[Sequence[Point], Place]] = [
            (section.line, ("section", i)) for i, section in enumerate(model.section)
        ]
        lines += [(ends, ("strip", i)) for i, strip in enumerate(model.strip) for ends in strip.across]
        result: list[Cut] = []
        for points, place in lines:
            with problems.collected():
                _require_on_plate(mesh, points, place)
                result.append(_cut(mesh, plate, model, held, points, place))
        faces = list[tuple[int, tuple[Point, Point]]]()
        for station, ends, place in _face_lines(model) if model.at_faces else ():
            # Faces off the plate, as of a column flush with an edge, are skipped.
            with suppress(InputError):
                _require_on_plate(mesh, ends, place)
                result.append(_cut(mesh, plate, model, held, ends, place))
                faces.append((station, ends))
        lengths = np.array([section.length for section in result])
        per = np.where(np.arange(len(result)) < len(model.section), 1.0, lengths)
        return cls(mesh, tuple(result), per, held.frames, tuple(faces))

    def __len__(self) -> int:
        """Return the number of lines."""
        return len(self.cuts)

    @property
    def lengths(self) -> Floats:
        """Length (s,) of each line on the plate."""
        return np.array([line.length for line in self.cuts])

    @cached_property
    def elements(self) -> Ints:
        """Elements (k,) that at least one line meets."""
        return np.unique(np.concatenate([np.zeros(0, np.int64), *(line.elements for line in self.cuts)]))

    def within(self, plate: _core.Plate, hi: Floats, lo: Floats, curvature: Floats, couples: Floats) -> Floats:
        """Contribution (3s,) to the section forces of nodal forces and stresses at displacements u = hi + lo."""
        if not self.cuts:
            return np.zeros(0)
        kx, ky, kxy = curvature.tolist()
        forces, stress = plate.element_forces(self.elements, hi, lo, (kx, ky, kxy), couples)
        return np.asarray(self._of_forces @ forces.ravel() + self._of_stress @ stress.ravel())

    def of_points(self, forces: Quadrature) -> Floats:
        """Contribution (3s,) to the section forces of downward point forces, which are the weights of ``forces``."""
        met = forces.pick(self._met[forces.elements])
        return self.of_rows(met.elements, met.positions, _deflections(self.mesh, met))

    def of_rows(self, elements: Ints, positions: Floats, rows: Floats) -> Floats:
        """Contribution (3s,) to the section forces of forces or couples with rows (q, 24) at positions (q, 2)."""

        def part(line: Cut) -> Floats:
            place, indices = placed(line.elements, elements)
            return np.asarray(line.work(place, rows[indices], line.lefts(positions[indices])).sum(axis=0))

        return self._sum(elements, part)

    def of_line(self, whole: Quadrature, divided: Callable[[Levels], Quadrature]) -> Floats:
        """Contribution (3s,) to the section forces of forces along a line, with the quadrature ``whole``.

        ``divided`` maps levels to the quadrature that is divided where they change sign.
        """
        if not self._met[whole.elements].any():
            return np.zeros(3 * len(self.cuts))
        crossed = divided([line.level for line in self.cuts])

        def part(line: Cut) -> Floats:
            place, indices = placed(line.elements, whole.elements)
            forces = whole.pick(indices)
            left = np.where(line.divided()[place], 0.0, line.lefts(forces.positions))
            result = line.work(place, _deflections(self.mesh, forces), left).sum(axis=0)
            place, indices = placed(line.elements, crossed.elements)
            forces = crossed.pick(indices)
            on_left = _deflections(self.mesh, forces.times(line.lefts(forces.positions)))
            return np.asarray(result - np.einsum("qcd,qd->c", line.motion[place], on_left))

        return self._sum(whole.elements, part)

    def of_spread(self, forces: Quadrature, spread: Spread) -> Floats:
        """Contribution (3s,) to the section forces of a pressure; ``forces`` is the quadrature of its nodal forces."""
        return self._sum(forces.elements, lambda line: self._of_spread(line, forces, spread))

    def of_supports(self, supports: Sequence[Support], points: ContactPoints) -> csr_array:
        """Section forces (3s, m) due to a unit upward reaction of each contact point or spring (m,)."""
        if not (self.cuts and len(points)):
            return csr_array((3 * len(self.cuts), len(points)))
        prints = {}
        for index, support in enumerate(supports):
            if not (shapes := support.where.footprints):
                continue
            rows = np.flatnonzero(points.support == index)
            fields = np.zeros(len(rows), np.int64)
            # Springs that resist rotations about x, which act on θy, precede springs about y.
            fields[points.slope[rows]] = np.repeat([2, 1], np.count_nonzero(points.slope[rows]) // 2)
            for row, field in zip(rows.tolist(), fields.tolist(), strict=True):
                shape = shapes[points.numbers[row]]
                quadrature = area_quadrature(self.mesh, shape, GAUSS)
                pressure = -float(points.direction[row]) / quadrature.total
                prints[row] = quadrature.times(pressure), Spread.even(shape, pressure, field)
        parts = []
        for line in self.cuts:
            part = _of_supports(line, self.mesh, supports, points)
            for row, (forces, spread) in prints.items():
                part[row] = self._of_spread(line, forces, spread)
            parts.append(csr_array(part.T))
        return csr_array(vstack(parts))

    def _of_spread(self, cut: Cut, forces: Quadrature, spread: Spread) -> Floats:
        """Contribution (3,) of a pressure to moment, twist and shear at one line; ``forces`` is as for `of_spread`."""
        place, indices = placed(cut.elements, forces.elements)
        if not len(place):
            return np.zeros(3)
        nodal = self._forces(forces.pick(indices), spread.field)
        left = cut.on_left(self.mesh, spread.region, spread.order, spread.levels)
        elements = cut.elements[left.elements]
        density = spread.pressure(elements, left.positions)
        share = self._forces(replace(left, elements=elements).times(density), spread.field)
        on_left = np.einsum("qcd,qd->c", cut.motion[left.elements], share)
        return np.asarray(cut.work(place, nodal, np.zeros(len(place))).sum(axis=0) - on_left)

    def _forces(self, forces: Quadrature, field: int) -> Floats:
        """Rows (q, 24) of w, θx or θy at points, multiplied by the weights, which are forces or couples."""
        rows = interpolated(self.mesh, self.frames, forces.elements, forces.xi, field)
        return np.asarray(forces.weights[:, None] * rows.coefficients)

    def _sum(self, elements: Ints, part: Callable[[Cut], Floats]) -> Floats:
        """Section forces (3s,) of all lines due to forces in elements (q,); ``part`` computes those of one line."""
        if not self._met[elements].any():
            return np.zeros(3 * len(self.cuts))
        return np.concatenate([part(line) for line in self.cuts])

    @cached_property
    def _met(self) -> Bools:
        met = np.zeros(len(self.mesh.elements), np.bool_)
        met[self.elements] = True
        return met

    @cached_property
    def _of_forces(self) -> csr_array:
        return self._rows([line.of_forces for line in self.cuts])

    @cached_property
    def _of_stress(self) -> csr_array:
        return self._rows([np.moveaxis(line.of_stress, -1, 1) for line in self.cuts])

    def _rows(self, parts: Sequence[Floats]) -> csr_array:
        """Sparse matrix (3s, k·n) from n values in each of k elements to the forces of s sections.

        ``parts`` has the entries of each section, (elements of the section, 3, n).
        """
        width = int(np.prod(parts[0].shape[2:]))
        values = [part.reshape(len(part), 3, width) for part in parts]
        rows, columns = [], []
        for number, (line, value) in enumerate(zip(self.cuts, values, strict=True)):
            place = width * np.searchsorted(self.elements, line.elements)
            row = 3 * number + np.arange(3)
            rows.append(np.broadcast_to(row[:, None], value.shape).ravel())
            columns.append(np.broadcast_to(place[:, None, None] + np.arange(width), value.shape).ravel())
        entries = np.concatenate([value.ravel() for value in values])
        shape = 3 * len(self.cuts), width * len(self.elements)
        return csr_array((entries, (np.concatenate(rows), np.concatenate(columns))), shape=shape)


def _face_lines(model: Model) -> Iterator[tuple[int, tuple[Point, Point], Place]]:
    """Yield stations of strips within columns: number among all stations, cross line at a face, path of the strip."""
    first = np.cumsum([0, *(strip.stations for strip in model.strip)]).tolist()
    for index, strip in enumerate(model.strip):
        for _, column in model.footprints:
            yield from ((first[index] + station, ends, ("strip", index)) for station, ends in strip.faces(column))


def _cut(mesh: Mesh, plate: _core.Plate, model: Model, held: Held, points: Sequence[Point], place: Place) -> Cut:
    try:
        return cut(mesh, plate, model.plate.element, held, points)
    except InputError as error:
        raise InputError(error.message, (*place, "line") if place[0] == "section" else place) from None


def _require_on_plate(mesh: Mesh, points: Sequence[Point], place: Place) -> None:
    """Refuse a section with an end off the plate; cross lines of strips may end in a hole."""
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
    where = point(end, mesh.size)
    if place[0] == "section":
        message = f"The line ends at {where}, off the plate. Let the line end on the plate; it may cross holes."
        raise InputError(message, (*place, "line"))
    middle = ends.mean(axis=0)
    subject = f"The strip reaches beyond the plate at {where}, beside its station {point(middle, mesh.size)}"
    if mesh.locate(middle[None] + _BESIDE * (end - middle)).inside.all():
        raise InputError(f"{subject}. Make it narrower, or move its line or the line's ends.", place=(*place, "width"))
    advice = ", which is on an edge. Let the strip's line end before the edge, or move the line off the edge."
    raise InputError(f"{subject}{advice}", place=(*place, "line"))


def _of_supports(
    cut: Cut,
    mesh: Mesh,
    supports: Sequence[Support],
    points: ContactPoints,
) -> Floats:
    """Moment, twist and shear (m, 3) due to a unit upward reaction of each point (m,) without a footprint."""
    result = np.zeros((len(points), 3))
    place, rows = placed(cut.elements, points.rows.elements)
    areas = [index for index, support in enumerate(supports) if support.area is not None]
    spread = np.isin(points.support[rows], areas) & ~_on_outline(mesh, points, rows)
    left = np.where(spread, 0.0, cut.lefts(points.positions[rows]))
    result[rows] = -cut.work(place, points.rows.coefficients[rows], left)
    rows = rows[spread]
    for index in np.unique(points.support[rows]).tolist() if cut.divided().any() else ():
        for indices, shares in _shares(cut, mesh, supports[index], points, rows[points.support[rows] == index]):
            result[indices] += shares
    return result


def _on_outline(mesh: Mesh, points: ContactPoints, rows: Ints) -> Bools:
    """Whether points with the indices ``rows`` (q,) are outline points of an area that acts on means of elements."""
    # Only points of areas with means are tested: other points, such as footprints, may lie outside their element.
    result = points.averaged[rows]
    rows = rows[result]
    elements = points.rows.elements[rows]
    x, y = mesh.invert(elements, points.positions[rows]).T
    in_triangles = np.minimum(np.minimum(x, y), 1.0 - x - y)
    inside = np.where(mesh.triangles[elements], in_triangles, 1.0 - np.maximum(np.abs(x), np.abs(y)))
    result[result] = inside < _AT_SIDE
    return result


def _shares(
    cut: Cut, mesh: Mesh, support: Support, table: ContactPoints, rows_of_support: Ints
) -> Iterator[tuple[Ints, Floats]]:
    """Yield points (k,) of an area, and the section forces (k, 3) due to their unit reactions on the line's left.

    The reaction of each point is spread over the point's element, of which the line divides off a left part.
    """
    covered = support.where.region
    left = cut.on_left(mesh, covered, GAUSS, ())
    whole = area_quadrature(mesh.part(cut.elements), covered, GAUSS)
    rows = _deflections(mesh, replace(left, elements=cut.elements[left.elements]))
    work = np.einsum("qcd,qd->qc", cut.motion[left.elements], rows)
    for element in np.unique(left.elements).tolist():
        on_left, covered_part = left.elements == element, whole.pick(whole.elements == element)
        in_element = rows_of_support[table.rows.elements[rows_of_support] == cut.elements[element]]
        middle, size = covered_part.positions.mean(axis=0), np.sqrt(covered_part.weights.sum())
        # The reactions become a linear pressure over the covered part of the element, with equal resultants.
        linear, basis, points = (
            np.column_stack([np.ones(len(p)), (p - middle) / size])
            for p in (left.positions[on_left], covered_part.positions, table.positions[in_element])
        )
        inverse = np.linalg.pinv(basis.T @ (covered_part.weights[:, None] * basis), rcond=_FLAT, hermitian=True)
        yield in_element, table.direction[in_element, None] * (points @ inverse @ (linear.T @ work[on_left]))


def _deflections(mesh: Mesh, forces: Quadrature) -> Floats:
    """Rows (q, 24) of the deflection at points, multiplied by the weights, which are forces."""
    rows = np.zeros((len(forces), 24))
    rows[:, ::3] = forces.weights[:, None] * mesh.shape_functions(forces.elements, forces.xi)
    return rows
