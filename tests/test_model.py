import copy
import json
import pickle

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from models import rectangular, tables

from signorini import shapes
from signorini.errors import InputError
from signorini.formats.inputfile import loads
from signorini.model import Area, Combination, DiscPlate, Load, Material, MeshOptions, Model, Support, validate
from signorini.model.where import Where


def slab(**changes):
    return {
        "material": {"E": 30e9, "nu": 0.2, "unit_weight": 25e3},
        "plate": {"shape": "rectangle", "size": [10.0, 5.0], "thickness": 0.3},
        "mesh": {"divisions": [40, 40]},
        "support": [
            {"name": "walls", "edge": ["left", "right"], "fix": "simple"},
            {"at": [[2.5, 2.5], [7.5, 2.5]], "resists": "down", "gap": 0.001, "stiffness": "5e8*(1 + x)"},
            {"area": {"polygon": [[0, 0], [4, 0], [2, 3]]}, "resists": "down", "stiffness": 30e6},
        ],
        "load": [
            {"case": "G", "self_weight": True},
            {"case": "Q", "force": 20e3, "at": [5.5, 3.5]},
            {"case": "Q", "line_load": "x", "line": [[0, 0], [1, 1]]},
            {"case": "T", "curvature": [1e-5, 0, 0]},
            {"case": "T", "moment": [1, 2], "at": [[1, 1]]},
        ],
        "combination": [{"name": "ULS", "factors": {"G": 1.35, "Q": 1.5}}, {"factors": {"T": 1}}],
        "probe": [{"at": [5.0, 5.0]}],
        "solver": {"method": "lemke"},
        **changes,
    }


def test_defaults_are_filled_in():
    model = Model(**slab())
    walls, bearings, soil = model.support
    assert (walls.resists, walls.fixed, walls.place) == (None, ("w",), "edge")
    assert (bearings.name, bearings.resists, bearings.place) == ("support 2", "down", "at")
    assert soil.gap.value == 0
    assert soil.stiffness is not None and soil.stiffness.value == 30e6
    assert model.load_cases == ("G", "Q", "T")
    assert [load.kind for load in model.load] == ["self_weight", "force", "line_load", "curvature", "moment"]
    assert [combination.name for combination in model.combination] == ["ULS", "combination 2"]
    assert model.plate.shear_factor == 5 / 6
    assert Support(at=[0, 0]).resists == "both"
    assert Load(pressure=1).area == "all"


def test_no_combination_means_every_case_at_factor_one():
    (combination,) = Model(**slab(combination=[])).effective_combinations
    assert combination.name == "all"
    assert dict(combination.factors) == {"G": 1.0, "Q": 1.0, "T": 1.0}


def test_models_are_immutable_hashable_and_picklable():
    model = Model(**slab())
    with pytest.raises(AttributeError, match="Model is immutable; make a new Model with another title"):
        model.title = "other"
    with pytest.raises(TypeError):
        model.combination[0].factors["G"] = 2.0
    assert hash(model) == hash(copy.deepcopy(model))
    assert pickle.loads(pickle.dumps(model)) == model


def test_a_dumped_model_is_the_same_model():
    model = Model(**slab())
    assert validate(model.model_dump()) == model
    assert Model.model_validate_json(model.model_dump_json()) == model


EVERYTHING = {
    "title": 'Größe "1" \\ 荷重',
    "units": {"length": "m", "force": "kN"},
    "material": {"Ex": 30e9, "Ey": 1e10, "nu_xy": 0.2, "Gxy": 4e9, "unit_weight": 25e3},
    "plate": {
        "shape": "polygon",
        "points": [[0, 0], [6, 0], {"through": [7, 2], "to": [6, 4]}, [0, 4]],
        "thickness": "0.2 + 0.01*x",
        "holes": [{"circle": {"center": [1, 1], "radius": 0.3}}],
        "modifiers": {"twist": 0.7},
    },
    "mesh": {"size": 0.8, "refine": [{"at": [[2, 2]], "size": 0.2}], "error": False},
    "zone": [
        {
            "area": {"rectangle": [3, 1, 4, 2]},
            "thickness": 0.4,
            "material": {"E": 2e11, "nu": 0.3, "unit_weight": 78e3},
        }
    ],
    "support": [
        {"name": "soil", "area": "all", "resists": "down", "stiffness": [[0, 0, 1e7], [6, 0, 2e7], [0, 4, 3e7]]},
        {"name": "bolts", "at": [[1, 3], [5, 3]], "resists": "up", "law": [[0, 0], [0.001, 90e3], [0.01, 120e3]]},
        {"edge": ["edge 1"], "fix": ["w"], "settlement": "1e-3*x"},
    ],
    "load": [
        {"case": "G", "self_weight": True},
        {
            "case": "Q",
            "area": {"annulus": {"inner": 0.5, "outer": 1, "center": [3, 2]}},
            "pressure": "5e3*where(x>3, 1, 2)",
        },
        {"case": "Q", "at": [[2, 2]], "couple_about": {"x": 0, "y": 1e3}},
    ],
    "moving": [{"case": "crane", "line": [[1, 2], [5, 2]], "axles": [[0, 1e4], [1, 2e4]], "step": 1.0}],
    "combination": [
        {"name": "ULS", "group": "uls", "generate": "patterns", "permanent": {"G": [1.35, 1]}, "variable": {"Q": 1.5}},
        {"generate": "table", "columns": ["G", "Q"], "rows": {"a.b c": [1, 0], "ü": [1, 1]}},
        {"generate": "positions", "factors": {"crane": 1}},
        {"factors": {}},
    ],
    "probe": [{"at": [[2, 2], [3, 3]]}],
    "strip": [{"line": [[2, 2], [5, 2]], "width": 1, "stations": 3}],
    "profile": [{"circle": {"center": [3, 2], "radius": 1}}],
    "output": {"combinations": "table", "fields": "none", "envelope": ["mx"]},
}


@pytest.mark.parametrize("tables", [slab(), EVERYTHING], ids=["slab", "everything"])
def test_a_model_written_as_toml_or_as_json_is_read_as_the_same_model(tables):
    model = Model(**tables)
    assert loads(model.to_toml()) == model
    assert validate(json.loads(model.provenance.text)) == model


def test_a_model_of_table_objects_is_written_as_toml_too():
    model = Model(
        material=Material(E=30e9, nu=0.2),
        plate=DiscPlate(radius=2, thickness=0.2),
        support=[Support(edge="rim", fix="simple")],
        load=[Load(pressure=1e3)],
    )
    assert loads(model.to_toml()) == model


def test_a_function_has_no_toml():
    soil = {"area": "all", "stiffness": lambda x, y: 1e7 + x}
    with pytest.raises(InputError, match="lambda"):
        Model(**slab(support=[soil])).to_toml()


def test_a_copy_with_other_combinations_has_these():
    model = Model(**slab(combination=[{"name": "G", "factors": {"G": 1}}]))
    assert [one.name for one in model.effective_combinations] == ["G"]
    copy = model.model_copy(update={"combination": (Combination(name="Q", factors={"Q": 1}),)})
    assert [one.name for one in copy.effective_combinations] == ["Q"]


def test_numpy_numbers_and_arrays_and_table_objects_are_accepted():
    points = np.array([[1.0, 2.0], [3.0, 4.0]])
    model = Model(
        material={"E": np.float32(2), "nu": np.float64(0.3)},
        plate=DiscPlate(radius=np.int64(5), thickness="0.1 + x*x"),
        mesh=MeshOptions(divisions=np.array([2, 8])),
        support=[Support(at=points), Support(edge=np.array(["rim"]), fix=np.array(["w", "slope"]))],
        load=[Load(force=1, at=points[0])],
        combination=[Combination(factors={"load": 2})],
        output={"fields": np.array(["combination 1"])},
    )
    assert model.support[1].edge == ("rim",) and model.support[1].fix == ("w", "slope")
    assert model.support[0].at == ((1.0, 2.0), (3.0, 4.0))
    assert model.load[0].at == ((1.0, 2.0),)
    assert model.plate.thickness.is_constant is False


def test_an_array_where_tables_are_is_told_with_its_place():
    with pytest.raises(InputError, match=r"load\[1\]"):
        validate(slab() | {"load": np.array([[1, 2]])})


@pytest.mark.parametrize(
    ("plate", "edges"),
    [
        ({"shape": "rectangle", "size": [1, 1]}, {"left", "right", "bottom", "top"}),
        ({"shape": "disc", "radius": 1}, {"rim"}),
        ({"shape": "disc", "radius": 1, "sector": 90}, {"rim", "start", "end"}),
        ({"shape": "annulus", "inner": 1, "outer": 2}, {"inner", "outer"}),
        ({"shape": "annulus", "inner": 1, "outer": 2, "sector": 77.5}, {"inner", "outer", "start", "end"}),
    ],
)
def test_a_plate_has_the_edges_of_its_shape(plate, edges):
    plate = {**plate, "thickness": 0.1}
    assert set(Model(**slab(plate=plate, support=[])).plate.edge_names) == edges
    for edge in edges:
        validate(slab(plate=plate, support=[{"edge": edge}]))
    with pytest.raises(InputError, match="Unknown edge 'middle'"):
        validate(slab(plate=plate, support=[{"edge": "middle"}]))


@pytest.mark.parametrize(
    ("plate", "mesh", "divisions"),
    [
        ({"shape": "rectangle", "size": [10, 5]}, {}, (20, 10)),
        ({"shape": "rectangle", "size": [10, 5]}, {"size": 1}, (10, 5)),
        ({"shape": "rectangle", "size": [0.3, 0.1]}, {"size": 0.1}, (3, 1)),
        ({"shape": "rectangle", "size": [10, 5]}, {"divisions": [3, 4]}, (3, 4)),
        ({"shape": "disc", "radius": 1}, {}, (10, 63)),
        ({"shape": "disc", "radius": 1, "sector": 90}, {}, (20, 32)),
        ({"shape": "annulus", "inner": 1, "outer": 2}, {"size": 0.5}, (2, 26)),
    ],
)
def test_divisions_follow_from_counts_size_or_twenty_along_the_longer_side(plate, mesh, divisions):
    model = Model(**slab(plate={**plate, "thickness": 0.1}, mesh=mesh, support=[]))
    assert model.plate.divisions(model.mesh) == divisions


@pytest.mark.parametrize(
    ("corners", "says"),
    [
        ([[0, 0], [1, 1], [1, 0], [0, 1]], "crosses or touches itself: the sides from corners 1 and 3 meet"),
        ([[0, 0], [1, 1], [2, 2]], "encloses nothing"),
        ([[0, 0], [1, 0]], "at least 3 corners"),
        ([[0, 0], [1, 0], [1, 1], [0, 0]], "the last corner equals the first"),
        ([[float(i), float(i * i)] for i in range(2001)], "at most 2000"),
    ],
)
def test_polygon_that_is_no_outline_is_refused(corners, says):
    with pytest.raises(InputError, match=says):
        Area(polygon=corners)


def test_a_model_made_in_python_is_refused_in_the_words_of_an_input_file():
    wrong = slab(plate={"shape": "rectangle", "size": [4, 4], "thickness": -0.1}, support=[{"stifness": 0}])
    for make in (lambda: Model(**wrong), lambda: validate(wrong)):
        with pytest.raises(InputError) as caught:
            make()
        assert str(caught.value).splitlines()[1:] == [
            "  plate.thickness: found -0.1; it must be greater than 0.",
            "  support[1].stifness: unknown key 'stifness'. Did you mean 'stiffness'? Allowed here: name, plate, at, "
            "edge, line, circle, area, nodes, patch, angle, radius, fix, resists, gap, stiffness, limit, law, "
            "rotational_stiffness, settlement, between, preload, preload_case, order, rotation.",
        ]
    with pytest.raises(InputError, match=r"^stiffness: found 0; it must be greater than 0.$"):
        Support(at=[1, 1], stiffness=0)


def test_one_problem_is_one_line_with_its_place():
    with pytest.raises(InputError) as caught:
        validate(slab(support=[{"name": "soil", "area": "all", "stiffness": -3}]))
    assert caught.value.place == 'support[1].stiffness ("soil")'
    assert caught.value.message == "found -3; it must be greater than 0."


def test_every_problem_is_listed_up_to_twenty():
    with pytest.raises(InputError) as caught:
        validate(slab(load=[{"force": "a", "at": [0, 0]}] * 30))
    lines = str(caught.value).splitlines()
    assert lines[0] == "30 problems:"
    assert lines[1] == '  load[1].force: found "a"; it must be a number. Write digits without quotes, such as 30e9.'
    assert lines[-1] == "  and 10 more."


@pytest.mark.parametrize("data", [None, 3, [], "text", {1: 2}, {"load": {}}, {"support": 3}])
def test_what_is_no_mapping_of_tables_is_an_input_error(data):
    with pytest.raises(InputError):
        validate(data)


_garbage = st.one_of(
    st.sampled_from(
        [None, True, False, float("nan"), float("inf"), -1, 0, 1e300, 10**400, "", "x", "1/0", "all", b"x"]
    ),
    st.sampled_from([[], {}, [[]], [1], [1, 2], [1, 2, 3], [[1, 2], [1, 2]], [{}], {"radius": 1}, {"circle": {}}]),
    st.integers(-3, 3),
    st.text(max_size=5),
).map(copy.deepcopy)


def _places(node, path=()):
    yield path
    parts = node.items() if isinstance(node, dict) else enumerate(node) if isinstance(node, list) else ()
    for key, part in parts:
        yield from _places(part, (*path, key))


@settings(max_examples=150, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_mutated_models_are_models_or_input_errors(data):
    model = copy.deepcopy(slab())
    plates = [
        {"shape": "disc", "radius": 3.0, "sector": 90, "thickness": 0.1, "center": [1.0, 1.0]},
        {"shape": "annulus", "inner": 1.0, "outer": 2.0, "thickness": "0.1 + y"},
        {"shape": "mesh", "file": "plate.msh", "thickness": 1},
        model["plate"],
    ]
    model["plate"] = data.draw(st.sampled_from(plates))
    for _ in range(data.draw(st.integers(1, 4))):
        places = [path for path in _places(model) if path]
        if not places:
            break
        *path, key = data.draw(st.sampled_from(places))
        parent = model
        for step in path:
            parent = parent[step]
        match data.draw(st.sampled_from(["delete", "replace", "add", "double"])):
            case "delete":
                del parent[key]
            case "replace":
                parent[key] = data.draw(_garbage)
            case "add" if isinstance(parent, dict):
                parent[data.draw(st.sampled_from(["at", "area", "fix", "gap", "stifness", "name", "x"]))] = data.draw(
                    _garbage
                )
            case _ if isinstance(parent, list):
                parent.append(copy.deepcopy(parent[key]))
    try:
        assert isinstance(validate(model), Model)
    except InputError as error:
        assert "does not fit here" not in str(error)
        assert not any(word in str(error) for word in ("pydantic", "Value error", "type=", "Input should"))


def test_a_plate_by_its_stiffness_needs_no_material() -> None:
    stiffness = {"Dx": 4e6, "Dy": 4e6, "D1": 0.0, "Dxy": 1e6, "Sx": 1e9, "Sy": 1e9}
    without = tables(load=[{"case": "Q", "pressure": 1}])
    del without["material"]
    with pytest.raises(InputError, match="'E' is missing"):
        Model(**without)
    without["plate"] |= {"stiffness": stiffness}
    assert Model(**without).material.unit_weight is None


def test_the_least_size_that_a_message_names_is_allowed() -> None:
    """1e-60 was refused, since it must be at least 1e-60."""
    held = [{"edge": "left", "fix": "clamped"}]
    model = rectangular(material={"E": 1e-60, "nu": 0.3}, support=held, load=[{"pressure": 1.0}])
    assert model.material.E == 1e-60


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ({"at": [[1, 2], [3, 4]]}, Where("at", points=((1.0, 2.0), (3.0, 4.0)))),
        (
            {"at": [1, 2], "radius": 0.5},
            Where("at", points=((1.0, 2.0),), footprints=(shapes.Circle((1.0, 2.0), 0.5),)),
        ),
        (
            {"at": [1, 2], "patch": [2, 4]},
            Where("at", ((1.0, 2.0),), footprints=(shapes.Rectangle(0.0, 0.0, 2.0, 4.0),)),
        ),
        ({"nodes": 7}, Where("at")),
        ({"edge": "left"}, Where("edge", edges=("left",))),
        ({"line": [[0, 0], [1, 1]]}, Where("line", curve=shapes.Polyline(((0.0, 0.0), (1.0, 1.0))))),
        ({"circle": {"radius": 2}}, Where("circle", curve=shapes.Ring((0.0, 0.0), 2.0))),
        ({"area": "all"}, Where("area")),
        ({"area": {"rectangle": [0, 0, 1, 2]}}, Where("area", region=shapes.Rectangle(0.0, 0.0, 1.0, 2.0))),
    ],
)
def test_a_support_says_where_it_is(said, expected):
    assert Support(**said).where == expected


def test_a_load_without_a_place_is_all_over_the_plate():
    for load in (Load(pressure=1), Load(self_weight=True), Load(curvature=[1, 0, 0])):
        assert load.where == Where("area")
        assert load.where.covers(np.array([[0.0, 0.0], [9.0, 9.0]])).all()


def test_a_support_of_which_nothing_is_said_is_the_same_after_dump_and_load():
    model = Model(**slab(support=[{"at": [[1, 1], [3, 1], [2, 3]]}]))
    again = [Model(**model.model_dump()), Model.model_validate_json(model.model_dump_json())]
    assert again == [model, model]
    assert all(one.support[0].resists_by_default and one.support[0].resists == "both" for one in again)
    assert not Support(at=[1, 1], resists="both").resists_by_default
