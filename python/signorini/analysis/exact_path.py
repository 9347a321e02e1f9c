"""Exact load paths: every contact point is followed from event to event; direct solutions confirm some stops."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from signorini import _core
from signorini.analysis.sampler import PathLoads
from signorini.base.progress import Progress, Watcher, steps_of
from signorini.contact.certificate import Certificate, certified, certify_each, imbalances, least_deflection
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer, chosen, doubtful
from signorini.contact.strategy import WORDS, answered, posed_for_methods, uncertain
from signorini.discretise import CaseLoad
from signorini.discretise.rows import Bools, Floats, Ints, Pieces
from signorini.equilibrium.imbalance import CONTRADICTION, supports_contradict
from signorini.errors import NoEquilibriumError, NotCertifiedError
from signorini.results.exact_path import ExactPath, ahead
from signorini.results.load_path import AT_LIMIT, Ending, beside
from signorini.results.path_events import Threshold, events_of_stops, first_reached
from signorini.results.path_stop import PathStop, Switched, path_stops

_SAME = 1e-6
"""Largest difference of a path from a direct solution, relative to the largest deflection or to the load's work."""
_MOVED = 1e-9
"""Largest difference that may be rounding between the works of path and direct solution, relative to Σ |nodal load ×
displacement|. Where the plate moves freely, the rounding error of t changes the work by about this part of the sum.
"""
_AT = 1e-12
"""Rounding error of t at an event, relative to t. If the loads at t = 0 and t·add cancel, their sum is not zero but
this fraction of each load.
"""
_SAMPLES = 11
"""Number of equal intervals of a path's stops; direct solutions check the first and last stop of each interval."""


def confirmed(
    problem: ContactProblem, loads: tuple[CaseLoad, CaseLoad], stops: Sequence[PathStop], watcher: Watcher
) -> int:
    """Number of consecutive stops, from the first, that direct solutions confirm.

    Up to 12 stops are checked. If a check fails, bisection finds the first stop at which the direct solution differs.
    """
    last, agreed = len(stops) - 1, -1
    for k in sorted({round(i * last / _SAMPLES) for i in range(_SAMPLES + 1)} if stops else ()):
        if agrees(problem, loads, stops[k], watcher):
            agreed = k
            continue
        wrong = k
        while wrong - agreed > 1:
            middle = (agreed + wrong) // 2
            if agrees(problem, loads, stops[middle], watcher):
                agreed = middle
            else:
                wrong = middle
        return wrong
    return len(stops)


def agrees(problem: ContactProblem, loads: tuple[CaseLoad, CaseLoad], stop: PathStop, watcher: Watcher) -> bool:
    """Whether a direct solution at a stop's t agrees with it in deflections or, if several solutions exist, in work.

    If no direct solution is certified, the stop counts as right, since its own answer is certified.
    """
    result, load = problem.discretisation, loads[0] + stop.t * loads[1]

    tried = answered(problem, load, steps_of(f"t = {stop.t:.6g}, solved anew", watcher))
    if not tried.passed:
        return True
    (direct,) = path_stops(result, [stop.t], [load], [stop.points[:0]], [Switched()], [tried.answer])
    shown, wanted = (np.array([s.largest, s.smallest, *s.deflections]) for s in (stop, direct))
    apart = np.abs(shown - wanted).max() > _SAME * max(np.abs(wanted).max(), least_deflection(result, load))
    parts = sum(float(np.abs(part.nodal).max()) for part in beside(loads, stop.t))
    size = float(np.abs(load.nodal).max())
    rounding = max(_MOVED * size, _AT * parts) * max(direct.work_size, stop.work_size)
    return not apart or size * abs(direct.work - stop.work) <= max(size * _SAME * abs(direct.work), rounding)


_LOST = 1e-6
"""Largest relative error of the resultant of the reactions at an accepted stop. The certificate of a single answer
allows more, but smaller differences decide the contact states of a path.
"""
_TURNS = 1e-9
"""Smallest reaction whose sign counts, relative to the largest reaction; smallest distance in t of two changes of sign,
relative to the distance of two stops."""
_AT_ONCE = 64
_NUMBERS = 500_000
"""Largest number of stops that are certified together, and largest number of dofs of their displacements together
(arrays of 4 MB).
"""


@dataclass(eq=False)
class PathJudge:
    """Collects the answers of a path, certifies them, and stores them as stops."""

    problem: ContactProblem
    loads: tuple[CaseLoad, CaseLoad]
    """Load at t = 0, and load added per unit of t."""
    stops: list[PathStop] = field(default_factory=list)
    certificates: list[Certificate] = field(default_factory=list)
    """Certificates of the answers; the list ends before the first answer that fails."""
    doubts: list[int] = field(default_factory=list)
    """Numbers of the stops after which, up to the next stop, the answer may not be unique."""
    first: Pieces | None = None
    """(m,): pieces of the laws of contact points from t = 0 to the first event."""
    _waiting: list[tuple[float, Ints, Answer]] = field(default_factory=list)
    _before: tuple[float, Answer] | None = None
    _last: tuple[float, Answer] | None = None
    _shown: Pieces | None = None

    def take(self, t: float, points: Ints, answer: Answer) -> None:
        """Record the answer at t, where the contact points ``points`` open or close.

        Raises `NotCertifiedError` if a certificate fails.
        """
        for turn in self._turns(t, answer):
            self._put(*turn)
        self._put(t, points, answer)

    def _put(self, t: float, points: Ints, answer: Answer) -> None:
        self._last = t, answer
        self._waiting.append((t, points, answer))
        if len(self._waiting) > min(_AT_ONCE, max(1, _NUMBERS // self.problem.discretisation.dof_count)):
            self.judge(keep=1)

    def _turns(self, t: float, answer: Answer) -> Iterator[tuple[float, Ints, Answer]]:
        """Yield a stop for each t after the last stop at which a reaction with a dependent row of G changes sign."""
        discretisation = self.problem.discretisation
        if self._last is None or self._last[0] == t or not discretisation.shared:
            return
        begin, before = self._last
        ends = np.array([discretisation.by_sign(one.shared) for one in (before, answer)])
        nothing = _TURNS * max(np.abs(one.reaction).max() for one in (before, answer))
        first, last = ends[:, (ends.min(axis=0) < -nothing) & (ends.max(axis=0) > nothing)]
        at = 0.0
        for part in np.sort(first / (first - last)).tolist():
            if part - at <= _TURNS:
                continue
            at, turn = part, begin + part * (t - begin)
            load = self.loads[0] + turn * self.loads[1]
            solution = self.problem.core.solve_on(load.nodal, discretisation.held.values, before.piece)
            if begin < turn < t and solution.status == "solved":
                yield turn, np.zeros(0, np.int64), Answer.of(discretisation, solution)

    def judge(self, keep: int = 0) -> None:
        """Certify the answers that are recorded but not yet judged, except the last ``keep``; store them as stops."""
        until = len(self._waiting) - keep
        if until <= 0:
            return
        result, waiting, self._waiting = self.problem.discretisation, self._waiting[:until], self._waiting[until:]
        at, points, answers = [list(column) for column in zip(*waiting, strict=True)]
        loads = [self.loads[0] + t * self.loads[1] for t in at]
        hi, lo, reaction = (np.array([getattr(one, name) for one in answers]) for name in ("hi", "lo", "reaction"))
        pieces = np.array([answer.piece for answer in answers])
        # If the contact state is the same at both ends of a segment, certified ends prove the answers between them.
        before = np.concatenate([pieces[:1] if self._before is None else self._before[1].piece[None], pieces[:-1]])
        made_of = [beside(self.loads, t) for t in at]
        imbalance = imbalances(result, loads, hi, lo)
        certificates = certify_each(result, loads, hi, lo, reaction, (before, pieces), made_of, imbalance)
        passed = next((row for row, one in enumerate(certificates) if not one.passed), len(at))
        doubts = self._doubtful(at, answers)
        if self.first is None and passed:
            self.first = pieces[0]

        least: list[Answer] = []
        for row in range(passed):
            earlier = self._before[1] if row == 0 and self._before is not None else answers[row - 1] if row else None
            one = self._least(at[row], loads[row], answers[row], earlier)
            certificate = certificates[row]
            if one is not answers[row]:
                one, certificate = certified(result, loads[row], one, made_of[row])
                imbalance[row] = result.plate.residual(result.springs.arrays, loads[row].nodal, one.hi, one.lo)
            if certificate.lost > _LOST:
                break
            least.append(one)
            self.certificates.append(certificate)
        count = len(least)
        switched, several = [], bool(result.shared) or self.problem.freedom.count > 0
        following = [*waiting[1:], *self._waiting[:1]]
        for row, one in enumerate(least):
            goes_on = row < len(following) and at[row] < following[row][0]
            after = self._between(waiting[row], following[row]) if several and goes_on else one.piece
            changed = points[row] if self._shown is None else np.flatnonzero(after != self._shown)
            switched.append(Switched(changed, (after if self._shown is None else self._shown)[changed], after[changed]))
            self._shown = after
        doubted = np.flatnonzero(doubts[: count + (count < passed)])
        self.doubts += (len(self.stops) + doubted - 1).tolist()
        if count:
            self.stops += path_stops(
                result, at[:count], loads[:count], points[:count], switched, least, imbalance[:count]
            )
        self._before = (at[-1], answers[-1])
        if count < len(at):
            raise NotCertifiedError

    def _doubtful(self, at: list[float], answers: list[Answer]) -> Bools:
        """Mask (k,): whether the answer may not be unique between each t of ``at`` and the t before it."""
        chain = [*([] if self._before is None else [self._before]), *zip(at, answers, strict=True)]
        doubts = np.zeros(len(chain), np.bool_)
        apart = [row for row in range(1, len(chain)) if chain[row - 1][0] < chain[row][0]]
        if apart:
            amid = [
                np.array([0.5 * (getattr(chain[row - 1][1], name) + getattr(chain[row][1], name)) for row in apart])
                for name in ("reaction", "gap")
            ]
            doubts[apart] = doubtful(self.problem.discretisation, self.problem.freedom, amid[0], amid[1])
        return doubts[len(chain) - len(at) :]

    def _between(self, begin: tuple[float, Ints, Answer], end: tuple[float, Ints, Answer]) -> Pieces:
        """Pieces of the laws (m,) between two stops, in the least-norm answer halfway.

        At a stop, points that open there are still closed in the least-norm answer.
        """
        (t, _, one), (next_t, _, other) = begin, end
        middle = 0.5 * (t + next_t)
        names = ("hi", "lo", "reaction", "gap", "shared")
        mean = replace(one, **{name: 0.5 * (getattr(one, name) + getattr(other, name)) for name in names})
        return self._least(middle, self.loads[0] + middle * self.loads[1], mean, one).piece

    def _least(self, t: float, load: CaseLoad, answer: Answer, before: Answer | None) -> Answer:
        """Return the least-norm answer at t, with reactions only at points that also push just before or after t."""

        def elsewhere() -> Iterator[Floats]:
            if before is not None:
                yield before.reaction
            yield answer.reaction
            yield from ahead(self.problem, self.loads, t, answer.piece)

        return chosen(self.problem.discretisation, self.problem.freedom, load.nodal, answer, elsewhere)


def exact_path(
    problem: ContactProblem, path: PathLoads, until: float | None, asked: tuple[Threshold, ...], watcher: Watcher
) -> ExactPath:
    """Follow every contact point from event to event with each method in turn, until a path is complete."""
    discretisation = problem.discretisation
    traced: ExactPath | None = None
    for other_problem in posed_for_methods(problem):
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
    problem: ContactProblem, direct: ContactProblem, path: PathLoads, until: float | None, watcher: Watcher
) -> ExactPath | None:
    """Follow the path with one method while answers are certified and confirmed; None if the start is not certified."""
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
