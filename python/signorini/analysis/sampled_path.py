"""Load paths by samples: certified states at given t, and between them named events and thresholds by root finding."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from signorini.analysis.path_loads import PathLoads
from signorini.base.progress import Progress, Watcher
from signorini.contact.answer import Answer
from signorini.contact.certificate import Certificate, certified
from signorini.contact.problem import ContactProblem
from signorini.contact.refusal import uncertain
from signorini.contact.strategy import answered
from signorini.discretise.rows import Floats
from signorini.discretise.supports import can_let_go
from signorini.equilibrium.limits import CONTRADICTION, supports_contradict
from signorini.errors import NoEquilibriumError, NotCertifiedError
from signorini.results.closed_part import Scales
from signorini.results.load_path import AT_LIMIT, Ending, LoadPath, beside
from signorini.results.margins import LEVELS, margins
from signorini.results.named_events import PathEvent, event_of, first_place
from signorini.results.path_stop import PathStop, path_stops
from signorini.results.support_points import SupportPoints
from signorini.results.thresholds import Threshold, quantities

LINEAR, SMOOTH = 1e-9, 1e-6
"""Parts of the path's length to which the t of an event is found: of what is linear in t between the events of contact
points, and of contact areas and pressures, which are as exact themselves."""
_MOST_STEPS = 100
"""Solves for one event; halving alone takes 30."""
_MOST_DOUBLINGS = 40
_STEADY = 3
"""Doublings of t without a named event after which no more are looked for."""
_AT_ROOT = 1e-7
"""Part of the largest margin of a support's points that is none at the t of an event."""


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

    @cached_property
    def _quantities(self) -> Mapping[str, Callable[[PathStop], float]]:
        return quantities(self.problem.discretisation)

    def state(self, t: float, near: State | None = None, alone: bool = False) -> State:
        """Solve at some t from a state near it; ``alone`` by the problem's own method.

        Raises
        ------
        NotCertifiedError
            If the answer fails its certificate.
        NoEquilibriumError
            If the supports contradict each other.
        """
        found, load, made_of = self.problem.discretisation, self.path.at(t), beside(self.path.loads, t)
        start = near.answer if near is not None and near.own and near.answer.solution is not None else None

        def steps(method: str, step: int, changing: int, residual: float) -> None:
            self.watcher(Progress(f"t = {t:.6g}", step, changing, residual, method=method))

        self.watcher(Progress(f"t = {t:.6g}"))
        own = True
        if alone:
            answer = self.problem.solve(load, start=start)
            certificate = None
            if answer.status == "solved":
                answer, certificate = certified(found, load, answer, made_of)
        else:
            tried = answered(self.problem, load, steps, made_of, start)
            if tried.contradiction or (tried.certificate is None and near is None and supports_contradict(found)):
                raise NoEquilibriumError(CONTRADICTION)
            answer, certificate = tried.answer, tried.certificate
            own = tried.methods == (self.problem.method,)
        if certificate is None or not certificate.passed:
            raise NotCertifiedError(
                f"The contact problem at t = {t:g} has no answer that could be certified. {uncertain(found)}"
            )
        if self.scales is None or (near is not None and near.t == 0 and not self.path.loads[0].nodal.any()):
            # Without load there is nothing to compare with.
            self.scales = Scales.of(answer)
        none = [np.zeros(0, np.int64)]
        (stop,) = path_stops(found, [t], [load], none, none, [answer])
        of_supports = [
            margins(found, index, answer, self.scales, float(stop.parts[index])) if watched else np.ones(0)
            for index, watched in enumerate(self.watched)
        ]
        return State(t, answer, certificate, stop, of_supports, own)

    def value(self, state: State, watch: Watch) -> float:
        """The function of a watch."""
        if watch.support is not None:
            return float(state.margins[watch.support][watch.number])
        threshold = self.asked[watch.number]
        return float(self._quantities[threshold.quantity](state.stop)) - threshold.value

    def exact(self, watch: Watch) -> bool:
        """Whether the function is linear in t between the events of contact points."""
        if watch.support is None:
            return self.asked[watch.number].linear
        support = self.problem.discretisation.model.support[watch.support]
        return support.area is None or LEVELS[watch.number] in (0.0, 1.0)

    def changed(self, before: State, after: State) -> list[Watch]:
        """Which functions have another sign at the end of a stretch than at its beginning."""
        found = [
            Watch(index, int(number))
            for index, (one, other) in enumerate(zip(before.margins, after.margins, strict=True))
            for number in np.flatnonzero((one >= 0) != (other >= 0))
        ]
        for number in range(len(self.asked)):
            watch = Watch(None, number)
            if (self.value(before, watch) >= 0) != (self.value(after, watch) >= 0):
                found.append(watch)
        return found

    def root(self, watch: Watch, known: list[State], span: float) -> State:
        """The state at which the sign of a function changes first among known states, which gain those solved for it.

        Secants of the two states nearest on one side, which are exact on one contact set, within a bracket that is
        halved where they do not lead on.
        """
        signs = [self.value(state, watch) >= 0 for state in known]
        row = next(row for row in range(len(known) - 1) if signs[row] != signs[row + 1])
        low, high = known[row], known[row + 1]
        below, above = known[row - 1] if row else None, known[row + 2] if row + 2 < len(known) else None
        tolerance, slow, failed = span * (LINEAR if self.exact(watch) else SMOOTH), 0, False
        for _ in range(_MOST_STEPS):
            at_low, at_high = self.value(low, watch), self.value(high, watch)
            width = high.t - low.t
            if width <= tolerance:
                return high
            for end, value, other in ((low, at_low, below), (high, at_high, above)):
                if other is None or other.t == end.t:
                    continue
                # Beside a root the slope may be another on either side: forces on one, gaps on the other.
                slope = min(abs(at_high - at_low) / width, abs(value - self.value(other, watch)) / abs(end.t - other.t))
                if abs(value) <= slope * tolerance:
                    return end
            t = 0.5 * (low.t + high.t)
            if slow < 2 and not failed:
                t = self._guess(watch, (below, low, high, above))
            t = min(max(t, low.t + 0.25 * tolerance), high.t - 0.25 * tolerance)
            try:
                state = self.state(t, low if t - low.t < high.t - t else high)
            except NotCertifiedError:
                if failed:
                    raise
                failed = True
                continue
            known.insert(known.index(high), state)
            value = self.value(state, watch)
            if (value >= 0) == (at_low >= 0):
                slow = slow + 1 if high.t - t > 0.5 * width and abs(value) > 0.25 * abs(at_low) else 0
                below, low = low, state
            else:
                slow = slow + 1 if t - low.t > 0.5 * width and abs(value) > 0.25 * abs(at_high) else 0
                above, high = high, state
        return high

    def _guess(self, watch: Watch, states: tuple[State | None, State, State, State | None]) -> float:
        """Where lines through two states each come to zero within the bracket: of one contact set before others."""
        below, low, high, above = states
        guesses = []
        for one, other in ((low, high), (below, low), (high, above)):
            if one is None or other is None or one.t == other.t:
                continue
            first, second = self.value(one, watch), self.value(other, watch)
            if first == second:
                continue
            t = one.t - first * (other.t - one.t) / (second - first)
            same = np.array_equal(one.answer.closed, other.answer.closed)
            if low.t < t < high.t:
                nearest = min(abs(first), abs(second))
                guesses.append((not same, (one, other) == (low, high), nearest, t))
        return min(guesses)[-1] if guesses else 0.5 * (low.t + high.t)


class Hit(NamedTuple):
    """An event that was found."""

    watch: Watch
    state: State
    opening: bool


@dataclass(eq=False)
class SampledPath:
    """Goes along a path, sample by sample, and keeps of the states what a path shows."""

    sampler: Sampler
    stops: dict[float, PathStop] = field(default_factory=dict)
    certificates: list[Certificate] = field(default_factory=list)
    events: list[PathEvent] = field(default_factory=list)
    reached: dict[int, float] = field(default_factory=dict)
    _last: list[State] = field(default_factory=list)

    @property
    def last(self) -> State:
        """The state of the last sample."""
        return self._last[-1]

    def begin(self) -> None:
        """Solve at t = 0."""
        self._keep(state := self.sampler.state(0.0))
        self._last = [state]
        for number, threshold in enumerate(self.sampler.asked):
            if self.sampler.value(state, Watch(None, number)) == 0 and threshold.t is None:
                self.reached[number] = 0.0

    def go_on(self, t: float, span: float, alone: bool = False) -> None:
        """Solve at t, and find what happens on the way."""
        before, sampler = self.last, self.sampler
        after = sampler.state(t, before, alone)
        known = [*self._last, after]
        hits = []
        for watch in sampler.changed(before, after):
            if watch.support is None and watch.number in self.reached:
                continue
            state = sampler.root(watch, known, span)
            # What the plate does as soon as it is loaded is no event.
            if watch.support is None or state.t > LINEAR * span:
                hits.append(Hit(watch, state, sampler.value(before, watch) >= 0))
        for hit in sorted(hits, key=lambda hit: hit.state.t):
            self._keep(hit.state)
            if hit.watch.support is None:
                self.reached[hit.watch.number] = hit.state.t
            else:
                self.events.append(self._event(hit, hit.watch.support))
        self._keep(after)
        self._last = [known[-2], after]

    def _keep(self, state: State) -> None:
        if state.t not in self.stops:
            self.stops[state.t] = state.stop
            self.certificates.append(state.certificate)

    def _event(self, hit: Hit, index: int) -> PathEvent:
        found, state = self.sampler.problem.discretisation, hit.state
        support, own = found.model.support[index], state.margins[index]
        change, closed = event_of(support, hit.watch.number, hit.opening)
        at = None
        if support.place == "at":
            rest = _AT_ROOT * np.abs(own).max()
            closed = float(np.mean(own > rest if hit.opening else own >= -rest))
            x, y = SupportPoints.of(found, index).positions[hit.watch.number].tolist()
            at = x, y
            self._from_there_on(state.t, index, closed, len(own))
        elif change in ("begins to open", "begins to close"):
            at = first_place(found, index, state.answer, hit.opening)
        return PathEvent(0, state.t, support.name, at, change, closed or 0.0, hit.opening, hit.watch.number)

    def _from_there_on(self, t: float, index: int, part: float, count: int) -> None:
        """Show at the stop of an event what of a support is closed from there on, not what its rounding says."""
        stop = self.stops[t]
        parts, closed = stop.parts.copy(), stop.closed.copy()
        parts[index], closed[index] = part, round(part * count)
        self.stops[t] = replace(stop, parts=parts, closed=closed)

    def result(self, ending: Ending, interrupted: bool) -> LoadPath:
        """What was found, as a path."""
        sampler = self.sampler
        at = sorted(self.stops)
        rows = {t: row for row, t in enumerate(at)}
        events = tuple(
            sorted((replace(event, row=rows[event.t]) for event in self.events), key=lambda event: event.row)
        )
        thresholds = tuple(replace(one, t=self.reached.get(number)) for number, one in enumerate(sampler.asked))
        worst = Certificate.worst(self.certificates)
        return LoadPath(
            *sampler.path.names,
            sampler.problem,
            tuple(self.stops[t] for t in at),
            ending,
            *sampler.path.limits,
            worst,
            events,
            thresholds,
            interrupted,
            sampler.path.loads,
        )


def sampled_path(
    problem: ContactProblem,
    path: PathLoads,
    until: float | None,
    samples: int | Sequence[float],
    asked: tuple[Threshold, ...],
    watcher: Watcher,
) -> LoadPath:
    """Solve at so many evenly spaced t, or at given ones, and find the named events and thresholds between them.

    Raises
    ------
    NoEquilibriumError, NotCertifiedError
        If there is no answer at t = 0.
    """
    sampler = Sampler(problem, path, asked, watcher)
    whole = SampledPath(sampler)
    whole.begin()
    ending: Ending = "stopped"
    interrupted = False
    try:
        last, ends = _end(sampler, path, until, samples, whole)
        limited = ends == "no_equilibrium"
        if isinstance(samples, int):
            at = [last * k / samples for k in range(1, samples + 1)]
        else:
            at = [*(t for t in samples if 0 < t < last), last]
        for t in at[:-1]:
            whole.go_on(t, last)
        # At the limit itself the contact set barely holds the plate.
        for part in (0.0, LINEAR, AT_LIMIT) if limited else (0.0,):
            try:
                whole.go_on(at[-1] * (1 - part), last, alone=limited and part < AT_LIMIT)
                break
            except NotCertifiedError:
                if not limited or part == AT_LIMIT:
                    raise
        of_mesh = limited and path.limits[1] < path.limits[0] * (1 - AT_LIMIT)
        ending = "stopped" if of_mesh else ends
    except NotCertifiedError:
        pass
    except KeyboardInterrupt:
        interrupted = True
    return whole.result(ending, interrupted)


def _end(
    sampler: Sampler, path: PathLoads, until: float | None, samples: int | Sequence[float], whole: SampledPath
) -> tuple[float, Ending]:
    """The last t, and why it is: asked for, the limit, or a t beyond which no support changes what it does."""
    if not isinstance(samples, int):
        until = max(samples) if until is None else until
    if until is not None and until < path.end:
        return until, "until"
    if np.isfinite(path.end):
        return path.end, "no_equilibrium"
    if until is not None:
        return until, "until"
    return _settled(sampler, whole)


def _settled(sampler: Sampler, whole: SampledPath) -> tuple[float, Ending]:
    """The power of 2 beyond which doubling t changes nothing that has a name, and whether nothing ever does again."""
    begin = whole.last
    first = before = sampler.state(1.0, begin)
    steady, since, final = 0, 1.0, False
    for _ in range(_MOST_DOUBLINGS):
        after = sampler.state(2 * before.t, before)
        changed, final = bool(sampler.changed(before, after)), _final(before, after)
        steady, since = (0, after.t) if changed else (steady + 1, since)
        before = after
        if final or steady == _STEADY:
            break
    if since == 1.0 and sampler.changed(begin, first):
        for _ in range(_MOST_DOUBLINGS):
            if sampler.changed(sampler.state(since / 2, first), first):
                break
            since /= 2
    return since, "no_more_events" if final else "until"


def _final(before: State, after: State) -> bool:
    """Whether nothing opens or closes beyond two states of one contact set: no reaction or gap falls."""
    if not np.array_equal(before.answer.closed, after.answer.closed):
        return False
    for name in ("reaction", "gap"):
        first, second = getattr(before.answer, name), getattr(after.answer, name)
        least = LINEAR * max(float(np.abs(second).max(initial=0.0)), 1e-300)
        if ((second < first - least) & (first > least)).any():
            return False
    return True
