"""Warnings about input that is solved but seldom meant; ordinary models have no warning."""

import json
import re
from pathlib import Path

import jsonschema
import pytest
from models import rectangular

import signorini
from signorini.analysis.check import check
from signorini.output import results_json

AREAS = {
    "partly": ({"rectangle": [0, 0, 2, 2]}, {"rectangle": [1, 1, 3, 3]}, True),
    "inside": ({"rectangle": [0, 0, 3, 3]}, {"circle": {"center": [1, 1], "radius": 0.5}}, True),
    "twice": ({"circle": {"center": [1, 1], "radius": 0.5}}, {"circle": {"center": [1, 1], "radius": 0.5}}, True),
    "side by side": ({"rectangle": [0, 0, 2, 2]}, {"rectangle": [2, 0, 4, 2]}, False),
    "in a notch": (
        {"polygon": [[0, 0], [3, 0], [3, 1], [1, 1], [1, 3], [0, 3]]},
        {"rectangle": [1, 1, 3, 3]},
        False,
    ),
    "touching": ({"circle": {"center": [1, 1], "radius": 0.5}}, {"rectangle": [1.5, 0, 3, 3]}, False),
}
PADS = {"name": "pads", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}
SOIL = {"name": "soil", "area": "all", "resists": "down", "stiffness": 1e4}


def model(**changes: object) -> signorini.Model:
    data = {
        "units": {"length": "m", "force": "kN"},
        "material": {"E": 30e6, "nu": 0.2},
        "support": [PADS],
        "load": [{"case": "G", "pressure": 5}],
    }
    return rectangular(**data | changes)


def warned(**changes: object) -> tuple[str, ...]:
    """Warnings of the one combination, which are those in results.json; those of the model are those of `check`."""
    given = model(**changes)
    # Warnings of ± are not about the model.
    results = signorini.solve(given.model_copy(update={"mesh": given.mesh.model_copy(update={"error": False})}))
    (result,) = results.values()
    assert results_json(results)["combinations"][0]["warnings"] == list(result.warnings)
    assert set(check(results.discretisation.model).warnings) <= set(result.warnings)
    return result.warnings


def test_an_ordinary_model_has_none() -> None:
    assert warned() == ()
    beds = [
        {"name": "west", "area": {"rectangle": [0, 0, 2, 4]}, "resists": "down", "stiffness": 1e4},
        {"name": "east", "area": {"rectangle": [2, 0, 4, 4]}, "resists": "down", "stiffness": 1e4},
        {"name": "ties", "area": "all", "resists": "up", "stiffness": 1e3},
        {"name": "stops", "at": [[1, 1]], "resists": "up", "gap": 0.1},
        PADS,
    ]
    assert warned(support=beds) == ()
    assert warned(load=[{"curvature": [1e-4, 1e-4, 0]}], support=[{"edge": "left", "fix": "clamped"}]) == ()
    assert warned(load=[{"pressure": 5}, {"moment": [3, 0], "at": [2, 2]}]) == ()


@pytest.mark.parametrize("file", sorted((Path(__file__).parents[1] / "examples").glob("*.toml")), ids=lambda f: f.stem)
def test_the_examples_have_none(file: Path) -> None:
    assert check(signorini.load(file)).warnings == ()


@pytest.mark.parametrize(
    ("length", "force", "modulus", "said"),
    [
        ("m", "N", 30e9, False),
        ("m", "N", 30e6, True),
        ("m", "kN", 30e9, True),
        ("m", "kN", 30, True),
        ("mm", "N", 30e3, False),
        ("mm", "N", 30e9, True),
        ("mm", "N", 30, True),
        ("in", "lbf", 29e6, False),
        ("ft", "kip", 4.2e6, False),
        ("", "", 30, False),
    ],
)
def test_a_modulus_in_another_unit(length: str, force: str, modulus: float, said: bool) -> None:
    found = check(model(units={"length": length, "force": force}, material={"E": modulus, "nu": 0.2})).warnings
    assert [f"E = {modulus:.4g} {force}/{length}²" in sentence for sentence in found] == [True] * said


@pytest.mark.parametrize(
    ("units", "said"),
    [
        ({"length": "m", "force": "kN"}, []),
        ({"force": "kp"}, []),
        ({"length": "meter"}, ['"meter"', 'Did you mean "m"?']),
        ({"length": "Millimeters"}, ['"Millimeters"', 'Did you mean "mm"?']),
        ({"length": "IN", "force": "Kips"}, ["in", "kips"]),
        ({"force": "KN"}, ["N, daN, kN, MN", 'Did you mean "kN"?']),
        ({"force": "newtons"}, ['"N"?']),
        ({"length": "furlong"}, ["mm, cm, dm, m, km, in, ft, yd"]),
    ],
)
def test_units_that_are_not_known(units: dict[str, str], said: list[str]) -> None:
    found = " ".join(check(model(units=units)).warnings)
    assert all(part in found for part in said) and bool(found) == bool(said)
    assert ("Did you mean" in found) == (bool(said) and "furlong" not in units.values())


@pytest.mark.parametrize(
    ("thickness", "said"),
    [(1.9, ""), ("0.2 + 0.9*x", ""), (2.4, "The thickness, 2.4 m, is 0.6 times"), (4.8, "4.8 m, is 1.2 times")],
)
def test_a_plate_that_is_a_block(thickness: float | str, said: str) -> None:
    shape = {"shape": "rectangle", "size": [5, 4], "thickness": thickness}
    stiff = {"area": {"rectangle": [1, 1, 2, 2]}, "thickness": 4.9}
    found = " ".join(check(model(plate=shape, zone=[stiff])).warnings)
    assert (
        (said + " the plate's smaller extent, 4 m; the thickness of a plate is at most a fifth" in found)
        if said
        else "smaller extent" not in found
    )


@pytest.mark.parametrize(("size", "said"), [(4.0, False), (400.0, True)])
def test_elements_larger_than_the_plate(size: float, said: bool) -> None:
    words = "The size of elements, 400 m, is 100 times the plate's larger extent, 4 m: was another unit meant?"
    assert (words in check(model(mesh={"size": size})).warnings) == said


@pytest.mark.parametrize(
    ("support", "said"),
    [
        ({"gap": 0.19}, ""),
        ({"gap": 5}, "The gap of stop, 5 m, is 25 times the plate's thickness: was another unit meant?"),
        ({"gap": "2*x", "resists": "both"}, "The gap of stop, 4 m, is 20 times"),
        ({"gap": 5, "stiffness": 1e5}, "The gap of stop, 5 m, is 25 times"),
        ({"settlement": -0.25}, "The settlement of stop, 0.25 m, is 1.2 times"),
        ({"settlement": "-x", "stiffness": 1e5}, "The settlement of stop, 2 m, is 10 times"),
        ({"settlement": 3, "fix": "simple"}, "The settlement of stop, 3 m, is 15 times"),
        ({"settlement": 0.2, "gap": 0.2}, ""),
    ],
)
def test_gaps_and_settlements_beyond_the_thickness(support: dict[str, object], said: str) -> None:
    one_sided = {} if {"fix", "resists"} & set(support) else {"resists": "up"}
    found = check(model(support=[PADS, {"name": "stop", "at": [2, 2], **one_sided, **support}])).warnings
    assert len(found) == bool(said) and said in " ".join(found)


def test_a_deflection_beyond_the_thickness() -> None:
    (sentence,) = warned(load=[{"pressure": 5e4}])
    assert sentence.startswith("The deflection at [") and "is beyond the thickness, 0.2 m: " in sentence
    assert sentence.endswith("Are E, thickness, loads and the stiffness of supports in the same units?")
    assert warned(load=[{"pressure": 5e2}]) == ()


@pytest.mark.parametrize(("wide", "told"), [(25.0, True), (75.0, False)])
def test_a_gasket_one_element_wide_is_told(wide: float, told: bool) -> None:
    gasket = {"name": "gasket", "area": {"annulus": {"inner": 300, "outer": 300 + wide}}, "resists": "down"}
    warnings = warned(
        units={"length": "mm", "force": "N"},
        material={"E": 2e5, "nu": 0.3},
        plate={"shape": "annulus", "inner": 200, "outer": 390, "thickness": 30},
        mesh={"size": 25},
        support=[gasket | {"stiffness": 200.0}],
        load=[{"pressure": 1}],
    )
    assert ["gasket is one element wide" in one for one in warnings] == [True] * told


@pytest.mark.parametrize(
    ("divisions", "words"), [([1, 1], "a single element,"), ([1, 6], "one element wide,"), ([2, 2], "")]
)
def test_one_element(divisions: list[int], words: str) -> None:
    said = warned(mesh={"divisions": divisions}, support=[{"edge": ["left", "right"], "fix": "simple"}])
    assert [words in sentence for sentence in said] == [True] * bool(words)


def test_areas_that_overlap() -> None:
    grout = {
        "name": "grout",
        "area": {"circle": {"center": [1, 1], "radius": 0.3}},
        "resists": "down",
        "stiffness": 1e5,
    }
    expected = "The areas of soil and grout overlap: in the overlap their stiffnesses add."
    assert warned(support=[SOIL, grout]) == (expected,)
    apart = SOIL | {"area": {"rectangle": [2, 0, 4, 4]}}
    assert warned(support=[apart, grout]) == ()


def test_a_bed_that_holds_the_plate_down_unsaid_beside_supports_that_do_not() -> None:
    bed = {"name": "grout", "area": "all", "stiffness": 1e5}
    anchors = {"at": [[1, 1], [3, 3]], "resists": "up", "stiffness": 1e5}
    (sentence,) = warned(support=[bed, anchors])
    assert sentence.startswith("grout holds the plate down too, since resists is left out.")
    for both in (bed, bed | {"resists": "both"}):
        beside = [] if both is bed else [anchors]
        assert warned(support=[both, *beside]) == ()


def test_a_bed_that_pulls_unsaid() -> None:
    bed = {"name": "soil", "area": "all", "stiffness": 1e5}
    aside = [{"force": 100, "at": [0.5, 0.5]}]
    (sentence,) = warned(support=[bed], load=aside)
    assert sentence.startswith("soil pulls the plate down, with up to ") and "since resists is left out." in sentence
    assert warned(support=[bed | {"resists": "both"}], load=aside) == warned(support=[bed]) == ()


def test_reactions_that_outweigh_what_acts_by_far() -> None:
    """A thin cantilever between a wall and a line beside it."""
    wall = {"name": "wall", "edge": "left", "fix": "simple"}
    plate = {"shape": "rectangle", "size": [4, 1], "thickness": 0.004}

    def said(x: float) -> list[str]:
        line = {"name": "line", "line": [[x, 0], [x, 1]], "fix": "simple"}
        sentences = warned(support=[wall, line], plate=plate, mesh={"divisions": [6, 2]}, load=[{"pressure": 1e-6}])
        return [sentence for sentence in sentences if "times the loads" in sentence]

    (sentence,) = said(1e-3)
    assert sentence.startswith("Reactions of wall and line add up to ") and not said(1e-2)


def test_two_rigid_points_at_one_place() -> None:
    props = {"name": "props", "at": [[2, 2], [3, 1]], "resists": "down"}
    first, second = warned(support=[PADS, props])
    assert first == "pads and props both hold the plate rigidly at [3, 1]: how they share the reaction is a convention."
    assert second == "Reactions of pads, props could be shared otherwise; the least are shown."


def test_a_resultant_of_zero() -> None:
    couple = [{"case": "G", "force": 3, "at": [1, 2]}, {"case": "G", "force": -3, "at": [3, 2]}]
    fixed = [{"edge": "left", "fix": "clamped"}]
    sentence = "The load's resultant is zero: its forces cancel each other. Do all forces have the right sign?"
    assert warned(load=couple, support=fixed) == (sentence,)
    assert warned(load=[{"pressure": 0}], support=fixed) == ("No load acts.",)
    for moved in ({"settlement": 0.001}, {"rotation": [0.001, 0]}):
        assert warned(load=[{"pressure": 0}], support=[fixed[0] | moved]) == ()


def test_points_that_can_do_nothing() -> None:
    walls = {"edge": ["left", "right"], "fix": "simple"}
    props = {"name": "props", "at": [[0, 1], [2, 1], [2, 3]], "resists": "down", "gap": 1e-5}
    (sentence,) = warned(support=[walls, props])
    assert sentence.startswith("props: 1 of its 3 points are where other supports hold the plate")


def test_of_a_table_they_are_said_once() -> None:
    wanted = [{"name": f"c{i}", "factors": {"G": i}} for i in range(1, 20)]
    results = signorini.solve(
        model(mesh={"divisions": [4, 1]}, load=[{"case": "G", "pressure": 3000}], combination=wanted)
    )
    wide, far = results_json(results)["table"]["warnings"]
    assert wide.startswith("The mesh is one element wide") and far.startswith("The deflection at [")
    json.dumps(results_json(results), allow_nan=False)


@pytest.mark.parametrize(
    ("support", "said"),
    [
        ({"area": "all", "resists": "both", "stiffness": 5e4}, ""),
        ({"area": "all", "resists": "both", "stiffness": 5e13}, "as good as rigid"),
        ({"area": "all", "resists": "both", "stiffness": 5e-4}, "as good as none"),
        ({"at": [[1, 1], [3, 1], [2, 3]], "stiffness": 1e5}, ""),
        ({"at": [[1, 1], [3, 1], [2, 3]], "stiffness": 1e11}, "as good as rigid"),
        ({"edge": "left", "stiffness": 1e-3}, "as good as none"),
    ],
)
def test_a_stiffness_in_another_unit(support: dict[str, object], said: str) -> None:
    warnings = check(model(support=[PADS, {"name": "bed", **support}])).warnings
    assert [warning for warning in warnings if "stiffness of bed" in warning and said in warning] or not said
    assert bool(warnings) == bool(said)


@pytest.mark.parametrize(("weight", "said"), [(25, False), (25e3, True), (0.025, True)])
def test_a_weight_in_another_unit(weight: float, said: bool) -> None:
    heavy = {"E": 30e6, "nu": 0.2, "unit_weight": weight}
    assert (
        any("unit_weight" in warning for warning in check(model(material=heavy, load=[{"self_weight": True}])).warnings)
        == said
    )
    assert check(model(material=heavy)).warnings == ()


@pytest.mark.parametrize(
    ("moment", "at", "said"), [([3, 0], [0, 2], True), ([0, 3], [0, 2], False), ([3, 0], [1, 2], False)]
)
def test_a_couple_that_an_edge_of_symmetry_takes(moment: list[float], at: list[float], said: bool) -> None:
    load, supports = [{"moment": moment, "at": at}, {"pressure": 5}], [PADS, {"edge": "left", "fix": "symmetry"}]
    assert (
        any("loads the support only" in warning for warning in check(model(support=supports, load=load)).warnings)
        == said
    )


def test_a_load_case_that_acts_in_no_combination() -> None:
    load, only = [{"case": "G", "pressure": 5}, {"case": "Gx", "pressure": 1}], {"name": "ULS", "factors": {"G": 1}}
    said = 'The load case "Gx" acts in no combination. Is its name spelled correctly?'
    assert warned(load=load, combination=[only]) == (said,)
    assert warned(load=load) == ()
    assert said not in signorini.path(model(load=load, combination=[only]), "G", "Gx", 2.0).warnings


@pytest.mark.parametrize(("at", "said"), [([9, 9], True), ([2, 2], False), ([4, 4], False)])
def test_smaller_elements_off_the_plate(at: list[float], said: bool) -> None:
    given = model(mesh={"size": 1, "refine": [{"at": [at], "size": 0.3}]})
    assert any("not on the plate" in warning for warning in check(given).warnings) == said


def test_places_off_the_plate_are_not_refined_and_said() -> None:
    places = [{"at": [100, 1]}, {"area": {"rectangle": [50, 50, 60, 60]}}, {"line": [[-5, -5], [-3, -3]]}]
    places += [{"circle": {"center": [20, 20], "radius": 2}}, {"at": [1, 1]}, {"line": [[-1, 1], [1, 1]]}]
    refined = {"size": 1, "refine": [{**place, "size": 0.5} for place in places]}
    found = [warning for warning in check(model(mesh=refined)).warnings if "refines no elements" in warning]
    kinds = ["point [100, 1]", "area", "line", "circle"]
    assert [warning.split(" of refinement")[0] for warning in found] == [f"The {kind}" for kind in kinds]


def test_the_size_that_is_told_makes_the_mesh_follow_a_line() -> None:
    wall, line = {"rectangle": [0.5, 1.9, 3.5, 2.15]}, [[0.5, 2.03], [3.5, 2.03]]

    def told(**mesh: object) -> tuple[str, ...]:
        load = [{"case": "G", "pressure": 1e3, "area": wall}, {"case": "Q", "line_load": 1e3, "line": line}]
        held = [{"edge": ["left", "right"], "fix": "simple"}]
        return check(rectangular(support=held, load=load, mesh=mesh)).warnings

    (sentence,) = told(size=0.6)
    found = re.search(r"elements of (\S+) or less along it, such as at \[0\.\d+, 2\.03\] \(mesh\.refine\)\.$", sentence)
    assert found and 'does not follow the line of load[2] (case "Q")' in sentence
    assert not told(size=0.6, refine=[{"line": line, "size": float(found[1])}])


@pytest.mark.parametrize(("one", "other", "overlap"), AREAS.values(), ids=AREAS)
def test_areas_of_one_case_that_overlap_are_named(one: object, other: object, overlap: bool) -> None:
    load = [{"case": "Q", "pressure": 2, "area": area} for area in (one, other)]
    said = [sentence for sentence in warned(load=load) if "load[1] and load[2]" in sentence]
    assert len(said) == overlap and all('case "Q"' in sentence for sentence in said)
    assert warned(load=[load[0], load[1] | {"case": "P"}, {"case": "Q", "pressure": 1}]) == ()


def test_footprints_that_overlap_are_named() -> None:
    soil = SOIL | {"stiffness": 1e5}
    columns = {"case": "G", "force": 10, "at": [[1, 1], [3, 3]], "patch": [0.4, 0.4]}
    assert warned(load=[columns, columns | {"at": [2, 2]}, columns | {"case": "Q"}], support=[soil]) == ()
    couple = {"case": "G", "moment": [1, 0], "at": [1, 1], "patch": [0.4, 0.4]}
    assert warned(load=[columns, couple], support=[soil]) == ()
    (said,) = warned(load=[columns, columns | {"at": [3.3, 3], "radius": 0.2, "patch": None}], support=[soil])
    assert 'load[1] and load[2] (case "G") overlap, such as at [3.' in said
    (said,) = warned(load=[columns | {"at": [[1, 1], [1.3, 1]]}], support=[soil])
    assert 'of load[1] (case "G") overlap' in said
    pads = PADS | {"patch": [0.5, 0.5], "stiffness": 1e4}
    assert warned(support=[pads, pads | {"name": "bolts", "resists": "up"}]) == ()
    (said,) = warned(support=[pads, pads | {"name": "posts", "at": [1.2, 1]}])
    assert said.startswith("Footprints of pads and posts overlap, such as at [1.1, 1]")


LORRY = {"case": "lorry", "line": [[1, 2], [3, 2]], "step": 1, "axles": [[0, 6], [0.6, 6]], "patch": [0.4, 0.4]}


def test_a_moving_load_that_no_combination_takes_is_named() -> None:
    combination = [{"name": "G", "factors": {"G": 1.0}}]
    (said,) = warned(moving=[LORRY], combination=combination)
    assert said.startswith('The moving load "lorry" acts in no combination.')
    taken = {"name": "traffic", "generate": "positions", "factors": {"lorry": 1.0}}
    assert check(model(moving=[LORRY], combination=[*combination, taken])).warnings == ()


def test_a_wheel_that_is_partly_off_the_plate_is_told_of_results_in_which_it_acts() -> None:
    moving = [LORRY | {"line": [[1, 2], [4, 2]]}]
    combination = [{"name": "G", "factors": {"G": 1.0}}, {"name": "end", "factors": {"G": 1.0, "lorry@3": 1.0}}]
    combination += [{"name": "middle", "factors": {"lorry@2": 1.0, "lorry@3": 0.0}}]
    given = model(moving=moving, combination=combination, support=[SOIL | {"stiffness": 1e5}])
    results = signorini.solve(given)
    assert [len(results[name].warnings) for name in ("G", "end", "middle")] == [0, 1, 0]
    assert results["end"].warnings[0].startswith('A wheel of the moving load "lorry" is partly off the plate: at lorry')
    assert check(given).warnings == results["end"].warnings
    assert check(model(moving=moving, combination=combination[:1])).warnings[0].startswith("The moving load")


@pytest.mark.parametrize(
    ("moving", "support", "names"),
    [
        ([LORRY], [SOIL | {"stiffness": 1e5}], ["all: lorry@0", "all: lorry@1", "all: lorry@2"]),
        ([], [PADS | {"resists": "both", "settlement": "0.001*x"}], ["all"]),
        ([], [{"edge": "left", "fix": "clamped", "rotation": [0.01, 0]}], ["all"]),
        ([], [SOIL, {"name": "tie", "at": [2, 2], "resists": "up", "stiffness": 1e4, "preload": 5}], ["all"]),
    ],
)
def test_a_moving_load_a_settlement_a_rotation_and_a_preload_act_without_a_load(moving, support, names) -> None:
    given = model(load=[], moving=moving, support=support)
    assert signorini.Model(**given.model_dump()) == given
    tables = {key: value for key, value in {"moving": moving, "support": support}.items() if value}
    plate = {"plate": {"shape": "disc", "radius": 2, "thickness": 0.2}}
    jsonschema.validate(plate | tables, signorini.schema())
    results = signorini.solve(given)
    assert list(results) == names
    for result in results.values():
        assert result.certificate.passed and result.deflection.any() and "No load acts." not in result.warnings


def test_a_model_in_which_nothing_acts_is_refused() -> None:
    with pytest.raises(signorini.InputError, match="'load' is missing"):
        model(load=[], support=[PADS | {"gap": 0.1}])


@pytest.mark.parametrize(("word", "meant"), [("tension", "up"), ("Compression", "down"), ("compression-only", "down")])
def test_words_for_the_way_a_support_resists_say_which_is_meant(word: str, meant: str) -> None:
    with pytest.raises(signorini.InputError, match=rf'resists.*found "{word}".*resists = "{meant}"'):
        model(support=[PADS | {"resists": word}])


def test_names_keep_their_capitals_in_sentences() -> None:
    bolt = {"name": "Tie", "at": [3.5, 2], "resists": "up", "stiffness": 1e4, "preload": 1}
    pads = {"name": "Pads", "area": {"rectangle": [1, 1, 3, 3]}, "resists": "down", "stiffness": 1e4}
    with pytest.raises(signorini.NoEquilibriumError, match=r"While tightening Tie: The plate tips .* of Pads"):
        signorini.solve(model(support=[pads, bolt], load=[{"pressure": 0.001}]))


@pytest.mark.parametrize(
    ("place", "apart"),
    [({"line": [[-0.005, 0], [-0.005, 4]]}, "0.005"), ({"line": [[1, 4.25], [3, 4.25]]}, "0.25")],
)
@pytest.mark.parametrize("facade", ["load", "support"])
def test_a_line_beside_the_plate_says_by_how_much_it_misses_it(place: object, apart: str, facade: str) -> None:
    tables = {"load": [{"line_load": 2} | place], "support": [PADS, {"fix": "simple"} | place]}
    with pytest.raises(signorini.InputError, match=rf"not on the plate.*misses the plate by {apart}"):
        signorini.solve(model(**{facade: tables[facade]}))
