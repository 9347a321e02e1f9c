"""Corner force of a soft simply supported square."""

import pytest

CORNER_FORCE = 0.0649646
"""R/qa² of the thin plate: Timoshenko and Woinowsky-Krieger (1959), art. 30."""


def test_corner_force_of_the_soft_plate_spreads_over_its_boundary_layer(square):
    """All that pulls down near a corner; the layer, as wide as the plate is thick, costs 5.5 % of Kirchhoff's force."""
    result, _ = square({"fix": "simple"}, 0.01, 64)
    pulls = result.supports[0].reactions < 0
    assert (result.supports[0].positions[pulls].min(axis=1) > 0.45).all()
    down = -result.supports[0].reactions[pulls].sum()
    assert down == pytest.approx(0.945 * CORNER_FORCE, rel=5e-3)
