"""Sampled load paths: certified states at given t; root finding locates named events and thresholds between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from signorini.analysis.sampler import PathLoads, Sampler, State, Watch, last_change, root
from signorini.base.progress import Watcher
from signorini.contact.certificate import Certificate
from signorini.contact.problem import ContactProblem
from signorini.errors import NotCertifiedError
from signorini.results.load_path import AT_LIMIT, Ending, LoadPath
from signorini.results.path_events import PathEvent, Threshold, closing_margins, event_of, first_place
from signorini.results.path_stop import PathStop
from signorini.results.support_points import SupportPoints

_LOADED = 1e-9
"""Smallest t at which events of supports are reported, relative to the length of the path."""
_AT_ROOT = 1e-7
"""Largest margin (distance of a point to its event) that counts as zero, relative to the support's largest margin."""


class Hit(NamedTuple):
    """An event or threshold that was found, and the state of the plate at its t."""

    watch: Watch
    state: State
    opening: bool


@dataclass(eq=False)
class SampledPath:
    """Solves samples of a path, and stores the stops that the path will have."""

    sampler: Sampler
    stops: dict[float, PathStop] = field(default_factory=dict)
    certificates: list[Certificate] = field(default_factory=list)
    events: list[PathEvent] = field(default_factory=list)
    reached: dict[int, float] = field(default_factory=dict)
    _last: list[State] = field(default_factory=list)

    @property
    def last(self) -> State:
        """State of the plate at the last sample."""
        return self._last[-1]

    def begin(self) -> None:
        """Solve at t = 0 and store this stop."""
        self._keep(state := self.sampler.state(0.0))
        self._last = [state]
        for number, threshold in enumerate(self.sampler.asked):
            if state.stop.number(threshold.quantity) == threshold.value:
                self.reached[number] = 0.0

    def go_on(self, t: float, span: float, shown: bool) -> None:
        """Solve at t, and find the events since the last sample. If ``shown``, the sample becomes a stop.

        Without load, points in contact have no force, so that it is undefined which of them are open. Therefore the
        search for events begins at the first loaded sample.
        """
        before, sampler = self.last, self.sampler
        after = sampler.state(t, before)
        known = [*self._last, after]
        hits = []
        for watch in sampler.changed(before, after):
            if watch.number in self.reached if watch.support is None else t <= _LOADED * span:
                continue
            state = root(sampler, watch, known, before.t, span)
            hits.append(Hit(watch, state, sampler.value(before, watch) >= 0))
        for hit in sorted(hits, key=lambda hit: hit.state.t):
            self._keep(hit.state)
            if hit.watch.support is None:
                self.reached[hit.watch.number] = hit.state.t
            else:
                self.events.append(self._event(hit, hit.watch.support))
        if shown:
            self._keep(after)
        self._last = [known[-2], after]

    def _keep(self, state: State) -> None:
        if state.t not in self.stops:
            self.stops[state.t] = state.stop
            self.certificates.append(state.certificate)

    def _event(self, hit: Hit, index: int) -> PathEvent:
        result, state = self.sampler.problem.discretisation, hit.state
        support, own = result.model.support[index], state.margins[index]
        change, closed = event_of(support, hit.watch.number, hit.opening, len(own))
        at, count = None, closing_margins(support, len(own))
        if support.place == "at":
            own = own[:count]
            rest = _AT_ROOT * np.abs(own).max()
            closed = float(np.mean(own > rest if hit.opening else own >= -rest))
            x, y = SupportPoints.of(result, index).positions[hit.watch.number % count].tolist()
            at = x, y
            # At the t of an event rounding decides contact: store the fraction of points in contact just after it.
            self.stops[state.t] = self.stops[state.t].with_part(index, closed, count)
        elif change in ("begins to open", "begins to close", "yields", "stops yielding"):
            at = first_place(result, index, state.answer, change)
            closed = float(state.stop.parts[index]) if closed is None else closed
        return PathEvent(
            row=0,
            t=state.t,
            support=support.name,
            at=at,
            change=change,
            closed=closed or 0.0,
            opening=hit.opening,
            number=hit.watch.number,
        )

    def result(self, ending: Ending, interrupted: bool) -> LoadPath:
        """Return the path with its stops and events in order of t."""
        sampler = self.sampler
        at = sorted(self.stops)
        rows = {t: row for row, t in enumerate(at)}
        placed = (replace(event, row=rows[event.t]) for event in self.events)
        events = tuple(sorted(placed, key=lambda event: event.row))
        thresholds = tuple(replace(one, t=self.reached.get(number)) for number, one in enumerate(sampler.asked))
        worst, stops = Certificate.worst(self.certificates), tuple(self.stops[t] for t in at)
        known = (*sampler.path.names, sampler.problem, stops, ending, *sampler.path.limits, worst)
        return LoadPath(*known, events, thresholds, interrupted, sampler.path.loads)


def sampled_path(
    problem: ContactProblem,
    path: PathLoads,
    until: float | None,
    samples: int | Sequence[float],
    asked: tuple[Threshold, ...],
    watcher: Watcher,
) -> LoadPath:
    """Solve at evenly spaced or given t, and find the named events and thresholds between them."""
    sampler = Sampler(problem, path, asked, watcher)
    whole = SampledPath(sampler)
    whole.begin()
    ending: Ending = "stopped"
    interrupted = False
    try:
        length, ends = _end(sampler, until if isinstance(samples, int) else until or max(samples), whole.last)
        limited = ends == "no_equilibrium"
        # At the limit of equilibrium no contact state holds the plate, so that the last sample is before the limit.
        end = length * (1 - AT_LIMIT) if limited else length
        at = [length * k / samples for k in range(1, samples)] if isinstance(samples, int) else samples
        shown = {*(t for t in at if t < end), end}
        for t in sorted({*shown, _LOADED * length} - {0.0}):
            whole.go_on(t, length, t in shown)
        of_mesh = limited and path.limits[1] < path.limits[0] * (1 - AT_LIMIT)
        ending = "stopped" if of_mesh else ends
    except NotCertifiedError:
        pass
    except KeyboardInterrupt:
        interrupted = True
    return whole.result(ending, interrupted)


def _end(sampler: Sampler, until: float | None, begin: State) -> tuple[float, Ending]:
    """End of the path and the reason: ``until``, the limit of equilibrium, or a t after the last named event."""
    limit = sampler.path.end
    if until is not None and until < limit:
        return until, "until"
    if np.isfinite(limit):
        return limit, "no_equilibrium"
    return last_change(sampler, begin), "no_more_events"
