"""Views of results in a notebook, and the tutorial, cell by cell as a notebook runs it."""

import ast
import base64
import html
import json
import re
from pathlib import Path
from typing import Any

import pytest
from models import rectangular

import signorini

TUTORIAL = Path(__file__).parents[1] / "docs" / "tutorial.ipynb"


def pictures(shown: str) -> list[bytes]:
    return [base64.b64decode(data) for data in re.findall(r'<img [^>]*src="data:image/png;base64,([^"]+)"', shown)]


def run(source: str, names: dict[str, Any]) -> Any:
    """Run a cell, and return the value of its last expression, which a notebook displays."""
    tree = ast.parse(source)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, TUTORIAL.name, "exec"), names)
    return eval(compile(ast.Expression(last.value), TUTORIAL.name, "eval"), names) if last else None


def test_the_tutorial_runs_and_shows_pictures_and_tables(capsys: pytest.CaptureFixture[str]) -> None:
    notebook, names = json.loads(TUTORIAL.read_text("utf-8")), dict[str, Any]()
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert all(not cell.get("outputs") for cell in notebook["cells"])
    shown = [value._repr_html_() for source in cells if hasattr(value := run(source, names), "_repr_html_")]
    result, estimate, _, path = shown
    assert len(pictures(result)) == len(pictures(estimate)) == len(pictures(path)) == 1
    assert "mid-span" in result and "columns" in path and "±" in estimate
    assert ", 0 differ" in capsys.readouterr().out


def test_a_result_shows_a_picture_reactions_and_section_forces_as_text() -> None:
    feet = {"name": "<b>feet</b>", "at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}
    cut = {"name": "</td><script>", "line": [[2, 0], [2, 4]]}
    results = signorini.solve(rectangular(support=[feet], load=[{"pressure": 1e3}], section=[cut]))
    for shown in (results._repr_html_(), signorini.estimate(results["all"])._repr_html_()):
        (png,) = pictures(shown)
        assert png.startswith(b"\x89PNG")
        assert not {"b", "script"} & set(re.findall(r"<(\w+)", shown.replace("<b>all</b>", "")))
        assert html.escape("section[</td><script>]") in shown and "16000" in shown


def test_each_plate_has_a_picture_and_many_combinations_have_none() -> None:
    square = {"shape": "rectangle", "size": [2, 2], "thickness": 0.2, "mesh": {"divisions": [2, 2]}}
    model = signorini.Model(
        material={"E": 30e9, "nu": 0.2},
        plates={"upper": square, "lower": square},
        support=[{"plate": "lower", "area": "all", "resists": "down", "stiffness": 1e8}],
        contact=[{"between": ["upper", "lower"], "area": "all", "stiffness": 1e9}],
        load=[{"plate": "upper", "case": "G", "pressure": 1e3}],
    )
    assert len(pictures(signorini.solve(model)._repr_html_())) == 2
    many = model.model_copy(
        update={"combination": tuple(signorini.Combination(name=n, factors={"G": 1}) for n in "abcde")}
    )
    shown = signorini.solve(many)._repr_html_()
    assert pictures(shown) == [] and shown.count("<table>") == 5
