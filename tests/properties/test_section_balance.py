"""Sections balance the loads and reactions on either side, on any mesh and at any place."""

import math
from itertools import pairwise

import numpy as np
import pytest

from signorini import Model, solve
from signorini.analysis.single import solve_one
from signorini.contact.problem import contact_problem
from signorini.discretise import discretise
from signorini.shapes import Polygon
from signorini.shapes.regions import meeting

RECTANGLE = [(0.0, 0.0), (8.0, 0.0), (8.0, 6.0), (0.0, 6.0)]
POLYGON = [(0.0, 0.0), (8.0, 0.0), (9.0, 4.0), (5.0, 6.5), (0.0, 6.0)]


def on_left(corners, a, b):
    """Area of the part of a convex polygon on the left of the line from a to b, and its first moment about the line."""
    right = np.array([b[1] - a[1], a[0] - b[0]]) / math.dist(a, b)
    points, kept = [np.array(p) for p in (*corners, corners[0])], []
    for p, q in pairwise(points):
        off, then = right @ (p - a), right @ (q - a)
        kept += [p] if off <= 0 else []
        kept += [p + (q - p) * off / (off - then)] if off * then < 0 else []
    if len(kept) < 3:
        return 0.0, 0.0
    p = np.array(kept)
    q = np.roll(p, -1, axis=0)
    twice = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    return twice.sum() / 2, right @ (((p + q) * twice[:, None]).sum(axis=0) / 6 - a * twice.sum() / 2)


def box(middle, a, b):
    return [(middle[0] + i * a / 2, middle[1] + j * b / 2) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def by_statics(on, forces, couples, a, b):
    """Moment and shear through a line from a to b: reactions less loads on its left, and their moment about it."""
    right = np.array([b[1] - a[1], a[0] - b[0]]) / math.dist(a, b)
    shear = moment = 0.0
    for pressure, corners in on:
        area, first = on_left(corners, a, b)
        shear, moment = shear - pressure * area, moment + pressure * first
    for force, at in forces:
        off = right @ (np.array(at) - a)
        shear, moment = shear - force * (off < 0), moment + force * min(off, 0.0)
    return moment + sum(right @ couple for couple, at in couples if right @ (np.array(at) - a) < 0), shear


def solved(model, mesh=None):
    if mesh is None:
        return solve(model)["all"]
    (combination,) = model.effective_combinations
    return solve_one(contact_problem(discretise(model, mesh)), combination, lambda now: None)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("plate", ["rows", "followed", "across elements"])
def test_statics_give_the_moment_and_the_shear(plate, seed):
    """Random loads and one-sided supports; meshes of polygons follow the line if they know it."""
    random = np.random.default_rng(seed)
    corners = RECTANGLE if plate == "rows" else POLYGON
    shape = {"shape": "rectangle", "size": [8, 6]} if plate == "rows" else {"shape": "polygon", "points": corners}
    pushed, printed, spot = random.uniform([1.5, 1.5], [6.5, 4.5], (3, 2)).tolist()
    wide, high, long, across = random.uniform(0.2, 2.0, 4).tolist()
    q, p, f, g = (random.uniform(1e3, 3e3, 4) * [1, 2, 5, 3]).tolist()
    sides = random.choice(len(corners), 2, replace=False)
    shares = random.uniform(0.05, 0.95, 2)
    a, b = (
        np.array(corners[k]) + t * (np.array(corners[(k + 1) % len(corners)]) - corners[k])
        for k, t in zip(sides, shares, strict=True)
    )
    tables = dict(
        material={"E": 30e9, "nu": 0.2},
        plate=shape | {"thickness": 0.25},
        mesh={"size": 0.8},
        support=[
            {"at": random.uniform([0.3, 0.3], [7.0, 4.9], (6, 2)).tolist(), "resists": "down", "stiffness": 5e7},
            {"at": [[0.3, 0.3], [7.5, 0.3], [0.3, 5.4], [7.4, 4.9]]},
        ],
        load=[
            {"pressure": q},
            {"pressure": p, "area": {"polygon": box(pushed, wide, high)}},
            {"force": f, "at": printed, "patch": [long, across]},
            {"force": g, "at": spot},
            {"moment": [300, 500], "at": [2.2, 2.3]},
        ],
    )
    mesh = discretise(Model(**tables)).mesh if plate == "across elements" else None
    lines = [{"line": [a.tolist(), b.tolist()]}, {"line": [b.tolist(), a.tolist()]}]
    result = solved(Model(**tables, section=lines), mesh)
    on = [(q, corners), (p, box(pushed, wide, high)), (f / (long * across), box(printed, long, across))]
    forces = [(g, spot), *((-r, at) for s in result.supports for at, r in zip(s.positions, s.reactions, strict=True))]
    moment, shear = by_statics(on, forces, [((300, 500), (2.2, 2.3))], a, b)
    there, back = result.sections
    assert there.shear == pytest.approx(shear, abs=1e-12 * q * 48.0)
    assert there.moment == pytest.approx(moment, abs=1e-12 * q * 48.0 * 8.0)
    assert (back.moment, back.shear) == pytest.approx((there.moment, -there.shear), abs=1e-11 * q * 48.0 * 8.0)


@pytest.mark.parametrize("seed", range(4))
def test_a_line_load_is_divided_where_a_line_crosses_it(seed):
    """Inside elements, at any angle; where it varies too."""
    random = np.random.default_rng(seed)
    (x0, y0), (x1, y1) = random.uniform([0.5, 1.0], [1.5, 5.0]), random.uniform([6.5, 1.0], [7.5, 5.0])
    a, b = (float(random.uniform(3.0, 5.0)), 0.0), (float(random.uniform(3.0, 5.0)), 6.0)
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [8, 6], "thickness": 0.25},
        mesh={"size": 1.0, "error": False},
        support=[{"edge": "left", "fix": "clamped"}],
        load=[{"line_load": "1e3 * (1 + x)", "line": [[x0, y0], [x1, y1]]}],
        section=[{"line": [a, b]}, {"line": [b, a]}],
    )
    mesh = discretise(model.model_copy(update={"section": ()})).mesh
    there, back = solved(model, mesh).sections
    node, weight = np.polynomial.legendre.leggauss(3)
    right = np.array([b[1], a[0] - b[0]]) / math.hypot(b[1], a[0] - b[0])
    off = [right @ (np.array(at) - a) for at in ((x0, y0), (x1, y1))]
    begin = -off[0] / (off[1] - off[0])
    t = begin + (1 - begin) * (node + 1) / 2
    force = math.dist((x0, y0), (x1, y1)) * (1 - begin) / 2 * weight * 1e3 * (1 + x0 + t * (x1 - x0))
    assert -back.shear == pytest.approx(there.shear, rel=1e-10)
    assert there.shear == pytest.approx(force.sum(), rel=1e-10)
    assert there.moment == pytest.approx(-force @ (off[0] + t * (off[1] - off[0])), rel=1e-10)


@pytest.mark.parametrize("angle", [15, 18, 24, 30])
def test_a_line_may_end_in_a_node_of_a_round_edge(angle):
    """Whose coordinates are rounded; of sines and cosines too, and those of an end that is short of it."""
    x, y = 6 * math.cos(math.radians(angle)), 6 * math.sin(math.radians(angle))
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "disc", "radius": 6, "sector": 90, "thickness": 0.2},
        mesh={"size": 0.4, "error": False},
        support=[{"at": [[1, 1], [4, 1], [1, 4.2]], "patch": [0.2, 0.2]}],
        load=[{"force": 100.0, "at": [2, 2], "patch": [0.2, 0.2]}],
        section=[
            *({"line": [[0, round(y, digits)], [round(x, digits), round(y, digits)]]} for digits in (16, 9)),
            *({"line": [[0, y], [x - short, y]]} for short in (2e-8, 1e-6)),
        ],
    )
    result = solved(model)
    first, _, last = result.supports[0].reactions
    for section in result.sections:
        forces = [(100.0, (2, 2)), (-first, (1, 1)), (-result.supports[0].reactions[1], (4, 1)), (-last, (1, 4.2))]
        moment, shear = by_statics([], forces, [], (0, y), (x, y))
        assert section.shear == pytest.approx(shear, abs=1e-7)
        assert section.moment == pytest.approx(moment, abs=1e-6)


@pytest.mark.parametrize("divisions", [[32, 8], [8, 8], [6, 16]])
@pytest.mark.parametrize("seed", range(3))
def test_lines_across_thin_curved_elements_are_in_balance(divisions, seed):
    """Parts that end inside the plate add up to the whole; some lines only just cross or touch a ring of sides."""
    random = np.random.default_rng(seed)
    radii = np.linspace(0.6, 3.0, divisions[0] + 1)[1:-1]
    just = random.choice(radii, 4) * (1 - random.choice([0.0, 1e-9, 1e-6, 1e-3], 4))
    lines = []
    for off in (*just, *random.uniform(0.7, 2.6, 2)):
        angle = random.choice([random.uniform(0, math.tau), random.integers(16) * math.pi / 8])
        normal = np.array([math.cos(angle), math.sin(angle)])
        half, part = math.sqrt(9 - off**2) * np.array([normal[1], -normal[0]]), random.uniform(-0.9, 0.9)
        a, b, inside = (off * normal + t * half for t in (-1.0, 1.0, part))
        lines += [[a, b], [a, inside], [inside, b]]
    spots = [(0.8 * math.cos(t), 0.8 * math.sin(t)) for t in (0.3, 2.2, 4.1, 5.5)]
    loads = [(1e4, (-2.2, 0.1)), (2e4, (1.9, 1.2)), (3e4, (0.3, -2.3))]
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "annulus", "inner": 0.6, "outer": 3, "thickness": 0.2},
        mesh={"divisions": divisions, "error": False},
        support=[{"at": spots}],
        load=[{"force": force, "at": at} for force, at in loads],
        section=[{"line": [begin.tolist(), end.tolist()]} for begin, end in lines],
    )
    result = solved(model)
    (support,) = result.supports
    forces = [*loads, *((-r, at) for at, r in zip(support.positions, support.reactions, strict=True))]
    for (a, b), *found in zip(lines[::3], *(result.sections[k::3] for k in range(3)), strict=True):
        whole, *parts = found
        moment, shear = by_statics([], forces, [], a, b)
        assert (whole.moment, whole.shear) == pytest.approx((moment, shear), abs=1e-11 * 1e5)
        assert sum(part.moment for part in parts) == pytest.approx(moment, abs=1e-11 * 1e5)
        assert sum(part.shear for part in parts) == pytest.approx(shear, abs=1e-11 * 1e5)
        assert whole.length == pytest.approx(math.dist(a, b), rel=5e-3)
        assert sum(part.length for part in parts) == pytest.approx(whole.length, rel=1e-6)


def turned(points, angle, about=(4.0, 3.0)):
    c, s = math.cos(angle), math.sin(angle)
    return [tuple(p) for p in (np.array(points) - about) @ np.array([[c, s], [-s, c]]) + about]


def of_part(corners, forces, pressure, a, b):
    """Moment and shear through the line from a to b, on whose left there is a polygon, with forces (force, at)."""
    right = np.array([b[1] - a[1], a[0] - b[0]]) / math.dist(a, b)
    p = np.array(corners) - a
    q = np.roll(p, -1, axis=0)
    twice = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    inside = Polygon(tuple(dict.fromkeys(map(tuple, corners)))).contains(np.array([at for _, at in forces]))
    on = [(force, right @ (np.array(at) - a)) for (force, at), there in zip(forces, inside, strict=True) if there]
    first = right @ ((p + q) * twice[:, None]).sum(axis=0) / 6
    return sum(f * off for f, off in on) + pressure * first, -sum(f for f, _ in on) - pressure * twice.sum() / 2


def loaded(corners, spots, lines, pressure, holes=()):
    """Solve a plate on points under pressure and a force, on a mesh that follows the lines and on one that does not."""
    tables = dict(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "polygon", "points": corners, "holes": holes, "thickness": 0.25},
        mesh={"size": 0.9, "error": False},
        support=[{"at": spots[:4], "stiffness": 5e7}],
        load=[{"pressure": pressure}, {"force": 5e4, "at": spots[4]}],
    )
    model = Model(**tables, section=[{"line": line} for line in lines])
    for mesh in (None, discretise(Model(**tables)).mesh):
        result = solved(model, mesh)
        (support,) = result.supports
        reactions = zip(support.positions, support.reactions, strict=True)
        yield result.sections, [(5e4, spots[4]), *((-r, at) for at, r in reactions)]


@pytest.mark.parametrize("seed", range(12))
def test_a_line_that_ends_in_a_reentrant_corner_is_in_balance(seed):
    """Any angle, from any side, with plate, an edge or a void past its end; in both directions."""
    random = np.random.default_rng(seed)
    (d, e), turn = random.choice([0.0, 1.0], 2) * random.uniform(-1.5, 1.5, 2), random.choice([0.0, 1.0, 2.0])
    drawn = [(0.0, 0.0), (9.0, 0.0), (9.0, 4.0 + d), (5.0, 4.0), (5.0 + e, 9.0), (0.0, 9.0)]
    corners = turned(drawn, turn)
    spots = turned([(0.4, 0.3), (8.3, 0.6), (0.7, 8.4), (4.1, 3.3), (7.4, 1.9)], turn)
    begin = [(k, random.uniform(0.03, 0.97)) for k in (0, 0, 1, 4, 5, 5)] + [(0, 5 / 9), (5, 5 / 9), (0, 0.0)]
    ends = [np.array(corners[k]) * (1 - t) + t * np.array(corners[(k + 1) % 6]) for k, t in begin]
    # Within a millionth of the plate's size of the corner.
    beside = (np.array(corners[3]) + random.choice([0.0, 1.0]) * 10 ** random.uniform(-12, -5.5, 2)).tolist()
    lines = [way for a in ends for way in ([a.tolist(), beside], [beside, a.tolist()])]
    for sections, forces in loaded(corners, spots, lines, 2e3):
        for (k, _), a, there, back in zip(begin, ends, sections[::2], sections[1::2], strict=True):
            on_left = [corners[3], *[corners[i % 6] for i in range(4, (k if k > 3 else k + 6) + 1)], tuple(a)]
            moment, shear = of_part(on_left, forces, 2e3, a, corners[3])
            assert there.shear == pytest.approx(shear, abs=1e-10 * 1.8e5)
            assert there.moment == pytest.approx(moment, abs=1e-10 * 1.8e5 * 9)
            assert (back.moment, back.shear) == pytest.approx((there.moment, -there.shear), abs=1e-11 * 1.8e5 * 9)


def ray(at, towards):
    """Where a line from a place in the rectangle that way ends on its edge."""
    past = [((8.0, 6.0)[i] if towards[i] > 0 else 0.0) - at[i] for i in (0, 1)]
    axis = int(past[1] / towards[1] < past[0] / towards[0])
    end = np.array(at) + past[axis] / towards[axis] * np.array(towards)
    return tuple(np.where(np.arange(2) == axis, np.round(end), end).tolist())


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("hole", ["corners", "round"])
def test_two_lines_that_end_on_a_hole_are_in_balance_together(hole, seed):
    """In a corner, or anywhere on a circle, at angles with plate, an edge or a void past the end."""
    random = np.random.default_rng(seed)
    # Corners counter-clockwise, at angles from the middle.
    around = math.tau * (np.arange(4) / 4 + random.uniform(-0.1, 0.1, 4) * (seed % 3 > 0) + 0.125)
    at = np.column_stack([np.cos(around), np.sin(around)]) * math.sqrt(2 if hole == "corners" else 1) + [4, 3]
    shape = {"polygon": at.tolist()} if hole == "corners" else {"circle": {"center": [4, 3], "radius": 1}}
    widest = math.radians(125 if hole == "corners" else 85)
    while True:
        first, last = random.choice(4, 2, replace=False).tolist()
        angles = around[[first, last]] + random.choice([random.uniform(-widest, widest, 2), np.radians([45.0, -45.0])])
        a, b = (ray(at[k], (math.cos(t), math.sin(t))) for k, t in zip((first, last), angles, strict=True))
        if meeting(np.array([[a, at[first]], [at[last], b]]), closed=False) is None:
            break
    # With the hole on its right the path from one place to the other goes clockwise around it, the plate's edge back.
    beside = [at[(first - k) % 4] for k in range((first - last) % 4 + 1)]
    turn = [math.atan2(y - 3, x - 4) for x, y in RECTANGLE]
    begin, end = (math.atan2(y - 3, x - 4) for x, y in (b, a))
    corners = [c for t, c in zip(turn, RECTANGLE, strict=True) if (t - begin) % math.tau < (end - begin) % math.tau]
    corners.sort(key=lambda c: (math.atan2(c[1] - 3, c[0] - 4) - begin) % math.tau)
    on_left = [a, *map(tuple, beside), b, *corners]
    spots = [(0.4, 0.3), (7.3, 0.6), (0.7, 5.4), (7.1, 4.9), (6.4, 1.9)]
    pressure = 2e3 if hole == "corners" else 0.0
    lines = [[a, at[first].tolist()], [at[last].tolist(), b]]
    lines += [line[::-1] for line in lines]
    for (one, other, *back), forces in loaded(RECTANGLE, spots, lines, pressure, [shape]):
        _, shear = of_part(on_left, forces, pressure, a, b)
        assert one.shear + other.shear == pytest.approx(shear, abs=1e-12 * 1.5e5)
        assert [-part.shear for part in back] == pytest.approx([one.shear, other.shear], abs=1e-11 * 1.5e5)
