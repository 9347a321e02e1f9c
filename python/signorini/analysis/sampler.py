"""Certified states along a load path, and the functions of them whose signs change at its events."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from signorini.analysis.path_loads import PathLoads
from signorini.base.progress import Progress, Watcher
from signorini.contact.certificate import Certificate
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer
from signorini.contact.strategy import answered, uncertain
from signorini.discretise.rows import Floats
from signorini.discretise.supports import can_let_go
from signorini.equilibrium.imbalance import CONTRADICTION, supports_contradict
from signorini.errors import NoEquilibriumError, NotCertifiedError
from signorini.results.load_path import beside
from signorini.results.path_events import LEVELS, Threshold, margins
from signorini.results.path_stop import PathStop, path_stops
from signorini.results.support_points import Scales


@dataclass(eq=False)
class State:
    """A certified answer at some t, and what it says."""

    t: float
    answer: Answer
    certificate: Certificate
    stop: PathStop
    margins: list[Floats]
    """By support, in the order of the model."""
    own: bool
    """Whether the problem's own method found it, so that it can begin with it again."""


class Watch(NamedTuple):
    """A function of the state whose sign changes at an event: a margin of a support, or of a threshold."""

    support: int | None
    number: int
    """Of the margin; of thresholds which one."""


@dataclass(eq=False)
class Sampler:
    """Solves a problem along its path, each time from the answer before."""

    problem: ContactProblem
    path: PathLoads
    asked: tuple[Threshold, ...]
    watcher: Watcher
    scales: Scales | None = None
    watched: tuple[bool, ...] = field(init=False)

    def __post_init__(self) -> None:
        """See which supports can let go."""
        self.watched = tuple(can_let_go(support) for support in self.problem.discretisation.model.support)

    def state(self, t: float, near: State | None = None) -> State:
        """Solve at some t, from a state near it if there is one.

        Raises
        ------
        NotCertifiedError
            If the answer fails its certificate.
        NoEquilibriumError
            If the supports contradict each other.
        """
        result, load, made_of = self.problem.discretisation, self.path.at(t), beside(self.path.loads, t)
        start = near.answer if near is not None and near.own and near.answer.solution is not None else None

        def steps(method: str, step: int, changing: int, residual: float) -> None:
            self.watcher(Progress(f"t = {t:.6g}", step, changing, residual, method=method))

        self.watcher(Progress(f"t = {t:.6g}"))
        tried = answered(self.problem, load, steps, made_of, start)
        if tried.contradiction or (tried.certificate is None and near is None and supports_contradict(result)):
            raise NoEquilibriumError(CONTRADICTION)
        answer, certificate = tried.answer, tried.certificate
        if certificate is None or not certificate.passed:
            raise NotCertifiedError(
                f"The contact problem at t = {t:g} has no answer that could be certified. {uncertain(result)}"
            )
        if self.scales is None or (near is not None and near.t == 0 and not self.path.loads[0].nodal.any()):
            # Without load there is nothing to compare with.
            self.scales = Scales.of(answer)
        none = [np.zeros(0, np.int64)]
        (stop,) = path_stops(result, [t], [load], none, none, [answer])
        of_supports = [
            margins(result, index, answer, self.scales, float(stop.parts[index])) if watched else np.ones(0)
            for index, watched in enumerate(self.watched)
        ]
        own = tried.methods == (self.problem.method,)
        return State(t, answer, certificate, stop, of_supports, own)

    def value(self, state: State, watch: Watch) -> float:
        """The function of a watch."""
        if watch.support is not None:
            return float(state.margins[watch.support][watch.number])
        threshold = self.asked[watch.number]
        return state.stop.number(threshold.quantity) - threshold.value

    def exact(self, watch: Watch) -> bool:
        """Whether the function is linear in t between the events of contact points."""
        if watch.support is None:
            return self.asked[watch.number].linear
        support = self.problem.discretisation.model.support[watch.support]
        return support.area is None or LEVELS[watch.number] in (0.0, 1.0)

    def changed(self, before: State, after: State) -> list[Watch]:
        """Which functions have another sign at the end of a stretch than at its beginning."""
        result = [
            Watch(index, int(number))
            for index, (one, other) in enumerate(zip(before.margins, after.margins, strict=True))
            for number in np.flatnonzero((one >= 0) != (other >= 0))
        ]
        for number in range(len(self.asked)):
            watch = Watch(None, number)
            if (self.value(before, watch) >= 0) != (self.value(after, watch) >= 0):
                result.append(watch)
        return result
