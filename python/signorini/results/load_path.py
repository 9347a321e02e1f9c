"""What a load path says: its stops, the segments between them, and every result at any t."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import TYPE_CHECKING, Literal

import numpy as np

from signorini import _core
from signorini.base import arguments
from signorini.base.brief import Brief
from signorini.base.numbers import compared
from signorini.contact.answer import Answer, NotUnique
from signorini.contact.certificate import Certificate, certified
from signorini.contact.factoring import Method
from signorini.contact.problem import ContactProblem
from signorini.contact.refusal import refusal
from signorini.contact.selection import chosen
from signorini.contact.strategy import answered
from signorini.discretise import CaseLoad
from signorini.discretise.rows import Bools, Floats
from signorini.errors import InputError, NotCertifiedError, point
from signorini.mesh import Mesh
from signorini.results.columns import Block, Column, Layout, together
from signorini.results.envelope import Envelope
from signorini.results.estimate import PathEstimate, PathEstimator
from signorini.results.notebook import path_table
from signorini.results.path_events import PathEvent, in_words, path_events
from signorini.results.path_stop import PathStop
from signorini.results.result import FIELDS, Result
from signorini.results.states import States
from signorini.results.warnings import bending_thickness, model_warnings, too_far

if TYPE_CHECKING:
    from signorini.plot import Figure

AT_LIMIT = 1e-6
"""Distance from the limit of equilibrium, over the limit, that is none: the last contact sets barely hold the plate."""

_DRAWN = 2.0
"""Deflections over the thickness up to which a path is drawn: beyond, nothing of the theory is left."""

_AFTER = 2.0
"""Times the t of the last event up to which a path is drawn that has no other end."""

Ending = Literal["until", "no_more_events", "no_equilibrium", "stopped"]


@dataclass(frozen=True, eq=False, repr=False)
class Segment(Brief):
    """A stretch of the path on which no point opens or closes, so that everything is linear in t.

    Parameters
    ----------
    begin, end : PathStop
        What holds at its two ends.
    closed : (m,) array
        Contact points that are closed on it.
    """

    begin: PathStop
    end: PathStop
    closed: Bools

    @property
    def jumps(self) -> bool:
        """Whether all of it is at one t: the plate, having lost its hold, moves until other points hold it."""
        return self.begin.t == self.end.t


@dataclass(frozen=True, eq=False, repr=False)
class LoadPath(States[float]):
    """The answer of a plate to start + t add, for every t from 0 to where the path ends.

    Parameters
    ----------
    start : str or None
        The load at t = 0; None is no load.
    add : str
        The load that grows. Both are names of cases or combinations.
    problem : ContactProblem
    stops : tuple of PathStop
        At t = 0, at every event, where supports begin to share a reaction otherwise, and at the end.
    ending : str
        Why it ends: "until", the t asked for; "no_more_events", however large t; "no_equilibrium", from there on;
        "stopped", where arithmetic no longer tells the contact set, or at ``mesh_limit``.
    limit : float
        The largest t for which reactions balance the load; infinite if there is none.
    mesh_limit : float
        The same for reactions at the contact points of this mesh, which are within the supports' outlines.
    certificate : Certificate
        The worst of every figure over all stops.
    estimator : PathEstimator or None
        Who says how far its mesh is from the plate.
    """

    start: str | None
    add: str
    problem: ContactProblem
    stops: tuple[PathStop, ...]
    ending: Ending
    limit: float
    mesh_limit: float
    certificate: Certificate
    _loads: tuple[CaseLoad, CaseLoad]
    _first: Bools
    _doubtful: tuple[int, ...] = ()
    """Segments on which more answers than one may be right."""
    estimator: PathEstimator | None = field(default=None, repr=False)

    @property
    def mesh(self) -> Mesh:
        """The mesh."""
        return self.discretisation.mesh

    @cached_property
    def estimate(self) -> PathEstimate:
        """Half-widths of the t of every event and of the end; the path is followed on other meshes for them."""
        if self.estimator is None:
            return PathEstimate(None, (None,) * len(self.support_events), (), ())
        return self.estimator.estimate(self)

    @property
    def method(self) -> Method:
        """How it was followed: "lemke" by parametric pivoting, "active_set" from event to event."""
        return self.problem.method

    @property
    def name(self) -> str:
        """Its load in words."""
        return f"t {self.add}" if self.start is None else f"{self.start} + t {self.add}"

    @property
    def end(self) -> float:
        """The t of the last stop; the last segment goes on for ever if there are no more events."""
        return self.stops[-1].t

    @property
    def ends_with_the_mesh(self) -> bool:
        """Whether it stops where the mesh's points, but not yet the supports' outlines, cease to balance the load."""
        return self.ending == "stopped" and self.end >= self.mesh_limit * (1 - AT_LIMIT)

    @cached_property
    def support_events(self) -> tuple[PathEvent, ...]:
        """What the supports do: points open or close, lines and areas begin to, have done so, or pass a quarter."""
        return path_events(self.model.support, self.stops)

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What of the model, and of the deflections on the way, is seldom meant."""
        found = self.discretisation
        thinnest = bending_thickness(found).min()
        for stop in self.stops:
            for far in too_far(found, self.at(stop.t).deflection) if abs(stop.utmost) > thinnest else ():
                return (*model_warnings(found), f"At t = {stop.t:.6g}: {far}")
        return model_warnings(found)

    @property
    def events(self) -> tuple[PathStop, ...]:
        """Stops at which points open or close."""
        return tuple(stop for stop in self.stops if stop.switched)

    @cached_property
    def segments(self) -> tuple[Segment, ...]:
        """Stretches between neighbouring stops."""
        closed, found = self._first, []
        for begin, end in zip(self.stops[:-1], self.stops[1:], strict=True):
            closed = closed.copy()
            closed[begin.points] ^= True
            found.append(Segment(begin, end, closed))
        return tuple(found)

    @cached_property
    def not_unique(self) -> tuple[tuple[float, float, NotUnique], ...]:
        """Where more answers than one are right: from one t to another, and what could be otherwise.

        The stops show an answer that leads on, `at` the least one.
        """
        found, stretches = self.problem.discretisation, list[tuple[float, float, NotUnique]]()
        for segment in (self.segments[index] for index in self._doubtful):
            load = self._loads[0] + 0.5 * (segment.begin.t + segment.end.t) * self._loads[1]
            solution = self.problem.core.solve_on(load.nodal, found.held.values, segment.closed)
            answer = chosen(found, self.problem.freedom, load.nodal, Answer.of(found, solution))
            for one in answer.not_unique:
                before = [stretch for stretch in stretches if stretch[1:] == (segment.begin.t, one)]
                begin = before[0][0] if before else segment.begin.t
                stretches = [stretch for stretch in stretches if stretch not in before]
                stretches.append((begin, segment.end.t, one))
        return tuple(stretches)

    def key(self, row: int) -> float:
        """The t of a stop, given its number from 0."""
        return self.stops[row].t

    @property
    def table(self) -> Mapping[str, Column]:
        """Every column by name, with a row a stop: t, what happens there, and what a table of combinations has."""
        return self._tabulated[0]

    @property
    def envelope(self) -> Envelope:
        """Extremes over the whole path, which are at stops, since everything is linear in t between them."""
        return self._tabulated[1]

    @cached_property
    def _tabulated(self) -> tuple[Mapping[str, Column], Envelope]:
        found, count = self.discretisation, len(self.stops)
        layout = Layout.of(found, [name for name in FIELDS if name in found.model.output.envelope])
        block, envelope = Block.empty(layout, 0, count), Envelope.none(layout, found.mesh)
        for row, stop in enumerate(self.stops):
            # Of the two stops of a jump the first is what holds before it, the second what holds after.
            after = 0 < row < count - 1 and self.segments[row - 1].jumps
            result = self._at(stop.t, row if after else max(row - 1, 0), leading=True)
            block.put(row, layout, result)
            envelope.take_fields(result, block.numbers[row : row + 1])
        envelope.take(block, layout, np.arange(count))
        keys: list[tuple[str, Column]] = [
            ("t", np.array([stop.t for stop in self.stops])),
            ("event", [self.words(row) for row in range(count)]),
        ]
        return together([block.columns(layout, keys)]), envelope

    def words(self, index: int) -> str:
        """Say what the supports do at a stop, by its number from 0; nothing where less than a quarter of one does."""
        index = arguments.index(index, len(self.stops), "stop", "index")
        pulling = {support.name for support in self.model.support if support.resists == "up"}
        event = in_words([self.support_events[number] for number in self._numbers.get(index, ())], pulling)
        event = event or {0: "begin", len(self.stops) - 1: "end"}.get(index, "")
        jumps = index < len(self.segments) and self.segments[index].jumps
        moves = "the plate moves on its own until another support holds it"
        return "; ".join(part for part in (event, moves * jumps) if part)

    def half_width(self, index: int) -> float | None:
        """The widest half-width of the t of a stop that its events show, or of the end; None where one has none."""
        ends = {len(self.stops) - 1: self.estimate.end, 0: 0.0}
        widths = [self.estimate.events[number] for number in self._numbers.get(index, ())] or [ends.get(index)]
        known = [width for width in widths if width is not None]
        return max(known) if known and len(known) == len(widths) else None

    @cached_property
    def _numbers(self) -> Mapping[int, Sequence[int]]:
        found: dict[int, list[int]] = {}
        for number, event in enumerate(self.support_events):
            found.setdefault(event.row, []).append(number)
        return found

    def _repr_html_(self) -> str:
        """Show the events in a notebook, with half-widths once `estimate` was asked for: nothing is solved here."""
        rows = [
            (t_in_words(self, index), words, stop.utmost, stop.reactions.tolist())
            for index, stop in enumerate(self.stops)
            if (words := self.words(index))
        ]
        table = path_table([support.name for support in self.model.support], rows, self.model.units)
        asked = "estimate" in self.__dict__
        of_mesh = compared(self.estimate.elements, True) if asked else "± once estimate is asked for"
        return f"{table}<p>of the mesh: {of_mesh}</p>"

    def plot(self) -> Figure:
        """Draw deflections over t, at the probes or else the extremes, and below it what part of supports is closed.

        Returns
        -------
        Figure
            Of matplotlib.
        """
        from signorini.plot import load_path_picture

        found = self.problem.discretisation
        positions = found.probe_positions.tolist()
        at_probes = np.array([stop.deflections for stop in self.stops])
        extremes = {name: np.array([getattr(stop, name) for stop in self.stops]) for name in ("largest", "smallest")}
        curves = {f"at {point(at)}": at_probes[:, i] for i, at in enumerate(positions)}
        supports = self.model.support
        parts = np.array([stop.parts for stop in self.stops[:-1]])
        return load_path_picture(
            [stop.t for stop in self.stops],
            curves or extremes,
            dict(zip((support.name for support in supports), parts.reshape(-1, len(supports)).T, strict=True)),
            limit=self.end if self.ending == "no_equilibrium" else None,
            until=self._drawn,
            last=self._last,
            title=", ".join(part for part in (self.model.title, self.name) if part),
            factor=f"t, the factor of {self.add}",
            length=self.model.units.length,
        )

    @property
    def _drawn(self) -> float | None:
        """The t at which deflections leave what is drawn, if that is after the first event."""
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
        """The t up to which a path is drawn of which the last event is known: the rest is a line."""
        events = self.support_events
        return _AFTER * events[-1].t if events and self.ending == "no_more_events" else None

    def _beside(self, t: float) -> Iterator[Floats]:
        """Reactions (m,) amid the segments that end or begin at t, or are about it."""
        held = self.problem.discretisation.held.values
        for segment in self.segments:
            if segment.begin.t <= t <= segment.end.t and not segment.jumps:
                load = self._loads[0] + 0.5 * (segment.begin.t + segment.end.t) * self._loads[1]
                solution = self.problem.core.solve_on(load.nodal, held, segment.closed)
                if solution.status == "solved":
                    yield solution.reaction

    def at(self, t: float) -> Result:
        """Every result at some t: one linear solve on the contact set that holds there, with its certificate.

        Of equal answers it is the one that `solve` gives; at the t of a jump what holds before it.

        Raises
        ------
        InputError
            If t is not on the path.
        NotCertifiedError
            If the answer fails its certificate.
        """
        t = arguments.number(t, "t")
        open_ended = self.ending == "no_more_events"
        # The last event may be a rounding short of the limit.
        end = max(self.end, self.limit) if self.ending == "no_equilibrium" else self.end
        if not (0 <= t <= end or (open_ended and end < t < np.inf)):
            raise InputError(f"t is {t:g}; the path goes from 0 to {'infinity' if open_ended else f'{end:.12g}'}.")
        jumps = any(segment.jumps and segment.begin.t == t for segment in self.segments)
        found = self._at(t, int(np.searchsorted([stop.t for stop in self.stops[1:-1]], t, side="left")), leading=jumps)
        return found if self.estimator is None else replace(found, estimator=partial(self.estimator.estimate_at, t))

    def _at(self, t: float, segment: int, leading: bool) -> Result:
        """Every result at some t of a segment: of equal answers the least, or one that leads on."""
        load = self._loads[0] + t * self._loads[1]
        found = self.problem.discretisation
        closed = self.segments[segment].closed if self.segments else self._first
        answer = Answer.of(found, self.problem.core.solve_on(load.nodal, found.held.values, closed))
        made_of = beside(self._loads, t)
        methods: Sequence[Method] = (self.problem.method,)
        answer, certificate = certified(found, load, answer, made_of)
        if not certificate.passed:
            # Supports that repeat each other share a reaction in more ways than one; this set alone does not tell how.
            tried = answered(self.problem, load, beside=made_of)
            answer, certificate = certified(found, load, tried.answer.somehow or tried.answer, made_of)
            methods = tried.methods
        if not certificate.passed:
            answers: list[_core.ContactSolution] = []
            nodal = self._loads[0].nodal, self._loads[1].nodal
            self.problem.core.path(*nodal, found.held.values, t, lambda t, points, answer: answers.append(answer))
            if answers:
                answer, certificate = certified(found, load, Answer.of(found, answers[-1]), made_of)
                methods = (self.problem.method,)
        name = f"{'' if self.start is None else f'{self.start} + '}{t:.12g} {self.add}"
        if not certificate.passed:
            raise NotCertifiedError(refusal(name, found, load, answer, certificate))
        elsewhere = partial(self._beside, t) if leading else None
        least = chosen(found, self.problem.freedom, load.nodal, answer, elsewhere)
        if least is not answer:
            answer, certificate = certified(found, load, least, made_of)
        return Result.of(found, name, methods, load, answer, certificate)


def t_in_words(path: LoadPath, index: int) -> str:
    """Write the t of a stop, to digits that keep the order, with its half-width once `estimate` was asked for."""
    t = f"{path.stops[index].t:.6g}"
    if "estimate" not in path.__dict__ or not path.estimate.elements:
        return t
    width = 0.0 if path.words(index) == "end" and path.ending == "no_more_events" else path.half_width(index)
    return f"{t} ± {'?' if width is None else f'{width:.2g}'}" if width != 0 else t


def ahead(problem: ContactProblem, loads: tuple[CaseLoad, CaseLoad], t: float, closed: Bools) -> Iterator[Floats]:
    """Reactions (m,) on a contact set at a t well beyond this one, signs as they come; none where it does not hold."""
    start, add = (np.abs(load.nodal).max() for load in loads)
    far = t + max(t, start / add if start else 1.0)
    held = problem.discretisation.held.values
    solution = problem.core.solve_on((loads[0] + far * loads[1]).nodal, held, closed)
    if solution.status == "solved":
        yield solution.reaction


def beside(loads: tuple[CaseLoad, CaseLoad], t: float) -> tuple[CaseLoad, CaseLoad]:
    """What the load at t is the sum of, at a t at which both parts count."""
    start, add = (float(np.abs(load.nodal).max()) for load in loads)
    return loads[0], max(t, start / add if start and add else 1.0) * loads[1]
