"""Load paths as a user meets them: samples, named events, thresholds, the command, its files and its refusals."""

import csv
import itertools
import json
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from command import run
from models import rectangular
from slab_on_pads import SLAB

import signorini
from signorini.output import path_csv, path_json
from signorini.results.path_events import PathEvent, in_words
from signorini.results.support_points import margin_by_part


def test_the_command_prints_the_named_events_and_writes_every_stop(slab: Path) -> None:
    result = run("path", slab, "--from", "G", "--add", "Q", "--steps", 8, "--when", "prop[1].gap = 5e-4")
    assert result.exit_code == 0, result.output
    assert "pads: opens at [1, 3]" in result.output and "Equilibrium ends at t = 16" in result.output
    directory = slab.with_name("slab-path")
    assert sorted(file.name for file in directory.iterdir()) == ["path.csv", "path.json", "path.png"]
    found = json.loads((directory / "path.json").read_text())
    assert (found["from"], found["add"], found["ending"], found["events"]) == ("G", "Q", "no_equilibrium", [])
    assert found["end"] == pytest.approx(found["limit"], rel=2e-6) and found["certificate"]["passed"]
    assert found["interrupted"] is False and set(found["thresholds"][0]) == {"when", "t", "plus_minus"}
    at = [stop["t"] for stop in found["stops"]]
    events = {event["t"] for event in found["support_events"]}
    assert at[0] == 0 and at[-1] == found["end"] and events <= set(at)
    assert len(set(at) - events) >= 9
    for stop in found["stops"]:
        total = sum(support["reaction"] for support in stop["supports"])
        assert total == pytest.approx(80 + 10 * stop["t"], rel=1e-9)
        assert len(stop["probes"]) == 2
    with (directory / "path.csv").open(encoding="utf-8", newline="") as text:
        rows = list(csv.DictReader(text))
    assert [float(row["t"]) for row in rows] == at
    (row,) = [row for row in rows if row["event"] == "pads: opens at [1, 3]"]
    assert (row["closed:pads"], row["open:pads"], row["closed_part:pads"]) == ("3", "1", "0.75")
    assert float(rows[-1]["probe[2]:deflection"]) == found["stops"][-1]["probes"][1]["deflection"]


def test_the_files_have_the_reaction_of_every_point(slab: Path) -> None:
    found = signorini.path(signorini.load(slab), "G", "Q", steps=5)
    rows = list(csv.DictReader(path_csv(found).splitlines()))
    for name, count in (("pads", 4), ("prop", 1)):
        for number in range(1, count + 1):
            column = f"reaction_at:{name}[{number}]"
            assert [float(row[column]) for row in rows] == pytest.approx(found.table[column], rel=1e-9, abs=1e-9)
    for stop in path_json(found)["stops"]:
        pads, prop = stop["supports"]
        assert [point["at"] for point in pads["points"]] == [[1, 1], [3, 1], [3, 3], [1, 3]]
        assert sum(point["reaction"] for point in pads["points"]) == pytest.approx(pads["reaction"])
        assert prop["points"][0]["at"] == [2, 2]


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_named_events_of_points_are_those_of_the_exact_path(slab: Path, method) -> None:
    model = signorini.validate(tomllib.loads(SLAB) | {"solver": {"method": method}})
    exact, found = signorini.path(model, "G", "Q", events="all"), signorini.path(model, "G", "Q")
    said = [(event.support, event.at, event.change) for event in exact.support_events]
    assert [(event.support, event.at, event.change) for event in found.support_events] == said
    for one, other in zip(exact.support_events, found.support_events, strict=True):
        assert other.t == pytest.approx(one.t, abs=1e-9 * found.end)


def test_stops_are_at_the_t_that_are_asked_for_and_are_what_solve_gives(slab: Path) -> None:
    model = signorini.load(slab)
    found = signorini.path(model, "G", "Q", at=[1.5, 0.5, 1.0])
    assert (found.ending, found.end) == ("until", 1.5)
    assert {0.0, 0.5, 1.0, 1.5} <= {stop.t for stop in found.stops}
    (stop,) = [stop for stop in found.stops if stop.t == 1.0]
    direct = signorini.solve(model)["service"]
    assert stop.reactions == pytest.approx([*direct.reactions.values()], rel=1e-9, abs=1e-9)
    assert found.at(0.73).certificate.passed
    assert found.at(1.0).deflection == pytest.approx(direct.deflection, rel=1e-10)
    assert len(signorini.path(model, "G", "Q", until=1.0, steps=4).stops) >= 5


def test_thresholds_are_found_where_a_solve_has_the_value(slab: Path) -> None:
    asked = ["pads[2].reaction = 40", "probe[2].deflection=2e-4", " pads.reaction = 100 ", "pads[2].reaction = 1e9"]
    found = signorini.path(signorini.load(slab), "G", "Q", when=asked)
    first, second, third, never = found.thresholds
    assert found.at(first.t).supports[0].reactions[1] == pytest.approx(40, rel=1e-8)
    assert found.at(second.t).probes[1].deflection == pytest.approx(2e-4, rel=1e-6)
    assert found.at(third.t).reactions["pads"] == pytest.approx(100, rel=1e-8)
    assert never.t is None and (never.when, third.when) == (asked[3], "pads.reaction = 100")
    told = path_json(found)["thresholds"]
    assert told[-1] == {"when": asked[3], "t": None, "plus_minus": None}
    assert {stop.t for stop in found.stops} >= {first.t, second.t, third.t}
    assert any("probe[2].deflection=2e-4" in words for words in found.table["event"])


@pytest.mark.parametrize("events", ["named", "all"])
def test_a_threshold_at_the_limit_of_a_support_is_reached_where_it_yields(events: str) -> None:
    given = tomllib.loads(SLAB)
    given["support"] = [{"name": "anchors", "at": [[0, 0], [4, 0], [4, 4], [0, 4]], "stiffness": 1e4, "limit": 50}]
    given["support"].append({"name": "middle", "at": [2, 2], "stiffness": 1e3, "rotational_stiffness": 1e5})
    for value in (50.0, -50.0):
        given["combination"] = [{"name": "c", "factors": {"Q": math.copysign(1.0, value)}}]
        found = signorini.path(
            signorini.validate(given), None, "c", events=events, when=[f"anchors[1].reaction = {value}"], until=1e4
        )
        (yields,) = [one.t for one in found.support_events if one.change == "yields" and one.at == (0.0, 0.0)]
        assert found.thresholds[0].t == pytest.approx(yields, rel=1e-6)


def test_an_exact_path_has_thresholds_at_its_stops(slab: Path) -> None:
    found = signorini.path(signorini.load(slab), "G", "Q", events="all", when=["pads[2].reaction = 40"])
    (one,) = found.thresholds
    assert one.t in {stop.t for stop in found.stops} and signorini.estimate(found).elements == ()
    assert path_json(found)["plus_minus"] is None and path_json(found)["events"]


@pytest.mark.parametrize(
    ("arguments", "code", "message"),
    [
        (["--from", "G", "--add", "W"], 2, "Error: --add: Unknown load case or combination 'W'. This model has: G,"),
        (["--from", "X", "--add", "Q"], 2, "Error: --from: Unknown load case or combination 'X'."),
        (["--add", "Q", "--until", "1e300"], 2, "Error: --until: found 1e+300; it must be at most 1e+60."),
        (["--add", "Q", "--until", "nan"], 2, "Error: --until: found nan; it must be a finite number greater than 0."),
        (["--from", "Q", "--add", "G"], 3, "Q: The plate tips about the line"),
        (["--from", "G"], 2, "Missing option '--add'"),
        (["--from", "G", "--add", "nothing"], 2, '--add: the load "nothing" is zero'),
        (["--add", "Q", "--steps", "0"], 2, "--steps: found 0; it must be a whole number from 1 to"),
        (["--add", "Q", "--at", "1,b"], 2, "--at: found '1,b'; it must be numbers separated by commas"),
        (["--add", "Q", "--at", "1,-1"], 2, "--at: found -1; it must be a finite number greater than 0."),
        (["--add", "Q", "--at", "1", "--steps", "3"], 2, "--at: both steps and at are given; give one of them."),
        (["--add", "Q", "--events", "some"], 2, "--events: Unknown choice 'some'. It has: all, named."),
        (["--add", "Q", "--events", "all", "--steps", "3"], 2, "leave out steps and at."),
        (["--add", "Q", "--when", "pad[1].reaction = 3"], 2, "--when: Unknown quantity 'pad[1].reaction'."),
        (["--add", "Q", "--when", "pads[1].reaction"], 2, "it must be a name and a number, such as"),
        (["--add", "Q", "--when", "pads[1].reaction = much"], 2, "it must be a name and a number, such as"),
    ],
)
def test_what_cannot_be_followed_is_named(slab: Path, arguments: list[str], code: int, message: str) -> None:
    result = run("path", slab, *arguments)
    assert result.exit_code == code
    assert message in " ".join(result.output.split()) and "Traceback" not in result.output
    assert not slab.with_name("slab-path").exists()


def test_an_unknown_quantity_tells_what_there_is(slab: Path) -> None:
    with pytest.raises(signorini.InputError, match=r"Did you mean 'prop\[1\]\.gap'\?"):
        signorini.path(signorini.load(slab), "G", "Q", when=["prop[1].gop = 1"])
    with pytest.raises(signorini.InputError, match="when: it must be a list of texts"):
        signorini.path(signorini.load(slab), "G", "Q", when="prop[1].gap = 1")


def stopping(after: int):
    seen = []

    def watch(now) -> None:
        seen.append(now)
        if sum(str(one).startswith("t = ") and one.step == 0 for one in seen) > after:
            raise KeyboardInterrupt

    return watch


@pytest.mark.parametrize("events", ["named", "all"])
def test_an_interrupted_path_keeps_what_it_has(slab: Path, events) -> None:
    found = signorini.path(
        signorini.load(slab), "G", "Q", progress=stopping(2 if events == "all" else 12), events=events
    )
    assert found.interrupted and found.ending == "stopped" and 0 < found.end < 16
    told = path_json(found)
    assert told["interrupted"] is True and told["plus_minus"] is None and told["certificate"]["passed"]
    assert "interrupted" in found.plot().get_suptitle()


def test_an_interrupted_command_writes_what_it_has(slab: Path, monkeypatch) -> None:
    true = signorini.path
    monkeypatch.setattr(signorini, "path", lambda *a, **k: true(*a[:4], stopping(12), **k))
    result = run("path", slab, "--from", "G", "--add", "Q")
    assert result.exit_code == 130 and "Interrupted at t = " in result.output
    assert json.loads((slab.with_name("slab-path") / "path.json").read_text())["interrupted"] is True


def test_a_path_without_equilibrium_says_that_the_files_are_of_an_earlier_run(slab: Path) -> None:
    command = ["path", slab, "--from", "G", "--add", "Q", "--no-error"]
    assert run(*command).exit_code == 0
    directory = slab.with_name(f"{slab.stem}-path")
    earlier = (directory / "path.json").read_bytes()
    slab.write_text(SLAB.replace("pressure = ", "pressure = -"))
    done = run(*command)
    assert done.exit_code == 3
    assert done.stderr.startswith(f"No files are written; {directory} has the results of an earlier run.\n")
    assert (directory / "path.json").read_bytes() == earlier


def test_until_ends_the_path_and_at_keeps_to_it(slab: Path) -> None:
    found = signorini.path(signorini.load(slab), "service", "Q", until=2)
    assert (found.ending, found.end) == ("until", 2.0)
    printed = run("path", slab, "--from", "G", "--add", "Q", "--until", "2").output
    assert "Followed to t = 2. Equilibrium ends at t = 16" in printed
    printed = run("path", slab, "--add", "G", "--until", "2").output
    end = "Followed to t = 2. Equilibrium does not end for any t: the supports hold without limit."
    assert end in " ".join(printed.split())
    with pytest.raises(signorini.InputError, match="the path goes from 0 to 2"):
        found.at(2.5)
    with pytest.raises(signorini.InputError, match="until: found -1; it must be a finite number greater than 0"):
        signorini.path(found.model, "G", "Q", until=-1)


def test_what_holds_against_lifting_without_limit_is_named(slab: Path) -> None:
    slab.write_text(
        SLAB.replace('  { name = "prop"', '  { name = "pile", at = [2, 3], resists = "up" },\n  { name = "prop"')
    )
    printed = run("path", slab, "--from", "G", "--add", "G", "--until", "2").output
    end = "Equilibrium does not end for any t: the supports hold without limit; pile also against uplift."
    assert end in " ".join(printed.split())


def test_what_may_be_otherwise_at_one_t_is_said_of_that(slab: Path) -> None:
    printed = " ".join(run("path", slab, "--from", "G", "--add", "Q", "--at", "16").output.split())
    assert "At t = 16 the plate could rest elsewhere, turning about the line through [3, 2] along [0, 1]" in printed


@pytest.mark.parametrize("gap", [1e-3, 1e9], ids=["near", "far beyond any sense"])
def test_a_path_without_an_end_goes_to_where_nothing_more_happens(gap: float) -> None:
    stop = {"name": "stop", "at": [2, 2], "resists": "down", "gap": gap}
    model = rectangular(support=[{"edge": ["left", "right"], "fix": "simple"}, stop], load=[{"pressure": 1e3}])
    found = signorini.path(model, None, "load")
    (event,) = found.support_events
    assert (found.ending, event.support) == ("no_more_events", "stop") and event.t <= found.end <= 2 * event.t
    assert found.at(10 * found.end).certificate.passed
    assert event.t == pytest.approx(signorini.path(model, None, "load", events="all").events[0].t, rel=1e-8)


def test_a_path_ends_where_its_last_pieces_begin_however_large_the_load_is() -> None:
    """Reactions grow and deflections do not: their rounding opened and closed points up to t = 1e30."""
    settled = {"name": "wall", "edge": ["left", "right"], "resists": "down", "gap": "1e-4 * (1 + y)"}
    model = rectangular(
        support=[settled, {"name": "prop", "at": [2, 2], "resists": "down"}],
        load=[{"case": "G", "pressure": 0.01}, {"case": "Q", "at": [2, 2], "force": 100.0}],
    )
    followed, exact = (signorini.path(model, "G", "Q", events=events) for events in ("named", "all"))
    assert followed.ending == exact.ending == "no_more_events" and followed.end < 1e6


BED = """
units = { length = "m", force = "kN" }
material = { E = 30e6, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 4], thickness = 0.3 }
mesh = { divisions = [10, 10] }
support = [
  { name = "soil", area = "all", resists = "down", stiffness = 2e4 },
  { name = "prop", at = [0.2, 0.2], resists = "up", gap = 1.0 },
]
load = [{ case = "G", pressure = 8 }, { case = "Q", force = 100, at = [3.8, 3.8], patch = [0.4, 0.4] }]
"""


@pytest.fixture(scope="module")
def bedded(tmp_path_factory: pytest.TempPathFactory):
    """Output of a path of a plate on soil."""
    file = tmp_path_factory.mktemp("bed") / "bed.toml"
    file.write_text(BED)
    result = run("path", file, "--from", "G", "--add", "Q", "--until", 1.8)
    assert result.exit_code == 0, result.output
    directory = file.with_name("bed-path")
    rows = list(csv.DictReader((directory / "path.csv").open(encoding="utf-8", newline="")))
    return result.output, json.loads((directory / "path.json").read_text()), rows


def test_of_an_area_its_parts_are_events_and_not_its_points(bedded) -> None:
    shown, found, rows = bedded
    events = [event for event in found["support_events"] if event["support"] == "soil"]
    assert [(event["change"], event["closed"]) for event in events[1:]] == [("part closed", 0.75), ("part closed", 0.5)]
    assert events[0]["change"] == "begins to open" and len(events[0]["at"]) == 2
    table = [line for line in shown.splitlines() if " soil: " in line and line[0].isdigit()]
    t = [float(line.split()[0]) for line in table]
    assert t == sorted(t) and t == pytest.approx([event["t"] for event in events], rel=1e-5)
    assert "soil: opens on, 50 % closed" in table[2]
    assert len([row["event"] for row in rows if row["event"]]) == len(found["support_events"]) + 2


def test_a_part_closed_is_a_part_of_the_contact_area(bedded) -> None:
    _, found, rows = bedded
    half = next(event for event in found["support_events"] if event["closed"] == 0.5)
    (number,) = [number for number, stop in enumerate(found["stops"]) if stop["t"] == half["t"]]
    row, stop = rows[number], found["stops"][number]["supports"]
    tables = tomllib.loads(BED)
    solved = signorini.solve(
        signorini.validate(tables | {"combination": [{"name": "half", "factors": {"G": 1, "Q": half["t"]}}]})
    )
    soil = solved["half"].supports[0]
    for key, value in (("contact_area", soil.contact_area), ("max_pressure", soil.max_pressure)):
        assert float(row[f"{key}:soil"]) == stop[0][key] == pytest.approx(value, rel=1e-6)
        assert row[f"{key}:prop"] == "" and stop[1][key] is None
    assert stop[0]["closed_part"] == pytest.approx(0.5, abs=1e-5) and soil.contact_area == pytest.approx(8, abs=1e-4)
    assert soil.closed_part == pytest.approx(soil.contact_area / 16, rel=1e-12)


def test_a_solve_and_a_path_say_the_same_part_closed_of_a_line() -> None:
    model = rectangular(
        mesh={"divisions": [16, 16]},
        support=[{"name": "wall", "edge": ["left", "right"], "resists": "down", "stiffness": 1e5}],
        load=[{"case": "G", "pressure": 5}, {"case": "Q", "force": -30, "at": [0.3, 3.7], "patch": [0.4, 0.4]}],
    )
    found = signorini.path(model, "G", "Q", at=[1.0])
    part = found.at(1.0).supports[0].closed_part
    assert 0 < part < 1 and part == pytest.approx(found.stops[-1].parts[0], rel=1e-9)
    half_widths = signorini.estimate(found.at(1.0)).plus_minus
    assert half_widths["supports"][0]["closed_part"] < 0.1 and half_widths["supports"][0]["closed"] is None


def test_named_events_have_half_widths_from_the_same_events_on_coarser_meshes(bedded) -> None:
    _, found, rows = bedded
    half_widths = found["plus_minus"]["support_events"]
    for event, width in zip(found["support_events"], half_widths, strict=True):
        assert 0 < width["t"] < 0.1 * event["t"]
    assert found["plus_minus"]["events"] == []
    told = [row["t_plus_minus"] for row in rows if "soil" in row["event"]]
    assert [float(width) for width in told] == [one["t"] for one in half_widths]


def test_half_widths_cover_a_finer_mesh_and_never_come_from_one() -> None:
    tables = tomllib.loads(BED)
    coarse, fine = (
        signorini.path(
            signorini.validate(tables | {"mesh": {"divisions": [n, n]}}),
            "G",
            "Q",
            until=1.8,
            when=["soil.max_pressure = 70"],
        )
        for n in (12, 24)
    )
    compared = signorini.estimate(coarse)
    assert compared.elements == (144, 36, 9)
    for event, other, width in zip(coarse.support_events, fine.support_events, compared.events, strict=True):
        assert event.change == other.change and abs(event.t - other.t) <= width
    (one,), (other,), (width,) = coarse.thresholds, fine.thresholds, compared.thresholds
    assert abs(one.t - other.t) <= width


def test_a_mesh_that_cannot_be_coarsened_has_no_half_widths() -> None:
    model = rectangular(
        divisions=[1, 1],
        support=[{"name": "feet", "at": [[0, 0], [4, 0], [4, 4], [0, 4]], "resists": "down"}],
        load=[{"case": "G", "pressure": 1e3}, {"case": "Q", "force": 1e3, "at": [4, 4]}],
    )
    found = signorini.estimate(signorini.path(model, "G", "Q", until=1))
    assert found.elements == () and "this mesh cannot be coarsened" in found.warnings[0]


def test_a_path_warns_where_deflections_leave_the_theory_and_is_drawn_as_far(slab: Path) -> None:
    tables = tomllib.loads(SLAB)
    tables["load"][1]["at"] = [2.0, 2.5]
    found = signorini.path(signorini.validate(tables), "G", "Q", until=1e5)
    (warning,) = found.warnings
    assert "is beyond the thickness, 0.2 m" in warning
    assert path_json(found)["warnings"][0] == warning


def test_a_picture_goes_as_far_as_deflections_are_twice_the_thickness_of_a_thin_zone() -> None:
    model = rectangular(
        thickness=0.2,
        zone=[{"area": {"rectangle": [1, 1, 3, 3]}, "thickness": 0.05}],
        support=[{"name": "feet", "at": [[0, 0], [4, 0], [4, 4], [0, 4]], "resists": "down"}],
        load=[{"pressure": 1e3}],
    )
    found = signorini.path(model, None, "load", until=1e5)
    (warning,) = found.warnings
    assert "is beyond the thickness, 0.05" in warning
    drawn = np.abs([line.get_ydata() for line in found.plot().axes[-1].lines[:2]])
    assert drawn.max() == pytest.approx(0.1, rel=0.02)


def test_the_picture_shows_reactions_parts_thresholds_and_deflections(slab: Path) -> None:
    found = signorini.path(signorini.load(slab), "G", "Q", when=["pads[2].reaction = 40"])
    reactions, points, parts, deflections = found.plot().axes
    both = [*reactions.get_legend().get_texts(), *points.get_legend().get_texts()]
    shown = [", ".join(text.get_text().split("\n")) for text in both]
    assert sum(name.count("[") for name in shown) == 4 and any("prop" in name for name in shown)
    assert [text.get_text() for text in parts.get_legend().get_texts()] == ["pads", "prop"]
    assert [text.get_text() for text in deflections.get_legend().get_texts()] == ["at [2, 2]", "at [3.5, 3.5]"]
    said = {text.get_text() for text in reactions.texts}
    assert said >= {f"equilibrium ends at t = {found.limit:.6g}", "pads[2].reaction = 40"}
    assert reactions.get_xlim()[1] > found.limit
    assert {found.words(row) for row in found.events_at} & said
    colours = {line.get_label(): line.get_color() for line in reactions.lines if line.get_label()[0] != "_"}
    assert all(colours[line.get_label()] == line.get_color() for line in parts.lines if line.get_label() in colours)


def test_the_example_in_the_documentation_is_what_the_command_prints(tmp_path: Path) -> None:
    root = Path(__file__).parents[1]
    shown = run(
        "path", root / "examples" / "slab_on_points.toml", "--from", "slab", "--add", "machine", "-o", tmp_path / "out"
    )
    table = (root / "docs" / "paths.md").read_text("utf-8").split("```")[3].strip()
    assert table.startswith("t ") and all(line in shown.output for line in table.splitlines())


def test_points_that_resist_up_pull() -> None:
    bolts = PathEvent(row=1, t=0.5, support="bolts", at=(1.0, 2.0), change="closes", closed=0.5, opening=False)
    assert in_words([bolts], {"bolts"}) == "bolts: begins to pull at [1, 2]"
    assert in_words([bolts]) == "bolts: closes at [1, 2]"


def test_points_of_equal_margin_give_the_closed_part_of_a_line_in_any_order() -> None:
    """Points at one place in two elements once changed it by 2 %: rounding decided their order."""
    margin, length = np.array([0.3, 0.1, 0.1 * (1 - 1e-15), -0.2]), np.array([0.2, 0.5, 0.01, 0.29])
    at = [
        np.interp([0.1, 0.5, 0.705, 0.72, 0.9], *margin_by_part(margin[order], length[order]))
        for order in map(list, itertools.permutations(range(4)))
    ]
    assert np.ptp(at, axis=0).max() < 1e-14
