"""Every validation case holds; the command writes its page, and its input file is the model that was solved."""

import math
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from command import run

import signorini
from signorini.validation import Number, cases
from signorini.validation.pages import rows_of, summary
from signorini.validation.runner import Outcome, Solved, model_of, solve_on, values_of


@cache
def outcome(name: str) -> Outcome:
    """Results on the middle mesh, with half-widths, and on the finest mesh, whose errors decide."""
    case = cases()[name]
    *coarse, fine = case.meshes
    return Outcome(case, (*(solve_on(case, n) for n in coarse[-1:]), solve_on(case, fine, False)))


@pytest.mark.parametrize("name", cases())
def test_a_case_holds(name: str) -> None:
    for one in outcome(name).comparisons:
        assert one.holds, (one.number, one.values)


@pytest.mark.parametrize(
    "name",
    [
        *(f"square-{edges}-{slenderness}" for edges in ("hard", "soft", "clamped") for slenderness in (5, 10, 100)),
        *("disc-simple-10", "disc-clamped-10", "annulus-outer-simple"),
    ],
)
def test_q8r_holds_a_case_of_a_plate_that_is_not_very_thin(name: str) -> None:
    case = cases()[name]
    tables = case.tables(case.meshes[-1])
    model = signorini.Model.model_validate({**tables, "plate": {**tables["plate"], "element": "q8r"}})
    values = values_of(case, signorini.solve(model)["all"])
    for number, value in zip(case.numbers, values, strict=True):
        assert number.error(value) <= number.tolerance, number


def test_half_widths_cover_the_true_errors_and_are_narrow() -> None:
    rows = list(rows_of(map(outcome, cases())))
    counts = summary(rows)
    assert counts["covered"] >= 0.995 * counts["known"]
    assert np.median([row.width for row in rows if row.covered is not None]) < 0.005


@pytest.mark.parametrize(
    ("name", "linked"),
    [
        ("square-hard-10", {".toml", "-model.png", "-deflection.png"}),
        (
            "plates-cantilevers",
            {".toml", *(f"-{what}-{plate}.png" for what in ("model", "profile") for plate in ("upper", "lower"))},
        ),
        ("footing-kern", {".toml", "-model.png", "-pressure.png"}),
        ("lcp-three", set()),
    ],
)
def test_the_command_writes_pages_with_input_files_and_pictures(tmp_path: Path, name: str, linked: set[str]) -> None:
    done = run("validate", "--case", name, "-o", tmp_path)
    assert done.exit_code == 0, done.output
    files = {f"{name}{ending}" for ending in linked}
    assert {path.name for path in tmp_path.iterdir()} == {"coverage.md", "index.md", f"{name}.md", *files}
    page = (tmp_path / f"{name}.md").read_text("utf-8")
    assert all(f"]({file})" in page for file in files)
    if linked:
        case = cases()[name]
        assert signorini.load(tmp_path / f"{name}.toml") == model_of(case, case.meshes[-1])


def test_a_directory_that_cannot_be_written_is_refused_before_the_cases_are_solved(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("signorini.validation.outcomes", None)
    taken = tmp_path / "taken"
    taken.touch()
    done = run("validate", "--case", "lcp-three", "-o", taken)
    assert done.exit_code == 2 and str(taken) in done.stderr


def test_pages_replace_those_of_an_earlier_validation_and_no_others(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "notes.md").write_text("[mine](lcp-two.md)")
    for name in ("lcp-three", "square-hard-10", "lcp-three"):
        assert run("validate", "--case", name, "-o", tmp_path).exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"coverage.md", "index.md", "lcp-three.md", "notes.md"}
    monkeypatch.setattr("signorini.validation.outcomes", None)
    for taken in ("index.md", "coverage.md", "square-hard-10.toml"):
        (other := tmp_path / taken[:2]).mkdir()
        (other / taken).write_text("mine")
        done = run("validate", "--case", "square-hard-10", "-o", other)
        assert done.exit_code == 2 and f"{taken} exists" in done.stderr
        assert [path.name for path in other.iterdir()] == [taken]
        assert (other / taken).read_text() == "mine"


@pytest.mark.parametrize("differs", ["", "a misprint"])
@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_a_number_that_is_none_neither_agrees_nor_differs_as_stated(value: float, differs: str) -> None:
    case = next(iter(cases().values()))
    number = Number("n", "n", reference=1.0, tolerance=0.1, differs=differs)
    solved = tuple(Solved(n, n, (one,), (0.1,), 0.0) for n, one in ((1, 2.0), (2, value)))
    found = Outcome(replace(case, numbers=(number,)), solved)
    (comparison,) = found.comparisons
    assert not found.holds and comparison.rate is None
    assert not any(comparison.covered)


def test_an_unknown_case_is_refused_with_the_similar_names() -> None:
    done = run("validate", "--case", "square-hard-11")
    assert done.exit_code == 2
    assert "--case" in done.stderr and "square-hard-10" in done.stderr
