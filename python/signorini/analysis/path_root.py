"""Where a function of the states along a load path changes its sign."""

from __future__ import annotations

import numpy as np

from signorini.analysis.sampler import Sampler, State, Watch

LINEAR, SMOOTH = 1e-9, 1e-6
"""Parts of the path's length to which the t of an event is found: of what is linear in t between the events of contact
points, and of contact areas and pressures, which are as exact themselves."""
_MOST_STEPS = 100
"""Solves for one event; halving alone takes 30."""


def root(sampler: Sampler, watch: Watch, known: list[State], begin: float, span: float) -> State:
    """The state at which the sign of a function changes first from a t on, among known states, which gain those solved.

    Secants of the two states nearest on one side, which are exact on one contact set, within a bracket that is
    halved where they do not lead on.
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
            # Beside a root the slope may be another on either side: forces on one, gaps on the other.
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
    """Where lines through two states each come to zero within the bracket: of one contact set before others."""
    below, low, high, above = states
    guesses = []
    for one, other in ((low, high), (below, low), (high, above)):
        if one is None or other is None or one.t == other.t:
            continue
        first, second = sampler.value(one, watch), sampler.value(other, watch)
        if first == second:
            continue
        t = one.t - first * (other.t - one.t) / (second - first)
        same = np.array_equal(one.answer.closed, other.answer.closed)
        if low.t < t < high.t:
            nearest = min(abs(first), abs(second))
            guesses.append((not same, (one, other) == (low, high), nearest, t))
    return min(guesses)[-1] if guesses else 0.5 * (low.t + high.t)
