"""Random plates for which the program once had no answer, since rounding was decisive."""

import json
from pathlib import Path

import numpy as np
import pytest
from extreme_models import held_at_points

from signorini import NotCertifiedError, SupportResult, solve, validate

PLATES = sorted((Path(__file__).parent / "hard_plates").glob("*.json"))


NOT_YET = {"an_anchor_almost_between_two_props"}
"""Plates inside the domain that are still refused, since no method's answer passes its certificate."""


def _marked(path: Path):
    refused = pytest.mark.xfail(raises=NotCertifiedError, strict=True)
    return pytest.param(path, marks=refused if path.stem in NOT_YET else (), id=path.stem)


@pytest.mark.parametrize("path", [_marked(path) for path in PLATES])
def test_plates_that_rounding_made_hard_are_certified(path: Path) -> None:
    results = solve(validate(json.loads(path.read_text())))
    solved = [result for result in results.values() if result.status == "solved"]
    assert solved and all(result.certificate.passed for result in solved)


def test_a_plate_without_load_stays_where_it_is() -> None:
    """The solver leaves it 10⁶ m away; the least deflection once lost its digits on the way back."""
    tables = json.loads((Path(__file__).parent / "hard_plates" / "an_upper_plate_without_load.json").read_text())
    (result,) = solve(validate(tables)).values()
    loaded = np.abs(result.plates["up2"].deflection).max()
    assert np.abs(result.plates["up1"].deflection).max() < 1e-9 * loaded


def test_where_points_follow_from_several_equations_what_is_shared_by_the_sign_is_what_these_have() -> None:
    """The sum of reactions to a load without resultant was once wrong by 7 % of their size."""
    tables = json.loads((Path(__file__).parent / "hard_plates" / "floors_and_columns_between.json").read_text())
    reactions = np.concatenate([support.reactions for support in solve(validate(tables))["all"].supports])
    assert abs(reactions.sum()) < 1e-12 * np.abs(reactions).sum()


@pytest.mark.parametrize("name", ["crowded_points_that_hold_both_ways"])
def test_points_near_each_other_hold_the_plate_as_an_orthogonal_basis_of_what_they_leave_does(name: str) -> None:
    """Rows that are nearly dependent, within 1e-6, matter: without them the plate deflects 2 % more."""
    tables = json.loads((Path(__file__).parent / "hard_plates" / f"{name}.json").read_text())
    expected = held_at_points({**tables, "support": [{**tables["support"][0], "resists": "both"}]})
    found = solve(validate(tables))["all"].deflection
    assert np.abs(found - expected).max() < 1e-7 * np.abs(expected).max()


def test_supports_on_both_sides_carry_what_one_that_holds_both_ways_does() -> None:
    """The floor has the pushing reactions, the hold-down the pulling ones; two equal supports share equally."""
    place = {"at": [[2.0, 2.0], [8.0, 2.0], [5.0, 5.0], [3.0, 8.0]], "settlement": "1e-4*x"}
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        "mesh": {"divisions": [7, 7]},
        "load": [{"pressure": 1e3, "area": {"rectangle": [0, 0, 10, 4]}}],
    }
    down, up, both = ({**place, "resists": ways} for ways in ("down", "up", "both"))
    one = solve(validate({**tables, "support": [both]}))["all"]
    floor, hold_down, again = solve(validate({**tables, "support": [down, up, down]}))["all"].supports
    (forces,) = (support.reactions for support in one.supports)
    assert (forces > 1.0).any() and (forces < -1.0).any()
    np.testing.assert_allclose(floor.reactions, 0.5 * np.maximum(forces, 0.0), atol=1e-6 * np.abs(forces).max())
    np.testing.assert_allclose(again.reactions, floor.reactions)
    np.testing.assert_allclose(hold_down.reactions, np.minimum(forces, 0.0), atol=1e-6 * np.abs(forces).max())


def test_a_gap_both_ways_may_be_none_in_places() -> None:
    """Points with zero gap have the reactions of a model with a very small gap there."""

    def supports(gap: str) -> list[SupportResult]:
        tables = {
            "material": {"E": 30e9, "nu": 0.2},
            "plate": {"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
            "mesh": {"divisions": [4, 4]},
            "support": [
                {"edge": ["top", "left"], "resists": "both", "gap": gap},
                {"at": [[3.9, 0.1], [3.0, 2.1]], "resists": "both", "gap": "1e-4*where(x > 3.5, 1, 0)"},
            ],
            "load": [{"pressure": 5e3}, {"force": -2e5, "at": [3.5, 2.5]}],
        }
        return solve(validate(tables))["all"].supports

    for exact, near in zip(supports("1e-4*x"), supports("1e-4*x + 1e-13"), strict=True):
        assert near.positions.tolist() == exact.positions.tolist()
        assert exact.reactions == pytest.approx(near.reactions, abs=1e-5 * np.abs(near.reactions).max())
        assert exact.gaps == pytest.approx(near.gaps, abs=1e-10)


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_a_plate_that_cannot_deflect_touches_what_it_stands_on(method: str) -> None:
    """The gaps of such a plate are rounding, whatever its deflection."""
    tables = {
        "material": {"E": 30e9, "nu": 0.0},
        "plate": {"shape": "rectangle", "size": [1.0, 0.5], "thickness": 0.2},
        "mesh": {"divisions": [1, 5], "error": False},
        "support": [
            {"edge": ["left", "top", "right"], "resists": "both"},
            {"area": "all", "resists": "down"},
            {"line": [[0.5, 0.0], [0.2724507481388333, 0.20502431841163238]], "fix": "clamped"},
        ],
        "load": [{"pressure": "2e4*x"}, {"pressure": 2.4e5, "area": {"rectangle": [0.43, 0.11, 0.57, 0.25]}}],
        "solver": {"method": method},
    }
    result = solve(validate(tables))["all"]
    assert len(result.not_unique) == 1 and "support 2, support 3" in str(result.not_unique[0])
    # These are the least-norm reactions, whichever ones the method found.
    assert list(result.reactions.values()) == pytest.approx([-558.167551, 6878.873649, 3383.293901], rel=1e-8)
