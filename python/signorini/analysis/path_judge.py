"""The stops of a load path, judged and reduced to what the path keeps of them, some at a time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from signorini.contact.certificate import Certificate, certified, certify_each, imbalances
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer, chosen, doubtful
from signorini.discretise import CaseLoad
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import NotCertifiedError
from signorini.results.exact_path import ahead
from signorini.results.load_path import beside
from signorini.results.path_stop import PathStop, path_stops

_LOST = 1e-6
"""What reactions may miss of the loads that have a resultant: a path decides by less than a single answer shows."""
_TURNS = 1e-9
"""Part of the largest reaction below which a sign is rounding, and of a segment within which signs change together."""
_AT_ONCE = 64
_NUMBERS = 500_000
"""Displacements of the stops that are judged together: arrays of 4 MB."""


@dataclass(eq=False)
class PathJudge:
    """Takes answers as the path comes to them.

    Parameters
    ----------
    problem : ContactProblem
    loads : tuple of CaseLoad
        At t = 0, and what grows.
    stops, certificates : list
        Of the answers that are judged, as far as all passed.
    doubts : list of int
        Numbers of stops up to the next of which more answers than one may be right.
    first : (m,) array or None
        The contact set from t = 0 on.
    """

    problem: ContactProblem
    loads: tuple[CaseLoad, CaseLoad]
    stops: list[PathStop] = field(default_factory=list)
    certificates: list[Certificate] = field(default_factory=list)
    doubts: list[int] = field(default_factory=list)
    first: Bools | None = None
    _waiting: list[tuple[float, Ints, Answer]] = field(default_factory=list)
    _before: tuple[float, Answer] | None = None
    _last: tuple[float, Answer] | None = None
    _shown: Bools | None = None

    def take(self, t: float, points: Ints, answer: Answer) -> None:
        """Take the answer at t, from which on ``points`` open or close; raise `NotCertifiedError` where one fails."""
        for turn in self._turns(t, answer):
            self._put(*turn)
        self._put(t, points, answer)

    def _put(self, t: float, points: Ints, answer: Answer) -> None:
        self._last = t, answer
        self._waiting.append((t, points, answer))
        if len(self._waiting) >= min(_AT_ONCE, max(1, _NUMBERS // self.problem.discretisation.dof_count)):
            self.judge()

    def _turns(self, t: float, answer: Answer) -> Iterator[tuple[float, Ints, Answer]]:
        """Stops on the way to the answer at t at which supports share a reaction otherwise, since its sign changes."""
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
            solution = self.problem.core.solve_on(load.nodal, discretisation.held.values, before.closed)
            if begin < turn < t and solution.status == "solved":
                yield turn, np.zeros(0, np.int64), Answer.of(discretisation, solution)

    def judge(self) -> None:
        """Judge those that wait."""
        if not self._waiting:
            return
        result, waiting, self._waiting = self.problem.discretisation, self._waiting, []
        at, points, answers = [list(column) for column in zip(*waiting, strict=True)]
        loads = [self.loads[0] + t * self.loads[1] for t in at]
        hi, lo, reaction = (np.array([getattr(one, name) for one in answers]) for name in ("hi", "lo", "reaction"))
        closed = np.array([answer.closed for answer in answers])
        # What stands on one set at both ends of a segment is proven between them.
        before = np.concatenate([closed[:1] if self._before is None else self._before[1].closed[None], closed[:-1]])
        made_of = [beside(self.loads, t) for t in at]
        imbalance = imbalances(result, loads, hi, lo)
        certificates = certify_each(result, loads, hi, lo, reaction, (before, closed), made_of, imbalance)
        passed = next((row for row, one in enumerate(certificates) if not one.passed), len(at))
        doubts = self._doubtful(at, answers)
        if self.first is None and passed:
            self.first = closed[0]

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
        # Of points that repeat each other all open or close, not only the one that the path is followed with.
        switched = []
        for row, one in enumerate(least):
            changed = None if self._shown is None else np.flatnonzero(one.closed != self._shown)
            switched.append(points[row] if changed is None else changed)
            self._shown = one.closed
        self.doubts += [
            len(self.stops) + row - 1 for row in np.flatnonzero(doubts[: count + (count < passed)]).tolist()
        ]
        if count:
            self.stops += path_stops(
                result, at[:count], loads[:count], points[:count], switched, least, imbalance[:count]
            )
        self._before = (at[-1], answers[-1])
        if count < len(at):
            raise NotCertifiedError

    def _doubtful(self, at: list[float], answers: list[Answer]) -> Bools:
        """Whether between each answer and the one before it more than one may be right."""
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

    def _least(self, t: float, load: CaseLoad, answer: Answer, before: Answer | None) -> Answer:
        """The least of the answers at t that lead from the one before to what comes."""

        def elsewhere() -> Iterator[Floats]:
            if before is not None:
                yield before.reaction
            yield answer.reaction
            yield from ahead(self.problem, self.loads, t, answer.closed)

        return chosen(self.problem.discretisation, self.problem.freedom, load.nodal, answer, elsewhere)
