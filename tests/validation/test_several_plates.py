"""Several plates: how they share a load, lift off each other and tip, against statics and closed forms."""

from __future__ import annotations

import csv
import json
import pickle
from typing import Any

import meshio
import numpy as np
import pytest

from signorini import InputError, Model, NoEquilibriumError, contact_problem, estimate, load, path, solve, write
from signorini.contact.strategy import uncertain

STEEL: dict[str, Any] = {"E": 210e9, "nu": 0.0}
SQUARE: dict[str, Any] = {"shape": "rectangle", "size": [4, 4]}
EDGES = ["left", "right", "top", "bottom"]


def strip(thickness: float, divisions: tuple[int, int] = (32, 1), **more: object) -> dict[str, Any]:
    """A plate strip 4 long and 0.5 wide."""
    mesh = {"divisions": divisions}
    return {"shape": "rectangle", "size": [4, 0.5], "thickness": thickness, "mesh": mesh, **more}


def rigid(plate: str, box: list[float]) -> dict[str, Any]:
    """A zone that makes all of a plate rigid."""
    return {"plate": plate, "area": {"rectangle": box}, "rigid": True}


def two_squares(thick: float, thin: float, loaded: str, divisions: tuple[int, int] = (8, 8)) -> Model:
    """Two simply supported squares of one outline that touch."""
    plates = {
        "upper": {**SQUARE, "thickness": thick, "mesh": {"divisions": [8, 8]}},
        "lower": {**SQUARE, "thickness": thin, "mesh": {"divisions": divisions}},
    }
    return Model(
        material=STEEL,
        plates=plates,
        support=[{"plate": name, "edge": EDGES, "fix": "hard"} for name in plates],
        contact=[{"name": "touching", "between": ["upper", "lower"], "area": "all"}],
        load=[{"plate": loaded, "pressure": 1e3}],
    )


def test_touching_plates_of_different_meshes_share_a_load_as_their_bending_stiffnesses():
    """Equal outline, support and deflection: the lower one carries D₂ / (D₁ + D₂) of the load."""
    thick, thin = 0.04, 0.02
    result = solve(two_squares(thick, thin, "upper", (7, 9)))["all"]
    part = thin**3 / (thick**3 + thin**3)
    alone = Model(
        material=STEEL,
        plate={**SQUARE, "thickness": thick},
        mesh={"divisions": [8, 8]},
        support=[{"edge": EDGES, "fix": "hard"}],
        load=[{"pressure": 1e3}],
    )
    deflection = solve(alone)["all"].deflection.max()
    assert result.plates["upper"].deflection.max() == pytest.approx((1.0 - part) * deflection, rel=1e-3)


def test_a_plate_on_a_rigid_one_is_a_plate_on_a_bed():
    """To the last digits: the same points, whatever the mesh of the rigid plate."""
    loads = [{"pressure": 1e3}, {"force": 5e4, "at": [0.5, 0.5]}]
    upper = {**SQUARE, "thickness": 0.2, "mesh": {"divisions": [8, 8]}}
    lower = {"shape": "rectangle", "size": [6, 6], "origin": [-1, -1], "thickness": 0.5, "mesh": {"divisions": [5, 4]}}
    layer = {"area": "all", "stiffness": 1e8, "gap": 1e-4}
    model = Model(
        material=STEEL,
        plates={"upper": upper, "lower": lower},
        zone=[rigid("lower", [-1, -1, 5, 5])],
        support=[{"plate": "lower", "at": [[-1, -1], [5, -1], [0, 5]], "fix": "simple"}],
        contact=[{"name": "layer", "between": ["upper", "lower"], **layer}],
        load=[{"plate": "upper", **load} for load in loads],
    )
    bed = {"name": "layer", "resists": "down", **layer}
    alone = Model(
        material=STEEL,
        plate={**SQUARE, "thickness": 0.2},
        mesh={"divisions": [8, 8]},
        support=[bed],
        load=loads,
    )
    both, one = solve(model)["all"], solve(alone)["all"]
    upper_plate = both.plates["upper"]
    size = np.abs(one.deflection).max()
    np.testing.assert_allclose(upper_plate.deflection, one.deflection, atol=1e-9 * size)
    np.testing.assert_allclose(upper_plate.moment, one.moment, atol=1e-8 * np.abs(one.moment).max())
    for name in ("reaction", "contact_area", "max_pressure"):
        assert getattr(both.supports[-1], name) == pytest.approx(getattr(one.supports[0], name), rel=1e-9)


def see_saw(force: float) -> Model:
    """A rigid beam of weight 4 kN on a pad 0.4 wide in the middle of a slab, with a force at its end."""
    return Model(
        material=STEEL,
        plates={"beam": strip(0.2), "slab": strip(0.3, (16, 2))},
        zone=[rigid("beam", [0, 0, 4, 0.5])],
        support=[{"plate": "slab", "edge": ["left", "right"], "fix": "simple"}],
        contact=[
            {
                "name": "pad",
                "between": ["beam", "slab"],
                "area": {"rectangle": [1.8, 0, 2.2, 0.5]},
                "stiffness": 1e9,
            }
        ],
        load=[
            {"plate": "beam", "case": "G", "pressure": 2e3},
            {"plate": "beam", "case": "P", "line_load": 2 * force, "edge": "right"},
        ],
        combination=[{"name": "both", "factors": {"G": 1, "P": 1}}],
    )


@pytest.mark.parametrize("places", [{"line": [[2, 0], [2, 0.5]]}, {"at": [[2, 0], [2, 0.25], [2, 0.5]]}])
def test_plates_tied_rigidly_sag_alike_there(places):
    """Alike and one of them loaded, each takes half of the load at midspan, along a line of the mesh as at points."""
    model = Model(
        material=STEEL,
        plates={name: strip(0.05, (16, 2)) for name in ("upper", "lower")},
        support=[
            *({"plate": name, "edge": ["left", "right"], "fix": "simple"} for name in ("upper", "lower")),
            {"name": "tie", "between": ["upper", "lower"], "resists": "both", **places},
        ],
        load=[{"plate": "upper", "line_load": 1e3, "line": [[2, 0], [2, 0.5]]}],
    )
    result = solve(model)["all"]
    assert result.reactions["tie"] == pytest.approx(250.0, rel=1e-3)
    upper, lower = (result.plates[name].probe([2, 0.25])[0].deflection for name in ("upper", "lower"))
    assert upper == pytest.approx(lower, rel=1e-9)


def test_a_see_saw_on_a_plate_tips_about_the_edge_of_its_pad():
    """4 kN × 0.2 m = P × 1.8 m: the force at which it tips, by statics."""
    most = 4e3 * 0.2 / 1.8
    standing = solve(see_saw(0.99 * most))
    assert standing["both"].reactions["pad"] == pytest.approx(4e3 + 0.99 * most, rel=1e-9)
    assert standing.limits["both"] == ("P", pytest.approx(1 / 0.99, rel=1e-6))
    with pytest.raises(NoEquilibriumError, match=r'"beam" tips about the line x = 2\.2'):
        solve(see_saw(1.01 * most))
    followed = path(see_saw(1.0), "G", "P")
    assert followed.ending == "no_equilibrium"
    assert followed.stops[-1].t == pytest.approx(most, rel=1e-5)


def test_what_nothing_holds_down_lifts_off():
    model = Model(
        material=STEEL,
        plates={"upper": strip(0.1), "lower": strip(0.1)},
        support=[{"plate": "lower", "edge": ["left", "right"], "fix": "hard"}],
        contact=[{"between": ["upper", "lower"], "area": "all"}],
        load=[{"plate": "upper", "pressure": -1e3}],
    )
    with pytest.raises(NoEquilibriumError, match='"upper" lifts off'):
        solve(model)
    bolted = {"between": ["upper", "lower"], "line": [[1, 0], [1, 0.5]], "resists": "up"}
    mechanism = model.model_dump(exclude_unset=True) | {"contact": (), "support": [*model.support, bolted]}
    with pytest.raises(InputError, match='Nothing holds the plate against this motion: "upper"'):
        solve(Model(**mechanism))


ROUND_HOLE, SQUARE_HOLE = {"circle": {"center": [1.8, 1.4], "radius": 0.2}}, {"rectangle": [1.6, 1.2, 1.9, 1.7]}


def on_a_plate_with_a_hole(area, hole, drilled="lower"):
    """A plate with a load beside its middle, on an area of another plate on soil; one of the plates has a hole."""
    shapes = {
        "lower": {"size": [4, 3], "thickness": 0.3},
        "upper": {"size": [3, 2.3], "origin": [0.5, 0.4], "thickness": 0.1},
    }
    plates = {
        name: {"shape": "rectangle", **of, **({"holes": [hole]} if hole and name == drilled else {})}
        for name, of in shapes.items()
    }
    return Model(
        material={"E": 3e7, "nu": 0.2},
        mesh={"size": 0.3},
        plates=plates,
        contact=[{"name": "layer", "between": ["upper", "lower"], "area": area, "stiffness": 1e5}],
        support=[{"name": "soil", "plate": "lower", "area": "all", "resists": "down", "stiffness": 2e4}],
        load=[
            {"plate": "upper", "pressure": 10},
            {"plate": "upper", "force": 5, "at": [2.2, 1.5], "patch": [0.2, 0.2]},
        ],
    )


@pytest.mark.parametrize("drilled", ["lower", "upper"])
@pytest.mark.parametrize(
    ("area", "hole", "measure"),
    [
        ({"rectangle": [0.8, 0.6, 3, 2.4]}, SQUARE_HOLE, 2.2 * 1.8 - 0.15),
        ({"rectangle": [0.8, 0.6, 3, 2.4]}, ROUND_HOLE, 2.2 * 1.8 - 0.04 * np.pi),
        ({"rectangle": [1.8, 0.6, 3.2, 2.4]}, ROUND_HOLE, 1.4 * 1.8 - 0.02 * np.pi),
        ({"annulus": {"center": [1.8, 1.4], "inner": 0.3, "outer": 0.8}}, ROUND_HOLE, 0.55 * np.pi),
        ("all", SQUARE_HOLE, 6.9 - 0.15),
    ],
)
def test_a_contact_acts_only_where_both_plates_are(area, hole, measure, drilled):
    """The holes of both plates are left out, in the readings of either plate."""
    result = solve(on_a_plate_with_a_hole(area, hole, drilled))["all"]
    assert result.reactions["layer"] == pytest.approx(10 * (6.9 - hole_area(hole) * (drilled == "upper")) + 5, rel=1e-4)
    for plate in result.plates.values():
        (layer,) = (one for one in plate.supports if one.name == "layer")
        assert layer.weights.sum() == pytest.approx(measure, rel=1e-4)


def hole_area(hole):
    return 0.15 if hole is SQUARE_HOLE else 0.04 * np.pi


def test_a_hole_of_the_lower_plate_acts_as_a_hole_of_the_area():
    area = {"rectangle": [0.8, 0.6, 3, 2.4]}
    found, expected = (
        solve(on_a_plate_with_a_hole(one, SQUARE_HOLE))["all"].plates["upper"]
        for one in (area, area | {"holes": [SQUARE_HOLE]})
    )
    assert found.extremes["deflection"].max == pytest.approx(expected.extremes["deflection"].max, rel=1e-9)


@pytest.mark.parametrize(
    "where",
    [{"area": {"rectangle": [0.8, 0.6, 3.4, 2.4]}}, {"line": [[0.8, 1], [3.4, 1]]}, {"line": [[1, 1.4], [3, 1.4]]}],
)
def test_a_support_off_the_lower_plate_is_refused(where):
    plates = {
        "lower": {"shape": "rectangle", "size": [3.2, 3], "thickness": 0.3, "holes": [SQUARE_HOLE]},
        "upper": {"shape": "rectangle", "size": [4, 2.3], "origin": [0.5, 0.4], "thickness": 0.1},
    }
    tie = {"name": "tie", "between": ["upper", "lower"], "resists": "both", "stiffness": 1e5, **where}
    soil = {"plate": "lower", "area": "all", "resists": "down", "stiffness": 2e4}
    model = Model(
        material={"E": 3e7, "nu": 0.2}, plates=plates, support=[soil, tie], load=[{"plate": "upper", "pressure": 1}]
    )
    with pytest.raises(InputError, match="off the plate"):
        solve(model)


@pytest.mark.parametrize("drilled", [("foot",), ("slab",), ("foot", "slab")])
def test_a_bolt_through_round_holes_is_in_balance_with_itself(drilled):
    """Tightened on one-sided soil; the meshes of the plates approximate the holes differently."""
    hole = [{"circle": {"center": [1.75, 1.45], "radius": 0.05}}]
    shapes = {
        "slab": {"size": [4, 3], "thickness": 0.3},
        "foot": {"size": [2, 1.5], "origin": [0.75, 0.7], "thickness": 0.1},
    }
    plates = {
        name: {"shape": "rectangle", **of, **({"holes": hole} if name in drilled else {})}
        for name, of in shapes.items()
    }
    bolt = {"name": "bolt", "between": ["foot", "slab"], "at": [1.75, 1.45], "radius": 0.12, "resists": "up"}
    model = Model(
        material={"E": 3e7, "nu": 0.2, "unit_weight": 25},
        plates=plates,
        contact=[{"between": ["foot", "slab"], "area": "all", "stiffness": 1e6}],
        support=[
            {"name": "soil", "plate": "slab", "area": "all", "resists": "down", "stiffness": 2e4},
            {**bolt, "stiffness": 1e4, "preload": 50},
        ],
        load=[{"plate": name, "self_weight": True} for name in plates],
    )
    result = solve(model)["all"]
    areas = {"slab": 12.0, "foot": 3.0}
    weight = 25 * sum(
        (areas[name] - 0.0025 * np.pi * (name in drilled)) * of["thickness"] for name, of in shapes.items()
    )
    assert result.reactions["soil"] == pytest.approx(weight, rel=1e-6)
    assert result.supports["bolt"].reaction == pytest.approx(-50.0, rel=0.01)


@pytest.mark.parametrize("pull", [0.0, 0.5, 0.99, 1.2])
def test_bolts_through_two_plates_hold_a_preloaded_joint(pull):
    """n bolts tightened to F on a layer of stiffness K: F + k P / (n k + K) up to P = n F (n k + K) / K, then P / n."""
    count, bolt, preload, layer = 4, 2e7, 5e4, 1e9
    total = layer * 1.0
    separates = count * preload * (count * bolt + total) / total
    model = Model(
        material=STEEL,
        plates={
            name: {"shape": "rectangle", "size": [1, 1], "thickness": 0.1, "mesh": {"divisions": divisions}}
            for name, divisions in (("cover", [4, 4]), ("base", [3, 5]))
        },
        zone=[rigid("cover", [0, 0, 1, 1]), rigid("base", [0, 0, 1, 1])],
        support=[
            {"plate": "base", "at": [[0, 0], [1, 0], [0, 1]], "fix": "simple"},
            {
                "name": "bolts",
                "between": ["cover", "base"],
                "at": [[0.2, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]],
                "resists": "up",
                "stiffness": bolt,
                "preload": preload,
            },
        ],
        contact=[{"name": "gasket", "between": ["cover", "base"], "area": "all", "stiffness": layer}],
        load=[{"plate": "cover", "pressure": -pull * separates}],
    )
    result = solve(model)["all"]
    bolts = next(one for one in result.supports if one.name == "bolts")
    expected = preload + bolt * pull * separates / (count * bolt + total) if pull < 1.0 else pull * separates / count
    np.testing.assert_allclose(-bolts.reactions, expected, rtol=1e-8)
    assert bolts.preloads is not None
    np.testing.assert_allclose(-bolts.preloads, preload, rtol=1e-12)
    assert result.reactions["gasket"] == pytest.approx(max(0.0, count * expected - pull * separates), abs=1e-4)


def test_a_plate_from_a_mesh_file_lies_on_another(tmp_path):
    """The same square, made here and read from a file; where it lies on the other one is given."""
    upper = {**SQUARE, "thickness": 0.2, "mesh": {"divisions": [6, 6]}}
    lower = {**SQUARE, "thickness": 0.3, "mesh": {"divisions": [5, 5]}}
    tables: dict[str, Any] = {
        "material": STEEL,
        "support": [{"plate": "lower", "area": "all", "resists": "down", "stiffness": 1e7}],
        "contact": [{"name": "pad", "between": ["upper", "lower"], "area": {"rectangle": [0, 0, 4, 4]}}],
        "load": [{"plate": "upper", "force": 1e4, "at": [1, 1]}],
    }
    made = Model(**tables, plates={"upper": upper, "lower": lower})
    mesh = solve(made)["all"].plates["upper"].mesh
    file = tmp_path / "upper.vtu"
    meshio.Mesh(np.column_stack([mesh.points, np.zeros(mesh.node_count)]), [("quad8", mesh.elements)]).write(file)
    read = Model(**tables, plates={"upper": {"shape": "mesh", "file": file, "thickness": 0.2}, "lower": lower})
    one, other = (solve(model)["all"] for model in (made, read))
    assert other.reactions["pad"] == pytest.approx(one.reactions["pad"], rel=1e-9)
    assert other.plates["upper"].deflection.max() == pytest.approx(one.plates["upper"].deflection.max(), rel=1e-9)
    beside = tmp_path / "stack.toml"
    beside.write_text(read.to_toml().replace(str(file), "upper.vtu"), encoding="utf-8")
    assert load(beside).plates["upper"] == read.plates["upper"], "the name of the mesh file is relative to the input"
    everywhere = tables | {"contact": [{"between": ["upper", "lower"], "area": "all"}]}
    with pytest.raises(InputError, match="is in a mesh file"):
        Model(**everywhere, plates={"upper": {"shape": "mesh", "file": file, "thickness": 0.2}, "lower": lower})


def mats() -> dict[str, Any]:
    """A mat across two others side by side on soil, tied to one of them."""
    side = {"shape": "rectangle", "size": [1, 4], "thickness": 0.2, "mesh": {"size": 0.25}}
    soil = {"area": "all", "resists": "down", "stiffness": 2e7}
    return {
        "material": {"E": 12e9, "nu": 0.2, "unit_weight": 7e3},
        "plates": {
            "top": {"shape": "rectangle", "size": [3, 1], "origin": [0, 1.5], "thickness": 0.2, "mesh": {"size": 0.2}},
            "left": side,
            "right": {**side, "origin": [1.5, 0]},
        },
        "support": [
            {"name": "soil left", "plate": "left", **soil},
            {"name": "soil right", "plate": "right", **soil},
            {
                "name": "tie",
                "between": ["top", "left"],
                "at": [[0.2, 2]],
                "radius": 0.1,
                "resists": "up",
                "stiffness": 1e7,
            },
        ],
        "contact": [
            {"name": name, "between": ["top", name], "area": "all", "stiffness": 1e9} for name in ("left", "right")
        ],
        "load": [
            *({"plate": name, "case": "G", "self_weight": True} for name in ("top", "left", "right")),
            {"plate": "top", "case": "Q", "force": 1e5, "at": [2.2, 2], "patch": [0.4, 0.4]},
        ],
        "probe": [{"plate": "right", "at": [2, 2]}, {"plate": "top", "at": [[1, 2], [2, 2]]}],
        "section": [{"name": "through", "plate": "top", "line": [[1.25, 1.5], [1.25, 2.5]]}],
    }


def test_every_plate_is_in_balance():
    """Soil carries the weight and the load; the contacts carry the load of the top mat, and the section its part."""
    result = solve(Model(**mats()))["all"]
    of = result.reactions
    weight = 7e3 * 0.2
    assert of["soil left"] + of["soil right"] == pytest.approx(weight * (3 + 4 + 4) + 1e5, rel=1e-9)
    assert of["left"] + of["right"] + of["tie"] == pytest.approx(weight * 3 + 1e5, rel=1e-9)
    assert of["soil left"] == pytest.approx(weight * 4 + of["left"] + of["tie"], rel=1e-9)
    (section,) = result.sections
    on_the_left = of["left"] + of["tie"] - weight * 1.25
    assert section.shear == pytest.approx(on_the_left, abs=1e-6 * 1e5)


def test_a_table_of_combinations_and_plus_minus_are_those_of_single_ones():
    factors = [{"G": 1.0 + 0.05 * at, "Q": 0.3 * at} for at in range(1, 15)]
    combinations = [{"name": f"c{at}", "factors": one} for at, one in enumerate(factors)]
    table = solve(Model(**mats(), combination=combinations, output={"fields": "none"}))
    for at in (0, 6, 13):
        single = solve(Model(**mats(), combination=[combinations[at]]))[f"c{at}"]
        for name, reaction in single.reactions.items():
            assert table.table[f"reaction:{name}"][at] == pytest.approx(reaction, rel=1e-9, abs=1e-6)
        assert table.table["contact_area:right"][at] == pytest.approx(single.supports[-1].contact_area, rel=1e-9)
        assert table.table["probe[3]:mx"][at] == pytest.approx(single.probes[2].moment[0], rel=1e-8)
    widths = estimate(table)
    alone = estimate(solve(Model(**mats(), combination=[combinations[6]]))["c6"])
    told = alone.plus_minus
    assert told is not None
    assert widths.half_width("reaction:soil right", 6) == pytest.approx(told["supports"][1]["reaction"], rel=0.02)
    assert widths.half_width("max:left.mx", 6) == pytest.approx(told["plates"]["left"]["fields"]["mx"]["max"], rel=0.02)


def test_envelopes_of_several_plates_are_those_of_each_over_its_combinations(tmp_path):
    factors = [{"G": 1.0, "Q": 0.3 * at} for at in range(1, 14)]
    combinations = [{"name": f"c{at}", "factors": one} for at, one in enumerate(factors)]
    results = solve(Model(**mats() | {"mesh": {"error": False}}, combination=combinations, output={"fields": "all"}))
    write(results, tmp_path, pictures="none")
    envelope = json.loads((tmp_path / "results.json").read_text("utf-8"))["envelope"]
    rows = csv.DictReader((tmp_path / "governing.csv").read_text("utf-8").splitlines())
    governing = {(row["support"], row["what"]) for row in rows}
    assert {("soil left", "max_pressure"), ("right", "contact_area")} <= governing
    for name in ("top", "left"):
        each = [result.plates[name] for result in results.values()]
        low, high = zip(*((one.extremes["mx"].min, one.extremes["mx"].max) for one in each), strict=True)
        told = envelope["plates"][name]
        assert (told["fields"]["mx"]["max"], told["fields"]["mx"]["min"]) == pytest.approx((max(high), min(low)))
        assert told["fields"]["mx"]["max_by"] == f"c{np.argmax(high)}"
        assert told["fields"]["mx"]["max_at"] == list(each[int(np.argmax(high))].extremes["mx"].max_at)
        written = meshio.read(tmp_path / told["file"]).point_data
        moment, deflection = (np.array([one.fields[field] for one in each]) for field in ("mx", "deflection"))
        np.testing.assert_allclose(written["mx_max"], moment.max(axis=0), atol=1e-6)
        np.testing.assert_allclose(written["deflection_min"], deflection.min(axis=0), atol=1e-12)


def test_results_are_told_of_all_and_by_plate(tmp_path):
    profiles = [{"name": name, "plate": name, "line": [[0.5, 2], [0.9, 2]]} for name in ("top", "left")]
    results = solve(Model(**mats(), profile=profiles))
    files = {file.name for file in write(results, tmp_path)}
    assert {"profiles.csv", "profile-top.png", "profile-left.png"} <= files
    assert {f"all-{name}.vtu" for name in ("top", "left", "right")} <= files
    assert {"all-top.png", "all-left-moments.png", "all-right-pressure.png"} <= files
    (told,) = json.loads((tmp_path / "results.json").read_text("utf-8"))["combinations"]
    assert [one["name"] for one in told["supports"]] == ["soil left", "soil right", "tie"]
    assert [one["name"] for one in told["contacts"]] == ["left", "right"]
    assert told["contacts"][1]["contact_boundary"]
    assert told["deflection"]["max"] == max(one["deflection"]["max"] for one in told["plates"].values())
    assert told["plus_minus"]["plates"]["top"]["fields"]["mx"]["max"] > 0.0
    result = results["all"]
    # The pressure on a plate's bed, not that of the plate on it; that of a contact by the distance of the two.
    pressed = meshio.read(tmp_path / "all-left.vtu").point_data["contact_pressure"]
    np.testing.assert_allclose(pressed, 2e7 * np.maximum(result.plates["left"].deflection, 0.0), atol=1e-6)
    pressed = meshio.read(tmp_path / "all-top.vtu").point_data["contact_pressure"]
    assert pressed.max() < 2 * max(one.max_pressure for one in result.supports if one.name in ("left", "right"))
    assert told["plates"]["top"]["fields"]["mx"]["max"] == result.plates["top"].extremes["mx"].max
    again = pickle.loads(pickle.dumps(results))["all"]
    assert again.plates["left"].reactions["left"] == -result.reactions["left"]


def test_a_probe_on_a_plate_without_an_area_has_no_pressure():
    """Contact pressure is a number of probes on plates with an area support or an area contact only."""
    tables = mats() | {
        "contact": [{"name": "stud", "between": ["top", "right"], "at": [[1.7, 1.7], [2.3, 1.7], [2, 2.3]]}]
    }
    result = solve(Model(**tables))["all"]
    right, *top = result.probes
    assert right.pressure is not None and [one.pressure for one in top] == [None, None]
    names = {one.name for one in result.catalogue}
    assert "probe[1].pressure" in names and not {"probe[2].pressure", "probe[3].pressure"} & names


def test_what_has_no_limit_is_told_with_its_plate():
    """The pressure of a contact is the upper plate's; the lower one does not have it."""
    plates = two_squares(0.04, 0.02, "upper", (3, 3))
    force = {"plate": "upper", "at": [2, 2], "force": 1e3}
    tables = plates.model_dump() | {"load": [force]}
    tables["plates"]["upper"]["mesh"] = {"divisions": [4, 4]}
    result = solve(Model(**tables))["all"]
    named = {(one.plate, one.source) for one in result.singular}
    assert ("upper", "load") in named and ("lower", "load") not in named
    grows = [said for said in estimate(result).warnings if "show no limit" in said]
    assert grows and all(said.startswith("upper: ") for said in grows)


def test_units_and_the_order_of_plates_change_nothing():
    """In millimetres and kilonewtons, and with plates named in another order."""
    one = solve(Model(**mats()))["all"]
    other = mats()
    other["plates"] = dict(reversed(other["plates"].items()))
    turned = solve(Model(**other))["all"]
    for name, reaction in one.reactions.items():
        assert turned.reactions[name] == pytest.approx(reaction, rel=1e-8)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"contact": [{"between": ["top", "far"], "area": "all"}]},
            r'contact\[1\].area: "top" and "far" do not overlap',
        ),
        ({"contact": [{"between": ["top", "lft"], "area": "all"}]}, r"contact\[1\].between: Unknown plate 'lft'"),
        ({"contact": [{"between": ["top", "top"], "area": "all"}]}, r"contact\[1\].between: found \"top\" twice"),
        ({"contact": [{"between": ["top", "left"], "at": [2, 2]}]}, r"contact\[1\].at: The point \[2, 2\] is not on"),
        (
            {"contact": [{"between": ["top", "left"], "edge": "left"}]},
            r"contact\[1\].edge: edge is not allowed with between",
        ),
        (
            {"contact": [{"between": ["top", "left"], "area": "all", "resists": "up"}]},
            "found resists; a contact, which only pushes",
        ),
        ({"contact": [{"between": ["top", "left"], "area": "all", "limit": 0}]}, r"contact\[1\].limit: found 0"),
        ({"load": [{"pressure": 1.0}]}, r"load\[1\].plate: 'plate' is missing"),
        ({"support": [{"plate": "left", "edge": "lft"}]}, r"support\[1\].edge: Unknown edge 'lft'"),
        ({"probe": [{"plate": "top", "at": [9, 9]}]}, r"probe\[1\].at: The point \[9, 9\] is not on"),
        ({"mesh": {"accuracy": 0.1}}, "mesh.accuracy: accuracy is for one plate"),
        (
            {
                "contact": [
                    {"between": [one, "left" if one == "top" else "top"], "area": "all"} for one in ("top", "left")
                ]
            },
            r"contact\[2\].between: found \"left\" on \"top\"",
        ),
    ],
)
def test_bad_input_is_refused_with_its_place(change, message):
    given = mats()
    far = {"shape": "rectangle", "size": [1, 1], "origin": [9, 9], "thickness": 0.2}
    given["plates"] = {**given["plates"], **({"far": far} if "far" in str(change) else {})}
    with pytest.raises(InputError, match=message):
        solve(Model(**given | change))


@pytest.mark.parametrize("seed", [6, 7, 9, 12])
@pytest.mark.parametrize("unit", [1.0, 1e3], ids=["m", "mm"])
def test_plates_that_float_are_pressed_as_on_three_points_that_carry_nothing(seed: int, unit: float) -> None:
    rng = np.random.default_rng([34, seed])
    corner, part, thickness = rng.uniform(0.5, 1.5, 2), rng.uniform(0.8, 2.0, 2), rng.uniform(0.03, 0.08)

    def stack(ground: list[dict[str, object]]) -> Model:
        at = [(unit * (corner + place * part)).tolist() for place in ((0.1, 0.15), (0.9, 0.15), (0.15, 0.9))]
        bolts = {"name": "bolts", "between": ["foot", "slab"], "at": at, "resists": "up"}
        force = {"force": 5e4, "at": (unit * (corner + 0.45 * part)).tolist()}
        return Model(
            material={"E": 30e9 / unit**2, "nu": 0.2},
            plates={
                "slab": {
                    **{"shape": "rectangle", "size": [4 * unit, 3 * unit], "thickness": 0.2 * unit},
                    "mesh": {"divisions": [6, 5]},
                },
                "foot": {
                    **{"shape": "rectangle", "size": (unit * part).tolist(), "origin": (unit * corner).tolist()},
                    **{"thickness": thickness * unit, "mesh": {"divisions": [7, 5]}},
                },
            },
            contact=[{"name": "grout", "between": ["foot", "slab"], "area": "all", "stiffness": 5e10 / unit**3}],
            support=[*ground, {**bolts, "stiffness": 2e8 / unit, "preload": 4e4}],
            load=[{"plate": "foot", **force}, {"plate": "slab", **force, "force": -5e4}],
        )

    soil = {"name": "soil", "plate": "slab", "area": "all", "resists": "down", "stiffness": 3e7 / unit**3}
    feet = {"name": "feet", "plate": "slab", "at": (unit * np.array([[0, 0], [4, 0], [0, 3]])).tolist()}
    floats, stands = solve(stack([soil]))["all"], solve(stack([feet]))["all"]
    assert np.abs(stands.supports[0].reactions).max() < 1e-6
    for name in ("bolts", "grout"):
        ours, theirs = (next(s for s in one.supports if s.name == name).reactions for one in (floats, stands))
        np.testing.assert_allclose(ours, theirs, atol=1e-8 * np.abs(theirs).max())
    # They rest where the deflection is least: near the soil, within their bending.
    most = [np.abs(one.plates["slab"].deflection).max() for one in (floats, stands)]
    assert most[0] < 2 * most[1]


ON_A_PLATE: list[list[dict[str, Any]]] = [
    [{"line": [[1, 0], [1, 1]]}, {"line": [[3, 0], [3, 1]]}],
    [{"line": [[1, 0], [1, 1]], "stiffness": 1e9}, {"line": [[3, 0], [3, 1]], "gap": 1e-5}],
    [{"circle": {"center": [2, 0.5], "radius": 0.4}}, {"at": [[0.5, 0.5], [3.5, 0.5]]}],
    [{"area": {"rectangle": [0, 0, 1, 1]}}, {"area": {"rectangle": [3, 0, 4, 1]}}],
]


@pytest.mark.parametrize("supports", ON_A_PLATE)
def test_supports_and_the_same_against_a_rigid_plate_give_the_same_moments_and_shears(supports):
    shape = {"shape": "rectangle", "size": [4, 1], "thickness": 0.2}
    concrete, mesh = {"E": 30e9, "nu": 0.0}, {"size": 0.25, "error": False}
    read = {"profile": [{"name": "along", "line": [[0, 0.5], [4, 0.5]], "stations": 41}]}
    alone = Model(
        material=concrete,
        plate=shape,
        mesh=mesh,
        support=[{"resists": "down", **one} for one in supports],
        load=[{"pressure": 1e4}],
        **read,
    )
    read["profile"][0]["plate"] = "p"
    between = Model(
        material=concrete,
        plates={"p": shape, "z": shape},
        mesh=mesh,
        zone=[rigid("z", [0, 0, 4, 1])],
        contact=[{"between": ["p", "z"], **one} for one in supports],
        support=[{"plate": "z", "edge": "left", "fix": "clamped"}],
        load=[{"plate": "p", "pressure": 1e4}],
        **read,
    )
    one, other = (solve(model)["all"].profiles["along"].values for model in (alone, between))
    for field, scale in {"mx": 1e4, "my": 1e4, "mxy": 1e4, "qx": 2e4, "qy": 2e4}.items():
        np.testing.assert_allclose(other[field], one[field], rtol=0, atol=1e-7 * scale, err_msg=field)


def test_shears_jump_at_a_line_between_two_plates():
    """A plate of 4 m overhangs lines at x = 1 and 3 by 1 m; each takes 20 kN/m, half from either side."""
    shape, wider = (strip(0.2, (divisions, 1)) for divisions in (16, 24))
    model = Model(
        material={"E": 30e9, "nu": 0.0},
        plates={"p": shape, "z": {**wider, "size": [6, 0.5], "origin": [-1, 0]}},
        mesh={"error": False},
        contact=[{"between": ["p", "z"], "line": [[x, 0], [x, 0.5]]} for x in (1, 3)],
        support=[{"plate": "z", "edge": ["left", "right"], "fix": "clamped"}],
        load=[{"plate": "p", "pressure": 1e4}],
        probe=[{"plate": name, "at": [[1, 0.25], [0.98, 0.25], [1.02, 0.25]]} for name in ("p", "z")],
    )
    shears = np.array([probe.shear[0] for probe in solve(model)["all"].probes])
    np.testing.assert_allclose(np.abs(shears[0]), 10e3, rtol=1e-3)
    np.testing.assert_allclose(shears[1:3], [-9.8e3, 9.8e3], rtol=1e-3)
    np.testing.assert_allclose(shears[3:], [20e3, 20e3, 0], rtol=0, atol=20)


def test_shears_jump_at_the_outline_of_a_rigid_area():
    """At the outline x = 2 a clamped plate that lifts off between has −15 kN/m, its end 10 kN/m."""
    model = Model(
        material={"E": 30e9, "nu": 0.0},
        plate={"shape": "rectangle", "size": [4, 0.5], "thickness": 0.2},
        mesh={"divisions": [16, 1], "error": False},
        support=[
            {"area": {"rectangle": [0, 0, 2, 0.5]}, "resists": "down"},
            {"edge": "left", "fix": "clamped"},
        ],
        load=[{"line_load": 1e4, "edge": "right"}],
        probe=[{"at": [[1.95, 0.25], [2.05, 0.25]]}],
    )
    left, right = (probe.shear[0] for probe in solve(model)["all"].probes)
    # A propped cantilever: half of the moment 20 kNm/m goes over its length of 2 m.
    assert left == pytest.approx(-15e3, rel=0.01)
    assert right == pytest.approx(10e3, rel=0.02)


def test_a_refusal_of_two_plates_names_the_element_that_may_do_better() -> None:
    plate = {"shape": "rectangle", "size": [2.0, 2.0], "thickness": 0.2, "element": "q8r"}
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plates={"a": plate, "b": plate},
        mesh={"size": 1.0},
        support=[{"plate": name, "area": "all", "stiffness": 1e7} for name in ("a", "b")],
        load=[{"plate": "a", "pressure": 1e3}],
    )
    assert "mitc9" in uncertain(contact_problem(model).discretisation)
