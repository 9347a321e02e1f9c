"""Many combinations of one active set side by side, so that the factor is read once for all of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence

import numpy as np

from signorini import _core
from signorini.contact.certificate import certified
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer, chosen
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.equilibrium.balance import allowed_motions, work_of
from signorini.model import Combination
from signorini.results.result import Result

_MOST = 64
_MOST_NUMBERS = 4_000_000
"""Combinations, and numbers of theirs, that are in memory at once."""
_FEWEST = 8
"""Combinations for which the factor is read together."""


def solve_several(
    problem: ContactProblem,
    combinations: Sequence[Combination],
    single: Callable[[Combination], Result],
    begin: Callable[[str], None],
) -> Iterator[Result]:
    """Yield the results of combinations in their order.

    Each is the same whatever stands beside it, and certified. One that is not, and one of which equilibrium is not
    beyond doubt, is left to ``single``.

    Parameters
    ----------
    problem : ContactProblem
        With an active set.
    combinations : sequence of Combination
    single : callable
        Solves one combination by itself.
    begin : callable
        Called with the name of the first combination of those that begin, and again after their steps; what it raises
        ends the run.
    """
    discretisation = problem.discretisation
    rays = allowed_motions(problem.freedom.on_mesh)
    numbers = 8 * discretisation.dof_count + 4 * len(discretisation.contacts)
    size = int(np.clip(_MOST_NUMBERS // numbers, _FEWEST, _MOST))
    for first in range(0, len(combinations), size):
        yield from _solve(problem, rays, combinations[first : first + size], single, begin)


def _solve(
    problem: ContactProblem,
    rays: Floats,
    combinations: Sequence[Combination],
    single: Callable[[Combination], Result],
    begin: Callable[[str], None],
) -> Iterator[Result]:
    discretisation = problem.discretisation

    def watch() -> None:
        begin(combinations[0].name)

    watch()
    loads = {
        number: load
        for number, combination in enumerate(combinations)
        if _surely_balanced(problem, rays, (load := discretisation.load(combination)).weighing)
    }
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
                yield Result.of(discretisation, combination, (problem.method,), load, answer, certificate, stress)
                continue
        yield single(combination)


def _surely_balanced(problem: ContactProblem, rays: Floats, nodal: Floats) -> bool:
    """Whether a load does no work in any motion that the supports allow, so that reactions balance it."""
    if not problem.freedom.count:
        return True
    return bool((rays @ work_of(problem.discretisation, problem.freedom, nodal)).max(initial=0.0) <= 0.0)


def mean_load(discretisation: Discretisation) -> Floats:
    """The mean of all combinations (3n,), whatever their order."""
    combinations = discretisation.model.effective_combinations
    factors: dict[str, list[float]] = {}
    for combination in combinations:
        for case, factor in (combination.factors or {}).items():
            factors.setdefault(case, []).append(factor / len(combinations))
    mean = {case: math.fsum(sorted(all_)) for case, all_ in factors.items()}
    return discretisation.load(Combination.model_construct(name="mean", factors=mean)).nodal
