"""Punching of columns: quadrature of contact pressures inside control perimeters, and the results of each column."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csr_array

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.laws import steps_of
from signorini.discretise.punching import PunchedColumn, over
from signorini.discretise.quadrature import GAUSS, Quadrature, area_quadrature
from signorini.discretise.rows import Bools, Floats
from signorini.results.contact_field.areas import area_at_rest
from signorini.results.quantities import OF_COLUMNS
from signorini.shapes.cuts import Common


class Inside(NamedTuple):
    """Points (q,) of an area support inside r regions.

    ``rows`` (q, n) interpolate deflections, ``sums`` (r, q) have the weights. ``stiff`` (q,) marks points at which the
    pressure is the mean over the element.
    """

    points: Quadrature
    rows: csr_array
    sums: csr_array
    stiff: Bools


@kept
def points_inside(discretisation: Discretisation, column: int, support: int) -> Inside:
    """Quadrature over the part of area support number ``support`` inside the perimeters of a column."""
    mesh, area = discretisation.mesh, area_at_rest(discretisation, support)
    parts, regions = [], discretisation.columns.columns[column].regions
    for region in regions:
        part = region if area.support.where.region is None else Common(region, area.support.where.region)
        (x0, y0, x1, y1), levels = part.bounds, steps_of(area.support)
        meets = x0 < x1 and y0 < y1
        if (part is region and not levels) or not meets:
            points = over(region, mesh, GAUSS)
        else:
            points = area_quadrature(mesh, part, GAUSS, levels=levels)
        parts.append(points if meets else points.times(0.0))
    points = Quadrature.join(parts)
    at, shape = np.arange(len(points)), mesh.shape_functions(points.elements, points.xi)
    entries = np.repeat(at, 8), mesh.elements[points.elements].ravel()
    rows = csr_array((shape.ravel(), entries), shape=(len(points), mesh.node_count))
    region_of = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    sums = csr_array((points.weights, (region_of, at)), shape=(len(parts), len(points)))
    return Inside(points, rows, sums, area.stiff[points.elements] | area.on_means)


@dataclass(frozen=True, eq=False)
class ColumnResult:
    """Punching of one column in one combination; ``numbers`` are named as in `OF_COLUMNS`.

    Examples
    --------
    >>> from signorini import Model, solve
    >>> model = Model(
    ...     units={"length": "m", "force": "kN"},
    ...     material={"E": 30e6, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [6, 6], "thickness": 0.3},
    ...     support=[{"name": "columns", "at": [[1, 1], [5, 1], [1, 5], [5, 5]]}],
    ...     load=[{"pressure": 10}],
    ...     punching=[
    ...         {"support": "columns", "column": [0.3, 0.3], "code": "EN 1992-1-1:2004", "d": 0.25, "rho": 0.005,
    ...          "fck": 30e3, "fyk": 500e3}
    ...     ],
    ... )
    >>> column = solve(model)["all"].punching["columns[1]"]
    >>> round(column.numbers["force"], 6), round(column.numbers["u1"], 4)
    (90.0, 4.3416)
    """

    name: str
    at: tuple[float, float]
    numbers: Mapping[str, float]
    column: PunchedColumn

    @property
    def clauses(self) -> Mapping[str, str]:
        """Clause of each number."""
        return self.column.check.clauses

    @property
    def openings(self) -> list[tuple[float, float]]:
        """Middles of the openings that reduce the perimeter."""
        middles = [opening.centroid for opening in self.column.check.plan.openings]
        return [(middle.x / self.column.length, middle.y / self.column.length) for middle in middles]

    @cached_property
    def perimeter(self) -> list[Floats]:
        """Parts (k, 2) of the control perimeter u1."""
        u1 = self.numbers["u1"] * self.column.length
        perimeters = [perimeter.pieces for perimeter in self.column.check.perimeters]
        return self.column.drawn(min(perimeters, key=lambda pieces: abs(pieces.length - u1)))

    @cached_property
    def outer(self) -> list[Floats]:
        """Parts (k, 2) of the perimeter uout beyond which no shear reinforcement is needed; none if none is needed."""
        if self.numbers["asw"] == 0.0:
            return []
        return self.column.drawn(self.column.check.plan.of_length(self.numbers["uout"] * self.column.length))

    def figures(self) -> dict[str, Any]:
        """Keys of results.json that are not numbers of the catalogue."""
        place = {"name": self.name, "at": list(self.at), "code": self.column.code}
        return place | {"openings": [list(at) for at in self.openings], "clauses": dict(self.clauses)}


def column_results(discretisation: Discretisation, numbers: Mapping[str, Floats]) -> Iterator[ColumnResult]:
    """Yield the results of columns (c,) from their numbers (c,) by name."""
    for index, column in enumerate(discretisation.columns.columns):
        own = {quantity.name: float(numbers[quantity.name][index]) for quantity in OF_COLUMNS}
        name = column.column.subject(discretisation.model).removeprefix("punching:")
        yield ColumnResult(name, column.column.at, own, column)
