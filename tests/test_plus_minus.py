"""Half-widths: how far the mesh is from the plate, as other meshes show it."""

import csv
import itertools
import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies
from models import rectangular, tables

import signorini
from signorini import Estimate, Model, Result, estimate, solve
from signorini.accuracy.half_width import beside, half_widths
from signorini.accuracy.meshes import meshes_beside
from signorini.analysis import other_meshes
from signorini.analysis.estimate import estimates_of
from signorini.base.numbers import estimated, plain
from signorini.discretise import discretise
from signorini.errors import InputError
from signorini.mesh.meshers import disc
from signorini.output import results_json, write
from signorini.results.figures import figures
from signorini.results.marks import panel
from signorini.results.quantities import SIDES

POINTS = [[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]]
EDGES = ["left", "right", "bottom", "top"]


def slab(**others: Any) -> Model:
    """A slab on bearings and on soil under a corner."""
    given: dict[str, Any] = {
        "support": [
            {"name": "feet", "at": POINTS, "resists": "down"},
            {"name": "soil", "area": {"rectangle": [0, 0, 2, 2]}, "resists": "down", "stiffness": 1e7},
            {"name": "wall", "edge": "right", "resists": "down"},
        ],
        "load": [{"pressure": 5e3}, {"force": 1e3, "at": [3.5, 2.0]}],
        "probe": [{"at": [[2.0, 2.0], [0.5, 0.5]]}],
    }
    return rectangular(**given | others)


@pytest.fixture(scope="module")
def result() -> Result:
    return solve(slab())["all"]


@pytest.fixture(scope="module")
def estimated_result(result: Result) -> Estimate:
    return estimate(result)


def widths_of(result: Result) -> Any:
    """Half-widths by the keys of results.json."""
    return estimate(result).plus_minus


def written_of(results: signorini.Results) -> Any:
    """Give results.json with half-widths."""
    return results_json(results, estimate(results))


@pytest.mark.parametrize("divisions", [[8, 8], [10, 6], [16, 16]])
def test_shears_alike_on_both_sides_of_a_wall_are_of_the_same_side_on_every_mesh(divisions: list[int]) -> None:
    """Without a rule rounding picks the side on each mesh, and the half-width is at least their difference."""
    support = [{"edge": EDGES[:2], "fix": "simple"}, {"line": [[4, 0], [4, 4]], "fix": "simple"}]
    probe = [{"at": [[4, 2], [4, 1.3]]}]
    model = rectangular(size=(8, 4), divisions=divisions, support=support, load=[{"pressure": 1e3}], probe=probe)
    found = solve(model)["all"]
    for at, width in zip(found.probes, widths_of(found)["probes"], strict=True):
        assert at.shear[0] > 0
        assert width["shear"][0] < 0.1 * at.shear[0]


def same_shape(value: Any, width: Any) -> bool:
    """Whether a tree of half-widths is built like that of the numbers."""
    match value:
        case dict():
            return value.keys() == width.keys() and all(same_shape(value[key], width[key]) for key in value)
        case list():
            return len(value) == len(width) and all(map(same_shape, value, width))
        case str() | None:
            return bool(value == width)
        case _:
            return width is None or (isinstance(width, float) and width >= 0)


def test_half_widths_are_built_like_the_numbers_they_are_of(estimated_result: Estimate) -> None:
    assert same_shape(figures(estimated_result.result), estimated_result.plus_minus)


def test_what_the_input_gives_has_none_and_what_is_of_the_mesh_has_no_half_width(estimated_result: Estimate) -> None:
    widths: Any = estimated_result.plus_minus
    feet, soil, wall = widths["supports"]
    assert feet["points"][0]["at"] == [0.0, 0.0] == widths["probes"][0]["at"]
    assert feet["closed"] is not None
    assert soil["closed"] is None
    assert all(node["reaction"] is None for node in wall["nodes"])
    assert soil["contact_area"] == pytest.approx(0, abs=1e-8)
    assert soil["max_pressure"] > 0


def test_the_edge_of_contact_has_half_widths_along_both_axes() -> None:
    model = rectangular(
        divisions=(12, 12),
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e7}],
        load=[{"pressure": 1e3}, {"force": 60e3, "at": [0.5, 2.0]}],
    )
    found = solve(model)["all"]
    (line,), own = found.supports[0].contact_boundary, widths_of(found)["supports"][0]
    (widths,) = own["contact_boundary"]
    assert np.shape(widths) == line.shape
    assert 0 < np.max(widths) < 0.1
    assert 0 < own["contact_area"] < 0.3


def test_half_widths_at_free_edges_of_thin_plates_know_the_layer_that_no_mesh_shows() -> None:
    thin = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [1, 1], "thickness": 0.001},
        mesh={"divisions": [16, 16]},
        support=[{"edge": ["bottom", "top"], "fix": "simple"}],
        load=[{"pressure": 1e3}],
        probe=[{"at": [[0, 0.25], [0.01, 0.25]]}],
    )
    result = solve(thin)["all"]
    edge, inside = result.probes
    at_edge, beside_it = widths_of(result)["probes"]
    # A free edge has no twist and no shear across it; the lost twist is a shear along it.
    twist = abs(edge.moment[2])
    assert twist == pytest.approx(10.7, rel=0.01)
    assert at_edge["moment"][2] == pytest.approx(twist, rel=0.02)
    assert at_edge["shear"][0] > abs(edge.shear[0])
    assert at_edge["shear"][1] == pytest.approx(twist * math.sqrt(10) / 0.001, rel=0.1)
    assert beside_it["moment"][2] < 0.02 * abs(inside.moment[2])


def test_a_moment_under_a_point_force_has_no_half_width_and_is_named() -> None:
    model = rectangular(
        divisions=(16, 16),
        support=[{"edge": EDGES, "fix": "simple"}],
        load=[{"force": 1e3, "at": [2, 2]}],
        probe=[{"at": [[2, 2], [1, 2]]}],
    )
    solved = solve(model)
    estimates = estimate(solved)
    found: Any = estimates["all"]
    at, beside = found.plus_minus["probes"]
    assert at["moment"][:2] == [None, None]
    assert None not in beside["moment"]
    (sentence,) = found.warnings
    assert "moment mx, moment my" in sentence
    assert sentence in results_json(solved, estimates)["combinations"][0]["warnings"]


def test_what_a_clamped_point_carries_turns_without_a_limit_wherever_it_is() -> None:
    found = solve(
        rectangular(
            plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.5},
            divisions=[8, 8],
            support=[{"at": [1.9, 2.1], "fix": "clamped"}],
            load=[{"pressure": 1e3, "area": {"rectangle": [2.5, 0.5, 3.5, 3.5]}}],
            probe=[{"at": [3.5, 3.2]}],
        )
    )["all"]
    compared: Any = estimate(found)
    (width,) = compared.plus_minus["probes"]
    assert (width["deflection"], width["rotation"][0], compared.plus_minus["deflection"]["max"]) == (None, None, None)
    assert all(moment > 0 for moment in width["moment"])
    assert "deflection, rotation θx of the probe at [3.5, 3.2]" in compared.warnings[0]


def test_the_largest_pressure_of_a_rigid_area_smaller_than_an_element_has_no_half_width() -> None:
    found = solve(
        rectangular(
            divisions=[5, 5],
            support=[
                {"edge": EDGES, "fix": "simple"},
                {"name": "pad", "area": {"circle": {"center": [2.3, 2.1], "radius": 0.2}}, "resists": "down"},
            ],
            load=[{"pressure": 1e3}],
        )
    )["all"]
    compared: Any = estimate(found)
    pad = compared.plus_minus["supports"][1]
    assert (pad["max_pressure"], pad["reaction"] > 0) == (None, True)
    assert "max pressure of pad" in compared.warnings[0]


def test_the_largest_tension_of_a_rigid_area_that_holds_down_has_no_half_width_either() -> None:
    pad = {"name": "pad", "area": {"rectangle": [1.3, 1.3, 2.4, 2.1]}, "resists": "both"}
    support = [{"edge": EDGES, "fix": "simple"}, pad]
    found = solve(rectangular(divisions=[5, 5], support=support, load=[{"pressure": 1e3}]))["all"]
    assert widths_of(found)["supports"][1]["max_tension"] is None


def test_no_number_of_a_plate_without_singularities_is_said_to_have_no_limit() -> None:
    for divisions in ((2, 2), (3, 3), (5, 4), (20, 20)):
        model = rectangular(
            divisions=divisions,
            support=[{"edge": EDGES, "resists": "down"}],
            load=[{"pressure": 1e3}, {"pressure": 40e3, "area": {"rectangle": [1.5, 1.5, 2.5, 2.5]}}],
            probe=[{"at": [[2, 2], [1, 2], [0.3, 0.3]]}],
        )
        assert estimate(solve(model)["all"]).warnings == ()


def test_files_have_half_widths_where_the_model_asks(tmp_path: Path) -> None:
    for asked in (True, False):
        write(solve(slab(mesh={"divisions": [4, 4], "error": asked})), tmp_path)
        (written,) = json.loads((tmp_path / "results.json").read_text())["combinations"]
        assert (written["plus_minus"] is not None) == asked
        first, *_ = csv.DictReader((tmp_path / "reactions.csv").read_text().splitlines())
        assert (first["reaction_plus_minus"] != "") == asked


@pytest.mark.parametrize(
    ("step", "error", "why"),
    [
        ("discretise", InputError("A mesh of 64 elements takes 3 GB."), "takes 3 GB"),
        ("contact_problem", MemoryError(), "not enough memory."),
        ("meshes_beside", None, "a finer mesh would take too long"),
    ],
)
@pytest.mark.parametrize("kind", ["each", "table"])
def test_where_no_other_mesh_can_be_solved_a_warning_says_why(
    monkeypatch: pytest.MonkeyPatch, step: str, error: Exception | None, why: str, kind: str
) -> None:
    found = solve(slab(output={"combinations": kind}))

    def refused(*given: object) -> object:
        if error is not None:
            raise error
        return []

    monkeypatch.setattr(other_meshes, step, refused)
    written = results_json(found, estimate(found))
    one = written["table"] if kind == "table" else written["combinations"][0]
    assert (written["envelope"] if kind == "table" else one)["plus_minus"] is None
    (said,) = [sentence for sentence in one["warnings"] if "±" in sentence]
    assert said.startswith("The mesh error of the numbers is unknown: they have no half-width (±); ")
    assert why in said
    assert ("half its size" in said) == (step != "meshes_beside")


def test_an_accuracy_that_no_other_mesh_can_judge_is_said_to_be_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(other_meshes, "meshes_beside", lambda *given: [])
    found = solve(slab(mesh={"divisions": [4, 4], "accuracy": 0.1}))
    assert found.refinement == ()
    assert "The accuracy of 0.1 that was asked for is not known to be reached" in found.accuracy_warning


def test_a_combination_without_equilibrium_has_none() -> None:
    model = slab(
        support=[{"at": POINTS, "resists": "down"}],
        load=[{"case": "G", "pressure": 1.0}, {"case": "W", "pressure": -2.0}],
        combination=[{"name": "up", "factors": {"G": 1, "W": 1}}, {"name": "down", "factors": {"G": 1}}],
    )
    found = solve(model)
    widths = estimate(found)
    assert widths["up"].plus_minus is None
    assert "there is no equilibrium" in widths["up"].warnings[0]
    assert widths["down"].plus_minus is not None


def test_other_meshes_have_elements_of_half_and_a_quarter_or_twice_and_four_times_the_size() -> None:
    def others(*divisions: int, **options: Any) -> list[list[int]]:
        given = {"support": [{"edge": EDGES, "fix": "simple"}], "load": [{"pressure": 1.0}]}
        model = rectangular(mesh={"divisions": divisions} | options, **given)
        mesh = discretise(model).mesh
        return [
            [len(discretise(other.model, other.mesh).mesh.elements) / len(mesh.elements) for other in pair]
            for pair in meshes_beside(model, mesh)
        ]

    assert others(4, 6)[0] == others(25, 25)[0] == others(1, 3)[0] == [4, 16]
    assert others(34, 40)[0] == [4, 0.25]
    assert others(52, 60)[0] == [0.25, 0.0625]
    assert others(52, 60, accuracy=0.01)[0] == [4, 0.25]
    assert others(4, 4, refine=[{"at": [1.0, 1.0], "size": 0.05}])[0] == [4, 16]


def test_plates_read_from_a_file_are_divided_on_request(tmp_path: Path) -> None:
    import meshio

    mesh = disc((0.0, 0.0), 1.0, (2, 8))
    meshio.Mesh(np.column_stack([mesh.points, np.zeros(len(mesh.points))]), [("quad8", mesh.elements)]).write(
        tmp_path / "disc.vtu"
    )
    given = tables(support=[{"at": [[0, 0.9], [0.8, -0.5], [-0.8, -0.5]]}], load=[{"pressure": 1.0}])
    given |= {"plate": {"shape": "mesh", "file": str(tmp_path / "disc.vtu"), "thickness": 0.1}, "mesh": {}}
    assert not Model(**given).estimated and Model(**given | {"mesh": {"error": True}}).estimated
    found = solve(Model(**given))["all"]
    compared: Any = estimate(found)
    assert 0 < compared.plus_minus["deflection"]["max"] < 0.2 * found.deflection.max()
    assert compared.elements == tuple(len(mesh.elements) * factor for factor in (16, 4, 1))


def test_a_design_moment_of_zero_has_a_half_width_where_the_moments_reach_beyond_it() -> None:
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        mesh={"divisions": [4, 4]},
        support=[{"edge": ["left", "right"], "fix": "clamped"}],
        load=[{"pressure": 1e3}],
        probe=[{"at": [[0.6, 2], [0.83, 2]]}],
    )
    result = solve(model)["all"]
    (far, near), (of_far, of_near) = result.probes, widths_of(result)["probes"]
    assert far.design_moment["bottom"] == near.design_moment["bottom"] == (0, 0)
    assert -far.moment[0] > of_far["moment"][0] + of_far["moment"][2] > of_far["design_moment"]["bottom"][0] * 1e3
    reach = near.moment[0] + of_near["moment"][0] + of_near["moment"][2]
    assert 0.3 * reach < of_near["design_moment"]["bottom"][0] < 1.1 * reach


def test_a_design_moment_of_zero_at_a_station_has_a_half_width_where_the_moment_reaches_beyond_it() -> None:
    model = slab(
        mesh={"divisions": [4, 4]},
        support=[{"edge": ["left", "right"], "fix": "clamped"}],
        load=[{"pressure": 1e3}],
        strip=[{"name": "s", "line": [[0.846, 2], [0.849, 2]], "width": 1, "stations": 21}],
    )
    result = solve(model)["all"]
    (stations,), (widths,) = ([one["stations"] for one in of["strips"]] for of in (figures(result), widths_of(result)))
    pairs = [(one, width) for one, width in zip(stations, widths, strict=True) if abs(one["moment"]) < width["moment"]]
    assert len(pairs) > 3
    for one, width in pairs:
        face = "bottom" if one["moment"] < 0 else "top"
        assert one["design_moment"][face] == 0
        beyond = width["moment"] - abs(one["moment"])
        assert width["design_moment"][face] == pytest.approx(beyond, abs=0.01 * width["moment"])


@pytest.mark.parametrize("seed", range(3))
def test_half_widths_of_design_moments_have_no_jump_where_the_moments_become_zero(seed: int) -> None:
    rng = np.random.default_rng(seed)
    factors = np.linspace(0.6, 0.8, 401)
    model = slab(
        mesh={"divisions": [4, 4]},
        support=[{"edge": ["left", "bottom"]}, {"at": [3.3, 3.6]}],
        load=[
            {"case": "G", "pressure": 1e3},
            {"case": "Q", "force": -3e3, "at": rng.uniform(0.5, 3.5, 2).tolist(), "radius": 0.3},
        ],
        probe=[{"at": rng.uniform(0.5, 3.5, (12, 2)).tolist()}],
        strip=[{"name": "s", "line": [[0.3, 0.5], [3.7, 3.5]], "width": 0.6, "stations": 12}],
        combination=[{"name": f"{x:.4f}", "factors": {"G": 1 - x, "Q": x}} for x in factors],
        output={"combinations": "table"},
    )
    results = solve(model)
    widths, crossed = estimate(results).table, {"probe": 0, "strip": 0}
    homes = {f"probe[{n}]": (("mx", "my", "mxy"), ("mx_{}", "my_{}")) for n in range(1, 13)}
    homes |= {f"strip[s][{n}]": (("moment", "twist"), ("moment_{}",)) for n in range(1, 13)}
    for home, (moments, names) in homes.items():
        change = sum(np.abs(np.diff(results.table[f"{home}:{name}"])) for name in moments)
        for name, face in itertools.product(names, ("bottom", "top")):
            column = f"{home}:{name.format(face)}"
            width = widths[f"{column}:plus_minus"]
            crossed[home[:5]] += int((np.diff(np.sign(results.table[column])) != 0).sum())
            assert not (np.abs(np.diff(width)) > 15 * change + 0.01 * width[1:]).any(), column
    assert crossed["probe"] > 10 and crossed["strip"] > 2


@given(
    strategies.lists(strategies.floats(-1, 1), min_size=3, max_size=3),
    strategies.floats(-1, 1),
    strategies.integers(0, 2),
    strategies.integers(0, 2),
)
def test_neighbouring_loads_have_neighbouring_half_widths(
    values: list[float], change: float, mesh: int, own: int
) -> None:
    """A half-width changes at most ten times as much as a value on one of the three meshes."""
    nothing, limited = np.zeros(2), np.ones(2, np.bool_)
    both = np.array([values, values]).T
    both[mesh, 1] += change
    (one, other), _ = half_widths(both, [1.0, 2.0, 4.0], own, nothing, np.ones(2), limited)
    assert abs(one - other) <= 10 * abs(change) + 1e-9


@pytest.mark.parametrize(("thickness", "known"), [(0.05, False), (0.2, True)])
def test_a_mean_over_less_than_an_element_of_every_mesh_has_no_half_width(thickness: float, known: bool) -> None:
    model = slab(plate={"shape": "rectangle", "size": [4, 4], "thickness": thickness}, mesh={"divisions": [8, 8]})
    fields = widths_of(solve(model)["all"])["fields"]
    assert all((fields[name]["max_mean"] is not None) is known for name in ("mx", "my", "qx", "qy"))


def test_extremes_of_a_vector_count_as_part_of_the_largest_change_among_them(result: Result) -> None:
    """Extremes hop from node to node: one may be alike on three meshes beside others that are not."""
    moved = ("fields", "mx", "max")
    changes = np.array([[float(one.path == moved)] for one in result.catalogue])
    found = beside(result.catalogue.numbers, changes)[:, 0]
    counted = dict(zip((one.path for one in result.catalogue), found.tolist(), strict=True))
    moments = ("mx", "my", "mxy", "m1", "m2")
    assert all(0.1 < counted["fields", name, side] < 1 for name in moments for side in SIDES)
    others = [path for path in counted if path[0] != "fields" or path[1] in ("qx", "qy", "sx_top")]
    assert all(counted[path] == 0 for path in others)


def test_rows_of_a_table_and_its_envelope_have_half_widths(tmp_path: Path) -> None:
    import pyarrow.parquet as pq

    loads = [{"case": "G", "pressure": 5e3}, {"case": "Q", "force": 1e4, "at": [3.5, 2.0]}]
    rows = {f"c{i}": [1.0, i / 4] for i in range(14)}
    table = {"name": "all", "generate": "table", "columns": ["G", "Q"], "rows": rows}
    model = slab(load=loads, combination=[table])
    results = solve(model, table=tmp_path / "t.parquet")
    before = pq.read_table(tmp_path / "t.parquet").to_pydict()
    estimates_of(results, lambda now: None, tmp_path / "t.parquet")
    found = pq.read_table(tmp_path / "t.parquet").to_pydict()
    assert [path.name for path in tmp_path.iterdir()] == ["t.parquet"]
    assert {name: found[name] for name in before} == before
    single = widths_of(results["c7"])
    for name, width in (
        ("reaction:wall", single["supports"][2]["reaction"]),
        ("contact_area:soil", single["supports"][1]["contact_area"]),
        ("probe[1]:deflection", single["probes"][0]["deflection"]),
        ("max:deflection", single["deflection"]["max"]),
    ):
        assert found[f"{name}:plus_minus"][7] == pytest.approx(width, rel=0.01, abs=1e-8)
    assert "closed:wall:plus_minus" not in found
    in_python = estimate(results).table
    assert sorted(in_python) == sorted(set(found) - set(before))
    assert all(np.array_equal(in_python[name], np.array(found[name], float), equal_nan=True) for name in in_python)
    envelope = written_of(results)["envelope"]
    widths = envelope["plus_minus"]
    assert all(same_shape(envelope[key], widths[key]) for key in ("fields", "supports", "probes"))


def combined(count: int, **others: Any) -> signorini.Results:
    """Combinations of the slab with a wind, the first of them the same whatever their number."""
    loads = [
        {"case": "G", "pressure": 5e3},
        {"case": "Q", "force": 1e4, "at": [3.5, 2.0]},
        {"case": "W", "pressure": -2e3, "area": {"rectangle": [0, 0, 2, 3]}},
    ]
    rows = {f"c{i}": [1.0, i % 7 / 4, i % 3 / 2] for i in range(count)}
    table = {"generate": "table", "columns": ["G", "Q", "W"], "rows": rows}
    return signorini.solve(slab(load=loads, combination=[table], **others))


def test_a_number_has_one_half_width_in_a_list_a_table_and_an_envelope() -> None:
    few, many, tabled = combined(3), combined(30), combined(3, output={"combinations": "table"})
    listed = estimate(few).table
    assert {"reaction_at:feet[1]:plus_minus", "probe[1]:mx:plus_minus", "max:deflection:plus_minus"} < set(listed)
    for other in (estimate(many).table, estimate(tabled).table):
        assert other.keys() == listed.keys()
        for name, widths in listed.items():
            assert np.array_equal(widths, other[name][:3], equal_nan=True), name
    envelope = written_of(tabled)["envelope"]
    for kind, number, key, path in (
        ("supports", 0, "reaction", ("points", 1)),
        ("supports", 1, "max_pressure", ()),
        ("fields", "mx", "max", ()),
    ):
        ends, widths = envelope[kind][number], envelope["plus_minus"][kind][number]
        for part in path:
            ends, widths = ends[part], widths[part]
        by, width = (ends["max_by"], widths["max"]) if key == "max" else (ends[key]["max_by"], widths[key]["max"])
        single = widths_of(few[by])
        for part in (kind, number, *path, key):
            single = single[part]
        assert width == single


def test_governing_reactions_have_half_widths() -> None:
    listed, tabled = (written_of(combined(3, output={"combinations": how})) for how in ("each", "table"))
    for one, other in zip(listed["governing_reactions"], tabled["governing_reactions"], strict=True):
        assert one["plus_minus"] == other["plus_minus"]
    first = listed["governing_reactions"][0]
    assert 0 < first["plus_minus"]["max"] == first["plus_minus"]["max_with"][0]
    numbers = {one["name"]: one for one in listed["combinations"]}
    width = numbers[first["max_by"]]["plus_minus"]["supports"][0]["points"][0]["reaction"]
    assert width == first["plus_minus"]["max"]
    none = results_json(combined(3, mesh={"divisions": [4, 4], "error": False}))
    assert none["governing_reactions"][0]["plus_minus"] is None


def failing_on(*sides: int) -> Any:
    """Discretises, but not with some numbers of elements along a side."""

    def failing(model: Model, mesh: Any = None) -> Any:
        result = discretise(model, mesh)
        if any(len(result.mesh.elements) == at**2 for at in sides):
            raise InputError("It failed.")
        return result

    return failing


@pytest.mark.parametrize("kind", ["each", "table"])
def test_a_mesh_that_cannot_be_solved_is_told_and_half_widths_are_wider(
    monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    """On the finer mesh, so that coarser ones are taken, then on one of these too: one alone shows no order."""

    def solved(*failing: int) -> tuple[list[str], Any]:
        with monkeypatch.context() as patch:
            patch.setattr(other_meshes, "discretise", failing_on(*failing))
            model = slab(mesh={"divisions": [8, 8]}, output={"combinations": kind})
            written = written_of(solve(model))
        one = written["table"] if kind == "table" else written["combinations"][0]
        widths = written["envelope"] if kind == "table" else one
        return one["warnings"], widths["plus_minus"]["fields"]["mx"]["max"]

    def told(warnings: list[str]) -> list[str]:
        return [sentence for sentence in warnings if "±" in sentence]

    every, _ = solved()
    without_finer, _ = solved(16)
    alone, widened = solved(16, 2)
    assert told(every) == []
    assert told(without_finer) == [
        "Half-widths (±) come from other meshes than the first that were tried; on a mesh of half its size, divided: "
        "It failed."
    ]
    assert told(alone)[0].startswith("Half-widths (±) come from one other mesh alone; on a mesh of ")
    fine, coarse = (solve(slab(mesh={"divisions": [n, n], "error": False}))["all"].extremes["mx"].max for n in (8, 4))
    assert widened > 3 * abs(fine - coarse) > 0


def test_extremes_in_pictures_have_their_half_widths(estimated_result: Estimate) -> None:
    result, widths = estimated_result.result, estimated_result.plus_minus
    assert widths is not None
    words, _ = panel("deflection", result, widths).extremes[0]
    most = float(result.deflection.max())
    assert words == f"max {estimated(most, widths['deflection']['max'], digits=4)}" and " ± " in words
    assert panel("mx", result, None).extremes[0][0] == f"max {plain(result.extremes['mx'].max, 4)}"
    (of_pressure, _), *_ = panel("pressure", result, widths).extremes
    assert of_pressure.startswith("max ") and " ± " in of_pressure
    texts = {text.get_text() for text in result.plot("qx").texts}
    assert {words for words, _ in panel("qx", result).extremes} < texts


def test_colours_of_pictures_end_at_the_extremes_that_are_named() -> None:
    """A peak beside a corner, which is left out, would leave one colour for all else."""
    points = [[0, 0], [6, 0], [6, 4], [3, 4], [3, 2], [0, 2]]
    model = signorini.Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "polygon", "points": points, "thickness": 0.2},
        mesh={"size": 0.25, "error": False},
        support=[{"edge": [f"edge {i}" for i in range(1, 7)], "fix": "clamped"}],
        load=[{"pressure": 5e3}],
    )
    result = signorini.solve(model)["all"]
    ends = result.extremes["qx"]
    assert (ends.min, ends.max) == panel("qx", result).limits
    assert np.abs(result.fields["qx"]).max() > 1.2 * max(-ends.min, ends.max)
