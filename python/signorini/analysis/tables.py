"""All combinations of a model as rows of a table, and their half-widths, by the same table on other meshes."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path as FilePath

import numpy as np

from signorini.analysis.batch import mean_load, solve_several
from signorini.analysis.combinations import Combined, Sink, combine
from signorini.analysis.single import solve_one
from signorini.analysis.twins import Twins
from signorini.analysis.twins.columns import ENDING, Rows
from signorini.analysis.twins.compared import Meshes
from signorini.analysis.twins.leaves import Path
from signorini.base.arguments import watching
from signorini.base.progress import Progress, Watcher
from signorini.contact.problem import ContactProblem
from signorini.contact.strategy import WORDS
from signorini.discretise.rows import Floats
from signorini.errors import InputError, NoEquilibriumError
from signorini.model import Combination
from signorini.results.columns import Column, Layout, together
from signorini.results.envelope import NONE, Envelope, Extremes
from signorini.results.result import FIELDS, Result
from signorini.results.section_result import paths_of

_REASONS = 5
"""Combinations without equilibrium that a message names where none has one."""


def solve_rows(problem: ContactProblem, watcher: Watcher, sink: Sink | None = None) -> Combined:
    """Solve every combination as a row."""

    def show(step: int, changing: int, residual: float) -> None:
        watcher(Progress("the mean", step, changing, residual, method=WORDS[problem.method]))

    problem = problem.near(mean_load(problem.discretisation), show)

    def single(combination: Combination) -> Result:
        return solve_one(problem, combination, watcher)

    def begin(name: str) -> None:
        watcher(Progress(name))

    def several(combinations: Sequence[Combination], alone: Callable[[Combination], Result]) -> Iterator[Result]:
        return solve_several(problem, combinations, alone, begin)

    return combine(problem, single, several, begin, sink)


def solve_table(problem: ContactProblem, watcher: Watcher, table: str | os.PathLike[str] | None) -> Combined:
    """Solve every combination as a row, written to the table if there is one.

    Raises
    ------
    InputError
        If it cannot be written.
    NoEquilibriumError
        If no combination has one.
    """
    if table is None:
        combined = solve_rows(problem, watcher)
    else:
        # Only this function needs pyarrow.
        from signorini.formats.parquet import writing

        try:
            with writing(table) as sink:
                combined = solve_rows(problem, watcher, sink)
        except OSError as error:
            why = error.strerror or str(error)
            raise InputError(f"the table cannot be written there: {why}. Name another file.", str(table)) from None
    if not combined.solved:
        reasons = "\n".join(f"{name}: {message}" for name, message in list(combined.unbalanced.items())[:_REASONS])
        raise NoEquilibriumError(
            f"None of {len(combined.combinations)} combinations has one, to begin with:\n{reasons}"
        )
    return combined


def rows_of(combined: Combined, again: Callable[[Sink], object]) -> Mapping[str, Column]:
    """The columns of all rows; where they were too many to be kept they are solved again."""
    if combined.rows is not None:
        return combined.rows
    blocks = list[list[tuple[str, Column]]]()
    again(lambda columns: blocks.append(list(columns)))
    return together(blocks)


def rows_named(layout: Layout, envelope: Envelope) -> Iterator[tuple[Path, str, int]]:
    """Yield the path of every number of an envelope that is a row's, and its column and row."""
    for at, name in enumerate(envelope.names):
        ends = envelope.peaks.extremes
        yield ("fields", name, "max"), f"max:{name}", int(ends.largest_by[at])
        yield ("fields", name, "min"), f"min:{name}", int(ends.smallest_by[at])
    for path, column, ends, at in _both_ends(layout, envelope):
        yield (*path, "max"), column, int(ends.largest_by[at])
        yield (*path, "min"), column, int(ends.smallest_by[at])


def _both_ends(layout: Layout, envelope: Envelope) -> Iterator[tuple[Path, str, Extremes, int]]:
    """Yield the path of every number of supports and probes, its column, and where its extremes are."""
    for index, support in enumerate(envelope.supports):
        of, name = ("supports", index), layout.model.support[index].name
        yield (*of, "reaction"), f"reaction:{name}", support.reaction, 0
        if support.pressed is not None:
            for at, key in enumerate(("max_pressure", "contact_area")):
                yield (*of, key), f"{key}:{name}", support.pressed, at
        for number in range(len(support.points.largest) if layout.model.support[index].place == "at" else 0):
            point = (*of, "points", number)
            yield (*point, "reaction"), f"reaction_at:{name}[{number + 1}]", support.points, number
            yield (*point, "gap"), f"gap_at:{name}[{number + 1}]", support.gap, number
    for place in range(len(FIELDS) * len(layout.probes)):
        probe, field = divmod(place, len(FIELDS))
        yield ("probes", probe, FIELDS[field]), f"probe[{probe + 1}]:{FIELDS[field]}", envelope.probes, place
    for place, (path, column) in enumerate(zip(paths_of(layout.model), layout.through, strict=True)):
        yield path, column, envelope.through, place


def _named(combined: Combined) -> Mapping[str, set[int]]:
    """Rows, by column, that envelopes name: of their own extremes, and of what bearings do where one governs."""
    layout, found = combined.layout, dict[str, set[int]]()
    for envelope in (combined.envelope, *combined.groups.values()):
        for _, column, row in rows_named(layout, envelope):
            found.setdefault(column, set()).add(row)
        bearings = envelope.bearings.extremes
        rows = {*bearings.largest_by.tolist(), *bearings.smallest_by.tolist()}
        for bearing in layout.bearings:
            found.setdefault(bearing.column(layout.model), set()).update(rows)
    return {column: rows - {NONE} for column, rows in found.items()}


_Table = Mapping[str, Column]


@dataclass(frozen=True, eq=False)
class OtherTables:
    """The table on other meshes.

    Parameters
    ----------
    problem : ContactProblem
    combined : Combined
        On the mesh that half-widths are for.
    others : tuple of (Combined, ContactProblem)
        None where no other mesh could be solved.
    why : str
        Why that is; else empty.
    picked : mapping
        Half-widths by column and row of what envelopes name, of a table that is in a file; of others empty.
    """

    problem: ContactProblem
    combined: Combined
    others: tuple[tuple[Combined, ContactProblem], ...]
    why: str
    picked: Mapping[tuple[str, int], float]

    @classmethod
    def solved(
        cls, problem: ContactProblem, combined: Combined, twins: Twins, table: str | os.PathLike[str] | None
    ) -> OtherTables:
        """Solve on other meshes; a table in a file gains the half-widths of its columns."""
        files: list[FilePath] = []

        def on_other(other: ContactProblem, watcher: Watcher) -> tuple[Combined, ContactProblem]:
            file = None if table is None else FilePath(f"{table}-{len(other.mesh.elements)}")
            found = solve_table(other, watcher, file), other
            files.extend([] if file is None else [file])
            return found

        try:
            found, why = twins.others(on_other)
            none = cls(problem, combined, tuple(found), why, {})
            picked = none._widen(FilePath(table), files) if table is not None and found else {}
        finally:
            for file in files:
                file.unlink()
        return cls(problem, combined, tuple(found), why, picked)

    @cached_property
    def meshes(self) -> Meshes:
        """The mesh that half-widths are for, and the others."""
        return Meshes.of(self.problem.mesh, [other.mesh for _, other in self.others], bool(self.why))

    @cached_property
    def widths(self) -> Mapping[str, Floats]:
        """Half-widths of the table's columns, ``<column>:plus_minus``; none without other meshes."""
        if not self.others:
            return {}
        every = [(self.combined, self.problem), *self.others]
        tables = [rows_of(combined, partial(solve_rows, problem, watching(None, ""))) for combined, problem in every]
        return self._rows.widths(self._in_order(tables), self.meshes, self.combined.combinations[:])

    def width(self, column: str, row: int) -> float | None:
        """The half-width of a number that an envelope names; None where there is none."""
        if self.picked:
            return _known(self.picked.get((column, row)))
        return _known(self.widths[column + ENDING][row]) if column + ENDING in self.widths else None

    @property
    def _rows(self) -> Rows:
        return Rows(self.problem.discretisation, self.combined.layout)

    def _in_order(self, tables: Sequence[_Table]) -> list[_Table]:
        """Tables of this mesh and the others, in the order in which meshes are compared."""
        every = [self.problem.mesh, *(other.mesh for _, other in self.others)]
        return [tables[every.index(mesh)] for mesh in self.meshes.every]

    def _widen(self, table: FilePath, files: Sequence[FilePath]) -> Mapping[tuple[str, int], float]:
        # Only this function needs pyarrow.
        from signorini.formats.parquet import widen

        rows, wanted, picked, first = self._rows, _named(self.combined), dict[tuple[str, int], float](), 0

        def more(blocks: Sequence[Mapping[str, Floats]]) -> Mapping[str, Floats]:
            nonlocal first
            count = len(next(iter(blocks[0].values())))
            found = rows.widths(self._in_order(blocks), self.meshes, self.combined.combinations[first : first + count])
            for column, numbers in wanted.items():
                here = [number for number in numbers if first <= number < first + count]
                if column + ENDING in found:
                    picked.update(((column, number), found[column + ENDING][number - first]) for number in here)
            first += count
            return found

        widen(table, files, more)
        return picked


def _known(width: float | None) -> float | None:
    return None if width is None or np.isnan(width) else float(width)
