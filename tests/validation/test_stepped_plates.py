"""Plates whose thickness, loads and beds jump: the mesh follows the step, or the element that it cuts is a laminate."""

from itertools import pairwise

import numpy as np
import pytest
from pytest import approx

from signorini import InputError, Model, solve
from signorini.discretise import discretise

E = 1e6
FOLLOWED = [
    "where(x < 5, 0.1, {0})",
    "where(x <= 5, 0.1, {0})",
    "where(x > 5, {0}, 0.1)",
    "where(x >= 5, {0}, 0.1)",
    "(x < 5)*0.1 + (x >= 5)*{0}",
    "where(abs(x - 15) > 10, 0.1, {0})",
    "where(floor(x/5) == 0, 0.1, {0})",
    "where((x - 5)*(x + 1) < 0, 0.1, {0})",
]


def cantilever(thickness, elements, element="mitc9", **more):
    """Deflection of the tip of a strip 10 by 1, clamped at the left, under a line load of 1 at its right end."""
    model = Model(
        material={"E": E, "nu": 0},
        plate={"shape": "rectangle", "size": [10, 1], "thickness": thickness, "element": element},
        mesh={"divisions": [elements, 1]},
        support=[{"edge": ["left"], "fix": "clamped"}],
        load=[{"line_load": 1.0, "edge": ["right"]}],
        probe=[{"at": [10, 0.5]}],
        **more,
    )
    return solve(model)["all"].probes[0].deflection


def beam(thickness, *joints):
    """The same by Timoshenko's beam: the integral of M²/EI + Q²/κGA over the pieces between joints."""
    node, weight = np.polynomial.legendre.leggauss(60)
    ends, total = np.array([0.0, *joints, 10.0]), 0.0
    for a, b in pairwise(ends):
        x = 0.5 * (a + b) + 0.5 * (b - a) * node
        h = thickness(x) * np.ones_like(x)
        total += 0.5 * (b - a) * weight @ ((10 - x) ** 2 * 12 / (E * h**3) + 2 / (5 / 6 * E * h))
    return total


@pytest.mark.parametrize("element", ["mitc9", "q8r"])
@pytest.mark.parametrize("thick", [1.0, 1.3])
@pytest.mark.parametrize("formula", FOLLOWED)
def test_a_step_of_a_strip_is_followed_however_it_is_written(formula, thick, element):
    exact = beam(lambda x: np.where(x < 5, 0.1, thick), 5.0)
    found = [cantilever(formula.format(thick), n, element) for n in (7, 10, 20)]
    assert found == approx([exact] * 3, rel=1e-6)


@pytest.mark.parametrize("element", ["mitc9", "q8r"])
@pytest.mark.parametrize("at", [4.7, 5.0, 5.13])
def test_a_step_that_cuts_elements_costs_little(at, element):
    exact = beam(lambda x: np.where(x < at, 0.1, 1.0), at)
    formulas = [f"where(exp(x) {sign} exp({at}), 0.1, 1)" for sign in ("<", "<=")]
    below, up_to = ([cantilever(formula, n, element) for n in (13, 40)] for formula in formulas)
    assert below == approx(up_to, rel=1e-9)
    assert below == approx([exact] * 2, rel=0.02)


def test_a_taper_converges_fast():
    exact = beam(lambda x: 1 / (1.0 + 0.2 * x))
    errors = [abs(cantilever("1/(1 + 0.2*x)", n) / exact - 1) for n in (4, 8, 16)]
    assert errors[0] < 1e-3 and errors[1] < errors[0] / 12 and errors[2] < errors[1] / 12


def slab(thickness, n, turn=0.0, element="mitc9"):
    """Deflections in the middle and at the quarter of a square slab on four sides with a thicker middle."""
    c, s = np.cos(turn), np.sin(turn)
    names = {"u": f"({c}*(x - 5) + {s}*(y - 5))", "v": f"({c}*(y - 5) - {s}*(x - 5))"}
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [10, 10], "thickness": thickness.format(**names), "element": element},
        mesh={"divisions": [n, n]},
        support=[{"edge": ["left", "right", "bottom", "top"], "fix": "simple"}],
        load=[{"pressure": 1e4}],
        probe=[{"at": [[5, 5], [2.5, 2.5]]}],
    )
    return [probe.deflection for probe in solve(model)["all"].probes]


@pytest.mark.parametrize(
    ("thickness", "turn"),
    [
        ("where((abs({u}) < 1.7)*(abs({v}) < 1.7), 0.6, 0.3)", 0.0),
        ("where((abs({u}) < 1.7)*(abs({v}) < 1.7), 0.6, 0.3)", 0.3),
        ("where({u}**2 + {v}**2 < 4, 0.6, 0.3)", 0.0),
    ],
    ids=["drop panel", "turned drop panel", "thick disc"],
)
def test_a_thick_middle_of_a_slab_on_a_coarse_mesh(thickness, turn):
    fine = slab(thickness, 52, turn)
    assert slab(thickness, 13, turn) == approx(fine, rel=0.012)
    assert slab(thickness, 13, turn, "q8r") == approx(fine, rel=0.012)


@pytest.mark.parametrize("element", ["mitc9", "q8r"])
@pytest.mark.parametrize(
    "thickness", ["where(x + 0.37*y < 2.1, 0.2, 0.4)", "where((x-2)**2 + (y-1)**2 < 0.5, 0.4, 0.2)"]
)
def test_a_free_plate_bends_to_its_stress_free_curvature_across_steps(thickness, element):
    model = Model(
        material={"E": 1e6, "nu": 0.3},
        plate={"shape": "rectangle", "size": [4, 2], "thickness": thickness, "element": element},
        mesh={"divisions": [5, 3]},
        support=[{"at": [[0, 0], [4, 0], [0, 2]], "fix": "simple"}],
        load=[{"curvature": [1e-3, -2e-3, 5e-4]}],
    )
    result = solve(model)["all"]
    x, y = result.mesh.points.T
    bent = 0.5 * (1e-3 * x**2 - 2e-3 * y**2) + 5e-4 * x * y
    plane = np.linalg.solve([[1, 0, 0], [1, 4, 0], [1, 0, 2]], -np.array([0, 8e-3, -4e-3]))
    assert result.deflection == approx(bent + plane @ [np.ones_like(x), x, y], abs=1e-12)
    assert np.abs(result.moment).max() < 1e-9


RECTANGLE = {"shape": "rectangle", "size": [10, 7], "thickness": 0.2}
DISC = {"shape": "disc", "radius": 3, "thickness": 0.2}
SKEW = 6.1 * 7 - 0.37 * 49 / 2


def total(plate, load, divisions, **material):
    edge = "rim" if plate["shape"] == "disc" else "left"
    model = Model(
        material={"E": 1e9, "nu": 0.2, **material},
        plate=plate,
        mesh={"divisions": divisions},
        support=[{"edge": edge, "fix": "clamped"}],
        load=[load],
    )
    return discretise(model).cases["load"].nodal[::3].sum()


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        ({"pressure": "where(x < 3.3, 5, 0)"}, 5 * 3.3 * 7),
        ({"pressure": "where(x + 0.37*y < 6.1, 5, 0)"}, 5 * SKEW),
        ({"pressure": "floor(x)"}, 45 * 7),
        ({"pressure": "sign(x - 5.55) + 1"}, 2 * 4.45 * 7),
        ({"pressure": "max(0, x - 3.123)"}, 7 * 6.877**2 / 2),
        ({"pressure": "5*abs(x + y - 7)"}, 5 * (105 + 7**3 / 3)),
        ({"pressure": "where((abs(x - 5) < 1.23)*(abs(y - 3) < 0.77), 2, 0)"}, 8 * 1.23 * 0.77),
        ({"pressure": "where(x < 5 and y < 3.33, 2, 0)", "area": {"rectangle": [1, 1, 9, 6]}}, 2 * 4 * 2.33),
        ({"line_load": "where(x < 3.3, 5, 0)", "edge": "bottom"}, 5 * 3.3),
        ({"line_load": "where(x < 3.3, 5, 0)", "line": [[0, 1], [10, 6]]}, 5 * 3.3 * np.hypot(1, 0.5)),
    ],
)
@pytest.mark.parametrize("divisions", [(1, 1), (7, 5), (20, 13)])
def test_loads_that_jump_along_straight_lines_have_their_totals(load, expected, divisions):
    assert total(RECTANGLE, load, divisions) == approx(expected, rel=1e-9)


@pytest.mark.parametrize("load", ["where((x-5)**2 + (y-3)**2 < 4, 1, 0)", "(hypot(x - 5, y - 3) <= 2)*1"])
def test_loads_that_jump_along_a_circle_have_their_totals_nearly(load):
    assert total(RECTANGLE, {"pressure": load}, (7, 5)) == approx(4 * np.pi, rel=1e-4)
    around = load.replace("x-5", "x").replace("y-3", "y").replace("x - 5", "x").replace("y - 3", "y")
    assert total(DISC, {"pressure": around}, (4, 24)) == approx(4 * np.pi, rel=1e-4)


def test_self_weight_jumps_with_the_thickness():
    plate = {**RECTANGLE, "thickness": "where(x + 0.37*y < 6.1, 0.5, 0.25)"}
    weight = 2 * 0.25 * (70 + SKEW)
    assert total(plate, {"self_weight": True}, (7, 5), unit_weight=2.0) == approx(weight, rel=1e-9)


@pytest.mark.parametrize(
    ("stiffness", "area", "close"),
    [
        ("where(x < 3.3, 1e5, 1e3)", 3.3 * 7, 1e-9),
        ("where(x + 0.37*y < 6.1, 1e5, 1e3)", SKEW, 1e-9),
        ("where((x-5)**2 + (y-3)**2 < 4, 1e5, 1e3)", 4 * np.pi, 0.01),
    ],
)
def test_soil_that_jumps_is_as_stiff_as_its_parts(stiffness, area, close):
    model = Model(
        material={"E": 1e9, "nu": 0.2},
        plate=RECTANGLE,
        mesh={"divisions": [10, 7]},
        support=[{"area": "all", "resists": "down", "stiffness": stiffness}],
        load=[{"pressure": 1.0}],
    )
    found = discretise(model)
    assert (1 / found.contacts.compliance).sum() == approx(1e3 * 70 + 99e3 * area, rel=close)


@pytest.mark.parametrize(
    ("thickness", "says"),
    [
        ("0.3 - 0.1*x", r"is -\S+ at \[\S+, \S+\], but must be greater than 0"),
        ("where(exp(x) < exp(5.01), 0.2, -1)", r"is -1 at \["),
        ("where(y < 0.99, 0.2, 1e3)", r"Found the thickness 1000 at \[\S+, \S+\]"),
    ],
)
def test_a_thickness_that_is_none_somewhere_is_refused_with_the_place(thickness, says):
    with pytest.raises(InputError, match=says) as refusal:
        cantilever(thickness, 3)
    assert refusal.value.place == "plate.thickness"


def test_a_formula_that_is_refused_only_at_a_node_is_none_of_its_elements():
    assert cantilever("0.2 + 1e-9/x", 3) == approx(cantilever(0.2, 3), rel=1e-6)
