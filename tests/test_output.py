import csv
import io
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st
from models import rectangular
from typer.testing import CliRunner

import signorini
from signorini.base.numbers import estimated, plain
from signorini.cli import app
from signorini.errors import InputError
from signorini.output import path_csv, reactions_csv, results_json, unique_slugs, write, write_path
from signorini.output.directory import room_for
from signorini.output.governing import governing_csv
from signorini.results.quantities import PEAKING, REINFORCEMENT


def model(**changes: object) -> signorini.Model:
    data = {
        "title": "Table, with a comma",
        "units": {"length": "m", "force": "kN"},
        "material": {"E": 30e6, "nu": 0.2},
        "support": [
            {"name": "legs", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"},
            {"name": "prop", "at": [2, 2.1], "resists": "down", "gap": 1e-3, "stiffness": 1e4},
        ],
        "load": [
            {"case": "G", "pressure": 5},
            {"case": "Q", "force": 60, "at": [0.2, 0.2]},
            {"case": "W", "force": -500, "at": [0, 0]},
        ],
        "combination": [
            {"name": "G+Q", "factors": {"G": 1, "Q": 1}},
            {"name": "g q", "factors": {"G": 1, "Q": 0}},
            {"name": "storm", "factors": {"W": 1}},
        ],
        "probe": [{"at": [[2, 2], [0.2, 0.2]]}],
    }
    return rectangular(**data | changes)


@pytest.fixture(scope="module")
def results() -> signorini.Results:
    return signorini.solve(model())


def keys(node: object) -> object:
    """Return the skeleton of a JSON document: the keys of its tables, the first element of its lists."""
    if isinstance(node, dict):
        return {key: keys(part) for key, part in node.items()}
    return [keys(node[0])] if isinstance(node, list) and node and isinstance(node[0], dict) else None


def of(names: str) -> dict[str, None]:
    """Keys of numbers, words and lists of these."""
    return dict.fromkeys(names.split())


def test_results_json_has_every_key_of_the_contract(results: signorini.Results) -> None:
    found = results_json(results, signorini.estimate(results))
    support = of("name kind reaction closed open closed_part contact_area max_pressure max_pressure_at max_tension")
    means = of("max_mean max_mean_at max_mean_width min_mean min_mean_at min_mean_width")
    numbers = {
        "deflection": of("max max_at min min_at"),
        "fields": {
            name: of("max max_at min min_at max_beside min_beside") | means
            for name in PEAKING
            if name not in REINFORCEMENT
        },
        "supports": [support | of("contact_boundary") | {"points": [of("at reaction gap state")]}],
        "probes": [
            of("at deflection rotation moment shear pressure principal_moment")
            | {"design_moment": of("bottom top"), "stress": of("top bottom von_mises shear")}
        ],
        **of("sections strips"),
    }
    figures = of("penetration tension complementarity equilibrium balance rounding lost passed")
    combination = {
        **of("name status message method unsettled iterations not_unique warnings profiles"),
        "limit": of("case factor"),
        "plus_minus": numbers,
        "singular": [
            of("where count box line limited within what numbers source advice")
            | {"means": [of("at width mx my mxy qx qy")]}
        ],
        "certificate": figures | of("tension_limit equilibrium_limit balance_limit"),
        **numbers,
    }
    governing = of("support point at max max_by max_with min min_by min_with")
    assert keys(found) == {
        **of("schema title snapped groups"),
        "warnings": [of("text combinations")],
        "program": of("name version commit"),
        "input": of("file sha256 model_sha256 files") | {"model": keys(found["input"]["model"])},
        "options": of("pictures xlsx"),
        "units": of("length force"),
        "model": of("nodes elements dofs contact_points"),
        "combinations": [combination],
        "governing_reactions": [governing | {"plus_minus": of("max max_with min min_with")}],
        "seconds": of("mesh assemble order factor contact recover total"),
        "files": [of("combination kind file")],
    }
    assert found["schema"] == 2
    assert found["model"] == {"nodes": 65, "elements": 16, "dofs": 195, "contact_points": 5}


def test_the_limit_of_equilibrium_is_that_of_statics() -> None:
    # 5 on 16 at 2 and 20 Q at 4, beside the legs' line at 3.
    loads = [{"case": "G", "pressure": 5}, {"case": "Q", "force": 20, "at": [4, 2]}]
    factors = {"stands": {"G": 1, "Q": 1}, "tips": {"G": 1, "Q": 5}, "alone": {"G": 1}}
    wanted = [{"name": name, "factors": of} for name, of in factors.items()]
    results = signorini.solve(model(support=[model().support[0]], load=loads, combination=wanted))
    limits = {c["name"]: c["limit"] for c in results_json(results)["combinations"]}
    assert limits["stands"] in (
        {"case": "Q", "factor": pytest.approx(4)},
        {"case": "G", "factor": pytest.approx(0.25)},
    )
    assert limits["tips"] in ({"case": "Q", "factor": pytest.approx(0.8)}, {"case": "G", "factor": pytest.approx(1.25)})
    assert limits["alone"] is None


def test_results_json_says_what_the_result_says(results: signorini.Results) -> None:
    found = results_json(results)["combinations"][0]
    result = results["G+Q"]
    assert found["certificate"]["passed"] is True
    assert found["deflection"]["max"] == result.deflection.max()
    assert np.allclose(found["deflection"]["max_at"], result.mesh.points[result.deflection.argmax()])
    legs = found["supports"][0]
    assert legs["reaction"] == pytest.approx(140, rel=1e-9)
    assert legs["contact_area"] is None and legs["max_pressure"] is None
    assert [point["at"] for point in legs["points"]] == [[1, 1], [3, 1], [3, 3], [1, 3]]
    assert sum(point["reaction"] for point in legs["points"]) == pytest.approx(legs["reaction"], rel=1e-12)
    for point in legs["points"]:
        assert (point["state"] == "open") == (point["gap"] > 0) == (point["reaction"] == 0)
    assert found["probes"][1]["deflection"] == pytest.approx(result.probe((0.2, 0.2))[0].deflection, rel=1e-12)


def test_principal_and_design_moments_are_those_of_the_probes_moments(results: signorini.Results) -> None:
    found = results_json(results, signorini.estimate(results))["combinations"][0]
    for probe, width in zip(found["probes"], found["plus_minus"]["probes"], strict=True):
        mx, my, mxy = probe["moment"]
        m1, m2, angle = probe["principal_moment"]
        turned = np.radians(angle)
        axis = np.array([np.cos(turned), np.sin(turned)])
        tensor = np.array([[mx, mxy], [mxy, my]])
        assert tensor @ axis == pytest.approx(m1 * axis)
        assert m1 + m2 == pytest.approx(mx + my)
        # Bars along x and y resist the moment in every direction, at the bottom and at the top.
        for side, sign in (("bottom", 1), ("top", -1)):
            designed = sign * np.array(probe["design_moment"][side])
            assert (designed >= 0).all()
            spare = np.linalg.eigvalsh(np.diag(designed) - sign * tensor)
            assert spare.min() >= -1e-9 * abs(tensor).max()
        assert width["principal_moment"][2] is None
    assert found["plus_minus"]["probes"][0]["design_moment"]["bottom"][0] >= 0


def test_a_point_with_travel_both_ways_is_one_point() -> None:
    legs = model().support[0]
    for gap, state in [(1e-3, "open"), (1e-6, "closed")]:
        tie = {"name": "tie", "at": [2, 2.1], "resists": "both", "gap": gap}
        results = signorini.solve(model(support=[legs, tie], combination=[{"name": "G", "factors": {"G": 1}}]))
        found = results_json(results)["combinations"][0]["supports"][1]
        (point,) = found["points"]
        assert (found["closed"], found["open"]) == ((0, 1) if state == "open" else (1, 0))
        # The nearer of the two sides counts.
        left = gap - abs(results["G"].probe((2, 2.1))[0].deflection)
        assert (point["state"], point["gap"]) == (state, pytest.approx(left, rel=1e-6, abs=1e-15))
        assert point["reaction"] == found["reaction"] == pytest.approx(results["G"].reactions["tie"])


def test_points_of_areas_are_not_listed() -> None:
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e4}
    results = signorini.solve(model(support=[soil], combination=[{"factors": {"G": 1}}]))
    found = results_json(results)["combinations"][0]["supports"][0]
    assert "points" not in found
    assert found["contact_area"] == pytest.approx(16, rel=1e-9)
    assert found["max_pressure"] == pytest.approx(5, rel=1e-6)


@pytest.fixture(scope="module")
def bedded() -> signorini.Results:
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e4}
    grout = {"name": "grout", "area": {"rectangle": [2, 2, 4, 4]}, "resists": "down"}
    pull = {"case": "G", "force": -30, "at": [0, 4]}
    loads = [{"case": "G", "pressure": 5}, pull]
    return signorini.solve(model(support=[soil, grout], load=loads, combination=[{"name": "G", "factors": {"G": 1}}]))


@pytest.mark.parametrize("resists", ["up", "both", "down"])
def test_areas_that_pull_give_their_largest_tension(resists: str) -> None:
    ties = {"name": "ties", "area": "all", "resists": resists, "stiffness": 1e4}
    stand = {"name": "stand", "at": [[1, 1], [3, 1], [2, 3]]}
    results = signorini.solve(model(support=[ties, stand], load=[{"pressure": -5}], combination=[], probe=[]))
    found = results_json(results, signorini.estimate(results))["combinations"][0]
    support, width = found["supports"][0], found["plus_minus"]["supports"][0]
    lowest = results["all"].pressure(results["all"].mesh.points).min()
    assert support["max_tension"] == pytest.approx(-lowest if resists != "down" else 0, rel=0.05)
    assert (support["max_tension"] > 0) == (resists != "down")
    assert width["max_tension"] >= 0
    (row,) = [row for row in csv.DictReader(io.StringIO(reactions_csv(results))) if row["support"] == "ties"]
    assert float(row["max_tension"]) == support["max_tension"]


def test_pressure_and_edge_of_contact_are_in_results_json(bedded: signorini.Results) -> None:
    found = results_json(bedded)["combinations"][0]
    result = bedded["G"]
    for written, support in zip(found["supports"], result.supports, strict=True):
        assert len(support.contact_boundary) > 0
        assert written["contact_boundary"] == [line.tolist() for line in support.contact_boundary]
    assert [probe["pressure"] for probe in found["probes"]] == result.pressure([(2, 2), (0.2, 0.2)]).tolist()
    json.dumps(found, allow_nan=False)


def test_pressure_is_in_the_vtu_file_of_elastic_areas_at_nodes_and_of_rigid_ones_an_element(
    bedded: signorini.Results, tmp_path: Path
) -> None:
    result = bedded["G"]
    written = write(bedded, tmp_path)
    assert {path.name for path in written} == {
        *("g.vtu", "g.png", "g-deformed.png", "g-moments.png", "g-shears.png", "g-pressure.png"),
        *("reactions.csv", "results.json"),
    }
    found = meshio.read(tmp_path / "g.vtu")
    pressures = found.point_data["contact_pressure"][: len(result.deflection)]
    assert np.allclose(pressures, np.maximum(1e4 * result.deflection, 0), rtol=1e-12)
    (rigid,) = found.cell_data["rigid_contact_pressure"]
    area = result.mesh.element_area
    assert (rigid * area).sum() == pytest.approx(result.reactions["grout"], rel=1e-12)
    assert (rigid[result.mesh.nodes.min(axis=(1, 2)) < 2 - 1e-9] == 0).all()
    axes = result.plot("pressure")
    words = [entry.get_text() for entry in axes.get_legend().get_texts()]
    assert words[0].startswith("soil: area, pushes up only, elastic, ") and "edge of contact" in words
    named = [text.get_text() for text in axes.texts if text.get_text().startswith("max")]
    assert named == [f"max {plain(max(support.max_pressure for support in result.supports), 4)}"]


def test_a_combination_without_equilibrium_has_a_reason_and_no_numbers(results: signorini.Results) -> None:
    found = results_json(results)["combinations"][2]
    assert (found["name"], found["status"]) == ("storm", "no_equilibrium")
    assert "The plate lifts off its supports: the load's resultant is 500 kN up" in found["message"]
    assert (found["certificate"], found["deflection"]) == (None, None)
    assert (found["supports"], found["probes"]) == ([], [])


def test_no_number_is_nan(results: signorini.Results) -> None:
    assert json.loads(json.dumps(results_json(results), allow_nan=False)) == results_json(results)


def test_reactions_csv_has_a_row_a_support_and_a_row_a_point(results: signorini.Results) -> None:
    rows = list(csv.DictReader(io.StringIO(reactions_csv(results))))
    totals = [(row["combination"], row["support"]) for row in rows if row["point"] == "total"]
    assert totals == [(name, support) for name in ("G+Q", "g q", "storm") for support in ("legs", "prop")]
    points = [row for row in rows if (row["combination"], row["support"]) == ("G+Q", "legs")][1:]
    assert [row["point"] for row in points] == ["1", "2", "3", "4"]
    assert sum(float(row["reaction"]) for row in points) == pytest.approx(140, rel=1e-9)
    storm = [row for row in rows if row["combination"] == "storm"]
    assert [(row["state"], row["reaction"]) for row in storm] == 2 * [("no_equilibrium", "")]


NAMES = ["-W", "+W", "=HYPERLINK(1)", "@SUM(A1)", "'t Huis", "＝1", "[bold]x[/bold]", "<b>G</b> & Q", "G, Q"]


@pytest.fixture(scope="module")
def oddly_named() -> signorini.Results:
    prop = {"at": [2, 2.1], "resists": "down", "gap": 1e-3, "stiffness": 1e4}
    supports = [model().support[0], *(prop | {"name": name, "at": [2, 2 + i / 9]} for i, name in enumerate(NAMES))]
    return signorini.solve(
        model(
            title="=title",
            support=supports,
            combination=[{"name": name, "factors": {"G": 1 + i}} for i, name in enumerate(NAMES)],
        )
    )


def test_no_name_is_a_formula_and_every_number_a_number(oddly_named: signorini.Results) -> None:
    written = reactions_csv(oddly_named)
    feet = {"name": "=feet", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}
    path = signorini.path(model(support=[feet]), start="G", add="Q")
    for line in (*csv.reader(io.StringIO(written)), *csv.reader(io.StringIO(path_csv(path)))):
        for cell in line:
            assert not cell.startswith(("=", "+", "@", "＝", "-")) or np.isfinite(float(cell))
    rows = list(csv.DictReader(io.StringIO(written)))
    assert list(dict.fromkeys(row["combination"].removeprefix("'") for row in rows)) == NAMES
    assert {row["support"].removeprefix("'") for row in rows} == {"legs", *NAMES}
    assert "'-W" in {row["combination"] for row in rows}
    found = results_json(oddly_named)
    assert [combination["name"] for combination in found["combinations"]] == NAMES
    assert any(event.support == "=feet" for event in path.support_events)
    assert "'=feet: opens" in path_csv(path)


@pytest.mark.filterwarnings("ignore:Glyph")
def test_names_are_text_in_notebooks_and_pictures(oddly_named: signorini.Results, tmp_path: Path) -> None:
    shown = oddly_named._repr_html_()
    assert "&lt;b&gt;G&lt;/b&gt; &amp; Q" in shown and "<b>G</b>" not in shown
    axes = oddly_named["<b>G</b> & Q"].plot()
    axes.figure.savefig(tmp_path / "plate.svg")
    assert "<b>G" not in (tmp_path / "plate.svg").read_text("utf-8")


@pytest.mark.parametrize("count", [2, 13])
def test_python_writes_what_the_command_writes(tmp_path: Path, count: int) -> None:
    file = tmp_path / "slab.toml"
    file.write_text(
        """
material = { E = 30e9, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
mesh = { divisions = [4, 4] }
support = [{ name = "feet", at = [[1, 1], [3, 1], [3, 3], [1, 3]], resists = "down" }]
load = [{ case = "G", pressure = 5e3 }, { case = "Q", force = 4e4, at = [2, 4] }]
"""
        + "".join(f'[[combination]]\nname = "c{i}"\nfactors = {{ G = 1, Q = {0.1 * i} }}\n' for i in range(count))
    )
    for arguments in (["solve", str(file)], ["path", str(file), "--from", "G", "--add", "Q"]):
        result = CliRunner().invoke(app, arguments)
        assert result.exit_code == 0, result.output
    model = signorini.load(file)
    for found, name in ((signorini.solve(model), "results"), (signorini.path(model, "G", "Q"), "path")):
        theirs, mine = tmp_path / f"slab-{name}", tmp_path / f"mine-{name}"
        written = signorini.write(found, mine)
        assert sorted(written) == sorted(mine.iterdir())
        assert [path.name for path in sorted(written)] == [path.name for path in sorted(theirs.iterdir())]
        for path in written:
            other = theirs / path.name
            if path.suffix == ".csv":
                assert path.read_text() == other.read_text()
            elif path.suffix == ".parquet":
                assert pq.read_table(path).to_pydict() == pq.read_table(other).to_pydict()
            elif path.suffix == ".json":
                one, two = json.loads(path.read_text()), json.loads(other.read_text())
                assert one | {"seconds": None} == two | {"seconds": None}
    with pytest.raises(signorini.InputError, match=r"found Model\(.* it must be a Results. signorini.solve"):
        signorini.write(model, tmp_path / "none")
    assert not (tmp_path / "none").exists()


def test_write_leaves_whole_files_of_the_solved_combinations(results: signorini.Results, tmp_path: Path) -> None:
    written = write(results, tmp_path / "a" / "out")
    ends = ("-deformed.png", "-moments.png", "-shears.png", ".png", ".vtu")
    names = [f"{slug}{end}" for slug in ("g+q", "g-q") for end in ends]
    names = sorted([*names, "governing.csv", "reactions.csv", "results.json"])
    assert sorted(path.name for path in written) == names
    assert sorted(path.name for path in (tmp_path / "a" / "out").iterdir()) == names
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["out"]
    found = json.loads((tmp_path / "a" / "out" / "results.json").read_text("utf-8"))
    assert found == results_json(results, signorini.estimate(results))
    mesh = meshio.read(tmp_path / "a" / "out" / "g+q.vtu")
    assert np.allclose(mesh.point_data["displacement"][:, 2], -results["G+Q"].deflection)
    assert (tmp_path / "a" / "out" / "g+q.png").read_bytes().startswith(b"\x89PNG")


def test_a_notebook_shows_points_pressures_and_half_widths() -> None:
    feet = {"name": "feet", "at": [[x, y] for x in range(5) for y in range(5)], "resists": "down"}
    soil = {"name": "soil", "area": {"rectangle": [0, 0, 2, 2]}, "resists": "down", "stiffness": 1e4}
    combination = [{"name": "service", "factors": {"G": 1, "W": 0.06}}]
    result = signorini.solve(model(support=[feet, soil], combination=combination))["service"]
    plain = result._repr_html_()
    estimate = signorini.estimate(result)
    shown = estimate._repr_html_()
    assert shown.count("±") > plain.count("±") == 0
    rows = [re.findall("<t[hd][^>]*>(.*?)</t[hd]>", row) for row in shown.split("<tr>")[1:]]
    titles = ["", "support", "kind", "reaction [kN]", "gap [m]", "closed", "open", "largest pressure [kN/m²]"]
    assert rows[0] == [*titles, "in contact [m²]"]
    assert {len(row) for row in rows} == {9} and len(rows) == 1 + 1 + 20 + 1 + 1
    soil_row, widths = rows[-1], estimate.plus_minus["supports"]
    area = result.supports[1]
    assert soil_row[1] == "soil"
    assert soil_row[7] == estimated(area.max_pressure, widths[1]["max_pressure"])
    reaction = result.supports[0].reaction
    assert rows[1][3] == estimated(reaction, widths[0]["reaction"], reaction)
    first = next(row for row in rows if row[2] == "open")
    at = int(first[1].split(" at ")[0]) - 1
    assert first[4] == estimated(result.supports[0].gaps[at], widths[0]["points"][at]["gap"])
    assert "and 5 of smaller reactions" in shown and "± estimates the mesh error" in shown


def test_a_second_run_replaces_the_first_and_nothing_else(results: signorini.Results, tmp_path: Path) -> None:
    write(results, tmp_path)
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "other.vtu").write_text("mine too")
    fewer = signorini.solve(model(combination=[{"name": "only", "factors": {"G": 1}}]))
    write(fewer, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        *("notes.txt", "only-deformed.png", "only-moments.png", "only-shears.png", "only.png", "only.vtu"),
        *("other.vtu", "reactions.csv", "results.json"),
    ]


@pytest.mark.parametrize(
    "names", ['["../precious.vtu", "/etc/passwd"]', "7", '{"a": 1}', "[3]", '[{"a": 1}]', '[{"file": 7}]']
)
def test_a_forged_list_of_former_files_removes_nothing_else(
    results: signorini.Results, tmp_path: Path, names: str
) -> None:
    (tmp_path / "precious.vtu").write_text("mine")
    (tmp_path / "out").mkdir()
    forged = {key: None for key in results_json(results)} | {"files": json.loads(names)}
    (tmp_path / "out" / "results.json").write_text(json.dumps(forged))
    with pytest.raises(InputError, match=r"results.json exists, and was not written by an earlier run"):
        write(results, tmp_path / "out")
    assert (tmp_path / "precious.vtu").read_text() == "mine"


@pytest.mark.parametrize("name", ["reactions.csv", "results.json", "g-q.vtu", "g-q.png"])
def test_a_file_of_somebody_elses_with_a_name_of_ours_is_refused_beforehand(
    results: signorini.Results, tmp_path: Path, name: str
) -> None:
    (tmp_path / name).write_text('{"files": ["results.json", "reactions.csv"]}')
    before = (tmp_path / name).read_bytes()
    for put in (lambda: write(results, tmp_path), lambda: room_for(tmp_path, model()).__enter__()):
        with pytest.raises(InputError, match=f"{name} exists, and was not written by an earlier run"):
            put()
        assert [path.name for path in tmp_path.iterdir()] == [name] and (tmp_path / name).read_bytes() == before


def test_results_and_a_load_path_in_one_directory_leave_each_other_alone(
    results: signorini.Results, tmp_path: Path
) -> None:
    followed = signorini.path(model(), start="G", add="Q", until=0.5)
    for _ in range(2):
        write(results, tmp_path)
        write_path(followed, tmp_path)
    assert {"path.json", "path.csv", "path.png", *(entry["file"] for entry in results_json(results)["files"])} == {
        p.name for p in tmp_path.iterdir()
    }
    named_path = signorini.solve(model(combination=[{"name": "path", "factors": {"G": 1}}]))
    with pytest.raises(InputError, match=r"path.png exists"):
        write(named_path, tmp_path)


@pytest.mark.parametrize("moment", ["csv", "rename"])
def test_a_failure_on_the_way_leaves_everything_as_it_was(
    results: signorini.Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, moment: str
) -> None:
    write(results, tmp_path / "out")
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}

    if moment == "csv":
        monkeypatch.setattr("signorini.output.writing.reactions_csv", _full_disk)
    else:
        rename, count = Path.rename, iter(range(100))
        monkeypatch.setattr(Path, "rename", lambda path, to: _full_disk() if next(count) == 8 else rename(path, to))
    with pytest.raises(InputError, match="the results cannot be written there: No space left"):
        write(results, tmp_path / "out")
    if moment == "csv":
        with pytest.raises(InputError):
            write(results, tmp_path / "a" / "b" / "out")
    monkeypatch.undo()
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_signs_are_told_apart_in_file_names_and_results_json_says_which_is_which(tmp_path: Path) -> None:
    names = ["W+ lead", "W- lead", "W lead", "1.35 G + 1.5 W", "1.35 G - 1.5 W", "−W", "a - b", "a-b"]
    assert unique_slugs(names) == [
        *("w+lead", "w-minus-lead", "w-lead", "1.35-g+1.5-w", "1.35-g-minus-1.5-w", "minus-w", "a-minus-b", "a-b")
    ]
    found = signorini.solve(model(combination=[{"name": name, "factors": {"G": 1}} for name in names[:2]]))
    written = write(found, tmp_path)
    entries = json.loads((tmp_path / "results.json").read_text())["files"]
    assert [tmp_path / entry["file"] for entry in entries] == written
    of_all = {"results": "results.json", "reactions": "reactions.csv", "governing": "governing.csv"}
    of_each = {"vtu": ".vtu", "picture": ".png", "deformed": "-deformed.png"}
    of_each |= {"moments": "-moments.png", "shears": "-shears.png"}
    expected = [(None, kind, file) for kind, file in of_all.items()]
    expected += [("W+ lead", kind, f"w+lead{end}") for kind, end in of_each.items()]
    expected += [("W- lead", kind, f"w-minus-lead{end}") for kind, end in of_each.items()]
    assert [(entry["combination"], entry["kind"], entry["file"]) for entry in entries] == expected


def test_results_of_schema_1_are_replaced_too(results: signorini.Results, tmp_path: Path) -> None:
    (tmp_path / "w-lead-2.vtu").write_text("former")
    former = {key: None for key in results_json(results)}
    former["files"] = ["results.json", "reactions.csv", "w-lead-2.vtu"]
    for name in former["files"]:
        (tmp_path / name).write_text(json.dumps(former))
    write(results, tmp_path)
    assert not (tmp_path / "w-lead-2.vtu").exists()


def _full_disk(*_: object) -> Path:
    raise OSError(28, "No space left on device")


def test_a_directory_that_cannot_be_is_refused_beforehand(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    for place in (tmp_path / "file", tmp_path / "file" / "out", Path("/proc/signorini"), tmp_path / ("a" * 300)):
        with pytest.raises(InputError, match="the results cannot be written there"), room_for(place, model()):
            pass
    for place in (tmp_path / "new" / "out", tmp_path / ("a" * 250)):
        with room_for(place, model()):
            pass
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_directory_with_the_name_of_a_file_is_not_removed(results: signorini.Results, tmp_path: Path) -> None:
    (tmp_path / "results.json").mkdir()
    with pytest.raises(InputError, match="a directory has the name of a file"):
        write(results, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["results.json"]


@given(st.lists(st.text(max_size=90)))
def test_file_names_are_safe_and_differ_on_every_file_system(names: list[str]) -> None:
    slugs = unique_slugs(names)
    assert len({slug.lower() for slug in slugs}) == len(names)
    for slug in slugs:
        assert slug and len(slug) < 90 and set(slug) <= set("abcdefghijklmnopqrstuvwxyz0123456789-_.+")
        assert slug[0] not in "-." and slug not in ("con", "nul", "aux", "prn")


def test_importing_the_package_imports_no_plotting() -> None:
    code = "import signorini, sys; print(sorted({'matplotlib', 'typer'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"


def test_a_held_edge_gives_the_reactions_of_its_nodes(tmp_path: Path) -> None:
    wall = {"name": "wall", "edge": "left", "fix": "simple"}
    found = signorini.solve(model(support=[wall, model().support[0]], combination=[{"name": "G", "factors": {"G": 1}}]))
    support = results_json(found)["combinations"][0]["supports"][0]
    assert sorted(node["at"][1] for node in support["nodes"]) == pytest.approx(np.linspace(0, 4, 9))
    assert {node["at"][0] for node in support["nodes"]} == {0}
    assert sum(node["reaction"] for node in support["nodes"]) == pytest.approx(support["reaction"], rel=1e-12)
    rows = [row for row in csv.DictReader(io.StringIO(reactions_csv(found))) if row["support"] == "wall"]
    assert [row["point"] for row in rows] == ["total", *map(str, range(1, 10))]
    assert [float(row["reaction"]) for row in rows[1:]] == [node["reaction"] for node in support["nodes"]]


def test_governing_reactions_come_with_those_of_the_others() -> None:
    wanted = [{"name": f"c{i}", "factors": {"G": 1, "Q": i / 8}} for i in range(9)] + [
        {"name": "storm", "factors": {"W": 1}}
    ]
    few = signorini.solve(model(combination=wanted))
    many = signorini.solve(model(combination=wanted, output={"combinations": "table"}))
    listed = results_json(few)["governing_reactions"]
    for one, other in zip(listed, results_json(many)["governing_reactions"], strict=True):
        assert (one["support"], one["point"], one["at"]) == (other["support"], other["point"], other["at"])
        for side in ("max", "min"):
            assert one[side] == pytest.approx(other[side], rel=1e-9, abs=1e-9)
            assert one[f"{side}_with"] == pytest.approx(other[f"{side}_with"], rel=1e-9, abs=1e-9)
    reactions = {
        name: [*few[name].supports[0].reactions, few[name].supports[1].reaction] for name in few if name != "storm"
    }
    assert [(one["support"], one["point"]) for one in listed] == [*(("legs", i) for i in range(1, 5)), ("prop", 1)]
    for index, one in enumerate(listed):
        assert one["max"] == max(values[index] for values in reactions.values()) == one["max_with"][index]
        assert one["min"] == min(values[index] for values in reactions.values())
        assert one["max_with"] == reactions[one["max_by"]] and one["min_with"] == reactions[one["min_by"]]


def _governed(row: dict[str, str], result: signorini.Result) -> float:
    """The number that a row of governing.csv is of, in some combination."""
    support = result.supports[row["support"] == "'=soil"]
    if row["what"] in ("max_pressure", "contact_area"):
        return getattr(support, row["what"])
    points = support.gaps if row["what"] == "gap" else support.reactions
    return points[int(row["point"]) - 1] if row["point"] else support.reaction


def test_a_file_has_every_extreme_of_every_bearing_with_what_the_others_do() -> None:
    feet = {"name": "feet", "at": [[x, y] for x in range(0, 5, 2) for y in range(5)], "resists": "down"}
    soil = {"name": "=soil", "area": {"rectangle": [0, 0, 2, 2]}, "resists": "down", "stiffness": 1e4}
    wanted = [{"name": f"c{i}", "group": "ULS" if i % 2 else "SLS", "factors": {"G": 1, "W": i / 80}} for i in range(5)]
    rows = dict[str, list[dict[str, str]]]()
    for form in ("each", "table"):
        found = signorini.solve(
            model(support=[feet, soil], combination=wanted, output={"combinations": form}, mesh={"divisions": [4, 4]})
        )
        rows[form] = list(csv.DictReader(io.StringIO(governing_csv(found, signorini.estimate(found)))))
    for one, other in zip(rows["each"], rows["table"], strict=True):
        assert [one[key] for key in ("group", "support", "what", "extreme")] == [
            other[key] for key in ("group", "support", "what", "extreme")
        ]
        assert float(one["value"]) == pytest.approx(float(other["value"]), rel=1e-6, abs=1e-6)
    each = signorini.solve(model(support=[feet, soil], combination=wanted, mesh={"divisions": [4, 4]}))
    for row in rows["each"]:
        of = {name: each[name] for name in each if row["group"] in ("", "SLS" if int(name[1:]) % 2 == 0 else "ULS")}
        values = [_governed(row, result) for result in of.values()]
        assert float(row["value"]) == pytest.approx((max if row["extreme"] == "max" else min)(values), rel=1e-9)
        governs = each[row["combination"]]
        assert float(row["value"]) == pytest.approx(_governed(row, governs), rel=1e-9)
        assert float(row["reaction:=soil"]) == pytest.approx(governs.supports[1].reaction, rel=1e-9)
        last = governs.supports[0].reactions[14]
        assert float(row["reaction_at:feet[15]"]) == pytest.approx(last, rel=1e-9, abs=1e-9)
    kinds = [(row["what"], row["extreme"]) for row in rows["each"] if not row["group"] and row["support"] == "'=soil"]
    both = [(what, side) for what in ("reaction", "max_pressure", "contact_area") for side in ("max", "min")]
    assert kinds == both
    assert {row["group"] for row in rows["each"]} == {"", "SLS", "ULS"}
    assert any(row["what"] == "gap" for row in rows["each"])
    assert any(row["value:plus_minus"] and row["reaction:=soil:plus_minus"] for row in rows["each"])


def test_pictures_of_a_group_have_one_scale_of_their_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    limits = dict[tuple[str, str], Any]()

    def kept(plan: Any, pictures: Any, length: str, rows: int) -> Iterator[bytes]:
        for one in pictures:
            first = one.panels[0]
            limits[one.title, first.label.split()[0].rstrip(",")] = first.limits
            yield b"drawn"

    monkeypatch.setattr("signorini.plot.pictures.drawn_as_png", kept)
    named = {"ULS 1": 1.35, "ULS 2": 1.5, "SLS": 1.0}
    combinations = [{"name": name, "group": name[:3], "factors": {"load": one}} for name, one in named.items()]
    plain = {"material": {"E": 30e9, "nu": 0.2}, "support": [{"edge": ["left", "right"], "fix": "simple"}]}
    loaded = {"load": [{"pressure": 2e3}], "combination": combinations, "mesh": {"divisions": [4, 4], "error": False}}
    plate = {"shape": "rectangle", "size": [4, 4], "thickness": 0.2}
    write(signorini.solve(signorini.Model(plate=plate, **plain, **loaded)), tmp_path)
    assert limits["ULS 1", "deflection"] == limits["ULS 2", "deflection"] != limits["SLS", "deflection"]
    assert limits["ULS 2", "shear"][1] == pytest.approx(1.5 * limits["SLS", "shear"][1])
    plans = {path for path in tmp_path.glob("*.png") if not path.stem.endswith(("-deformed", "-reactions"))}
    assert {path.read_bytes()[:5] for path in plans} == {b"drawn"}


def test_an_envelope_has_pictures_of_its_largest_and_smallest_values_in_one_scale(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn = dict[tuple[str, str], Any]()

    def kept(plan: Any, pictures: Any, length: str, rows: int) -> Iterator[bytes]:
        for one in pictures:
            drawn.update({(one.title, panel.label): panel for panel in one.panels} if rows == 2 else {})
            yield b"drawn"

    monkeypatch.setattr("signorini.plot.pictures.drawn_as_png", kept)
    groups = ("ULS", "ULS", "SLS")
    wanted = [{"name": f"c{i}", "group": groups[i], "factors": {"G": 1, "W": 0.01 * i}} for i in range(3)]
    asked = {"combinations": "table", "fields": "none", "envelope": ["deflection", "mx", "qx", "qy"]}
    results = signorini.solve(model(combination=wanted, output=asked, mesh={"divisions": [4, 4], "error": False}))
    write(results, tmp_path / "out")
    files = results_json(results)["files"]
    named = [(one["kind"], one["file"]) for one in files if one["file"].startswith("envelope")]
    kinds = {"envelope": ".vtu", "picture": ".png", "moments": "-moments.png", "shears": "-shears.png"}
    of_all = ("envelope", "envelope-uls", "envelope-sls")
    assert named == [(kind, of + ending) for of in of_all for kind, ending in kinds.items()]
    assert {path.name for path in (tmp_path / "out").iterdir()} == {one["file"] for one in files}
    found = {"3 combinations": results.envelope, **results.groups}
    assert {title for title, _ in drawn} == {f"Table, with a comma, envelope of {what}" for what in found}
    for what, envelope in found.items():
        title = f"Table, with a comma, envelope of {what}"
        high, low = (drawn[title, f"{side} moment mx [kN m/m]"] for side in ("largest", "smallest"))
        of, peak, place = envelope.fields["mx"], envelope.field("mx"), envelope.layout.fields.index("mx")
        most, least = peak.max, peak.min
        assert high.limits == low.limits == (least, most)
        assert np.array_equal(high.values, results.discretisation.stress_nodes.spread(of.largest))
        assert np.array_equal(low.values, results.discretisation.stress_nodes.spread(of.smallest))
        assert high.extremes == [(f"max {plain(most, 4)}", envelope.places[place, 0].tolist())]
        assert low.extremes[0][0] == f"min {plain(least, 4)}"
        assert (title, "largest moment my [kN m/m]") not in drawn
        assert (title, "smallest deflection [m], positive down") in drawn
        assert (high.title, low.title) == (f"max: c{peak.max_by}", f"min: c{peak.min_by}")


def test_of_extremes_alike_but_for_rounding_the_one_at_the_least_x_and_then_y_is_named() -> None:
    legs = [{"at": [[0.4, 0.4], [3.6, 0.4], [0.4, 3.6], [3.6, 3.6]], "resists": "down"}]
    found = signorini.solve(model(support=legs, load=[{"pressure": 5}], combination=[], mesh={"divisions": [16, 16]}))
    extremes = found["all"].extremes
    assert extremes["deflection"].min_at == (0, 0)
    assert extremes["mx"].max_at == (2, 0) and extremes["my"].max_at == (0, 2)
    assert extremes["qx"].max_at[1] < 2 and extremes["qy"].max_at[0] < 2
