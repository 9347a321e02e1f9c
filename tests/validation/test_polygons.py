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
