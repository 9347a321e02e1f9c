"""The report: its numbers are those of results.json, names are text, it needs no network, and it prints."""

import base64
import json
import re
import shutil
import subprocess
import zlib
from collections.abc import Mapping
from html import unescape
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_spreadsheet import read

import signorini
from signorini import InputError, Model
from signorini.analysis.estimate import estimates_of
from signorini.base.numbers import estimated
from signorini.cli.commands import app
from signorini.output.tables import results_json
from signorini.reports import numbers, page, sections
from signorini.reports.blocks import Table, Text, Writer
from signorini.reports.sections import Contents
from signorini.results import quantities

BAD = "<script>alert(1)</script>"
NAMED = "\"soil\" & 'sand' </script><img src=x onerror=alert(2)>"


def slab(**keys: Any) -> Model:
    tables: dict[str, Any] = {
        "title": BAD,
        "units": {"length": "m", "force": "kN"},
        "material": {"E": 30e6, "nu": 0.2, "unit_weight": 25},
        "plate": {"shape": "rectangle", "size": [6, 4], "thickness": 0.2},
        "mesh": {"divisions": [6, 4]},
        "support": [
            {"name": "wall", "edge": "left", "fix": "simple"},
            {"name": NAMED, "area": {"rectangle": [2, 0, 6, 4]}, "resists": "down", "stiffness": 2e4},
            {"name": "feet", "at": [[5, 1], [5, 3]], "resists": "down", "stiffness": 1e4},
        ],
        "load": [
            {"case": "G", "self_weight": True},
            {"case": "Q", "pressure": 5, "area": {"rectangle": [3, 0, 6, 4]}},
        ],
        "combination": [
            {"name": BAD, "group": "ULS", "factors": {"G": 1.35, "Q": 1.5}},
            {"name": "up", "group": "ULS", "factors": {"G": 1.0, "Q": -0.8}},
            {"name": "SLS", "group": "SLS", "factors": {"G": 1.0, "Q": 1.0}},
        ],
        "probe": [{"at": [3, 2]}],
        "section": [{"name": "cut", "line": [[3, 0], [3, 4]]}],
        "strip": [{"name": "middle", "line": [[0, 2], [6, 2]], "width": 2}],
        "profile": [{"name": "axis", "line": [[0, 2], [6, 2]]}],
        "report": {"project": "4711 </style>", "author": 'A. "Tony" M', "date": "2026-11-28", "revision": "B"},
    }
    return Model(**{**tables, **keys})


class Parsed(HTMLParser):
    """Sections, headings, tables and embedded results of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.sections: list[str] = []
        self.headings: list[int] = []
        self.values: set[float] = set()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.script, self.inside = "", False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        own = dict(attrs)
        self.tags.append((tag, own))
        self.inside = own.get("id") == "signorini-results"
        if tag == "section":
            self.sections.append(str(own["id"]))
        if re.fullmatch("h[1-6]", tag):
            self.headings.append(int(tag[1]))
        if (value := own.get("data-value")) is not None:
            self.values.add(float(value))

    def handle_data(self, data: str) -> None:
        self.script += data if self.inside else ""

    @property
    def results(self) -> Any:
        return json.loads(zlib.decompress(base64.b64decode(self.script)))


@pytest.fixture(scope="module")
def solved() -> tuple[signorini.Results, Any]:
    results = signorini.solve(slab())
    return results, estimates_of(results, lambda _: None)


@pytest.fixture(scope="module")
def text(solved: tuple[signorini.Results, Any]) -> str:
    return page.page(*solved, "title = '''</pre>" + BAD + "'''")


def contents(solved: tuple[signorini.Results, Any], **more: Any) -> Contents:
    results, estimates = solved
    values = results_json(results, estimates) | more
    return Contents(results, estimates, values, Writer("en", results.model.units), "")


def test_sections_are_in_the_order_of_a_calculation_report(text: str) -> None:
    found = Parsed(text).sections
    order = ["scope", "summary", "materials", "geometry", "loads", "combinations", "equilibrium", "reactions", "fields"]
    assert found == [*order, "cuts", "warnings", "input", "glossary", "verify"]


def test_results_json_is_embedded(text: str, solved: tuple[signorini.Results, Any]) -> None:
    assert Parsed(text).results == json.loads(json.dumps(results_json(*solved)))


def test_numbers_of_the_page_are_those_of_results_json(text: str) -> None:
    found = Parsed(text)
    numbers = list[float]()
    for one in found.results["combinations"]:
        for support in one["supports"]:
            numbers.append(support["reaction"])
            for point in support.get("points", ()):
                numbers += [point["reaction"], point["gap"]]
        numbers += [cut[key] for cut in one["sections"] for key in ("moment", "twist", "shear")]
        numbers += one["probes"][0]["moment"]
        numbers += [one["certificate"][key] for key in ("penetration", "equilibrium", "balance")]
    for strip in found.results["envelope"]["strips"] if "envelope" in found.results else ():
        numbers += [at["moment"][side] for at in strip["stations"] for side in ("max", "min")]
    for one in found.results["governing_reactions"]:
        numbers += [one["max"], one["min"], *one["max_with"], *one["min_with"]]
    assert {float(f"{number:.8g}") for number in numbers} <= found.values


def test_names_are_text_and_never_markup(text: str) -> None:
    assert "<script>alert" not in text and "<img src=x" not in text and "</style>" not in text.split("<title>")[0]
    tags = [tag for tag, _ in Parsed(text).tags]
    assert tags.count("script") == sum(tag == "script" for tag in re.findall(r"<(\w+)[\s>]", text))
    assert not any(name.startswith("on") for _, attributes in Parsed(text).tags for name in attributes)


def test_the_page_is_accessible(text: str) -> None:
    found = Parsed(text)
    assert found.headings[0] == 1 and found.headings.count(1) == 1
    assert all(later - earlier <= 1 for earlier, later in zip(found.headings, found.headings[1:], strict=False))
    assert all(own.get("alt") for tag, own in found.tags if tag == "img")
    assert all(own.get("scope") in ("col", "row") for tag, own in found.tags if tag == "th")
    ids = [own["id"] for _, own in found.tags if "id" in own]
    assert len(ids) == len(set(ids))
    links = {str(own["href"])[1:] for tag, own in found.tags if tag == "a"}
    assert links <= set(ids)
    assert {"header", "nav", "main", "footer"} <= {tag for tag, _ in found.tags}
    assert dict(found.tags[0][1])["lang"] == "en"


def contrast(one: str, other: str) -> float:
    def luminance(colour: str) -> float:
        parts = (int(colour[at : at + 2], 16) / 255 for at in (1, 3, 5))
        red, green, blue = (part / 12.92 if part <= 0.04045 else ((part + 0.055) / 1.055) ** 2.4 for part in parts)
        return 0.2126 * red + 0.7152 * green + 0.0722 * blue

    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_colours_of_texts_have_contrast(text: str) -> None:
    colours = dict(re.findall(r"--(\w+): (#\w{6})", text.split("</style>")[0]))
    for name in ("ink", "faint", "accent"):
        assert min(contrast(colours[name], "#ffffff"), contrast(colours[name], colours["wash"])) >= 4.5, name


def test_german(solved: tuple[signorini.Results, Any]) -> None:
    model = solved[0].model.varied(report=signorini.Report(language="de"))
    german = signorini.solve(model)
    text = page.page(german, None, "")
    assert "Auflagerkräfte" in text and "Bemessungsmoment in x unten" in text
    assert "Reactions" not in text and "Governing combination" not in text


def test_messages_of_the_program_are_marked_as_english_in_a_german_report() -> None:
    feet = [{"name": "feet", "at": [[1, 1], [5, 1], [3, 3]], "resists": "down"}]
    rows = [{"name": name, "factors": {"G": factor}} for name, factor in (("down", 1), ("lift", -1))]
    results = signorini.solve(slab(support=feet, combination=rows, report={"language": "de"}))
    text = unescape(page.page(results, None, ""))
    said = next(iter(results.unbalanced.values()))
    (shown,) = (line for line in text.splitlines() if said in line and line.startswith("<p"))
    assert 'lang="en"' in shown and "auf Englisch" in text
    assert all('lang="en"' in line for line in text.splitlines() if line.startswith('<p class="warning"'))


def test_every_text_is_in_both_languages() -> None:
    from signorini.reports.blocks import _catalogue

    assert all(set(one) == {"en", "de"} for one in _catalogue()["texts"].values())
    owners = [
        of.values() if isinstance(of, Mapping) else of
        for of in vars(quantities).values()
        if isinstance(of, tuple | Mapping)
    ]
    words = {
        one.words or one.name.replace("_", " ") for of in owners for one in of if isinstance(one, quantities.Quantity)
    }
    assert len(words) > 50 and words <= set(_catalogue()["de"])


def test_summary_shows_each_check_with_half_width(solved: tuple[signorini.Results, Any]) -> None:
    own = {
        "name": "soil",
        "of": "deflection",
        "value": 90.0,
        "limit": 100.0,
        "utilisation": 0.9,
        "governing": "SLS",
        "place": [1.0, 2.0],
    }
    checks = [own | {"plus_minus": 0.02, "verdict": "passed", "passed": True}]
    checks.append(own | {"name": "tight", "plus_minus": 0.2, "verdict": "undecided: 1 is within ±", "passed": None})
    over = {"value": 120.0, "utilisation": 1.2, "plus_minus": 0.1, "verdict": "failed", "passed": False}
    checks.append(own | over | {"name": "over"})
    blocks = list(numbers.summary(contents(solved, checks=checks)))
    assert blocks[0] == Text("1 of 3 checks passed, 1 failed (over), 1 undecided.", "bad")
    (table, *_) = [one for one in blocks if isinstance(one, Table)]
    said = [[cell.text for cell in row] for row in table.rows]
    assert [(row[0], row[-1]) for row in said] == [
        ("over", "failed"),
        ("soil", "passed"),
        ("tight", "undecided within the mesh error"),
    ]
    assert said[1][1:7] == ["90.00 ± 2.0", "100", "m", "0.9000 ± 0.020", "C3: SLS", "[1, 2]"]


def test_a_punching_sheet_has_all_numbers_of_the_governing_row_of_a_table() -> None:
    code = {"code": "EN 1992-1-1:2004", "d": [0.16, 0.15], "rho": [0.005, 0.005], "fck": 3e4, "fyk": 5e5}
    table = {"support": "feet", "column": [0.3, 0.3], **code}
    plate = {"shape": "rectangle", "size": [8, 8], "thickness": 0.2, "holes": [{"rectangle": [4.4, 1.6, 4.7, 2.4]}]}
    stiff = [{"name": "wall", "edge": "left", "fix": "simple"}, {"name": "feet", "at": [[5, 2], [5, 6]]}]
    load = [{"case": "G", "pressure": 11}, {"case": "Q", "pressure": 5, "area": {"rectangle": [3, 0, 6, 4]}}]
    output = {"combinations": "table", "fields": "none"}
    model = slab(punching=[table], plate=plate, support=stiff, load=load, output=output, mesh={"size": 0.5})
    of = contents((signorini.solve(model), None))
    blocks = list(numbers.punching(of))
    headings = [one.words for one in blocks if isinstance(one, Text) and one.kind == "heading"]
    assert headings == [f"feet[{n}], [5, {y}], Combination C1: {BAD}" for n, y in ((1, 2), (2, 6))]
    for sheet, one in zip([one for one in blocks if isinstance(one, Table)], of.punched, strict=True):
        found = {row[0].text: row[2].value for row in sheet.rows}
        of_envelope = of.values["envelope"]["punching"][("feet[1]", "feet[2]").index(one.of.name)]
        assert found["utilisation"] == pytest.approx(of_envelope["utilisation"]["max"], rel=1e-9)
        net, d = found["V"] - found["ΔV"], found["d"]
        eccentric = sum(found[f"k{n}"] * found[f"e{n}"] / found[f"W1,{n}"] for n in "12")
        inward = found["u1"] / found["u1*"] if "u1*" in found else 0.0
        assert found["β"] == pytest.approx(max(1 + eccentric * found["u1"], inward), rel=1e-6)
        assert found["vEd"] == pytest.approx(found["β"] * net / (found["u1"] * d), rel=1e-9)
        assert found["vRd,c"] == pytest.approx(max(120 * found["k"] * 15 ** (1 / 3), found["vmin"]), rel=1e-9)
        assert found["vRd,max"] == pytest.approx(0.4 * found["ν"] * 3e4 / 1.5, rel=1e-9)
        links = (found["vEd"] - 0.75 * found["vRd,c"]) * found["u1"] / (1.5 * found["fywd,ef"])
        assert found["Asw/s"] == pytest.approx(links, rel=1e-9)
        for kind in ("u1", "uout"):
            drawn = sum(np.hypot(*np.diff(line, axis=0).T).sum() for line in one.lines[kind])
            assert drawn == pytest.approx(found[kind], rel=2e-3)
    assert [len(one.lines["dead"]) for one in of.punched] == [2, 0]
    assert "<svg" in page.page(of.results, None, "")


def test_a_punching_sheet_by_aci_gives_the_stress_from_its_numbers() -> None:
    table = {"support": "feet", "column": [0.3, 0.4], "code": "ACI 318-19", "d": [0.16, 0.15], "fck": 3e4, "fyk": 4.2e5}
    model = slab(punching=[table], mesh={"size": 0.5})
    for block in numbers.punching(contents((signorini.solve(model), None))):
        if isinstance(block, Table):
            found = {row[0].text: row[2].value for row in block.rows}
            parts = [found[f"γv,{n}"] * found[f"M,{n}"] * found[f"c,{n}"] / found[f"Jc,{n}"] for n in "12"]
            mean = (found["V"] - found["ΔV"]) / (found["bo"] * found["d"])
            assert found["vu"] == pytest.approx(mean + sum(parts), rel=1e-6)


def test_many_combinations_are_folded_and_counted() -> None:
    rows = [{"name": f"c{at}", "factors": {"G": 1 + at / 100, "Q": at / 10}} for at in range(60)]
    results = signorini.solve(slab(combination=rows))
    text = page.page(results, None, "")
    assert "(60 rows)" in text and "C60: c59" in text
    assert "60 of 60 combinations" in text


def test_a_page_of_table_rows_solves_none_again_and_has_two_megabytes(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = {f"c{at}": [1 + at / 100, at / 300] for at in range(300)}
    table = {"generate": "table", "columns": ["G", "Q"], "rows": rows}
    probes = [{"at": [[1 + at / 10, 2] for at in range(40)]}]
    results = signorini.solve(slab(combination=[table], probe=probes, mesh={"divisions": [60, 40], "error": False}))
    monkeypatch.setattr("signorini.analysis.results.solve_one", None)
    assert len(results) == 300 and "c299" in results and "c300" not in results
    assert len(page.page(results, None, "").encode()) < 2_000_000


def test_a_combination_without_equilibrium_is_named() -> None:
    feet = [{"name": "feet", "at": [[1, 1], [5, 1], [3, 3]], "resists": "down"}]
    rows = [{"name": "down", "factors": {"G": 1}}, {"name": "lift", "factors": {"G": -1}}]
    results = signorini.solve(slab(support=feet, combination=rows))
    text = page.page(results, None, "")
    assert "1 of 2 combinations" in text and "lift: " in text


def test_a_load_path_is_shown(solved: tuple[signorini.Results, Any], tmp_path: Path) -> None:
    path = signorini.path(slab(), "G", "Q", 2.0, steps=4)
    (file,) = signorini.report(solved[0], tmp_path / "slab.html", solved[1], load_path=path)
    assert "load_path" in Parsed(file.read_text("utf-8")).sections


def test_logo(tmp_path: Path, solved: tuple[signorini.Results, Any]) -> None:
    (tmp_path / "logo.svg").write_text("<svg xmlns='http://www.w3.org/2000/svg' width='9' height='9'/>")
    assert page._logo(str(tmp_path / "logo.svg")).startswith("data:image/svg+xml;base64,")
    for name in ("absent.svg", "logo.gif"):
        with pytest.raises(InputError) as refused:
            page._logo(str(tmp_path / name))
        assert name in str(refused.value)


def test_without_a_browser_the_message_says_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, solved: tuple[signorini.Results, Any]
) -> None:
    monkeypatch.setattr(page.shutil, "which", lambda name: None)
    with pytest.raises(InputError, match="chromium"):
        signorini.report(solved[0], tmp_path / "slab.html", solved[1], pdf=True)
    assert not list(tmp_path.iterdir())


def test_the_command_writes_the_file_with_the_input(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    file = tmp_path / "slab.toml"
    file.write_text("# a remark\n" + slab(mesh={"divisions": [6, 4], "error": False}).to_toml(), "utf-8")
    ended = CliRunner().invoke(app, ["report", str(file)])
    assert ended.exit_code == 0, ended.output
    written = (tmp_path / "slab.html").read_text("utf-8")
    assert "# a remark" in written
    assert Parsed(written).results["input"]["file"] == "slab.toml"


@pytest.mark.parametrize("taken", ["slab.html", "slab.xlsx"])
def test_a_report_that_cannot_be_written_is_refused_before_the_plate_is_solved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, taken: str
) -> None:
    from typer.testing import CliRunner

    monkeypatch.setattr("signorini.analysis.solve.solve_all", None)
    file = tmp_path / "slab.toml"
    file.write_text(slab().to_toml(), "utf-8")
    (tmp_path / taken).mkdir()
    ended = CliRunner().invoke(app, ["report", str(file), "--xlsx"])
    assert ended.exit_code == 2
    assert f"{taken} cannot be written: the path exists and is not a regular file" in ended.stderr
    assert {path.name for path in tmp_path.iterdir()} == {"slab.toml", taken}


def test_the_command_prints_checks_failed_ones_first_and_writes_a_spreadsheet(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    checks = [{"name": name, "of": "deflection", "limit": limit} for name, limit in (("wide", 9.0), ("tight", 1e-9))]
    rows = [{"name": "down", "factors": {"G": 1}}, {"name": "up", "factors": {"G": -1}}]
    file = tmp_path / "slab.toml"
    file.write_text(slab(check=checks, combination=rows, mesh={"divisions": [6, 4]}).to_toml(), "utf-8")
    ended = CliRunner().invoke(app, ["report", str(file), "--xlsx", "--no-error"])
    assert ended.exit_code == 3, ended.output
    said = ended.stdout
    assert said.index("tight") < said.index("wide") and "Failed checks: tight." in said
    values = Parsed((tmp_path / "slab.html").read_text("utf-8")).results["checks"]
    assert {one["name"] for one in read(tmp_path / "slab.xlsx")["Checks"]} == {one["name"] for one in values}


class Opened:
    """A page in a browser, with what went wrong on it."""

    def __init__(self, browser: Any, file: Path, width: int = 1400) -> None:
        self.errors: list[str] = []
        self.requests: list[str] = []
        self.page = browser.new_page(viewport={"width": width, "height": 900})
        self.page.on("console", lambda one: None if "GL Driver" in one.text else self.errors.append(one.text))
        self.page.on("pageerror", lambda one: self.errors.append(str(one)))
        self.page.on("dialog", lambda one: self.errors.append(one.message))
        self.page.on("request", lambda one: self.requests.append(one.url))
        self.page.goto(file.as_uri() + "#print")
        self.page.wait_for_selector("html[data-pictures]", state="attached", timeout=120_000)


@pytest.fixture(scope="module")
def file(text: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "slab.html"
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize("width", [1400, 390])
def test_no_error_no_request_and_no_sideways_scrolling(browser: Any, file: Path, width: int) -> None:
    shown = Opened(browser, file, width)
    assert shown.errors == []
    assert [url for url in shown.requests if not url.startswith(("data:", "file:"))] == []
    assert shown.page.evaluate("document.documentElement.scrollWidth") <= width


def test_tables_sort_and_filter_by_mouse_and_keyboard(browser: Any, file: Path) -> None:
    page = Opened(browser, file).page
    table = page.locator("#reactions table").first
    header = table.locator("thead th").nth(3)
    column = "t => [...t.tBodies[0].rows].map(r => Number(r.cells[3].dataset.value))"
    header.locator("button").click()
    assert header.get_attribute("aria-sort") == "ascending"
    up = table.evaluate(column)
    assert up == sorted(up)
    header.locator("button").press("Enter")
    assert table.evaluate(column) == sorted(up, reverse=True)
    filtered = table.locator("input")
    filtered.focus()
    page.keyboard.type("feet SLS")
    shown = "t => [...t.tBodies[0].rows].filter(r => !r.hidden).map(r => r.cells[1].textContent)"
    assert table.evaluate(shown) == ["feet"]


def test_a_diagram_shows_values_with_half_widths_by_pointer_and_keyboard(browser: Any, file: Path, text: str) -> None:
    shown = Opened(browser, file)
    stages, values = shown.page.locator(".diagram .stage"), Parsed(text).results["combinations"]
    assert stages.evaluate_all("all => all.map(one => one.getAttribute('aria-label'))") == [
        *("Section cut", "Strip middle [m]", "Profile axis [m]", "Support wall [m]")
    ]
    strip, at = stages.nth(1), values[0]["strips"][0]["stations"][10]
    box = strip.locator("svg").bounding_box()
    strip.hover(position={"x": box["width"] * (82 + 0.5 * (720 - 94)) / 720, "y": 40})
    said, width = strip.get_attribute("aria-valuetext"), values[0]["plus_minus"]["strips"][0]["stations"][10]["moment"]
    assert said.startswith("3 m: Moment") and f"{BAD} {estimated(at['moment'], width)}" in said
    strip.focus()
    shown.page.keyboard.press("ArrowRight")
    shown.page.keyboard.press("ArrowDown")
    shown.page.keyboard.press("ArrowDown")
    shown.page.keyboard.press("ArrowLeft")
    assert strip.get_attribute("aria-valuetext").startswith("3 m: Shear")
    assert strip.locator(".tip").is_visible() and shown.errors == []


def test_paper_has_every_folded_table_and_a_picture_of_every_field(browser: Any, file: Path) -> None:
    shown = Opened(browser, file)
    page = shown.page
    assert page.locator("details:not([open])").count() > 0
    page.evaluate("window.dispatchEvent(new Event('beforeprint'))")
    assert page.locator("details:not([open])").count() == 0
    page.emulate_media(media="print")
    titles = page.locator(".prints .title b").all_text_contents()
    fields = page.evaluate("document.querySelector('.signorini-map').signoriniMap.data.fields.map(f => f.words)")
    assert all(any(title.startswith(words) for title in titles) for words in fields)
    assert page.locator(".prints img").first.is_visible()
    page.evaluate("window.dispatchEvent(new Event('afterprint'))")
    assert page.locator("details:not([open])").count() > 0
    assert shown.errors == []


@pytest.mark.usefixtures("chromium")
def test_pdf_has_the_title_block_on_every_page(tmp_path: Path, solved: tuple[signorini.Results, Any]) -> None:
    html, pdf = signorini.report(solved[0], tmp_path / "slab.html", solved[1], pdf=True)
    assert html.suffix == ".html" and pdf.read_bytes().startswith(b"%PDF")
    if shutil.which("pdftotext") is None:
        pytest.skip("no pdftotext is installed")
    said = subprocess.run(["pdftotext", "-layout", str(pdf), "-"], capture_output=True, text=True, check=True).stdout
    pages = said.rstrip("\f\n").split("\f")
    assert len(pages) > 3 and all('A. "Tony" M' in one for one in pages)
    assert all(f"{number} / {len(pages)}" in one for number, one in enumerate(pages, 1))


def test_codes_are_named() -> None:
    tables = {"combination": [{"generate": "en1990"}], "punching": [{"code": "ACI 318-19"}]}
    assert sections.codes_of(tables) == ["EN 1990", "ACI 318-19"]


def test_the_command_adds_a_load_path(tmp_path: Path) -> None:
    from typer.testing import CliRunner

    (tmp_path / "slab.toml").write_text(slab().to_toml(), "utf-8")
    start, add = slab().load_cases[:2]
    options = ["report", str(tmp_path / "slab.toml"), "--from", start, "--until", "0.5", "--no-error"]
    assert CliRunner().invoke(app, options).exit_code == 2
    done = CliRunner().invoke(app, [*options, "--add", add])
    assert done.exit_code == 0, done.output
    assert 'id="load_path"' in (tmp_path / "slab.html").read_text("utf-8")


def test_extremes_are_those_of_each_group(solved: tuple[signorini.Results, Any]) -> None:
    of = contents(solved)
    for blocks, key in ((numbers.extreme_results(of), "Extreme results"), (numbers.fields(of), "Extremes of fields")):
        tables = {one.caption: one for one in blocks if isinstance(one, Table) and one.caption.startswith(key)}
        assert list(tables) == [f"{key}: ULS", f"{key}: SLS"]
        for group, table in zip(("ULS", "SLS"), tables.values(), strict=True):
            shown = {row[0].text: row[1].value for row in table.rows}
            named = [one for one in of.results.values() if one.combination and one.combination.group == group]
            most = max(one.extremes["deflection"].max for one in named)
            assert shown["Deflection [m], largest"] == most


def test_extremes_of_combinations_without_a_group_are_among_those_of_all() -> None:
    rows = [{"name": "ULS", "group": "ULS", "factors": {"G": 1.35}}, {"name": "rest", "factors": {"G": 2.0}}]
    for output in ({"combinations": "table", "fields": "none"}, {"combinations": "each"}):
        of = contents((signorini.solve(slab(combination=rows, output=output)), None))
        whole, group = numbers.extreme_results(of)
        assert isinstance(whole, Table) and isinstance(group, Table)
        assert (whole.caption, group.caption) == ("Extreme results", "Extreme results: ULS")
        values = [[row[1].value for row in table.rows if "pressure" in row[0].text] for table in (whole, group)]
        assert values[0][0] == pytest.approx(values[1][0] * 2.0 / 1.35, rel=1e-6)


def test_a_path_has_the_words_of_the_terminal_and_of_its_motion() -> None:
    soil = [{"name": "soil", "area": {"rectangle": [0, 0, 4, 4]}, "resists": "down", "stiffness": 2e4}]
    tip = {"case": "Q", "force": 10, "at": [[5.9, 2]]}
    model = slab(support=soil, load=[{"case": "G", "self_weight": True}, tip])
    path = signorini.path(model, "G", "Q", steps=8)
    of = contents((signorini.solve(model), None))
    blocks = list(numbers.load_path(Contents(of.results, None, of.values, of.write, "", path)))
    (table,) = (one for one in blocks if isinstance(one, Table))
    assert [row[1].text for row in table.rows] == [words for words in map(path.words, range(len(path.stops))) if words]
    assert any("50 % closed" in row[1].text for row in table.rows)
    motion = "The plate tips about the line x = 4 through [4, 0], [4, 4] of soil."
    assert Text(motion, english=True) in blocks


def test_a_punching_sheet_names_the_sources_of_what_its_table_lacks() -> None:
    bars = {"code": "EN 1992-1-1:2004", "fck": 3e4, "fyk": 5e5, "cover": {"top": 0.03, "bottom": 0.03}, "bar": 0.01}
    table = {"support": "feet", "column": [0.3, 0.3], "code": "EN 1992-1-1:2004", "fck": 2.5e4}
    of = contents((signorini.solve(slab(punching=[table], reinforcement=bars)), None))
    sheet = next(one for one in numbers.punching(of) if isinstance(one, Table))
    sources = {row[0].text: row[4].text for row in sheet.rows}
    assert sources["fck"] == "input" and sources["fyk"] == "[reinforcement]"
    assert "[reinforcement]" in sources["dx"] and "9.2.1.1" in sources["ρx"] and "self-weight" in sources["ΔV"]
