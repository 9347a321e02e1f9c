"""Where a load path that has no end comes to its last named event."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from signorini.analysis.sampler import Sampler, State
from signorini.contact.certificate import by_force, least_deflection
from signorini.discretise import CaseLoad, Discretisation
from signorini.discretise.rows import Floats

_NOTHING = 1e-9
"""Part of the largest reaction or travel, or of its change, that is none."""


def last_change(sampler: Sampler, begin: State) -> float:
    """A power of 2 beyond which nothing that has a name happens, and not long after what is the last to happen.

    A plate is linear in t as long as its contact points keep their pieces, and two states on the same pieces say how
    long that is. So the search goes from one end of pieces to the next until there is none; and backward, where the
    first state already is beyond the last event.
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
    # Down to t = 0 the pieces hold, or an event is passed.
    while (line := kept(sampler, first, above)) is None or line[0] > 0:
        before = sampler.state(0.5 * _power_beyond(min(line[0] if line else first.t, 0.75 * first.t)), first)
        if sampler.changed(before, first):
            break
        first, above = before, first
    return first.t


def kept(sampler: Sampler, one: State, other: State) -> tuple[float, float] | None:
    """From which t on, and up to which, contact points keep the pieces of two states; None of different pieces."""
    result, first, second, span = sampler.problem.discretisation, one.answer, other.answer, other.t - one.t
    contacts, add = result.contacts, sampler.path.loads[1]
    moved, change = (second.hi - first.hi) + (second.lo - first.lo), second.reaction - first.reaction
    force, length = _nothing(result, sampler.path.at(other.t), second.reaction, second.hi)
    least_change, least_way = _nothing(result, span * add, change, moved)
    may = ~contacts.two_sided
    pressed = may & (np.maximum(first.reaction, second.reaction) > force)
    apart = may & (np.maximum(first.gap, second.gap) > length)
    if (pressed & apart).any():
        return None
    # Of gaps that are far larger than what closes them the difference is rounding.
    opening = -(result.contact_rows @ moved)
    presses_otherwise = (np.abs(change) > least_change) | (contacts.compliance * np.abs(change) > least_way)
    begin, end = 0.0, math.inf
    for counts, value, rate in (
        (pressed & presses_otherwise, first.reaction, change / span),
        (apart & (np.abs(opening) > least_way), first.gap, opening / span),
    ):
        none_at = one.t - value[counts] / rate[counts]
        begin = max(begin, float(none_at[rate[counts] > 0].max(initial=0.0)))
        end = min(end, float(none_at[rate[counts] < 0].min(initial=math.inf)))
    return (min(begin, one.t) if begin > _NOTHING * one.t else 0.0), max(end, other.t)


def _nothing(
    discretisation: Discretisation, load: CaseLoad, reaction: Floats, deflection: Floats
) -> tuple[float, float]:
    """The force and the deflection that are none beside a load and what it does."""
    force = max(
        float(np.abs(reaction).max(initial=0.0)), float(by_force(load.nodal[None], discretisation.mesh.size)[0])
    )
    length = max(float(np.abs(deflection[::3]).max()), least_deflection(discretisation, load))
    return _NOTHING * force, _NOTHING * length


def _power_beyond(t: float) -> float:
    """The least power of 2 that is larger."""
    return math.ldexp(1.0, math.frexp(t)[1])
