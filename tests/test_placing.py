"""Supports are found on the mesh once, and everything lists their points as the input does."""

import numpy as np
import pytest
from models import rectangular

from signorini import solve
from signorini.discretise import discretise
from signorini.mesh import Mesh

PLATE = {
    "load": [{"pressure": 5e3}],
}


@pytest.mark.parametrize("how", [{"fix": "simple"}, {"stiffness": 1e8}, {"resists": "down"}, {"gap": 1e-4}])
def test_points_keep_the_order_of_the_input(how):
    # Nodes and points between them, two of them as near to each other as supports may be.
    at = [[3.3, 3.1], [1, 1], [0.4, 3.3], [3, 1], [0.4 + 1e-7, 3.3]]
    other = {"at": [2.1, 2.2], "stiffness": 1e6}
    (result,) = solve(rectangular(**PLATE, support=[other, {"at": at, **how}])).values()
    np.testing.assert_allclose(result.supports[1].positions, at, rtol=0, atol=1e-12)


def test_every_spring_and_contact_point_is_one_supports():
    supports = [
        {"at": [[1, 1], [1.3, 3]], "resists": "down"},
        {"edge": "left", "fix": "hard"},
        {"line": [[3, 0], [3, 4]], "gap": 0.001},
        {"area": {"circle": {"center": [2, 2], "radius": 0.7}}, "resists": "down", "stiffness": 1e7},
        {"at": [[2.2, 0.3]], "stiffness": 1e6},
    ]
    found = discretise(rectangular(**PLATE, support=supports))
    for index, parts in enumerate(found.parts):
        assert (found.points.support[parts.rows] == index).all() and (
            found.springs.support[parts.springs] == index
        ).all()
    rows = np.concatenate([parts.rows.ravel() for parts in found.parts])
    assert sorted(rows) == np.flatnonzero(~found.points.slope).tolist()
    assert found.parts[2].rows.shape == (2, 9)
    assert sum(len(parts.springs) for parts in found.parts) == len(found.springs) == 1
    assert found.mesh.points[found.parts[1].nodes, 0].tolist() == [0.0] * 9


@pytest.mark.parametrize("how", [{"fix": "clamped"}, {"resists": "down"}, {"stiffness": 1e6}, {"gap": 0.01}])
def test_a_line_is_looked_for_once(monkeypatch, how):
    asked = []
    along = Mesh.edges_along
    monkeypatch.setattr(Mesh, "edges_along", lambda mesh, curve: asked.append(curve) or along(mesh, curve))
    line = {"line": [[2, 0], [2, 4]]}
    discretise(rectangular(**PLATE, support=[line | how, {"edge": "left", "fix": "simple"}]))
    assert len(asked) == 1
