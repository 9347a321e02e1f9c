"""Reactions per length of walls and edges, and the forces concentrated at their corners."""

import csv
import io
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest

import signorini
from signorini.output import reactions_csv, results_json
from signorini.output.pictures import jobs_of
from signorini.plot.pictures import drawn
from signorini.results.line_reactions import LineReactions

NU = 0.3
ALL = ["left", "bottom", "right", "top"]


def square(fix: str = "simple", divisions: int = 16, thickness: float = 0.001, **others: Any) -> signorini.Model:
    """A unit square of D = 1 under q = 1."""
    given: dict[str, Any] = {
        "material": {"E": 12 * (1 - NU**2) / thickness**3, "nu": NU},
        "plate": {"shape": "rectangle", "size": [1, 1], "thickness": thickness},
        "support": [{"name": "edges", "edge": ALL, "fix": fix}],
        "load": [{"pressure": 1.0}],
        "mesh": {"divisions": [divisions, divisions], "error": False},
    }
    return signorini.Model(**given | others)


def slab(*support: dict[str, Any], **others: Any) -> signorini.Model:
    given: dict[str, Any] = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [6, 4], "thickness": 0.2},
        "support": list(support),
        "load": [{"pressure": 1e3}],
        "mesh": {"divisions": [12, 8], "error": False},
    }
    return signorini.Model(**given | others)


def line_of(model: signorini.Model, support: int = -1) -> LineReactions:
    (result,) = signorini.solve(model).values()
    line = result.supports[support].line
    assert line is not None
    total, size = result.supports[support].reaction, np.abs(result.supports[support].reactions).sum()
    assert line.reactions @ line.lengths + line.corner_reactions.sum() == pytest.approx(total, abs=1e-10 * size)
    by_trapezia = np.trapezoid(line.reactions, line.s) + line.corner_reactions.sum()
    assert by_trapezia == pytest.approx(total, abs=1e-10 * size)
    return line


def kirchhoff(y: np.ndarray) -> tuple[np.ndarray, float]:
    """Reaction per length along x = 0 and corner force of the simply supported square, by Navier's double series."""
    m, n = np.arange(1, 1200, 2)[:, None], np.arange(1, 1200, 2)
    terms = 16 / np.pi**3 * (m**2 + (2 - NU) * n**2) / (n * (m**2 + n**2) ** 2.0)
    corner = -2 * (1 - NU) * 16 / np.pi**4 * (1 / (m**2 + n**2) ** 2.0).sum()
    return np.sin(np.pi * np.outer(y, n)) @ terms.sum(axis=0), float(corner)


def triangles(path: Path, n: int) -> Path:
    """Write a square of 6-node triangles."""
    count = 2 * n + 1
    x, y = np.meshgrid(np.linspace(0, 1, count), np.linspace(0, 1, count))
    node = np.arange(count**2).reshape(count, count)
    a, b, c, d = node[:-1:2, :-1:2], node[:-1:2, 2::2], node[2::2, 2::2], node[2::2, :-1:2]
    ab, bc, cd, da, ac = node[:-1:2, 1::2], node[1::2, 2::2], node[2::2, 1::2], node[1::2, :-1:2], node[1::2, 1::2]
    cells = np.concatenate(
        [np.stack([one.ravel() for one in of], axis=1) for of in ((a, b, c, ab, bc, ac), (a, c, d, ac, cd, da))]
    )
    sides = {"bottom": node[0], "top": node[-1], "left": node[:, 0], "right": node[:, -1]}
    lines = np.concatenate([np.stack([one[:-1:2], one[2::2], one[1::2]], axis=1) for one in sides.values()])
    sets = {name: [np.zeros(0, int), np.arange(at * n, (at + 1) * n)] for at, name in enumerate(sides)}
    points = np.column_stack([x.ravel(), y.ravel(), 0 * x.ravel()])
    meshio.Mesh(points, [("triangle6", cells), ("line3", lines)], cell_sets=sets).write(path)
    return path


@pytest.mark.parametrize(("fix", "thickness"), [("hard", 0.1), ("hard", 0.01), ("hard", 0.001), ("simple", 0.001)])
@pytest.mark.parametrize("kind", ["mitc9", "triangles"])
def test_a_simply_supported_square_has_kirchhoffs_reactions_and_corner_forces(
    tmp_path: Path, fix: str, thickness: float, kind: str
) -> None:
    # S. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, art. 30: R = 0.065 q a².
    plate = {"shape": "rectangle", "size": [1, 1], "thickness": thickness}
    if kind == "triangles":
        plate = {"shape": "mesh", "file": str(triangles(tmp_path / "square.inp", 16)), "thickness": thickness}
    mesh = {"error": False} if kind == "triangles" else {"divisions": [16, 16], "error": False}
    line = line_of(square(fix, thickness=thickness, plate=plate, mesh=mesh))
    on = np.isclose(line.positions[:, 0], 0.0) & (np.abs(line.positions[:, 1] - 0.5) < 0.4)
    exact, corner = kirchhoff(line.positions[on, 1])
    assert corner == pytest.approx(-0.0650, abs=5e-5)
    assert line.reactions[on] == pytest.approx(exact, rel=0.015)
    assert len(line.corners) == 4
    assert line.corner_reactions == pytest.approx(corner, rel=0.08 if kind == "triangles" else 0.01)
    assert line.max_per_length == pytest.approx(0.4205, rel=0.005)


@pytest.mark.parametrize("thickness", [0.001, 0.02])
def test_reactions_of_a_clamped_square_are_smooth_and_have_no_corner_forces(thickness: float) -> None:
    # Ritz's method with (1 − x²)²(1 − y²)² times 14 Legendre polynomials each way: 0.4413 q a at the middle, and
    # w = 0.00126532 q a⁴/D, as R. L. Taylor, S. Govindjee, Commun. Numer. Meth. Engng 20 (2004) have it.
    coarse, fine = (line_of(square("clamped", divisions=n, thickness=thickness)) for n in (8, 16))
    assert fine.max_per_length == pytest.approx(0.441, rel=0.01)
    assert coarse.max_per_length == pytest.approx(fine.max_per_length, rel=0.02)
    assert fine.max_per_length_at in ((0.0, 0.5), (0.5, 0.0))
    assert np.abs(fine.corner_reactions).max() < 1e-3
    assert np.diff(fine.reactions[:9]).min() > 0.0


@pytest.mark.parametrize("thickness", [0.001, 0.02, 0.05])
@pytest.mark.parametrize("element", ["mitc9", "q8r"])
def test_reactions_of_neighbours_do_not_alternate(element: str, thickness: float) -> None:
    plate = {"shape": "rectangle", "size": [1, 1], "thickness": thickness, "element": element}
    line = line_of(square(thickness=thickness, plate=plate, divisions=24))
    middle = line.reactions[np.abs(line.s - 0.5) < 0.2]
    assert (np.abs(np.diff(middle, 2)) < 0.02 * middle.max()).all()
    assert (np.diff(np.sign(np.diff(middle))) != 0).sum() == 1


@pytest.mark.parametrize(
    "wall",
    [
        {"fix": "simple"},
        {"fix": "clamped"},
        {"resists": "down"},
        {"stiffness": 1e8},
        {"resists": "down", "stiffness": 1e12},
        {"resists": "down", "limit": 1e9},
    ],
    ids=str,
)
def test_a_strip_between_two_walls_has_half_of_its_load_on_each(wall: dict[str, Any]) -> None:
    model = slab({"edge": ["left", "right"], **wall}, material={"E": 30e9, "nu": 0.0})
    line = line_of(model)
    assert line.reactions == pytest.approx(3000.0, rel=2e-3)
    assert line.corner_reactions == pytest.approx(0.0, abs=5.0)


EDGES = {"edge": ALL, "fix": "simple"}


@pytest.mark.parametrize(
    ("walls", "others"),
    [
        ([{"line": [[3, 1], [3, 3]]}], {}),
        ([{"line": [[2.03, 1.02], [4.11, 2.87]]}], {}),
        ([{"line": [[3, 0], [3, 4]]}, {"line": [[3, 2], [6, 2]]}], {}),
        ([{"line": [[1.5, 1], [4.5, 1], [4.5, 3]]}], {}),
        ([{"circle": {"center": [3, 2], "radius": 1}, "resists": "down"}], {}),
        ([{"circle": {"center": [3, 2], "radius": 1}, "stiffness": 1e8}], {"mesh": {"error": False}}),
        ([{"line": [[3, 0], [3, 4]], "resists": "down", "gap": 1e-5}], {"load": [{"pressure": -1e3}]}),
        ([{"line": [[1, 1.99], [5, 2.01]], "resists": "up"}], {}),
    ],
)
def test_the_integral_is_the_total_wherever_walls_are(walls: list[dict[str, Any]], others: dict[str, Any]) -> None:
    model = slab(EDGES, *walls, **others)
    for support in range(1 + len(walls)):
        line = line_of(model, support)
        sign = {"down": 1.0, "up": -1.0}.get(model.support[support].resists or "", 0.0)
        if sign:
            assert (sign * line.reactions >= 0.0).all() and (sign * line.corner_reactions > -1e-6).all()


def test_a_circle_and_a_rim_have_no_corners_and_even_reactions() -> None:
    disc = {"shape": "disc", "center": [0, 0], "radius": 2, "thickness": 0.2}
    for fix in ("simple", "hard"):
        line = line_of(slab({"edge": "rim", "fix": fix}, plate=disc, mesh={"error": False}))
        assert line.reactions == pytest.approx(1000.0, rel=2e-3)
        assert not len(line.corners)
        assert line.s[-1] == pytest.approx(4 * np.pi, rel=1e-4)


def test_a_line_that_cuts_elements_reacts_as_one_that_the_mesh_follows() -> None:
    wall = {"line": [[2.03, 1.02], [4.11, 2.87]]}
    followed = line_of(slab(EDGES, wall, mesh={"size": 0.25, "error": False}))
    cutting = line_of(slab(EDGES, wall, mesh={"divisions": [48, 32], "error": False}))
    middle = np.linspace(1.0, 1.8, 5)
    expected = np.interp(middle, followed.s, followed.reactions)
    assert np.interp(middle, cutting.s, cutting.reactions) == pytest.approx(expected, rel=0.03)


def test_on_a_rigid_zone_the_reaction_per_length_is_linear() -> None:
    zone = [{"area": {"rectangle": [2.5, 1, 3.5, 3]}, "rigid": True}]
    line = line_of(slab(EDGES, {"line": [[3, 0], [3, 4]]}, zone=zone))
    inside = (line.positions[:, 1] > 1.1) & (line.positions[:, 1] < 2.9)
    assert np.diff(line.reactions[inside], 2) == pytest.approx(0.0, abs=1e-6)
    assert line.reactions == pytest.approx(line.reactions[::-1], rel=1e-6)


def test_between_two_plates_the_lower_one_has_the_opposite() -> None:
    plates = {
        "up": {"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        "low": {"shape": "rectangle", "size": [4, 4], "thickness": 0.3},
    }
    support = [
        {"plate": "low", "area": "all", "resists": "down", "stiffness": 5e7},
        {"name": "wall", "between": ["up", "low"], "line": [[2, 0], [2, 4]]},
        {"name": "side", "between": ["up", "low"], "line": [[1, 0], [1, 4]], "resists": "down"},
    ]
    model = signorini.Model(
        material={"E": 30e9, "nu": 0.2},
        plates=plates,
        support=support,
        load=[{"plate": "up", "pressure": 1e3}],
        mesh={"error": False},
    )
    result = signorini.solve(model)["all"]
    for name in ("wall", "side"):
        upper, lower = (
            next(one.line for one in of.supports if one.name == name) for of in (result, result.plates["low"])
        )
        total = upper.reactions @ upper.lengths + upper.corner_reactions.sum()
        assert lower.reactions @ lower.lengths + lower.corner_reactions.sum() == pytest.approx(-total, rel=1e-10)


def tabled() -> signorini.Model:
    combinations = [{"name": f"c{i}", "factors": {"G": 1.0, "Q": i - 1.0}} for i in range(3)]
    return slab(
        {"name": "hard", "edge": ["left", "bottom"], "fix": "hard"},
        {"name": "clamped", "edge": "right", "fix": "clamped"},
        {"name": "wall", "line": [[3, 1], [3, 3]], "resists": "down"},
        load=[{"case": "G", "pressure": 1e3}, {"case": "Q", "pressure": 2e3, "area": {"rectangle": [0, 0, 3, 4]}}],
        combination=combinations,
        output={"combinations": "table"},
    )


def test_tables_and_envelopes_have_what_the_combinations_have_by_themselves() -> None:
    results = signorini.solve(tabled())
    every = [results[name] for name in results]
    found = results_json(results)["envelope"]["supports"]
    for at, name in enumerate(("hard", "clamped", "wall")):
        lines = [one.supports[at].line for one in every]
        for side, over in (("max", max), ("min", min)):
            own = [getattr(line, f"{side}_per_length") for line in lines]
            assert results.table[f"{side}_per_length:{name}"] == pytest.approx(own, rel=1e-8, abs=1e-6)
            assert found[at][f"{side}_per_length"][side] == pytest.approx(over(own), rel=1e-8)
            assert found[at][f"{side}_per_length"][f"{side}_by"] == list(results)[own.index(over(own))]
            stations = [getattr(np.stack([line.reactions for line in lines]), side)(axis=0)]
            told = [station[side] for station in found[at]["line"]]
            assert told == pytest.approx(stations[0], rel=1e-8, abs=1e-6)
            corners = getattr(np.stack([line.corner_reactions for line in lines]), side)(axis=0)
            assert [corner[side] for corner in found[at]["corners"]] == pytest.approx(corners, rel=1e-8, abs=1e-6)
    named = {(one["combination"], one["kind"]): one["file"] for one in results_json(results)["files"]}
    assert named[None, "line reactions"] == "envelope-reactions.png"
    wanted = {file for (_, kind), file in named.items() if kind == "line reactions"}
    (job,) = jobs_of(results, None)
    pictures = dict(drawn(replace(job, sheets=[one for one in job.sheets if wanted & set(one.files)])))
    assert set(pictures) == wanted
    assert all(content.startswith(b"\x89PNG") for content in pictures.values())


def test_files_say_what_the_result_says() -> None:
    model = slab(
        {"name": "hard", "edge": ["left", "bottom"], "fix": "hard"},
        {"name": "clamped", "edge": "right", "fix": "clamped"},
        mesh={"divisions": [12, 8]},
    )
    results = signorini.solve(model)
    result, estimates = results["all"], signorini.estimate(results)
    (combination,) = results_json(results, estimates)["combinations"]
    for support, said, told in zip(
        result.supports, combination["supports"], combination["plus_minus"]["supports"], strict=True
    ):
        line = support.line
        assert line is not None
        assert [one["reaction"] for one in said["line"]] == line.reactions.tolist()
        assert [one["at"] for one in said["line"]] == line.positions.tolist()
        assert [one["reaction"] for one in said["corners"]] == line.corner_reactions.tolist()
        assert (said["max_per_length"], said["max_per_length_at"]) == (line.max_per_length, [*line.max_per_length_at])
        assert told["max_per_length"] > 0.0 and len(told["corners"]) == len(line.corners)
        assert told["corners"][0]["reaction"] is not None
    clamped = combination["supports"][1]["line"]
    couples = sum(one["couple"] * np.hypot(*np.subtract(one["to"], one["from"])) for one in clamped)
    edge = result.supports[1].edge
    assert edge is not None
    assert couples == pytest.approx(edge.couples @ np.hypot(*(edge.sides[:, 1] - edge.sides[:, 0]).T), rel=1e-12)
    rows = [row for row in csv.DictReader(io.StringIO(reactions_csv(results, estimates))) if row["support"] == "hard"]
    total, *points = rows
    line = result.supports[0].line
    assert line is not None
    assert float(total["max_per_length"]) == line.max_per_length
    assert float(total["max_per_length_plus_minus"]) > 0.0
    forces = [float(row["corner_reaction"]) for row in points if row["corner_reaction"]]
    assert sorted(forces) == sorted(line.corner_reactions.tolist())
    along = {float(row["s"]): float(row["reaction_per_length"]) for row in points}
    assert along[line.s[1]] == pytest.approx(line.reactions[1])


def test_a_finer_mesh_moves_walls_reactions_by_little() -> None:
    # The layer that carries the corner forces of this plate is known to fine elements and not to coarse ones.
    lines = [line_of(square(divisions=n, thickness=0.05)) for n in (12, 24, 48)]
    assert [line.max_per_length for line in lines] == pytest.approx([lines[2].max_per_length] * 3, rel=0.005)
    corners = [line.corner_reactions.mean() for line in lines]
    assert corners == pytest.approx([corners[2]] * 3, rel=0.15)
    assert all(line.min_per_length > 0.0 for line in lines)
