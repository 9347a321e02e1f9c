"""results.xlsx: the numbers of results.json with units, as values that no program computes."""

import itertools
import re
import sys
import time
import zipfile
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from models import tables
from test_verification import CHECKED, everything
from typer.testing import CliRunner

import signorini
from signorini import Model, SignoriniError, solve, verify, write
from signorini.cli.commands import app
from signorini.formats.xlsx import Sheet, write_xlsx
from signorini.output import results_json
from signorini.output.spreadsheet import sheets_of

SPACE = {"m": "http://schemas.openxmlformats.org/spreadsheetml/2006/main"}
EVIL = ["=1+1", "+2", "-3", "@SUM(A1)", "http://example.org", "{=A1}", "\u00e9<b>&\"'"]


def read(file: Path) -> dict[str, list[dict[str, Any]]]:
    """Rows of every sheet by the titles of their columns; numbers as floats."""
    with zipfile.ZipFile(file) as book:
        sheets = ElementTree.fromstring(book.read("xl/workbook.xml")).iterfind("m:sheets/m:sheet", SPACE)
        result = {}
        for number, sheet in enumerate(sheets, start=1):
            tree = ElementTree.fromstring(book.read(f"xl/worksheets/sheet{number}.xml"))
            rows = [dict(map(cell, row)) for row in tree.iterfind("m:sheetData/m:row", SPACE)]
            result[sheet.get("name", "")] = [{title: row.get(at) for at, title in rows[0].items()} for row in rows[1:]]
    return result


def cell(of: ElementTree.Element) -> tuple[str, str | float]:
    at, value = re.sub(r"\d", "", of.get("r", "")), of.find("m:v", SPACE)
    if of.get("t") == "inlineStr":
        return at, "".join(of.itertext())
    assert value is not None and of.get("t") in (None, "n", "b")
    return at, float(value.text or "")


def near(value: float | None) -> Any:
    """A number to the 16 digits of a cell; None is an empty cell."""
    return None if value is None else pytest.approx(value, rel=1e-15)


@pytest.fixture(scope="module")
def model() -> Model:
    return everything(units={"length": "m", "force": "N"}, output={"combinations": "table", "fields": "all"})


@pytest.fixture(scope="module")
def written(model: Model, tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, Any], Path]:
    place, results = tmp_path_factory.mktemp("written"), solve(model)
    assert place / "results.xlsx" in write(results, place, pictures="none", xlsx=True)
    return results_json(results, signorini.estimate(results), "none", True), place / "results.xlsx"


def test_the_sheets_have_the_numbers_of_results_json_with_units(written: tuple[dict[str, Any], Path]) -> None:
    values, file = written
    sheets = read(file)
    names = {"Summary", "Combinations", "Reactions", "Supports", "Lines", "Probes", "Sections", "Strips", "Profiles"}
    assert sheets.keys() == names | {"Governing", "Envelope"}
    for combination, row in zip(values["combinations"], sheets["Probes"], strict=True):
        (probe,), (widths,) = combination["probes"], combination["plus_minus"]["probes"]
        assert (row["combination"], row["x [m]"], row["y [m]"]) == (combination["name"], *probe["at"])
        assert row["moment mxy [N m/m]"] == near(probe["moment"][2])
        assert row["± moment mxy [N m/m]"] == near(widths["moment"][2])
    totals = {(row["combination"], row["name"]): row for row in sheets["Supports"]}
    points = {(row["combination"], row["name"], row["number"]): row for row in sheets["Reactions"]}
    for combination in values["combinations"]:
        for support in combination["supports"]:
            row = totals[combination["name"], support["name"]]
            assert row["reaction [N], total, positive up"] == near(support["reaction"])
            assert row["max pressure [N/m²], positive up"] == near(support["max_pressure"])
            for number, point in enumerate(support.get("points", ()), start=1):
                row = points[combination["name"], support["name"], number]
                assert row["gap [m], remaining free travel"] == near(point["gap"])
                assert row["state"] == point["state"]
    stations = [one for combination in values["combinations"] for one in combination["strips"][0]["stations"]]
    assert [row["width [m]"] for row in sheets["Strips"]] == [one["width"] for one in stations]
    (row,) = [row for row in sheets["Envelope"] if row["quantity"] == "sections, cut, moment" and not row["group"]]
    extreme = values["envelope"]["sections"][0]["moment"]
    assert (row["max by"], row["min by"], row["unit"]) == (extreme["max_by"], extreme["min_by"], "N m")
    assert row["max"] == near(extreme["max"]) and row["± max"] is not None
    assert {row["group"] for row in sheets["Governing"]} == {None, "g0", "g1"}


def test_the_summary_and_the_combinations_say_where_the_numbers_come_from(
    model: Model, written: tuple[dict[str, Any], Path]
) -> None:
    values, file = written
    sheets = read(file)
    summary = {row["what"]: row["value"] for row in sheets["Summary"]}
    assert summary["SHA-256 of the model"] == values["input"]["model_sha256"] and summary["unit of force"] == "N"
    assert summary["version"] == signorini.__version__ and summary["c2"] == "certificate passed"
    for row, one in zip(sheets["Combinations"], model.effective_combinations, strict=True):
        assert (row["combination"], row["group"]) == (one.name, one.group)
        assert [row[f"factor of {case}"] for case in "GQ"] == [one.factors.get(case) for case in "GQ"]
        supports = next(of["supports"] for of in values["combinations"] if of["name"] == one.name)
        (reaction,) = (row[title] for title in row if title.startswith("soil: reaction [N]"))
        assert reaction == pytest.approx(supports[1]["reaction"], rel=1e-9)


def test_checks_and_punching_have_sheets_with_units() -> None:
    results = solve(everything(**CHECKED))
    values = results_json(results)
    sheets = {
        sheet.name: [dict(zip(sheet.columns, row, strict=False)) for row in sheet.rows]
        for sheet in sheets_of(values, results)
    }
    for row, check in zip(sheets["Checks"], values["checks"], strict=False):
        (value,) = (cell for title, cell in row.items() if title.startswith("value") and "[N/m²]" in title)
        assert (row["name"], row["limit"], row["combination"], value) == (
            check["name"],
            check["limit"],
            None,
            check["value"],
        )
    assert len(sheets["Checks"]) == 2 * (1 + len(results)) and len(sheets["Punching"]) == 2 * len(results)
    first = values["combinations"][0]["punching"][0]
    assert sheets["Punching"][0]["vEd [N/m²], shear stress at u1"] == first["v_ed"]


def test_no_cell_is_computed_and_every_name_is_text(tmp_path: Path) -> None:
    supports = [{"name": name, "at": [1 + i % 3, 1 + i // 3], "resists": "down"} for i, name in enumerate(EVIL)]
    combination = [{"name": name, "factors": {"G": 1}} for name in EVIL]
    load = [{"case": "G", "pressure": 1e3}]
    write(
        solve(Model(**tables(title="=2+2", support=supports, load=load, combination=combination))),
        tmp_path,
        pictures="none",
        xlsx=True,
    )
    with zipfile.ZipFile(tmp_path / "results.xlsx") as book:
        sheets = [book.read(name).decode() for name in book.namelist() if "worksheets/sheet" in name]
        assert not any("hyperlink" in name.lower() or ".rels" in name for name in book.namelist() if "sheets/_" in name)
    assert not any(re.search(r"<(f|hyperlink)[ >/]", sheet) for sheet in sheets)
    assert all("<autoFilter " in sheet and 'state="frozen"' in sheet for sheet in sheets)
    found = read(tmp_path / "results.xlsx")
    assert [row["combination"] for row in found["Combinations"]] == EVIL
    assert {row["name"] for row in found["Supports"]} == set(EVIL)
    assert found["Summary"][0]["value"] == "=2+2"


def test_the_command_writes_a_spreadsheet_that_is_replaced_and_verified(model: Model, tmp_path: Path) -> None:
    (tmp_path / "slab.toml").write_text(model.to_toml(), "utf-8")
    content = []
    for options in (["--xlsx"], ["--xlsx"], []):
        done = CliRunner().invoke(
            app, ["solve", str(tmp_path / "slab.toml"), "-o", str(tmp_path / "out"), "--pictures", "none", *options]
        )
        assert done.exit_code == 0, done.output
        assert (tmp_path / "out" / "results.xlsx").exists() == bool(options)
        content += [(tmp_path / "out" / "results.xlsx").read_bytes()] if options else []
        assert verify(tmp_path / "out" / "results.json").equal
    assert content[0] == content[1]


def test_without_the_package_a_message_names_the_command_that_installs_it(
    model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "xlsxwriter", None)
    (tmp_path / "slab.toml").write_text(model.to_toml(), "utf-8")
    done = CliRunner().invoke(app, ["solve", str(tmp_path / "slab.toml"), "--xlsx"])
    assert done.exit_code == 1 and "pip install xlsxwriter" in done.output
    assert [one.name for one in tmp_path.iterdir()] == ["slab.toml"]
    with pytest.raises(SignoriniError, match="pip install"):
        write(solve(model), tmp_path / "out", pictures="none", xlsx=True)


def test_a_table_of_ten_thousand_rows_is_written_in_seconds(tmp_path: Path) -> None:
    rows = {f"c{n}": [1.35, 1e-4 * n] for n in range(10_000)}
    combination = [{"generate": "table", "columns": ["G", "Q"], "rows": rows}]
    load = [{"case": case, "pressure": 1e3} for case in "GQ"]
    feet = [{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}]
    mesh = {"divisions": [2, 2], "error": False}
    results = solve(Model(**tables(support=feet, load=load, combination=combination) | {"mesh": mesh}))
    values = results_json(results)
    begun = time.process_time()
    write_xlsx(tmp_path / "results.xlsx", sheets_of(values, results), {})
    assert time.process_time() - begun < 10
    assert len(read(tmp_path / "results.xlsx")["Combinations"]) == 10_000


def test_more_rows_than_a_sheet_holds_are_refused(tmp_path: Path) -> None:
    with pytest.raises(signorini.InputError, match="1048575"):
        write_xlsx(tmp_path / "a.xlsx", [Sheet("a", ["x"], itertools.repeat((None,), 1_048_576))], {})
