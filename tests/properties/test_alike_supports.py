"""Equivalent keys of one support give the same results: the law of a point decides."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import signorini

Table = dict[str, Any]
FAR = 50.0
"""Travel of kinks and limits that no load reaches."""
PLACES: dict[str, tuple[float, Table]] = {
    "all of the plate": (1e6, {"area": "all"}),
    "rectangle across elements": (3e6, {"area": {"rectangle": [0.3, 0.45, 2.2, 1.9]}}),
    "disc": (3e6, {"area": {"circle": {"center": [2.1, 1.4], "radius": 0.9}}}),
    "polygon": (3e6, {"area": {"polygon": [[0.2, 0.2], [3.3, 0.7], [1.6, 2.6]]}}),
    "edges": (3e6, {"edge": ["left", "right"]}),
    "line across elements": (5e6, {"line": [[0.3, 0.2], [3.1, 2.3]]}),
    "circle": (5e6, {"circle": {"center": [2.0, 1.5], "radius": 1.1}}),
    "points": (2e6, {"at": [[0.5, 0.5], [3.5, 0.75], [2, 2.5], [2, 1.5]]}),
    "footprints": (2e6, {"at": [[0.6, 0.5], [3.4, 0.7], [2, 2.4]], "radius": 0.2}),
    "points on a rigid zone": (2e6, {"at": [[1.2, 1.2], [1.8, 1.2], [1.2, 1.8], [1.8, 1.8]]}),
    "area within a rigid zone": (5e6, {"area": {"rectangle": [1, 1, 2, 2]}}),
    "line within a rigid zone": (5e6, {"line": [[1.2, 1.2], [1.8, 1.7]]}),
}
ZONE = {"rigid": True, "area": {"rectangle": [1, 1, 2, 2]}}


def ways(stiffness: float) -> dict[str, list[Table]]:
    """Write a two-sided spring of this stiffness."""
    k = stiffness
    return {
        "stiffness": [{"stiffness": k}],
        "straight law": [{"law": [[0, 0], [1e-3, 1e-3 * k]]}],
        "straight law in parts": [{"law": [[-2e-3, -2e-3 * k], [0, 0], [1e-3, 1e-3 * k], [2e-3, 2e-3 * k]]}],
        "kink further out": [{"law": [[0, 0], [FAR, FAR * k], [2 * FAR, 1.5 * FAR * k]]}],
        "limit further out": [{"stiffness": k, "limit": FAR * k}],
        "two of half": [{"law": [[0, 0], [1, 0.5 * k]]}, {"stiffness": 0.5 * k}],
        "two laws of half": [{"law": [[0, 0], [1, 0.5 * k]]}, {"law": [[0, 0], [2, k]]}],
    }


def slab(supports: list[Table]) -> Table:
    """One plate that rests on its corners besides."""
    return {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [4, 3], "thickness": 0.15},
        "mesh": {"divisions": [4, 3]},
        "zone": [ZONE],
        "support": [*supports, {"at": [[0, 0], [0, 3], [4, 0], [4, 3]], "resists": "down", "stiffness": 1e6}],
        "load": [{"pressure": 4e3}, {"force": 20e3, "at": [3.2, 2.1], "patch": [0.3, 0.3]}],
    }


def stacked(supports: list[Table]) -> Table:
    """Tie a smaller plate to a clamped one beneath it."""
    plate = {"shape": "rectangle", "thickness": 0.15}
    return {
        "material": {"E": 30e9, "nu": 0.2},
        "plates": {"lower": {**plate, "size": [4, 3]}, "upper": {**plate, "size": [4, 3]}},
        "mesh": {"divisions": [4, 3]},
        "zone": [{"plate": "upper", **ZONE}],
        "support": [
            *({**one, "between": ["upper", "lower"]} for one in supports),
            {"plate": "lower", "edge": ["left", "right"], "fix": "clamped"},
            {"plate": "upper", "at": [[4, 3], [0, 3], [0, 0]], "resists": "both", "stiffness": 1e5},
        ],
        "load": [{"plate": "upper", "pressure": 4e3}, {"plate": "upper", "force": 20e3, "at": [3.2, 2.1]}],
    }


def numbers(tables: Table, count: int) -> np.ndarray:
    """Deflections of a model, and the total reaction of its first supports."""
    (result,) = signorini.solve(signorini.Model(**tables)).values()
    plates = result.plates.values() if result.plates else [result]
    deflection = np.concatenate([one.deflection for one in plates])
    carried = sum(support.reaction for support in result.supports[:count])
    return np.append(deflection / np.abs(deflection).max(), carried / 1e5)


def differences(make: Any, where: Table, stiffness: float, beside: Table) -> dict[str, float]:
    """By how much every way of writing differs from the first one."""
    given = ways(stiffness)
    if "gap" in beside or beside["resists"] != "both":
        # A law that begins at a negative travel is two-sided without a gap.
        del given["straight law in parts"]
    shares = {name: [{**where, **beside, **keys} for keys in own] for name, own in given.items()}
    for own in shares.values():
        for one in own if "preload" in beside else ():
            one["preload"] = beside["preload"] / len(own)
    found = {name: numbers(make(own), len(own)) for name, own in shares.items()}
    return {name: float(np.abs(other - found["stiffness"]).max()) for name, other in found.items()}


def require_alike(make: Any, place: str, beside: Table) -> None:
    """Compare to rounding; kinks and limits have other integration points in elements that are cut."""
    stiffness, where = PLACES[place]
    apart = differences(make, where, stiffness, beside)
    cuts = place in ("rectangle across elements", "disc", "polygon", "line across elements")
    others = {"kink further out", "limit further out"} if cuts else set()
    assert max(value for name, value in apart.items() if name not in others) < 1e-9, apart
    assert max(apart.values()) < 1e-2, apart


BESIDE: dict[str, Table] = {
    "both ways": {"resists": "both"},
    "settlement": {"resists": "both", "settlement": "0.002 + 0.001*x"},
    "gap": {"resists": "both", "gap": 0.0004},
    "pushes": {"resists": "down"},
    "preload": {"resists": "both", "preload": 8e3},
    "preload and settlement": {"resists": "both", "preload": 8e3, "settlement": 0.0005},
    "preload, holds down": {"resists": "up", "preload": 8e3},
}


AT_POINTS = ("points", "footprints", "points on a rigid zone")
PAIRS = [(place, "both ways") for place in PLACES]
PAIRS += [(place, beside) for place in ("line across elements", "points") for beside in ("settlement", "gap", "pushes")]
PAIRS += [(place, beside) for place in AT_POINTS for beside in BESIDE if "preload" in beside]


@pytest.mark.parametrize(("place", "beside"), PAIRS)
def test_a_support_is_its_law(place: str, beside: str) -> None:
    require_alike(slab, place, BESIDE[beside])


@pytest.mark.parametrize(
    ("place", "beside"),
    [*((place, "both ways") for place in ("all of the plate", "circle", *AT_POINTS)), ("points", "preload")],
)
def test_so_is_one_between_plates(place: str, beside: str) -> None:
    require_alike(stacked, place, BESIDE[beside])


def test_a_straight_law_is_a_spring() -> None:
    tables = slab([{"area": "all", "resists": "both", "law": [[0, 0], [1e-3, 1e4]]}])
    model = signorini.Model(**tables | {"support": tables["support"][:1], "load": [{"pressure": 1e4}]})
    (result,) = signorini.solve(model).values()
    assert np.allclose(result.deflection, 1e-3, rtol=1e-9)
