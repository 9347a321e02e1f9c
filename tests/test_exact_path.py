"""Load paths that follow every contact point: events, segments, jumps, and their checks."""

import itertools
import tomllib
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command import run
from models import rectangular
from slab_on_pads import SLAB

import signorini
from signorini import Model
from signorini.analysis import exact_path
from signorini.analysis.exact_path import confirmed
from signorini.output import path_csv, path_json

exact = partial(signorini.path, events="all")


@pytest.mark.parametrize(("across", "listed"), [(10, True), (11, False)])
def test_of_many_points_the_files_have_the_sum_alone(across: int, listed: bool) -> None:
    at = [[0.3 * i + 0.2, 0.3 * j + 0.2] for i in range(across) for j in range(10)]
    model = rectangular(
        support=[{"name": "feet", "at": at, "stiffness": 1e3}, {"name": "wall", "edge": "left", "fix": "simple"}],
        load=[{"case": "Q", "pressure": 5}],
    )
    found = exact(model, None, "Q", until=1)
    assert ("reaction_at:feet[1]" in path_csv(found).splitlines()[0]) == listed
    feet, wall = path_json(found)["stops"][-1]["supports"]
    assert ("points" in feet) == listed and "points" not in wall


def test_stops_show_what_a_direct_solution_shows(slab: Path) -> None:
    model = signorini.load(slab)
    found = exact(model, "G", "Q")
    for stop in found.stops:
        result = found.at(stop.t)
        assert stop.reactions == pytest.approx(list(result.reactions.values()), rel=1e-9, abs=1e-9)
        assert stop.deflections == pytest.approx([probe.deflection for probe in result.probes], rel=1e-9)
        assert (stop.largest, stop.smallest) == pytest.approx((result.deflection.max(), result.deflection.min()))
    whole = signorini.solve(model)["service"]
    assert found.at(1.0).deflection == pytest.approx(whole.deflection, rel=1e-10)


def test_a_path_has_the_table_and_the_envelope_that_combinations_have(slab: Path) -> None:
    found = exact(signorini.load(slab), "G", "Q")
    table = found.table
    assert table["t"].tolist() == [stop.t for stop in found.stops]
    assert table["event"][1] == "pads: opens at [1, 3]" and set(table["status"]) == {"solved"}
    assert table["reaction:pads"] == pytest.approx([stop.reactions[0] for stop in found.stops])
    combinations = signorini.solve(signorini.load(slab)).table
    assert {"t", "event"} == table.keys() - combinations.keys()
    assert {"combination", "factor:G", "factor:Q"} == combinations.keys() - table.keys()
    largest = found.envelope.fields["mx"].largest
    for t in np.linspace(0, found.end, 23):
        assert (found.at(t).moment[:, 0] <= largest + 1e-9 * largest.max()).all()
    row = found.envelope["reaction:pads"].max_by
    assert found.key(row) == found.end == max(found.governing)


def test_a_path_without_events_has_one_segment() -> None:
    model = rectangular(
        material={"E": 30e6, "nu": 0.2},
        divisions=[2, 2],
        support=[{"edge": "left", "fix": "clamped"}],
        load=[{"pressure": 1.0}],
    )
    found = exact(model, None, "load")
    (segment,) = found.segments
    assert (found.ending, found.limit, found.events) == ("no_more_events", np.inf, ())
    assert found.at(10 * segment.end.t).deflection == pytest.approx(10 * found.at(segment.end.t).deflection, rel=1e-9)


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_points_that_meet_the_soil_at_once_are_no_events_one_by_one(method) -> None:
    model = rectangular(
        thickness=0.1,
        divisions=[2, 2],
        support=[{"area": "all", "resists": "down", "stiffness": 1e6, "gap": 1e-3}],
        load=[{"pressure": 1e3}],
        solver={"method": method},
    )
    found = exact(model, None, "load", until=1)
    assert [stop.t for stop in found.stops] == [0, 1]
    assert found.stops[0].number(f"{found.model.support[0].name}.open") == 0
    assert found.at(1).deflection == pytest.approx(2e-3, rel=1e-9)


@pytest.mark.parametrize("method", ["lemke", "active_set"])
@pytest.mark.parametrize("factor", [1e-12, 1e-6, 1e6, 1e9, 1e13, 1e18])
def test_a_gap_closes_at_the_same_load_whatever_is_counted_as_one(factor, method) -> None:
    """A step that the load of t = 1 sets may be too short to tell that it closes."""
    model = rectangular(
        thickness=0.1,
        support=[{"edge": ["left", "right"], "fix": "clamped"}, {"at": [2, 2], "resists": "down", "gap": 1e-3}],
        load=[{"case": "Q", "pressure": 1e4}, {"case": "other unit", "pressure": 1e4 * factor}],
        solver={"method": method},
    )
    (event,) = exact(model, None, "Q").events
    (same,) = exact(model, None, "other unit").events
    assert same.t * factor == pytest.approx(event.t, rel=1e-9)


def on_a_rigid_bed(curvature=(1e-3, 1e-3, 0.0), **more) -> Model:
    return rectangular(
        thickness=0.1,
        support=[{"area": "all", "resists": "down"}],
        load=[{"case": "G", "pressure": 2e3}, {"case": "Q", "curvature": list(curvature)}],
        **more,
    )


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_rounding_of_a_load_without_a_resultant_makes_no_events(method) -> None:
    found = exact(on_a_rigid_bed(solver={"method": method}), "G", "Q")
    assert found.ending == "no_more_events" and found.end < 10
    assert found.stops[-1].number(f"{found.model.support[0].name}.closed") == 4
    assert [stop.reactions[0] for stop in found.stops] == pytest.approx([32e3] * len(found.stops), rel=1e-6)


def test_a_path_ends_where_its_reactions_are_nothing_but_rounding() -> None:
    found = exact(on_a_rigid_bed(), "G", "Q", until=1e13)
    assert found.ending == "stopped" and found.end < 2
    assert [stop.reactions[0] for stop in found.stops] == pytest.approx([32e3] * len(found.stops), rel=1e-6)


@pytest.mark.parametrize("wrong", [0, 2, 5])
def test_a_path_ends_before_the_first_stop_that_a_direct_solution_contradicts(wrong: int) -> None:
    found = exact(on_a_rigid_bed(curvature=(0.0, 0.0, 1e-3)), "G", "Q")
    stops = [
        replace(stop, values=750 * stop.values + 1e-3, work=750 * stop.work + 1.0) if k >= wrong else stop
        for k, stop in enumerate(found.stops)
    ]
    assert confirmed(found.problem, found._loads, found.stops, lambda now: None) == len(found.stops) > 5
    assert confirmed(found.problem, found._loads, stops, lambda now: None) == wrong


def test_what_nothing_presses_on_its_supports_is_refused() -> None:
    model = rectangular(
        thickness=0.1,
        divisions=[2, 2],
        support=[{"at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}],
        load=[{"case": "sun", "curvature": [1e-3, 0, 0]}],
    )
    with pytest.raises(signorini.InputError, match=r"nothing presses the plate .* Add its weight"):
        exact(model, None, "sun")


SEESAW = """
material = { E = 30e6, nu = 0.2 }
plate = { shape = "rectangle", size = [4, 1], thickness = 0.2 }
mesh = { divisions = [4, 1] }
support = [
  { name = "hinge", line = [[2, 0], [2, 1]], resists = "both" },
  { name = "left", at = [0, 0.5], resists = "down" },
  { name = "right", at = [4, 0.5], resists = "down", gap = 0.01 },
]
load = [{ case = "G", force = 1, at = [0, 0.5] }, { case = "Q", force = 1, at = [4, 0.5] }]
"""


def test_a_jump_is_said_in_the_table_and_the_notebook(tmp_path: Path) -> None:
    file = tmp_path / "seesaw.toml"
    file.write_text(SEESAW)
    shown = run("path", file, "--from", "G", "--add", "Q", "--until", 2, "--events", "all")
    assert shown.exit_code == 0, shown.output
    words = "left: opens at [0, 0.5]; the plate moves on its own until another support holds it"
    assert words in shown.output
    found = exact(signorini.load(file), "G", "Q", until=2)
    assert words in found._repr_html_() and found._repr_html_().count("<tr>") == 1 + len(found.stops)
    shown = np.array([found.table[f"reaction:{name}"] for name in ("hinge", "left", "right")]).T
    assert shown == pytest.approx(np.array([stop.reactions for stop in found.stops]), abs=1e-12)


def test_a_path_says_where_more_answers_than_one_are_right() -> None:
    """Two of four bearings stay under a force on the diagonal, and the plate may turn about the line through them."""
    model = rectangular(
        size=[10, 10],
        thickness=0.3,
        divisions=[8, 8],
        support=[{"name": "bearings", "at": [[1, 1], [9, 1], [9, 9], [1, 9]], "resists": "down"}],
        load=[{"case": "G", "pressure": 2e3}, {"case": "Q", "force": 1e4, "at": [0.2, 0.2]}],
    )
    found = exact(model, "G", "Q")
    ((begin, end, one),) = found.not_unique
    assert (begin, end, one.what) == (found.events[0].t, found.end, "deflection")
    assert one == found.at(0.5 * (begin + end)).not_unique[0]
    assert not found.at(0.5 * begin).not_unique
    (told,) = path_json(found)["not_unique"]
    assert (told["begin"], told["end"], told["motion"]) == (begin, end, one.motion)


FEET = [[2.5, 3.0], [2.0, 3.0], [2.5, 1.5], [3.0, 2.5], [2.0, 2.0], [0.801, 1.337]]


@pytest.mark.parametrize(
    ("gap", "feet"),
    [("0.0002*x", FEET), ("0.0002*y", FEET), ("0.0002*x + 0.001", FEET), ("0.0002*x", FEET[:3] + FEET[4:])],
)
def test_a_load_is_taken_off_to_the_last(gap, feet) -> None:
    """At t = 3 all reactions vanish and, since the gaps lie in a plane, so do all gaps that are left."""
    model = rectangular(
        thickness=0.3,
        divisions=[4, 8],
        support=[{"name": "feet", "at": feet, "resists": "down", "gap": gap}],
        load=[
            {"case": "G", "force": 20e3, "at": [1.5, 2.5]},
            {"case": "Q", "curvature": [-1e-4, 0, 0]},
            {"case": "W", "pressure": 5e3},
            {"case": "W", "force": 100e3, "at": [1.603, 2.232]},
        ],
        combination=[{"name": name, "factors": dict.fromkeys("GQW", t)} for name, t in (("all", 3), ("off", -1))],
    )
    found = exact(model, "all", "off")
    assert (found.ending, [stop.t for stop in found.stops]) == ("no_equilibrium", pytest.approx([0, 3], rel=1e-11))
    assert found.method == path_json(found)["method"] == "lemke"
    assert found.at(found.limit).reactions["feet"] == pytest.approx(0, abs=1e-6)


GAP = {"name": "feet", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down", "gap": 0.001}
HINGE = {"name": "hinge", "at": [[1, 2], [3, 2]], "resists": "both"}


@pytest.mark.parametrize("support", [[GAP], [GAP, HINGE]], ids=["free", "hinged"])
def test_where_a_path_begins_at_chooses_as_solve_does(support) -> None:
    """The stop shows where the path goes on from: the feet, on which the plate comes down."""
    model = rectangular(
        support=support,
        load=[{"case": "G", "pressure": 5e3}, {"case": "Q", "force": 50e3, "at": [2, 3.5]}],
        combination=[{"name": "none", "factors": {}}],
    )
    direct = signorini.solve(model)["none"]
    found = exact(model, None, "Q" if HINGE in support else "G")
    begin = found.at(0)
    assert direct.not_unique and begin.not_unique == direct.not_unique
    assert begin.deflection == pytest.approx(direct.deflection, abs=1e-15)
    assert found.stops[0].largest > 0.999e-3 and found.table["max:deflection"][0] == found.stops[0].largest
    assert not found.at(1e-3).not_unique


def test_a_path_that_stops_names_an_end_that_helps(slab: Path, monkeypatch) -> None:
    slab.write_text(SLAB.replace("[4, 4] }", "[4, 4], error = false }"))
    limit = exact(signorini.load(slab), "G", "Q").limit
    monkeypatch.setattr("signorini.analysis.exact_path.confirmed", lambda problem, loads, stops, watcher: 1)
    for until, helps in ((None, True), (limit, True), (0.9 * limit, False)):
        ends = () if until is None else ("--until", until)
        result = run("path", slab, "--from", "G", "--add", "Q", "--events", "all", *ends)
        said = " ".join(result.output.split())
        assert result.exit_code == 4 and "give rigid supports a stiffness" in said
        assert (f"--until {0.999 * limit:.6g}. Or use another mesh size" in said) is helps


ROUND_BED = """
material = { E = 30e9, nu = 0.2 }
plate = { shape = "rectangle", size = [10, 10], thickness = 0.3 }
mesh = { divisions = [4, 4], error = false }
support = [{ area = { circle = { center = [5, 5], radius = 4.3 } }, resists = "down", stiffness = 3e7 }]
load = [{ case = "G", force = 1e5, at = [5, 5] }, { case = "Q", force = 1e5, at = [9.3847, 6.0123] }]
"""


def test_where_a_coarse_mesh_ends_short_of_an_outline_the_path_says_so(tmp_path: Path) -> None:
    file = tmp_path / "bed.toml"
    file.write_text(ROUND_BED)
    found = exact(signorini.load(file), "G", "Q")
    assert found.ending == "stopped" and found.ends_with_the_mesh
    assert found.end == pytest.approx(found.mesh_limit, rel=1e-6) and found.mesh_limit < 0.99 * found.limit
    result = run("path", file, "--from", "G", "--add", "Q", "--events", "all")
    assert result.exit_code == 4 and "reactions at the contact points of this mesh do not" in " ".join(
        result.output.split()
    )


@pytest.mark.parametrize("stiffness", [1e2, 1e4])
def test_a_path_from_no_load_does_not_depend_on_how_large_the_load_is(stiffness) -> None:
    """At t = 0 the plate lies on a soft stop without force; events may be at t = 1e-12."""
    events = []
    for pressure in (1e6, 1e3, 1.0, 1e-3):
        model = rectangular(
            support=[
                {"edge": "left", "stiffness": 1e6},
                {"edge": "right", "resists": "down", "settlement": 1e-6},
                {"at": [3, 3], "gap": 1e-11, "stiffness": stiffness},
            ],
            load=[{"pressure": pressure}],
        )
        found = exact(model, start=None, add="load")
        assert found.ending == "no_more_events"
        events.append([pressure * event.t for event in found.events])
    assert np.array(events) == pytest.approx(np.tile(events[0], (4, 1)), rel=1e-6)


def test_the_end_is_known_without_following_the_path_and_of_cases_that_grow_together(slab: Path) -> None:
    tables = tomllib.loads(slab.read_text())
    tables["load"].append({"case": "R", "force": 5, "at": [3.9, 2.0]})
    tables["combination"].append({"name": "both", "factors": {"Q": 1, "R": 1}})
    model = signorini.validate(tables)
    alone, whole = (exact(model, "G", "both", until=until) for until in (1e-6, None))
    assert (alone.end, len(alone.stops), whole.ending) == (1e-6, 2, "no_equilibrium")
    assert alone.limit == pytest.approx(whole.end, rel=1e-6)


def lifting():
    tables = tomllib.loads(ROUND_BED)
    tables["mesh"], tables["load"][1]["at"] = {"divisions": [4, 4]}, [9.3, 6]
    tables["support"].append({"at": [[1, 1], [9, 9]], "resists": "down", "gap": 1e-4})
    return exact(signorini.validate(tables | {"probe": [{"at": [2, 3]}]}), "G", "Q", 0.5)


def test_areas_in_contact_of_many_stops_are_those_of_each_result() -> None:
    found = lifting()
    for stop in found.stops[10:60:10]:
        area = found.at(stop.t).supports[0].contact_area
        shown = stop.number(f"{found.model.support[0].name}.contact_area")
        assert shown == pytest.approx(area, rel=1e-9) and 1 < area < np.pi * 4.3**2 - 1


@pytest.mark.parametrize("wrong", [5, 64])
def test_a_stop_that_is_not_certified_ends_the_path_wherever_it_stands_among_others(monkeypatch, wrong: int) -> None:
    judged, seen = exact_path.certify_each, [0]

    def failing(*arguments):
        found = judged(*arguments)
        row = wrong - seen[0]
        if 0 <= row < len(found):
            found[row] = replace(found[row], equilibrium=1.0)
        seen[0] += len(found)
        return found

    whole = lifting()
    monkeypatch.setattr(exact_path, "certify_each", failing)
    monkeypatch.setattr("signorini.analysis.exact_path.posed_for_methods", lambda problem: [problem])
    cut = lifting()
    assert cut.ending == "stopped" and cut.certificate.passed
    assert [stop.t for stop in cut.stops] == [stop.t for stop in whole.stops[:wrong]]


def test_a_plate_on_a_round_bed_does_not_move_on_its_own():
    # Points of next to no weight between arcs and the sides that stand for them opened within rounding of each other.
    model = Model(
        material={"E": 30e9, "nu": 0.2, "unit_weight": 25e3},
        plate={"shape": "disc", "radius": 2, "thickness": 0.3},
        mesh={"size": 0.8, "error": False},
        support=[{"area": {"circle": {"center": [0, 0], "radius": 1.6}}, "resists": "down", "stiffness": 5e7}],
        load=[{"case": "G", "self_weight": True}, {"case": "H", "force": 1e4, "at": [1.5, 0.2], "radius": 0.3}],
        combination=[{"name": "G", "factors": {"G": 1}}],
    )
    found = exact(model, "G", "H")
    assert found.ending == "no_more_events"
    assert not any(segment.jumps for segment in found.segments)


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_stops_far_away_hide_no_events(method) -> None:
    """A gap of 1e9 m must not make deflections of millimetres rounding, so that the plate passes its prop."""

    def events(*stops):
        model = rectangular(
            thickness=0.1,
            support=[
                {"edge": ["left", "right"], "fix": "simple"},
                {"at": [[2, 2], [1, 3]], "resists": "down", "gap": 1e-3},
                *stops,
            ],
            load=[{"pressure": 1e3}],
            solver={"method": method},
        )
        return [event.t for event in exact(model, None, "load", until=100).events]

    assert len(events()) == 2
    assert events({"at": [1, 1], "resists": "up", "gap": 1e9}) == pytest.approx(events(), rel=1e-9)


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_soil_far_softer_than_the_plate_has_the_events_of_the_deflection_alone(method) -> None:
    """The reactions of its props must not make those of the soil rounding, so that it has no events."""

    def events(stiffness: float) -> list[float]:
        model = rectangular(
            support=[
                {"at": [[0.1, 0.3], [0.1, 3.7], [3.9, 0.3], [3.9, 3.7]], "resists": "both"},
                {"area": {"rectangle": [1, 0, 3, 4]}, "resists": "down", "stiffness": stiffness},
            ],
            load=[{"case": "G", "pressure": 1e3}, {"case": "Q", "pressure": "-1e3*(x + 0.2*y)"}],
            solver={"method": method},
        )
        return [stop.t for stop in exact(model, "G", "Q").stops[:-1]]

    harder = events(10.0)
    assert len(harder) > 90
    assert events(1e-6) == pytest.approx(harder, rel=1e-5)


@pytest.mark.parametrize("ways", [("down", "up"), ("down", "both"), ("up", "down", "both")])
def test_supports_that_share_by_the_sign_are_linear_between_stops(ways) -> None:
    """A path stops where the reaction of a place that is held from both sides changes sign, as `solve` shares it."""
    place = {"at": [[0.7, 0.6], [3.3, 0.9], [3.1, 3.4], [0.8, 3.2]]}
    model = rectangular(
        mesh={"divisions": [5, 5], "error": False},
        support=[{"name": f"{way} {i}", **place, "resists": way} for i, way in enumerate(ways)],
        load=[{"case": "G", "pressure": 5e3}, {"case": "Q", "force": -1e5, "at": [3.5, 2.5]}],
        combination=[{"name": "both", "factors": {"G": 1, "Q": 0.5}}],
    )
    found = exact(model, "G", "Q", until=2.0)
    assert found.ending == "until" and len(found.stops) == 4
    for begin, end in itertools.pairwise(found.stops):
        middle = found.at(0.5 * (begin.t + end.t))
        shown = np.array(list(middle.reactions.values()))
        assert shown == pytest.approx(0.5 * (begin.reactions + end.reactions), abs=1e-9 * np.abs(shown).max())
    direct = signorini.solve(model)["both"]
    for support, other in zip(found.at(0.5).supports, direct.supports, strict=True):
        assert support.reactions == pytest.approx(other.reactions, abs=1e-8 * np.abs(other.reactions).max(initial=1))


def test_supports_at_the_same_points_open_and_close_together() -> None:
    """At a stop, points that open there are closed in the least-norm answer; the next stop once had the event."""
    tables = tomllib.loads(SLAB)
    pads, prop = tables["support"]
    tables["support"] = [pads, prop, {**pads, "name": "doubled"}]
    single, double = (exact(Model.model_validate(one), "G", "Q") for one in (tomllib.loads(SLAB), tables))
    of = {
        name: [(e.t, e.change, e.at) for e in double.support_events if e.support == name]
        for name in ("pads", "doubled")
    }
    alone = [(e.t, e.change, e.at) for e in single.support_events if e.support == "pads"]
    assert alone and of["pads"] == of["doubled"]
    assert [e[1:] for e in of["pads"]] == [e[1:] for e in alone]
    assert [e[0] for e in of["pads"]] == pytest.approx([e[0] for e in alone], rel=1e-9)
