"""Rigid zones: closed forms, the limit of stiff zones, and constraint rows on the whole plate solved densely."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from signorini import Model, contact_problem, solve

E, NU, H = 30e9, 0.25, 0.2


def test_a_clamped_plate_with_a_rigid_disc_deflects_as_timoshenko_says():
    # Timoshenko & Woinowsky-Krieger (1959), article 17: w = A + B r² + C ln r + P/(8πD) r² ln r, and the shear's part.
    a, b, force = 4.0, 1.0, 1e5
    model = Model(
        material={"E": E, "nu": NU},
        plate={"shape": "disc", "radius": a, "thickness": H, "sector": 90},
        mesh={"divisions": [32, 24]},
        support=[{"edge": "rim", "fix": "clamped"}, {"edge": ["start", "end"], "fix": "symmetry"}],
        zone=[{"area": {"circle": {"center": [0, 0], "radius": b}}, "rigid": True}],
        load=[{"force": force / 4, "at": [0, 0]}],
        probe=[{"at": [[2, 0], [0, 2.5]]}],
    )
    rigidity, shear = E * H**3 / (12 * (1 - NU**2)), 5 / 6 * E / (2 * (1 + NU)) * H
    part = force / (8 * np.pi * rigidity)

    def row(r):
        return [2 * r, 1 / r], -part * (2 * r * np.log(r) + r)

    (one, right), (other, beside) = row(a), row(b)
    square, log = np.linalg.solve([one, other], [right, beside])

    def bent(r):
        return square * (r**2 - a**2) + log * np.log(r / a) + part * (r**2 * np.log(r) - a**2 * np.log(a))

    def moment(r):
        first = 2 * square * r + log / r + part * (2 * r * np.log(r) + r)
        second = 2 * square - log / r**2 + part * (2 * np.log(r) + 3)
        return -rigidity * (second + NU * first / r)

    result = solve(model)["all"]
    expected = bent(b) + force / (2 * np.pi * shear) * np.log(a / b)
    assert result.deflection.max() == pytest.approx(expected, rel=2e-4)
    assert np.ptp(result.deflection[np.hypot(*result.mesh.points.T) < b * 1.0001]) < 1e-12 * expected
    assert result.probes[0].moment[0] == pytest.approx(moment(2), rel=1e-2)
    assert result.probes[1].moment[1] == pytest.approx(moment(2.5), rel=1e-2)


def test_a_strip_with_a_rigid_middle_is_two_cantilevers():
    free, middle, force = 2.0, 1.0, 3e4
    length = 2 * free + middle
    model = Model(
        material={"E": E, "nu": 0.0},
        plate={"shape": "rectangle", "size": [length, 1.0], "thickness": H},
        mesh={"divisions": [20, 2]},
        support=[{"edge": ["left", "right"], "fix": "simple"}],
        zone=[{"area": {"rectangle": [free, 0, free + middle, 1]}, "rigid": True}],
        load=[{"line_load": force, "line": [[length / 2, 0], [length / 2, 1]]}],
        section=[{"line": [[x, 0], [x, 1]]} for x in (free, 1.1, free + middle)],
    )
    result = solve(model)["all"]
    bending, shear = E * H**3 / 12, 5 / 6 * E / 2 * H
    expected = force / 2 * (free**3 / (3 * bending) + free / shear)
    assert result.deflection.max() == pytest.approx(expected, rel=1e-3)
    moments = [section.moment for section in result.sections]
    assert moments == pytest.approx([force / 2 * free, force / 2 * 1.1, force / 2 * free], rel=1e-9)
    assert [abs(section.shear) for section in result.sections] == pytest.approx([force / 2] * 3, rel=1e-9)


def _on_soil(zone, method="auto"):
    return Model(
        material={"E": E, "nu": NU},
        plate={"shape": "rectangle", "size": [4, 3], "thickness": H},
        mesh={"divisions": [16, 12]},
        zone=[{"area": {"rectangle": [1, 1, 2, 2]}, **zone}],
        support=[
            {"name": "soil", "area": "all", "resists": "down", "stiffness": 2e7},
            {"name": "anchors", "at": [[0.5, 0.5], [0.5, 2.5]], "resists": "up", "stiffness": 1e7},
        ],
        load=[{"force": 2e5, "at": [1.5, 1.5]}, {"moment": [3e5, -1e5], "at": [1.5, 1.5]}, {"pressure": 1e3}],
        solver={"method": method},
    )


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_a_rigid_zone_is_the_limit_of_stiff_ones(method):
    rigid = solve(_on_soil({"rigid": True}, method))["all"]
    misses = []
    for factor in (1e2, 1e3, 1e4):
        stiff = solve(_on_soil({"modifiers": {"bending": factor, "twist": factor, "shear": factor}}))["all"]
        misses.append(np.abs(stiff.deflection - rigid.deflection).max() / np.abs(rigid.deflection).max())
    assert misses[0] < 2e-2
    assert misses[1] < 0.15 * misses[0]
    assert misses[2] < 0.15 * misses[1]


@settings(max_examples=15, deadline=None)
@given(st.randoms(use_true_random=False))
def test_condensed_bodies_are_constraint_rows_on_the_whole_plate(random):
    """K, G and loads of the plate without bodies, with rows that hold its nodes to one motion, solved densely."""
    x, y = random.randint(0, 4), random.randint(0, 2)
    box = [x, y, x + random.randint(1, 6 - x), y + random.randint(1, 3 - y)]
    edges = ["left", *random.sample(["right", "bottom", "top"], random.randint(0, 2))]
    fix = random.choice(["simple", "hard", "clamped"]) if len(edges) > 1 else "clamped"
    thickness = random.choice([0.02, 0.1, 0.8])
    parts = dict(
        material={"E": 1e9, "nu": 0.3},
        plate={"shape": "rectangle", "size": [6, 3], "thickness": thickness},
        mesh={"divisions": [6, 3]},
        support=[
            {"edge": edges, "fix": fix},
            {"at": [[random.uniform(0, 6), 0.4], [random.uniform(0, 6), 2.6]], "stiffness": 1e6 * thickness**3},
        ],
        load=[
            {"pressure": "1 + x*y"},
            {"force": 3.0, "at": [random.uniform(0, 6), random.uniform(0, 3)]},
            {"curvature": [1e-4, -2e-4, 1e-4]},
        ],
    )
    zone = {"area": {"rectangle": box}}
    whole = contact_problem(Model(**parts, zone=[{**zone, "extremes": False}]))
    rigid = contact_problem(Model(**parts, zone=[{**zone, "rigid": True}]))
    found, result = rigid.discretisation, rigid.solve(rigid.discretisation.load(_only(rigid)))
    followers = np.flatnonzero(np.repeat(found.held.bodies.leaders != np.arange(found.mesh.node_count), 3))
    rows = (np.eye(found.dof_count) - found.held.bodies.motion.toarray())[followers]
    held = np.eye(found.dof_count)[whole.held]
    constraints = np.vstack([rows, held])
    size = len(constraints)
    load = whole.discretisation.load(_only(whole)).nodal
    scale = np.abs(whole.K).max()
    matrix = np.block([[whole.K.toarray() / scale, constraints.T], [constraints, np.zeros((size, size))]])
    right = np.concatenate([load / scale, np.zeros(size)])
    expected = np.linalg.lstsq(matrix, right)[0][: found.dof_count]
    found_there = result.hi + result.lo
    assert np.abs(found_there - expected).max() <= 1e-6 * np.abs(expected).max()


def _only(problem):
    return problem.discretisation.model.effective_combinations[0]


def test_reactions_balance_what_acts_on_a_rigid_block_on_three_supports():
    model = Model(
        material={"E": E, "nu": NU},
        plate={"shape": "rectangle", "size": [4, 3], "thickness": H},
        mesh={"divisions": [4, 3]},
        zone=[{"area": {"rectangle": [0, 0, 4, 3]}, "rigid": True}],
        support=[
            {"name": n, "at": [at], "resists": "down"} for n, at in zip("abc", ([0, 0], [4, 0], [1, 3]), strict=True)
        ],
        load=[{"force": 1e5, "at": [2, 1]}],
    )
    result = solve(model)["all"]
    # b and c from moments about the axes through a, by hand.
    c = 1e5 / 3
    b = (2e5 - c) / 4
    assert result.reactions == pytest.approx({"a": 1e5 - b - c, "b": b, "c": c}, rel=1e-10)
    assert not np.any([result.fields[name] for name in ("mx", "my", "mxy", "qx", "qy")])
