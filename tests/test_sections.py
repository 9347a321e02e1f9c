"""Sections and strips as they are asked for, and written: tables, envelopes, paths, half-widths, errors."""

import io
import json
import re

import numpy as np
import pytest
from models import rectangular, tables
from rich.console import Console

from signorini import InputError, Model, estimate, path, solve
from signorini.analysis.check import check
from signorini.cli.tables import print_results
from signorini.output.envelope_json import envelope_json
from signorini.output.load_path import path_csv, path_json
from signorini.output.tables import results_json
from signorini.plot.pictures import check_picture
from signorini.plot.plan import Plan
from signorini.results.marks import cut_marks

SECTIONS = [{"name": "A", "line": [[2, 0], [2, 4]]}, {"line": [[0.7, 0.4], [3.1, 2.9]]}]
STRIPS = [{"name": "middle", "line": [[0, 2], [4, 2]], "width": 1.5, "stations": 5}]
ASKED = {
    "support": [
        {"name": "walls", "edge": ["left", "right"], "resists": "down"},
        {"name": "soil", "area": {"rectangle": [1, 1, 3, 3.2]}, "resists": "down", "stiffness": 2e6},
        {"name": "column", "at": [3, 1], "patch": [0.4, 0.3], "resists": "down"},
    ],
    "load": [
        {"case": "G", "pressure": 5e3},
        {"case": "Q", "force": 4e4, "at": [1.4, 2.2], "patch": [0.5, 0.5]},
        {"case": "T", "curvature": [1e-4, 0, 0]},
    ],
    "section": SECTIONS,
    "strip": STRIPS,
}


def numbers(result):
    stations = [station for strip in result.strips for station in strip.stations]
    return np.array([[one.moment, one.twist, one.shear] for one in (*result.sections, *stations)])


def several(count, soil, **more):
    combinations = [{"name": f"{i}", "factors": {"G": 1, "Q": 0.1 * i, "T": 0.2}} for i in range(count)]
    supports = [one for one in ASKED["support"] if soil or one["name"] != "soil"]
    return rectangular(**ASKED | {"support": supports}, combination=combinations, **more)


@pytest.mark.parametrize("off", [-1e-9, 1e-9, 3e-6])
def test_a_line_that_all_but_ends_on_an_edge_ends_there_from_either_side(off):
    def cut(y):
        model = rectangular(
            support=[{"edge": "left", "fix": "clamped"}],
            load=[{"pressure": 1e3}],
            mesh={"divisions": [5, 5], "error": False},
            section=[{"line": [[1.3, y], [1.3, 4 + y]]}],
        )
        return solve(model)["all"].sections[0]

    there, beside = cut(0.0), cut(off)
    assert (beside.moment, beside.shear) == pytest.approx((there.moment, there.shear), rel=1e-9)


@pytest.mark.parametrize("soil", [False, True])
def test_a_table_and_its_envelope_have_what_each_combination_has_alone(soil):
    """By sums of responses, and side by side."""
    each = solve(several(4, soil, output={"combinations": "each"}, mesh={"divisions": [5, 5], "error": False}))
    table = solve(several(4, soil, output={"combinations": "table"}, mesh={"divisions": [5, 5], "error": False}))
    assert (table.combined.alone < 4) == (not soil)
    alone = np.array([numbers(each[key]) for key in each])
    size = np.abs(alone).max(axis=(0, 1))
    columns = table.table
    assert columns["section[A]:moment"] == pytest.approx(alone[:, 0, 0], abs=1e-9 * size[0])
    assert columns["section[section 2]:shear"] == pytest.approx(alone[:, 1, 2], abs=1e-9 * size[2])
    assert columns["strip[middle][3]:twist"] == pytest.approx(alone[:, 4, 1], abs=1e-9 * size[1])
    written = envelope_json(table, None)
    largest = written["sections"][0]["moment"]
    assert largest["max"] == pytest.approx(alone[:, 0, 0].max())
    assert largest["max_by"] == f"{alone[:, 0, 0].argmax()}"
    assert {f"{alone[:, 0, 0].argmax()}", f"{alone[:, 1, 2].argmin()}"} <= set(table.governing)
    assert written["strips"][0]["stations"][4]["shear"]["min"] == pytest.approx(
        alone[:, 6, 2].min(), abs=1e-9 * size[2]
    )


def test_results_have_every_number_with_its_half_width():
    results = solve(rectangular(**ASKED))
    (found,) = results_json(results, estimate(results))["combinations"]
    section, strip = found["sections"][0], found["strips"][0]
    assert list(section) == ["name", "length", "moment", "twist", "shear"]
    assert [len(strip["stations"]), strip["stations"][1]["at"]] == [5, [1.0, 2.0]]
    assert sorted(strip) == ["max_at", "max_moment", "min_at", "min_moment", "name", "stations"]
    assert list(strip["stations"][0]) == ["at", "width", "moment", "twist", "shear", "design_moment"]
    assert strip["max_moment"] == max(station["moment"] for station in strip["stations"])
    widths = found["plus_minus"]
    assert widths["sections"][0]["length"] == 0
    assert 0 <= widths["sections"][1]["moment"] < 0.1 * abs(found["sections"][1]["moment"])
    assert widths["strips"][0]["stations"][2]["moment"] >= 0
    assert widths["strips"][0]["max_at"] == [None, None]
    json.dumps(found, allow_nan=False)


def test_a_load_path_has_them_at_every_stop():
    model = rectangular(**ASKED)
    found = path(model, start="G", add="Q", until=2.0)
    written = path_json(found)
    t = written["stops"][1]["t"]
    there = numbers(found.at(t))
    stop = written["stops"][1]
    assert stop["sections"][0]["shear"] == pytest.approx(there[0, 2], abs=1e-9 * np.abs(there).max())
    assert stop["strips"][0]["stations"][2]["moment"] == pytest.approx(there[4, 0], abs=1e-9 * np.abs(there).max())
    assert "section[A]:moment" in path_csv(found).splitlines()[0]


def test_a_moving_wheel_passes_under_a_section():
    """The shear of a simple span falls by the wheel as it passes."""
    model = rectangular(
        size=(8, 2),
        divisions=(16, 4),
        support=[{"edge": ["left", "right"], "fix": "simple"}],
        load=[{"case": "G", "pressure": 1}],
        moving=[{"case": "wheel", "line": [[0.5, 1], [7.5, 1]], "step": 1.0, "axles": [[0, 1e4]], "patch": [0.3, 0.3]}],
        combination=[{"generate": "positions", "factors": {"wheel": 1.0}}],
        section=[{"line": [[4, 0], [4, 2]]}],
        mesh={"divisions": [16, 4], "error": False},
    )
    results = solve(model)
    places = np.arange(0.5, 8)
    assert results.table["section[section 1]:shear"] == pytest.approx(
        np.where(places < 4, -1e4 * places / 8, 1e4 * (8 - places) / 8)
    )
    assert results.table["section[section 1]:moment"] == pytest.approx(1e4 * np.minimum(places, 8 - places) / 2)


def test_the_terminal_has_a_row_for_each_with_its_half_widths():
    console = Console(file=io.StringIO(), width=200)
    units = {"length": "m", "force": "N"}
    tabled = several(3, False, units=units, output={"combinations": "table"})
    for results in map(solve, (rectangular(**ASKED, units=units), tabled)):
        print_results(console, results, estimate(results))
    shown = console.file.getvalue()
    number = r"-?[\d.]+(e[-+]\d+)?( ± [\d.e-]+)?"
    assert re.search(
        rf"section +moment \[N m\] +twist \[N m\] +shear \[N\]\n─+\nA +{number} +{number} +{number}\n", shown
    )
    assert re.search(rf"strip +largest mean moment \[N m/m\] .*\n─+\nmiddle +{number} +\[", shown)
    assert re.search(rf"A, moment \[N m\] +{number} +\d +{number} +\d\n", shown)


def test_asking_for_strips_changes_nothing_else():
    bare = {key: value for key, value in ASKED.items() if key not in ("section", "strip")}
    with_strips, without = (solve(rectangular(**asked))["all"] for asked in (bare | {"strip": STRIPS}, bare))
    assert np.array_equal(with_strips.deflection, without.deflection)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"section": [{"line": [[0, 0], [5, 4]]}]}, r"section\[1\]\.line: The line ends at \[5, 4\], off the plate"),
        ({"section": [{"line": [[1, 1], [1, 1]]}]}, r"section\[1\]\.line.*points 1 and 2 are the same"),
        ({"section": [{"line": [[1, 1]]}]}, r"section\[1\]\.line.*at least 2 points"),
        ({"section": [{"name": "A"}]}, r"section\[1\]\.line.*missing"),
        ({"section": SECTIONS[:1] * 2}, r'section\[2\]\.name.*the name "A" is taken by section\[1\]'),
        ({"section": [{"lines": [[1, 1], [2, 2]]}]}, "unknown key 'lines'. Did you mean 'line'"),
        ({"strip": [STRIPS[0] | {"width": 4.5}]}, r"strip\[1\]\.width.*The strip reaches beyond the plate at"),
        (
            {"strip": [{"line": [[1, 1], [3, 4]], "width": 1}]},
            r"strip\[1\]\.line.*station \[3, 4\], which is on an edge",
        ),
        ({"strip": [{"line": [[2, 1], [3.9, 3.8]], "width": 1}]}, r"strip\[1\]\.width.*Make it narrower, or"),
        ({"strip": [STRIPS[0] | {"width": 0}]}, r"strip\[1\]\.width"),
        ({"strip": [STRIPS[0] | {"stations": 1}]}, r"strip\[1\]\.stations"),
        ({"strip": STRIPS * 2}, r'strip\[2\]\.name.*the name "middle" is taken by strip\[1\]'),
    ],
)
def test_what_cannot_be_is_said_with_its_place(asked, message):
    with pytest.raises(InputError, match=message):
        solve(Model(**tables(**{**ASKED, "section": [], "strip": []} | asked)))


def test_the_check_picture_names_them(tmp_path):
    found = check(rectangular(**ASKED))
    marks = cut_marks(found.discretisation.model)
    assert [(mark.name, mark.borders is None) for mark in marks] == [
        ("A", True),
        ("section 2", True),
        ("middle", False),
    ]
    assert marks[2].borders[:, 0].tolist() == [[0.0, 2.75], [0.0, 1.25]]
    axes = check_picture(Plan(found.discretisation.mesh.points, found.discretisation.mesh.elements), cuts=marks).axes[0]
    assert {"A", "section 2", "middle"} <= {text.get_text() for text in axes.texts}


def section(*line, **more):
    return rectangular(**ASKED | {"section": [{"line": line}], "strip": []} | more)


@pytest.mark.parametrize("by", [2e-16, -1e-9, 4e-6])
def test_a_section_that_closes_but_for_rounding_is_closed(by):
    around = [[2.5, 0.5], [3.5, 0.5], [3.5, 1.5], [2.5, 1.5]]
    first, last = (
        solve(section(*around, end, mesh={"divisions": [5, 5], "error": False}))["all"].sections[0]
        for end in ([2.5, 0.5], [2.5 + by, 0.5 - by])
    )
    assert (last.moment, last.twist, last.shear) == (first.moment, first.twist, first.shear)


@pytest.mark.parametrize(
    ("line", "pieces"),
    [
        ([[3, 1.5], [1, 2], [1.6, 3], [1.3, 1.2]], "from [3, 1.5] to [1, 2] and from [1.6, 3] to [1.3, 1.2]"),
        ([[2, 0], [2, 4], [2, 0]], "from [2, 0] to [2, 4] and from [2, 4] to [2, 0]"),
        ([[2, 0], [2, 3], [2, 1], [3, 1]], "from [2, 0] to [2, 3] and from [2, 3] to [2, 1]"),
        ([[0, 2], [3, 2], [3, 3], [2, 3], [2, 2]], "from [0, 2] to [3, 2] and from [2, 3] to [2, 2]"),
    ],
    ids=["crosses", "there and back", "goes back", "ends in itself"],
)
def test_a_section_that_meets_itself_is_refused(line, pieces):
    message = f"the line turns back, or crosses or touches itself: see its segments {pieces}."
    with pytest.raises(InputError, match=re.escape(message)) as refused:
        section(*line)
    assert refused.value.place == "section[1].line"


def test_a_strip_that_goes_back_is_refused():
    with pytest.raises(InputError, match=re.escape("the line turns back at [2, 3]. Split the line")):
        rectangular(**ASKED | {"strip": [{"line": [[2, 1], [2, 3], [2, 2]], "width": 0.5}]})


@pytest.mark.parametrize("divisions", [3, 4, 5, 6])
def test_any_number_of_points_may_hold_slopes_beside_a_section(divisions):
    """The shear through a cut across the plate is the load beyond it; the line that holds slopes crosses elements."""
    given = rectangular(
        divisions=[divisions, 3],
        support=[{"line": [[0.1, 0.3], [1.4, 3.5]], "fix": ["w", "slope"]}],
        load=[{"pressure": 5e3}],
        section=[{"name": "A", "line": [[2, 0], [2, 4]]}],
    )
    forces = solve(given)["all"].sections["A"]
    assert abs(forces.shear) == pytest.approx(5e3 * 2 * 4, rel=1e-9)
