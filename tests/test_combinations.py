"""Combinations: generated, solved together, and compared with single solves."""

import io
import os
import subprocess
import sys
from pathlib import Path

import models
import numpy as np
import pyarrow.parquet as pq
import pytest
from rich.console import Console

import signorini
from signorini import InputError, Model, NoEquilibriumError, validate
from signorini.accuracy.half_width import largest_of
from signorini.analysis.single import solve_one
from signorini.cli.tables import print_results
from signorini.output import results_json, write
from signorini.results.rows import Layout
from signorini.results.warnings import model_warnings

LEGS = [[1, 1], [3, 1], [3.1, 3.3], [1, 3]]


def tables(**changes):
    patterns = {"permanent": {"G": [1, 1.35]}, "variable": {"Q": 1.5, "W": [-1.5, 1.5], "T": [-1, 1]}}
    given = {
        "material": {"E": 30e6, "nu": 0.2},
        "support": [
            {"name": "legs", "at": LEGS, "resists": "down"},
            {"name": "prop", "at": [2, 2.1], "resists": "both", "gap": 1e-4, "stiffness": 1e4},
        ],
        "load": [
            {"case": "G", "pressure": 5},
            {"case": "Q", "force": 60, "at": [0.5, 0.5]},
            {"case": "W", "pressure": -4, "area": {"rectangle": [0, 0, 4, 2]}},
            {"case": "T", "curvature": [1e-4, 0, 2e-5]},
        ],
        "combination": [{"name": "ULS", "generate": "patterns", **patterns}],
        "probe": [{"at": [[2, 2], [0.3, 3.7]]}],
    }
    return models.tables(**given | changes)


SUPPORTS = {
    "soil": [{"name": "soil", "area": "all", "resists": "down", "stiffness": 2e3}],
    "soil and rigid points": [
        {"name": "soil", "area": {"rectangle": [0, 0, 4, 2]}, "resists": "down", "stiffness": 2e3},
        {"name": "bearings", "at": [[0.7, 3.6], [3.3, 3.6]], "resists": "down", "gap": 1e-4},
        {"name": "anchor", "at": [2, 0.3], "resists": "up", "stiffness": 1e4, "gap": 1e-3},
    ],
    "soil and a point that holds both ways": [
        {"name": "soil", "area": "all", "resists": "down", "stiffness": 2e3, "settlement": "1e-3*x"},
        {"name": "pin", "at": [1.3, 2.2]},
    ],
    "a wall and a rigid bed": [
        {"name": "wall", "edge": "left", "fix": "simple"},
        {"name": "bed", "area": {"rectangle": [2, 0, 4, 4]}, "resists": "down"},
        {"name": "line", "line": [[1, 0.5], [1, 3.5]], "resists": "down", "gap": 2e-4},
    ],
}


def on_areas(support, rows, **changes):
    given = {
        "material": {"E": 30e6, "nu": 0.2},
        "divisions": [6, 6],
        "support": SUPPORTS[support],
        "load": [
            {"case": "G", "pressure": 5},
            {"case": "Q", "force": 60, "at": [0.5, 0.5]},
            {"case": "P", "force": 40, "at": [3.4, 2.5]},
            {"case": "W", "pressure": -4, "area": {"rectangle": [0, 0, 4, 2]}},
        ],
        "combination": [{"generate": "table", "columns": ["G", "Q", "P", "W"], "rows": rows}],
        "probe": [{"at": [[1, 1], [3.3, 2.2]]}],
        "solver": {"method": "active_set"},
        "output": {"combinations": "table", "fields": "none"},
    }
    return models.tables(**given | changes)


def random_rows(count):
    random = np.random.default_rng(3)
    factors = np.column_stack([random.choice([1.0, 1.35], count), random.uniform(0, 1.5, (count, 3))])
    return {f"c{i}": row for i, row in enumerate(factors.tolist())}


def names(data):
    return [combination.name for combination in Model(**data).effective_combinations]


def factors(data):
    return {c.name: dict(c.factors) for c in Model(**data).effective_combinations}


# Generation


def test_patterns_are_every_choice_of_factors_with_variable_cases_absent_or_not():
    generated = factors(tables())
    assert len(generated) == 2 * 2 * 3 * 3
    assert generated["ULS: 1.35 G + 1.5 Q - 1.5 W + T"] == {"G": 1.35, "Q": 1.5, "W": -1.5, "T": 1.0}
    assert generated["ULS: G - T"] == {"G": 1.0, "T": -1.0}
    assert next(iter(generated)) == "ULS: G"


def test_exclusive_cases_never_act_together():
    data = tables()
    data["combination"][0]["exclusive"] = [["Q", "W"]]
    generated = factors(data)
    assert len(generated) == 2 * (1 + 1 + 2) * 3
    assert not any({"Q", "W"} <= set(of) for of in generated.values())


def test_a_table_is_a_row_a_combination_inline_or_from_a_file_beside_the_input_file(tmp_path, monkeypatch):
    (tmp_path / "factors.csv").write_text("name, G, Q\nfirst, 1.35, 1.5\nsecond, 1,\n", "utf-8")
    inline = {"generate": "table", "columns": ["G", "Q"], "rows": {"first": [1.35, 1.5], "second": [1, 0]}}
    expected = {"first": {"G": 1.35, "Q": 1.5}, "second": {"G": 1.0}}
    assert factors(tables(combination=[inline])) == expected
    (tmp_path / "in.toml").write_text(
        "[material]\nE = 1\nnu = 0\n[plate]\nshape = 'disc'\nradius = 1\nthickness = 1\n[[load]]\ncase = 'G'\n"
        "pressure = 1\n[[load]]\ncase = 'Q'\npressure = 1\n[[combination]]\ngenerate = 'table'\nfile = 'factors.csv'\n",
        "utf-8",
    )
    loaded = signorini.load(tmp_path / "in.toml").effective_combinations
    assert {one.name: dict(one.factors) for one in loaded} == expected
    monkeypatch.chdir(tmp_path)
    assert factors(tables(combination=[{"generate": "table", "file": "factors.csv"}])) == expected


TRUCK = {"case": "truck", "line": [[0, 2], [4, 2]], "step": 1.5, "axles": [[0, 10], [1, 30]], "gauge": 1}


def test_a_moving_load_makes_a_combination_of_each_position():
    data = tables(moving=[TRUCK], combination=[{"name": "t", "generate": "positions", "factors": {"G": 1, "truck": 2}}])
    assert factors(data) == {f"t: truck@{s}": {"G": 1.0, f"truck@{s}": 2.0} for s in ("0", "1.5", "3", "4")}
    patterns = {"generate": "patterns", "permanent": {"G": 1}, "variable": {"truck": 1.35}}
    assert names(tables(moving=[TRUCK], combination=[patterns]))[1] == "combination 1: G + 1.35 truck@0"
    assert names(tables(moving=[TRUCK], combination=[]))[0] == "all: truck@0"


def resultant(found, case):
    """Force and its moments about the axes."""
    w = found.cases[case].nodal[::3]
    return np.array([w.sum(), *(found.mesh.points.T @ w)])


@pytest.mark.parametrize("patch", [None, [0.3, 0.2]])
def test_wheels_stand_where_they_should_and_act_only_on_the_plate(patch):
    truck = {**TRUCK, "line": [[1, 3], [1, 1], [3, 1]]} | ({"patch": patch} if patch else {})
    found = signorini.discretise.discretise(Model(**tables(moving=[truck])))
    # The first axle has gone 3 of the 4: on [2, 1], heading x; the second is at the corner, heading y.
    wheels = [(5, 2, 0.5), (5, 2, 1.5), (15, 0.5, 1), (15, 1.5, 1)]
    expected = np.sum([(f, f * x, f * y) for f, x, y in wheels], axis=0)
    assert np.allclose(resultant(found, "truck@3"), expected, rtol=1e-9)
    # At the start the second axle is behind the line's beginning, on the plate's edge: half of each print acts.
    assert np.isclose(resultant(found, "truck@0")[0], 10 + (15 if patch else 30), rtol=1e-9)
    said = [sentence for sentence in model_warnings(found) if "moving" in sentence]
    assert len(said) == (patch is not None)
    assert all("at truck@0, axle 2, 50 % of its force does not act" in sentence for sentence in said)


@pytest.mark.parametrize(
    ("combination", "says"),
    [
        ({"generate": "patterns"}, "combination[1].variable: 'variable' is missing."),
        ({"generate": "patterns", "variable": {"Q": [1, 1.0]}}, "the factor 1 is listed twice."),
        ({"generate": "patterns", "variable": {"Z": 1}}, "combination[1].variable.Z: Unknown case 'Z'. This model has"),
        ({"generate": "patterns", "permanent": {"Q": 1}, "variable": {"Q": 1}}, "is both permanent and variable"),
        ({"generate": "patterns", "variable": {"Q": 1}, "exclusive": [["Q", "W"]]}, '"W" is not a variable case'),
        (
            {"generate": "patterns", "variable": {c: [0.1 * i for i in range(1, 60)] for c in "GQWT"}},
            "found 1.3e+07 combinations up to this table; at most 1000000 are allowed.",
        ),
        ({"generate": "table"}, "needs either file, or columns and rows."),
        (
            {"generate": "table", "columns": ["G"], "rows": {"a": [1, 2]}},
            "combination[1].rows.a: found 2 factors; columns lists 1 cases.",
        ),
        ({"generate": "table", "file": "no.csv"}, "combination[1].file: no.csv cannot be read: No such file"),
        ({"factors": {"G": 1}, "variable": {"Q": 1}}, "variable is not allowed with a combination without generate"),
        ({"factors": {"G": [1, 1.35]}}, "found [1, 1.35]; it must be a number"),
        ({"generate": "positions", "factors": {"G": 1}}, 'generate = "positions" needs a case of [[moving]]'),
        ({"factors": {"truck": 1}}, '"truck" is a moving load. Write generate = "positions"'),
    ],
)
def test_what_cannot_be_generated_is_refused_with_its_place(combination, says):
    with pytest.raises(InputError) as error:
        validate(tables(moving=[TRUCK], combination=[combination]))
    assert says in str(error.value)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "has no header"),
        ("G,Q\n1.35,1\n", 'begins with "G"; its first column must be "name"'),
        ("name,G\na,1_000\n", 'has "1_000" under "G"; it must be a number.'),
        ("name,G,G\na,1,1\n", 'has the load case "G" twice'),
        ("name,G\na,1,2\n", "line 2 of f.csv has 2 factors; the header names 1 cases."),
        ("name,G\na,1\na,1\n", 'it generates the name "a", as does combination[1]'),
    ],
)
def test_a_bad_file_of_factors_is_refused_with_its_line(tmp_path, monkeypatch, text, says):
    (tmp_path / "f.csv").write_text(text, "utf-8")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError) as error:
        validate(tables(combination=[{"generate": "table", "file": "f.csv"}]))
    assert says in str(error.value)


def test_too_many_positions_are_refused():
    with pytest.raises(InputError, match="have 40001 positions; at most 2000"):
        validate(tables(moving=[{**TRUCK, "step": 1e-4}]))


# Solving


def columns(path):
    return pq.read_table(path).to_pydict()


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    path = tmp_path_factory.mktemp("table") / "combinations.parquet"
    model = Model(**tables())
    return signorini.solve(model, table=path), columns(path)


def close(a, b, scale):
    return abs(a - b) <= 1e-9 * scale


def same_as_alone(model, table):
    """Hold every row to its combination solved by itself; the states of contact there are."""
    problem, states = signorini.contact_problem(model), set()
    for row, combination in enumerate(model.effective_combinations):
        single = solve_one(problem, combination)
        assert table["combination"][row] == single.name and table["status"][row] == "solved"
        sizes, places = largest_of(single), single.catalogue.by_path
        force = max(np.abs(one.reactions).max() for one in single.supports)
        sizes = {kind: max(size, force if kind == "reaction" else 0.0) for kind, size in sizes.items()}
        for one in Layout.of(problem.discretisation).catalogue:
            value, size = single.numbers[places[one.path]], sizes[one.quantity.kind]
            told = np.array(table[one.column][row], dtype=np.float64)
            assert (np.isnan(value) and np.isnan(told)) or close(told, value, 10 * size), one.column
        for name in ("equilibrium", "balance", "penetration", "tension", "complementarity"):
            assert table[f"certificate:{name}"][row] <= 1e-10
        states.add(tuple(one.closed.tobytes() for one in single.supports))
    return states


def test_every_row_equals_the_combination_solved_by_itself(solved):
    results, table = solved
    assert results.combined.solved == len(table["combination"]) == 36 and results.combined.alone == 0
    assert "reaction_at:legs[4]" in table and "reaction_at:prop[1]" in table
    assert len(same_as_alone(results.model, table)) > 2


@pytest.mark.parametrize("support", SUPPORTS)
def test_so_does_every_row_of_plates_on_areas(tmp_path, support):
    model = Model(**on_areas(support, random_rows(30)))
    results = signorini.solve(model, table=tmp_path / "t.parquet")
    assert len(same_as_alone(model, columns(tmp_path / "t.parquet"))) > 2
    # With two-sided points an active set sometimes leaves a combination to Lemke's algorithm.
    assert results.combined.alone <= (10 if "both" in support else 0)


def test_so_does_every_row_with_preloaded_bolts(tmp_path):
    """Preloads by the factor of their case: each has contact points with gaps of its own."""
    bolts = {"at": [[1, 1], [3, 1], [2, 3]], "resists": "up", "stiffness": 1e4, "preload": 20, "preload_case": "P"}
    soil = {"name": "pads", "at": LEGS, "resists": "down", "stiffness": 1e5}
    rows = {str(at): [1.0 + 0.1 * at, 0.25 * at] for at in range(5)}
    combination = [{"name": "c", "generate": "table", "columns": ["G", "P"], "rows": rows}]
    table = {"combination": combination, "output": {"combinations": "table", "envelope": ["deflection", "mx"]}}
    model = Model(**tables(support=[soil, {"name": "bolts", **bolts}], **table))
    signorini.solve(model, table=tmp_path / "t.parquet")
    table = columns(tmp_path / "t.parquet")
    assert table["preload:bolts"] == pytest.approx([-60 * 0.25 * at for at in range(5)])
    same_as_alone(model, table)


def test_so_does_every_row_of_several_plates(tmp_path):
    """Plates with contacts, ties, springs, sections and strips."""
    plate = {"shape": "rectangle", "size": [4, 2], "thickness": 0.2, "mesh": {"divisions": [4, 2]}}
    feet = {"at": [[0.2, 0.2], [3.8, 0.2], [0.2, 1.8], [3.8, 1.8]], "resists": "down"}
    rows = {name: values[:3] for name, values in random_rows(12).items()}
    model = Model(
        material={"E": 30e6, "nu": 0.2},
        plates={"upper": {**plate, "size": [3, 1], "origin": [0.5, 0.5]}, "lower": plate},
        support=[
            {"name": "feet", "plate": "lower", **feet},
            {"name": "spring", "plate": "lower", "at": [2, 1], "stiffness": 1e3, "rotational_stiffness": 1e2},
            {"name": "tie", "between": ["upper", "lower"], "at": [[1, 1]], "resists": "up", "stiffness": 1e4},
        ],
        contact=[
            {"name": name, "between": ["upper", "lower"], "area": {"rectangle": box}, "stiffness": 1e6}
            for name, box in (("west", [0.5, 0.5, 1.25, 1.0]), ("east", [2.75, 1.0, 3.5, 1.5]))
        ],
        load=[
            {"plate": "upper", "case": "G", "pressure": 5},
            {"plate": "lower", "case": "G", "pressure": 5},
            {"plate": "upper", "case": "Q", "force": 20, "at": [2, 1], "patch": [0.4, 0.4]},
            {"plate": "upper", "case": "W", "curvature": [1e-4, 0, 2e-5]},
        ],
        probe=[{"plate": "upper", "at": [1.3, 0.8]}, {"plate": "lower", "at": [[2, 1], [0.9, 0.9]]}],
        section=[{"name": "cut", "plate": "lower", "line": [[1.5, 0], [1.5, 2]]}],
        strip=[{"name": "strip", "plate": "upper", "line": [[0.5, 1], [3.5, 1]], "width": 1}],
        combination=[{"name": "c", "generate": "table", "columns": ["G", "Q", "W"], "rows": rows}],
        output={"combinations": "table", "envelope": ["deflection", "mx", "mxy", "qx", "m1", "von_mises"]},
    )
    results = signorini.solve(model, table=tmp_path / "t.parquet")
    assert results.combined.alone == 0
    same_as_alone(model, columns(tmp_path / "t.parquet"))


def test_the_envelope_bounds_every_combination_and_names_the_one_that_governs(solved):
    results, _ = solved
    combined = results.combined
    problem = signorini.contact_problem(results.discretisation)
    singles = [solve_one(problem, combination) for combination in combined.combinations]
    for name, extremes in combined.envelope.fields.items():
        every = np.array([s.nodal_reaction if name == "reaction" else s.fields[name] for s in singles])
        scale = np.abs(every).max()
        assert np.abs(extremes.largest - every.max(axis=0)).max() <= 1e-9 * scale
        assert np.abs(extremes.smallest - every.min(axis=0)).max() <= 1e-9 * scale
        nodes = np.arange(every.shape[1])
        assert np.abs(every[extremes.largest_by, nodes] - every.max(axis=0)).max() <= 1e-9 * scale
    open_in = combined.envelope.open_in[0].tolist()
    assert open_in == [sum(not s.supports[0].closed[p] for s in singles) for p in range(4)]
    assert combined.envelope["reaction:legs"].max == pytest.approx(max(s.reactions["legs"] for s in singles), rel=1e-9)


def grouped(groups, **changes):
    """Combinations of which those of a group come in turn with those of the other."""
    factors = {"ULS": {"G": 1.35, "Q": 1.5}, "SLS": {"G": 1, "Q": 1}}
    made = [
        {"name": f"{name} {i}", "group": name, "factors": factors[name] | {"Q": factors[name]["Q"] * i / 8}}
        for i in range(8)
        for name in groups
    ]
    return signorini.solve(Model(**tables(combination=made, output={"combinations": "table"}) | changes))


@pytest.mark.parametrize("changes", [{}, {"solver": {"method": "active_set"}}])
def test_groups_have_the_envelopes_of_their_own_combinations(changes):
    both = grouped(["ULS", "SLS"], **changes)
    found = {group["name"]: group for group in results_json(both)["groups"]}
    assert list(found) == list(both.groups) == ["ULS", "SLS"]
    assert found["SLS"]["combinations"] == 8
    for name in found:
        alone = grouped([name], **changes)
        written, own = results_json(alone), found[name]
        assert [one["max_by"] for one in own["governing_reactions"]] == [
            one["max_by"] for one in written["governing_reactions"]
        ]
        theirs, mine = written["envelope"], own["envelope"]
        assert mine["file"] == f"envelope-{name.lower()}.vtu"
        assert mine["fields"]["mx"]["max"] == pytest.approx(theirs["fields"]["mx"]["max"], rel=1e-9)
        assert mine["fields"]["mx"]["max_by"] == theirs["fields"]["mx"]["max_by"]
        assert mine["supports"][0]["lifted"] == theirs["supports"][0]["lifted"]
        assert set(alone.governing) <= set(both.governing)
    # The envelope of all is that of both together.
    largest = [group["envelope"]["fields"]["mx"]["max"] for group in found.values()]
    assert results_json(both)["envelope"]["fields"]["mx"]["max"] == max(largest)
    open_in = [envelope.open_in[0] for envelope in both.groups.values()]
    assert both.envelope.open_in[0].tolist() == sum(open_in).tolist()


@pytest.mark.parametrize("changes", [{}, {"solver": {"method": "active_set"}}, {"output": {"combinations": "each"}}])
def test_of_extremes_alike_but_for_rounding_the_first_combination_governs(changes):
    # Four winds without a resultant, each the other's turned by a right angle: totals and fields are as large.
    turns = {"W": ([0.1, 0.1], [3.9, 3.9]), "E": ([3.9, 3.9], [0.1, 0.1])}
    turns |= {"N": ([0.1, 3.9], [3.9, 0.1]), "S": ([3.9, 0.1], [0.1, 3.9])}
    load = [{"case": "G", "pressure": 5}]
    load += [
        {"case": case, "force": sign * 7.7, "at": [at]}
        for case, two in turns.items()
        for sign, at in zip((1, -1), two, strict=True)
    ]
    made = [{"name": case, "group": "ULS", "factors": {"G": 1.35, case: 0.9}} for case in turns]
    legs = {"name": "legs", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}
    given = {"load": load, "combination": made, "support": [legs], "output": {"combinations": "table"}} | changes
    results = signorini.solve(Model(**tables(probe=[{"at": [2, 2]}], **given)))
    totals = [results[name].supports[0].reaction for name in turns]
    assert np.ptp(totals) <= 1e-9 * totals[0]
    for envelope in (results.combined.envelope, results.combined.over("ULS")):
        for ends in (envelope["reaction:legs"], envelope["probe[1]:deflection"], envelope.field("deflection")):
            assert ends.max_by == ends.min_by == 0
        assert [envelope[f"reaction_at:legs[{number}]"].max_by for number in range(1, 5)] == [0, 3, 1, 2]


def test_envelopes_of_groups_have_half_widths_files_and_tables(tmp_path):
    results = grouped(["ULS", "SLS"])
    write(results, tmp_path)
    listed = {entry["file"] for entry in results_json(results)["files"]}
    assert {"envelope.vtu", "envelope-uls.vtu", "envelope-sls.vtu"} <= listed
    assert listed == {path.name for path in tmp_path.iterdir()}
    estimates = signorini.estimate(results)
    for group in results_json(results, estimates)["groups"]:
        assert group["envelope"]["plus_minus"]["supports"][0]["reaction"]["max"] >= 0
    console = Console(file=io.StringIO(), width=200)
    print_results(console, results, estimates)
    lines = console.file.getvalue().splitlines()
    uls, sls = lines.index("ULS: 8 combinations"), lines.index("SLS: 8 combinations")
    assert uls < sls
    assert not any("SLS" in line for line in lines[uls:sls])


def test_a_group_of_all_combinations_has_the_files_of_all(tmp_path):
    results = grouped(["ULS"])
    write(results, tmp_path)
    found = results_json(results)
    names = [entry["file"] for entry in found["files"]]
    assert "envelope.vtu" in names and not [name for name in names if name.startswith("envelope-uls")]
    assert sorted(names) == sorted(path.name for path in tmp_path.iterdir())
    (group,) = found["groups"]
    assert group["envelope"] == found["envelope"] and group["envelope"]["file"] == "envelope.vtu"


def test_only_those_that_govern_have_all_results(solved):
    results, _ = solved
    assert 0 < len(results.full) <= 12 and set(results.full) == set(results.governing)
    found = results_json(results)
    assert [c["name"] for c in found["combinations"]] == list(results.full)
    assert found["table"]["solved"] == 36 and found["envelope"]["fields"]["deflection"]["max_by"] in results.full


@pytest.mark.parametrize("count", [12, 13])
def test_twelve_combinations_and_thirteen_are_one_api(count):
    rows = {f"c{i}": [1, 0.1 * i, 5 * (i == 3), 0] for i in range(count)}
    table = [{"generate": "table", "columns": ["G", "Q", "W", "T"], "rows": rows}]
    results = signorini.solve(Model(**tables(combination=table)))
    assert results.model.tabulated == (count == 13)
    assert len(results) == count and list(results) == list(rows) and "c5" in results and "c99" not in results
    one = results["c5"]
    assert one.certificate.passed and one.deflection.any() and results["c5"] is one
    single = signorini.solve(Model(**tables(combination=[{"name": "c5", "factors": {"G": 1, "Q": 0.5}}])))
    assert set(results.limits) == set(rows) and results.limits["c5"] == single.limits["c5"]
    shown = "{'c0': ..., 'c1': ..., 'c2': ..., 'c3': ..., ... 13 in all}" if count == 13 else repr(dict(results.limits))
    assert repr(results.limits) == shown
    widths = signorini.estimate(results)
    width = widths.half_width("reaction:legs", "c5")
    assert width == widths.half_width("reaction:legs", 5) == widths.table["reaction:legs:plus_minus"][5] > 0
    assert results.table["combination"] == tuple(rows)
    assert results.table["reaction:legs"][5] == pytest.approx(one.reactions["legs"], rel=1e-9)
    assert results.table["max:deflection"][5] == pytest.approx(one.deflection.max(), rel=1e-9)
    extremes = results.envelope.fields["deflection"]
    at = int(extremes.largest.argmax())
    assert results[results.key(int(extremes.largest_by[at]))].deflection[at] == pytest.approx(extremes.largest[at])
    assert set(results.governing) <= set(rows) and results.combined.solved == count - results.unbalanced_count
    with pytest.raises(KeyError, match="c99"):
        results["c99"]
    with pytest.raises(ValueError, match="read-only"):
        results.table["reaction:legs"][0] = 0


def test_fields_may_be_asked_for_by_name_or_not_at_all():
    chosen = signorini.solve(Model(**tables(output={"fields": ["ULS: G"]})))
    assert list(chosen.full) == ["ULS: G"] and chosen["ULS: G"].certificate.passed
    assert not signorini.solve(Model(**tables(output={"fields": "none", "envelope": []}))).full
    with pytest.raises(InputError, match="Unknown combination 'ULS: F'"):
        validate(tables(output={"fields": ["ULS: F"]}))


def test_combinations_without_equilibrium_are_reported_and_the_others_go_on(tmp_path):
    rows = {f"c{i}": [1, w] for i, w in enumerate([0, 1, 5, 2, 30])}
    data = tables(
        support=[{"name": "legs", "at": LEGS, "resists": "down"}],
        combination=[{"generate": "table", "columns": ["G", "W"], "rows": rows}],
        output={"combinations": "table"},
    )
    results = signorini.solve(Model(**data), table=tmp_path / "t.parquet")
    table = columns(tmp_path / "t.parquet")
    balanced = [status == "solved" for status in table["status"]]
    assert balanced == [name not in results.unbalanced for name in table["combination"]] and not all(balanced)
    assert [value is not None for value in table["reaction:legs"]] == balanced
    assert "lifts off" in results.unbalanced["c4"] or "tips" in results.unbalanced["c4"]
    data["combination"][0]["rows"] = {"up": [0, 1]}
    with pytest.raises(NoEquilibriumError, match="None of 1 combinations"):
        signorini.solve(Model(**data))


def test_a_moving_load_has_columns_for_its_factor_and_its_place(tmp_path):
    rows = {"first": [1, 2, 0], "second": [1, 0, 3], "both": [1, 1, 1]}
    table = {"generate": "table", "columns": ["G", "truck@0", "truck@1.5"], "rows": rows}
    data = tables(moving=[TRUCK], combination=[table], output={"combinations": "table", "fields": "none"})
    signorini.solve(Model(**data), table=tmp_path / "t.parquet")
    found = columns(tmp_path / "t.parquet")
    assert (found["factor:truck"], found["position:truck"]) == ([2.0, 3.0, None], [0.0, 1.5, None])


def shuffled(of, forward):
    """A table of some combinations, from the first to the last or the other way round."""
    legs = np.random.default_rng(1).uniform(-0.5, 2, (200, 4)).tolist()
    rows = random_rows(40) if of == "areas" else {f"c{i}": row for i, row in enumerate(legs)}
    rows = {name: rows[name] for name in (rows if forward else reversed(rows))}
    if of == "areas":
        return on_areas("soil and rigid points", rows)
    table = {"generate": "table", "columns": ["G", "Q", "W", "T"], "rows": rows}
    return tables(combination=[table], output={"fields": "none"})


SCRIPT = """
import sys, signorini
sys.path.insert(0, sys.argv[1])
from test_combinations import shuffled
signorini.solve(signorini.Model(**shuffled(sys.argv[3], sys.argv[4] == "forward")), table=sys.argv[2])
"""


@pytest.mark.parametrize(("of", "count"), [("points", 200), ("areas", 40)])
def test_neither_order_nor_number_of_threads_changes_a_bit(tmp_path, of, count):
    found = []
    for threads, order in (("1", "forward"), ("3", "backward")):
        path = tmp_path / f"{threads}.parquet"
        command = [sys.executable, "-c", SCRIPT, str(Path(__file__).parent), str(path), of, order]
        subprocess.run(command, check=True, env={**os.environ, "RAYON_NUM_THREADS": threads})
        table = columns(path)
        rows = zip(*table.values(), strict=True)
        found.append(dict(zip(table["combination"], rows, strict=True)))
    assert len(found[0]) == count and found[0] == found[1]


def test_nothing_half_written_is_left(tmp_path, monkeypatch):
    def fail(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("signorini.analysis.combinations.combined._Run.solve", fail)
    with pytest.raises(KeyboardInterrupt):
        signorini.solve(Model(**tables()), table=tmp_path / "t.parquet")
    assert list(tmp_path.iterdir()) == []


def test_a_table_of_combinations_without_load_is_solved() -> None:
    rows = [{"generate": "table", "columns": ["G"], "rows": {"before": [0.0], "after": [0.0]}}]
    results = signorini.solve(Model(**tables(combination=rows, output={"combinations": "table", "fields": "all"})))
    for name in ("before", "after"):
        assert list(results[name].reactions.values()) == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_table_of_a_plate_without_contact_points_is_solved():
    support = [{"edge": ["left", "right"], "fix": "hard"}]
    load = [{"case": "G", "pressure": 1e3}, {"case": "Q", "pressure": 2e3}]
    combination = [{"factors": {"G": 1, "Q": q}} for q in (0.5, 1)]
    tables = {"support": support, "load": load, "combination": combination}
    single = signorini.solve(models.rectangular(**tables))
    table = signorini.solve(models.rectangular(**tables, output={"combinations": "table"})).table
    wanted = [result.deflection.max() for result in single.values()]
    np.testing.assert_allclose(table["max:deflection"], wanted, rtol=1e-9)


def test_shears_of_a_thin_plate_on_soft_supports_are_those_of_the_combination_alone(tmp_path):
    """Terms of the sum have shears a million times as large, which were each rounded in a double."""
    given = {
        "material": {"E": 1.0, "nu": 0.49},
        "plate": {"shape": "rectangle", "size": [1, 0.1], "thickness": 1e-5},
        "mesh": {"divisions": [2, 5], "error": False},
        "support": [
            {"area": {"rectangle": [0.5, 0.08, 0.7, 0.1]}, "stiffness": 1.9e-21},
            {"edge": ["left", "top", "right", "bottom"], "resists": "down", "stiffness": 2.4e-18},
        ],
        "load": [
            {"case": "A", "line_load": 0.1, "edge": ["bottom"]},
            {"case": "B", "force": 0.05, "at": [0.53, 0.0436]},
        ],
        "combination": [{"name": "c", "factors": {"A": 0.9, "B": -0.5}}, {"name": "d", "factors": {"A": 1, "B": 0}}],
    }
    path = tmp_path / "rows.parquet"
    signorini.solve(validate(given | {"output": {"combinations": "table"}}), table=path)
    alone = signorini.solve(validate(given | {"output": {"combinations": "each"}}))
    for name, largest, least in zip(*(columns(path)[key] for key in ("combination", "max:qy", "min:qy")), strict=True):
        expected = alone[name].extremes["qy"]
        assert (largest, least) == pytest.approx((expected.max, expected.min), rel=1e-9)


# Plates on areas: their active sets side by side


def test_one_without_equilibrium_and_one_that_nearly_tips_stand_among_others(tmp_path):
    rows = random_rows(20) | {"flies": [1, 0, 0, 20], "tips": [1, 30, 0, 3.5], "stands": [1, 30, 0, 0]}
    model = Model(**on_areas("soil", rows))
    results = signorini.solve(model, table=tmp_path / "t.parquet")
    table = {row["combination"]: row for row in pq.read_table(tmp_path / "t.parquet").to_pylist()}
    assert set(results.unbalanced) == {name for name, row in table.items() if row["status"] != "solved"}
    assert "lifts off" in results.unbalanced["flies"] and "flies" in results.unbalanced
    stands = {c.name: c for c in model.effective_combinations}["stands"]
    single = solve_one(signorini.contact_problem(model), stands)
    assert table["stands"]["reaction:soil"] == pytest.approx(single.reactions["soil"], rel=1e-9)
    assert table["stands"]["open:soil"] == single.supports[0].open_count > 0


def test_a_batch_of_which_none_has_equilibrium_stands_before_one_that_has() -> None:
    """More than are in memory at once tip, so that none of them is left to be solved together."""
    rows = {f"c{i}": [0.0, 0.0, 0.0, 1.0 + i] for i in range(70)} | {"rests": [1.0, 0.0, 0.0, 0.0]}
    combined = signorini.solve(Model(**on_areas("soil", rows))).combined
    assert combined is not None and (combined.solved, len(combined.combinations)) == (1, 71)


BITS = """
import hashlib, signorini
model = signorini.Model(
    material={"E": 30e9, "nu": 0.2},
    plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
    mesh={"divisions": [48, 48]},
    support=[{"area": "all", "resists": "down", "stiffness": 1e7}],
    load=[{"pressure": 1e3}, {"at": [9, 8.5], "force": -2e5}, {"at": [2, 3], "force": 2e6}],
)
print(hashlib.sha256(signorini.solve(model)["all"].deflection.tobytes()).hexdigest())
"""


def test_a_slab_on_soil_has_the_same_bits_on_any_number_of_threads():
    found = [
        subprocess.run(
            [sys.executable, "-c", BITS],
            check=True,
            capture_output=True,
            env={**os.environ, "RAYON_NUM_THREADS": threads},
        ).stdout
        for threads in "123"
    ]
    assert found[0] and found[0] == found[1] == found[2]


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_pressure_and_contact_area_are_columns_and_have_envelopes(method, tmp_path):
    support = "soil and rigid points" if method == "lemke" else "a wall and a rigid bed"
    rows = random_rows(100 if method == "lemke" else 14)
    model = Model(**on_areas(support, rows, solver={"method": method}, mesh={"divisions": [4, 4]}))
    combined = signorini.solve(model, table=tmp_path / "rows.parquet").combined
    assert combined.alone == 0
    rows = columns(tmp_path / "rows.parquet")
    problem = signorini.contact_problem(model)
    alone = [solve_one(problem, combination) for combination in model.effective_combinations]
    (index,) = (i for i, one in enumerate(model.support) if one.area is not None)
    name = model.support[index].name
    found = np.array([[one.supports[index].max_pressure, one.supports[index].contact_area] for one in alone])
    assert np.allclose(rows[f"max_pressure:{name}"], found[:, 0], rtol=1e-7)
    assert np.allclose(rows[f"contact_area:{name}"], found[:, 1], rtol=1e-7)
    assert np.ptp(found[:, 0]) > 0
    ends = [combined.envelope[f"{what}:{name}"] for what in ("max_pressure", "contact_area")]
    assert np.allclose([one.max for one in ends], found.max(axis=0), rtol=1e-7)
    assert np.allclose([one.min for one in ends], found.min(axis=0), rtol=1e-7)


def test_a_table_without_any_equilibrium_is_refused_with_its_reasons():
    """None of the sums has an equilibrium; sections and probes have no row."""
    up = [{"name": f"up {at}", "factors": {"Q": -float(at)}} for at in range(1, 4)]
    given = tables(support=[{"name": "legs", "at": LEGS, "resists": "down"}], combination=up)
    given |= {"section": [{"line": [[1, 0], [1, 3]]}], "output": {"combinations": "table"}}
    with pytest.raises(signorini.NoEquilibriumError, match="up 1"):
        signorini.solve(Model(**given))
