"""Load paths of random plates: exact ones against direct solutions and bisection, sampled ones against exact ones."""

import itertools

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
        return path(model, "G", "Q", until=3.0, events="all")
    except (InputError, NoEquilibriumError, NotCertifiedError):
        assume(False)


def load_at(found, t):
    start, add = (found.problem.discretisation.cases[case] for case in (found.start, found.add))
    return start + t * add


def direct(found, t):
    """The solution at one t by itself, by Lemke's algorithm."""
    return found.problem.condensed.solve(load_at(found, t))


def on_set(found, t, segment):
    """The answer on one contact set, signs as they come."""
    return found.problem.core.solve_on(
        load_at(found, t).nodal, found.problem.discretisation.held.values, segment.pieces
    )


def apart(a, b, least):
    size = max(np.abs(a).max(initial=0), np.abs(b).max(initial=0), least)
    return np.abs(a - b).max(initial=0) / size if size else 0.0


def closed(twin, segment):
    return twin.two_sided | (segment.pieces > 0)


def condition(twin, closed):
    """Condition number of the equations of one contact set, every dof and point scaled to one."""
    scale = 1 / np.sqrt(np.diag(twin.K).clip(1e-300))
    rows = twin.G[closed] * scale
    lengths = np.linalg.norm(rows, axis=1)
    # A point that no free dof moves is by itself.
    moved = lengths > 0
    lengths = lengths[moved]
    rows = rows[moved] / lengths[:, None]
    compliance = np.diag(twin.compliance[closed][moved] / lengths**2)
    return np.linalg.cond(np.block([[scale[:, None] * twin.K * scale, rows.T], [rows, -compliance]]))


@pytest.mark.parametrize("method", ["auto", "active_set"])
@settings(max_examples=20, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_inside_a_segment_the_path_is_the_direct_solution(drawing, dense, method, data):
    found = traced(data, drawing, method)
    assert found.certificate.passed
    twin = dense.of(found.problem, load_at(found, 0.0).nodal)
    assume(not twin.redundant)
    for segment in found.segments:
        begin, end = segment.begin, segment.end
        t = begin.t + 0.37 * (end.t - begin.t)
        if segment.jumps:
            continue
        result, load = found.at(t), load_at(found, t)
        assert result.certificate.passed
        answer, force = direct(found, t), np.abs(load.nodal).max()
        if not twin.pins(answer.reaction):
            continue
        assert answer.status == "solved"
        # Sets are solved to an imbalance of 1e-13; points that all but repeat each other tell their shares less well.
        least = 1e-10 + 1e-12 * condition(twin, closed(twin, segment))
        # A deflection far below the largest under the load is rounding.
        assert apart(result.deflection, (answer.hi + answer.lo)[::3], 1e-6) < least
        fixed = on_set(found, t, segment)
        # Two-sided points that nearly repeat each other may defeat an active set that starts from its closed points.
        assert fixed.status == "solved" or (method == "active_set" and twin.two_sided.any())
        assert fixed.status != "solved" or apart(fixed.reaction, answer.reaction, force) < least
        between = begin.reactions + 0.37 * (end.reactions - begin.reactions)
        assert apart(np.array(list(result.reactions.values())), between, force) < least


def slowness(found, segment, points):
    """How long, at most, a reaction or gap of these points takes to change by all there is of its kind."""
    a, b = (segment.begin.t + part * (segment.end.t - segment.begin.t) for part in (0.25, 0.75))
    first, second = (on_set(found, t, segment) for t in (a, b))
    force = max(np.abs(answer.reaction).max(initial=0) for answer in (first, second))
    force = max(force, *(np.abs(load_at(found, t).nodal).max() for t in (a, b)))
    length = max(np.abs(found.problem.gaps).max(), *(np.abs(answer.gap).max() for answer in (first, second)))
    # Where the load vanishes on the way a stretch may be one rounding of t long.
    reacting = np.abs(second.reaction - first.reaction) / (force or 1.0)
    away = np.abs(second.gap - first.gap) / (length or 1.0)
    with np.errstate(divide="ignore"):
        return ((b - a) / np.where(found.problem.two_sided | (segment.pieces > 0), reacting, away)[points]).max()


@settings(max_examples=20, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_events_are_where_bisection_of_direct_solutions_finds_them(drawing, dense, data):
    found = traced(data, drawing, "auto", kinds=("at", "at", "edge"))
    twin = dense.of(found.problem, load_at(found, 0.0).nodal)
    assume(found.events and not twin.redundant)
    stretches = [segment for segment in found.segments if not segment.jumps]
    for before, after in itertools.islice(itertools.pairwise(stretches), 4):
        event, points = before.end, np.flatnonzero(before.pieces != after.pieces)
        # If only shares change, no point opens or closes.
        if not len(points):
            continue
        low, high = 0.5 * (before.begin.t + event.t), 0.5 * (event.t + after.end.t)
        if not all(twin.pins(direct(found, t).reaction) for t in (low, high)):
            continue
        while high - low > 1e-15 * high:
            middle = 0.5 * (low + high)
            if middle in (low, high):
                break
            if np.array_equal(direct(found, middle).piece[points], before.pieces[points]):
                low = middle
            else:
                high = middle
        # A direct solution takes reactions and gaps of 1e-11 of the largest for zero, its pivots 1e-10 of the gaps, and
        # more where points all but repeat each other.
        slow = slowness(found, before, points) + slowness(found, after, points)
        least = 1e-9 + 1e-12 * max(condition(twin, closed(twin, segment)) for segment in (before, after))
        assert event.t == pytest.approx(low, rel=1e-12, abs=least * slow)


@settings(max_examples=10, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_named_events_of_points_are_those_of_the_exact_path(drawing, dense, data):
    exact = traced(data, drawing, "auto", kinds=("at", "at"))
    twin = dense.of(exact.problem, load_at(exact, 0.0).nodal)
    stretches = [segment for segment in exact.segments if not segment.jumps]
    assume(exact.events and not twin.redundant and len(stretches) == len(exact.segments) and not exact.not_unique)
    assume(all(twin.pins(direct(exact, 0.5 * (one.begin.t + one.end.t)).reaction) for one in stretches))
    try:
        found = path(exact.model, "G", "Q", until=3.0, steps=200)
    except (NoEquilibriumError, NotCertifiedError):
        assume(False)
    span = found.end
    assume(found.ending != "stopped" and exact.ending != "stopped")

    def said(one):
        return [event for event in one.support_events if 1e-6 * span < event.t < (1 - 1e-6) * span]

    def near(event, others):
        return any(
            (event.support, event.change, event.at) == (other.support, other.change, other.at)
            and abs(event.t - other.t) <= 1e-7 * span
            for other in others
        )

    # All events found exist. Not found are events undone between two samples, and the first event of a point that
    # touches without force at the start.
    assert all(near(event, exact.support_events) for event in said(found))
    touching = {(event.support, event.at, event.change) for event in found.support_events if event.t <= 1e-6 * span}
    missed = [event for event in said(exact) if not near(event, found.support_events)]
    missed = [event for event in missed if (event.support, event.at, event.change) not in touching]
    for event in missed:
        back = {"opens": "closes", "closes": "opens"}[event.change]
        assert any(
            (other.support, other.at, other.change) == (event.support, event.at, back)
            and abs(other.t - event.t) <= span / 200
            for other in exact.support_events
        )
