"""Reactions are continuous in the places of supports and loads, also across a node, a side or a line."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from models import rectangular

from signorini import Model, NoEquilibriumError, solve
from signorini.discretise import discretise

Tables = dict[str, Any]
Floats = npt.NDArray[np.float64]

SIZE = np.array([6.0, 4.0])
STEP = 1e-5
"""Distance on either side of the node, side or line: above the tolerance for one place."""
JUMP = 1e-3
OF_MESH = 0.02
"""Mesh error relative to the largest reaction: a line on sides holds the plate at their
nodes, one beside them in means of elements, and element sizes that follow moving places change by thresholds."""
LEGS: Tables = {"at": [[0.7, 0.6], [5.3, 0.7], [5.1, 3.4], [0.8, 3.3]], "resists": "down"}
WAYS: list[Tables] = [
    {"resists": "down"},
    {"resists": "both"},
    {"resists": "up", "gap": 1e-4},
    {"resists": "down", "stiffness": 1e7},
    {"stiffness": 1e9},
]
PATH: list[list[float]] = [[1.3, 2.6], [4.4, 1.2]]


def model(mover: Tables, load: Tables, others: list[Tables], mesh: Tables) -> Model:
    return rectangular(
        size=SIZE.tolist(),
        support=[LEGS, *others, *([mover] if mover else [])],
        load=[{"pressure": 2e3}, load],
        mesh={**mesh, "error": False},
    )


def places(rng: Random, others: list[Tables], mesh: Tables) -> list[Floats]:
    """A node, a place on a side between nodes, and one on a line, where these are inside the plate."""
    found = discretise(model({}, {"force": 1e4, "at": [3.1, 2.2]}, others, mesh)).mesh
    inside = np.flatnonzero(((found.points > 0.8) & (found.points < SIZE - 0.8)).all(axis=1))
    node = found.points[rng.choice(inside.tolist())]
    sides = found.unique_sides[np.isin(found.unique_sides, inside).all(axis=1)]
    a, _, b = found.points[sides[rng.randrange(len(sides))]]
    part = rng.uniform(0.1, 0.9)
    begin, end = np.array(PATH)
    return [node, a + part * (b - a), begin + rng.uniform(0.1, 0.9) * (end - begin)]


def moved(kind: str, at: Floats, way: Tables) -> tuple[Tables, Tables]:
    """A support and a load, of which one is at a place or ends there."""
    x, y = at.tolist()
    held = {**way}
    load = {"force": 3e4, "at": [3.3, 1.9]}
    match kind:
        case "point":
            return {"at": [x, y], **held}, load
        case "footprint":
            return {"at": [x, y], "patch": [0.3, 0.4], **held}, load
        case "end of a line":
            return {"line": [[2.9, 3.6], [x, y]], **held}, load
        case "line":
            return {"line": [[x - 0.7, y], [x + 0.7, y]], **held}, load
        case "area":
            return {"area": {"rectangle": [x - 0.7, y - 0.6, x + 0.1, y]}, **held}, load
        case _:
            return {}, {"force": 3e4, "at": [x, y]}


def reactions(made: Model) -> Floats:
    result = solve(made)["all"]
    return np.array([support.reaction for support in result.supports])


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("mesh", [{"divisions": [9, 6]}, {"size": 0.7}], ids=["rows", "size"])
@pytest.mark.parametrize("kind", ["point", "footprint", "end of a line", "line", "area", "load"])
def test_nothing_jumps_as_a_support_or_a_load_passes_a_node_a_side_or_a_line(
    kind: str, mesh: Tables, seed: int
) -> None:
    rng = Random(f"{kind}{seed}{mesh}")
    others = [{"line": PATH, "resists": "down", "stiffness": 1e8}]
    way = rng.choice(WAYS)
    for at in places(rng, others, mesh):
        turn = rng.uniform(0.0, math.tau)
        step = STEP * np.array([math.cos(turn), math.sin(turn)])
        try:
            before, after = (
                reactions(model(*moved(kind, at + side * step, way), others, mesh)) for side in (-1.0, 1.0)
            )
        except NoEquilibriumError:
            continue
        most = OF_MESH if "size" in mesh else JUMP
        assert np.abs(after - before).max() < most * np.abs(before).max(), (at, way)


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("kind", ["point", "line", "end of a line"])
def test_nothing_jumps_beside_a_free_edge_or_a_corner(kind: str, way: Tables) -> None:
    for at in ([2.3, 0.0], [6.0, 2.1], [6.0, 4.0]):
        inward = np.sign(SIZE / 2 - at)
        place = np.array(at) - np.array([0.7, 0.0]) * (kind == "line")
        on, beside = (
            reactions(model(*moved(kind, place + off * inward, way), [], {"divisions": [9, 6]})) for off in (0.0, STEP)
        )
        assert np.abs(beside - on).max() < (JUMP if kind == "point" else OF_MESH) * np.abs(on).max(), (at, way)
