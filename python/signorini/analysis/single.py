"""Solve combinations: one by itself, several in parallel, or all as sums of the solutions for load cases and points."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from signorini import _core
from signorini.analysis.combinations import Combined, Sink, Ways, combine
from signorini.analysis.tightening import tightened_by
from signorini.base.arguments import made_by, watching
from signorini.base.progress import Progress, Watcher, steps_of
from signorini.contact.certificate import certified
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer, chosen
from signorini.contact.strategy import WORDS, answered, refusal, uncertain
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats
from signorini.equilibrium.balance import allowed_motions, work_of
from signorini.equilibrium.imbalance import CONTRADICTION, explain, imbalance, imbalance_of
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError
from signorini.model import Combination
from signorini.results.recovery import recovered, unsolved_result
from signorini.results.result import Result
from signorini.results.rows import Column, together


def solve_one(problem: ContactProblem, combination: Combination, progress: Watcher | None = None) -> Result:
    """Solve one combination by itself.

    Raises `NotCertifiedError` if the answer fails its certificate.
    """
    made_by(problem, ContactProblem, "Make one with signorini.contact_problem(model).", "problem")
    return timed(problem, combination, watching(progress, "progress"))[0]


def timed(problem: ContactProblem, combination: Combination, watcher: Watcher) -> tuple[Result, float]:
    """Result of one combination, and the duration of its contact problem in seconds."""
    discretisation = problem.discretisation
    load = discretisation.load(combination)

    begun = time.perf_counter()
    message = explain(discretisation, imbalance_of(discretisation, problem.freedom, combination))
    if not message:
        try:
            problem = tightened_by(problem, combination.factors or {}, watcher)
        except NoEquilibriumError as error:
            message = str(error)
    discretisation = problem.discretisation
    if message:
        return unsolved_result(discretisation, combination, message), time.perf_counter() - begun
    tried = answered(problem, load, steps_of(combination.name, watcher))
    spent = time.perf_counter() - begun
    if tried.contradiction:
        # Reactions exist that balance the load, so the gaps contradict each other (docs/theory.md, section 5).
        return unsolved_result(discretisation, combination, CONTRADICTION), spent
    if tried.certificate is None:
        raise NotCertifiedError(
            f'Combination "{combination.name}" has no answer that could be certified. {uncertain(discretisation)}'
        )
    if not tried.passed:
        why = refusal(combination.name, discretisation, load, tried.answer, tried.certificate)
        raise NotCertifiedError(f"Combination {why}")
    return recovered(discretisation, combination, tried.methods, load, tried.answer, tried.certificate), spent


_MOST = 64
_MOST_NUMBERS = 4_000_000
"""Largest number of combinations in one batch, and largest number of values stored for them."""
_FEWEST = 8
"""Smallest number of combinations in one batch. All combinations of a batch share each pass through the factor."""


def solve_several(
    problem: ContactProblem,
    combinations: Sequence[Combination],
    single: Callable[[Combination], Result],
    begin: Callable[[str], None],
) -> Iterator[Result]:
    """Yield the results of combinations in their order; the problem's method is the active set.

    Each result is certified and independent of the other combinations. Uncertified combinations, and those with
    doubtful equilibrium, are passed to ``single``. ``begin`` is called with the name of the first combination of each
    batch, before and after each step; an exception in it ends the run.
    """
    discretisation = problem.discretisation
    rays = allowed_motions(problem.freedom.on_mesh)
    numbers = 8 * discretisation.dof_count + 4 * len(discretisation.contacts)
    size = int(np.clip(_MOST_NUMBERS // numbers, _FEWEST, _MOST))
    for first in range(0, len(combinations), size):
        some = combinations[first : first + size]
        watch = partial(begin, some[0].name)
        watch()
        yield from _solve(problem, rays, some, single, watch)


def _solve(
    problem: ContactProblem,
    rays: Floats | None,
    combinations: Sequence[Combination],
    single: Callable[[Combination], Result],
    watch: Callable[[], None],
) -> Iterator[Result]:
    discretisation = problem.discretisation

    def surely_balanced(load: CaseLoad) -> bool:
        """Whether the load does no positive work in any motion that supports allow, so that reactions balance it."""
        if rays is None:
            return imbalance(discretisation, problem.freedom, load.weighing) is None
        work = work_of(discretisation, problem.freedom, load.weighing) if problem.freedom.count else np.zeros(0)
        return not len(work) or bool((rays @ work).max(initial=0.0) <= 0.0)

    loads = {number: discretisation.load(combination) for number, combination in enumerate(combinations)}
    loads = {number: load for number, load in loads.items() if surely_balanced(load)}
    answers: dict[int, tuple[_core.ContactSolution, Floats]] = {}
    if loads:
        nodal, curvatures, couples = (
            np.array([getattr(load, part) for load in loads.values()]).reshape(len(loads), -1)
            for part in ("nodal", "curvature", "couples")
        )
        solved = _core.solve_together(problem.core, problem.reference, nodal, discretisation.held.values, watch)
        stresses = _core.solution_stresses(discretisation.plate, solved, curvatures, couples)
        answers = dict(zip(loads, zip(solved, stresses, strict=True), strict=True))
    for number, combination in enumerate(combinations):
        if number in answers and answers[number][0].status == "solved":
            solution, stress = answers.pop(number)
            load = loads[number]
            least = chosen(discretisation, problem.freedom, load.nodal, Answer.of(discretisation, solution))
            answer, certificate = certified(discretisation, load, least)
            if certificate.passed:
                yield recovered(discretisation, combination, (problem.method,), load, answer, certificate, stress)
                continue
        yield single(combination)


def mean_load(discretisation: Discretisation) -> Floats:
    """Mean nodal load (3n,) of all combinations; it is independent of the order of the combinations."""
    combinations = discretisation.model.effective_combinations
    factors: dict[str, list[float]] = {}
    for combination in combinations:
        for case, factor in (combination.factors or {}).items():
            factors.setdefault(case, []).append(factor / len(combinations))
    mean = {case: math.fsum(sorted(all_)) for case, all_ in factors.items()}
    return discretisation.load(Combination.model_construct(name="mean", factors=mean)).nodal


def solve_rows(problem: ContactProblem, watcher: Watcher, sink: Sink | None = None) -> Combined:
    """Solve every combination as a row of a table."""

    def show(step: int, changing: int, residual: float) -> None:
        watcher(Progress("the mean", step, changing, residual, method=WORDS[problem.method]))

    mean = mean_load(problem.discretisation)

    def begin(name: str) -> None:
        watcher(Progress(name))

    def ways(combination: Combination) -> Ways:
        try:
            own = tightened_by(problem, combination.factors or {}, watcher).near(mean, show)
        except NoEquilibriumError:
            return Ways(problem, partial(solve_one, problem, progress=watcher), None)
        return Ways(own, partial(solve_one, own, progress=watcher), partial(solve_several, own, begin=begin))

    return combine(problem.discretisation, ways, begin, sink)


def solve_table(problem: ContactProblem, watcher: Watcher, table: str | os.PathLike[str] | None) -> Combined:
    """Solve every combination as a row of a table, and write the rows to the file ``table`` unless it is None."""
    if table is None:
        return solve_rows(problem, watcher)
    # This import loads pyarrow, which is needed for Parquet files only.
    from signorini.formats.parquet import writing

    try:
        with writing(table, problem.discretisation.model.provenance.metadata) as sink:
            return solve_rows(problem, watcher, sink)
    except OSError as error:
        why = error.strerror or str(error)
        raise InputError(f"the table cannot be written there: {why}. Name another file.", str(table)) from None


def rows_of(combined: Combined, again: Callable[[Sink], object]) -> Mapping[str, Column]:
    """Return the columns of all rows; if they were not stored, ``again`` is called to solve the rows again."""
    if combined.rows is not None:
        return combined.rows
    blocks = list[list[tuple[str, Column]]]()
    again(lambda columns: blocks.append(list(columns)))
    return together(blocks)
