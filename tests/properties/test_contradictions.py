"""Rigid supports with settlements or gaps that contradict each other where they meet are refused, others are not."""

import meshio
import numpy as np
import pytest

import signorini
from signorini import InputError, Model, path, solve
from signorini.analysis.check import check
from signorini.discretise import discretise
from signorini.discretise.quadrature.crossings import evaluate, quadratics
from signorini.mesh.meshers import disc

ACROSS = {"line": [[0.5, 2.1], [3.5, 2.1]]}
OBLIQUE = {"line": [[2.2, 0.5], [2.6, 3.5]]}
RING = {"circle": {"center": [2.0, 2.0], "radius": 0.9}}
PATCH = {"area": {"rectangle": [1.3, 1.2, 2.9, 2.7]}}
ROUND = {"area": {"circle": {"center": [1.9, 2.0], "radius": 0.8}}}
LOWER = {"settlement": 1e-3}
PLATE = {"shape": "rectangle", "size": [4, 4], "thickness": 0.2}
DISC = {"shape": "disc", "radius": 2.0, "center": [2.0, 2.0], "thickness": 0.2}
SECTOR = {"shape": "disc", "radius": 2.0, "center": [2.0, 2.0], "sector": 180, "thickness": 0.2}


def model(supports, plate=PLATE, **more):
    return Model(
        material={"E": 30e9, "nu": 0.2},
        plate=plate,
        support=[*supports, {"name": "pads", "at": [[2.1, 2.6], [2.9, 3.1], [1.6, 3.2]], "stiffness": 1e6}],
        load=[{"pressure": 5e3}],
        **more,
    )


MEETING = {
    "lines that cross": ([ACROSS, {**OBLIQUE, **LOWER}], PLATE),
    "a circle twice": ([RING, {**RING, **LOWER}], PLATE),
    "lines that overlap": ([ACROSS, {"line": [[1.0, 2.1], [3.9, 2.1]], **LOWER}], PLATE),
    "a line from a held edge": ([{"edge": "left"}, {"line": [[0, 1.3], [1.7, 2.2]], **LOWER}], PLATE),
    "a line from a clamped rim": ([{"edge": "rim", "fix": "clamped"}, {"line": [[2, 2], [3.2, 3.6]], **LOWER}], DISC),
    "a circle cut by a sector": ([{"edge": "start"}, {**RING, **LOWER}], SECTOR),
    "a point on a line": ([{"at": [[1.3, 2.1], [0.9, 0.9]]}, {**ACROSS, **LOWER}], PLATE),
    "a point on a circle": ([{"at": [2.54, 2.72]}, {**RING, **LOWER}], PLATE),
    "areas that overlap": ([PATCH, {**ROUND, **LOWER}], PLATE),
    "areas that touch": ([PATCH, {"area": {"rectangle": [2.9, 1.0, 3.7, 2.2]}, **LOWER}], PLATE),
    "a point on an area": ([PATCH, {"at": [2.0, 1.7], **LOWER}], PLATE),
    "a line over an area": ([PATCH, {**OBLIQUE, **LOWER}], PLATE),
    "a line within an area": ([PATCH, {"line": [[1.9, 1.9], [2.1, 2.2]], **LOWER}], PLATE),
    "a line on a bed that has not settled": ([{"area": "all", "resists": "down"}, {**OBLIQUE, **LOWER}], PLATE),
    "a pit in a bed that is far below elsewhere": (
        [{"area": "all", "settlement": "where(hypot(x - 2, y - 2) < 1, 0, 1e6)"}, {"at": [2.1, 2], **LOWER}],
        PLATE,
    ),
    "points at one place": ([{"at": [1.3, 2.3]}, {"at": [1.3, 2.3], **LOWER}], PLATE),
    "formulas that miss by 1e-6 of what they reach": (
        [{**ACROSS, "settlement": "0.01*(x - 0.3)"}, {"line": [[0.6, 0.5], [0.6, 3.5]], "settlement": "0.00300004"}],
        PLATE,
    ),
    "a formula that misses zero by 1e-6 of what it reaches": (
        [{"edge": "bottom", "settlement": "0.01*sin(pi*x/4) + 1e-8"}, {"edge": "right"}],
        PLATE,
    ),
    "a pin that misses an edge by 1e-6 of what it reaches": (
        [{"edge": "bottom", "settlement": "0.001*(x - 1.1*3)"}, {"at": [3.3, 0], "settlement": 4e-9}],
        PLATE,
    ),
    "a jump where an edge meets a line": (
        [{"line": [[2, 1.1], [3.5, 1.1]], "settlement": "where(x < 2, 0, 1e-3)"}, {"at": [2, 1.1]}],
        PLATE,
    ),
    "points of two supports among many": (
        [{"at": [[0.1 + 0.2 * i, y] for i in range(19)], "settlement": 1e-4 * k} for k, y in enumerate((1.3, 1.3))],
        PLATE,
    ),
}


@pytest.mark.parametrize("case", MEETING)
def test_supports_that_contradict_each_other_where_they_meet_are_refused(case: str) -> None:
    supports, plate = MEETING[case]
    words = r"^support\[[12]\]: Supports contradict .* at \[.*\]: .*support\[[12]\] and support\[[12]\].*settlement"
    for tables in (supports, supports[::-1]):
        with pytest.raises(InputError, match=words):
            solve(model(tables, plate))


def test_the_message_names_place_supports_and_by_how_much() -> None:
    words = r"support\[2\]: Supports contradict .* at \[2.4, 2\]: .* support\[1\] and support\[2\] .* by 0.001\."
    sloping = {"line": [[0.5, 2.0], [3.5, 2.0]], "settlement": "2e-3*x/2.4"}
    with pytest.raises(InputError, match=words):
        solve(model([sloping, {**OBLIQUE, **LOWER}]))


def test_a_path_and_a_check_refuse_the_same() -> None:
    wrong = model(MEETING["lines that cross"][0])
    said = []
    for ask in (solve, check, lambda model: path(model, None, "load")):
        with pytest.raises(InputError, match="contradict each other") as caught:
            ask(wrong)
        said.append(str(caught.value))
    assert len(set(said)) == 1


AGREEING = {
    "lines that settle together": [{**ACROSS, **LOWER}, {**OBLIQUE, **LOWER}],
    "a formula that agrees at the crossing": [
        {**ACROSS, "settlement": "5e-4*x"},
        {"line": [[2, 0.5], [2, 3.5]], **LOWER},
    ],
    "a formula on a circle": [{**RING, "settlement": "1e-3*(1 + (x - 2.9)*(y - 2))"}, {"at": [2.9, 2.0], **LOWER}],
    "lines that miss each other": [ACROSS, {"line": [[2.2, 0.5], [2.3, 1.4]], **LOWER}],
    "free travel that reaches": [{**ACROSS, "gap": 2e-3}, {**OBLIQUE, **LOWER}],
    "a stop below": [{**ACROSS, "resists": "down", "settlement": 2e-3}, {**OBLIQUE, **LOWER}],
    "a hold-down above": [{**ACROSS, "resists": "up"}, {**OBLIQUE, **LOWER}],
    "an elastic line": [{**ACROSS, "stiffness": 1e8}, {**OBLIQUE, **LOWER}],
    "slopes alone": [{**ACROSS, "fix": "symmetry"}, {**OBLIQUE, **LOWER}],
}


MEETING_AT_ZERO = {
    "a sine over an edge": (
        [{"edge": ["left", "right", "top"]}, {"edge": "bottom", "settlement": "0.01*sin(pi*x/4)"}],
        PLATE,
    ),
    "an edge through zero at a pin": (
        [{"edge": "bottom", "settlement": "0.001*(x - 1.1*3)"}, {"at": [3.3, 0]}, {"at": [[1, 3], [3, 3]]}],
        PLATE,
    ),
    "a line through zero at another": (
        [{**ACROSS, "settlement": "0.01*(x - 0.6)"}, {"line": [[0.2 + 0.2 + 0.2, 0.5], [0.6, 3.5]]}],
        PLATE,
    ),
    "a line that is zero all along": (
        [
            {"line": [[0.1 + 0.2, 0.5], [0.1 + 0.2, 3.5]], "settlement": "0.01*(x - 0.3)"},
            {"line": [[0, 2.1], [4, 2.1]]},
        ],
        PLATE,
    ),
    "a rim that waves": (
        [{"edge": "rim", "settlement": "0.001*sin(2*atan2(y - 2, x - 2))"}, {"at": [[2, 4], [2, 0], [0, 2], [4, 2]]}],
        DISC,
    ),
    "a root that is zero": (
        [
            {"edge": "outer", "settlement": "0.001*x"},
            {"circle": {"center": [0, 0], "radius": 5}, "settlement": "0.001*sqrt(25 - y**2)*sign(x)"},
        ],
        {"shape": "annulus", "inner": 0.5, "outer": 5, "thickness": 0.2},
    ),
    "far from the origin": (
        [{"edge": "bottom", "settlement": "0.01*sin(pi*(x - 1e6)/4)"}, {"edge": "right"}],
        {**PLATE, "origin": [1e6, 0]},
    ),
}


@pytest.mark.parametrize("case", MEETING_AT_ZERO)
def test_formulas_that_meet_at_zero_but_for_rounding_are_solved(case: str) -> None:
    supports, plate = MEETING_AT_ZERO[case]
    for tables in (supports, supports[::-1]):
        wanted = Model(
            material={"E": 30e9, "nu": 0.2}, plate=plate, support=tables, load=[{"pressure": 5e3}], mesh={"size": 0.5}
        )
        assert signorini.solve(wanted)["all"].certificate.passed


def test_supports_of_many_points_are_compared_where_they_are_near() -> None:
    rows = [{"at": [[0.1 + 0.2 * i, 0.03 * k] for i in range(19)], "settlement": 1e-4 * k} for k in range(1, 100)]
    discretise(model([{**row, "gap": 1e-5} for row in rows]))
    rows[80]["at"][7] = rows[3]["at"][11]
    words = r"support\[81\]: Supports contradict each other at \[2.3, 0.12\]: .* support\[4\] and support\[81\]"
    with pytest.raises(InputError, match=words):
        discretise(model(rows))


@pytest.mark.parametrize("case", AGREEING)
def test_supports_that_agree_where_they_meet_are_solved(case: str) -> None:
    result = signorini.solve(model(AGREEING[case], mesh={"divisions": [6, 6]}))["all"]
    assert result.certificate.passed
    assert abs(result.deflection).max() < 0.05


def test_an_edge_of_a_mesh_file_is_met_where_its_sides_curve(tmp_path) -> None:
    mesh = disc((2.0, 2.0), 2.0, (4, 8))
    points = np.column_stack([mesh.points, np.zeros(mesh.node_count)])
    meshio.Mesh(points, [("quad8", mesh.elements)]).write(tmp_path / "disc.vtu")
    plate = {"shape": "mesh", "file": str(tmp_path / "disc.vtu"), "thickness": 0.2}
    sides = quadratics(mesh.points[mesh.boundary[:1]])
    (on_side,) = evaluate(sides, np.array([0.4])).tolist()
    with pytest.raises(InputError, match="contradict each other"):
        solve(model([{"edge": "boundary", "fix": "simple"}, {"at": on_side, **LOWER}], plate))
