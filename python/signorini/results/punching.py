"""Punching shear of columns: quadrature of contact pressures inside control perimeters; results of each column."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from signorini.base.on_demand import kept
from signorini.design import en1992_punching
from signorini.design.perimeters import Positions
from signorini.discretise import Discretisation
from signorini.discretise.laws import steps_of
from signorini.discretise.punching import PunchedColumn, over
from signorini.discretise.quadrature import GAUSS, Quadrature
from signorini.discretise.rows import Bools, Floats
from signorini.results.contact_field.areas import area_at_rest
from signorini.results.quantities import KINDS, OF_COLUMNS


@kept
def points_inside(
    discretisation: Discretisation, column: int, support: int
) -> tuple[Quadrature, csr_array, csr_array, csr_array, Bools]:
    """Data for integrating the pressure of an area support inside the r perimeters of a column.

    Returns the quadrature (q,); rows (q, n) that interpolate deflections; weights (r, q) for each perimeter; rows
    (q, p) that map the forces of the area's points to the mean pressure over an element; and the mask (q,) of
    quadrature points at which this mean is used, since the area is too stiff for a pressure from the deflection.
    """
    mesh, area = discretisation.mesh, area_at_rest(discretisation, support)
    where, levels = area.support.where.region, steps_of(area.support)
    parts = [over(region, mesh, where, GAUSS, levels) for region in discretisation.columns.columns[column].regions]
    points = Quadrature.join(parts)
    at, shape = np.arange(len(points)), mesh.shape_functions(points.elements, points.xi)
    entries = np.repeat(at, 8), mesh.elements[points.elements].ravel()
    rows = csr_array((shape.ravel(), entries), shape=(len(points), mesh.node_count))
    region = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    sums = csr_array((points.weights, (region, at)), shape=(len(parts), len(points)))
    per_area = 1.0 / np.where(area.covered > 0.0, area.covered, 1.0)[points.elements]
    means = csr_array(area.per_element[points.elements].multiply(per_area[:, None]))
    return points, rows, sums, means, area.stiff[points.elements] | area.on_means


@dataclass(frozen=True, eq=False)
class ColumnResult:
    """Punching shear of one column in one combination; ``numbers`` have the names of `OF_COLUMNS`."""

    name: str
    at: tuple[float, float]
    numbers: Mapping[str, float]
    column: PunchedColumn

    @property
    def perimeter(self) -> list[Floats]:
        """Points (k, 2) along the parts of the control perimeter u1."""
        u1, perimeters = self.numbers["u1"] * self.column.length, self.column.check.perimeters
        return self.column.drawn(
            min((found.pieces for found in perimeters), key=lambda pieces: abs(pieces.length - u1))
        )

    def figures(self) -> dict[str, Any]:
        """JSON of the column's input: position, code, effective depths, ratios, strengths, openings, clauses."""
        check, length = self.column.check, self.column.length
        given: dict[str, Any] = {"d": [d / length for d in check.d]}
        given |= {"rho": list(check.rho)} if isinstance(check, en1992_punching.Punching) else {}
        given |= {key: getattr(check, key) * length**2 / self.column.force for key in ("fck", "fyk")}
        middles = [opening.centroid for opening in check.plan.openings]
        openings = [[middle.x / length, middle.y / length] for middle in middles]
        place = {"name": self.name, "at": list(self.at), "code": self.column.code}
        return place | given | {"openings": openings, "clauses": dict(check.clauses)}


def in_units(column: PunchedColumn, force: Floats, moment: Positions, inside: Floats) -> Mapping[str, Floats]:
    """Numbers (k,) of a column by name, from its forces (k,), moments (k,) and the forces (k, r) inside r perimeters.

    Arguments and results are in units of the model. A moment is complex, x + iy: the force times its distance along x,
    and the force times its distance along y.
    """
    couple = column.force * column.length * moment
    found = {**column.check.numbers(column.force * force, couple, column.force * inside)}
    found |= {"moment_x": couple.real, "moment_y": couple.imag}
    kinds = {quantity.name: KINDS[quantity.kind] for quantity in OF_COLUMNS}
    return {name: found[name] / (column.force**kind.force * column.length**kind.length) for name, kind in kinds.items()}


def column_results(discretisation: Discretisation, numbers: Mapping[str, Floats]) -> Iterator[ColumnResult]:
    """Yield the results of columns (c,) from their numbers (1, c) by name."""
    for index, column in enumerate(discretisation.columns.columns):
        own = {quantity.name: float(numbers[quantity.name][0, index]) for quantity in OF_COLUMNS}
        yield ColumnResult(column.column.subject.removeprefix("punching:"), column.column.at, own, column)
