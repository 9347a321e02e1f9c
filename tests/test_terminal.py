"""Terminal output: it fits, breaks no number, names governing combinations, and ends quietly."""

import io
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from models import rectangular
from rich.console import Console
from typer.testing import CliRunner

import signorini
from signorini import estimate
from signorini.analysis.check import check
from signorini.base.numbers import estimated, number
from signorini.cli import app
from signorini.cli.events import print_path
from signorini.cli.grid import Column, Grid, numbers
from signorini.cli.tables import print_check, print_results
from signorini.errors import point
from signorini.output.envelope_json import envelope_json

EXAMPLES = Path(__file__).parents[1] / "examples"
WIDE = 100_000


def model(count: int, **changes: object) -> signorini.Model:
    data = {
        "title": "Slab on pads, with a title that is longer than a narrow terminal shows on a line",
        "units": {"length": "m", "force": "kN"},
        "material": {"E": 30e6, "nu": 0.2},
        "support": [
            {"name": "pads", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"},
            {"name": "prop in the middle", "at": [2, 2], "resists": "down", "gap": 1e-3, "stiffness": 1e4},
            {"name": "soil", "area": {"rectangle": [0, 0, 1, 1]}, "resists": "down", "stiffness": 1e3},
        ],
        "load": [{"case": "G", "pressure": 5.123}, {"case": "Q", "force": 80, "at": [0.2, 0.3]}],
        "combination": [
            {"name": f"ULS {i + 1}: 1.35 G + {i / 8} Q", "factors": {"G": 1.35, "Q": i / 8}} for i in range(count)
        ],
        "section": [{"name": "beside the prop", "line": [[2.1, 0], [2.4, 4]]}],
        "strip": [{"name": "over the pads", "line": [[0, 1], [4, 1]], "width": 1.5}],
        "probe": [{"at": [[2, 2], [1 / 3, 1 / 3], [3.5, 2.25]]}],
    }
    return rectangular(**data | changes)


def shown(printed: object, found: object, width: int, widths: object = None) -> str:
    console = Console(file=io.StringIO(), width=width, markup=False, highlight=False, emoji=False, soft_wrap=True)
    if printed in (print_results, print_path):
        asked = found.model.estimated  # type: ignore[attr-defined]
        printed(console, found, widths or estimate(found) if asked else None)  # type: ignore[operator, call-overload]
    else:
        printed(console, found)  # type: ignore[operator]
    return console.file.getvalue()  # type: ignore[attr-defined,no-any-return]


def figures(text: str) -> set[str]:
    """Every number with more than three digits, whole words only."""
    return set(re.findall(r"(?<!\S)-?\d[\d.]{3,}(?:e[-+]\d+)?(?!\S)", text))


def held(printed: object, found: object) -> None:
    widths = estimate(found) if printed in (print_results, print_path) else None  # type: ignore[call-overload]
    wide = shown(printed, found, WIDE, widths)
    for width in (40, 80, 120):
        text = shown(printed, found, width, widths)
        assert max(map(len, text.splitlines())) <= width
        assert figures(text) >= figures(wide), (width, figures(wide) - figures(text))


@pytest.mark.parametrize("count", [1, 40])
def test_no_number_is_broken_on_a_terminal_of_any_width(count: int) -> None:
    results = signorini.solve(model(count))
    held(print_results, results)
    held(print_check, check(results.discretisation.model))


def test_nor_in_a_path() -> None:
    held(print_path, signorini.path(model(1), add="Q", start="G", until=1))


@pytest.mark.parametrize("file", ["slab_on_points", "base_plate", "disc_on_ring"])
def test_nor_in_the_examples(file: str) -> None:
    held(print_check, check(signorini.load(EXAMPLES / f"{file}.toml")))


def test_a_table_drops_spare_columns_and_then_turns() -> None:
    grid = Grid([Column("support"), Column("kind", spare=True), *numbers("reaction [kN]", "gap [m]")])
    for name in ("pads", "props"):
        grid.add(name, "points, pushes up only, rigid", "-1234.5678", "0.000123456")
    lines = {width: shown(lambda console, _: grid.show(console), None, width).splitlines() for width in (80, 40, 30)}
    assert lines[80][0].split() == ["support", "kind", "reaction", "[kN]", "gap", "[m]"]
    assert lines[40][0].split() == ["support", "reaction", "[kN]", "gap", "[m]"]
    assert [line.split()[0] for line in lines[30] if line[:1].isalpha()][:4] == ["support", "kind", "reaction", "gap"]
    for each in lines.values():
        assert sum("-1234.5678" in line for line in each) in (1, 2)


@pytest.mark.parametrize(("count", "first"), [(2, "solved by"), (3, "largest deflection [m]"), (13, "field")])
def test_from_three_combinations_on_a_summary_stands_for_them(count: int, first: str) -> None:
    lines = shown(print_results, signorini.solve(model(count)), 200).splitlines()
    assert any(first in line for line in lines[3:6])
    assert (first in lines[3]) == (count <= 3)
    assert any("solved by" in line for line in lines) == (count < 3)
    governing = [line for line in lines if line.startswith("largest pads[1]")]
    assert len(governing) == (count >= 3)
    if governing:
        # The largest reaction comes with the largest Q; beside it those of the five others, each with its ± but zeros.
        assert f"ULS {count}: 1.35 G + {(count - 1) / 8} Q" in governing[0]
        cells = governing[0].partition(" Q ")[2].replace(" ± ", "±").split()
        assert len(cells) == 6 and all("±" in one or one == "0" for one in cells)


def test_extremes_of_many_combinations_are_shown_with_their_half_widths() -> None:
    results = signorini.solve(model(13, mesh={"divisions": [4, 4]}))
    found = envelope_json(results, estimate(results))
    assert found is not None
    widths = found["plus_minus"]
    lines = shown(print_results, results, WIDE).splitlines()

    def line(start: str) -> str:
        return next(one for one in lines if one.startswith(start))

    for name, title in (("deflection", "deflection [m]"), ("mx", "moment mx [kN m/m]"), ("qy", "shear qy [kN/m]")):
        own, width = found["fields"][name], widths["fields"][name]
        size = max(abs(own["max"]), abs(own["min"]))
        for side in ("max", "min"):
            assert estimated(own[side], width[side], size) in line(title)
    pads, soil = found["supports"][0], found["supports"][2]
    for side in ("max", "min"):
        assert estimated(pads["reaction"][side], widths["supports"][0]["reaction"][side]) in line("pads ")
    pressure = estimated(soil["max_pressure"]["max"], widths["supports"][2]["max_pressure"]["max"])
    assert line("soil: largest pressure").startswith(f"soil: largest pressure {pressure} kN/m² at [0, 0] in ULS 13")
    assert any(re.match(r"pads: widest gap [\d.e-]+ ± [\d.e-]+ m at ", one) for one in lines)
    assert any("certificate checks" in one and "(meshes of 256, 64 and 16 elements)" in one for one in lines)


@pytest.mark.parametrize("count", [3, 13])
def test_of_many_bearings_it_is_said_where_the_governing_reactions_are(count: int) -> None:
    feet = {"name": "feet", "at": [[x, y] for x in range(4) for y in range(4)], "resists": "down"}
    results = signorini.solve(model(count, support=[feet], mesh={"divisions": [2, 2], "error": False}))
    lines = shown(print_results, results, WIDE).splitlines()
    assert "16 bearings: governing.csv has the largest and smallest reaction of each" in lines
    assert not any(one.startswith("largest feet[") for one in lines)


def test_point_reactions_are_shown_and_noise_is_zero() -> None:
    assert (number(-1.7e-10, 8109.0), number(1.7e-3, 8109.0)) == ("0", "0.0017")
    assert point([-5.7985, -1.4e-14], 12.0) == "[-5.7985, 0]"
    results = signorini.solve(model(1, mesh={"divisions": [4, 4], "error": False}))
    lines = shown(print_results, results, 200).splitlines()
    result = results["ULS 1: 1.35 G + 0.0 Q"]
    rows = [line.split() for line in lines if line.startswith("pads[")]
    assert [float(row[3]) for row in rows] == pytest.approx(result.supports[0].reactions, rel=1e-5)
    (prop,) = (line for line in lines if line.startswith("prop in the middle "))
    assert prop.split()[-3:] == ["0", number(float(result.supports[1].gaps[0])), "open"]


def test_the_largest_moments_and_shears_of_every_combination_are_shown() -> None:
    """With their places and half-widths, and where they are larger still."""
    results = signorini.solve(model(2, units={"length": "m", "force": "kN"}))
    widths: Any = estimate(results)
    lines = shown(print_results, results, WIDE).splitlines()
    rows = [line for line in lines if line.startswith("moment mx [kN m/m]") and line.endswith("]")]
    for row, result in zip(rows, results.values(), strict=True):
        ends, width = result.extremes["mx"], widths[result.name].plus_minus["fields"]["mx"]
        for side, at in (("max", ends.max_at), ("min", ends.min_at)):
            assert estimated(getattr(ends, side), width[side], float(np.abs(result.moment).max()), 5) in row
            assert point(at, result.mesh.size) in row
    left_out = [line for line in lines if line.startswith("Excluded from extremes")]
    assert left_out
    assert all("moments and shears within 0.2 m of " in line and "pads at a point" in line for line in left_out)


def test_supports_that_are_rigid_and_limits_of_equilibrium_are_told() -> None:
    stand = {"name": "stand", "at": [[1, 1], [3, 1], [2, 3]]}
    results = signorini.solve(model(1, support=[stand]))
    shown_ = shown(print_results, results, 60)
    assert "◆ holds both ways  without ~: rigid" in shown_
    legs = {"name": "legs", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}
    results = signorini.solve(model(2, support=[legs]))
    case, factor = results.limits["ULS 2: 1.35 G + 0.125 Q"]
    assert f"Equilibrium ends at {factor:.4g} × the factored case {case}, other cases unchanged" in shown(
        print_results, results, WIDE
    )


@pytest.mark.parametrize("count", [2, 30])
def test_a_check_asks_for_limits_of_the_first_rows_of_a_table_too(count: int) -> None:
    legs = {"name": "legs", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}
    found = check(model(count, support=[legs]))
    assert found.resultants[1].limit == signorini.solve(model(2, support=[legs])).limits["ULS 2: 1.35 G + 0.125 Q"]
    assert "not asked" not in shown(print_check, found, WIDE)


def test_what_is_nothing_is_shown_as_nothing() -> None:
    """A plate at rest on soil has moments, pressures' changes and gaps by rounding."""
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e4}
    results = signorini.solve(
        model(1, support=[soil], load=[{"case": "G", "pressure": 5}, {"case": "Q", "pressure": 1}])
    )
    lines = shown(print_results, results, WIDE).splitlines()
    text = "\n".join(line for line in lines if not line.startswith("certificate"))
    assert not re.search(r"\de-(1[3-9]|[2-9]\d)", text)
    assert "0 ± 0" not in text


def test_warnings_are_printed_once_after_the_tables() -> None:
    thick = signorini.solve(model(2, material={"E": 3e3, "nu": 0.2}))
    lines = shown(print_results, thick, WIDE).splitlines()
    said = [line for line in lines if line.startswith("Warning")]
    assert len([line for line in said if "E = 3000 kN/m²" in line]) == 1
    assert lines.index(said[0]) > max(i for i, line in enumerate(lines) if line.startswith("certificate"))
    assert any(re.match(r"Warning \(ULS 2: 1.35 G \+ 0.125 Q\): The deflection at ", line) for line in said)
    assert "Warning: E = 3000 kN/m²" in shown(print_check, check(thick.discretisation.model), WIDE)


@pytest.mark.parametrize("command", [[], ["solve"], ["check"], ["path"], ["schema"]])
def test_help_has_an_example_and_is_not_cut(command: list[str]) -> None:
    text = CliRunner().invoke(app, [*command, "--help"], env={"COLUMNS": "80"}, terminal_width=80).stdout
    assert f"Example: signorini {command[0] if command else 'solve'} " in " ".join(text.split())
    assert "..." not in text.replace("[ARGS]...", "")


@pytest.mark.skipif(os.name == "nt", reason="a closed pipe is of POSIX")
@pytest.mark.parametrize(("factor", "code"), [(1, 0), (-1, 3)])
def test_head_ends_a_run_quietly_with_its_code(tmp_path: Path, factor: int, code: int) -> None:
    support = '[[support]]\nat = [[1, 1], [3, 1], [2, 3]]\nresists = "down"\n'
    (tmp_path / "slab.toml").write_text(
        'title = "first"\nmaterial = { E = 30e9, nu = 0.2 }\n'
        'plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }\nmesh = { divisions = [2, 2] }\n'
        f'{support}[[load]]\npressure = 1e3\n[[combination]]\nname = "a"\nfactors = {{ load = 1 }}\n'
        f'[[combination]]\nname = "b"\nfactors = {{ load = {factor} }}\n'
    )
    command = f"{sys.executable} -m signorini solve slab.toml | head -1; exit ${{PIPESTATUS[0]}}"
    done = subprocess.run(["bash", "-c", command], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (code, "first\n")
    assert (done.stderr == "") == (code == 0) and "Traceback" not in done.stderr and "Errno" not in done.stderr


def test_places_without_a_limit_are_named_with_the_case_of_their_load() -> None:
    said = shown(print_results, signorini.solve(model(2)), WIDE)
    (line,) = [line for line in said.splitlines() if line.startswith("Singular")]
    assert 'Force at a point of load[2] (case "Q") at [' in line and "pads at a point at [1, 1] and 3 more" in line
    assert line.endswith("All in results.json.")


def test_what_is_in_contact_is_told_of_how_much_and_the_largest_pressure_where() -> None:
    wall = {"name": "wall", "edge": "left", "resists": "down", "stiffness": 1e5}
    soil = {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e4}
    load = [{"pressure": 5}, {"force": -18, "at": [0.3, 3.7], "patch": [0.4, 0.4]}]
    results = signorini.solve(rectangular(units={"length": "m"}, support=[wall, soil], load=load))
    (result,), said = results.values(), shown(print_results, results, WIDE)
    part = result.supports[0].closed_part
    assert 0 < part < 1
    # The edge of contact is between the last closed point and the first open one, which are 0.5 m apart at most.
    assert part * 4 == pytest.approx(result.supports[0].weights[result.supports[0].closed].sum(), abs=0.5)
    assert f"wall: in contact on {100 * part:.3g} % of its length, {4 * part:.6g} of 4 m" in said
    area = result.supports[1]
    assert f"soil: in contact on {100 * area.contact_area / 16:.3g} % of its area, " in said
    assert " of 16 m²; largest pressure" in said
    (lifted,) = [line for line in said.splitlines() if "has lifted" in line]
    assert lifted.startswith("the plate has lifted at its corner [0, 4] by ") and lifted.endswith(" mm")
    node = int(np.hypot(*(result.mesh.points - [0, 4]).T).argmin())
    assert float(lifted.split()[-2]) == pytest.approx(-1e3 * result.deflection[node], rel=5e-3)
    x, y = area.max_pressure_at
    assert f" at {point((x, y), 4.0)}" in said.split("largest pressure")[1].splitlines()[0]
    assert result.pressure([[x, y]])[0] == pytest.approx(area.max_pressure, rel=1e-9)


def test_of_a_support_along_which_others_hold_the_plate_nothing_is_in_contact() -> None:
    """Nothing of 0 m ended in a division by zero."""
    ring = {"circle": {"radius": 2}, "resists": "down", "gap": 4e-4, "stiffness": 1e6}
    held = signorini.Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "disc", "radius": 4, "thickness": 0.8},
        mesh={"size": 1.2, "error": False},
        support=[{"circle": {"radius": 2}}, {"name": "ring", **ring}],
        load=[{"pressure": 1e3}],
    )
    shown = io.StringIO()
    print_results(Console(file=shown, width=WIDE), signorini.solve(held), None)
    assert "ring: the plate is held by other supports everywhere on it" in shown.getvalue()


def test_a_single_bearing_has_no_others() -> None:
    said = shown(print_results, signorini.solve(model(13, support=[{"area": "all", "stiffness": 1e4}])), WIDE)
    assert "other bearings in that combination" not in said and "largest reaction" in said


@pytest.mark.parametrize("count", [1, 13])
def test_where_half_widths_are_wide_it_is_said_once_what_helps(count: int) -> None:
    load = [{"case": "G", "pressure": 5.0}, {"case": "Q", "force": 80, "at": [2.1, 2.2], "patch": [0.3, 0.3]}]
    made = [{"name": f"c{i}", "factors": {"G": 1, "Q": 1 + i}} for i in range(count)]
    held = [{"edge": ["left", "right", "bottom", "top"], "fix": "clamped"}]
    given = {"size": (10, 10), "load": load, "support": held, "combination": made}
    said = shown(print_results, signorini.solve(rectangular(**given, mesh={"size": 0.5})), WIDE)
    (told,) = re.findall(r"± is more than half of the largest (.*): the mesh is too coarse there\. Use", said)
    assert "qx at [1.95, 2.2]" in told
    finer = rectangular(**given, mesh={"size": 0.5, "refine": [{"at": [2.1, 2.2], "size": 0.05}]})
    assert "± is more than half" not in shown(print_results, signorini.solve(finer), WIDE)


def test_of_many_points_the_largest_and_those_that_are_open_are_shown() -> None:
    many = {"name": "feet", "at": [[x, y] for x in range(5) for y in range(5)], "resists": "down"}
    results = signorini.solve(model(2, support=[many], mesh={"divisions": [4, 4], "error": False}))
    result = results["ULS 2: 1.35 G + 0.125 Q"]
    (support,) = result.supports
    lines = shown(print_results, results, WIDE).splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("ULS 2: 1.35 G + 0.125 Q: solved"))
    rows = [line.split() for line in lines[at:] if line.startswith("feet[")]
    wanted = sorted(np.abs(support.reactions))[-20:]
    assert sorted(float(row[3]) for row in rows) == pytest.approx(wanted, rel=1e-5, abs=1e-9)
    assert "and 5 more points with smaller reactions, all in reactions.csv" in lines[at:]
    assert any(line.startswith("feet, open: [") for line in lines[at:]) == (0 < support.open_count <= 8)
