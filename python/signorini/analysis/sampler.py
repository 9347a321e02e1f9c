"""Certified states at values of the load factor t, search for the t of an event, and the t of the last named event."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from signorini.base import arguments
from signorini.base.progress import Progress, Watcher, steps_of
from signorini.contact.certificate import Certificate, by_force, least_deflection
from signorini.contact.problem import ContactProblem
from signorini.contact.selection import Answer
from signorini.contact.strategy import answered, uncertain
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.laws import can_let_go
from signorini.discretise.rows import Floats
from signorini.equilibrium.imbalance import (
    CONTRADICTION,
    explain,
    floats,
    imbalance,
    largest_factor,
    supports_contradict,
)
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, unknown
from signorini.results.load_path import beside
from signorini.results.path_events import LEVELS, Threshold, margins
from signorini.results.path_stop import PathStop, Switched, path_stops
from signorini.results.support_points import Scales

_NAMED = 10_000
"""Largest number of combinations whose names are compared with an unknown name for an error message."""


@dataclass(frozen=True, eq=False)
class PathLoads:
    """The load start + t·add of a path on one mesh, and the t at which equilibrium ends."""

    names: tuple[str | None, str]
    loads: tuple[CaseLoad, CaseLoad]
    """Load at t = 0, and load added per unit of t."""
    limits: tuple[float, float]
    """Two largest t with equilibrium: first with reactions anywhere within the supports' outlines, then with reactions
    at the contact points of the mesh."""

    @classmethod
    def of(cls, problem: ContactProblem, start: str | None, add: str) -> PathLoads:
        """Find the two loads of a path; refuse a path whose load at t = 0 has no equilibrium."""
        discretisation = problem.discretisation
        loads = load_named(discretisation, start, "start"), load_named(discretisation, add, "add")
        message = explain(discretisation, imbalance(discretisation, problem.freedom, loads[0].weighing))
        if message:
            raise NoEquilibriumError(f"{start or 'without load'}: {message}")
        if floats(discretisation, problem.freedom, loads[0].weighing, loads[1].weighing):
            raise InputError(
                f"nothing presses the plate on its supports: neither {start or 'the start, which is no load,'} nor "
                f"{add} has a resultant, so that the plate may rest anywhere. Add its weight.",
                place="add",
            )
        outline, mesh = (
            largest_factor(discretisation, problem.freedom, bearing, loads[0].weighing, loads[1].weighing)
            for bearing in (problem.freedom.outline, problem.freedom.on_mesh)
        )
        return cls((start, add), loads, (outline, mesh))

    @property
    def end(self) -> float:
        """Largest t with equilibrium on this mesh: the smaller of the two ``limits``."""
        return float(np.fmin(*self.limits))

    def at(self, t: float) -> CaseLoad:
        """Return the load at t."""
        return self.loads[0] + t * self.loads[1]


def load_named(discretisation: Discretisation, name: str | None, argument: str) -> CaseLoad:
    """Return the load of a case or, without a case of that name, of a combination."""
    if name is None:
        return 0.0 * next(iter(discretisation.cases.values()))
    arguments.name(name, "load case or combination", argument)
    if name in discretisation.cases:
        return discretisation.cases[name]
    combinations = discretisation.model.effective_combinations if discretisation.model.combination else ()
    for combination in combinations:
        if combination.name == name:
            return discretisation.load(combination)
    names = {*discretisation.cases, *(combination.name for combination in itertools.islice(combinations, _NAMED))}
    raise InputError(unknown("load case or combination", name, names), place=argument)


@dataclass(eq=False)
class State:
    """Certified answer at t, the `PathStop` made from it, and margins: distances of supports from their events."""

    t: float
    answer: Answer
    certificate: Certificate
    stop: PathStop
    margins: list[Floats]
    """Margins of each support, in the order of the model's supports."""
    own: bool
    """Whether the method of the problem found the answer. If so, the method can start from this answer."""


class Watch(NamedTuple):
    """Function of t whose sign changes at an event: margin of a support or, if ``support`` is None, of a threshold."""

    support: int | None
    number: int
    """Number of the margin or of the threshold, from 0."""


@dataclass(eq=False)
class Sampler:
    """Solves a problem at values of t; each solution starts from a known state at a nearby t."""

    problem: ContactProblem
    path: PathLoads
    asked: tuple[Threshold, ...]
    watcher: Watcher
    scales: Scales | None = None
    above: tuple[bool, ...] = ()
    """For each threshold: whether the quantity is above the threshold's value at the first state."""
    watched: tuple[bool, ...] = field(init=False)

    def __post_init__(self) -> None:
        """Find the supports that can open or yield; only these have margins that change."""
        self.watched = tuple(can_let_go(support) for support in self.problem.discretisation.model.support)

    def state(self, t: float, near: State | None = None) -> State:
        """Return the state at t; the solution starts from the state ``near``, unless it is None."""
        result, load, made_of = self.problem.discretisation, self.path.at(t), beside(self.path.loads, t)
        start = near.answer if near is not None and near.own and near.answer.solution is not None else None

        self.watcher(Progress(f"t = {t:.6g}"))
        tried = answered(self.problem, load, steps_of(f"t = {t:.6g}", self.watcher), made_of, start)
        if tried.contradiction or (tried.certificate is None and near is None and supports_contradict(result)):
            raise NoEquilibriumError(CONTRADICTION)
        answer, certificate = tried.answer, tried.certificate
        if certificate is None or not certificate.passed:
            raise NotCertifiedError(
                f"The contact problem at t = {t:g} has no answer that could be certified. {uncertain(result)}"
            )
        if self.scales is None or (near is not None and near.t == 0 and not self.path.loads[0].nodal.any()):
            # Without load there are no reference forces for margins; ``scales`` are taken from the first loaded state.
            self.scales = Scales.of(answer)
        (stop,) = path_stops(result, [t], [load], [np.zeros(0, np.int64)], [Switched()], [answer])
        if not self.above:
            self.above = tuple(stop.number(one.quantity) > one.value for one in self.asked)
        of_supports = [
            margins(result, index, answer, self.scales, float(stop.parts[index])) if watched else np.ones(0)
            for index, watched in enumerate(self.watched)
        ]
        own = tried.methods == (self.problem.method,)
        return State(t, answer, certificate, stop, of_supports, own)

    def value(self, state: State, watch: Watch) -> float:
        """Value at a state of the function ``watch``, whose sign changes at an event."""
        if watch.support is not None:
            return float(state.margins[watch.support][watch.number])
        threshold = self.asked[watch.number]
        return threshold.margin(state.stop.number(threshold.quantity), self.above[watch.number])

    def exact(self, watch: Watch) -> bool:
        """Whether the function (margin or threshold) of a watch is linear in t while the contact state is constant."""
        if watch.support is None:
            return self.asked[watch.number].linear
        support = self.problem.discretisation.model.support[watch.support]
        return support.area is None or watch.number not in range(1, len(LEVELS) - 1)

    def changed(self, before: State, after: State) -> list[Watch]:
        """List those watches whose functions have different signs at two states."""
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


LINEAR, SMOOTH = 1e-9, 1e-6
"""Tolerances of the t of an event, relative to the length of the path: for functions that are linear in t between
events, and for contact areas and pressures."""
_MOST_STEPS = 100
"""Largest number of solutions to find one event; bisection alone takes 30."""


def root(sampler: Sampler, watch: Watch, known: list[State], begin: float, span: float) -> State:
    """State at the first sign change of a watch's function after t = ``begin``, within the tolerance.

    ``known`` are states in rising t that bracket the sign change; solved states are added to this list. A secant goes
    through two states on one side of the root; it is exact while the contact state is constant. If the secants converge
    slowly, the bracket is halved.
    """
    signs = [sampler.value(state, watch) >= 0 for state in known]
    row = next(row for row, state in enumerate(known) if state.t >= begin and signs[row] != signs[row + 1])
    low, high = known[row], known[row + 1]
    below, above = known[row - 1] if row else None, known[row + 2] if row + 2 < len(known) else None
    tolerance, slow = span * (LINEAR if sampler.exact(watch) else SMOOTH), 0
    for _ in range(_MOST_STEPS):
        at_low, at_high = sampler.value(low, watch), sampler.value(high, watch)
        width = high.t - low.t
        if width <= tolerance:
            return high
        for end, value, other in ((low, at_low, below), (high, at_high, above)):
            if other is None or other.t == end.t:
                continue
            # Slopes on both sides of a root may differ: the function is a force on one side, a gap on the other.
            slope = min(abs(at_high - at_low) / width, abs(value - sampler.value(other, watch)) / abs(end.t - other.t))
            if abs(value) <= slope * tolerance:
                return end
        t = 0.5 * (low.t + high.t)
        if slow < 2:
            t = _guess(sampler, watch, (below, low, high, above))
        t = min(max(t, low.t + 0.25 * tolerance), high.t - 0.25 * tolerance)
        state = sampler.state(t, low if t - low.t < high.t - t else high)
        known.insert(known.index(high), state)
        value = sampler.value(state, watch)
        if (value >= 0) == (at_low >= 0):
            slow = slow + 1 if high.t - t > 0.5 * width and abs(value) > 0.25 * abs(at_low) else 0
            below, low = low, state
        else:
            slow = slow + 1 if t - low.t > 0.5 * width and abs(value) > 0.25 * abs(at_high) else 0
            above, high = high, state
    return high


def _guess(sampler: Sampler, watch: Watch, states: tuple[State | None, State, State, State | None]) -> float:
    """Zero of a line through the function's values at two states, inside the bracket; equal contact states first."""
    below, low, high, above = states
    guesses = []
    for one, other in ((low, high), (below, low), (high, above)):
        if one is None or other is None or one.t == other.t:
            continue
        first, second = sampler.value(one, watch), sampler.value(other, watch)
        if first == second:
            continue
        t = one.t - first * (other.t - one.t) / (second - first)
        same = np.array_equal(one.answer.piece, other.answer.piece)
        if low.t < t < high.t:
            nearest = min(abs(first), abs(second))
            guesses.append((not same, (one, other) == (low, high), nearest, t))
    return min(guesses)[-1] if guesses else 0.5 * (low.t + high.t)


_NOTHING = 1e-9
"""Largest reaction or travel, or change of these, that counts as zero, relative to the largest value."""


def last_change(sampler: Sampler, begin: State) -> float:
    """Return a power of 2 shortly after the t of the last named event.

    The answer is linear in t while contact points keep their pieces of the laws. From two states on the same pieces
    follows the range of t of these pieces. The search goes from one range to the next until the last range. If the
    first state is already after the last event, the search goes backward.
    """
    states, end = [begin], 0.5
    while end < math.inf:
        states.append(sampler.state(_power_beyond(end), states[-1]))
        line = kept(sampler, states[-2], states[-1])
        end = line[1] if line else states[-1].t
    changes = [row for row, (one, other) in enumerate(pairwise(states), start=1) if sampler.changed(one, other)]
    if not changes or changes[-1] > 1 or len(states) == 2:
        return states[changes[-1] if changes else 1].t
    first, above = states[1:3]
    # Search backward until points keep their pieces down to t = 0, or until an event lies between two states.
    while (line := kept(sampler, first, above)) is None or line[0] > 0:
        before = sampler.state(0.5 * _power_beyond(min(line[0] if line else first.t, 0.75 * first.t)), first)
        if sampler.changed(before, first):
            break
        first, above = before, first
    return first.t


def kept(sampler: Sampler, one: State, other: State) -> tuple[float, float] | None:
    """Return the range of t in which contact points keep the pieces of two states; None if the pieces differ."""
    result, first, second, span = sampler.problem.discretisation, one.answer, other.answer, other.t - one.t
    contacts, add = result.contacts, sampler.path.loads[1]
    moved, change = (second.hi - first.hi) + (second.lo - first.lo), second.reaction - first.reaction
    force, length = _nothing(result, sampler.path.at(other.t), second.reaction, second.hi)
    least_change, least_way = _nothing(result, span * add, change, moved)
    may = ~contacts.two_sided
    least, most = contacts.range_on(contacts.pieces_at(0.5 * (first.reaction + second.reaction), 0.0, flat=False))
    within = [np.minimum(one.reaction - least, most - one.reaction) for one in (first, second)]
    pressed = may & (np.maximum(*within) > force)
    apart = may & (np.maximum(np.abs(first.gap), np.abs(second.gap)) > length)
    if (pressed & (apart | (np.minimum(*within) < -force))).any():
        return None
    # Gaps and reactions that change by less than the tolerances change by rounding alone, and do not limit the range.
    opening = -(result.contact_rows @ moved)
    presses_otherwise = (np.abs(change) > least_change) | (contacts.compliance * np.abs(change) > least_way)
    begin, end = 0.0, math.inf
    # Upward motion of the plate increases |gap| of an open point and decreases |gap| of a point at its force limit.
    beyond = np.where(first.reaction > 0.0, -opening, opening)
    ends = pressed & presses_otherwise
    for counts, value, rate in (
        (ends, first.reaction - least, change / span),
        (ends & np.isfinite(most), most - first.reaction, -change / span),
        (apart & (np.abs(opening) > least_way), np.abs(first.gap), beyond / span),
    ):
        none_at = one.t - value[counts] / rate[counts]
        begin = max(begin, float(none_at[rate[counts] > 0].max(initial=0.0)))
        end = min(end, float(none_at[rate[counts] < 0].min(initial=math.inf)))
    return (min(begin, one.t) if begin > _NOTHING * one.t else 0.0), max(end, other.t)


def _nothing(
    discretisation: Discretisation, load: CaseLoad, reaction: Floats, deflection: Floats
) -> tuple[float, float]:
    """Return the largest force and the largest deflection that count as zero under a load."""
    force = max(
        float(np.abs(reaction).max(initial=0.0)), float(by_force(load.nodal[None], discretisation.mesh.size)[0])
    )
    length = max(float(np.abs(deflection[::3]).max()), least_deflection(discretisation, load))
    return _NOTHING * force, _NOTHING * length


def _power_beyond(t: float) -> float:
    """Smallest power of 2 that is larger than t."""
    return math.ldexp(1.0, math.frexp(t)[1])
