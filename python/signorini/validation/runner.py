"""Solve validation cases on their meshes, with half-widths, in worker processes."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from signorini.accuracy.comparison import known
from signorini.analysis.estimate import estimate
from signorini.analysis.solve import solve
from signorini.model import Model
from signorini.plot.artist import cores
from signorini.results.result import Result
from signorini.studies.workers import Workers
from signorini.validation.case import Case, Number
from signorini.validation.catalogue import cases

if TYPE_CHECKING:
    from signorini.validation.drawing import Drawing

EXACT = 1e-9
"""Largest relative error that counts as rounding; smaller errors are left out of the rate of convergence."""


@dataclass(frozen=True)
class Solved:
    """Numbers of a case on one mesh, in the units of their reference values.

    ``widths`` are the half-widths ±: None where a number has no limit, NaN where they were not estimated.
    """

    n: int
    elements: int
    values: tuple[float, ...]
    widths: tuple[float | None, ...]
    seconds: float


@dataclass(frozen=True)
class Comparison:
    """One number of a case on all meshes beside its reference."""

    number: Number
    meshes: tuple[Solved, ...]
    place: int

    @property
    def values(self) -> list[float]:
        """Values of the number, from the coarsest to the finest mesh."""
        return [mesh.values[self.place] for mesh in self.meshes]

    @property
    def widths(self) -> list[float | None]:
        """Half-widths ± of the number, from the coarsest to the finest mesh."""
        return [mesh.widths[self.place] for mesh in self.meshes]

    @cached_property
    def errors(self) -> list[float]:
        """Relative errors of the number, from the coarsest to the finest mesh."""
        return [self.number.error(value) for value in self.values]

    @property
    def within(self) -> bool:
        """Whether the number's error on the finest mesh is at most its tolerance."""
        return self.errors[-1] <= self.number.tolerance

    @property
    def holds(self) -> bool:
        """Whether the number is finite, and agrees with its reference or, if the case states so, differs from it."""
        return self.within != bool(self.number.differs) and math.isfinite(self.errors[-1])

    @property
    def rate(self) -> float | None:
        """Slope of log error over log element size, for the meshes whose error exceeds that of the reference itself."""
        least = max(EXACT, self.number.uncertainty / self.number.magnitude)
        shown = [
            (mesh.n, error) for mesh, error in zip(self.meshes, self.errors, strict=True) if least < error < math.inf
        ]
        if len(shown) < 2 or self.number.differs:
            return None
        sizes, errors = np.log(np.array(shown)).T
        return float(-np.polyfit(sizes, errors, 1)[0])

    @property
    def covered(self) -> list[bool | None]:
        """For each mesh, whether ± plus the reference's own error covers the number's error; None without ±."""
        size, result = self.number.magnitude, list[bool | None]()
        for error, width in zip(self.errors, self.widths, strict=True):
            unknown = width is None or math.isnan(width) or bool(self.number.differs)
            reach = 0.0 if width is None else width + self.number.uncertainty + EXACT * size
            result.append(None if unknown else error * size <= reach)
        return result


@dataclass(frozen=True)
class Outcome:
    """A case with its numbers on all meshes, and two pictures of each plate if they were drawn."""

    case: Case
    meshes: tuple[Solved, ...]
    drawings: tuple[tuple[Drawing, Drawing], ...] = ()

    @property
    def comparisons(self) -> list[Comparison]:
        """Every number of the case beside its reference."""
        return [Comparison(number, self.meshes, place) for place, number in enumerate(self.case.numbers)]

    @property
    def holds(self) -> bool:
        """Whether every number of the case agrees or differs as the case states."""
        return all(one.holds for one in self.comparisons)

    @property
    def seconds(self) -> float:
        """Duration in seconds of the solutions on all meshes."""
        return sum(mesh.seconds for mesh in self.meshes)


def solve_case(name: str, drawn: bool) -> tuple[tuple[Solved, ...], tuple[tuple[Drawing, Drawing], ...]]:
    """Solve a case on each of its meshes; if ``drawn``, also draw its plates on the finest mesh."""
    case = cases()[name]
    meshes = tuple(solve_on(case, n) for n in case.meshes)
    if case.direct or not drawn:
        return meshes, ()
    from signorini.validation.drawing import drawings  # imports matplotlib

    return meshes, tuple(drawings(solve(model_of(case, case.meshes[-1]))))


def model_of(case: Case, n: int) -> Model:
    """Model of a case with n elements along a side."""
    return Model.model_validate({"title": case.title, **case.tables(n)})


def solve_on(case: Case, n: int, estimated: bool = True) -> Solved:
    """Solve a case with n elements along a side; half-widths are NaN unless ``estimated`` is true."""
    begun = time.perf_counter()
    if case.direct:
        found = case.tables(n)
        values = tuple(number.factor * float(found[number.name]) for number in case.numbers)
        return Solved(n, n, values, (math.nan,) * len(values), time.perf_counter() - begun)
    result = solve(model_of(case, n))["all"]
    widths = estimate(result).widths if estimated else np.full(len(result.catalogue), math.nan)
    places = [result.catalogue.by_name[number.name] for number in case.numbers]
    half = [abs(one.factor) * float(widths[at]) for one, at in zip(case.numbers, places, strict=True)]
    seconds = time.perf_counter() - begun
    return Solved(
        n,
        len(result.mesh.elements),
        values_of(case, result),
        tuple(map(known, half)) if estimated else tuple(half),
        seconds,
    )


def values_of(case: Case, result: Result) -> tuple[float, ...]:
    """Read the numbers of a case from a result, in the units of their reference values."""
    by_name = result.catalogue.by_name
    return tuple(one.factor * float(result.numbers[by_name[one.name]]) for one in case.numbers)


def outcomes(names: Sequence[str], drawn: bool = False) -> Iterator[Outcome]:
    """Solve cases in worker processes, with pictures if ``drawn``, and yield each when it is finished."""
    with Workers(min(cores(), len(names))) as workers:
        waiting = {workers.submit(solve_case, name, drawn): name for name in names}
        for future in as_completed(waiting):
            yield Outcome(cases()[waiting[future]], *future.result())
