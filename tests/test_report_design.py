"""A checking engineer finds every number of the design in the report, with its clause."""

import math
from typing import Any

import pytest

import signorini
from signorini import Model
from signorini.analysis.estimate import estimates_of
from signorini.output.tables import results_json
from signorini.reports import design, numbers, page
from signorini.reports.blocks import Block, Table, Text, Writer
from signorini.reports.maps import map_data
from signorini.reports.sections import Contents


def floor(**keys: Any) -> Model:
    column = {"name": "columns", "at": [[1, 1], [5, 1], [1, 5], [5, 5]], "patch": [0.4, 0.4], "resists": "down"}
    tables: dict[str, Any] = {
        "units": {"length": "m", "force": "kN"},
        "material": {"E": 33e6, "nu": 0.2, "unit_weight": 25},
        "plate": {"shape": "rectangle", "size": [6, 6], "thickness": 0.2},
        "mesh": {"size": 0.5},
        "support": [column | {"stiffness": 1e6}],
        "load": [
            {"case": "G", "self_weight": True},
            {"case": "Q1", "pressure": 35, "area": {"rectangle": [0, 0, 3, 6]}},
            {"case": "Q2", "pressure": 35, "area": {"rectangle": [3, 0, 6, 6]}},
            {"case": "W", "pressure": 1},
        ],
        "cases": {
            "G": {"kind": "permanent"},
            "Q1": {"kind": "variable", "category": "B", "action": "Q"},
            "Q2": {"kind": "variable", "category": "B", "action": "Q"},
            "W": {"kind": "variable", "category": "wind"},
        },
        "combination": [
            {"name": "ULS", "generate": "en1990", "rule": "6.10ab", "gamma": {"variable": [1.4, 0]}},
            {"name": "SLS", "group": "SLS", "generate": "en1990", "rule": "quasi-permanent"},
        ],
        "reinforcement": {
            "code": "EN 1992-1-1:2004",
            "fck": 30e3,
            "fyk": 500e3,
            "cover": {"top": 0.03, "bottom": 0.03},
            "bar": 0.012,
        },
        "punching": [
            {
                "support": "columns",
                "code": "EN 1992-1-1:2004",
                "d": [0.164, 0.152],
                "rho": [0.006, 0.006],
                "fck": 30e3,
                "fyk": 500e3,
            }
        ],
        "check": [{"name": "sag", "of": "deflection", "limit": 0.02, "group": "SLS"}],
        "report": {"number": "B-017", "approver": "C. Jones"},
    }
    return Model(**{**tables, **keys})


@pytest.fixture(scope="module")
def of() -> Contents:
    results = signorini.solve(floor())
    estimates = estimates_of(results, lambda _: None)
    values = results_json(results, estimates)
    return Contents(results, estimates, values, Writer("en", results.model.units), "")


def tables(blocks: Any) -> dict[str, list[dict[str, str]]]:
    """Rows of the tables by caption, each with its cells by title."""
    return {
        one.caption: [dict(zip(one.head, (cell.text for cell in row), strict=True)) for row in one.rows]
        for one in blocks
        if isinstance(one, Table) and one.rows
    }


def texts(blocks: Any) -> str:
    return "\n".join(one.words for one in blocks if isinstance(one, Text))


def test_strengths_and_factors_have_values_clauses_and_sources(of: Contents) -> None:
    (strengths,) = tables(design.strengths(of)).values()
    found = {row["Symbol"].split()[0]: row for row in strengths if row["Part"] == "Reinforcement"}
    wanted = {"fck": "30", "fyk": "500", "γC": "1.5", "γS": "1.15", "αcc": "1", "fcd": "20", "fyd": "434.8"}
    assert {name: found[name]["Value"] for name in wanted} == wanted and found["fctm"]["Value"] == "2.896"
    assert "2.4.2.4" in found["γC"]["Clause"] and "3.1.6" in found["fcd"]["Clause"]
    assert found["γC"]["Source"] == "recommended value"
    blocks: list[Block] = list(design.factors(of))
    rules, actions = tables(blocks).values()
    assert rules[0]["Factors"] == "γG = 1.35 / 1; γQ = 1.4 / 0; γP = 1; ξ = 0.85"
    assert "A1.2(B)" in rules[0]["Clause"] and "gamma.variable" in rules[0]["Source"]
    assert "6.5.3" in rules[1]["Clause"] and rules[1]["Source"] == "recommended value"
    assert [actions[3][key] for key in ("ψ0", "ψ1", "ψ2", "Category")] == ["0.6", "0.2", "0", "wind"]
    said = texts(blocks)
    assert "the action Q has the parts Q1, Q2" in said and "Without pattern loading: W" in said


def test_the_largest_areas_follow_from_the_numbers_in_their_rows(of: Contents) -> None:
    found = tables(design.reinforcement(of))
    largest = found["Largest required areas over all combinations"]
    least = {row["Layer"]: float(row["As,min [mm²/m]"]) for row in list(found.values())[1]}
    assert len(largest) == 4 and {row["Decided by"] for row in largest} <= {"bending", "minimum governs"}
    for row in largest:
        mx, my, mxy, m, d = (float(row[f"{key}"]) for key in (*(k for k in row if k.endswith("[kN m/m]")), "d [m]"))
        sign = -1 if row["Layer"].startswith("top") else 1
        assert m == pytest.approx(sign * (my if " y " in row["Layer"] else mx) + abs(mxy), rel=1e-3)
        z = d / 2 * (1 + math.sqrt(1 - 2 * m / (20e3 * d**2)))
        assert float(row["z [m]"]) == pytest.approx(z, rel=1e-3)
        area = m / (z * 500e3 / 1.15) * 1e6
        assert float(row["As [mm²/m]"].split()[0]) == pytest.approx(max(area, least[row["Layer"]]), rel=1e-3)


def test_a_section_that_cannot_resist_is_not_left_out() -> None:
    results = signorini.solve(floor(load=[{"case": case, "pressure": 150} for case in ("G", "Q1", "Q2", "W")]))
    of = Contents(results, None, results_json(results, None), Writer("en", results.model.units), "")
    rows = tables(design.reinforcement(of))["Largest required areas over all combinations"]
    assert any(row["As [mm²/m]"] == "∞" and "cannot resist" in row["Decided by"] for row in rows)


def test_fields_of_bars_are_enveloped_and_are_the_first_maps(of: Contents) -> None:
    bars = [f"as_{axis}_{face}" for face in ("bottom", "top") for axis in "xy"]
    names = [one["name"] for one in map_data(of.results).header["fields"]]
    assert names[:8] == bars + [name.replace("as_", "m") for name in bars] and names[-1] == "von_mises"
    assert {*names[:8]} <= {*of.results.envelope.layout.fields}
    assert not {*bars} & {*signorini.solve(floor(output={"envelope": ["mx"]})).envelope.layout.fields}


def test_the_page_has_the_warnings_of_results_json_and_of_the_terminal(of: Contents) -> None:
    warned = of.values["warnings"]
    assert any("β = 1" in one["text"] for one in warned)
    assert all(one["text"] in texts(numbers.warnings(of)) for one in warned)


def test_limits_of_the_report_are_stated(of: Contents) -> None:
    found = tables(design.not_checked(of))["What this report does not check"]
    assert {"one-way shear of the slab", "crack width", "fire resistance"} <= {row["Check"] for row in found}
    assert all(row["Clause"] for row in found)
    assert "uncracked" in texts(design.uncracked(of)) and "above fctm = 2.9 MPa" in texts(design.uncracked(of))
    text = page.page(of.results, of.estimates, "")
    assert "B-017" in text and "C. Jones" in text and "docs/" not in text.split('id="signorini-results"')[0]
