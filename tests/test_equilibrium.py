"""Equilibrium as numbers: the axis about which a plate tips, the missing moment, the support that would hold it."""

import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from models import rectangular

from signorini import path, validate
from signorini.analysis.check import check
from signorini.discretise import discretise
from signorini.equilibrium.balance import rigid_freedom
from signorini.equilibrium.imbalance import explain, imbalance, imbalance_of

EXAMPLES = Path(__file__).parents[1] / "examples"
PLATE = {
    "units": {"force": "kN", "length": "m"},
    "support": [{"name": "pads", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}],
}


def asked(*loads):
    found = discretise(rectangular(**PLATE, load=list(loads)))
    return found, rigid_freedom(found)


def test_a_plate_that_tips_has_its_axis_moment_hinges_and_what_holds_it():
    # 80 at 2, 1 m inside of the line x = 3; 200 at 4, 1 m outside: 120 short, held by 40 at 3 m from it.
    found, freedom = asked({"case": "G", "pressure": 5}, {"case": "Q", "force": 200, "at": [4, 2]})
    why = imbalance_of(found, freedom, found.model.effective_combinations[0])
    assert (why.resultant, why.direction, why.moment) == (pytest.approx(280), None, pytest.approx(120))
    np.testing.assert_allclose([*why.axis.normal, why.axis.offset], [1, 0, -3], atol=1e-9)
    np.testing.assert_allclose(why.axis.ends(found.middle, 4.0), [[3, 0], [3, 4]], atol=1e-9)
    assert why.hinges.tolist() == [[3, 1], [3, 3]] and why.supports.tolist() == [0, 0]
    assert (why.holding.force, why.holding.direction, why.holding.node[0]) == (pytest.approx(40), "down", 0.0)
    case, factor = why.limit
    assert (case, factor) == ("Q", pytest.approx(0.4))
    assert explain(found, why).startswith(
        "The plate tips about the line x = 3 through [3, 1], [3, 3] of pads, short by a moment of 120 kN m. "
        "An extra 40 kN down at [0, "
    )


def test_points_that_a_plate_tips_about_are_named_once_with_their_supports():
    walls = [
        {"name": "bed", "area": {"rectangle": [0, 0, 2, 4]}, "resists": "down", "stiffness": 1e4},
        {"name": "wall", "line": [[0, 4], [2, 4]], "resists": "down"},
        {"name": "feet", "at": [[2, 0.5 * i] for i in range(1, 7)], "resists": "down"},
    ]
    found = discretise(rectangular(support=walls, load=[{"force": 200, "at": [4, 2]}]))
    why = imbalance(found, rigid_freedom(found), found.cases["load"].weighing)
    assert explain(found, why).startswith(
        "The plate tips about the line x = 2 through [2, 0] of bed, [2, 4] of bed and wall, "
        "[2, 0.5], [2, 1], [2, 1.5], [2, 2], ... of feet, short by a moment of 400."
    )


def test_a_plate_that_is_lifted_has_the_way_and_what_holds_it():
    found, freedom = asked({"pressure": -5})
    why = imbalance(found, freedom, found.cases["load"].weighing)
    assert (why.resultant, why.direction, why.axis) == (pytest.approx(-80), "up", None)
    assert (why.holding.force, why.holding.direction) == (pytest.approx(80), "down")
    assert why.holding.node.tolist() == [2, 2]
    assert "lifts off its supports: the load's resultant is 80 kN up" in explain(found, why)


@pytest.mark.parametrize("divisions", [[3, 2], [7, 5], [12, 8], [25, 17]])
@pytest.mark.parametrize("footprints", [True, False])
def test_the_limit_of_a_base_plate_is_the_same_on_any_mesh_and_its_path_ends_there(divisions, footprints):
    tables = tomllib.loads((EXAMPLES / "base_plate.toml").read_text())
    tables |= {"mesh": {"divisions": divisions}, "zone": []}
    if not footprints:
        for table in (*tables["support"], *tables["load"]):
            table.pop("patch", None)
            table.pop("radius", None)
    left = check(validate(tables)).resultants[1]
    assert left.limit == ("wind", pytest.approx(0.75, rel=1e-12))
    np.testing.assert_allclose([x for x, _ in left.axis], 0.5, rtol=1e-12)
    if footprints and divisions in ([7, 5], [12, 8]):
        found = path(validate(tables), start="column", add="wind")
        assert found.ending == "no_equilibrium" and found.limit == pytest.approx(0.75, rel=1e-9)


@pytest.mark.parametrize("before", ["", "others = highspy.Highs(); others.setOptionValue('threads', 2); others.run()"])
def test_the_solver_of_linear_programs_works_beside_another_user_of_it(before):
    """HiGHS starts the threads of a process once, and refuses to run when then asked for another number."""
    asked = "print(minimise(np.ones(1), np.ones((1, 1)), (2.0, np.inf), (0.0, 3.0)))"
    imports = "import highspy, numpy as np; from signorini.base.linear_program import minimise"
    done = subprocess.run([sys.executable, "-c", f"{imports}\n{before}\n{asked}"], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1:] == ["[2.]"], done.stderr
