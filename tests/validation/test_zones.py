"""Zones against closed forms: a disc with a thicker middle, and a strip of two thicknesses and materials."""

import numpy as np
import pytest
from pytest import approx

from signorini import Model, solve

E, NU, R, A, Q = 30e9, 0.2, 4.0, 2.0, 10e3
THICK, THIN = 0.4, 0.2


def stepped_disc():
    """Deflection of the middle, radial moment at the step, tangential moments inside and outside it, moment in the
    middle, of a disc on its rim under an even load.

    D (θ'' + θ'/r − θ/r²) = q r/2 with θ = q r³/16D + A r + B/r; slope and radial moment are continuous at the step.
    """
    inner, outer = (E * h**3 / 12 / (1 - NU**2) for h in (THICK, THIN))
    own = {D: (Q * A**3 / 16 / D, 3 * Q * A**2 / 16 / D) for D in (inner, outer)}
    at_rim = -Q * R**2 * (3 + NU) / 16 / outer
    equations = [
        [A, -A, -1 / A],
        [inner * (1 + NU), -outer * (1 + NU), outer * (1 - NU) / A**2],
        [0, 1 + NU, -(1 - NU) / R**2],
    ]
    radial = {D: D * (slope + NU * theta / A) for D, (theta, slope) in own.items()}
    a, b, c = np.linalg.solve(equations, [own[outer][0] - own[inner][0], radial[outer] - radial[inner], at_rim])
    bent = Q * A**4 / 64 / inner + a * A**2 / 2
    bent += Q * (R**4 - A**4) / 64 / outer + b * (R**2 - A**2) / 2 + c * np.log(R / A)
    sheared = Q / 4 * sum(part / (5 / 12 * E / (1 + NU) * h) for part, h in ((A**2, THICK), (R**2 - A**2, THIN)))
    slopes = {inner: own[inner][1] + a, outer: own[outer][1] + b - c / A**2}
    over = {inner: own[inner][0] / A + a, outer: own[outer][0] / A + b + c / A**2}
    tangential = {D: -D * (over[D] + NU * slopes[D]) for D in over}
    return -bent + sheared, -radial[inner] - inner * a * (1 + NU), *tangential.values(), -inner * a * (1 + NU)


HALVES = ({"through": [0, R], "to": [-R, 0]}, {"through": [0, -R], "to": [R, 0]})
SHAPES = {
    "disc": ({"shape": "disc", "radius": R}, lambda n: {"divisions": [n, 4 * n]}, ["rim"]),
    "polygon": (
        {
            "shape": "polygon",
            "points": [[R, 0], {"through": [0, R], "to": [-R, 0]}, {"through": [0, -R], "to": [R, 0]}],
        },
        lambda n: {"size": R / n},
        ["edge 1", "edge 2"],
    ),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_a_stepped_disc_converges_to_its_closed_form_on_both_sides_of_the_step(shape):
    plate, mesh, rim = SHAPES[shape]
    deflection, radial, inside, outside, middle = stepped_disc()
    assert outside < 0.3 * inside
    errors = []
    for n in (12, 24):
        model = Model(
            material={"E": E, "nu": NU},
            plate=plate | {"thickness": THIN},
            mesh=mesh(n),
            zone=[{"area": {"circle": {"radius": A}}, "thickness": THICK}],
            support=[{"edge": rim, "fix": "simple"}],
            load=[{"pressure": Q}],
            probe=[{"at": [[0, 0], [A, 0]]}],
        )
        result = solve(model)["all"]
        nodes, size = result.stress_nodes, len(result.stress_nodes.further)
        assert size == (len(nodes.nodes[np.abs(np.hypot(*nodes.points.T) - A) < 1e-9])) / 2 > 40
        x, y = nodes.points[nodes.mesh.node_count :].T / A
        both = [result.moment[rows] for rows in (nodes.further, np.arange(size) + nodes.mesh.node_count)]
        across = [m[:, 0] * x**2 + m[:, 1] * y**2 + 2 * m[:, 2] * x * y for m in both]
        along = np.sort([m[:, 0] * y**2 + m[:, 1] * x**2 - 2 * m[:, 2] * x * y for m in both], axis=0)
        errors.append(
            [
                abs(result.probes[0].deflection / deflection - 1),
                np.abs(np.array(across) / radial - 1).max(),
                np.abs(along[1] / inside - 1).max(),
                np.abs(along[0] / outside - 1).max(),
                abs(result.probes[0].moment[0] / middle - 1),
            ]
        )
        # At the step the probe says the larger side.
        assert result.probes[1].moment[:2] == approx([radial, inside], rel=2e-3)
        assert result.deflection.max() == approx(deflection, rel=1e-4)
    assert np.array(errors[1]) == approx(0, abs=1e-2)
    assert (np.array(errors[1][1:]) < np.array(errors[0][1:]) / 2).all()


def test_a_strip_of_two_zones_is_a_beam():
    """A cantilever under a force at its end: the integral of M²/EI + Q²/κGA over both parts."""
    soft = {"E": E / 3, "nu": 0}
    for shape in (
        {"shape": "rectangle", "size": [10, 1]},
        {"shape": "polygon", "points": [[0, 0], [10, 0], [10, 1], [0, 1]]},
    ):
        clamped, loaded = ("left", "right") if shape["shape"] == "rectangle" else ("edge 4", "edge 2")
        model = Model(
            material={"E": E, "nu": 0},
            plate=shape | {"thickness": 0.2},
            mesh={"size": 0.5},
            zone=[{"area": {"rectangle": [4.3, 0, 10, 1]}, "thickness": 0.3, "material": soft}],
            support=[{"edge": clamped, "fix": "clamped"}],
            load=[{"line_load": 1e3, "edge": loaded}],
            probe=[{"at": [[10, 0.5], [4.3, 0.5]]}],
        )
        result = solve(model)["all"]
        parts = (E, 0.2, 10.0, 5.7), (E / 3, 0.3, 5.7, 0.0)
        bent = sum(12 * (far**3 - near**3) / 3 / (e * h**3) for e, h, far, near in parts)
        sheared = sum((far - near) / (5 / 6 * e / 2 * h) for e, h, far, near in parts)
        assert result.probes[0].deflection == approx(1e3 * (bent + sheared), rel=1e-6)
        assert result.probes[1].moment[0] == approx(-5.7e3, rel=1e-6)
        assert result.moment[result.stress_nodes.further, 0] == approx(-5.7e3, rel=1e-5)
