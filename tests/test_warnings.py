"""Warnings: what is solved all the same, but seldom meant; and that ordinary models have none."""

import json
import tomllib
from pathlib import Path

import pytest
from models import rectangular

import signorini
from signorini.analysis.check import check
from signorini.output import results_json

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
    # What ± says is not of the model.
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
    data = tomllib.loads(file.read_text("utf-8"))
    assert check(signorini.validate(data)).warnings == ()


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
        ("furlong", "N", 30, False),
    ],
)
def test_a_modulus_in_another_unit(length: str, force: str, modulus: float, said: bool) -> None:
    found = check(model(units={"length": length, "force": force}, material={"E": modulus, "nu": 0.2})).warnings
    assert [f"E = {modulus:.4g} {force}/{length}²" in sentence for sentence in found] == [True] * said


def test_a_deflection_beyond_the_thickness() -> None:
    (sentence,) = warned(load=[{"pressure": 5e4}])
    assert sentence.startswith("The deflection at [") and "is beyond the thickness, 0.2 m: " in sentence
    assert warned(load=[{"pressure": 5e2}]) == ()


@pytest.mark.parametrize(
    ("divisions", "words"), [([1, 1], "one element,"), ([1, 6], "one element wide,"), ([2, 2], "")]
)
def test_one_element(divisions: list[int], words: str) -> None:
    said = warned(mesh={"divisions": divisions}, support=[{"edge": ["left", "right"], "fix": "simple"}])
    assert [words in sentence for sentence in said] == [True] * bool(words)


def test_areas_that_overlap() -> None:
    grout = {"name": "grout", "area": {"circle": {"center": [1, 1], "radius": 0.3}}, "stiffness": 1e5}
    expected = "The areas of soil and grout overlap: where they do, their stiffness adds."
    assert warned(support=[SOIL, grout]) == (expected,)
    apart = SOIL | {"area": {"rectangle": [2, 0, 4, 4]}}
    assert warned(support=[apart, grout]) == ()


def test_two_rigid_points_at_one_place() -> None:
    props = {"name": "props", "at": [[2, 2], [3, 1]], "resists": "down"}
    first, second = warned(support=[PADS, props])
    assert first == "pads and props both hold the plate rigidly at [3, 1]: how they share its reaction is a convention."
    assert second == "Reactions of pads, props could be shared otherwise; the least are shown."


def test_a_resultant_of_zero() -> None:
    couple = [{"case": "G", "force": 3, "at": [1, 2]}, {"case": "G", "force": -3, "at": [3, 2]}]
    fixed = [{"edge": "left", "fix": "clamped"}]
    sentence = "The load's resultant is zero: its forces cancel each other. Is each of the sign that is meant?"
    assert warned(load=couple, support=fixed) == (sentence,)
    assert warned(load=[{"pressure": 0}], support=fixed) == ("No load acts.",)
    for moved in ({"settlement": 0.001}, {"rotation": [0.001, 0]}):
        assert warned(load=[{"pressure": 0}], support=[fixed[0] | moved]) == ()


def test_points_that_can_do_nothing() -> None:
    walls = {"edge": ["left", "right"], "fix": "simple"}
    props = {"name": "props", "at": [[0, 1], [2, 1], [2, 3]], "resists": "down", "gap": 1e-5}
    (sentence,) = warned(support=[walls, props])
    assert sentence == (
        "props: 1 of its 3 points are where other supports hold the plate, and can do nothing there. Results number "
        "the other points without them."
    )


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
        ({"area": "all", "stiffness": 5e4}, ""),
        ({"area": "all", "stiffness": 5e13}, "as good as rigid"),
        ({"area": "all", "stiffness": 5e-4}, "as good as none"),
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


@pytest.mark.parametrize(("x", "said"), [(0.1, True), (0.3, False), (0.0, False)])
def test_a_rigid_point_beside_an_edge_that_is_held(x: float, said: bool) -> None:
    wall, prop = {"edge": "left", "fix": "clamped"}, {"name": "prop", "at": [x, 2], "resists": "down"}
    assert any("pry against" in warning for warning in check(model(support=[wall, prop])).warnings) == said


@pytest.mark.parametrize(
    ("moment", "at", "said"), [([3, 0], [0, 2], True), ([0, 3], [0, 2], False), ([3, 0], [1, 2], False)]
)
def test_a_couple_that_an_edge_of_symmetry_takes(moment: list[float], at: list[float], said: bool) -> None:
    load, supports = [{"moment": moment, "at": at}, {"pressure": 5}], [PADS, {"edge": "left", "fix": "symmetry"}]
    assert any("does nothing" in warning for warning in check(model(support=supports, load=load)).warnings) == said
