"""The shipped examples, each with its purpose."""

import importlib.util
import re
import tomllib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import signorini
from signorini.discretise import discretise

EXAMPLES = Path(__file__).parents[1] / "examples"

# MITC4, 160 x 160, in kN; rows from y = 0.5.
SLAB_B = np.array([333.96, 93.67, 0, 5.85, 93.67, 71.92, 7.92, 14.01, 0, 7.92, 21.46, 11.79, 5.85, 14.01, 11.79, 6.17])


def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def slab() -> signorini.Results:
    return signorini.solve(signorini.load(EXAMPLES / "slab_on_points.toml"))


def slab_under(pressure: float) -> signorini.Model:
    data = tomllib.loads((EXAMPLES / "slab_on_points.toml").read_text())
    data["load"][0]["pressure"] = pressure
    return signorini.validate(data)


def documented(message: str) -> bool:
    return f"> {message}\n" in (EXAMPLES.parent / "docs" / "results.md").read_text("utf-8")


def test_every_example_has_a_test() -> None:
    # tests/validation/test_triangles.py runs triangle_mesh.
    tested = Path(__file__).read_text()
    assert [p.name for p in EXAMPLES.iterdir() if p.suffix in (".py", ".toml") and p.stem not in tested] == []


def test_slab_b_lifts_off_exactly_two_of_its_bearings(slab: signorini.Results) -> None:
    bearings = slab["service"].supports[0]
    assert bearings.positions[~bearings.closed].tolist() == [[6.5, 0.5], [0.5, 6.5]]
    assert (bearings.reactions[~bearings.closed] == 0).all()
    assert (bearings.gaps[~bearings.closed] > 0).all()
    assert bearings.reaction == pytest.approx(700e3, rel=1e-12)


def test_slab_b_has_the_reactions_of_the_reference(slab: signorini.Results) -> None:
    # The coarser mesh moves the small reactions more, by up to 1.9 % of themselves and 0.1 % of the largest.
    reactions = slab["service"].supports[0].reactions / 1e3
    assert np.abs(reactions - SLAB_B).max() < 1e-3 * SLAB_B.max()
    large = SLAB_B > 10
    assert np.abs(reactions[large] / SLAB_B[large] - 1).max() < 0.015


def test_a_slab_that_touches_nothing_at_first_comes_down_by_its_gap(slab: signorini.Results) -> None:
    lowered = signorini.solve(signorini.load(EXAMPLES / "slab_on_points_gap.toml"))
    for name, result in slab.items():
        a, b = result.supports[0], lowered[name].supports[0]
        assert np.abs(a.reactions - b.reactions).max() < 1e-9 * a.reactions.max()
        assert (a.closed == b.closed).all()
        assert np.abs(lowered[name].deflection - result.deflection - 1e-3).max() < 1e-12


def test_a_slab_under_slight_suction_tips(slab: signorini.Results) -> None:
    with pytest.raises(signorini.NoEquilibriumError) as caught:
        signorini.solve(slab_under(-4e3))
    service, alone = str(caught.value).splitlines()
    assert "service: The plate tips about the line" in service
    assert "through [0.5, 0.5] of bearings" in service
    # About the diagonal through the bearing: 400 kN up at (5, 5) and 500 kN down at (1, 1).
    assert f"short by a moment of {(400e3 * 9 - 500e3) / np.sqrt(2):.6g} N m" in service
    assert "An extra 163158 N down at [10, 10] would just hold it." in service
    assert documented(service)
    assert "slab alone: The plate lifts off its supports: the load's resultant is 400000 N up" in alone


def test_the_extra_load_that_is_named_just_holds_it() -> None:
    for extra, holds in [(163158.5, True), (163157.0, False)]:
        data = tomllib.loads((EXAMPLES / "slab_on_points.toml").read_text())
        data["load"][0]["pressure"] = -4e3
        data["load"].append({"case": "machine", "force": extra, "at": [10, 10]})
        data["combination"] = [{"name": "service", "factors": {"slab": 1, "machine": 1}}]
        model = signorini.validate(data)
        if holds:
            assert signorini.solve(model)["service"].status == "solved"
        else:
            with pytest.raises(signorini.NoEquilibriumError):
                signorini.solve(model)


def test_a_slab_under_strong_suction_flies() -> None:
    with pytest.raises(signorini.NoEquilibriumError) as caught:
        signorini.solve(slab_under(-10e3))
    service = str(caught.value).splitlines()[0]
    assert "service: The plate lifts off its supports: the load's resultant is 500000 N up" in service
    assert "An extra 500000 N down at [9, 9] would just hold it." in service


def test_a_base_plate_stands_the_wind_that_its_anchors_hold() -> None:
    model = signorini.load(EXAMPLES / "base_plate.toml")
    right, left = signorini.solve(model).values()
    grout, anchors = right.supports
    # The anchors pull about as hard as a rigid plate on the grout's edge would make them: 500 kN at 0.05 outside of it.
    assert grout.reaction + anchors.reaction == pytest.approx(500.0, rel=1e-9)
    assert -250 < anchors.reaction < -500 * 0.05 / 0.35
    assert left.status == "no_equilibrium"
    assert "tips about the line x = 0.5" in left.message


def test_the_messages_about_supports_are_those_of_the_documents() -> None:
    tables = tomllib.loads((EXAMPLES / "slab_on_points.toml").read_text())
    beam = {**tables, "support": [{"at": [[1, 5], [5, 5], [9, 5]], "resists": "down"}]}
    stops = [{"at": [1, 1], "resists": "down"}, {"at": [1, 1], "resists": "up", "settlement": 0.01}]
    for wrong in (beam, {**tables, "support": stops}):
        with pytest.raises(signorini.InputError) as caught:
            signorini.solve(signorini.validate(wrong))
        assert documented(f"Error: {caught.value}")


def test_a_disc_lets_go_of_its_ring_at_both_sides_of_the_crane() -> None:
    results = signorini.solve(signorini.load(EXAMPLES / "disc_on_ring.toml"))
    weight = 25e3 * 0.15 * np.pi * 2**2
    alone, loaded = (result.supports[0] for result in results.values())
    assert alone.open_count == 0
    assert alone.reaction == pytest.approx(weight, rel=1e-6)
    assert loaded.reaction == pytest.approx(weight + 120e3, rel=1e-6)
    assert np.allclose(np.hypot(*loaded.positions.T), 1.6, rtol=1e-12)
    # Reactions balance the moment too, and the contact is as symmetric as the load.
    assert loaded.reactions @ loaded.positions[:, 0] == pytest.approx(120e3 * 1.9, rel=1e-6)
    x, y = loaded.positions[loaded.closed].round(9).T
    assert set(zip(x, y + 0.0, strict=True)) == set(zip(x, 0.0 - y, strict=True))
    angle = np.degrees(np.arctan2(*loaded.positions.T[::-1]))
    for held in (np.abs(angle) < 10, np.abs(angle) > 125):
        assert loaded.closed[held].all()
    assert not loaded.closed[(np.abs(angle) > 30) & (np.abs(angle) < 110)].any()
    assert (loaded.gaps[~loaded.closed] > 0).all()


@pytest.mark.parametrize("element", ["q8r", "mitc9"])
def test_table_1_the_unilateral_plate_is_the_sum_of_two_bilateral_steps(element: str) -> None:
    table = script("clamped_quarter").table(element)
    assert len(table.unilateral) == 21
    assert np.abs(table.first + table.second - table.unilateral).max() < 1e-10
    assert table.first.sum() == pytest.approx(32, abs=1e-10)
    assert table.second.sum() == pytest.approx(32, abs=1e-10)
    assert table.unilateral.sum() == pytest.approx(64, abs=1e-10)
    # The support under the centre is not touched in the first step, and the free nodes have no reaction at all.
    assert table.first[20] == 0
    assert table.unilateral[20] > 0
    free = np.array([7, 8, 10, 11, 12, 13, 15, 16, 18, 19, 20]) - 1
    assert (table.unilateral[free] == 0).all()


def test_table_1_is_printed_as_in_the_paper() -> None:
    example = script("clamped_quarter")
    lines = example.printed(example.table()).splitlines()
    assert lines[0].split() == ["Node", "R1", "R2", "R1+R2", "R*"]
    assert [int(line.split()[0]) for line in lines[1:-1]] == [1, 2, 3, 4, 5, 6, 8, 9, 13, 14, 16, 17, 18, 19, 20, 21]
    assert lines[-1].split() == ["sum", "-32.000", "-32.000", "-64.000", "-64.000"]
    centre = [float(part) for part in lines[-2].split()]
    assert centre[1] == 0 and centre[2] == centre[3] == centre[4] < 0


def test_the_first_example_of_the_paper_is_the_same_from_toml() -> None:
    model = signorini.load(EXAMPLES / "clamped_quarter.toml")
    example = script("clamped_quarter")
    columns = example.table()
    assert columns.young == pytest.approx(model.material.E, rel=1e-12)
    first, unilateral = signorini.solve(model).values()
    assert example.row_by_row(first) == pytest.approx(columns.first, abs=1e-9)
    assert example.row_by_row(unilateral) == pytest.approx(columns.unilateral, abs=1e-9)
    (event,) = signorini.path(model, None, "load", until=1.0).support_events
    assert event.t == pytest.approx(0.5, rel=1e-9) and event.change == "closes"
    assert "the digits of its Table 1 are not matched" in (EXAMPLES / "clamped_quarter.toml").read_text("utf-8")


def test_the_second_example_of_the_paper_is_the_same_from_toml_and_opens_its_inner_ring_along_a_path() -> None:
    model = signorini.load(EXAMPLES / "circular_cover.toml")
    results, wanted = signorini.solve(model), signorini.solve(script("circular_cover").cover())
    assert list(results) == list(wanted)
    for name, result in results.items():
        assert np.abs(result.deflection - wanted[name].deflection).max() < 1e-9 * np.abs(result.deflection).max()
    path = signorini.path(model, "180 Kgm", "pressure", until=1.0, events="all")
    switched = [one for event in path.events for one in event.switched]
    assert {(one.support, one.change) for one in switched} == {("inner ring", "opens")}
    first, *_, last = (event.t for event in path.events)
    assert (first, last) == pytest.approx((0.53539, 0.53807), rel=1e-3)
    assert len(switched) == results["180 Kgm and pressure"].supports[1].open_count


def test_circular_cover_bulges_with_its_bolts_and_opens_its_inner_ring_under_pressure() -> None:
    example = script("circular_cover")
    results = signorini.solve(example.cover())
    places = np.array([[0.0, 0.0], [240.416, 240.416], [275.771, 275.771]])
    *bolted, last = (np.array([one.deflection for one in result.probe(places)]) for result in results.values())
    # In the five bolted states both rings stay closed, so all grows with the bolts: rim down, centre up.
    for torque, deflection in zip(example.TORQUES, bolted, strict=True):
        assert np.allclose(deflection / torque, bolted[0] / 60, rtol=1e-9)
        assert deflection[0] < 0 < deflection[1] < deflection[2]
    # Pressure lifts the centre; the inner ring lets go.
    assert last[0] < 5 * bolted[-1][0]
    inner, outer = (results["180 Kgm and pressure"].supports[i] for i in (1, 2))
    assert inner.closed_count == 0 and outer.open_count == 0
    bolts = 20 * 180 * 9806.65 / (0.2 * 36)
    lift = 11.5 * np.pi * 340**2
    assert 4 * outer.reaction == pytest.approx(bolts - lift, rel=1e-5)


def test_circular_cover_under_pressure_agrees_with_the_axisymmetric_plate() -> None:
    """Thick circular plate on its outer ring with an overhang, bolts smeared along their circle."""
    example = script("circular_cover")
    result = signorini.solve(example.cover())["180 Kgm and pressure"]
    young, nu, h, a, r, b = 206e3, 0.3, 110.0, 340.0, 390.0, 365.0
    rigidity, shear = young * h**3 / 12 / (1 - nu**2), 5 / 6 * young / 2 / (1 + nu) * h
    # Slope of the overhang is that of the ring; its annulus holds the moment k per slope at radius a. Per length of the
    # ring the bolts act at the arm b - a.
    bolts = 20 * 180 * 9806.65 / (0.2 * 36) / (2 * np.pi * a)
    holds = rigidity * (1 - nu**2) / a * (r**2 - a**2) / ((1 - nu) * a**2 + (1 + nu) * r**2)
    pressure_slope = 11.5 * a**3 / 8 / rigidity / (1 + nu)
    slope = (pressure_slope + bolts * (b - a) * a / rigidity / (1 + nu)) / (1 + holds * a / rigidity / (1 + nu))
    moment_slope = slope - pressure_slope
    rise = 11.5 * a**4 / 64 / rigidity * (5 + nu) / (1 + nu) + 11.5 * a**2 / 4 / shear + moment_slope * a / 2
    centre, ring = (probe.deflection for probe in result.probe([[0.0, 0.0], [a / np.sqrt(2), a / np.sqrt(2)]]))
    assert ring - centre == pytest.approx(rise, rel=0.02)


def test_figure_6_has_78_nodes_and_21_quadrilaterals_and_the_answer_of_a_finer_mesh() -> None:
    """The paper prints no digits for its Figures 7 and 8; a finer mesh of mitc9 is the reference.

    Three elements a quarter circle are too few for the rim to bend between the bolts: there they leave 5 %.
    """
    model = signorini.load(EXAMPLES / "circular_cover_21.toml")
    mesh = discretise(model).mesh
    assert (mesh.node_count, len(mesh.elements), int(mesh.triangles.sum())) == (78, 21, 0)
    assert (mesh.elements[:3, [0, 1, 4]] == 0).all()
    assert (np.diff(np.sort(mesh.elements[3:], axis=1), axis=1) > 0).all()
    results, finer = signorini.solve(model), signorini.solve(signorini.load(EXAMPLES / "circular_cover.toml"))
    assert list(results) == list(finer)
    for name, found in results.items():
        wanted = finer[name]
        assert found.certificate.passed
        along, expected = (one.profiles["radius"].values["deflection"] for one in (found, wanted))
        assert along[0] == pytest.approx(expected[0], rel=1e-3)
        assert np.abs(along - expected).max() < 0.05 * np.abs(expected).max()
        for mine, theirs in zip(found.supports[1:], wanted.supports[1:], strict=True):
            assert mine.reaction == pytest.approx(theirs.reaction, rel=1e-4)
            assert (mine.closed_count == 0) == (theirs.closed_count == 0)


def test_circular_cover_writes_its_two_figures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["circular_cover.py", str(tmp_path)])
    script("circular_cover").main()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["cover_centre.png", "cover_radius.png"]


def test_ten_lines_lift_one_column(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    columns = script("ten_lines").columns
    assert columns.positions[~columns.closed].tolist() == [[1.0, 5.0]]
    assert columns.reaction == pytest.approx(4e3 * 60 + 400e3, rel=1e-12)
    assert "certificate passed" in capsys.readouterr().out
    assert (tmp_path / "slab.png").stat().st_size > 1000


def test_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    readme = (EXAMPLES.parent / "README.md").read_text("utf-8")
    blocks = dict(re.findall(r"```(toml|python)\n(.*?)```", readme, re.DOTALL))
    results = signorini.solve(signorini.validate(tomllib.loads(blocks["toml"])))
    assert [result.status for result in results.values()] == ["solved"]
    monkeypatch.chdir(tmp_path)
    exec(compile(blocks["python"], "README.md", "exec"), {})
    assert (tmp_path / "slab.png").exists()


def test_a_flat_slab_has_its_panels_weight_and_moments_on_both_sides_of_their_borders() -> None:
    model = signorini.load(EXAMPLES / "flat_slab.toml")
    result = signorini.solve(model)["SLS"]
    area = 16 * 13 - 12.5 - 5
    cone = 2 * np.pi * 1.2**2 * (0.5 / 2 - 0.2 * 1.2 / 3)
    zone = 9 * (11 + 11.5) / 2 - 9.5 * 9
    weight = 25 * (0.25 * (area - 4 - np.pi * 1.2**2 - zone) + 0.4 * 4 + cone) + 24 * 0.25 * zone
    live = 0.3 * 5 * (11 * 13 - 5)
    assert result.certificate.passed
    assert sum(result.reactions.values()) == pytest.approx(weight + live, rel=1e-6)
    assert not signorini.solve(model).discretisation.zones.parted.any()
    inside, outside = result.probe([(5.999, 5), (6.001, 5)])
    assert abs(inside.moment[1]) > 3 * abs(outside.moment[1])
    assert result.probes[0].moment[1] == pytest.approx(inside.moment[1], rel=0.01)


def test_a_flat_slab_of_nine_bays_has_the_total_static_moment_between_its_columns() -> None:
    """M₀ = q l₂ l₁²/8 (Nichols 1914), less half of each column's reaction times a quarter of its width."""
    result = signorini.solve(signorini.load(EXAMPLES / "flat_slab_strips.toml"))["all"]
    bay, columns, around = result.sections
    over = sum(result.supports[0].reactions[1::4])
    # The mesh is not quite symmetric, so that a little shear is left in the middle of the bay.
    static = bay.moment - columns.moment - 3 * bay.shear
    assert static == pytest.approx(13.2 * 15.4 * 6**2 / 8 - over * 0.4 / 8, rel=1e-9)
    assert abs(bay.shear) < 1e-3 * over
    assert around.shear == pytest.approx(result.supports[0].reactions[5] - 13.2 * 1.4**2, rel=1e-9)
    column, middle = result.strips
    assert column.hogging.at in ((6.2, 5.2), (12.2, 5.2))
    assert column.hogging.moment < 2.0 * middle.hogging.moment < 0.0 < middle.sagging.moment < column.sagging.moment


def test_the_footing_tips_at_the_load_of_its_plastic_mechanism() -> None:
    model = signorini.load(EXAMPLES / "yielding_footing.toml")
    path = signorini.path(model, "G", "W")
    # Soil that crushes under a part a of 4 x 3 m: 250 · 3 a = 720 + 400 t and, about x = 4, 375 a² = 1500 - 150 t.
    a, b, c = 375 * (400 / 750) ** 2, 375 * 2 * (720 / 750) * (400 / 750) + 150, 375 * (720 / 750) ** 2 - 1500
    assert path.limit == pytest.approx((-b + np.sqrt(b**2 - 4 * a * c)) / (2 * a), rel=1e-3)
    assert path.mechanism == "tips about the line x = 2.21 at the limits of soil and anchors"
    yields = {event.support for event in path.support_events if event.change == "yields"}
    assert yields == {"soil", "anchors"}


def test_the_rounds_of_the_preloaded_cover_loosen_and_its_rings_open_one_after_the_other() -> None:
    model = signorini.load(EXAMPLES / "preloaded_cover.toml")
    tight, pressed, loose = signorini.solve(model).values()
    _, inner, outer, first, second = tight.supports
    assert second.preloads == pytest.approx([-245e3] * 2, rel=1e-12)
    assert ((first.preloads > -0.95 * 245e3) & (first.preloads < -0.85 * 245e3)).all()
    assert first.changes == pytest.approx(np.zeros(3), abs=1e-3)
    lift = 11.5 * np.pi * 340**2 / 4
    _, inner, outer, first, second = pressed.supports
    assert (inner.closed_count, outer.open_count) == (0, 0)
    assert first.prying + second.prying == pytest.approx((lift + outer.reaction) / lift, rel=1e-4)
    assert max(-first.changes.min(), -second.changes.min()) < 20e3
    assert [one.closed_count for one in loose.supports[1:3]] == [0, 0]
    found = signorini.path(model, "tightened", "pressure", until=2.0)
    order = [one.support for one in found.support_events]
    assert order == ["inner ring"] * 5 + ["outer ring"] * 5
    assert all(one.t <= other.t for one, other in zip(found.support_events, found.support_events[1:], strict=False))


def test_anchors_of_a_base_plate_gain_and_lose_force_while_the_grout_crushes() -> None:
    results = signorini.solve(signorini.load(EXAMPLES / "base_plate_on_grout.toml"))
    for name, down in (("permanent", 1.35 * 300.0), ("wind", 300.0)):
        assert sum(results[name].reactions.values()) == pytest.approx(down, rel=1e-9)
    grout, anchors = results["permanent"].supports
    assert grout.yielded_area == 0.0
    assert anchors.changes is not None and (anchors.changes > 0.0).all()  # pressed, they lose some of their force
    grout, anchors = results["wind"].supports
    assert grout.yielded_area is not None and grout.yielded_area > 0.01
    assert grout.max_pressure == pytest.approx(6e3)
    assert anchors.changes is not None
    assert (anchors.changes[[0, 2]] < 0.0).all() and (anchors.changes[[1, 3]] > 0.0).all()


def test_a_machine_lifts_the_edge_of_its_foot_from_the_slab() -> None:
    results = signorini.solve(signorini.load(EXAMPLES / "machine_foot.toml"))
    for result in results.values():
        on_foot = 50.0 * 0.8 * 0.5
        assert result.reactions["grout"] + result.reactions["bolts"] == pytest.approx(on_foot, rel=1e-8)
        assert result.reactions["soil"] == pytest.approx(on_foot + 25.0 * 0.35 * 12.0, rel=1e-9)
    running, starting = (results[name].supports[2].closed_part for name in ("running", "starting"))
    assert starting < 0.8 * running
    bolts = results["starting"].supports[0]
    assert bolts.changes is not None and (bolts.changes[[0, 3]] < -3.0).all()  # those on the side that is pulled up


def test_flange_bolts_tightened_in_turn_loosen_their_neighbours() -> None:
    results = signorini.solve(signorini.load(EXAMPLES / "flange_pair.toml"))
    tightened, service = results["tightened"], results["in service"]
    pairs = [support for support in tightened.supports if support.name.startswith("bolts")]
    left = [-float(pair.preloads.mean()) for pair in pairs if pair.preloads is not None]
    assert left[-1] == pytest.approx(30e3, rel=1e-12)  # the last ones have their tightening force
    assert min(left[:2]) < 29e3
    for result in results.values():
        bolts = sum(force for name, force in result.reactions.items() if name.startswith("bolts"))
        thrust = 10.0 * np.pi * 56.0**2 if result is service else 0.0
        assert result.reactions["gasket"] + bolts == pytest.approx(-thrust, rel=1e-3, abs=1e-3)
    assert service.reactions["gasket"] < tightened.reactions["gasket"]


def test_crane_mats_share_an_outrigger_and_lift_their_ends() -> None:
    result = signorini.solve(signorini.load(EXAMPLES / "crane_mats.toml"))["all"]
    of = result.reactions
    assert of["soil left"] == pytest.approx(of["soil right"], rel=1e-9)
    assert of["on left"] + of["on middle"] + of["on right"] == pytest.approx(400.0 + 7.0 * 0.2 * 3.0, rel=1e-9)
    assert of["on middle"] > of["on left"]
    assert result.plates["middle"].deflection.min() < 0.0


def test_a_trench_lid_lifts_from_its_frame_away_from_the_wheel() -> None:
    result = signorini.solve(signorini.load(EXAMPLES / "trench_lid.toml"))["all"]
    assert result.reactions["rebate"] == pytest.approx(50.0 + 78.5 * 0.025 * 1.2, rel=1e-9)
    lid, frame = (result.plates[name].probe([1.15, 0.95])[0].deflection for name in ("lid", "frame"))
    assert lid < frame
    assert result.supports[-1].closed_part < 0.5


def test_the_slab_by_en_1990_has_an_envelope_of_each_limit_state() -> None:
    results = signorini.solve(signorini.load(EXAMPLES / "slab_by_en1990.toml"))
    # Leading live load: 3 patterns, 3 cases of wind; leading wind: 2 directions, 4 patterns; neither. G up and down.
    assert results.model.effective_combinations.groups == {"ULS": 36, "EQU": 36, "SLS": 18 + 3}
    assert results.combined.solved == 93
    assert results.table["factor:walls"].tolist() == results.table["factor:G"].tolist()


def test_the_flat_slab_with_every_table_of_design_is_in_balance_and_passes() -> None:
    results = signorini.solve(signorini.load(EXAMPLES / "flat_slab_design.toml"))
    full = next(one for one in results.values() if len(one.combination.factors) == 4)
    area = 12.4**2 - 0.8 * 0.6
    assert full.reactions["columns"] == pytest.approx((1.35 * (25 * 0.26 + 1.5) + 1.5 * 3) * area, rel=1e-9)
    inner = full.punching[4].numbers
    # The hole takes a sector of the perimeter between 6 d and the column.
    assert inner["u1"] < 4 * 0.4 + 4 * np.pi * 0.214 and inner["force"] > 0.2 * full.reactions["columns"]
    deflection, bars = signorini.check_results(results)
    assert deflection.passed and bars.utilisation < 1.0
