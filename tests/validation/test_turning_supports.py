"""Springs on slopes: beams with turning ends, clamped edges as their limit, columns in a frame."""

import json

import numpy as np
import pytest
from models import rectangular

import signorini
from signorini import Model
from signorini.errors import InputError

YOUNG, THICKNESS, SPAN, PRESSURE = 30e9, 0.2, 4.0, 1e3
RIGIDITY = YOUNG * THICKNESS**3 / 12


def model(support, size=(SPAN, 0.5), divisions=(20, 2), nu=0.0, load=None, **more):
    return Model(
        material={"E": YOUNG, "nu": nu},
        plate={"shape": "rectangle", "size": size, "thickness": THICKNESS, "element": more.pop("element", "mitc9")},
        mesh={"divisions": divisions},
        support=support,
        load=[{"pressure": PRESSURE}] if load is None else load,
        **more,
    )


def test_a_stiff_spring_holds_the_slope_as_a_clamped_edge_does():
    edges, couples = ["left", "right", "bottom", "top"], []
    for how in ({"fix": "clamped"}, {"fix": "hard", "rotational_stiffness": 1e13}):
        plate = model([{"edge": edges} | how], size=(4, 4), divisions=(8, 8), nu=0.2)
        result = signorini.solve(plate)["all"]
        couples.append(result.supports[0].edge.couples)
        assert result.certificate.passed
    away = np.abs(couples[0]) > 300
    assert couples[1][away] == pytest.approx(couples[0][away], rel=2e-3)


@pytest.mark.parametrize("resists", ["both", "down"])
def test_columns_and_sections_balance_the_load(resists):
    columns = {"at": [[0.5, 0.5], [5.5, 0.5], [5.5, 3.5], [0.5, 3.5], [3, 2]], "resists": resists, "stiffness": 1e8}
    loads = [{"pressure": 1e4}, {"force": 5e4, "at": [4.2, 1.3]}]
    section = [{"name": "cut", "line": [[2.2, 0], [2.2, 4]]}]
    plate = model(
        [columns | {"rotational_stiffness": [2e7, "3e7 + 1e6*x"]}], (6, 4), (12, 8), 0.2, loads, section=section
    )
    result = signorini.solve(plate)["all"]
    of = result.supports[0]
    weight = 1e4 * 24 + 5e4
    assert of.reaction == pytest.approx(weight, rel=1e-12)
    about_y = of.reactions @ of.positions[:, 0] - of.moments[:, 0].sum()
    about_x = of.reactions @ of.positions[:, 1] - of.moments[:, 1].sum()
    assert about_y == pytest.approx(1e4 * 24 * 3 + 5e4 * 4.2, rel=1e-10)
    assert about_x == pytest.approx(1e4 * 24 * 2 + 5e4 * 1.3, rel=1e-10)
    left = of.positions[:, 0] < 2.2
    shear = 1e4 * 2.2 * 4 - of.reactions[left].sum()
    moment = (
        (of.reactions[left] * (2.2 - of.positions[left, 0])).sum() + of.moments[left, 0].sum() - 1e4 * 4 * 2.2**2 / 2
    )
    assert abs(result.sections[0].shear) == pytest.approx(abs(shear), rel=1e-9)
    assert result.sections[0].moment == pytest.approx(moment, rel=1e-9)


def test_a_column_turns_as_its_moment_over_its_stiffness_says():
    result = signorini.solve(
        model([{"at": [[1, 1], [3, 1], [2, 3]], "rotational_stiffness": [2e6, 5e6]}], (4, 4), (8, 8))
    )
    result = result["all"]
    for moments, one in zip(result.supports[0].moments, result.probe([(1, 1), (3, 1), (2, 3)]), strict=True):
        # About x the slope along y is resisted.
        assert moments == pytest.approx([-5e6 * one.rotation[0], -2e6 * one.rotation[1]], rel=1e-9)


@pytest.mark.parametrize(
    ("support", "said"),
    [
        ({"edge": "left", "fix": "clamped", "rotational_stiffness": 1}, '"clamped" holds the slope already'),
        ({"area": "all", "stiffness": 1e6, "rotational_stiffness": 1}, "use at, nodes, edge, line or circle"),
        ({"edge": "left", "fix": "hard", "rotational_stiffness": [1, 2]}, "found two values; along an edge"),
        ({"at": [1, 1], "rotational_stiffness": [1, 2, 3]}, "found [1, 2, 3]; it must be one stiffness"),
        ({"at": [1, 1], "rotational_stiffness": 0}, "found 0; it must be greater than 0."),
    ],
)
def test_a_rotational_stiffness_that_holds_nothing_is_refused(support, said):
    with pytest.raises(InputError) as refused:
        model([support])
    assert said in str(refused.value)
    assert "support[1].rotational_stiffness" in str(refused.value)


COLUMNS = [[0.5, 0.5], [5.5, 0.5], [5.5, 3.5], [0.5, 3.5], [3, 2]]
CASES = [{"case": "G", "pressure": 1e4}, {"case": "Q", "force": 3e5, "at": [4.2, 1.3]}, {"case": "W", "pressure": -8e3}]


def frame(resists, **more):
    """Columns that turn, beside a wall that turns and points that do not, so that the order of points counts."""
    supports = [
        {"name": "wall", "edge": ["left"], "resists": "down", "stiffness": 1e8, "rotational_stiffness": 1e6},
        {"name": "pads", "at": [[2, 3.5], [4, 3.5]], "resists": "down", "stiffness": 1e7},
        {
            "name": "columns",
            "at": COLUMNS,
            "resists": resists,
            "stiffness": 1e8,
            "rotational_stiffness": [2e7, "3e7 + 1e6*x"],
        },
    ]
    return model(supports, (6, 4), (6, 4), 0.2, CASES, **more)


@pytest.mark.parametrize("method", ["lemke", "active_set"])
@pytest.mark.parametrize("resists", ["both", "down"])
def test_moments_of_columns_in_a_table_are_those_of_single_solves(resists, method):
    rows = {f"row {n}": [1.0, 0.3 * n, 0.1 * n] for n in range(-3, 10)}
    table = {"name": "all", "generate": "table", "columns": ["G", "Q", "W"], "rows": rows}
    results = signorini.solve(frame(resists, combination=[table], solver={"method": method}))
    for number, (name, factors) in enumerate(rows.items()):
        one = {"name": name, "factors": {case: factor for case, factor in zip("GQW", factors, strict=True) if factor}}
        columns = signorini.solve(frame(resists, combination=[one]))[name].supports[2]
        for point, moments in enumerate(columns.moments, start=1):
            found = [results.table[f"moment_{axis}_at:columns[{point}]"][number] for axis in "xy"]
            assert found == pytest.approx(moments, rel=1e-8, abs=1e-6)
    ends = results.envelope["moment_x_at:columns[5]"]
    column = np.array(results.table["moment_x_at:columns[5]"])
    assert (ends.max, ends.max_by) == (column.max(), column.argmax())
    assert (ends.min, ends.min_by) == (column.min(), column.argmin())


def test_moments_of_columns_are_told_along_a_path_with_their_thresholds():
    sampled = signorini.path(frame("down"), "G", "Q", until=3.0, steps=6, when=["columns[5].moment_x = -20e3"])
    assert sampled.thresholds[0].t is not None
    for stop, t in zip(sampled.stops, sampled.table["t"], strict=True):
        moments = sampled.at(float(t)).supports[2].moments
        found = [[stop.number(f"columns[{point}].moment_{axis}") for axis in "xy"] for point in range(1, 6)]
        assert np.array(found) == pytest.approx(moments, rel=1e-8, abs=1e-6)
    exact = signorini.path(frame("down"), "G", "Q", until=3.0, events="all")
    last = sampled.at(3.0).supports[2].moments[4, 0]
    assert exact.stops[-1].number("columns[5].moment_x") == pytest.approx(last, rel=1e-8)
    assert sampled.at(sampled.thresholds[0].t).supports[2].moments[4, 0] == pytest.approx(-20e3, rel=1e-8)


def test_moments_of_columns_have_one_half_width_and_stand_in_the_files(tmp_path):
    rows = {"generate": "table", "columns": ["G", "Q"], "rows": {f"row {n}": [1.0, 0.3 * n] for n in range(13)}}
    results = signorini.solve(frame("down", combination=[rows]))
    estimates = signorini.estimate(results)
    signorini.write(results, tmp_path, estimates)
    written = json.loads((tmp_path / "results.json").read_text())
    point = written["envelope"]["supports"][2]["points"][4]
    ends = results.envelope["moment_y_at:columns[5]"]
    assert point["moment_y"]["max"] == ends.max
    assert point["moment_y"]["max_by"] == results.key(ends.max_by)
    name = point["moment_y"]["max_by"]
    one = next(one for one in written["combinations"] if one["name"] == name)
    assert one["supports"][2]["points"][4]["moment"][1] == pytest.approx(ends.max, rel=1e-9)
    width = written["envelope"]["plus_minus"]["supports"][2]["points"][4]["moment_y"]["max"]
    assert width == pytest.approx(estimates.half_width("moment_y_at:columns[5]", name))
    assert width == pytest.approx(estimates[name].plus_minus["supports"][2]["points"][4]["moment"][1])
    found = signorini.path(frame("down"), "G", "Q", until=1.0, steps=2)
    signorini.write(found, tmp_path / "path")
    stops = json.loads((tmp_path / "path" / "path.json").read_text())["stops"]
    assert stops[-1]["supports"][2]["points"][4]["moment"] == pytest.approx(
        found.at(1.0).supports[2].moments[4].tolist(), rel=1e-8
    )
    assert "moment_x_at:columns[5]" in (tmp_path / "path" / "path.csv").read_text().splitlines()[0]


@pytest.mark.parametrize("mesh", [{"divisions": [7, 9]}, {"size": 0.6}, {"divisions": [8, 8]}])
@pytest.mark.parametrize("thickness", [0.05, 0.3])
def test_the_couple_at_a_point_is_its_stiffness_times_the_rotation_there(mesh, thickness):
    at = [[1.37, 2.2], [2.5, 1.3], [2, 2]]
    model = rectangular(
        thickness=thickness,
        mesh={**mesh, "error": False},
        support=[
            {"edge": ["left", "right"], "fix": "simple"},
            {"name": "columns", "at": at, "stiffness": 1e8, "rotational_stiffness": [2e6, 5e6]},
        ],
        load=[{"pressure": 1e4}, {"force": 1e4, "at": [3, 3]}],
        probe=[{"at": at}],
    )
    result = signorini.solve(model)["all"]
    rotations = [probe.rotation for probe in result.probes]
    (couples,) = (support.moments for support in result.supports if support.name == "columns")
    # About x the plate turns by θy.
    np.testing.assert_allclose(couples, -np.array(rotations) * [5e6, 2e6], rtol=1e-9)
