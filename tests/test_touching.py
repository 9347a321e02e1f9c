"""Rigid lines and circles that run along an edge or each other so near that they are meant to be on it."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from models import rectangular

from signorini import InputError, Model, solve
from signorini.discretise import discretise
from signorini.formats.vtk import write_vtu
from signorini.mesh import meshers

RADIUS, MIDDLE = 5.0, (5.0, 4.0)
DISC = {"shape": "disc", "radius": RADIUS, "center": MIDDLE, "thickness": 0.3}
SQUARE = {"shape": "rectangle", "origin": [-1, -2], "size": [12, 12], "thickness": 0.3}
RIM = {"name": "rim", "edge": "rim", "fix": "simple"}
EDGES = {"name": "edges", "edge": ["left", "right", "bottom", "top"], "fix": "simple"}
RING = {"name": "ring", "circle": {"center": MIDDLE, "radius": 3}, "fix": "simple"}
WAYS = pytest.mark.parametrize("way", [{"fix": "simple"}, {"resists": "down"}, {"resists": "up"}])
HELD = {"fix": "simple"}
Tables = dict[str, Any]


def around(radius: float, count: int, begin: float = 0.0, turn: float = 360.0) -> list[list[float]]:
    """Ends of chords of a circle, from an angle on."""
    angle = np.radians(np.linspace(begin, begin + turn, count + 1))
    points = MIDDLE + radius * np.column_stack([np.cos(angle), np.sin(angle)])
    if turn == 360.0:
        points[-1] = points[0]
    return points.tolist()


def polygon(count: int) -> Tables:
    return {"shape": "polygon", "points": around(RADIUS, count)[:-1], "thickness": 0.3}


def given(plate: Tables, *support: Tables, **others: Any) -> Model:
    said = {"mesh": {"size": 0.8, "error": False}, "load": [{"pressure": 1e4}]} | others
    return rectangular(plate=plate, support=support, **said)


def assert_one_support(model: Model, wanted: Model) -> None:
    """Reactions and deflections are as if what runs along something were it."""
    found, exact = (solve(one)["all"] for one in (model, wanted))
    deflections = [one.probe([MIDDLE, (5.3, 0.9)]) for one in (found, exact)]
    largest = max(abs(one.deflection) for one in deflections[1])
    for mine, other in zip(*deflections, strict=True):
        assert mine.deflection == pytest.approx(other.deflection, abs=1e-2 * largest)
    load = sum(exact.reactions.values())
    assert sum(found.reactions.values()) == pytest.approx(load, rel=1e-3)
    assert max(map(abs, found.reactions.values())) <= 1.01 * load
    assert not [words for words in found.warnings if "pry" in words or "not follow" in words]


@WAYS
@pytest.mark.parametrize(("count", "begin", "turn"), [(39, 17.2, 60.0), (130, 0.0, 360.0), (131, 3.7, 360.0)])
def test_chords_of_a_round_edge_are_on_it(way, count, begin, turn) -> None:
    wall = {"name": "wall", "line": around(RADIUS, count, begin, turn), **way}
    assert_one_support(given(DISC, RIM, wall), given(DISC, RIM))


@WAYS
@pytest.mark.parametrize("turned", [0.0, 1.3])
def test_a_circle_within_a_polygon_is_on_its_edges(way, turned) -> None:
    plate = polygon(180) | {"points": around(RADIUS, 180, turned)[:-1]}
    edges = {"name": "edges", "edge": [f"edge {i}" for i in range(1, 181)], "fix": "simple"}
    inscribed = {"center": MIDDLE, "radius": RADIUS * math.cos(math.pi / 180)}
    assert_one_support(given(plate, edges, {"name": "ring", "circle": inscribed, **way}), given(plate, edges))


@WAYS
@pytest.mark.parametrize("chords_first", [False, True])
@pytest.mark.parametrize(("count", "begin", "turn"), [(120, 0.0, 360.0), (121, 5.3, 360.0), (50, 5.3, 137.0)])
def test_chords_of_a_circle_are_on_it(way, chords_first, count, begin, turn) -> None:
    wall = {"name": "wall", "line": around(3.0, count, begin, turn), **way}
    both = [wall, RING] if chords_first else [RING, wall]
    assert_one_support(given(SQUARE, EDGES, *both), given(SQUARE, EDGES, RING))


def test_a_wall_runs_along_a_circle_and_then_on() -> None:
    bent, onward = around(3.0, 40, 0.0, 90.0), [4.0, 9.0]
    wall = {"name": "wall", "line": [*bent, onward], **HELD}
    straight = wall | {"line": [[5.0, 7.0], onward]}
    assert_one_support(given(SQUARE, EDGES, RING, wall), given(SQUARE, EDGES, RING, straight))


@pytest.mark.parametrize("turned", [0.0, 2.2])
def test_chords_along_chords_are_on_them(turned) -> None:
    one, other = (
        {"name": name, "line": around(3.0, count, begin), **HELD}
        for name, count, begin in (("one", 90, 0.0), ("other", 107, turned))
    )
    found = solve(given(SQUARE, EDGES, one, other))["all"]
    wanted = solve(given(SQUARE, EDGES, one))["all"]
    assert found.deflection.max() == pytest.approx(wanted.deflection.max(), rel=2e-2)
    assert max(map(abs, found.reactions.values())) < 1.5e6
    assert not [words for words in found.warnings if "pry" in words]


@pytest.mark.parametrize("mesh", [{"divisions": [4, 24]}, {"divisions": [5, 31]}])
@WAYS
def test_chords_of_a_round_edge_are_on_it_on_meshes_in_rows(way, mesh) -> None:
    wall = {"name": "wall", "line": around(RADIUS, 39, 17.2, 60.0), **way}
    found, wanted = (solve(given(DISC, RIM, *more, mesh=mesh | {"error": False}))["all"] for more in ([wall], []))
    assert found.deflection.max() == pytest.approx(wanted.deflection.max(), rel=1e-6)
    assert max(map(abs, found.reactions.values())) < 8e5


@pytest.mark.parametrize("digits", [8, 17])
@WAYS
def test_chords_of_a_round_edge_of_a_mesh_from_a_file_are_on_it(tmp_path: Path, digits, way) -> None:
    mesh = meshers.disc(MIDDLE, RADIUS, (4, 24))
    points = np.array([[float(f"{x:.{digits}g}") for x in point] for point in mesh.points])
    write_vtu(tmp_path / "disc.vtu", points, mesh.elements, {"w": np.zeros(len(points))})
    plate = {"shape": "mesh", "file": str(tmp_path / "disc.vtu"), "thickness": 0.3}
    rim = RIM | {"edge": "boundary"}
    walls = [[], *([{"name": "wall", **one, **way}] for one in WALLS)]
    wanted, *others = (solve(given(plate, rim, *wall, mesh={"error": False}))["all"] for wall in walls)
    for found in others:
        assert found.deflection.max() == pytest.approx(wanted.deflection.max(), rel=1e-6)
        assert max(map(abs, found.reactions.values())) < 8e5
        assert not [words for words in found.warnings if "pry" in words]


WALLS: list[Tables] = [
    {"line": around(RADIUS, 39, 17.2, 60.0)},
    {"line": around(RADIUS, 131, 3.7)},
    {"circle": {"center": MIDDLE, "radius": RADIUS - 1e-3}},
]


@pytest.mark.parametrize(
    ("ring", "wall"),
    [
        ({"resists": "down"}, {"resists": "up"}),
        ({"resists": "down"}, {"resists": "down", "gap": 1e-3}),
        ({"resists": "down", "gap": 1e-3}, {"resists": "up"}),
        ({"resists": "both"}, {"resists": "both", "gap": 1e-3}),
        ({"fix": "simple", "settlement": 1e-3}, {"resists": "down", "settlement": 1e-3}),
        ({"fix": "simple"}, {"fix": "clamped"}),
    ],
)
def test_of_any_kind_they_answer_as_one_line_does(ring, wall) -> None:
    """A circle twice, and with its chords for the second."""
    circle = {"name": "ring", "circle": RING["circle"], **ring}
    twice = given(SQUARE, EDGES, circle, {"name": "wall", "circle": RING["circle"], **wall})
    chords = given(SQUARE, EDGES, circle, {"name": "wall", "line": around(3.0, 120), **wall})
    found, wanted = (solve(one)["all"] for one in (chords, twice))
    for name, reaction in wanted.reactions.items():
        assert found.reactions[name] == pytest.approx(reaction, rel=1e-6, abs=1.0)
    assert found.deflection.max() == pytest.approx(wanted.deflection.max(), rel=1e-6)


def test_settlements_that_contradict_each_other_along_a_line_are_refused() -> None:
    wall = {"name": "wall", "line": around(3.0, 120, 0.0, 90.0), "fix": "simple", "settlement": 1e-3}
    with pytest.raises(
        InputError, match=r"Supports contradict each other at .* holds the plate at 0 there and .* at 0\.001\."
    ):
        discretise(given(SQUARE, EDGES, RING, wall))


def test_what_is_elastic_or_farther_off_stays_where_it_is() -> None:
    for wall in ({"line": around(3.0, 120), "stiffness": 1e8}, {"line": around(3.0, 20), **HELD}):
        assert discretise(given(SQUARE, EDGES, RING, wall)).model.support[2].course is None


def test_what_is_on_a_line_already_stays_as_it_is() -> None:
    wall = {"line": [[1.0, -2.0], [7.0, -2.0]], **HELD}
    beside = {"line": [[2.0, -2.0], [9.0, -2.0], [9.0, 3.0]], **HELD}
    model = given(SQUARE, EDGES, wall, beside)
    assert discretise(model).model == model


@pytest.mark.parametrize("degrees", [0.0, 45.0, 71.3])
@pytest.mark.parametrize(("off", "touches"), [(2.7e-3, True), (3.0e-3, False)])
def test_how_the_plate_lies_does_not_tell_what_touches(degrees, off, touches) -> None:
    """A square of 10, whose diameter is 14.1, and a wall that ends beside an edge."""
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    corners, wall = (
        [[cos * x - sin * y, sin * x + cos * y] for x, y in points]
        for points in ([(0, 0), (10, 0), (10, 10), (0, 10)], [(3, off), (4, 5)])
    )
    plate = {"shape": "polygon", "points": corners, "thickness": 0.3}
    edges = {"edge": [f"edge {i}" for i in range(1, 5)], "fix": "simple"}
    model = given(plate, edges, {"line": wall, **HELD})
    if not touches:
        with pytest.raises(InputError, match="at least a tenth of the thickness apart"):
            discretise(model)
        return
    (end, _) = discretise(model).model.support[1].line
    assert math.dist(end, wall[0]) > 1e-6
