"""Circular plates: locking of q8r, and symmetry of a rigid circle."""

import pytest
from models import rectangular

import signorini


def circle(fix, thickness, element, divisions):
    model = signorini.Model(
        material={"E": 1.0, "nu": 0.3},
        plate={"shape": "disc", "radius": 1.0, "thickness": thickness, "element": element},
        mesh={"divisions": divisions},
        support=[{"name": "rim", "edge": "rim", "fix": fix}],
        load=[{"pressure": 1.0}],
        probe=[{"at": [0, 0]}],
    )
    return signorini.solve(model)["all"]


def test_q8r_still_locks_on_a_thin_clamped_circle():
    found = [
        circle("clamped", 1e-3, "q8r", divisions).probes[0].deflection * 1e-6 / 170.625
        for divisions in ([4, 16], [8, 32])
    ]
    assert found[0] == pytest.approx(0.968, abs=2e-3)
    assert abs(found[1] - 1) < 3e-3


@pytest.mark.parametrize("divisions", [5, 8, 17])
def test_a_rigid_circle_has_no_beginning(divisions: int) -> None:
    """A square plate on a circle is its own mirror image, wherever elements lie on the circle's rightmost point."""
    model = rectangular(
        size=[10, 10],
        thickness=0.1,
        divisions=[divisions, divisions],
        support=[{"circle": {"center": [5, 5], "radius": 2.5358}, "resists": "both"}],
        load=[{"pressure": 1e4}],
        probe=[{"at": at} for at in ([1, 5], [9, 5], [5, 1], [5, 9])],
    )
    deflection = [probe.deflection for probe in signorini.solve(model)["all"].probes]
    assert deflection == pytest.approx([deflection[0]] * 4, rel=1e-10)
