"""Load paths by following every contact point from event to event."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from signorini import _core
from signorini.analysis.path_check import confirmed
from signorini.analysis.path_judge import PathJudge
from signorini.analysis.path_loads import PathLoads
from signorini.base.progress import Progress, Watcher
from signorini.contact.certificate import Certificate
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer
from signorini.contact.strategy import WORDS, methods_along, uncertain
from signorini.discretise.rows import Ints
from signorini.equilibrium.imbalance import CONTRADICTION, supports_contradict
from signorini.errors import NoEquilibriumError, NotCertifiedError
from signorini.results.exact_path import ExactPath
from signorini.results.load_path import AT_LIMIT, Ending
from signorini.results.path_events import Threshold, events_of_stops, first_reached


def exact_path(
    problem: ContactProblem, path: PathLoads, until: float | None, asked: tuple[Threshold, ...], watcher: Watcher
) -> ExactPath:
    """Follow every contact point.

    Raises
    ------
    NoEquilibriumError
        If the supports contradict each other.
    NotCertifiedError
        If the start was not solved.
    """
    discretisation = problem.discretisation
    traced: ExactPath | None = None
    for other_problem in methods_along(problem):
        other = _trace(other_problem, problem, path, until, watcher)
        traced = other if traced is None or (other is not None and other.end > traced.end) else traced
        if traced is not None and (traced.ending != "stopped" or traced.ends_with_the_mesh or traced.interrupted):
            break
    if traced is None and supports_contradict(discretisation):
        raise NoEquilibriumError(CONTRADICTION)
    if traced is None:
        raise NotCertifiedError(
            f"The contact problem at t = 0 has no answer that could be certified. {uncertain(discretisation)}"
        )
    return replace(traced, thresholds=tuple(first_reached(one, traced.stops) for one in asked))


def _trace(
    problem: ContactProblem,
    direct: ContactProblem,
    path: PathLoads,
    until: float | None,
    watcher: Watcher,
) -> ExactPath | None:
    """Follow the path by one method, as far as its answers are certified and confirmed; None if not at all."""
    result, loads, limits = problem.discretisation, path.loads, path.limits
    judge, at = PathJudge(problem, loads), list[float]()
    method = WORDS[problem.method]
    limit, asked = limits[0], np.inf if until is None else until
    end, interrupted = min(*limits, asked), False

    def visit(t: float, points: Ints, solution: _core.ContactSolution) -> None:
        judge.take(t, points, Answer.of(result, solution))
        at.append(t)
        whole = f" of {end:.6g}" if np.isfinite(end) else ""
        watcher(Progress(f"t = {t:.6g}{whole}, event {len(at)}"))

    def show(step: int, changing: int, residual: float) -> None:
        where = f"after t = {at[-1]:.6g}" if at else "t = 0"
        watcher(Progress(where, step, changing, residual, method=method))

    try:
        ended = problem.core.path(loads[0].nodal, loads[1].nodal, result.held.values, end, visit, show)
        judge.judge()
    except NotCertifiedError:
        ended = "unsolved"
    except KeyboardInterrupt:
        ended, interrupted = "unsolved", True
        judge.judge()
    stops, certificates, doubts = judge.stops, judge.certificates, judge.doubts
    count = len(stops) if interrupted else confirmed(direct, loads, stops, watcher)
    if interrupted and not count:
        raise KeyboardInterrupt
    if count == 0 or judge.first is None:
        return None
    whole = count == len(stops) and not interrupted
    del stops[count:], certificates[count:]
    near_limit = stops[-1].t >= limit * (1 - AT_LIMIT)
    ending: Ending = "stopped"
    if whole and ended == "unbounded":
        ending = "no_more_events"
    elif whole and ended != "too_many" and near_limit:
        ending = "no_equilibrium"
    elif whole and ended == "reached" and end == asked:
        ending = "until"
    worst = Certificate.worst(certificates)
    doubted = tuple(index for index in doubts if index < len(stops) - 1)
    events = events_of_stops(result.model.support, stops)
    known = (*path.names, problem, tuple(stops), ending, *limits, worst, events, (), interrupted, loads)
    return ExactPath(*known, _first=judge.first, _doubtful=doubted)
