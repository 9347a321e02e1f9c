"""Plates at the limits of the domain, each with a judge: a closed form, statics, or a second description.

Ribbons, steps of thickness and of pressure, forces near or on the edge of a bed, supports that coincide or hold the
plate from both sides, loads without resultant between stops, and stiffnesses from 1e-10 to 1e18 of the plate's.
All are inside the domain of validity (docs/domain.md).
A judge shares no code with the program: it knows the plate's exact answer, or compares two descriptions of one plate.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from random import Random
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.sparse import block_diag, csc_array, csr_array, diags_array, eye_array
from scipy.sparse.linalg import splu

from signorini import NoEquilibriumError, Result, contact_problem, solve, validate
from signorini.discretise import discretise

Tables = dict[str, Any]
Floats = npt.NDArray[np.float64]
Judge = Callable[[Result | None], list[str]]
"""Function that returns the errors of a result, which is None if the program found no equilibrium."""

_STRIP = 2e-2
"""Tolerance for a strip's deflection on at least four elements, relative."""
_CUT = 6e-2
"""Tolerance if a thickness step cuts an element: 3.8 % occurs for a step to a seventh near an end, on 11 elements."""
_PANEL = 4e-2
"""Tolerance for a slab with a thicker panel, compared with a mesh three times as fine."""
_SAME = 1e-6
"""Tolerance for two descriptions of one plate, relative to the load or the deflection."""
_RIGID, _SOFT = 1e8, 1e-6
"""Stiffness, relative to the plate's, of supports that are nearly rigid, and of supports on which the plate is."""
_LIMIT = 1e-3
"""Tolerance for results on such supports, compared with the rigid limit, relative to the deflection."""
_RANK = 1e-12
"""Relative tolerance for singular values of independent rows."""
_CORRECTIONS = 4
_STILL = 1e-6
"""Deflection that counts as zero, relative to F a²/D."""


@dataclass(frozen=True)
class Extreme:
    """A model as the tables of an input file, and the judge of its result."""

    kind: str
    tables: Tables
    judge: Judge
    may_be_refused: bool = False
    """Whether the program may refuse the model, since double precision may not suffice."""


def extreme(rng: Random) -> Extreme:
    """Draw a model with its judge."""
    return rng.choice(
        [
            *(ribbon, stepped_strip, stepped_panel, near_the_edge, on_the_edge),
            *(coincident, opposed, redundant, self_balanced, stiffness),
        ]
    )(rng)


def solved(tables: Tables) -> Result | None:
    """Solve a model with one combination; None if it has no equilibrium."""
    try:
        return solve(validate(tables))["all"]
    except NoEquilibriumError:
        return None


def ribbon(rng: Random) -> Extreme:
    """Draw a long thin strip on two edges under a pressure, ν = 0: a beam."""
    length = rng.choice([1.0, 1000.0, 0.02])
    width, thickness = length * 10 ** rng.uniform(-3, 0), length * 10 ** rng.uniform(-6, -2)
    young = rng.choice([1.0, 30e9])
    pressure = 1e-3 * young * (thickness / length) ** 3
    way = rng.choice([{"fix": "simple"}, {"resists": "down"}])
    tables = {
        "material": {"E": young, "nu": 0.0},
        "plate": {"shape": "rectangle", "size": [length, width], "thickness": thickness},
        "mesh": {"divisions": _divisions(rng, length / max(width, thickness))},
        "support": [{"edge": ["left", "right"], **way}],
        "load": [{"pressure": pressure}],
        "probe": [{"at": [length / 2, width / 2]}],
    }
    bending = 5 * pressure * length**4 / (384 * young * thickness**3 / 12)
    expected = bending + pressure * length**2 / 8 / (5 / 12 * young * thickness)
    return Extreme("ribbon", tables, lambda result: deflections(result, [expected], _STRIP), may_be_refused=True)


def _divisions(rng: Random, ratio: float) -> list[int]:
    """Numbers of elements of a ribbon, whose elements have an aspect ratio of at most 1000."""
    along, across = rng.randint(4, 12), rng.randint(1, 6)
    return [along, max(1, min(across, int(1000.0 * along / ratio)))]


def stepped_strip(rng: Random) -> Extreme:
    """Draw a strip of two thicknesses under a pressure on a part of it, ν = 0: a beam with a step."""
    length, young = rng.choice([10.0, 0.3]), 30e9
    divisions = rng.randint(10, 40)
    # The step and the end of the pressure are on a mesh line, or anywhere.
    step, stop = (
        rng.choice([rng.randint(1, divisions - 1) / divisions, rng.uniform(0.05, 0.95)]) * length for _ in "ab"
    )
    thin = length * 10 ** rng.uniform(-2.5, -1.5)
    thick = thin * rng.uniform(1.2, 13)
    if rng.random() < 0.5:
        thin, thick = thick, thin
    less = rng.choice(["<", "<="])
    saying = rng.choice(
        [f"where(x {less} {step!r}, {thin!r}, {thick!r})", f"{thick!r} + ({thin!r} - {thick!r})*(x {less} {step!r})"]
    )
    pressure = 1e-3 * young * (min(thin, thick) / length) ** 3
    loaded = rng.random() < 0.5
    at = [length * part for part in (0.25, 0.5, 0.8)]
    tables = {
        "material": {"E": young, "nu": 0.0},
        "plate": {"shape": "rectangle", "size": [length, length / 10], "thickness": saying},
        "mesh": {"divisions": [divisions, 1]},
        "support": [{"edge": ["left", "right"], "fix": "simple"}],
        "load": [{"pressure": f"where(x > {stop!r}, {pressure!r}, 0)" if loaded else pressure}],
        "probe": [{"at": [[x, length / 20] for x in at]}],
    }
    expected = _beam(length, (step, thin, thick), (stop if loaded else 0.0, pressure), young, at)
    cut = any(abs(x / length * divisions - round(x / length * divisions)) > 1e-9 for x in (step, stop))
    part = _CUT if cut else _STRIP
    return Extreme("stepped strip", tables, lambda result: deflections(result, expected, part))


def _beam(length: float, thickness: Any, load: Any, young: float, at: list[float]) -> list[float]:
    """Deflections at ``at`` of a stepped beam on two supports, under a pressure that begins at a given position."""
    step, left, right = thickness
    begin, pressure = load
    x = np.unique(np.concatenate([np.linspace(0, length, 20001), [step, begin]]))
    h = np.where(0.5 * (x[1:] + x[:-1]) < step, left, right)
    beyond = np.maximum(x - begin, 0.0)
    at_left = pressure * (length - begin) ** 2 / (2 * length)
    shear, moment = at_left - pressure * beyond, at_left * x - pressure * beyond**2 / 2
    curvature = 0.5 * (moment[1:] + moment[:-1]) / (young * h**3 / 12)
    strain = 0.5 * (shear[1:] + shear[:-1]) / (5 / 12 * young * h)
    width = np.diff(x)
    slope = np.append(0.0, np.cumsum(-curvature * width))
    w = np.append(0.0, np.cumsum((0.5 * (slope[1:] + slope[:-1]) + strain) * width))
    return [float(value) for value in np.interp(at, x, w - w[-1] * x / length)]


def stepped_panel(rng: Random) -> Extreme:
    """Draw a slab with another thickness inside an outline; the judge is a mesh three times as fine."""
    size = [10.0, rng.choice([10.0, 6.0])]
    (x, y), r = [rng.uniform(0.35, 0.65) * s for s in size], rng.uniform(0.15, 0.3) * size[1]
    within = rng.choice(
        [
            f"(abs(x - {x}) < {r}) and (abs(y - {y}) <= {r})",
            f"(x - {x})**2 + (y - {y})**2 < {r * r}",
            f"{rng.choice([0.3, 1, -2])}*(x - {x}) + (y - {y}) > 0",
        ]
    )
    thickness = rng.choice([0.3, 0.1])
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {
            "shape": "rectangle",
            "size": size,
            "thickness": f"where({within}, {thickness * rng.choice([0.5, 2.0])}, {thickness})",
        },
        "mesh": {"divisions": [rng.randint(9, 14), rng.randint(9, 14)]},
        "support": [{"edge": ["left", "right", "bottom", "top"], **rng.choice([{"fix": "hard"}, {"fix": "clamped"}])}],
        "load": [{"pressure": 1e3}],
        "probe": [{"at": [[s * t for s in size] for t in (0.3, 0.5, 0.6)]}],
    }

    def judge(result: Result | None) -> list[str]:
        fine = solved({**tables, "mesh": {"divisions": [3 * n for n in tables["mesh"]["divisions"]]}})
        assert fine is not None, "a plate held all around has an equilibrium"
        return deflections(result, [probe.deflection for probe in fine.probes], _PANEL)

    return Extreme("stepped panel", tables, judge)


def near_the_edge(rng: Random) -> Extreme:
    """Draw a bed under a part of a plate, and one force just inside or outside the bed's outline."""
    size = 10.0
    polygon = [[2.0, 2.0], [8.5, 3.0], [7.0, 8.0], [3.0, 7.0]]
    area, outline = rng.choice(
        [
            ("all", [[0.0, 0.0], [size, 0.0], [size, size], [0.0, size]]),
            ({"rectangle": [1.3, 2.0, 8.1, 9.0]}, [[1.3, 2.0], [8.1, 2.0], [8.1, 9.0], [1.3, 9.0]]),
            ({"polygon": polygon}, polygon),
        ]
    )
    corners = np.array(outline)
    ends = rng.choice(range(len(corners)))
    one, other = corners[ends], corners[(ends + 1) % len(corners)]
    inward = np.array([one[1] - other[1], other[0] - one[0]]) / math.dist(one, other)
    beside = one + rng.uniform(0.1, 0.9) * (other - one)
    # The force is outside the bed only if the plate extends there.
    distance = rng.choice([1.0, -1.0] if area != "all" else [1.0]) * 10 ** rng.uniform(-3, 0)
    at = (beside + distance * inward).tolist()
    held = distance > 0
    bed: Tables = {"name": "bed", "area": area, "resists": "down"}
    if rng.random() < 0.4:
        bed["stiffness"] = 10 ** rng.uniform(6, 16)
    divisions = rng.choice([4, 7, 10, 16])
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [size, size], "thickness": rng.choice([0.3, 1.0])},
        "mesh": {"divisions": [divisions, divisions]},
        "support": [bed],
        "load": [{"force": 1e5, "at": at}],
    }

    def judge(result: Result | None) -> list[str]:
        if (result is not None) != held:
            return [f"a force {distance:.3g} inside the outline is {'held' if result else 'said to tip the plate'}"]
        return [] if result is None else close("reaction of the bed", result.reactions["bed"], 1e5, _SAME * 1e5)

    return Extreme("near the edge", tables, judge)


def on_the_edge(rng: Random) -> Extreme:
    """Draw a load whose resultant lies on the edge of a rigid bed, beside springs that hardly hold the plate.

    The plate turns by an amount that rounding of the load decides; it must not depend on the unit of length.
    """
    thickness, divisions = 10 ** rng.uniform(-2, 0), [rng.choice([2, 4, 6]), rng.choice([3, 8, 12])]
    # On springs softer than this part of D/a⁴, rounding of the load would turn the plate.
    soft = 10 ** rng.uniform(-9, 0) * 3e10 * thickness**3 / 12 / 1e4
    bed_ends_at = rng.choice([5.0, 2.5])

    def in_units(of: float) -> Tables:
        bed: Tables = {"area": {"rectangle": [0, 0, bed_ends_at * of, 10 * of]}, "resists": "down"}
        return {
            "material": {"E": 3e10, "nu": 0.2},
            "plate": {"shape": "rectangle", "size": [10 * of, 10 * of], "thickness": thickness * of},
            "mesh": {"divisions": divisions},
            "support": [bed, {"area": "all", "resists": "up", "stiffness": soft / of}],
            "load": [{"pressure": 0.1, "area": {"rectangle": [0, 0, 2 * bed_ends_at * of, 10 * of]}}],
        }

    unit = rng.choice([2.5, 12.0, 37.3, 100.0])

    def judge(result: Result | None) -> list[str]:
        other = solved(in_units(unit))
        if result is None or other is None:
            return ["said to have no equilibrium"]
        # The springs carry 1e-11 of the load, which is rounding of the bed's reactions.
        if any("as good as none" in warning for warning in result.warnings):
            return []
        return deflections(result, (other.deflection / unit).tolist(), _LIMIT, at=result.deflection.tolist())

    return Extreme("on the edge", in_units(1.0), judge)


def coincident(rng: Random) -> Extreme:
    """Draw supports that coincide; the judge lists them in another order."""
    corners = [[1.0, 1.0], [9.0, 1.0], [9.0, 9.0], [1.0, 9.0]]
    middle = [rng.uniform(2, 8), rng.uniform(2, 8)]
    ways = [{"resists": "down"}, {"resists": "both"}, {"resists": "down", "gap": 1e-5}]
    supports = [{"name": "corners", "at": corners, "resists": "down"}]
    for i in range(rng.randint(1, 3)):
        place = rng.choice(
            [
                {"at": middle},
                {"at": corners[:2]},
                {"at": [corners[0], [9.0, 5.0]]},
                {"line": [[1.0, 1.0], [9.0, 1.0]]},
            ]
        )
        supports.append({"name": f"again {i}", **place, **rng.choice(ways)})
        if rng.random() < 0.5:
            supports.append({**supports[-1], "name": f"twice {i}"})
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10.0, 10.0], "thickness": 0.3},
        "mesh": {"divisions": [rng.randint(2, 8), rng.randint(2, 8)]},
        "support": supports,
        "load": [{"pressure": 2e3}, {"force": 1e5, "at": [rng.uniform(1, 9), rng.uniform(1, 9)]}],
    }
    return Extreme("coincident", tables, lambda result: _order(result, tables, rng, 3e5))


def opposed(rng: Random) -> Extreme:
    """Draw a plate on two-sided supports at crowded points, or on pairs of supports there from below and above.

    The judge solves with the points' rows as equations or, for a circle, lists the supports in another order.
    """
    at, apart = [rng.uniform(1, 9), rng.uniform(0.3, 1.0)], rng.choice([0.02, 0.05, 0.1, 0.2])
    thickness, crowd = rng.choice([0.03, 0.1]), list[list[float]]()
    for _ in range(rng.choice([4, 9, 12])):
        # Points may be as close to each other as the domain allows.
        to = [x + rng.uniform(-apart, apart) for x in at]
        if all(math.dist(to, other) > 0.1 * thickness for other in crowd):
            crowd.append(to)
    crowd.append([crowd[0][0] + 0.1 * thickness + 1e-12, crowd[0][1]])
    crowd = [to for i, to in enumerate(crowd) if i in (0, len(crowd) - 1) or math.dist(to, crowd[-1]) > 0.1 * thickness]
    place = rng.choice([{"at": crowd}, {"circle": {"center": at, "radius": apart}}])
    tables = {
        "material": {"E": 1e3, "nu": 0.2},
        "plate": {
            "shape": "rectangle",
            "size": [10.0, 1.3],
            "thickness": thickness,
            "element": rng.choice(["mitc9", "q8r"]),
        },
        "mesh": {"divisions": [rng.choice([4, 12, 30]), rng.choice([4, 8])]},
        "support": [{"name": "floor", **place, "resists": "down"}, {"name": "hold-down", **place, "resists": "up"}],
        "load": [{"force": 1e-7, "at": [rng.uniform(0, 10), 0.65]}],
    }

    both = [{"name": "bearing", **place, "resists": "both"}]
    if "at" in place and rng.random() < 0.3:
        tables["support"] = both

    def judge(result: Result | None) -> list[str]:
        if "at" in place:
            expected: Floats | None = held_at_points({**tables, "support": both})
        else:
            other = solved({**tables, "support": tables["support"][::-1]})
            expected = None if other is None else other.deflection
        if result is None or expected is None:
            return ["a plate held both ways has an equilibrium"]
        # If the points hold the plate at the load, its deflection is zero.
        least = _STILL * 1e-7 * 10.0**2 / (1e3 * tables["plate"]["thickness"] ** 3 / 12)
        return deflections(result, expected.tolist(), _SAME, least, at=result.deflection.tolist())

    # In an element much larger than a circle, the circle is represented by two points.
    return Extreme("opposed", tables, judge, may_be_refused="circle" in place)


def held_at_points(tables: Tables) -> Floats:
    """Deflections of the nodes of a plate on two-sided supports with nearly dependent rows.

    The equations in an orthogonal basis of the rows' null space are well conditioned.
    """
    found = discretise(validate(tables))
    rows, stiffness = found.point_rows.toarray(), csr_array(contact_problem(found).K)
    load = found.load(found.model.effective_combinations[0]).nodal
    touched = rows.any(axis=0)
    _, values, basis = np.linalg.svd(rows[:, touched])
    free = basis[int((values > _RANK * values[0]).sum()) :].T
    order = np.argsort(np.concatenate([np.flatnonzero(touched), np.flatnonzero(~touched)]))
    motions = csr_array(block_diag([free, eye_array(int((~touched).sum()))], format="csr")[order])
    reduced = motions.T @ stiffness @ motions
    scale = diags_array(1.0 / np.sqrt(reduced.diagonal()))
    factor = splu(csc_array(scale @ reduced @ scale))
    accurate, moved = stiffness.astype(np.longdouble), np.zeros(len(load))
    for _ in range(_CORRECTIONS):
        left = (load - accurate @ moved).astype(np.float64)
        moved += motions @ (scale @ factor.solve(scale @ (motions.T @ left)))
    return np.asarray(moved[::3])


def redundant(rng: Random) -> Extreme:
    """Draw more rigid points and lines than a coarse mesh can distinguish, beside a held edge."""
    wall = {
        "name": "wall",
        "edge": rng.choice(["bottom", ["bottom", "left"]]),
        "fix": rng.choice(["simple", "clamped"]),
    }
    across = rng.uniform(1.0, 9.0)
    supports: list[Tables] = [wall]
    for number in range(rng.randint(1, 3)):
        heights = [0.05 * number for number in sorted(rng.sample(range(101), rng.randint(2, 5)))]
        place: Tables = rng.choice(
            [
                {"at": [[across, y] for y in heights]},
                {"at": [[rng.uniform(0.5, 9.5), y] for y in heights]},
                {"line": [[across, heights[0]], [rng.uniform(0.5, 9.5), heights[-1]]]},
            ]
        )
        supports.append({"name": f"piers {number}", **place, "resists": rng.choice(["both", "both", "down"])})
    force, pressure = rng.choice([0.0, 1e4]), 1e3
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10.0, 10.0], "thickness": 0.3},
        "mesh": {"divisions": [rng.randint(1, 5), rng.randint(1, 5)]},
        "support": rng.sample(supports, len(supports)),
        "load": [{"pressure": pressure}, {"force": force, "at": [rng.uniform(1, 9), rng.uniform(1, 9)]}],
    }

    def judge(result: Result | None) -> list[str]:
        if result is None:
            return []
        load = 100 * pressure + force
        size = load + sum(float(np.abs(support.reactions).sum()) for support in result.supports)
        return close("sum of reactions", sum(result.reactions.values()), load, _SAME * size)

    return Extreme("redundant", tables, judge, may_be_refused=True)


def self_balanced(rng: Random) -> Extreme:
    """Draw a load without resultant on a plate between stops, which may rest anywhere between them."""
    stops = [{"name": "floor", "at": [[1, 1], [9, 1], [9, 9], [1, 9]], "resists": "down", "gap": rng.choice([0, 0.5])}]
    stops.append({"name": "ceiling", "at": [[5, 5], [1, 5]], "resists": "up", "gap": rng.choice([0.2, 0.5])})
    if rng.random() < 0.3:
        stops.append({"name": "pin", "at": [5, 5], "fix": "simple"})
    size = rng.choice([1e3, 1e5])
    tables = {
        "material": {"E": 30e9, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10.0, 10.0], "thickness": 0.3},
        "mesh": {"divisions": [rng.randint(2, 6), rng.randint(2, 6)]},
        "support": stops,
        "load": [
            {"force": size, "at": [2, 5]},
            {"force": -2 * size, "at": [5, 5]},
            {"force": size, "at": [8, 5]},
        ],
    }
    return Extreme("self-balanced", tables, lambda result: _order(result, tables, rng, size))


def stiffness(rng: Random) -> Extreme:
    """Draw supports far softer or far stiffer than the plate; the judge is the rigid support, or the rigid plate."""
    size, thickness, young = 10.0, rng.choice([0.3, 0.03]), 30e9
    own = young * thickness**3 / 12 / size**2
    ratio = 10 ** rng.uniform(-10.5, 18)
    place, share = rng.choice(
        [
            ({"at": [[1, 1], [9, 1], [9, 9], [1, 9]]}, 4.0),
            ({"edge": ["left", "right"]}, 2 * size),
            ({"area": "all"}, size**2),
        ]
    )
    # A two-sided rigid bed holds only the mean deflection of each element.
    one_way = "area" in place and ratio > _SOFT
    support = {"name": "bed", **place, "resists": rng.choice(["down"] if one_way else ["down", "down", "both"])}
    pressure = 1e-2 * own / size
    tables = {
        "material": {"E": young, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [size, size], "thickness": thickness},
        "mesh": {"divisions": [rng.randint(4, 12)] * 2},
        "support": [{**support, "stiffness": ratio * own * 4.0 / share}],
        "load": [{"pressure": pressure}, {"force": 20 * pressure, "at": [rng.uniform(3, 7), rng.uniform(3, 7)]}],
        "probe": [{"at": [[5, 5], [2, 3]]}],
    }

    def judge(result: Result | None) -> list[str]:
        load = 120 * pressure
        wrong = [] if result is None else close("reaction", result.reactions["bed"], load, _SAME * load)
        if ratio > _RIGID:
            rigid = solved({**tables, "support": [support]})
            assert rigid is not None, "the force is amid the supports"
            return wrong + deflections(result, [probe.deflection for probe in rigid.probes], _LIMIT, load / own / 100)
        if ratio < _SOFT and result is not None:
            mean = 0.25 * sum(p.deflection for p in result.probe([(0, 0), (size, 0), (size, size), (0, size)]))
            sunk = load / (4.0 * ratio * own)
            # The load is not exactly central. The mean of the corners is the deflection of a rigid plate's middle.
            return wrong + close("deflection", mean, sunk, _LIMIT * sunk)
        return wrong if result is not None else ["no equilibrium for a force amid the supports"]

    return Extreme("stiffness", tables, judge)


def _order(result: Result | None, tables: Tables, rng: Random, load: float) -> list[str]:
    """Compare with the same supports in another order, and perhaps by another method."""
    shuffled = rng.sample(tables["support"], len(tables["support"]))
    other = solved({**tables, "support": shuffled, "solver": {"method": rng.choice(["auto", "lemke", "active_set"])}})
    if result is None or other is None:
        return [] if result is other else ["an equilibrium in one order of the supports, none in another"]
    wrong = deflections(result, other.deflection.tolist(), _SAME, at=result.deflection.tolist())
    for name, reaction in result.reactions.items():
        wrong += close(f"reaction of {name}", reaction, other.reactions[name], _SAME * load)
    return wrong


def deflections(
    result: Result | None, expected: list[float], part: float, least: float = 0.0, at: list[float] | None = None
) -> list[str]:
    """Compare deflections at the probes, or ``at``, with expected ones; ``part`` is the tolerance relative to the
    largest.
    """
    if result is None:
        return ["said to have no equilibrium"]
    found = [probe.deflection for probe in result.probes] if at is None else at
    size = max(*(abs(value) for value in [*expected, 0.0]), least)
    apart = max(abs(a - b) for a, b in zip(found, expected, strict=True))
    if apart <= part * size:
        return []
    worst = max(range(len(found)), key=lambda i: abs(found[i] - expected[i]))
    return [f"deflection {found[worst]:.6g} where {expected[worst]:.6g} is right"]


def close(what: str, found: float, expected: float, within: float) -> list[str]:
    return [] if abs(found - expected) <= within else [f"{what} {found:.6g} where {expected:.6g} is right"]
