"""A load path start + t add: stops, named events, thresholds, and the result at any t on the path."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from signorini.base import arguments
from signorini.base.arguments import checked
from signorini.contact.certificate import Certificate
from signorini.contact.factoring import Method
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import NotUnique
from signorini.contact.strategy import answered, refusal, uncertain
from signorini.discretise import CaseLoad, Discretisation
from signorini.equilibrium.imbalance import imbalance, mechanism
from signorini.errors import InputError, NotCertifiedError, point
from signorini.mesh import Mesh
from signorini.model import Combination
from signorini.results.envelope import Envelope, States
from signorini.results.notebook import path_table, picture_of
from signorini.results.path_events import PathEvent, Threshold, in_words
from signorini.results.path_stop import PathStop
from signorini.results.recovery import recovered
from signorini.results.result import Result
from signorini.results.rows import Block, Column, Layout, together
from signorini.results.warnings import bending_thickness, model_warnings, too_far

if TYPE_CHECKING:
    from signorini.plot.curves import Figure

AT_LIMIT = 1e-6
"""Distance from the limit of equilibrium within which t counts as at the limit, relative to the limit: at the limit the
plate is almost free to move in any contact state.
"""

_DRAWN = 2.0
"""Ratio of deflection to thickness at which the picture of a path ends; the theory does not hold beyond it."""

_AFTER = 2.0
"""Last t in the picture of a path without end, relative to the t of the path's last event."""

Ending = Literal["until", "no_more_events", "no_equilibrium", "stopped"]


@checked
@dataclass(frozen=True, eq=False, repr=False)
class LoadPath(States[float]):
    """The answer of a plate to the load start + t add, for every t from 0 to the end of the path.

    Parameters
    ----------
    start : str or None
        Name of the load case or combination at t = 0; None if there is no load at t = 0.
    add : str
        Name of the load case or combination that is multiplied by t.
    problem : ContactProblem
    stops : tuple of PathStop
        Stops at t = 0, at every sample, named event and threshold, and at the end of the path.
    ending : str
        Why the path ends. "until": the requested t is reached. "no_more_events": no event occurs at any larger t.
        "no_equilibrium": no reactions balance a larger load. "stopped": no answer was certified, ``mesh_limit`` was
        reached, or the user interrupted.
    limit : float
        Largest t at which reactions balance the load; infinite if every t has such reactions.
    mesh_limit : float
        Largest t at which reactions at the contact points of this mesh balance the load. These points are within the
        supports' outlines.
    certificate : Certificate
        Largest value of each certificate error over all stops.
    support_events : tuple of PathEvent
        Events of the supports: a point opens or closes; a line or area begins to open or close, has opened or closed,
        or has a quarter, half or three quarters closed.
    thresholds : tuple of Threshold
        Thresholds that ``when`` requests, with the t at which each is reached.
    interrupted : bool
        Whether the user interrupted the path; the stops up to there are certified.
    options : mapping
        The arguments of `signorini.path`, by name.
    """

    start: str | None
    add: str
    problem: ContactProblem
    stops: tuple[PathStop, ...]
    ending: Ending
    limit: float
    mesh_limit: float
    certificate: Certificate
    support_events: tuple[PathEvent, ...]
    thresholds: tuple[Threshold, ...]
    interrupted: bool
    _loads: tuple[CaseLoad, CaseLoad]
    options: Mapping[str, Any] = field(default_factory=dict, kw_only=True)

    @property
    def mesh(self) -> Mesh:
        """The mesh of the plate."""
        return self.discretisation.mesh

    @property
    def method(self) -> Method:
        """The method that is tried first for every stop."""
        return self.problem.method

    @property
    def name(self) -> str:
        """Text for the load, such as "G + t Q"."""
        return f"t {self.add}" if self.start is None else f"{self.start} + t {self.add}"

    @property
    def end(self) -> float:
        """The t of the last stop; if ``ending`` is "no_more_events", the last segment continues to any larger t."""
        return self.stops[-1].t

    @property
    def ends_with_the_mesh(self) -> bool:
        """Whether the path ends because contact points cannot balance the load, though the supports' outlines could."""
        return self.ending == "stopped" and self.end >= self.mesh_limit * (1 - AT_LIMIT)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about the model, and about deflections along the path that exceed the thickness."""
        discretisation = self.discretisation
        thinnest = bending_thickness(discretisation).min()
        acting = self._loads[0].acting | self._loads[1].acting
        of_model = model_warnings(discretisation, acting)
        for stop in self.stops:
            for far in too_far(discretisation, self.at(stop.t).deflection) if abs(stop.utmost) > thinnest else ():
                return (*of_model, f"At t = {stop.t:.6g}: {far}")
        return of_model

    @cached_property
    def mechanism(self) -> str:
        """How the plate moves at the end of equilibrium, such as "tips about the line x = 2"; else an empty text."""
        if self.ending != "no_equilibrium":
            return ""
        discretisation, freedom = self.discretisation, self.problem.freedom
        beyond = self._loads[0] + (1.0 + AT_LIMIT) * self.limit * self._loads[1]
        why = imbalance(discretisation, freedom, beyond.weighing)
        return "" if why is None else mechanism(discretisation, why)

    @property
    def events(self) -> tuple[PathStop, ...]:
        """Stops at which contact points open or close; empty unless the path follows every contact point."""
        return tuple(stop for stop in self.stops if stop.switched)

    @property
    def not_unique(self) -> tuple[tuple[float, float, NotUnique], ...]:
        """Ranges of t between stops in which several answers are right, and how these answers differ."""
        result: dict[tuple[NotUnique, int], tuple[float, float]] = {}
        for row, stop in enumerate(self.stops):
            for one in stop.not_unique:
                begun = next((key for key in result if key[0] == one and result[key][1] == self.stops[row - 1].t), None)
                result[begun or (one, row)] = (result[begun][0] if begun else stop.t, stop.t)
        return tuple((begin, end, one) for (one, _), (begin, end) in result.items())

    def key(self, row: int) -> float:
        """The t of a stop, given its number from 0."""
        return self.stops[arguments.index(row, len(self.stops), "stop", "row")].t

    @property
    def table(self) -> Mapping[str, Column]:
        """Columns by name, with a row for each stop: "t", "event", and numbers as in a table of combinations."""
        return self._tabulated[0]

    @property
    def envelope(self) -> Envelope:
        """Extremes of every number over the stops."""
        return self._tabulated[1]

    @cached_property
    def _tabulated(self) -> tuple[Mapping[str, Column], Envelope]:
        values, count = self.discretisation, len(self.stops)
        layout = Layout.of(values)
        block, envelope = Block.empty(layout, 0, count), Envelope.none(layout, values.mesh)
        for row, result in enumerate(self._of_stops()):
            block.put(row, layout, result)
            envelope.take_fields(result, block.numbers[row : row + 1])
        envelope.take(block, np.arange(count))
        keys: list[tuple[str, Column]] = [
            ("t", np.array([stop.t for stop in self.stops])),
            ("event", [self.words(row) for row in range(count)]),
        ]
        return together([block.columns(layout, keys)]), envelope

    def _of_stops(self) -> Iterator[Result]:
        """Yield the results at all stops, in the order of t."""
        return (self._result(stop.t) for stop in self.stops)

    def words(self, index: int) -> str:
        """Describe how supports change and which thresholds are reached at a stop, given the stop's number from 0."""
        index = arguments.index(index, len(self.stops), "stop", "index")
        pulling = {support.name for support in self.model.support if support.direction == "up"}
        event = in_words([self.support_events[number] for number in self.events_at.get(index, ())], pulling)
        reached = [self.thresholds[number].when for number in self.reached_at.get(index, ())]
        said = "; ".join(part for part in (event, *reached) if part)
        return said or {0: "begin", len(self.stops) - 1: "end"}.get(index, "")

    @cached_property
    def events_at(self) -> Mapping[int, Sequence[int]]:
        """Indices in `support_events` of the events at each stop, by number of the stop."""
        result: dict[int, list[int]] = {}
        for number, event in enumerate(self.support_events):
            result.setdefault(event.row, []).append(number)
        return result

    @cached_property
    def reached_at(self) -> Mapping[int, Sequence[int]]:
        """Indices in `thresholds` of the thresholds that are reached at each stop, by number of the stop."""
        result: dict[int, list[int]] = {}
        at = {stop.t: row for row, stop in enumerate(self.stops)}
        for number, one in enumerate(self.thresholds):
            if one.t is not None:
                result.setdefault(at[one.t], []).append(number)
        return result

    def _repr_html_(self) -> str:
        """Show the picture and the events in a notebook."""
        rows = [
            (f"{stop.t:.6g}", words, stop.utmost, stop.reactions.tolist())
            for index, stop in enumerate(self.stops)
            if (words := self.words(index))
        ]
        table = path_table([support.name for support in self.model.support], rows, self.model.units)
        return picture_of(self.plot()) + table

    def plot(self) -> Figure:
        """Draw reactions of supports and points, pressures, closed parts, deflections and named events over t.

        Deflections are those at the probes or, without probes, the extremes.

        Returns
        -------
        Figure
            Of matplotlib.
        """
        from signorini.plot.curves import load_path_picture

        supports, units, stops = self.model.support, self.model.units, self.stops
        reactions = {one.name: [stop.reactions[i] for stop in stops] for i, one in enumerate(supports)}
        of_points, pressures = dict[str, list[float]](), dict[str, list[float]]()
        for one in stops[0].catalogue:
            if one.home == "point" and one.what == "reaction" and len(supports[one.owner].at or ()) > 1:
                of_points[one.subject] = [stop.number(one.name) for stop in stops]
            elif one.home == "support" and one.what == "max_pressure":
                pressures[one.subject] = [stop.number(one.name) for stop in stops]
        events = [(stops[row].t, self.words(row)) for row in sorted(self.events_at)]
        probes = self.discretisation.probe_positions.tolist()
        curves = {f"at {point(at)}": [stop.deflections[i] for stop in stops] for i, at in enumerate(probes)}
        extremes = {name: [getattr(stop, name) for stop in stops] for name in ("largest", "smallest")}
        cut = "interrupted" if self.interrupted else ""
        return load_path_picture(
            [stop.t for stop in stops],
            curves or extremes,
            reactions,
            {support.name: [stop.parts[i] for stop in stops] for i, support in enumerate(supports)},
            {one.when: one.t for one in self.thresholds if one.t is not None},
            of_points=of_points,
            pressures=pressures,
            events=events,
            stepwise=[support.name for support in supports if support.place == "at"],
            limit=self.limit if self.ending == "no_equilibrium" else None,
            until=self._drawn,
            last=self._last,
            title=", ".join(part for part in (self.model.title, self.name, cut) if part),
            factor=f"t, the factor of {self.add}",
            length=units.length,
            force=units.force,
        )

    @property
    def _drawn(self) -> float | None:
        """The t at which deflections reach `_DRAWN` times the thickness; None if before the first event, or never."""
        thickness = bending_thickness(self.discretisation)
        places = np.array(
            [stop.smallest_at if stop.utmost == stop.smallest else stop.largest_at for stop in self.stops]
        )
        far = np.abs([stop.utmost for stop in self.stops]) / thickness[self.mesh.locate(places).elements]
        for (begin, end), (before, after) in zip(pairwise(self.stops), pairwise(far.tolist()), strict=True):
            if after > _DRAWN >= before:
                t = begin.t + (_DRAWN - before) / (after - before) * (end.t - begin.t)
                return t if not self.support_events or t > self.support_events[0].t else None
        return None

    @property
    def _last(self) -> float | None:
        """Last t in the picture of a path without end: `_AFTER` times the t of the last event. None for other paths."""
        events = self.support_events
        return _AFTER * events[-1].t if events and self.ending == "no_more_events" else None

    def at(self, t: float) -> Result:
        """Result at t, with its certificate; `solve` gives the same answer for this load.

        Raises
        ------
        InputError
            If t is not on the path.
        NotCertifiedError
            If the answer fails its certificate.
        """
        t = arguments.number(t, "t")
        open_ended = self.ending == "no_more_events"
        # Rounding may place the last stop slightly before the limit.
        end = max(self.end, self.limit) if self.ending == "no_equilibrium" else self.end
        if not (0 <= t <= end or (open_ended and end < t < np.inf)):
            raise InputError(f"t is {t:g}; the path goes from 0 to {'infinity' if open_ended else f'{end:.12g}'}.")
        return self._result(t)

    def load_at(self, t: float) -> Combination:
        """Load at t as a combination: the factors of the load cases."""
        factors = dict[str, float]()
        for name, times in ((self.start, 1.0), (self.add, t)):
            for case, factor in factors_named(self.discretisation, name).items():
                factors[case] = factors.get(case, 0.0) + times * factor
        name = f"{'' if self.start is None else f'{self.start} + '}{t:.12g} {self.add}"
        return Combination.model_construct(name=name, factors=factors)

    def _result(self, t: float) -> Result:
        return result_at(self.problem, self.load_at(t), self._loads, t)


def motion_of(path: LoadPath) -> str:
    """`LoadPath.mechanism` with a subject, "the plate tips about the line x = 2"; empty if `mechanism` is empty."""
    return f"the plate {path.mechanism}" if path.mechanism and not path.model.plates else path.mechanism


def typical_t(path: LoadPath) -> float:
    """The t at which a report draws fields: t = 1 if the path goes beyond it.

    A shorter path that ends at a requested t, or after which no more events occur, is drawn at its end. Any other path
    is drawn at the last event before its end, or halfway if there is no such event.
    """
    inside = path.end * (1 - AT_LIMIT)
    if inside > 1.0:
        return 1.0
    if path.ending in ("until", "no_more_events"):
        return path.end
    return max((event.t for event in path.support_events if event.t < inside), default=0.5 * path.end)


def factors_named(discretisation: Discretisation, name: str | None) -> Mapping[str, float]:
    """Factors of the load cases in a load given by name, a load case or else a combination; empty for None."""
    if name is None or name in discretisation.cases:
        return {} if name is None else {name: 1.0}
    return next(one.factors or {} for one in discretisation.model.effective_combinations if one.name == name)


def result_at(problem: ContactProblem, of: Combination, loads: tuple[CaseLoad, CaseLoad], t: float) -> Result:
    """Result of a problem under the load at t; raises `NotCertifiedError` if the answer is not certified."""
    result, load = problem.discretisation, loads[0] + t * loads[1]
    tried = answered(problem, load, beside=beside(loads, t))
    if tried.certificate is None:
        raise NotCertifiedError(f"{of.name} has no answer that could be certified. {uncertain(result)}")
    if not tried.passed:
        raise NotCertifiedError(refusal(of.name, result, load, tried.answer, tried.certificate))
    return recovered(result, of, tried.methods, load, tried.answer, tried.certificate)


def beside(loads: tuple[CaseLoad, CaseLoad], t: float) -> tuple[CaseLoad, CaseLoad]:
    """The parts of the load, start and t add, relative to which `certify` tolerates rounding.

    At small t, t add is replaced by the multiple of add that is as large as start.
    """
    start, add = (float(np.abs(load.nodal).max()) for load in loads)
    return loads[0], max(t, start / add if start and add else 1.0) * loads[1]
