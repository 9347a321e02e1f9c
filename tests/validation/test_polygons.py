"""Plates of any outline, of quadrilaterals and triangles, against closed forms and against other meshes."""

import numpy as np
import pytest

import signorini

E, NU = 1e7, 0.3


def solved(points, size, thickness, supports, at, **plate):
    model = signorini.Model(
        material={"E": E, "nu": NU},
        plate={"shape": "polygon", "points": points, "thickness": thickness, **plate},
        mesh={"size": size},
        support=supports,
        load=[{"pressure": 1.0}],
        probe=[{"at": at}],
    )
    return signorini.solve(model)


def deflection(results):
    return results["all"].probes[0].deflection


def stiffness(thickness):
    return E * thickness**3 / (12 * (1 - NU**2))


def arcs(places):
    """Points of a polygon of arcs through every other of an even number of places."""
    closed = [*places, places[0]]
    return [closed[0], *({"through": m, "to": b} for m, b in zip(closed[1::2], closed[2::2], strict=True))]


@pytest.mark.parametrize(("fix", "exact"), [("simple", 703.425), ("clamped", 178.425)])
def test_a_disc_of_two_arcs_takes_the_values_of_code_aster(fix, exact):
    """SSLS101 and SSLS100: R = 1, h = 0.1, with E = 1 and p = 1."""
    points = arcs([[1, 0], [0, 1], [-1, 0], [0, -1]])
    support = [{"edge": ["edge 1", "edge 2"], "fix": fix}]
    errors = [abs(deflection(solved(points, h, 0.1, support, [0, 0])) * E / exact - 1) for h in (0.4, 0.2, 0.1)]
    assert errors[0] < 1.2e-2
    assert errors[2] < 5e-5
    assert errors[2] < 0.1 * errors[0]


@pytest.mark.parametrize("turn", [0.0, 0.4])
def test_an_equilateral_triangle_on_hard_edges_takes_its_closed_form(turn):
    """Height a, at the centroid: qa⁴/972D (Timoshenko, Woinowsky-Krieger 1959), and qa²/27κGh from shear."""
    a, h = 3.0, 0.15
    angles = turn + np.radians([0.0, 120.0, 240.0])
    points = (2 * a / 3 * np.column_stack([np.cos(angles), np.sin(angles)])).tolist()
    exact = a**4 / (972 * stiffness(h)) + a**2 / (27 * 5 / 6 * E / (2 * (1 + NU)) * h)
    support = [{"edge": [f"edge {i}" for i in (1, 2, 3)], "fix": "hard"}]
    errors = [abs(deflection(solved(points, size, h, support, [0, 0])) / exact - 1) for size in (0.6, 0.3, 0.15)]
    assert errors[0] < 1e-3
    assert errors[2] < 5e-5
    assert errors[2] < 0.2 * errors[0]


def test_a_clamped_ellipse_of_arcs_takes_its_closed_form():
    """w₀ = q/(D(24/a⁴ + 24/b⁴ + 16/a²b²)), thin (Timoshenko, Woinowsky-Krieger 1959)."""
    a, b, h = 2.0, 1.2, 0.005
    turn = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    points = arcs(np.column_stack([a * np.cos(turn), b * np.sin(turn)]).tolist())
    exact = 1 / (stiffness(h) * (24 / a**4 + 24 / b**4 + 16 / (a * b) ** 2))
    support = [{"edge": [f"edge {i}" for i in range(1, 33)], "fix": "clamped"}]
    results = solved(points, 0.2, h, support, [0, 0])
    assert deflection(results) == pytest.approx(exact, rel=5e-4)
    assert results.discretisation.mesh.element_area.sum() == pytest.approx(np.pi * a * b, rel=1e-4)


def test_a_rectangle_as_a_polygon_is_the_rectangle():
    common = {
        "material": {"E": E, "nu": NU},
        "mesh": {"size": 0.5},
        "load": [{"pressure": "1 + x"}],
        "probe": [{"at": [1.2, 0.7]}],
    }
    sides = {"rectangle": ["left", "right", "bottom", "top"], "polygon": ["edge 4", "edge 2", "edge 1", "edge 3"]}
    found = []
    for shape, own in (("rectangle", {"size": [4, 3]}), ("polygon", {"points": [[0, 0], [4, 0], [4, 3], [0, 3]]})):
        support = [{"edge": sides[shape][:2], "fix": "hard"}, {"edge": sides[shape][2:], "resists": "down"}]
        model = signorini.Model(plate={"shape": shape, "thickness": 0.2, **own}, support=support, **common)
        found.append(signorini.solve(model)["all"])
    one, other = found
    assert other.probes[0].deflection == pytest.approx(one.probes[0].deflection, rel=1e-9)
    assert other.probes[0].moment == pytest.approx(one.probes[0].moment, rel=1e-8)
    assert other.reactions["support 2"] == pytest.approx(one.reactions["support 2"], rel=1e-9)


def test_a_disc_with_a_round_hole_is_an_annulus():
    common = {"material": {"E": E, "nu": NU}, "load": [{"pressure": 1.0}], "probe": [{"at": [0.5, 0.3]}]}
    support = [{"edge": "rim", "fix": "simple"}]
    ring = {"shape": "annulus", "inner": 0.4, "outer": 1.0, "thickness": 0.05}
    exact = signorini.solve(
        signorini.Model(
            plate=ring, mesh={"divisions": [16, 96]}, support=[{"edge": "outer", "fix": "simple"}], **common
        )
    )["all"]
    pierced = {"shape": "disc", "radius": 1.0, "thickness": 0.05, "holes": [{"circle": {"radius": 0.4}}]}
    errors = []
    for size in (0.2, 0.1):
        found = signorini.solve(signorini.Model(plate=pierced, mesh={"size": size}, support=support, **common))["all"]
        errors.append(abs(found.probes[0].deflection / exact.probes[0].deflection - 1))
    assert errors[0] < 2e-3
    assert errors[1] < 2e-4


def test_a_plate_with_holes_on_one_sided_edges_settles_on_finer_meshes():
    points = [[0, 0], [6, 0], [6, 3], [4, 4.5], [0, 4]]
    holes = [{"rectangle": [1, 1, 2, 2]}, {"circle": {"center": [4, 2], "radius": 0.5}}]
    supports = [
        {"edge": ["edge 1", "edge 3"], "resists": "down"},
        {"name": "hole", "edge": "hole 1", "resists": "down", "gap": 1e-5},
        {"edge": "edge 5", "fix": "simple"},
    ]
    found = [
        solved(points, size, 0.2, supports, [3, 2.8], holes=holes, element="mitc9")["all"] for size in (0.5, 0.25, 0.12)
    ]
    errors = [abs(result.probes[0].deflection / found[2].probes[0].deflection - 1) for result in found[:2]]
    assert errors[0] < 0.04
    assert errors[1] < 0.5 * errors[0]
    area = 24.5 - 1 - np.pi * 0.25
    assert sum(found[2].reactions.values()) == pytest.approx(area, rel=1e-5)
