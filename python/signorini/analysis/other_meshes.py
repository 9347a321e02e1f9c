"""Solve the plate on other meshes, and compute the half-width of each number of a table. Each mesh is factored once."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TypeVar

import numpy as np

from signorini.accuracy.comparison import Meshes, compared, known, plates_of_extremes
from signorini.accuracy.meshes import OtherMesh, meshes_beside, meshes_beside_path
from signorini.analysis.combinations import Combined
from signorini.analysis.results import Results
from signorini.analysis.single import rows_of, solve_rows, solve_table
from signorini.base.arguments import watching
from signorini.base.progress import Progress, Watcher
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.discretise import Discretisation, discretise
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import SignoriniError
from signorini.mesh import Mesh
from signorini.model import Combination, Model
from signorini.results.checks import widened
from signorini.results.envelope import NONE
from signorini.results.quantities import Number
from signorini.results.rows import Column, Layout
from signorini.singularities.named import singularities_of
from signorini.singularities.singularity import Singularity

_T = TypeVar("_T")
_OTHERS = 2
"""Number of other meshes with which a result is compared."""
_OTHER = 0.5
"""Smallest |log₂(n₁/n₂)| of the element counts n₁, n₂ of two compared meshes. For one twofold refinement it is 2."""


class _SameMeshError(SignoriniError):
    """Raised if another mesh has nearly as many elements, since the outline or refined places fix the element size."""


@dataclass(eq=False)
class OtherMeshes:
    """Solves a model on other meshes than its own, one mesh after the other."""

    model: Model
    mesh: Mesh
    """The model's own mesh, with which other meshes are compared."""
    watcher: Watcher
    """Called with a `Progress` for each step. An exception in it ends the solution and reaches the caller."""
    seconds: float = math.nan
    """Duration in seconds of the solution of all ``calls`` on the model's own mesh; NaN if not measured."""
    calls: int = 1
    """Number of calls of `solved` that are expected."""
    _begun: float = field(default_factory=time.monotonic)
    _done: tuple[float, float] = (0.0, 0.0)
    """Completed work, relative to the work of one call on the own mesh, and its duration in seconds."""
    _problems: dict[str, ContactProblem] = field(default_factory=dict)

    def solved(self, solve: Callable[[ContactProblem, Watcher], _T]) -> tuple[list[_T], str]:
        """Call ``solve`` on one or two other meshes; return the values, and a warning if solving on a mesh failed."""
        return self._first(meshes_beside(self.model, self.mesh), solve, "a finer mesh would take too long.")

    def solved_for_path(self, solve: Callable[[ContactProblem, Watcher], _T]) -> tuple[list[_T], str]:
        """Call ``solve`` on one or two other meshes for a load path; return values and warning as `solved` does."""
        pairs = [pair] if (pair := meshes_beside_path(self.model, self.mesh)) else []
        return self._first(pairs, solve, "this mesh cannot be coarsened.")

    def _first(
        self, pairs: Iterable[tuple[OtherMesh, ...]], solve: Callable[[ContactProblem, Watcher], _T], none: str
    ) -> tuple[list[_T], str]:
        """Call ``solve`` on the first pair of meshes of which at least one can be solved."""
        whys: list[str] = []
        failed: list[str] = []
        for pair in pairs:
            result: dict[str, _T] = {}
            for number, other in enumerate(pair, 2):
                try:
                    result[other.words] = self._on(other, solve, pair[:_OTHERS], number, result)
                except (SignoriniError, MemoryError) as error:
                    whys.append(f"on a mesh of {other.words}: {str(error) or 'not enough memory.'}")
                    if not isinstance(error, _SameMeshError):
                        failed.append(whys[-1])
                        if not result:
                            break
                if len(result) == _OTHERS:
                    break
            if result:
                return [*result.values()], without(len(result), " ".join(dict.fromkeys(failed))) if failed else ""
        return [], without(0, " ".join(dict.fromkeys(whys)) or none)

    def _on(
        self,
        other: OtherMesh,
        solve: Callable[[ContactProblem, Watcher], _T],
        pair: tuple[OtherMesh, ...],
        number: int,
        beside: Iterable[str] = (),
    ) -> _T:
        """Call ``solve`` on another mesh, unless a mesh with about as many elements was already solved.

        These meshes are the own mesh and those in ``beside``. ``number`` is the mesh's number in progress reports; the
        own mesh is 1.
        """
        total = self.calls * sum(one.work for one in pair)

        def watch(now: Progress) -> None:
            count = max(number, 1 + len(pair))
            self.watcher(replace(now, other_mesh=other.words, mesh=number, meshes=count, left=self._left(total)))

        if other.words not in self._problems:
            watch(Progress(stage="mesh"))
            # The method that the input names may be slow on a finer mesh; every method gives the same certified answer.
            solver = other.model.solver.model_copy(update={"method": "auto"})
            discretisation = discretise(other.model.varied(solver=solver), other.mesh)
            count, meshes = len(discretisation.mesh.elements), [self.mesh, *(self._problems[at].mesh for at in beside)]
            for known_count in (len(mesh.elements) for mesh in meshes):
                if not abs(math.log2(count / known_count)) > _OTHER:
                    raise _SameMeshError(f"it has {count} elements, about as many as a mesh of {known_count}.")
            watch(Progress(stage="factor"))
            self._problems[other.words] = contact_problem(discretisation)
        result = solve(self._problems[other.words], watch)
        self._done = self._done[0] + other.work, time.monotonic() - self._begun
        return result

    def _left(self, total: float) -> float:
        """Estimated seconds for the remaining work, from the speed of completed work or, at first, of the own mesh."""
        done, spent = self._done
        each = spent / done if done else self.seconds / self.calls
        return max(0.0, each * (total - done) - (time.monotonic() - self._begun - spent))


def without(count: int, why: str) -> str:
    """Warning about half-widths from ``count`` other meshes, with the reason ``why``.

    With ``count`` 2, the two meshes are not the first that were tried.
    """
    what = (
        "The mesh error of the numbers is unknown: they have no half-width (±)",
        "Half-widths (±) come from one other mesh alone",
        "Half-widths (±) come from other meshes than the first that were tried",
    )
    return f"{what[count]}; {why}"


ENDING = ":plus_minus"
_TOGETHER = 4096
"""Number of rows of a table that are compared at once."""


@dataclass(frozen=True, eq=False)
class EstimatedTable:
    """Half-widths of a table, computed by comparison with the same table on other meshes."""

    others: tuple[tuple[Combined, Mesh], ...]
    """Table and mesh for each other mesh; empty if none could be solved."""
    why: str
    """Reason why another mesh is missing; empty if two other meshes were solved."""
    widths: Mapping[str, Floats] = field(default_factory=dict)
    """Half-widths (k,) of the columns, by ``<column>:plus_minus``; empty if the table is in a file."""
    picked: Mapping[tuple[str, int], float] = field(default_factory=dict)
    """Half-widths of the extremes of envelopes by (column, row), if the table is in a file."""
    reach: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Largest utilisation − ± and utilisation + ± over all rows, by column of the check's utilisation."""

    @classmethod
    def of(cls, results: Results, meshes: OtherMeshes, table: str | os.PathLike[str] | None) -> EstimatedTable:
        """Solve the table on other meshes and compare; half-widths are added to the file ``table``, if given."""
        files: list[Path] = []

        def solved(other: ContactProblem, watcher: Watcher) -> tuple[Combined, ContactProblem]:
            if table is None:
                return solve_table(other, watcher, None), other
            combined = solve_table(other, watcher, file := Path(f"{table}-{len(other.mesh.elements)}"))
            files.append(file)
            return combined, other

        try:
            result, why = meshes.solved(solved)
            others = tuple((combined, problem.mesh) for combined, problem in result)
            if not result:
                return cls(others, why)
            every = [(results.combined, results.problem), *result]
            in_order = Meshes.of(results.problem.mesh, [mesh for _, mesh in others])
            own = [problem.mesh for _, problem in every]
            order = [own.index(mesh) for mesh in in_order.every]
            rows = _Rows(results.discretisation, results.combined.layout, in_order)
            combinations = results.combined.combinations
            if table is not None:
                picked, reach = _widen(Path(table), files, rows, order, results.combined)
                return cls(others, why, picked=picked, reach=reach)
            tables = [rows_of(combined, partial(solve_rows, of, watching(None, ""))) for combined, of in every]
            widths = rows.widths(in_turn := [tables[place] for place in order], combinations[:])
            return cls(others, why, widths, reach=rows.reach(in_turn, widths))
        finally:
            for file in files:
                file.unlink()

    def width(self, column: str, row: int) -> float | None:
        """Return the half-width of an extreme of an envelope, by column and row; None if it is unknown."""
        if self.picked:
            return known(self.picked.get((column, row), np.nan))
        return known(self.widths[column + ENDING][row]) if column + ENDING in self.widths else None


@dataclass(frozen=True, eq=False)
class _Rows:
    """Compares the rows of a table on several meshes, many rows at once."""

    discretisation: Discretisation
    layout: Layout
    meshes: Meshes

    def widths(
        self, tables: Sequence[Mapping[str, Column]], combinations: Sequence[Combination]
    ) -> Mapping[str, Floats]:
        """Half-widths (k,) of the columns of k rows, by ``<column>:plus_minus``.

        ``tables`` are in the order of the meshes. A half-width is NaN if it is unknown, or if a mesh has no
        equilibrium.
        """
        told = [one for one in self.layout.catalogue if one.estimated and one.quantity.kind != "count"]
        numbers: list[Number] = [one for one in told if all(one.column in table for table in tables)]
        out = np.full((len(numbers), len(combinations)), np.nan)
        for first in range(0, len(combinations), _TOGETHER):
            rows = slice(first, first + _TOGETHER)
            values = np.array([[np.asarray(table[one.column])[rows] for one in numbers] for table in tables])
            for at, plate in enumerate(self.discretisation.each):
                mine, own = self._of_plate(at, numbers)
                named, probes = self._named(plate, combinations[rows]), plate.probe_positions
                meshes = self.meshes.of_plate(at)
                out[mine, rows] = compared(values[:, mine], own, meshes, plate.model, probes, named)[0]
        by_path, plates = {one.path: row for row, one in enumerate(numbers)}, self.layout.model.plates
        shown = tables[self.meshes.own]
        for row in (row for row, one in enumerate(numbers) if plates and one.over_plates):
            each = [by_path["plates", name, *numbers[row].path] for name in plates]
            whole, *parts = (np.asarray(shown[numbers[at].column]) for at in (row, *each))
            which = plates_of_extremes(whole, np.array(parts), out[each])
            out[row] = np.take_along_axis(out[each], which[None], axis=0)[0]
        found = {one.column: width for one, width in zip(numbers, out, strict=True)}
        return {column + ENDING: width for column, width in (found | self._of_checks(found, shown)).items()}

    def reach(
        self, tables: Sequence[Mapping[str, Column]], widths: Mapping[str, Floats]
    ) -> dict[str, tuple[float, float]]:
        """Largest ends of the intervals utilisation ± half-width over k rows, by column of each utilisation."""
        columns = [one.column for one in self.layout.catalogue if one.check and one.what == "utilisation"]
        shown = tables[self.meshes.own]
        told = (column for column in columns if column in shown and column + ENDING in widths)
        return {column: ends_of(np.asarray(shown[column]), widths[column + ENDING]) for column in told}

    def _of_checks(self, widths: Mapping[str, Floats], shown: Mapping[str, Column]) -> dict[str, Floats]:
        """Half-widths (k,) of the columns of checks, from those of other columns and the columns of this mesh."""
        catalogue = self.layout.catalogue
        checks = [place for place, one in enumerate(catalogue) if one.check is not None]
        if not checks:
            return {}
        columns, unknown = [one.column for one in catalogue], np.full(len(next(iter(widths.values()))), np.nan)
        # A block of a Parquet file has only columns of floating-point numbers; the missing columns of counts get NaN.
        values = np.array([np.asarray(shown.get(column, unknown), np.float64) for column in columns]).T
        known = np.array([widths.get(column, unknown) for column in columns]).T
        result = widened(catalogue, values, known, self.discretisation.model.has_limits)
        return {columns[place]: result[:, place] for place in checks}

    def _of_plate(self, plate: int, numbers: Sequence[Number]) -> tuple[Ints, list[Number]]:
        """Return the indices (k,) in ``numbers`` of one plate's numbers, and these numbers as in the plate's model."""
        if not self.discretisation.plates:
            return np.arange(len(numbers)), list(numbers)
        catalogue, own = self.layout.catalogue, self.layout.members[plate].catalogue
        places = dict(zip(catalogue.numbers, catalogue.in_plates, strict=True))
        pairs = [
            (row, own.numbers[at])
            for row, one in enumerate(numbers)
            for which, at in places[one]
            if which == plate and not one.over_plates
        ]
        return np.array([row for row, _ in pairs], np.int64), [one for _, one in pairs]

    @staticmethod
    def _named(
        discretisation: Discretisation, combinations: Sequence[Combination]
    ) -> list[tuple[Sequence[Singularity], Bools]]:
        """Singularities of supports, with a mask of all rows; then those of each load case, with a mask of its rows."""
        acting = [one.acting for one in combinations]
        result: list[tuple[Sequence[Singularity], Bools]] = [
            (singularities_of(discretisation), np.ones(len(acting), np.bool_))
        ]
        for case in sorted(set().union(*acting)):
            where = np.array([case in cases for cases in acting], np.bool_)
            if case in discretisation.cases:
                result.append((singularities_of(discretisation, case), where))
        return result


def ends_of(values: Floats, widths: Floats) -> tuple[float, float]:
    """Largest value − half-width and value + half-width of k values; −∞ if none has a half-width.

    Examples
    --------
    >>> ends_of(np.array([0.9, 0.5, np.nan]), np.array([0.05, 0.6, np.nan]))
    (0.85, 1.1)
    """
    low, high = (float(np.fmax.reduce(of, initial=-np.inf)) for of in (values - widths, values + widths))
    return low, high


def _widen(
    table: Path, files: Sequence[Path], rows: _Rows, order: Sequence[int], combined: Combined
) -> tuple[Mapping[tuple[str, int], float], Mapping[str, tuple[float, float]]]:
    """Add columns of half-widths to the table in a file.

    Returns the half-widths of the extremes of envelopes, and `EstimatedTable.reach`.
    """
    # This import loads pyarrow, which is needed for Parquet files only.
    from signorini.formats.parquet import widen

    wanted, picked, first = _wanted(combined), dict[tuple[str, int], float](), 0
    reach = dict[str, tuple[float, float]]()

    def more(blocks: Sequence[Mapping[str, Floats]]) -> Mapping[str, Floats]:
        nonlocal first
        count = len(next(iter(blocks[0].values())))
        result = rows.widths(
            in_turn := [blocks[place] for place in order], combined.combinations[first : first + count]
        )
        for column, (low, high) in rows.reach(in_turn, result).items():
            known_low, known_high = reach.get(column, (-np.inf, -np.inf))
            reach[column] = max(low, known_low), max(high, known_high)
        for column, numbers in wanted.items():
            here = [number for number in numbers if first <= number < first + count]
            if column + ENDING in result:
                picked.update(((column, number), result[column + ENDING][number - first]) for number in here)
        first += count
        return result

    widen(table, files, more)
    return picked, reach


def _wanted(combined: Combined) -> Mapping[str, set[int]]:
    """Row numbers of envelope extremes, by column; columns of reactions have the rows of all governing extremes."""
    layout, result = combined.layout, dict[str, set[int]]()
    for envelope in (combined.envelope, *combined.groups.values()):
        of = envelope.values
        for one, largest, smallest in zip(layout.catalogue, of.largest_by, of.smallest_by, strict=True):
            result.setdefault(one.column, set()).update((int(largest), int(smallest)))
        places = layout.governed_places
        rows = {*of.largest_by[places].tolist(), *of.smallest_by[places].tolist()}
        for bearing in layout.bearings:
            result.setdefault(bearing.column(layout.model), set()).update(rows)
    return {column: rows - {NONE} for column, rows in result.items()}
