"""Load paths of random plates: within every segment the direct solution, and events where bisection finds them."""

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from signorini import InputError, NoEquilibriumError, NotCertifiedError, path
from signorini.model import validate


def traced(data, drawing, method, **options):
    """The path of a random plate under one load and another, up to t = 3."""
    raw = data.draw(drawing.models(**options))
    loads = [{**load, "case": "G"} for load in raw["load"]] + [{**data.draw(drawing.loads(raw["plate"])), "case": "Q"}]
    model = validate({**raw, "load": loads, "solver": {"method": method}})
    try:
        return path(model, "G", "Q", until=3.0)
    except (InputError, NoEquilibriumError, NotCertifiedError):
        assume(False)


def load_at(found, t):
    start, add = (found.problem.discretisation.cases[case] for case in (found.start, found.add))
    return start + t * add


def direct(found, t):
    """The solution at one t by itself, by Lemke's algorithm."""
    return found.problem.condensed.solve(load_at(found, t))


def apart(a, b, least):
    size = max(np.abs(a).max(initial=0), np.abs(b).max(initial=0), least)
    return np.abs(a - b).max(initial=0) / size if size else 0.0


@pytest.mark.parametrize("method", ["auto", "active_set"])
@settings(suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_inside_a_segment_the_path_is_the_direct_solution(drawing, dense, method, data):
    found = traced(data, drawing, method)
    assert found.certificate.passed
    twin = dense.of(found.problem, load_at(found, 0.0).nodal)
    assume(not twin.redundant)
    for segment in found.segments:
        begin, end = segment.begin, segment.end
        t = begin.t + 0.37 * (end.t - begin.t)
        result, load = found.at(t), load_at(found, t)
        assert result.certificate.passed
        answer, force = direct(found, t), np.abs(load.nodal).max()
        if not twin.pins(answer.reaction):
            continue
        assert answer.status == "solved"
        # A deflection far below those that the load makes elsewhere is rounding.
        assert apart(result.deflection, (answer.hi + answer.lo)[::3], 1e-6) < 1e-8
        on = found.problem.core.solve_on(load.nodal, found.problem.discretisation.held.values, segment.closed)
        # Points that all but repeat each other tell their reactions apart less well.
        assert apart(on.reaction, answer.reaction, force) < 1e-8
        between = begin.reactions + 0.37 * (end.reactions - begin.reactions)
        assert apart(np.array(list(result.reactions.values())), between, force) < 1e-8


@settings(max_examples=60, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_events_are_where_bisection_of_direct_solutions_finds_them(drawing, dense, data):
    found = traced(data, drawing, "auto", kinds=("at", "at", "edge"))
    twin = dense.of(found.problem, load_at(found, 0.0).nodal)
    assume(found.events and not twin.redundant)
    for before, after in list(zip(found.segments[:-1], found.segments[1:], strict=True))[:3]:
        event = before.end
        low, high = 0.5 * (before.begin.t + event.t), 0.5 * (event.t + after.end.t)
        if not all(twin.pins(direct(found, t).reaction) for t in (low, high)):
            continue
        width = high - low
        while high - low > 1e-12 * max(width, event.t):
            middle = 0.5 * (low + high)
            if np.array_equal(direct(found, middle).closed[event.points], before.closed[event.points]):
                low = middle
            else:
                high = middle
        # A direct solution takes reactions and gaps of 1e-11 of the largest for zero, and some hardly change with t.
        assert event.t == pytest.approx(low, rel=1e-4, abs=1e-4 * width)
