"""Checks of numbers and fields, eccentricity and kern, overturning."""

import csv
import json
import math
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
from models import rectangular

from signorini import InputError, Model, Results, check_results, estimate, path, solve, write
from signorini.analysis.estimate import estimates_of
from signorini.discretise import discretise
from signorini.equilibrium.balance import rigid_freedom
from signorini.equilibrium.imbalance import largest_factor
from signorini.equilibrium.stability import load_factors
from signorini.model import Combination

FOOTING: dict[str, Any] = {
    "size": [2, 1.5],
    "thickness": 0.8,
    "divisions": [8, 6],
    "support": [{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e6}],
    "load": [
        {"case": "G", "pressure": 100e3},
        {"case": "W", "moment": [60e3, 0], "at": [1, 0.75], "radius": 0.3},
    ],
}
"""A pad footing with 300 kN in the middle, and a moment of 60 kN m: e = 0.2 m, a tenth of the length."""


def footing(factors: dict[str, float], *checks: dict[str, Any], **others: Any) -> Results:
    """Results of the footing under a combination with checks."""
    model = rectangular(**FOOTING | {"combination": [{"name": "c", "factors": factors}], "check": checks} | others)
    return solve(model)


def test_pressure_eccentricity_kern_and_overturning_of_a_footing_are_those_of_statics() -> None:
    results = footing(
        {"G": 1, "W": 1},
        {"name": "bearing", "of": "soil.max_pressure", "limit": 200e3},
        {"name": "kern", "of": "soil.kern", "limit": 1},
        {"name": "overturning", "of": "overturning", "grows": ["W"]},
    )
    numbers = dict(zip(results["c"].catalogue.by_name, results["c"].numbers, strict=True))
    assert numbers["soil.eccentricity_x"] == pytest.approx(0.2, rel=1e-9)
    assert abs(numbers["soil.eccentricity_y"]) < 1e-9
    bearing, kern, overturning = check_results(results)
    # q = N/A (1 + 6 e/b) = 160 kPa; kern 6 e/b = 0.6; the resultant is at the edge when e = b/2: λ = 5.
    assert bearing.value == pytest.approx(160e3, rel=1e-5)
    assert bearing.utilisation == pytest.approx(0.8, rel=1e-5)
    assert kern.utilisation == pytest.approx(0.6, rel=1e-9)
    assert overturning.utilisation == pytest.approx(0.2, rel=1e-9)
    assert [one.passed for one in (bearing, kern, overturning)] == [True] * 3


def test_the_kern_of_a_rectangle_is_a_rhombus() -> None:
    load = [*FOOTING["load"][:1], {"case": "W", "moment": [60e3, -30e3], "at": [1, 0.75], "radius": 0.3}]
    (kern,) = check_results(footing({"G": 1, "W": 1}, {"of": "soil.kern", "limit": 1}, load=load))
    # 6 (ex/bx + ey/by)
    assert kern.value == pytest.approx(6 * (0.2 / 2 + 0.1 / 1.5), rel=1e-9)


def test_the_kern_of_a_disc_has_a_quarter_of_its_radius() -> None:
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "disc", "radius": 2, "thickness": 2},
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e5}],
        load=[{"force": 1e5, "at": [0.3, 0.4], "radius": 0.2}],
        mesh={"size": 0.5},
        check=[{"of": "soil.kern", "limit": 2}],
    )
    (kern,) = check_results(solve(model))
    assert kern.utilisation == pytest.approx(0.5 * 0.5 / 0.5, rel=1e-3)


def test_rigid_and_elastic_areas_have_the_eccentricity_of_the_load() -> None:
    support = [{"name": "soil", "area": {"rectangle": [0.2, 0.2, 1.9, 1.4]}, "resists": "down"}]
    load = [{"force": 1e5, "at": [1.2, 0.9]}]
    results = footing({}, support=support, load=load, combination=[])
    numbers = dict(zip(results["all"].catalogue.by_name, results["all"].numbers, strict=True))
    assert numbers["soil.eccentricity_x"] == pytest.approx(1.2 - 1.05, rel=1e-9)
    assert numbers["soil.eccentricity_y"] == pytest.approx(0.9 - 0.8, rel=1e-9)


def test_overturning_without_equilibrium_fails_and_says_how_much_stands() -> None:
    combinations = [{"name": "stands", "factors": {"G": 1, "W": 1}}, {"name": "tips", "factors": {"G": 0.9, "W": 9}}]
    overturning, bearing = check_results(
        footing(
            {},
            {"of": "overturning", "grows": ["W"]},
            {"of": "soil.max_pressure", "limit": 1e6},
            combination=combinations,
        )
    )
    assert overturning.governing == "tips"
    assert overturning.utilisation == pytest.approx(2 * 0.2 / 2 * 9 / 0.9, rel=1e-9)
    assert overturning.passed is False
    assert bearing.passed is None
    assert bearing.without_equilibrium == 1


def test_overturning_with_limits_agrees_with_the_load_path() -> None:
    support = [
        {"name": "feet", "at": [[0.2, 0.2], [1.8, 0.2], [0.2, 1.3], [1.8, 1.3]], "resists": "down", "limit": 150e3},
    ]
    check = {"of": "overturning", "grows": ["W"]}
    results = footing({"G": 1, "W": 1}, check, support=support)
    (overturning,) = check_results(results)
    assert overturning.value == pytest.approx(1 / path(results.model, "G", "W").limit, rel=1e-6)


@pytest.mark.parametrize("combinations", ["each", "table"])
def test_overturning_with_limits_has_a_half_width(combinations: str) -> None:
    """Soil that crushes at q: M = N (L/2 − a/2) with the stress block a = N/(q b)."""
    soil = [FOOTING["support"][0] | {"limit": 350e3}]
    check, output = {"of": "overturning", "grows": ["W"]}, {"combinations": combinations}
    results = footing({"G": 1, "W": 1}, check, support=soil, output=output)
    (overturning,) = check_results(results, estimate(results))
    assert overturning.value is not None and overturning.plus_minus is not None
    block = 300e3 / (350e3 * 1.5)
    error = abs(overturning.value - 60e3 / (300e3 * (1 - block / 2)))
    assert error <= overturning.plus_minus <= 0.02
    assert overturning.passed


def test_variable_cases_overturn_by_default() -> None:
    """With [cases] the weight stays and the wind grows, with the case that follows it."""
    load = [*FOOTING["load"], {"case": "W2", "moment": [20e3, 0], "at": [1, 0.75], "radius": 0.3}]
    cases = {"G": {"kind": "permanent"}, "W": {"kind": "variable", "category": "wind"}, "W2": {"with": "W"}}
    table = [{"name": "EQU", "generate": "en1990", "rule": "EQU"}]
    model = rectangular(
        **FOOTING | {"load": load, "cases": cases, "combination": table, "check": [{"of": "overturning"}]}
    )
    (one,) = check_results(solve(model))
    # 0.9 · 300 kN at half the length, 1 m, against 1.5 · 80 kN m
    assert one.governing == "EQU: 0.9 G + 1.5 W + 1.5 W2"
    assert one.value == pytest.approx(1.5 * 80 / (0.9 * 300), rel=1e-9)


def test_an_anchored_plate_overturns_later() -> None:
    anchors = {"name": "anchors", "at": [[0.2, 0.2], [0.2, 1.3]], "resists": "up", "limit": 50e3}
    check = {"of": "overturning", "grows": ["W"]}
    free, anchored = (
        check_results(footing({"G": 1, "W": -1}, check, support=[*FOOTING["support"], *more]))[0]
        for more in ((), [{**anchors, "at": [[1.8, 0.2], [1.8, 1.3]]}])
    )
    # About x = 0: 300 kN · 1 m, and two anchors of 50 kN at 1.8 m.
    assert free.value == pytest.approx(60 / 300, rel=1e-9)
    assert anchored.value == pytest.approx(60 / (300 + 2 * 50 * 1.8), rel=2e-2)


@pytest.mark.parametrize("seed", range(5))
def test_overturning_on_points_agrees_with_a_linear_program_over_reactions(seed: int) -> None:
    random = np.random.default_rng(seed)
    # G stands in the middle of four feet.
    feet = [[0.1, 0.1], [1.9, 0.1], [1.9, 1.4], [0.1, 1.4], *(0.3 + random.random((1, 2)) * [1.4, 0.9]).tolist()]
    added = {"case": "Q", "force": 1e5, "at": random.random(2).tolist()}
    model = rectangular(**FOOTING | {"support": [{"at": feet, "resists": "down"}], "load": [*FOOTING["load"], added]})
    discretisation, freedom = discretise(model), rigid_freedom(discretise(model))
    factors = [{"G": 1.0, "Q": q, "W": w} for q, w in random.uniform(-1, 1, (20, 2)).tolist()]
    combinations = [Combination(name=f"c{number}", factors=of) for number, of in enumerate(factors)]
    for own, of in zip(load_factors(discretisation, combinations, ["Q", "W"]), factors, strict=True):
        case = {name: factor * discretisation.cases[name].weighing for name, factor in of.items()}
        most = largest_factor(discretisation, freedom, freedom.outline, case["G"], case["Q"] + case["W"])
        assert own == pytest.approx(most, rel=1e-6)


def test_plates_on_one_another_have_checks_of_contacts_and_fields_of_each() -> None:
    results = solve(
        Model(
            material={"E": 30e9, "nu": 0.2},
            plates={
                "slab": {"shape": "rectangle", "size": [4, 3], "thickness": 0.3},
                "raft": {"shape": "rectangle", "size": [4, 3], "thickness": 0.4},
            },
            mesh={"divisions": [8, 6]},
            support=[{"name": "soil", "plate": "raft", "area": "all", "resists": "down", "stiffness": 2e7}],
            contact=[{"name": "bed", "between": ["slab", "raft"], "area": "all", "stiffness": 1e9}],
            load=[
                {"case": "G", "plate": "slab", "pressure": 20e3},
                {"case": "W", "plate": "slab", "moment": [30e3, 0], "at": [2, 1.5], "radius": 0.4},
            ],
            combination=[{"name": "c", "factors": {"G": 1, "W": 2}}, {"name": "tips", "factors": {"G": 1, "W": 30}}],
            check=[
                {"of": "bed.kern", "limit": 1},
                {"of": "overturning", "grows": ["W"]},
                {"of": "raft.mx", "limit": 1e5},
            ],
        )
    )
    kern, overturning, moment = check_results(results)
    # 240 kN on 4 m; e = 60/240 m
    assert kern.value == pytest.approx(6 * 0.25 / 4, rel=1e-9)
    assert overturning.value == pytest.approx(900 / 480, rel=1e-9)
    ends = results["c"].plates["raft"].extremes["mx"]
    assert moment.value in (ends.max, ends.min, ends.max_mean, ends.min_mean)


def test_files_have_the_checks(tmp_path: Path) -> None:
    results = footing({"G": 1, "W": 1}, {"name": "=bearing", "of": "soil.max_pressure", "limit": 100e3})
    for _ in range(2):  # The second run replaces the files of the first.
        files = {file.name for file in write(results, tmp_path, pictures="none")}
    assert "checks.csv" in files
    values = json.loads((tmp_path / "results.json").read_text("utf-8"))
    (one,) = values["checks"]
    assert one["passed"] is False
    assert one["utilisation"] == values["combinations"][0]["checks"][0]["utilisation"]
    assert one["utilisation"] == values["combinations"][0]["supports"][0]["max_pressure"] / 100e3
    (row,) = csv.DictReader((tmp_path / "checks.csv").open(encoding="utf-8"))
    assert row["name"] == "'=bearing"
    assert float(row["utilisation"]) == one["utilisation"]


BASE_PLATE: dict[str, Any] = {
    "material": {"E": 210e3, "nu": 0.3},
    "plate": {"shape": "rectangle", "size": [400, 300], "thickness": 30},
    "mesh": {"divisions": [8, 6]},
    "support": [
        {"name": "grout", "area": "all", "resists": "down", "stiffness": 200},
        {"name": "anchors", "at": [[40, 40], [360, 40], [40, 260], [360, 260]], "resists": "up", "stiffness": 2e5},
    ],
    "load": [
        {"case": "N", "pressure": 2.0, "area": {"rectangle": [100, 75, 300, 225]}},
        {"case": "M", "moment": [1.5e7, 0], "at": [200, 150], "radius": 60},
    ],
    "combination": [
        {"name": "N + M", "group": "ULS", "factors": {"N": 1, "M": 1}},
        {"name": "N - M", "group": "ULS", "factors": {"N": 1, "M": -1.2}},
        {"name": "N", "group": "SLS", "factors": {"N": 1}},
    ],
    "check": [
        {"name": "plate stress", "of": "von_mises", "limit": 213.0},
        {"name": "anchors", "of": "anchors[*].reaction", "limit": [-60e3, 1.0]},
        {"name": "all anchors", "of": "anchors.reaction", "limit": 120e3, "group": "SLS"},
        {"name": "lift", "of": "deflection.min", "limit": 0.5, "combinations": ["N + M"]},
    ],
}


def test_checks_take_the_largest_utilisation_of_fields_points_and_sums() -> None:
    results = solve(Model(**BASE_PLATE))
    stress, anchors, total, lift = check_results(results)
    each = {name: result.extremes["von_mises"] for name, result in results.items()}
    most = {name: max(of.max, 0.0 if math.isnan(of.max_mean) else of.max_mean) for name, of in each.items()}
    assert stress.value == max(most.values())
    assert stress.governing == max(most, key=lambda name: most[name])
    assert stress.place in (each[stress.governing].max_at, each[stress.governing].max_mean_at)
    least = min(float(result.supports["anchors"].reactions.min()) for result in results.values())
    assert anchors.value == least < 0
    assert anchors.limit == -60e3
    assert anchors.utilisation == least / -60e3
    assert str(anchors.place).startswith("anchors[")
    assert total.governing == "N"
    assert lift.governing == "N + M"
    assert lift.utilisation == abs(results["N + M"].extremes["deflection"].min) / 0.5


def test_a_check_has_no_utilisation_in_other_combinations() -> None:
    results = solve(Model(**BASE_PLATE))
    assert np.isnan(results.table["utilisation:all anchors"]).tolist() == [True, True, False]
    assert not np.isnan(results.table["utilisation:plate stress"]).any()


def test_half_widths_of_utilisations_are_those_of_the_values_over_the_limit() -> None:
    results = solve(Model(**BASE_PLATE))
    estimates = estimate(results)
    for one in check_results(results, estimates):
        assert one.governing is not None
        assert one.limit is not None
        of = {"von_mises": ("max:von_mises", "max_mean:von_mises"), "deflection.min": ("min:deflection",)}
        columns = of.get(one.of, (f"reaction_at:{one.place}", f"reaction:{one.place}"))
        widths = [
            width
            for column in columns
            if column in results.combined.layout.catalogue.by_column
            and results.table[column][results.number_of(one.governing)] == one.value
            and (width := estimates.half_width(column, one.governing)) is not None
        ]
        assert one.plus_minus == pytest.approx(widths[0] / abs(one.limit), rel=1e-12)


@pytest.mark.parametrize("tabulated", ["each", "table", "file"])
def test_a_check_passes_only_with_the_half_width_of_every_combination(tabulated: str, tmp_path: Path) -> None:
    """The combination with the largest utilisation is certain to pass; another one has a half-width beyond 1."""
    load = [
        {"case": "even", "pressure": 1e3},
        {"case": "wheel", "force": 1e4, "at": [2, 2], "patch": [0.4, 0.4]},
    ]
    support = [{"edge": ["left", "right"], "fix": "simple"}]
    alike = {"divisions": [6, 6], "load": load, "support": support, "probe": [{"at": [2, 2]}]}
    each = [{"name": case, "factors": {case: 1.0}} for case in ("even", "wheel")]
    first = estimate(solve(rectangular(**alike, combination=each)))
    even, wheel = (first[case].result.probes[0].moment[0] for case in ("even", "wheel"))
    relative = first["wheel"].plus_minus["probes"][0]["moment"][0] / wheel
    assert relative > 0.1 > 10 * first["even"].plus_minus["probes"][0]["moment"][0] / even
    each = [{"name": "even", "factors": {"even": 0.96 / even}}, {"name": "wheel", "factors": {"wheel": 0.94 / wheel}}]
    output = {"combinations": "each" if tabulated == "each" else "table"}
    check = [{"name": "bars", "of": "probe[1].mx", "limit": 1.0}]
    model = rectangular(**alike, combination=each, output=output, check=check)
    file = tmp_path / "table.parquet" if tabulated == "file" else None
    results = solve(model) if file is None else solve(model, table=file)
    estimates = estimate(results) if file is None else estimates_of(results, lambda now: None, file)
    (one,) = check_results(results, estimates)
    assert (one.governing, one.passed, one.verdict) == ("even", None, "undecided: 1 is within ±")
    assert one.utilisation + one.plus_minus < 1.0
    (alone,) = check_results(results)
    assert alone.passed is True


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_a_table_has_the_checks_of_single_results(method: str) -> None:
    single = check_results(solve(Model(**BASE_PLATE | {"solver": {"method": method}})))
    options = {"solver": {"method": method}, "output": {"combinations": "table", "envelope": []}}
    table = solve(Model(**BASE_PLATE | options))
    for one, other in zip(check_results(table), single, strict=True):
        assert (one.name, one.governing, one.place, one.verdict) == (
            *(other.name, other.governing, other.place),
            other.verdict,
        )
        assert one.utilisation == pytest.approx(other.utilisation, rel=1e-8)


def test_the_utilisation_of_a_field_is_a_field_in_files_and_envelopes(tmp_path: Path) -> None:
    """A limit [lower, upper] has its own sign; the envelope has the largest utilisation and its row."""
    name = 'twist of <a> & "b"'
    limits = {"limit": [-50.0, 200.0], "group": "SLS"}
    checks = [{"name": name, "of": "mx", "limit": [-100.0, 50.0]}, {"name": "SLS", "of": "deflection", **limits}]
    options = {
        "output": {"combinations": "table", "fields": "governing"},
        "mesh": {"divisions": [8, 8], "error": False},
    }
    results = solve(Model(**BASE_PLATE | options | {"check": checks}))
    each = []
    for result in (results[key] for key in results):
        mx = result.fields["mx"]
        each.append(np.where(mx < 0, mx / -100.0, mx / 50.0))
        assert np.array_equal(result.fields[f"utilisation:{name}"], each[-1])
        assert np.isnan(result.fields["utilisation:SLS"]).all() == (result.combination.group != "SLS")
    result.plot(f"utilisation:{name}")
    result.to_vtk(tmp_path / "own.vtu")
    assert np.allclose(meshio.read(tmp_path / "own.vtu").point_data[f"utilisation:{name}"], each[-1])
    write(results, tmp_path / "all", pictures="none")
    found = meshio.read(tmp_path / "all" / "envelope.vtu").point_data
    assert np.allclose(found[f"utilisation:{name}_max"], np.max(each, axis=0), rtol=1e-8, atol=1e-12)
    rows = found[f"utilisation:{name}_max_row"].astype(int)
    assert np.allclose(np.array(each)[rows, np.arange(len(rows))], np.max(each, axis=0), rtol=1e-8, atol=1e-12)
    assert "utilisation:SLS_max" not in found
    assert "utilisation:SLS_max" in meshio.read(tmp_path / "all" / "envelope-sls.vtu").point_data


@pytest.mark.parametrize("divisions", [[2, 2], [8, 6]])
def test_a_table_checks_numbers_that_have_no_column_otherwise(divisions: list[int]) -> None:
    """Rows are sums of responses of the few contact points of a coarse mesh, or solved one by one."""
    checks = [
        {"of": "grout.closed_part", "limit": 2.0},
        {"of": "anchors.closed_part", "limit": 2.0},
        {"of": "probe[2].pressure", "limit": 3.0},
        {"of": "grout.max_tension", "limit": 1.0},
    ]
    more: dict[str, Any] = {"probe": [{"at": [[40, 40], [210, 160]]}], "mesh": {"divisions": divisions}}
    tables = BASE_PLATE | {"check": checks, "solver": {"method": "lemke"}} | more
    wanted = check_results(solve(Model(**tables)))
    results = solve(Model(**tables | {"output": {"combinations": "table", "envelope": []}}))
    for one, other in zip(check_results(results), wanted, strict=True):
        assert (one.governing, one.place) == (other.governing, other.place)
        assert one.utilisation == pytest.approx(other.utilisation, rel=1e-8, abs=1e-12)
    assert (results.combined.alone == 0) == (divisions == [2, 2])
    assert np.ptp(results.table["closed_part:grout"]) > 0.1
    line = {"name": "line", "edge": "left", "resists": "down", "stiffness": 100}
    refused = BASE_PLATE | {
        "support": [*BASE_PLATE["support"], line],
        "check": [{"of": "line.closed_part", "limit": 1}],
    }
    with pytest.raises(InputError, match=r"check\[1\]\.of.*combinations"):
        solve(Model(**refused | {"output": {"combinations": "table"}}))


def test_a_path_finds_where_a_check_is_reached() -> None:
    model = Model(**BASE_PLATE)
    result = path(model, "N", "M", 1.2, when=["check:plate stress = 0.2", "check:anchors = 0.1"])
    for threshold, check in zip(result.thresholds, (0, 1), strict=True):
        assert threshold.t is not None
        combination = [{"name": "t", "factors": {"N": 1, "M": threshold.t}}]
        changed = {"combination": combination, "check": [BASE_PLATE["check"][check]]}
        (one,) = check_results(solve(Model(**BASE_PLATE | changed)))
        assert one.utilisation == pytest.approx((0.2, 0.1)[check], rel=1e-4)


@pytest.mark.parametrize(
    ("check", "key"),
    [
        ({"of": "von_mises"}, "limit"),
        ({"of": "von_mises", "limit": 0}, "limit"),
        ({"of": "von_mises", "limit": [1, 2]}, "limit"),
        ({"of": "von_mises", "limit": 1, "grows": ["M"]}, "grows"),
        ({"of": "overturning"}, "grows"),
        ({"of": "overturning", "grows": ["W"]}, "grows"),
        ({"of": "von_mises", "limit": 1, "group": "EQU"}, "group"),
        ({"of": "von_mises", "limit": 1, "combinations": ["N", "M"]}, "combinations"),
        ({"of": "von_mises", "limit": 1, "combinations": ["N"], "group": "SLS"}, "group"),
        ({"of": "von_misses", "limit": 1}, "of"),
    ],
)
def test_a_check_that_cannot_be_computed_is_refused_with_its_key(check: dict[str, Any], key: str) -> None:
    with pytest.raises(InputError, match=rf"check\[1\]\.{key}"):
        solve(Model(**BASE_PLATE | {"check": [check]}))


def test_the_lifted_part_of_a_footing_is_checked() -> None:
    """A rigid footing of length b presses on 3 (b/2 − e); here e = 0.3 b, so that 0.4 of it lift."""
    results = footing({"G": 1, "W": 3}, {"name": "lifted", "of": "soil.lifted_part", "limit": 0.5})
    (one,) = check_results(results)
    assert one.value == pytest.approx(0.4, rel=2e-3) and one.utilisation == one.value / 0.5
