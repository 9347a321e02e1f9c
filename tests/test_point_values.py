"""Lists with one value for each point of a support: the same as a support for each point."""

import pickle
import tomllib
from typing import Any

import jsonschema
import numpy as np
import pytest
from models import rectangular as build

import signorini
from signorini import InputError, Model, solve
from signorini.discretise import discretise

PLACES = [[0.5, 0.5], [3.5, 0.5], [2.0, 3.5], [2.1, 1.9]]
LISTS: dict[str, Any] = {
    "gap": [0, 1e-3, 2e-4, 1e-4],
    "stiffness": [1e7, 2e7, 3e7, 4e7],
    "settlement": [0, 1e-4, 0, -2e-4],
    "limit": [1e5, 1.2e4, 3e4, 5e4],
}


def of_each_point(keys: dict[str, Any]) -> list[dict[str, Any]]:
    """Supports that have the values of the points."""

    def value_of(value: Any, number: int) -> Any:
        return value[number] if isinstance(value, list) and len(value) == len(PLACES) else value

    return [
        {"at": at} | {key: value_of(value, number) for key, value in keys.items()} for number, at in enumerate(PLACES)
    ]


KINDS: list[dict[str, Any]] = [
    {"resists": "down"},
    {"resists": "both"},
    {"resists": "down", "radius": 0.2},
    {"resists": "both", "patch": [0.2, 0.3], "angle": 20},
    {"resists": "down", "stiffness": None, "limit": None},
    {"resists": "both", "stiffness": None, "limit": None, "gap": None},
    {"fix": "simple", "stiffness": None, "limit": None, "gap": None, "settlement": [0, 1e-3, 0, 2e-3]},
]


@pytest.mark.parametrize("kind", KINDS)
def test_a_list_is_a_support_for_each_point(kind: dict[str, Any]) -> None:
    keys = {key: value for key, value in (LISTS | kind).items() if value is not None}
    load = [{"pressure": 5e3}, {"force": 5e3, "at": [2, 1.5]}]
    together = solve(build(support=[{"at": PLACES} | keys], load=load))["all"]
    apart = solve(build(support=of_each_point(keys), load=load))["all"]
    (support,) = together.supports
    assert support.reactions == pytest.approx([one.reaction for one in apart.supports], rel=1e-9)
    assert support.gaps == pytest.approx([one.gaps[0] for one in apart.supports], abs=1e-12)
    assert support.states == [one.states[0] for one in apart.supports]
    assert together.deflection == pytest.approx(apart.deflection, rel=1e-9, abs=1e-12)


def test_a_list_between_plates_and_of_bolts_in_turn() -> None:
    plate = {"shape": "rectangle", "size": [4, 4], "thickness": 0.2, "mesh": {"divisions": [4, 4]}}
    between = {"between": ["upper", "lower"], "resists": "up"}
    bolts = between | {"stiffness": [1e7, 2e7, 1e7, 2e7], "preload": [1e4, 2e4, 3e4, 4e4], "order": [2, 1, 2, 3]}
    pads = {"between": ["upper", "lower"], "at": PLACES, "stiffness": 5e7}

    def joined(supports: list[dict[str, Any]]) -> signorini.Result:
        soil = {"plate": "lower", "area": "all", "stiffness": 1e7, "resists": "down"}
        tables = {"support": [soil, *supports], "contact": [pads | {"gap": [0, 0, 1e-5, 0]}]}
        load = [{"plate": "upper", "pressure": 1e3}]
        material, plates = {"E": 30e9, "nu": 0.2}, {"upper": plate, "lower": plate}
        return solve(signorini.validate({"material": material, "plates": plates, "load": load} | tables))["all"]

    together, apart = joined([{"at": PLACES} | bolts]), joined(of_each_point(bolts))
    assert together.supports[1].reactions == pytest.approx([one.reaction for one in apart.supports[1:5]], rel=1e-8)
    assert together.supports[2].reactions == pytest.approx(apart.supports[5].reactions, rel=1e-8)
    assert together.supports[1].preloads is not None and together.supports[1].tightened_to is not None
    assert together.supports[1].tightened_to == pytest.approx([-1e4, -2e4, -3e4, -4e4])
    assert together.supports[1].preloads[3] == pytest.approx(-4e4, rel=1e-9)


def test_values_go_with_their_points_where_these_are_snapped() -> None:
    keys = {"fix": "simple", "settlement": [1e-3, 0.0, 2e-3]}
    wall = {"edge": "left", "fix": "simple"}
    at = [[3.99, 0.01], [4, 4], [3.9, 2]]
    mesh = {"divisions": [4, 4], "snap": 0.05}
    found = solve(build(load=[{"pressure": 1e3}], support=[wall, {"at": at} | keys], mesh=mesh))["all"]
    down = [probe.deflection for probe in found.probe([[4, 0], [4, 4], [3.9, 2]])]
    assert down == pytest.approx([1e-3, 0.0, 2e-3], abs=1e-12)


def test_a_model_with_lists_is_the_same_after_dump_pickle_and_schema() -> None:
    text = """
    material = { E = 30e9, nu = 0.2 }
    plate = { shape = "rectangle", size = [4, 4], thickness = 0.2 }
    [[support]]
    name = "feet"
    at = [[1, 1], [3, 1], [2, 3]]
    gap = [0, 0.1, 0.3]
    stiffness = [1e7, 2e7, 3e7]
    [[support]]
    name = "bolts"
    at = [[0.5, 0.5], [3.5, 3.5]]
    resists = "up"
    [[support]]
    at = [[0.5, 3.5], [3.5, 0.5]]
    resists = "up"
    preload = [1e3, 2e3]
    order = [2, 1]
    [[tightening]]
    support = "bolts"
    force = [1e3, 2e3]
    sequence = [[2], 1]
    [[load]]
    pressure = 1e3
    """
    data = tomllib.loads(text)
    jsonschema.validate(data, signorini.schema())
    model = signorini.validate(data)
    assert Model(**model.model_dump()) == model == pickle.loads(pickle.dumps(model))
    assert signorini.validate(model.model_dump(mode="json", exclude_unset=True)) == model
    assert model.support[0].model_dump(exclude_unset=True)["gap"] == [0.0, 0.1, 0.3]
    arrays = data | {"support": [data["support"][0] | {"gap": np.array([0, 0.1, 0.3])}, *data["support"][1:]]}
    assert Model(**arrays) == model
    assert model.support[1].is_bolt and model.support[2].is_bolt and not model.support[0].is_bolt


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"gap": [0, 0.1]}, "support[1].gap: found a list of 2 for 4 points"),
    ({"order": [1, 2], "preload": 1e3, "resists": "up"}, "support[1].order: found a list of 2 for 4 points"),
    ({"gap": [0, 0.1, -0.1, 0]}, "support[1].gap: value 3 of the list: found -0.1; it must not be less than 0"),
    ({"limit": [1, 0, 1, 1]}, "support[1].limit: value 2 of the list: found 0; it must be greater than 0"),
    ({"stiffness": [1, "x", 1, 1]}, 'support[1].stiffness: value 2 of the list: found "x"; it must be a number'),
    ({"gap": []}, "support[1].gap"),
    ({"order": [], "preload": 1e3, "resists": "up"}, "support[1].order"),
    ({"at": None, "edge": "left", "settlement": [0, 1]}, "support[1].settlement: found [0.0, 1.0]; a list with one"),
    ({"at": None, "area": "all", "stiffness": [1e3, 1e3]}, "support[1].stiffness: found [1000.0, 1000.0]; a list"),
    ({"preload": 1e3, "resists": "up", "gap": [0, 0, 1, 0]}, "support[1].gap: a gap is not allowed with a preload"),
    ({"fix": "simple", "resists": None, "gap": [0, 0, 1, 0]}, "support[1].gap: a gap is not allowed with fix"),
]


@pytest.mark.parametrize(("keys", "message"), WRONG)
def test_a_list_that_does_not_fit_is_refused_with_its_place(keys: dict[str, Any], message: str) -> None:
    own = {key: value for key, value in ({"at": PLACES, "resists": "down"} | keys).items() if value is not None}
    with pytest.raises(InputError) as caught:
        discretise(build(support=[own]))
    assert message in str(caught.value)
