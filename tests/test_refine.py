"""Rectangles with smaller elements where it is asked, and meshes that are refined until they are as near as asked."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from models import rectangular

from signorini import InputError, Model, solve
from signorini.discretise import discretise
from signorini.mesh.grading import STEEPEST, graded

EDGES = ["left", "right", "bottom", "top"]
NUMBERS = st.floats(0.0, 10.0)


def sides(model: Model) -> tuple[np.ndarray, np.ndarray]:
    """Sides of the elements along x and along y."""
    points = discretise(model).mesh.points[discretise(model).mesh.elements[:, :4]]
    return np.diff(np.unique(points[..., 0].round(12))), np.diff(np.unique(points[..., 1].round(12)))


def plate(**mesh: object) -> Model:
    return rectangular(mesh=mesh, support=[{"edge": EDGES, "fix": "simple"}], load=[{"pressure": 1.0}])


@settings(max_examples=60, deadline=None)
@given(
    size=st.floats(0.1, 5.0),
    caps=st.lists(st.tuples(NUMBERS, st.floats(0.0, 3.0), st.floats(0.01, 1.0)), min_size=1, max_size=3),
    lines=st.lists(NUMBERS, max_size=5),
)
def test_neighbours_differ_by_1_3_at_most_and_no_element_is_larger_than_asked(
    size: float, caps: list[tuple[float, float, float]], lines: list[float]
) -> None:
    within = [(at, min(at + length, 10.0), most) for at, length, most in caps]
    joints = graded(0.0, 10.0, size, within, lines)
    steps = np.diff(joints)
    assert joints[0] == 0.0 and joints[-1] == 10.0 and steps.min() > 0
    assert steps.max() <= size * (1 + 1e-6)
    assert np.maximum(steps[1:] / steps[:-1], steps[:-1] / steps[1:]).max(initial=1.0) <= STEEPEST * 1.001
    for low, high, most in within:
        there = (joints[1:] > low) & (joints[:-1] < high)
        assert steps[there].max(initial=0.0) <= most * STEEPEST


def test_elements_are_small_at_points_and_edges_alone() -> None:
    x, y = sides(plate(size=0.5, refine=[{"at": [1.0, 3.0], "size": 0.05}, {"edge": "left", "size": 0.02}]))
    assert x[0] == pytest.approx(0.02, rel=0.2)
    assert 0.4 < x.max() <= 0.5
    assert y[0] > 0.3
    assert y.min() == pytest.approx(0.05, rel=0.2)


def test_a_refined_mesh_follows_the_outlines_of_loads() -> None:
    model = rectangular(
        mesh={"refine": [{"area": {"rectangle": [1.03, 1.03, 1.08, 1.08]}, "size": 0.02}]},
        support=[{"edge": EDGES, "fix": "simple"}],
        load=[{"pressure": 1.0, "area": {"rectangle": [1.03, 1.03, 1.08, 1.08]}}],
    )
    corners = np.unique(discretise(model).mesh.points[:, 0])
    assert np.abs(corners - 1.03).min() < 1e-12 > np.abs(corners - 1.08).min()


def test_other_meshes_of_a_refined_one_are_refined_alike() -> None:
    found = solve(plate(divisions=[4, 4], refine=[{"at": [1.0, 1.0], "size": 0.1}]))["all"]
    coarse = found.estimate.elements[-1]
    assert coarse == len(found.mesh.elements)
    assert found.estimate.elements[0] > 2.5 * coarse


@pytest.mark.parametrize(
    ("refine", "said"),
    [
        ({"size": 0.1}, "mesh.refine[1]: found no place; exactly one of at, edge, line, area is needed."),
        ({"edge": "lef", "size": 0.1}, "mesh.refine[1].edge: Unknown edge 'lef'."),
        ({"at": [1, 1]}, "mesh.refine[1].size"),
    ],
)
def test_what_is_wrong_with_a_refinement_is_said(refine: object, said: str) -> None:
    with pytest.raises(InputError) as raised:
        plate(refine=[refine])
    assert said in str(raised.value)


def test_only_rectangles_can_be_refined() -> None:
    with pytest.raises(InputError, match="only a rectangle's mesh can be refined; this plate is a disc"):
        Model(
            material={"E": 1.0, "nu": 0.2},
            plate={"shape": "disc", "radius": 1, "thickness": 0.1},
            mesh={"refine": [{"at": [0, 0], "size": 0.1}]},
            load=[{"pressure": 1.0}],
        )
