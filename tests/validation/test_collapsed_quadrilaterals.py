"""Polar meshes whose innermost ring is collapsed to the centre, as that of the paper's Figure 6."""

import meshio
import numpy as np
import pytest

import signorini
from signorini.mesh.meshers import annulus


def quarter_circle(path, rings, sectors, **plate):
    """A quarter of a disc of radius 1 from a file, its mesh that of an annulus with no inner circle left."""
    mesh = annulus((0.0, 0.0), 0.5, 1.0, (rings, sectors), 90)
    radius = np.hypot(*mesh.points.T)
    points = mesh.points * (2.0 - 1.0 / radius)[:, None]
    groups = {name: np.unique(mesh.edges[name]) for name in ("start", "end", "outer")}
    space = np.column_stack([points, np.zeros(mesh.node_count)])
    meshio.Mesh(space, [("quad8", mesh.elements)], point_sets=groups).write(path)
    model = signorini.Model(
        material={"E": 1.0, "nu": 0.3},
        plate={"shape": "mesh", "file": path, "thickness": 0.1, **plate},
        support=[{"edge": "outer", "fix": "clamped"}, {"edge": ["start", "end"], "fix": "symmetry"}],
        load=[{"pressure": 1.0}],
        probe=[{"at": [0, 0]}, {"at": [0.01, 0.02]}],
    )
    return signorini.solve(model)["all"]


@pytest.mark.parametrize("element", ["mitc9", "q8r"])
def test_code_aster_clamped_circle_on_a_polar_mesh(tmp_path, element):
    """Code_Aster SSLS100: R = 1, h = 0.1, E = 1, p = 1. A collapsed element of the file is a triangle of mitc9."""
    results = [quarter_circle(tmp_path / "polar.inp", n, n, element=element) for n in (2, 4, 8)]
    assert [result.mesh.triangles.sum() for result in results] == ([2, 4, 8] if element == "mitc9" else [0, 0, 0])
    errors = np.abs([result.probes[0].deflection / 178.425 - 1 for result in results])
    assert (errors[1:] < 0.15 * errors[:-1]).all() and errors[-1] < 1e-4
    assert results[-1].probes[0].moment[:2] == pytest.approx([1.3 / 16, 1.3 / 16], rel=0.015)
    # Within the innermost ring, at r² = 5e-4.
    assert results[-1].probes[1].deflection == pytest.approx(170.625 * (1 - 5e-4) ** 2 + 7.8 * (1 - 5e-4), rel=1e-4)
    assert results[-1].reactions["support 1"] == pytest.approx(np.pi / 4, rel=1e-5)
