"""Rectangles with smaller elements where it is asked, and meshes that are refined until they are as near as asked."""

import io
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from models import rectangular
from rich.console import Console

from signorini import InputError, Model, Results, estimate, solve
from signorini.accuracy import meshes as refinement
from signorini.cli.tables import print_results
from signorini.discretise import discretise
from signorini.mesh.divisions import STEEPEST, graded
from signorini.output import results_json, write

EDGES = ["left", "right", "bottom", "top"]
SQUARE = {"shape": "rectangle", "size": [10, 10], "thickness": 0.3}
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
    found = estimate(solve(plate(divisions=[4, 4], refine=[{"at": [1.0, 1.0], "size": 0.1}]))["all"])
    coarse = found.elements[-1]
    assert coarse == len(found.result.mesh.elements)
    assert found.elements[0] > 2.5 * coarse


@pytest.mark.parametrize(
    ("refine", "said"),
    [
        (
            {"size": 0.1},
            "mesh.refine[1]: found none; exactly one of at, edge, line, circle, area gives the place",
        ),
        ({"edge": "lef", "size": 0.1}, "mesh.refine[1].edge: Unknown edge 'lef'."),
        ({"at": [1, 1]}, "mesh.refine[1].size"),
    ],
)
def test_what_is_wrong_with_a_refinement_is_said(refine: object, said: str) -> None:
    with pytest.raises(InputError) as raised:
        plate(refine=[refine])
    assert said in str(raised.value)


def asked(part: float, **others: object) -> Model:
    """A slab with a wheel near its corner."""
    given: dict[str, object] = {
        "size": (10, 10),
        "thickness": 0.3,
        "mesh": {"divisions": [10, 10], "accuracy": part},
        "support": [{"edge": EDGES, "resists": "down"}],
        "load": [{"pressure": 2e3}, {"pressure": 5e5, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
        "probe": [{"at": [[5, 5], [1, 1]]}],
    }
    return rectangular(**given | others)


def shown(results: Results) -> str:
    console = Console(file=io.StringIO(), width=100)
    print_results(console, results, estimate(results))
    return console.file.getvalue()  # type: ignore[attr-defined,no-any-return]


def test_a_mesh_is_refined_until_it_is_as_near_as_asked(tmp_path: Path) -> None:
    results = solve(asked(0.05))
    first, *_, last = results.refinement
    counts = [step.elements for step in results.refinement]
    assert all(later > 1.1 * earlier for earlier, later in pairwise(counts))
    assert first.worst > 0.05 >= last.worst
    assert results.accuracy_warning == ""
    assert len(results["all"].mesh.elements) == last.elements < 1600
    written: Any = results_json(results, estimate(results))
    assert written["refinement"][-1]["worst"] == last.worst
    width = written["combinations"][0]["plus_minus"]["probes"][1]["moment"][0]
    assert width <= 0.05 * abs(results["all"].moment).max()
    write(results, tmp_path / "out")
    assert {"combination": None, "kind": "refinement", "file": "refinement.png"} in written["files"]
    assert (tmp_path / "out" / "refinement.png").stat().st_size > 10_000
    assert "refined to ± 0.05" in shown(results)


@pytest.mark.parametrize(
    "given",
    [
        {"support": [{"edge": ["left", "right"], "fix": "simple"}], "load": [{"curvature": [1e-4, 0, 0]}]},
        {"support": [{"edge": EDGES, "fix": "clamped"}], "load": [{"curvature": [1e-4, 0, 0]}]},
    ],
    ids=["bent without forces", "bent without moving"],
)
def test_what_is_zero_by_symmetry_is_not_chased(given: dict[str, object]) -> None:
    results = solve(asked(0.01, **given))
    assert len(results.refinement) == 1
    assert results.refinement[0].worst < 1e-6
    assert results.accuracy_warning == ""


L_SHAPE = {"shape": "polygon", "points": [[0, 0], [6, 0], [6, 3], [3, 3], [3, 6], [0, 6]], "thickness": 0.2}


def test_a_polygon_is_refined_where_the_numbers_are() -> None:
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate=L_SHAPE,
        mesh={"size": 0.5, "accuracy": 0.03},
        support=[{"area": "all", "resists": "down", "stiffness": 50e6}],
        load=[{"pressure": 5e3}, {"pressure": 1e6, "area": {"rectangle": [0.9, 0.9, 1.2, 1.2]}}],
        probe=[{"at": [[1.05, 1.05]]}],
        strip=[{"line": [[0.3, 4], [2.7, 4]], "width": 1, "stations": 5}],
    )
    results = solve(model)
    first, *_, last = results.refinement
    assert results.accuracy_warning == ""
    assert last.worst <= 0.03 < first.worst
    assert last.elements < 8 * first.elements
    mesh = results["all"].mesh
    at_probe, away = np.sqrt(mesh.element_area[mesh.locate([[1.05, 1.05], [5.0, 1.5]]).elements])
    assert at_probe < 0.3 * away
    finest = solve(model.model_copy(update={"mesh": model.plate.scaled(results.model.mesh, 0.4, None)}))["all"]
    for mine, true in zip(results["all"].probes[0].moment, finest.probes[0].moment, strict=True):
        assert abs(mine - true) <= 0.03 * np.abs(finest.moment).max()


def test_shears_on_a_line_that_loads_the_plate_are_not_chased() -> None:
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate=L_SHAPE,
        mesh={"size": 0.5, "accuracy": 0.3},
        support=[{"area": "all", "resists": "down", "stiffness": 50e6}],
        load=[{"pressure": 5e3}, {"line_load": 1e5, "circle": {"center": [1.5, 1.5], "radius": 1}}],
        probe=[{"at": [[2.5, 1.5]]}],
    )
    (only,) = solve(model).refinement
    assert not only.what.endswith("qx")


def test_a_disc_is_refined_where_the_numbers_are() -> None:
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "disc", "radius": 2, "thickness": 0.1},
        mesh={"divisions": [4, 16], "accuracy": 0.02},
        support=[{"edge": "rim", "fix": "clamped"}],
        load=[{"pressure": 1e3}],
        probe=[{"at": [[0, 0], [2, 0]]}],
    )
    steps = solve(model).refinement
    assert steps[-1].worst <= 0.02 < steps[0].worst


def test_while_meshes_are_refined_progress_says_how_far_the_last_one_came() -> None:
    seen: list[str] = []
    results = solve(asked(0.1), lambda now: seen.append(str(now)))
    first, *others = results.refinement
    assert others
    assert seen[0] == "meshing"
    assert f"mesh 2, ± {first.worst:.2g} on {first.elements} elements: meshing" in seen
    assert any(line.startswith("mesh 2, ") and ", on a mesh of " in line for line in seen)
    said = [line for line in seen if line.startswith("mesh 1: ")]
    assert len(said) == 1
    assert (
        f"with {first.elements:,} elements ± of {first.what} is {first.worst:.2g} of the largest value of its field"
        in said[0]
    )
    assert "± of 0.1 would take about " in said[0]
    assert first.expected > first.elements
    assert others[-1].expected == others[-1].elements


def test_where_memory_ends_it_is_said_what_it_would_take(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(refinement, "fits", lambda wanted: False)
    results = solve(asked(0.01))
    assert len(results.refinement) == 1
    assert "The accuracy of 0.01 that was asked for is not reached: with " in results.accuracy_warning
    assert "of the probe at [1, 1] in all is 0." in results.accuracy_warning
    assert "GB of memory" in results.accuracy_warning
    assert results.accuracy_warning in results_json(results)["combinations"][0]["warnings"]


def test_what_does_not_come_nearer_is_given_up() -> None:
    steps = [refinement.Refined(100 * n, 1000 * n, 0.5, "mx in all", 10_000) for n in range(1, 5)]
    finer, why = refinement.refined(asked(0.01), {}, steps)
    assert finer is None
    assert "finer meshes hardly improve it" in why


def test_an_accuracy_needs_half_widths() -> None:
    with pytest.raises(InputError, match="accuracy needs the half-widths"):
        plate(accuracy=0.1, error=False)
    with pytest.raises(InputError, match=r"mesh\.accuracy"):
        plate(accuracy=2)


@pytest.mark.parametrize(
    "given",
    [
        {"mesh": {"size": 1, "refine": [{"at": [5, 5], "size": 0.002}]}},
        {"mesh": {"size": 2}, "plate": SQUARE | {"holes": [{"circle": {"center": [3, 3], "radius": 0.02}}]}},
    ],
    ids=["of twice the size", "of half the size"],
)
def test_where_small_places_make_most_elements_half_widths_come_from_another_mesh(given: dict[str, Any]) -> None:
    plain = {"support": [{"edge": EDGES, "fix": "simple"}], "load": [{"pressure": 1.0}]}
    model = Model(**{"material": {"E": 30e9, "nu": 0.2}, "plate": SQUARE} | plain | given)
    assert estimate(solve(model)["all"]).plus_minus is not None
