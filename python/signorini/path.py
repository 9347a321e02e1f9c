"""Load paths: every event between a load and more of another, exactly."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Literal

import numpy as np

from signorini import _core
from signorini.certificate import Certificate, certify
from signorini.discretise import CaseLoad, Discretisation, discretise
from signorini.discretise.rows import Bools, Ints
from signorini.equilibrium import no_equilibrium
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, unknown
from signorini.model import Model
from signorini.path_stop import PathStop, path_stop
from signorini.problem import ContactProblem, contact_problem
from signorini.progress import Progress, Watcher
from signorini.result import Result
from signorini.stability import largest_factor

Ending = Literal["until", "no_more_events", "no_equilibrium", "stopped"]

_NAMED = 20
"""Combinations that a message names."""
_AT_LIMIT = 1e-6
"""Distance from the limit of equilibrium, over the limit, that is none: the last contact sets barely hold the plate."""


@dataclass(frozen=True, eq=False)
class Segment:
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


@dataclass(frozen=True, eq=False)
class Path:
    """The answer of a plate to start + t add, for every t from 0 to where the path ends.

    Parameters
    ----------
    start : str or None
        The load at t = 0; None is no load.
    add : str
        The load that grows. Both are names of cases or combinations.
    problem : ContactProblem
    stops : tuple of PathStop
        At t = 0, at every event, and at the end.
    ending : str
        Why it ends: "until", the t asked for; "no_more_events", however large t; "no_equilibrium", from there on;
        "stopped", where arithmetic no longer tells the contact set.
    limit : float
        The largest t for which reactions balance the load; infinite if there is none.
    certificate : Certificate
        The worst of every figure over all stops.
    """

    start: str | None
    add: str
    problem: ContactProblem
    stops: tuple[PathStop, ...]
    ending: Ending
    limit: float
    certificate: Certificate
    _loads: tuple[CaseLoad, CaseLoad]
    _first: Bools

    @property
    def model(self) -> Model:
        """The model."""
        return self.problem.discretisation.model

    @property
    def name(self) -> str:
        """Its load in words."""
        return f"t {self.add}" if self.start is None else f"{self.start} + t {self.add}"

    @property
    def end(self) -> float:
        """The t of the last stop; the last segment goes on for ever if there are no more events."""
        return self.stops[-1].t

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

    def at(self, t: float) -> Result:
        """Every result at some t: one linear solve on the contact set that holds there, with its certificate.

        Raises
        ------
        InputError
            If t is not on the path.
        NotCertifiedError
            If the answer fails its certificate.
        """
        open_ended = self.ending == "no_more_events"
        if not (0 <= t <= self.end or (open_ended and self.end < t < np.inf)):
            raise InputError(f"t is {t:g}; the path goes from 0 to {'infinity' if open_ended else f'{self.end:.12g}'}.")
        index = int(np.searchsorted([stop.t for stop in self.stops[1:-1]], t, side="left"))
        load = self._loads[0] + t * self._loads[1]
        found = self.problem.discretisation
        closed = self.segments[index].closed if self.segments else self._first
        answer = self.problem.core.solve_on(load.nodal, found.held.values, closed)
        certificate = certify(found, load, answer.hi, answer.lo, answer.reaction)
        if not certificate.passed:
            # Supports that repeat each other share a reaction in more ways than one; this set alone does not tell how.
            answer = self.problem.solve(load)
            certificate = certify(found, load, answer.hi, answer.lo, answer.reaction)
        name = f"{'' if self.start is None else f'{self.start} + '}{t:.12g} {self.add}"
        if not certificate.passed:
            raise NotCertifiedError(f'"{name}" is refused, its certificate {certificate}.')
        return Result.of(found, name, (self.problem.method,), load, answer, certificate)


def path(
    model: Model, start: str | None, add: str, until: float | None = None, progress: Watcher | None = None
) -> Path:
    """Follow start + t add from t = 0: every t at which a contact point opens or closes, and where equilibrium ends.

    Parameters
    ----------
    model : Model
    start : str or None
        Name of a load case or combination; of two with one name the case is meant. None begins without load.
    add : str
        Name of the load that grows.
    until : float, optional
        The largest t wanted; by default to the end of equilibrium, or until there are no more events.
    progress : callable, optional
        Called with a `Progress` as meshing and factoring begin, and at every event.

    Raises
    ------
    InputError
        If the model says something that cannot be, or has no such case or combination.
    NoEquilibriumError
        If the start has no equilibrium.
    NotCertifiedError
        If the answer at a stop fails its certificate, or the start was not solved.

    Examples
    --------
    A pressure grows on a clamped plate with a prop under its middle, which it meets at some t and then presses.

    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.1},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[
    ...         {"edge": ["left", "right", "bottom", "top"], "fix": "clamped"},
    ...         {"name": "prop", "at": [2, 2], "resists": "down", "gap": 0.001},
    ...     ],
    ...     load=[{"case": "Q", "pressure": 10e3}],
    ... )
    >>> found = path(model, start=None, add="Q")
    >>> (event,) = found.events
    >>> event.switched[0].support, event.switched[0].closes, found.ending
    ('prop', True, 'no_more_events')
    >>> round(found.at(event.t).supports[1].reaction, 6), round(found.at(event.t).probe([2, 2])[0].deflection, 12)
    (0.0, 0.001)
    """
    watcher = progress or (lambda now: None)
    watcher(Progress(stage="mesh"))
    found = discretise(model)
    loads = _load(found, start, "start"), _load(found, add, "add")
    if until is not None and not 0 < until < np.inf:
        raise InputError(f"found {until:g}; it must be a finite number greater than 0.", place="until")
    watcher(Progress(stage="factor"))
    problem = contact_problem(found)
    message = no_equilibrium(found, problem.freedom, loads[0].nodal)
    if message:
        raise NoEquilibriumError(f"{start or 'without load'}: {message}")
    limit = largest_factor(found, problem.freedom, loads[0].nodal, loads[1].nodal)
    traced = _trace(problem, (start, add), loads, until, limit, watcher)
    for method in problem.fallbacks:
        if method != "interior_point" and (traced is None or traced.ending == "stopped"):
            other = _trace(problem.by(method), (start, add), loads, until, limit, watcher)
            traced = other if traced is None or (other is not None and other.end > traced.end) else traced
    if traced is None:
        raise NotCertifiedError("The contact problem at t = 0 has no answer that could be certified.")
    return traced


def _load(found: Discretisation, name: str | None, argument: str) -> CaseLoad:
    """The load of a case or, if there is none of that name, of a combination."""
    if name is None:
        return 0.0 * next(iter(found.cases.values()))
    if name in found.cases:
        return found.cases[name]
    combinations = found.model.effective_combinations if found.model.combination else ()
    for combination in combinations:
        if combination.name == name:
            return found.load(combination)
    names = [*found.cases, *(combination.name for combination in itertools.islice(combinations, _NAMED))]
    raise InputError(unknown("load case or combination", name, names), place=argument)


def _trace(
    problem: ContactProblem,
    names: tuple[str | None, str],
    loads: tuple[CaseLoad, CaseLoad],
    until: float | None,
    limit: float,
    watcher: Watcher,
) -> Path | None:
    """Follow the path by one method, as far as its answers are certified; None if not even the first is."""
    found = problem.discretisation
    stops: list[PathStop] = []
    first: list[Bools] = []
    worst = {figure.name: 0.0 for figure in fields(Certificate)}

    def visit(t: float, points: Ints, answer: _core.ContactSolution) -> None:
        load = loads[0] + t * loads[1]
        certificate = certify(found, load, answer.hi, answer.lo, answer.reaction)
        if not certificate.passed:
            raise NotCertifiedError
        for name in worst:
            worst[name] = max(worst[name], getattr(certificate, name))
        if not first:
            first.append(answer.closed)
        stops.append(path_stop(found, t, load, points, answer))
        watcher(Progress(f"t = {t:.6g}, event {len(stops)}"))

    end = min(limit, np.inf if until is None else until)
    try:
        ended = problem.core.path(loads[0].nodal, loads[1].nodal, found.held.values, end, visit)
    except NotCertifiedError:
        ended = "unsolved"
    if not stops:
        return None
    near_limit = stops[-1].t >= limit * (1 - _AT_LIMIT)
    ending: Ending = "stopped"
    if ended == "unbounded":
        ending = "no_more_events"
    elif ended != "too_many" and near_limit:
        ending = "no_equilibrium"
    elif ended == "reached":
        ending = "until"
    return Path(*names, problem, tuple(stops), ending, limit, Certificate(**worst), loads, first[0])
