"""Plates on soil that only pushes: the active set against Lemke's algorithm."""

import numpy as np
import pytest
import tensionless
from tensionless import SOIL

import signorini
from signorini import Model


def slab_a(divisions: int, method: str = "auto") -> signorini.Result:
    return signorini.solve(tensionless.slab_a(divisions, method))["all"]


def solved(method: str = "auto", **keys: object) -> signorini.Result:
    result = signorini.solve(Model.model_validate({"solver": {"method": method}, **keys}))["all"]
    assert result.certificate.passed
    return result


def test_active_set_and_lemke_give_the_same_slab() -> None:
    by_lemke, by_active_set = slab_a(8, "lemke"), slab_a(8, "active_set")
    assert (by_lemke.method, by_active_set.method) == ("lemke", "active_set")
    assert np.abs(by_lemke.deflection - by_active_set.deflection).max() < 1e-10 * np.abs(by_lemke.deflection).max()
    assert (by_lemke.supports[0].closed == by_active_set.supports[0].closed).all()


def test_a_plate_that_touches_nothing_at_the_start_falls_onto_the_soil() -> None:
    """The gap is a hundred settlements deep; the answer is that without a gap, lower by it."""
    on, above = (
        solved(
            "active_set",
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
            mesh={"divisions": [8, 8]},
            support=[{**SOIL, "stiffness": 30e6, "gap": gap}],
            load=[{"pressure": 2e3}, {"force": 5e5, "at": [1, 1]}],
        )
        for gap in (0.0, 0.5)
    )
    assert np.abs(above.deflection - 0.5 - on.deflection).max() < 1e-9 * np.abs(on.deflection).max()


def test_soil_with_bearings_anchors_and_a_wall_is_what_lemke_finds() -> None:
    """Soft and hard points together, some of each open."""
    by_lemke, result = (
        solved(
            method,
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "rectangle", "size": [10, 6], "thickness": 0.25},
            mesh={"divisions": [10, 6]},
            support=[
                {**SOIL, "stiffness": 2e6, "gap": "1e-4 * x"},
                {"name": "pads", "at": [[2, 2], [8, 2], [5.13, 4.77]], "resists": "down", "gap": 5e-4},
                {"name": "anchors", "at": [[0.5, 5.5], [9.5, 5.5]], "resists": "up"},
                {"name": "wall", "edge": "bottom", "resists": "down", "gap": 2e-4},
            ],
            load=[{"pressure": 3e3}, {"force": 4e5, "at": [8.2, 1.1]}],
        )
        for method in ("lemke", "active_set")
    )
    assert (by_lemke.method, result.method) == ("lemke", "active_set")
    assert sum(result.reactions.values()) == pytest.approx(3e3 * 60 + 4e5, rel=1e-9)
    assert np.abs(by_lemke.deflection - result.deflection).max() < 1e-9 * np.abs(result.deflection).max()
    for ours, theirs in zip(result.supports, by_lemke.supports, strict=True):
        assert (ours.closed == theirs.closed).all()
    hard = np.concatenate([support.closed for support in result.supports[1:]])
    assert 0 < hard.sum() < len(hard) and result.reactions["soil"] > 0


def test_few_points_of_very_stiff_soil_under_a_thin_plate() -> None:
    """A thin plate on very stiff soil that few points touch, on a wall that may let go."""
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [4.7, 3.5], "thickness": 0.0267},
        "mesh": {"divisions": [5, 4]},
        "support": [
            {**SOIL, "stiffness": 4.15e8, "gap": "1e-3*abs(x-1)"},
            {"name": "wall", "edge": "left", "resists": "down"},
        ],
        "load": [
            {"pressure": 361.0},
            {"force": -16.7e3, "at": [2.4, 2.18]},
            {"force": 3.8e3, "at": [3.79, 0.77]},
            {"force": 79.4e3, "at": [1.13, 2.67]},
        ],
    }
    by_lemke, result = solved("lemke", **tables), solved("active_set", **tables)
    assert result.method == "active_set"
    assert np.abs(by_lemke.deflection - result.deflection).max() < 1e-8 * np.abs(result.deflection).max()


@pytest.mark.parametrize(("thickness", "stiffness"), [(0.3, None), (0.03, None), (0.3, 1e10), (0.3, 1e3)])
def test_a_bed_from_soft_to_rigid_under_a_curled_slab(thickness: float, stiffness: float | None) -> None:
    """The gap is a bowl that opens towards the corners; points of the bed are elements where it is rigid."""
    bed = {"name": "bed", "area": "all", "resists": "down", "gap": "4e-5*((x-5)**2 + (y-5)**2)"}
    by_lemke, result = (
        solved(
            method,
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "rectangle", "size": [10, 10], "thickness": thickness},
            mesh={"divisions": [9, 9]},
            support=[bed if stiffness is None else {**bed, "stiffness": stiffness}],
            load=[{"pressure": 2e3}, {"force": 1e5, "at": [3, 4]}],
        )
        for method in ("lemke", "active_set")
    )
    assert (by_lemke.method, result.method) == ("lemke", "active_set")
    assert np.abs(by_lemke.deflection - result.deflection).max() < 1e-9 * np.abs(result.deflection).max()
    ours, theirs = result.supports[0], by_lemke.supports[0]
    assert ours.closed.sum() > 0 and (ours.closed.sum() < len(ours.closed) or stiffness == 1e3)
    assert np.abs(ours.reactions - theirs.reactions).max() < 1e-8 * np.abs(theirs.reactions).max()


def test_the_lcp_of_a_bedded_plate_has_every_point_whatever_solves_it() -> None:
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        "mesh": {"divisions": [6, 6]},
        "support": [{**SOIL, "stiffness": 30e6}],
        "load": [{"pressure": 2e3}, {"force": 5e5, "at": [1, 1]}],
    }
    problem = signorini.contact_problem(Model.model_validate(tables))
    assert problem.method == "active_set"
    posed = problem.lcp(problem.load("all"))
    assert sorted(posed.points) == list(range(len(problem.gaps)))
    answer = signorini._core.lemke(posed.M, posed.q)
    direct = problem.solve(problem.discretisation.cases["load"])
    gap = np.where(posed.gap_is_z, answer.z, answer.w)
    assert np.abs(gap - direct.gap[posed.points]).max() < 1e-9 * np.abs(direct.hi[::3]).max()
