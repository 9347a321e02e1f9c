"""Sensitivities: closed forms, laws of scaling, ranges, refusals, and the command."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sensitivities
from command import run

from signorini import InputError, Model, Result, solve

CONCRETE = {"E": 30e9, "nu": 0.2}


def result_of(**tables: Any) -> Result:
    return solve(Model(**tables))["all"]


def raft(**changes: Any) -> dict[str, Any]:
    """A raft that lifts off the soil under an eccentric force, with a pile that pulls."""
    return {
        "material": CONCRETE | {"unit_weight": 25e3},
        "plate": {"shape": "rectangle", "size": [6, 4], "thickness": 0.4},
        "mesh": {"divisions": [6, 4]},
        "support": [
            {"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7},
            {"name": "pile", "at": [0.5, 2], "resists": "up", "stiffness": 5e7},
        ],
        "load": [{"case": "G", "self_weight": True}, {"case": "Q", "at": [5.5, 1.5], "force": 500e3}],
        "probe": [{"at": [3, 2]}],
    } | changes


def test_plate_under_uniform_pressure_on_soil_settles_by_p_over_k() -> None:
    found = result_of(
        material=CONCRETE,
        plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        mesh={"divisions": [3, 3]},
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7}],
        load=[{"pressure": 5e3}],
        probe=[{"at": [1, 1]}],
    )
    pressure, deflection = found.sensitivity("soil.max_pressure"), found.sensitivity("probe[1].deflection")
    assert pressure["load[1].pressure"] == pytest.approx(1.0, rel=1e-9)
    assert pressure["support.soil.stiffness"] == pytest.approx(0.0, abs=1e-9 * 5e3 / 2e7)
    assert deflection["support.soil.stiffness"] == pytest.approx(-5e3 / 2e7**2, rel=1e-7)
    assert deflection["support.soil.gap"] == pytest.approx(1.0, rel=1e-9)
    assert deflection.derivative("case.load.factor").elasticity == pytest.approx(1.0, rel=1e-9)
    # The soil opens where the load is 0.
    low, high = pressure.valid["load[1].pressure"]
    assert (low, high) == (pytest.approx(0.0, abs=1e-6), np.inf)


def test_simply_supported_thin_plate_deflects_by_one_over_e_and_thickness_cubed() -> None:
    found = result_of(
        material=CONCRETE,
        plate={"shape": "rectangle", "size": [4, 3], "thickness": 4e-3},
        mesh={"divisions": [6, 6]},
        support=[{"edge": ["left", "right", "bottom", "top"], "fix": "hard"}],
        load=[{"pressure": 1.0}],
        probe=[{"at": [2, 1.5]}],
    ).sensitivity("probe[1].deflection")
    assert found.derivative("material.E").elasticity == pytest.approx(-1.0, rel=1e-6)
    assert found.derivative("plate.thickness").elasticity == pytest.approx(-3.0, rel=1e-5)
    # D ~ 1/(1 − ν²)
    assert found["material.nu"] == pytest.approx(-2 * 0.2 / (1 - 0.2**2) * found.value, rel=1e-4)


def test_force_of_a_preloaded_bolt_rises_by_its_share_of_the_stiffness() -> None:
    """Bolts of stiffness kb through a stiff plate on a bed kc: F = P + kb/(kb + kc) X (VDI 2230)."""
    bolt, bed = 1e6, 4e6
    found = result_of(
        material={"E": 1e16, "nu": 0.0},
        plate={"shape": "rectangle", "size": [2, 2], "thickness": 0.5},
        mesh={"divisions": [2, 2]},
        support=[
            {"name": "bed", "area": "all", "resists": "down", "stiffness": bed},
            {
                **{"name": "bolts", "at": [[0, 0], [2, 0], [2, 2], [0, 2]], "resists": "up"},
                **{"stiffness": bolt, "preload": 50e3},
            },
        ],
        load=[{"at": [1, 1], "force": -100e3}],
    )
    force = found.sensitivity("bolts[1].reaction")
    share = bolt / (4 * bolt + 4 * bed)
    assert force.value == pytest.approx(-50e3 - share * 100e3, rel=1e-6)
    assert force["load[1].force"] == pytest.approx(share, rel=1e-6)
    assert force["support.bolts.preload"] == pytest.approx(-1.0, rel=1e-6)
    by_stiffness = -100e3 * 4 * bed / (4 * bolt + 4 * bed) ** 2
    assert force["support.bolts.stiffness"] == pytest.approx(by_stiffness, rel=1e-6)
    # The bed opens when the share of the bed in the load equals the preload.
    opens = -4 * 50e3 * (bolt + bed) / bed
    assert force.valid["load[1].force"][0] == pytest.approx(opens, rel=1e-5)


def test_scaling_gives_sums_of_elasticities() -> None:
    """Numbers scale with the loads; pressures do not change, and deflections fall, if all stiffnesses rise alike."""
    found = result_of(**raft())
    for name, power in (("soil.max_pressure", 0.0), ("probe[1].deflection", -1.0), ("soil.contact_area", 0.0)):
        one = found.sensitivity(name)
        loads = [one.derivative(f"case.{case}.factor").elasticity for case in "GQ"]
        stiff = ("material.E", "support.soil.stiffness", "support.pile.stiffness")
        assert sum(loads) == pytest.approx(0.0 if "area" in name else 1.0, abs=1e-7)
        assert sum(one.derivative(path).elasticity for path in stiff) == pytest.approx(power, abs=1e-7)


@pytest.mark.parametrize("seed", [1, 5, 8, 13, 21])
def test_random_plates_agree_with_differences_of_new_solutions(seed: int) -> None:
    """A sample of benchmarks/sensitivities.py."""
    outcome, wrong = sensitivities.draw(seed)
    assert wrong == []
    assert outcome["derivatives"] > 100


def test_contact_changes_at_the_ends_of_the_range() -> None:
    tables = raft()
    found = result_of(**tables)
    low, high = found.sensitivity("soil.reaction").valid["load[2].force"]

    def pieces(force: float) -> list[bool]:
        moved = raft(load=[tables["load"][0], tables["load"][1] | {"force": force}])
        soil = result_of(**moved).supports["soil"]
        return soil.closed.tolist()

    assert low < 500e3 < high
    for end, inward in ((low, 1e-6), (high, -1e-6)):
        assert pieces(end * (1 + inward)) == pieces(500e3) != pieces(end * (1 - inward))


def test_parameters_are_those_of_the_input_with_their_units() -> None:
    tables = raft(units={"length": "m", "force": "N"}, mesh={"size": 1.0})
    found = result_of(**tables).sensitivity("soil.max_pressure")
    assert list(found) == [
        *("material.E", "material.nu", "material.unit_weight", "plate.thickness"),
        *("support.soil.stiffness", "support.pile.stiffness", "load[2].force", "case.G.factor", "case.Q.factor"),
    ]
    units = [(one.unit, one.derivative_unit) for one in found.derivatives]
    assert units[4:7] == [("N/m³", "N/m² per N/m³"), ("N/m", "N/m² per N/m"), ("N", "N/m² per N")]
    assert found["support.pile.settlement"] != 0.0
    assert "support.pile.settlement" not in found
    assert found.to_dataframe().loc["plate.thickness", "derivative"] == found["plate.thickness"]


def test_numbers_without_a_derivative_are_refused_with_the_reason() -> None:
    found = result_of(**raft())
    with pytest.raises(InputError, match="count"):
        found.sensitivity("soil.closed")
    with pytest.raises(InputError, match=r"Unknown number .*soil\.max_pressure"):
        found.sensitivity("soil.max_presure")
    pressure = found.sensitivity("soil.max_pressure")
    for path, reason in {
        "plate.size[1]": "move the mesh",
        "support.pile.limit": "nothing",
        "support.rock.stiffness": "soil",
        "case.snow.factor": "G, Q",
    }.items():
        with pytest.raises(InputError, match=reason):
            _ = pressure[path]
    redundant = raft(support=[{"at": [0, 2], "fix": "clamped"}, *[{"at": [6, 2], "resists": "down"}] * 2])
    with pytest.raises(InputError, match="not unique"):
        result_of(**redundant).sensitivity("deflection.max")


@pytest.mark.parametrize(
    "held",
    [
        {"resists": "both", "gap": 0, "stiffness": 1e7},
        {"resists": "both", "gap": [0, 0, 0, 0], "stiffness": 1e7},
        {"gap": 0},
        {"resists": "both", "gap": 0, "law": [[-1, -1e7], [0, 0], [1, 2e7]]},
        {"fix": "simple", "gap": 0},
        {"resists": "up", "gap": 0, "stiffness": 1e7, "preload": 1e4},
    ],
)
def test_a_gap_that_must_stay_0_is_no_parameter(held: dict[str, Any]) -> None:
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7}
    corners = {"name": "c", "at": [[0, 0], [6, 0], [6, 4], [0, 4]], **held}
    found = result_of(**raft(support=[soil, corners])).sensitivity("c[1].reaction")
    assert len(found.derivatives) == len(found) > 5
    assert not [path for path in found if path.startswith("support.c.gap")]
    with pytest.raises(InputError, match=r"support\.c\.gap.*must stay 0"):
        found.derivative("support.c.gap[1]" if isinstance(held["gap"], list) else "support.c.gap")


def test_a_settlement_that_must_stay_0_is_no_parameter() -> None:
    slopes = {"name": "s", "edge": "left", "fix": "symmetry", "settlement": 0}
    found = result_of(**raft(support=[*raft()["support"], slopes])).sensitivity("soil.reaction")
    assert len(found.derivatives) == len(found) > 5 and "support.s.settlement" not in found
    with pytest.raises(InputError, match=r"support\.s\.settlement.*must stay 0"):
        found.derivative("support.s.settlement")


@pytest.mark.parametrize(
    ("path", "resists", "gap"),
    [("support.c.gap", "down", 0), ("support.c.gap[1]", "both", [0, 0, 0, 1e-4]), ("support.c.gap", "both", 1e-6)],
)
def test_derivatives_by_a_gap_are_differences_of_new_solutions(path: str, resists: str, gap: Any) -> None:
    """At the end of the range, a gap of 0, derivatives are one-sided."""

    def solved(more: float) -> Result:
        gaps = [gap[0] + more, *gap[1:]] if isinstance(gap, list) else gap + more
        corners = {"name": "c", "at": [[0, 0], [6, 0], [6, 4], [0, 4]], "stiffness": 1e7}
        middle = {"name": "m", "at": [3, 2], "stiffness": 2e6}
        load = [{"at": [2, 1.5], "force": 500e3}]
        return result_of(**raft(support=[corners | {"resists": resists, "gap": gaps}, middle], load=load))

    here, h = solved(0.0), 1e-5
    difference = (solved(h).supports["c"].reactions[0] - here.supports["c"].reactions[0]) / h
    assert here.sensitivity("c[1].reaction")[path] == pytest.approx(difference, rel=1e-6)


def test_two_places_that_govern_equally_have_no_derivative() -> None:
    corners = [[0, 0], [6, 0], [6, 4], [0, 4]]
    support = [{"name": name, "at": at, "stiffness": 1e7} for name, at in zip("abcd", corners, strict=True)]
    found = result_of(**raft(support=support, load=[{"pressure": 1e3}])).sensitivity("deflection.min")
    assert found["load[1].pressure"] == pytest.approx(found.value / 1e3, rel=1e-9)
    with pytest.raises(InputError, match="kink"):
        _ = found["support.a.stiffness"]


def test_point_at_the_end_of_its_piece_has_no_derivative() -> None:
    """A prop that touches the plate without a force: the load would close it."""
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7}
    prop = {"name": "prop", "at": [2, 2], "resists": "down", "stiffness": 1e8, "gap": 5e3 / 2e7}
    found = result_of(**raft(support=[soil, prop], load=[{"pressure": 5e3}])).sensitivity("probe[1].deflection")
    with pytest.raises(InputError, match="just opens"):
        _ = found["load[1].pressure"]


def test_command_prints_writes_and_reports_sensitivities(tmp_path: Path) -> None:
    file = tmp_path / "raft.toml"
    combinations = [{"name": "low", "factors": {"G": 1.0}}, {"name": "high", "factors": {"G": 1.35, "Q": 1.5}}]
    tables = raft(mesh={"divisions": [3, 2], "error": False}, combination=combinations)
    file.write_text(Model(**tables).to_toml())
    output = run("solve", file, "-o", tmp_path / "out", "--pictures", "none", "--sensitivity", "soil.max_pressure")
    assert output.exit_code == 0
    assert "support.soil.stiffness" in output.output
    (one,) = json.loads((tmp_path / "out" / "results.json").read_text())["sensitivities"]
    assert (one["name"], one["combination"]) == ("soil.max_pressure", "high")
    by_path = {row["path"]: row for row in one["parameters"]}
    direct = solve(Model(**tables))["high"].sensitivity("soil.max_pressure")
    assert by_path["load[2].force"]["derivative"] == direct["load[2].force"]
    assert by_path["case.Q.factor"]["value"] == 1.5
    assert run("verify", tmp_path / "out" / "results.json").exit_code == 0
    page = tmp_path / "raft.html"
    assert run("report", file, "-o", page, "--sensitivity", "soil.max_pressure").exit_code == 0
    assert "soil.max_pressure = " in page.read_text().partition('id="sensitivities"')[2]
    assert run("solve", file, "--sensitivity", "soil.nothing").exit_code == 2


def test_factor_of_a_preload_moves_bolts_and_bed_by_the_same_force() -> None:
    model = Model(
        material={"E": 2e11, "nu": 0.3},
        plate={"shape": "rectangle", "size": [0.4, 0.3], "thickness": 0.03},
        mesh={"divisions": [6, 6]},
        support=[
            {"name": "bed", "area": "all", "resists": "down", "stiffness": 1e10},
            {"name": "b", "at": [[0.05, 0.05], [0.35, 0.25]], "resists": "up", "stiffness": 3e8, "preload": 2e4}
            | {"preload_case": "P"},
        ],
        load=[{"force": -3e4, "at": [0.2, 0.14]}],
        combination=[{"name": "u", "factors": {"load": 1.0, "P": 0.9}}],
    )
    result = solve(model)["u"]
    bed, bolts = (result.sensitivity(f"{name}.reaction")["case.P.factor"] for name in ("bed", "b"))
    assert bed == pytest.approx(-bolts, rel=1e-6) and bed > 0

    def at(factor: float) -> float:
        changed = model.model_copy(
            update={"combination": (model.combination[0].model_copy(update={"factors": {"load": 1.0, "P": factor}}),)}
        )
        return float(solve(changed)["u"].supports["b"].reaction)

    assert bolts == pytest.approx((at(0.901) - at(0.899)) / 0.002, rel=1e-6)
