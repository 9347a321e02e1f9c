"""Combinations by the rules of EN 1990 and ASCE 7: counts and factors against the codes, examples, enumeration."""

import itertools

import models
import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import signorini
from signorini import InputError, Model
from signorini.design import asce7, en1990

G = {"kind": "permanent"}
Q = {"kind": "variable", "category": "B"}
W = {"kind": "variable", "category": "wind"}
S = {"kind": "variable", "category": "snow low"}
TRUCK = {"case": "truck", "line": [[0, 2], [4, 2]], "step": 2, "axles": [[0, 10]]}


def tables(cases, rule, code="en1990", moving=(), **combination):
    loads = [{"case": case, "pressure": 1} for case in cases if all(case != one["case"] for one in moving)]
    table = {"generate": code, "rule": rule, **combination}
    return models.tables(load=loads, cases=cases, combination=[table], moving=list(moving))


def generated(*args, **keys):
    """Factors of every combination, by name."""
    combinations = list(Model(**tables(*args, **keys)).effective_combinations)
    factors = {one.name: dict(one.factors) for one in combinations}
    assert len(factors) == len(combinations) == len({frozenset(row.items()) for row in factors.values()})
    return factors


def names(*args, **keys):
    return set(generated(*args, **keys))


# Counts and factors of worked examples


def test_one_permanent_and_two_variable_actions_have_ten_combinations_by_6_10():
    assert list(generated({"G": G, "Q": Q, "W": W}, "6.10")) == [
        "6.10: 1.35 G + 1.5 Q + 0.9 W",
        "6.10: 1.35 G + 1.5 Q",
        "6.10: G + 1.5 Q + 0.9 W",
        "6.10: G + 1.5 Q",
        "6.10: 1.35 G + 1.5 W + 1.05 Q",
        "6.10: 1.35 G + 1.5 W",
        "6.10: G + 1.5 W + 1.05 Q",
        "6.10: G + 1.5 W",
        "6.10: 1.35 G",
        "6.10: G",
    ]


def test_combinations_of_snow_wind_and_imposed_load_are_those_of_steel_buildings_in_europe():
    """Steel Buildings in Europe (ArcelorMittal, Peiner Träger, Corus), Multi-storey, part 3: Actions, 3.2.3 and 3.3."""
    frame = {"G": G, "S": S, "W": W}
    assert {"6.10: 1.35 G + 1.5 S + 0.9 W", "6.10: 1.35 G + 1.5 W + 0.75 S"} <= names(frame, "6.10")
    assert "characteristic: G + S + 0.6 W" in names(frame, "characteristic")
    assert "characteristic: G + S + 0.7 Q" in names({"G": G, "S": S, "Q": Q}, "characteristic")
    assert names(frame, "frequent") == {"frequent: G + 0.2 S", "frequent: G + 0.2 W", "frequent: G"}
    assert "frequent: G + 0.2 S + 0.3 Q" in names({"G": G, "S": S, "Q": Q}, "frequent")
    assert names(frame, "quasi-permanent") == {"quasi-permanent: G"}


def test_6_10a_and_6_10b_reduce_the_leading_action_or_the_permanent_actions():
    found = names({"G": G, "Q": Q}, "6.10ab")
    assert found == {
        *("6.10a: 1.35 G + 1.05 Q", "6.10a: G + 1.05 Q", "6.10a: 1.35 G", "6.10a: G"),
        *("6.10b: 1.1475 G + 1.5 Q", "6.10b: G + 1.5 Q", "6.10b: 1.1475 G"),
    }
    # The national annex of the United Kingdom has ξ = 0.925, so that 1.35 ξ is about 1.25.
    assert "6.10b: 1.24875 G + 1.5 Q" in names({"G": G, "Q": Q}, "6.10ab", xi=0.925)


def test_static_equilibrium_has_the_factors_of_table_a1_2_a():
    found = names({"G": G, "H": G, "Q": Q}, "EQU")
    assert len(found) == 8
    assert {"EQU: 1.1 G + 0.9 H + 1.5 Q", "EQU: 0.9 G + 1.1 H + 1.5 Q", "EQU: 0.9 G + 0.9 H"} <= found


def test_one_accidental_action_acts_in_an_accidental_combination():
    cases = {"G": G, "Q": Q, "S": S, "A1": {"kind": "accidental"}, "A2": {"kind": "accidental"}}
    found = names(cases, "accidental")
    assert {"accidental: G + A1 + 0.5 Q", "accidental: G + A2 + 0.2 S + 0.3 Q", "accidental: G + A1"} <= found
    assert not any("A1" in name and "A2" in name for name in found)
    assert "accidental: G + A1 + 0.3 Q" in names(cases, "accidental", accidental_leading="psi2")
    assert not any("A" in name for name in names(cases, "6.10"))


def test_one_seismic_action_acts_with_quasi_permanent_values():
    """EN 1990, 6.12b: G + P + AEd + Σ ψ2 Q."""
    cases = {"G": G, "Q": Q, "S": S, "E+": {"kind": "seismic"}, "E-": {"kind": "seismic"}}
    assert names(cases, "seismic") == {f"seismic: G + E{sign}{q}" for sign in "+-" for q in ("", " + 0.3 Q")}
    assert not any("E" in name for name in names(cases, "6.10"))


def test_national_factors_stand_in_place_of_the_recommended_ones():
    gamma = {"permanent": [1.2, 0.95], "variable": [1.6, 0], "preload": [1.1, 0.9]}
    preload = {"name": "bolt", "at": [2, 2], "resists": "up", "stiffness": 1e4, "preload": 5, "preload_case": "P"}
    data = tables({"G": G, "Q": {"kind": "variable", "psi": [0.4, 0.3, 0.2]}, "P": {"kind": "preload"}}, "6.10")
    data["load"].pop()
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e4}
    plain = Model(**{**data, "support": [soil, preload]})
    assert "6.10: 1.35 G + P + 1.5 Q" in plain.effective_combinations.names()
    data["combination"][0]["gamma"] = gamma
    model = Model(**{**data, "support": [soil, preload]})
    factors = {tuple(one.factors.get(case, 0.0) for case in "GPQ") for one in model.effective_combinations}
    assert factors == set(itertools.product((1.2, 0.95), (1.1, 0.9), (1.6, 0.0)))


# Groups, followers, parts and moving loads


def test_one_case_of_a_group_acts_at_a_time_and_with_gives_the_factor_of_another():
    cases = {"G": G, "G2": {**G, "with": "G"}, "Q": Q, "W+": {**W, "group": "wind"}, "W-": {**W, "group": "wind"}}
    rows = generated(cases, "6.10")
    assert all(row["G"] == row["G2"] for row in rows.values())
    assert not any({"W+", "W-"} <= row.keys() for row in rows.values())
    assert len(rows) == 2 * (1 + 3 + 2 * 2)


def test_parts_of_one_action_lead_together():
    parts = {f"Q{span}": {**Q, "action": "live"} for span in (1, 2, 3)}
    rows = generated({"G": G, **parts, "W": W}, "6.10")
    assert {"G": 1.35, "Q1": 1.5, "Q3": 1.5, "W": 0.9} in rows.values()
    assert {"G": 1.0, "W": 1.5, "Q2": 1.05, "Q3": 1.05} in rows.values()
    assert all(len({row[part] for part in parts if part in row}) <= 1 for row in rows.values())
    assert len(rows) == 2 * (7 * 2 + 8 + 1)


def test_positions_of_a_moving_load_are_cases_of_one_group():
    group = {"group": "traffic"}
    rows = generated({"G": G, "truck": {**Q, **group}, "Q": {**Q, **group}}, "6.10", moving=[TRUCK])
    leading = {name for row in rows.values() for name in row if name != "G"}
    assert leading == {"truck@0", "truck@2", "truck@4", "Q"}
    assert len(rows) == 2 * (1 + 4)


def test_rules_of_one_kind_in_two_tables_are_told_apart_by_the_names_of_the_tables():
    data = tables({"G": G, "Q": Q}, "6.10", name="STR", group="STR")
    gamma = {"permanent": 1.0, "variable": [1.3, 0]}
    data["combination"].append({"name": "GEO", "group": "GEO", "generate": "en1990", "rule": "6.10", "gamma": gamma})
    found = list(Model(**data).effective_combinations.names())
    assert found[:1] + found[-2:] == ["STR 6.10: 1.35 G + 1.5 Q", "GEO 6.10: G + 1.3 Q", "GEO 6.10: G"]


# Enumeration of all subsets

EVENTS = ("accidental", "seismic")
LABELS = {rule: tuple(one.label for one in of) for rule, of in en1990.EXPRESSIONS.items()}


def written_out(rule, permanent, variable, accidental):
    """Rows of a rule, from every subset of cases: ``variable`` has (case, ψ, action, group) of each case."""
    rows = set()
    sup, inf = {"6.10": (1.35, 1.0), "6.10ab": (1.35, 1.0), "EQU": (1.1, 0.9)}.get(rule, (1.0, 1.0))
    q = 1.5 if rule in ("6.10", "6.10ab", "EQU") else 1.0
    formulas = {
        "6.10": [(sup, 1.0, "ψ0")],
        "EQU": [(sup, 1.0, "ψ0")],
        "6.10ab": [(sup, "ψ0", "ψ0"), (0.85 * sup, 1.0, "ψ0")],
        "accidental": [(sup, "ψ1", "ψ2")],
        "characteristic": [(sup, 1.0, "ψ0")],
        "frequent": [(sup, "ψ1", "ψ2")],
        "quasi-permanent": [(sup, "ψ2", "ψ2")],
        "seismic": [(sup, "ψ2", "ψ2")],
    }[rule]
    for size in range(len(variable) + 1):
        for subset in itertools.combinations(variable, size):
            pairs = itertools.combinations(subset, 2)
            if any(one[3] and one[3] == other[3] and one[2] != other[2] for one, other in pairs):
                continue
            for lead in {of for _, _, of, _ in subset} or {None}:
                for upper, leading, other in formulas:
                    for gammas in itertools.product({upper, inf}, repeat=len(permanent)):
                        for extra in accidental if rule in EVENTS else [None]:
                            row = dict(zip(permanent, gammas, strict=True)) | ({extra: 1.0} if extra else {})
                            for case, psi, of, _ in subset:
                                which = leading if of == lead else other
                                row[case] = q * (which if which == 1.0 else psi[("ψ0", "ψ1", "ψ2").index(which)])
                            rows.add(frozenset((case, float(f"{f:.12g}")) for case, f in row.items() if f))
    return rows - {frozenset()}


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_combinations_are_those_of_every_subset_of_the_cases(data):
    permanent = [f"G{i}" for i in range(data.draw(st.integers(0, 2)))]
    accidental = [f"A{i}" for i in range(data.draw(st.integers(0, 2)))]
    rule = data.draw(st.sampled_from([rule for rule in en1990.GAMMA if accidental or rule not in EVENTS]))
    kind = "seismic" if rule == "seismic" else "accidental"
    cases = {name: G for name in permanent} | {name: {"kind": kind} for name in accidental}
    variable = []
    for index in range(data.draw(st.integers(0, 4))):
        category = data.draw(st.sampled_from(list(en1990.PSI)))
        action, group = data.draw(st.sampled_from([(None, None), ("q", None), (None, "w"), ("r", "w")]))
        own = {"kind": "variable", "category": category, "action": action, "group": group}
        cases[f"Q{index}"] = {key: value for key, value in own.items() if value}
        variable.append((f"Q{index}", en1990.PSI[category], action or f"Q{index}", group))
    expected = written_out(rule, permanent, variable, accidental)
    if not expected:
        return
    rows = generated(cases, rule)
    assert {frozenset(row.items()) for row in rows.values()} == expected
    assert all(name.partition(":")[0] in LABELS[rule] for name in rows)


# ASCE 7

DEAD_LIVE_ROOF_WIND = {
    "LRFD": [
        *("1.4 D", "1.2 D + 1.6 L + 0.5 Lr", "1.2 D + 1.6 L", "1.2 D + 1.6 Lr + L", "1.2 D + 1.6 Lr"),
        *("1.2 D + 1.6 Lr + 0.5 W", "1.2 D + W + L + 0.5 Lr", "1.2 D + W + L", "1.2 D + W + 0.5 Lr"),
        *("1.2 D + W", "0.9 D + W"),
    ],
    "ASD": [
        *("D", "D + L", "D + Lr", "D + 0.75 L + 0.75 Lr", "D + 0.75 L", "D + 0.6 W"),
        *("D + 0.45 W + 0.75 L + 0.75 Lr", "D + 0.45 W + 0.75 L", "D + 0.45 W + 0.75 Lr", "D + 0.45 W"),
        "0.6 D + 0.6 W",
    ],
}


@pytest.mark.parametrize("rule", ["LRFD", "ASD"])
def test_the_basic_combinations_of_asce_7_22_are_generated(rule):
    """ASCE/SEI 7-22, 2.3.1 and 2.4.1, with each load other than the principal one acting or not."""
    found = generated({symbol: {"asce": symbol} for symbol in ("D", "L", "Lr", "W")}, rule, "asce7")
    assert [name.partition(": ")[2] for name in found] == DEAD_LIVE_ROOF_WIND[rule]


def test_one_roof_load_acts_and_seismic_effects_have_two_signs():
    """ASCE/SEI 7-22, 2.3.1 with S and R, 2.3.6 and 2.4.5."""
    cases = {symbol: {"asce": symbol} for symbol in asce7.LOADS if symbol != "P"}
    rows = generated(cases, ["LRFD", "ASD"], "asce7")
    assert not any(len({"Lr", "S", "R"} & row.keys()) > 1 for row in rows.values())
    assert {
        *("LRFD 2a: 1.2 D + 1.6 L + 0.3 S", "LRFD 3a: 1.2 D + S + L", "LRFD 3a: 1.2 D + 1.6 R + 0.5 W"),
        *("LRFD 6: 1.2 D + Ev + E + L + 0.15 S", "LRFD 7: 0.9 D - Ev + E"),
        *("ASD 3a: D + 0.7 S", "ASD 9: D + 0.525 Ev + 0.525 E + 0.75 L + 0.1 S", "ASD 10: 0.6 D - 0.7 Ev + 0.7 E"),
    } <= rows.keys()


# Models


def test_rows_are_solved_like_those_of_a_table(tmp_path):
    cases = {"G": G, "Q": {**Q, "action": "live"}, "Q2": {**Q, "action": "live"}, "W": W}
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e4}
    data = {**tables(cases, ["6.10", "characteristic"]), "support": [soil]}
    data["load"] = [{"case": case, "force": 10 + n, "at": [0.5 + n, 1 + 0.3 * n]} for n, case in enumerate(cases)]
    rows = {
        name: [row.get(case, 0.0) for case in cases]
        for name, row in generated(cases, ["6.10", "characteristic"]).items()
    }
    listed = {**data, "combination": [{"generate": "table", "columns": list(cases), "rows": rows}], "cases": {}}
    results = []
    for number, tables_ in enumerate((data, listed)):
        signorini.solve(Model(**tables_), table=tmp_path / f"{number}.parquet")
        results.append(pq.read_table(tmp_path / f"{number}.parquet").to_pydict())
    numbers = [key for key, values in results[0].items() if isinstance(values[0], float)]
    for key in results[0].keys() - set(numbers):
        assert results[0][key] == results[1][key]
    first, second = (np.array([one[key] for key in numbers], float) for one in results)
    np.testing.assert_allclose(first, second, rtol=1e-9, atol=1e-9 * np.nanmax(np.abs(first)))


def test_a_model_with_cases_is_written_as_toml():
    model = Model(**tables({"G": G, "G2": {**G, "with": "G"}, "Q": Q}, ["6.10ab", "EQU"], xi=0.9))
    assert signorini.loads(model.to_toml()) == model


@pytest.mark.parametrize(
    ("cases", "combination", "says"),
    [
        ({"G": G}, {"rule": "6.10"}, 'generate = "en1990" needs a role of each load case; give the key kind in'),
        ({"G": G, "Q": {"asce": "L"}}, {"rule": "6.10"}, "give the key kind in [cases.Q]."),
        ({"G": G, "Q": {"kind": "variable"}}, {"rule": "6.10"}, "cases.Q: found neither category nor psi"),
        ({"G": {**G, "psi": [1, 1, 1]}, "Q": Q}, {"rule": "6.10"}, "cases.G.psi: psi is for variable cases"),
        ({"G": {}, "Q": Q}, {"rule": "6.10"}, "cases.G.kind: 'kind' is missing."),
        ({"G": G, "Q": Q, "X": Q}, {"rule": "6.10"}, "cases.X: Unknown case 'X'."),
        ({"G": G, "Q": {"with": "X"}}, {"rule": "6.10"}, "cases.Q.with: Unknown case 'X'."),
        ({"G": G, "Q": {"kind": "variable", "with": "G"}}, {"rule": "6.10"}, "cases.Q.kind: found variable"),
        ({"G": {**G, "group": "a"}, "Q": {**Q, "group": "a"}}, {"rule": "6.10"}, "cases.Q.group: found variable"),
        ({"G": G, "Q": Q}, {}, "combination[1].rule: 'rule' is missing."),
        ({"G": G, "Q": Q}, {"rule": "LRFD"}, '"LRFD" is no rule of en1990'),
        ({"G": G, "Q": Q}, {"rule": "accidental"}, '"accidental" gives no combination'),
        ({"G": G, "Q": Q}, {"rule": "6.10", "xi": 0.9}, 'xi is for the rule "6.10ab"'),
        ({"G": G, "Q": Q}, {"rule": ["6.10", "EQU"], "gamma": {"preload": 1}}, "different recommended factors"),
        ({"G": G, "Q": Q}, {"rule": "6.10", "gamma": {"accidental": 1}}, "combination[1].gamma.accidental"),
        ({"G": G, "Q": Q}, {"rule": "6.10", "gamma": {"permanent": -1}}, "combination[1].gamma.permanent: found -1"),
    ],
)
def test_wrong_cases_and_rules_are_refused_with_their_place(cases, combination, says):
    loads = [{"case": case, "pressure": 1} for case in "GQ"]
    with pytest.raises(InputError) as error:
        Model(**models.tables(load=loads, cases=cases, combination=[{"generate": "en1990", **combination}]))
    assert says in str(error.value)


def test_more_than_a_hundred_thousand_rows_are_refused_with_their_number():
    with pytest.raises(InputError, match=r"combination\[1\]: found 114689 combinations; at most 100000"):
        Model(**tables({f"Q{number}": Q for number in range(14)}, "6.10"))
