"""Columns that are checked for punching: their checks, and the loads on them and inside their control perimeters."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from signorini.base.on_demand import kept
from signorini.base.units import METRES, NEWTONS
from signorini.design import aci318, en1992_punching
from signorini.design.perimeters import Column, Pieces, Plan
from signorini.discretise.places import edge_sides
from signorini.discretise.quadrature import GAUSS, Quadrature, area_quadrature
from signorini.discretise.quadrature.stepped import Levels, sides_of
from signorini.discretise.rows import Floats
from signorini.discretise.sections.sections import Spread
from signorini.discretise.zones import Zones
from signorini.errors import InputError, Problems
from signorini.mesh import Mesh
from signorini.model import MeshPlate, Model
from signorini.model.punching import ACI_318, ColumnAt
from signorini.shapes import Circle, Rounded
from signorini.shapes.cuts import Common, Part
from signorini.shapes.distances import depth
from signorini.shapes.outlines import Contour

Check: TypeAlias = en1992_punching.Punching | aci318.Punching
_ON_EDGE = 1e-9
"""Tolerance for points of loads within a column, relative to its size."""


@dataclass(frozen=True, eq=False)
class PunchedColumn:
    """A column of a plate with its punching check in mm and N; the model's units are ``length`` mm and ``force`` N."""

    column: ColumnAt
    check: Check
    code: str
    length: float
    force: float

    @cached_property
    def regions(self) -> tuple[Rounded, ...]:
        """Regions (p,) inside each of the column's p control perimeters."""
        return tuple(_region(perimeter.whole, self.length) for perimeter in self.check.perimeters)

    def drawn(self, pieces: Pieces) -> list[Floats]:
        """Points (k, 2) along each piece of a control perimeter, in units of the model."""
        points = pieces.at(np.linspace(0.0, 1.0, 17)) / self.length
        return [np.column_stack([z.real, z.imag]) for z in points]


@dataclass(frozen=True, eq=False)
class Columns:
    """Columns (c,) of a plate, and the regions (r,) inside all their control perimeters.

    A load is reduced to r + 3c numbers: the downward forces inside the regions, and for each column the downward force
    and the couples on θx and θy that act on the column.
    """

    mesh: Mesh
    columns: tuple[PunchedColumn, ...]

    @classmethod
    def of(cls, zones: Zones, mesh: Mesh, problems: Problems) -> Columns:
        """Make the columns of a model; errors are collected in ``problems``."""
        result = []
        for column in zones.model.columns:
            with problems.collected():
                try:
                    found = _punched(zones, mesh, column)
                    none = np.zeros((1, len(found.regions)))
                    found.check.numbers(np.zeros(1), np.zeros(1, np.complex128), none)
                    result.append(found)
                except InputError as error:
                    raise InputError(error.message, ("punching", column.table)) from None
        return cls(mesh, tuple(result))

    @cached_property
    def regions(self) -> tuple[Rounded, ...]:
        """Regions (r,) of all columns."""
        return tuple(region for column in self.columns for region in column.regions)

    @property
    def count(self) -> int:
        """How many numbers a load is reduced to: r + 3c."""
        return len(self.regions) + 3 * len(self.columns)

    @cached_property
    def slices(self) -> tuple[slice, ...]:
        """Indices of the regions of each column."""
        ends = np.cumsum([0, *(len(column.regions) for column in self.columns)]).tolist()
        return tuple(slice(a, b) for a, b in pairwise(ends))

    def of_points(self, forces: Quadrature) -> Floats:
        """The r + 3c numbers (see `Columns`) of downward point forces, which are the weights of ``forces``."""
        return self._numbers(lambda region: forces.weights[region.contains(forces.positions)].sum())

    def of_line(self, divided: Callable[[Levels], Quadrature]) -> Floats:
        """The r + 3c numbers (see `Columns`) of forces along a line; ``divided`` is as in `Sections.of_line`."""

        def inside(region: Rounded) -> float:
            points = divided(sides_of(region))
            return float(points.weights[region.contains(points.positions)].sum())

        return self._numbers(inside)

    def of_spread(self, forces: Quadrature, spread: Spread) -> Floats:
        """The r + 3c numbers (see `Columns`) of a pressure; arguments are as in `Sections.of_spread`."""
        shape = spread.region
        around = np.concatenate([np.zeros((0, 2)), *getattr(shape, "loops", ())])

        def inside(region: Rounded) -> float:
            # The region inside a perimeter is convex: it contains a load if it contains all corners of its outline.
            if len(around) and region.contains(around).all():
                return forces.total
            points = over(region, self.mesh, shape, spread.order, spread.levels)
            return float(points.weights @ spread.pressure(points.elements, points.positions))

        return self._numbers((lambda region: 0.0) if spread.field else inside)

    def of_case(self, model: Model, case: str) -> Floats:
        """The r + 3c numbers (see `Columns`) of the forces and couples of a load case that act on the columns."""
        result, first = np.zeros(self.count), len(self.regions)
        loads = [load for load in model.load if load.case == case and load.at is not None]
        for own, column in zip(result[first:].reshape(-1, 3), (one.column for one in self.columns), strict=True):
            for load in loads if column.support is None else ():
                points = np.array(load.at)
                arms = points[depth(column.outline, points) >= -_ON_EDGE * self.mesh.size] - column.at
                force, couple = load.force or 0.0, np.array(load.couple or (0.0, 0.0))
                own += [force * len(arms), *(force * arms.sum(axis=0) + couple * len(arms))]
        return result

    def _numbers(self, inside: Callable[[Rounded], float]) -> Floats:
        return np.array([*map(inside, self.regions), *np.zeros(3 * len(self.columns))])


def over(region: Rounded, mesh: Mesh, shape: Part | None, order: int, levels: Levels) -> Quadrature:
    """Quadrature over the part of ``shape`` in a region; arguments are as in `area_quadrature`."""
    # Quadratures without levels are stored: loads of several cases often act on the same footprint.
    return _divided_over(region, mesh, shape, order, levels) if levels else _over(region, mesh, shape, order)


@kept
def _over(region: Rounded, mesh: Mesh, shape: Part | None, order: int) -> Quadrature:
    return _divided_over(region, mesh, shape, order, ())


def _divided_over(region: Rounded, mesh: Mesh, shape: Part | None, order: int, levels: Levels) -> Quadrature:
    part = region if shape is None else Common(region, shape)
    x0, y0, x1, y1 = part.bounds
    if x0 < x1 and y0 < y1:
        return area_quadrature(mesh, part, order, levels=levels)
    return Quadrature(np.zeros(0, np.int64), np.zeros((0, 2)), np.zeros(0), np.zeros((0, 2)))


def _punched(zones: Zones, mesh: Mesh, column: ColumnAt) -> PunchedColumn:
    model, at = zones.model, np.array([column.at])
    table, units = model.punching[column.table], model.units
    length, force = 1e3 * METRES[units.length], NEWTONS[units.force]
    outline = Column.hull([length * complex(x, y) for x, y in np.concatenate(column.outline.loops)])
    if isinstance(column.outline, Circle):
        outline = Column((length * complex(*column.outline.center),), length * column.outline.radius)
    rings = [length * ring for ring in _rings(model, mesh)]
    check = _check(model, column, outline, rings, thickness := _least_thickness(zones, at))
    reach = max(perimeter.distance for perimeter in check.perimeters)
    # The plate may be thinner within the perimeters of the thickness at the column, as beyond a narrow thickening.
    inside = over(_region(outline.offset(reach), length), mesh, None, GAUSS, ()).positions
    if (least := _least_thickness(zones, inside)) < thickness:
        check = _check(model, column, outline, rings, least)
    if any(outline.distance(length * line) <= reach for line in _axes(model, mesh)):
        raise InputError("An edge of symmetry cuts the control perimeter. Model the whole column.")
    return PunchedColumn(column, check, table.code, length, force)


def _least_thickness(zones: Zones, points: Floats) -> float:
    """Least thickness of the plate at points (q, 2); infinite without points."""
    return float(zones.nominal(zones.made_at(points).thickness, points).min(initial=np.inf))


def _check(model: Model, column: ColumnAt, outline: Column, rings: Sequence[Floats], thickness: float) -> Check:
    """Check of a column in a plate of uniform thickness, in units of the model; outlines are in mm."""
    table, units, on_raft = model.punching[column.table], model.units, column.support is None
    length, force = 1e3 * METRES[units.length], NEWTONS[units.force]
    rho, d, fck, fyk = table.rho or (0.0, 0.0), table.d, table.fck, table.fyk
    if (own := model.reinforcement) is not None and (bars := model.bars) is not None:
        faces = (bars.bottom_x, bars.bottom_y) if on_raft else (bars.top_x, bars.top_y)
        d = d or (thickness - faces[0], thickness - faces[1])
        rho, fck, fyk = table.rho or (bars.least, bars.least), fck or own.fck, fyk or own.fyk
    assert d is not None and fck is not None and fyk is not None  # Without [reinforcement], d, fck, fyk are required.
    if min(d) <= 0.0:
        raise InputError("The plate is thinner than the distance of its bars from the face. Give the depth d.")
    given, depths = None if table.beta == "computed" else table.beta, (length * d[0], length * d[1])
    strengths = fck * force / length**2, fyk * force / length**2
    if table.code == ACI_318:
        plan = Plan.of(outline, rings, aci318.WITHIN * length * thickness)
        return aci318.Punching(plan, depths, *strengths, given)
    plan = Plan.of(outline, rings, 0.5 * en1992_punching.WITHIN * sum(depths), widened=True)
    return en1992_punching.Punching(plan, depths, rho, *strengths, given, on_raft)


def _axes(model: Model, mesh: Mesh) -> Iterator[Floats]:
    """Points (k, 2) along element sides on edges of symmetry."""
    for index, support in enumerate(model.support):
        if support.edge is not None and "slope" in support.fixed and "w" not in support.fixed:
            yield from mesh.points[edge_sides(mesh, support.edge, ("support", index))[:, [0, 2]]]


def _rings(model: Model, mesh: Mesh) -> Sequence[Floats]:
    """Points along the outline and the holes of the plate."""
    if not isinstance(model.plate, MeshPlate):
        return [contour.points() for contour in model.plate.contours]
    ends = np.flatnonzero(mesh.boundary[:-1, 2] != mesh.boundary[1:, 0]) + 1
    return [mesh.points[loop[:, :2].ravel()] for loop in np.split(mesh.boundary, ends)]


def _region(whole: Pieces, length: float) -> Rounded:
    """Region inside a closed control perimeter ``whole`` in mm; the region is in units of ``length`` mm."""
    start, middle = (whole.at(np.array([0.0, 0.5])) / length).T
    through = [None if straight else (z.real, z.imag) for z, straight in zip(middle, whole.radius == 0.0, strict=True)]
    return Rounded(Contour(tuple((z.real, z.imag) for z in start.tolist()), tuple(through), ("",) * len(start)))
