"""One combination by itself, certified."""

from __future__ import annotations

import time

from signorini.base.arguments import made_by, watching
from signorini.base.progress import Progress, Watcher
from signorini.contact.problem import ContactProblem
from signorini.contact.strategy import answered, refusal, uncertain
from signorini.equilibrium.imbalance import CONTRADICTION, explain, imbalance_of
from signorini.errors import NotCertifiedError
from signorini.model import Combination
from signorini.results.result import Result, unsolved_result


def solve_one(problem: ContactProblem, combination: Combination, progress: Watcher | None = None) -> Result:
    """Solve one combination by itself.

    Raises
    ------
    NotCertifiedError
        If the answer fails its certificate; it is refused.

    Examples
    --------
    >>> from signorini import Model, contact_problem
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    ...     support=[{"name": "bearings", "at": [[1, 1], [9, 1], [1, 9], [9, 9]], "resists": "down"}],
    ...     load=[{"case": "G", "pressure": 2e3}],
    ... )
    >>> (combination,) = model.effective_combinations
    >>> round(solve_one(contact_problem(model), combination).reactions["bearings"], 3)
    200000.0
    """
    made_by(problem, ContactProblem, "Make one with signorini.contact_problem(model).", "problem")
    return timed(problem, combination, watching(progress, "progress"))[0]


def timed(problem: ContactProblem, combination: Combination, watcher: Watcher) -> tuple[Result, float]:
    """One combination, and the seconds its contact problem took."""
    discretisation = problem.discretisation
    load = discretisation.load(combination)

    def steps(method: str, step: int, changing: int, residual: float) -> None:
        watcher(Progress(combination.name, step, changing, residual, method=method))

    begun = time.perf_counter()
    message = explain(discretisation, imbalance_of(discretisation, problem.freedom, combination))
    if message:
        return unsolved_result(discretisation, combination, message), time.perf_counter() - begun
    tried = answered(problem, load, steps)
    spent = time.perf_counter() - begun
    if tried.contradiction:
        # Reactions that balance the load exist, so it is the gaps that cannot be (docs/theory.md, section 5).
        return unsolved_result(discretisation, combination, CONTRADICTION), spent
    if tried.certificate is None:
        raise NotCertifiedError(
            f'Combination "{combination.name}" has no answer that could be certified. {uncertain(discretisation)}'
        )
    if not tried.passed:
        why = refusal(combination.name, discretisation, load, tried.answer, tried.certificate)
        raise NotCertifiedError(f"Combination {why}")
    return Result.of(discretisation, combination, tried.methods, load, tried.answer, tried.certificate), spent
