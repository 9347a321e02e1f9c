"""Wrong arrays at the border to Rust raise ordinary exceptions; a panic never crosses it."""

import border
import numpy as np
import pytest

from signorini import _core


@pytest.fixture(scope="module")
def entries():
    return border.calls(*border.example())


def test_the_calls_are_right_before_they_are_spoilt(entries) -> None:
    for call, arguments in entries:
        call(*arguments)


def test_no_panic_crosses_the_border(entries) -> None:
    others = border.strangers()
    faults = {seed: found for seed in range(3000) if (found := border.fault(seed, entries, others))}
    assert faults == {}


@pytest.mark.parametrize("points", [2, 3, 1], ids=["as large", "larger", "smaller"])
def test_what_another_problem_has_made_is_refused(points: int) -> None:
    problem, found = border.example()
    core, plate, rest, cases, at_points, *_ = border.made(problem, found)
    _, _, other_rest, other_cases, other_points, other_shared, other_reference, other_solved = border.made(
        *border.example(points)
    )
    curvatures, couples = np.zeros((1, 3)), np.zeros((1, 2 * len(found.mesh.elements)))
    load, held = found.cases["load"].nodal, found.held.values
    for call, message in (
        (lambda: _core.combine(core, other_shared, np.ones((1, 1))), "what the cases share is of another problem"),
        (
            lambda: _core.combined_cases(core, other_rest, cases, at_points),
            "the response at rest is of another",
        ),
        (lambda: _core.combined_cases(core, rest, other_cases, at_points), "a response of the cases is of another"),
        (lambda: _core.combined_cases(core, rest, cases, other_points), "of another problem|contact points"),
        (lambda: _core.response_stresses(plate, other_cases, curvatures, couples), "is of another plate"),
        (lambda: _core.solution_stresses(plate, other_solved, curvatures, couples), "is of another plate"),
        (
            lambda: problem.by("active_set").core.solve(load, held, None, other_reference),
            "The solution to begin with is of another problem",
        ),
    ):
        with pytest.raises(ValueError, match=message):
            call()
    with pytest.raises(ValueError, match="a response at points has no displacements"):
        _core.response_stresses(plate, [cases[0].at_points()], curvatures, couples)


def test_a_plate_without_elements_is_refused() -> None:
    for nodes in (0, 8):
        with pytest.raises(ValueError, match="a plate has at least one element"):
            _core.Plate(np.zeros((nodes, 2)), np.zeros((0, 8), np.int64), 1.0, 1.0, np.ones(9), "mitc9", None)
