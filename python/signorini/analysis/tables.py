"""All combinations of a model as rows of a table."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence

from signorini.analysis.batch import mean_load, solve_several
from signorini.analysis.combinations import Combined, Sink, combine
from signorini.analysis.single import solve_one
from signorini.base.progress import Progress, Watcher
from signorini.contact.problem import ContactProblem
from signorini.contact.strategy import WORDS
from signorini.errors import InputError, NoEquilibriumError
from signorini.model import Combination
from signorini.results.result import Result
from signorini.results.rows import Column, together

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
