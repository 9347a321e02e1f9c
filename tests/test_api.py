"""Results in Python: by name, as tables, written singly; messages for wrong calls."""

import json
import pickle
from pathlib import Path

import numpy as np
import pytest
import pyvista
from models import rectangular, tables

import signorini
from signorini import InputError, Model, contact_problem, estimate, lemke, recover, solve, write

FEET = [{"name": "feet", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}]
HELD = [{"edge": "left", "fix": "clamped"}, {"name": "props", "at": [[4, 0], [4, 4]], "resists": "down"}]
CUTS = {
    "section": [{"name": "mid", "line": [[2, 0], [2, 4]]}],
    "strip": [{"name": "s", "line": [[0, 2], [4, 2]], "width": 1}],
}


@pytest.fixture(scope="module")
def results() -> signorini.Results:
    return solve(rectangular(support=FEET, load=[{"case": "G", "pressure": 1e3}], probe=[{"at": [2, 2]}], **CUTS))


def test_supports_sections_and_strips_are_found_by_number_and_by_name(results: signorini.Results) -> None:
    for result in (results["all"], pickle.loads(pickle.dumps(results["all"]))):
        assert result.supports["feet"] is result.supports[0] and result.supports[-1:] == (result.supports[0],)
        assert result.sections["mid"] is result.sections[0] and result.strips["s"] is result.strips[0]
        for of in (result.supports, result.sections, result.strips):
            with pytest.raises(KeyError) as told:
                of["foot"]
            assert isinstance(told.value, InputError) and of[0].name in str(told.value)


def test_a_result_is_a_table_of_its_numbers_with_units_places_and_half_widths(results: signorini.Results) -> None:
    result, widths = results["all"], estimate(results["all"])
    table = widths.to_dataframe()
    assert table["value"].tolist() == pytest.approx(result.numbers.tolist(), nan_ok=True)
    assert table.loc["feet[2].reaction", ["x", "y"]].tolist() == [3, 1]
    assert table.loc["mx.max", ["x", "y"]].tolist() == list(result.extremes["mx"].max_at)
    assert table.loc["deflection.max", "plus_minus"] == widths.plus_minus["deflection"]["max"]
    assert list(result.to_dataframe().columns) == ["value", "unit", "x", "y"]


def test_several_plates_are_blocks_by_name() -> None:
    square = {"shape": "rectangle", "size": [2, 2], "thickness": 0.2, "mesh": {"divisions": [2, 2]}}
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plates={"upper": square, "lower": square},
        support=[{"plate": "lower", "area": "all", "resists": "down", "stiffness": 1e8}],
        contact=[{"between": ["upper", "lower"], "area": "all", "stiffness": 1e9}],
        load=[{"plate": "upper", "pressure": 1e3}],
    )
    result = solve(model)["all"]
    blocks = result.to_pyvista()
    assert isinstance(blocks, pyvista.MultiBlock) and blocks.keys() == ["upper", "lower"]
    assert blocks["upper"].n_cells == 4
    assert len(result.to_dataframe()) == len(result.numbers)


def test_a_result_is_written_by_itself_however_it_was_found(tmp_path: Path) -> None:
    given = tables(support=HELD, load=[{"case": "G", "pressure": 1e3}, {"case": "Q", "force": 1e4, "at": [2, 2]}])
    model = Model(**given | {"combination": [{"name": "ULS", "factors": {"G": 1.35}}, {"factors": {"Q": 1}}]})
    problem, results = contact_problem(model), solve(model)
    P, s = problem.dual(problem.load("ULS"))
    found = recover(problem, "ULS", lemke(P, -s).z)
    own = recover(problem, problem.load("ULS"), lemke(P, -s).z)
    for name, result in {"solved": results["ULS"], "recovered": found, "own": own}.items():
        files = write(result, tmp_path / name, pictures="none")
        told = json.loads((tmp_path / name / "results.json").read_text("utf-8"))
        (combination,) = told["combinations"]
        assert combination["supports"][1]["reaction"] == pytest.approx(results["ULS"].reactions["props"])
        assert sorted(file.name for file in files) == sorted(file.name for file in (tmp_path / name).iterdir())


def test_an_estimate_without_half_widths_says_why() -> None:
    model = rectangular(support=HELD, load=[{"case": "G", "pressure": 1e3}])
    problem = contact_problem(model)
    P, s = problem.dual(problem.load("all"))
    assert estimate(recover(problem, "all", lemke(P, -s).z)).warnings
    assert estimate(signorini.path(model, None, "G", until=1.0, events="all")).warnings


@pytest.mark.parametrize(
    "call",
    [
        lambda results: results["all"].probe(5, 3),
        lambda results: results["all"].pressure(),
        lambda results: results["all"].plot(limit=(0, 1)),
        lambda results: results["all"].plot("mx", plus_minus=5),
        lambda results: results.key("all"),
        lambda results: results.envelope["reaction"],
        lambda results: solve(),
        lambda results: solve(results.model, progres=print),
        lambda results: write(results),
        lambda results: lemke(np.eye(2)),
        lambda results: signorini.loads(5),
        lambda results: contact_problem(results.model).dual(),
    ],
)
def test_a_wrong_call_is_an_input_error(results: signorini.Results, call: object) -> None:
    with pytest.raises(InputError):
        call(results)  # type: ignore[operator]


def test_catalogue_and_model_are_short_in_a_console(results: signorini.Results) -> None:
    assert len(repr(results["all"].catalogue)) < 200 and len(repr(results.model)) < 200
