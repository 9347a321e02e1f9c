"""Places where moments and shears have no limit: exclusions are reported, and means are given."""

import io
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from models import rectangular
from rich.console import Console
from typer.testing import CliRunner

import signorini
from signorini import Model, Progress, Results, estimate, solve
from signorini.cli import app
from signorini.cli.tables import print_results
from signorini.output.envelope_json import envelope_json
from signorini.output.tables import results_json

RADIUS, PRESSURE = 0.25, 10e3
AT = (4.0, 3.0)


def column(size: float = 0.25, **changes: Any) -> Model:
    """A slab on its edges and on a column of no size, of thickness 0.25."""
    x, y = AT
    given: dict[str, Any] = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [8, 6], "thickness": RADIUS},
        "mesh": {"size": size, "error": False},
        "support": [{"name": "walls", "edge": ["left", "right"], "fix": "simple"}, {"name": "column", "at": [AT]}],
        "load": [{"case": "G", "pressure": PRESSURE}, {"case": "P", "force": 2e4, "at": [6, 2]}],
        "section": [{"name": "across", "line": [[x, y - RADIUS], [x, y + RADIUS]]}],
        "combination": [{"name": "G", "factors": {"G": 1}}, {"name": "G + P", "factors": {"G": 1, "P": 1}}],
    }
    return Model(**given | changes)


def table(**changes: Any) -> Model:
    combinations = [
        {"name": f"ULS {i}: 1.35 G + {i / 8} P and more of it", "factors": {"G": 1.35, "P": i / 8}} for i in range(14)
    ]
    return column(**{"combination": combinations, "section": []} | changes)


def shown(results: Results, width: int = 100_000) -> str:
    console = Console(file=io.StringIO(), width=width, markup=False, highlight=False, emoji=False, soft_wrap=True)
    print_results(console, results, None)
    return console.file.getvalue()  # type: ignore[attr-defined,no-any-return]


def test_means_at_a_column_are_what_a_section_and_equilibrium_say() -> None:
    result = solve(column(0.125))["G"]
    means = next(one for one in results_json(solve(column(0.125)))["combinations"][0]["singular"])["means"]
    assert [one["at"] for one in means] == [list(AT)] and means[0]["width"] == 2 * RADIUS
    (across,) = result.sections
    assert means[0]["mx"] == pytest.approx(across.moment / (2 * RADIUS), rel=0.03)
    # The shears around the square of the width give back the reaction, less the load inside.
    around = 4 * RADIUS * (abs(means[0]["qx"]) + abs(means[0]["qy"]))
    assert around == pytest.approx(result.reactions["column"] - PRESSURE * (2 * RADIUS) ** 2, rel=0.03)


def test_a_mean_settles_as_the_mesh_is_refined_and_its_half_width_covers_it() -> None:
    coarse, fine = (solve(column(size)) for size in (0.5, 0.125))
    mean = coarse["G"].extremes["mx"].min_mean
    width = estimate(coarse["G"]).plus_minus["fields"]["mx"]["min_mean"]  # type: ignore[index]
    assert abs(mean - fine["G"].extremes["mx"].min_mean) < width < 0.5 * abs(mean)


def test_extremes_of_means_are_of_the_cases_that_act() -> None:
    alone, both = solve(column()).values()
    assert alone.extremes["mx"].max_mean_at == AT
    assert both.extremes["mx"].max_mean_at == (6.0, 2.0)
    assert alone.extremes["mx"].min_mean < alone.extremes["mx"].min
    assert alone.extremes["mx"].min_mean_width == 2 * RADIUS


def test_a_field_without_an_exclusion_has_no_mean() -> None:
    support = [{"edge": ["left", "right"], "fix": "simple", "name": "walls"}]
    result = solve(rectangular(support=support, load=[{"pressure": 1e3}]))["all"]
    assert np.isnan(result.extremes["mx"].max_mean)


def test_a_table_has_the_exclusions_and_the_means_of_its_combinations() -> None:
    results = solve(table())
    fields = envelope_json(results)["fields"]  # type: ignore[index]
    each = [results[name] for name in results]
    for name in ("mx", "my", "mxy", "qx", "qy"):
        for side, pick in (("max_mean", max), ("min_mean", min)):
            values = [getattr(one.extremes[name], side) for one in each]
            assert fields[name][side] == pytest.approx(pick(values), rel=1e-9, abs=1e-6)
            assert results.table[f"{side}:{name}"] == pytest.approx(np.array(values), rel=1e-8, abs=1e-6)
            own = results[fields[name][f"{side}_by"]].extremes[name]
            assert getattr(own, side) == pytest.approx(fields[name][side], rel=1e-9, abs=1e-6)
            assert fields[name][f"{side}_at"] == list(getattr(own, f"{side}_at"))
        assert {(one["what"], one["within"]) for one in fields[name]["excluded"]} >= {("column at a point", RADIUS)}
    assert fields["mx"]["min_mean"] < fields["mx"]["min"]
    assert fields["mx"]["min_mean_by"] in results.governing
    assert fields["deflection"].keys() == {"max", "max_by", "max_at", "min", "min_by", "min_at"}


@pytest.mark.parametrize("model", [column(), column(combination=[]), table()])
def test_the_terminal_says_what_extremes_exclude_and_gives_the_means(model: Model) -> None:
    said = shown(solve(model)).splitlines()
    told = [one for one in said if one.startswith("Excluded from extremes")]
    assert any(f"moments and shears within {RADIUS} of " in one and "column at a point" in one for one in told)
    assert any(one.startswith("mean there") for one in said)


def test_numbers_stand_for_long_names_where_there_is_no_room() -> None:
    results = solve(table())
    wide, narrow = shown(results), shown(results, 80)
    assert "C14: ULS 13: 1.35 G + 1.625 P and more of it" in wide
    assert max(map(len, narrow.splitlines())) <= 80
    rows = [line for line in narrow.splitlines() if line.startswith("moment mx ")]
    assert rows and all(re.fullmatch(r"moment mx .* C\d+ .* C\d+", row) for row in rows)
    named = dict(re.findall(r"^(C\d+): (.+)$", narrow, re.M))
    assert named["C14"] == [*results][13]
    assert set(re.findall(r"\bC\d+\b", narrow)) <= set(named)


def test_reactions_of_each_bearing_are_shown_by_combination_and_enveloped() -> None:
    feet = {"name": "feet", "at": [[x, y] for x in (1, 3, 5, 7) for y in (1, 2, 4, 5)]}
    results = solve(table(support=[feet]))
    said = shown(results).splitlines()
    begin = said.index("reaction of each bearing")
    rows = [line for line in said[begin:] if re.match(r"C\d+: ", line)][:14]
    for name, row in zip(results, rows, strict=True):
        numbers = row.split("more of it")[1].split()
        assert np.array(numbers, float) == pytest.approx(results[name].supports[0].reactions, rel=1e-4)
    (row,) = (line for line in said if line.startswith("feet[1] ") and " C" in line)
    reactions = [results[name].supports[0].reactions[0] for name in results]
    assert f"{max(reactions):.6g}" in row and f"{min(reactions):.6g}" in row


WALLS = {"name": "walls", "edge": ["left", "right", "bottom", "top"], "fix": "simple"}


@pytest.mark.parametrize("rest", [{"gap": 0.05}, {"settlement": 0.05}])
@pytest.mark.parametrize("place", [{"area": "all", "stiffness": 1e8}, {"at": [[1, 1], [0, 0]]}])
def test_what_never_touched_or_what_settles_away_lifts_nothing(rest: Any, place: Any) -> None:
    support = [WALLS, {"name": "stop", "resists": "down", **place, **rest}]
    found = solve(rectangular(support=support, load=[{"pressure": 1e3}]))
    assert "has lifted" not in shown(found)
    rows = [{"name": f"c{i}", "factors": {"load": i}} for i in range(1, 15)]
    many = solve(rectangular(support=support, load=[{"pressure": 1e3}], combination=rows))
    assert envelope_json(many)["supports"][1]["lifted"] == 0  # type: ignore[index]


def test_points_that_let_go_are_lifted_in_a_table() -> None:
    pads = {"name": "pads", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}
    rows = [{"name": f"c{i}", "factors": {"G": 1, "P": i}} for i in range(14)]
    load = [{"case": "G", "pressure": 1e3}, {"case": "P", "force": 1e3, "at": [0, 0]}]
    found = solve(rectangular(support=[pads], load=load, combination=rows))
    opened = sum(any(one.supports[0].gaps[at] > 0 for one in found.values()) for at in range(4))
    assert opened and envelope_json(found)["supports"][0]["lifted"] == opened  # type: ignore[index]


SOIL = """
plate = { shape = "rectangle", size = [4, 3], thickness = 0.3 }
material = { E = 30e9, nu = 0.2 }
mesh = { divisions = [4, 3] }
support = [{ name = "soil", area = "all", resists = "down", stiffness = 2e7 }]
load = [{ case = "G", pressure = 1e4 }, { case = "P", force = 1e5, at = [1, 1] }]
[[combination]]
name = "ULS"
generate = "patterns"
permanent = { G = [1, 1.1, 1.2, 1.35] }
variable = { P = [0.5, 1, 1.5] }
[output]
fields = []
envelope = ["deflection"]
"""


def test_a_table_on_soil_has_a_picture_of_the_largest_pressure_and_no_error_leaves_half_widths_out(
    tmp_path: Path,
) -> None:
    (tmp_path / "raft.toml").write_text(SOIL)
    done = CliRunner().invoke(app, ["solve", str(tmp_path / "raft.toml"), "--no-error", "-o", str(tmp_path / "out")])
    assert done.exit_code == 0, done.stderr
    written = json.loads((tmp_path / "out" / "results.json").read_text("utf-8"))
    assert written["envelope"]["plus_minus"] is None
    assert {"combination": None, "kind": "pressure", "file": "envelope-pressure.png"} in written["files"]
    assert (tmp_path / "out" / "envelope-pressure.png").read_bytes().startswith(b"\x89PNG")
    path = ["path", str(tmp_path / "raft.toml"), "--add", "P", "--from", "G", "--until", "1", "--steps", "2"]
    done = CliRunner().invoke(app, [*path, "--no-error", "-o", str(tmp_path / "path")])
    assert done.exit_code == 0 and "no ± (mesh.error)" in done.stdout


def test_progress_says_which_mesh_of_how_many_and_forecasts_the_rest() -> None:
    told: list[Progress] = []
    model = column(mesh={"size": 0.5})
    signorini.estimate(solve(model), progress=told.append)
    assert {now.mesh for now in told} == {2, 3} and {now.meshes for now in told} == {3}
    of_last = [now.left for now in told if now.mesh == 3]
    assert of_last and all(left >= 0.0 for left in of_last)
