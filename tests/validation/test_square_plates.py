"""Uniformly loaded square plates, supported hard, soft and clamped, at several thicknesses; ν = 0.3, κ = 5/6.

References: hard, the double sine series (Navier, with the shear deflection of Mindlin 1951); soft and clamped, a
high-order spectral solution of the Mindlin plate; corner force, Timoshenko & Woinowsky-Krieger (1959), § 30. Each is
for a = q = 1; meshes are of a quarter of the plate.
"""

import numpy as np
import pytest

SOFT = {0.001: 0.00406585, 0.01: 0.00409930, 0.1: 0.00461691, 0.2: 0.00554504}
CLAMPED = {0.001: 0.00126534, 0.01: 0.00126786, 0.1: 0.00150463, 0.2: 0.00217216}
CLAMPED_MOMENT = {0.001: 0.05133, 0.01: 0.05131, 0.1: 0.04937, 0.2: 0.04625}
CORNER_FORCE = 0.0649646
MESHES = (8, 16, 32)
DIGITS = 1e-5
"""Errors this small are of the references' own rounding."""

both_elements = pytest.mark.parametrize("element", ["mitc9", "q8r"])


def node(result, at):
    distance = np.hypot(*(result.mesh.points - at).T)
    assert distance.min() < 1e-12
    return int(np.argmin(distance))


def hard_deflection(thickness, nu=0.3, kappa=5 / 6):
    """Centre deflection times D/qa⁴ of the hard simply supported Mindlin plate."""
    m = np.arange(1, 400, 2)
    square = np.pi**2 * (m[:, None] ** 2 + m**2)
    sign = np.where((m[:, None] + m) // 2 % 2, 1.0, -1.0)
    shear = thickness**2 / (6 * (1 - nu) * kappa)
    return float((16 / np.pi**2 * sign / np.outer(m, m) / square**2 * (1 + shear * square)).sum())


def falling(errors, least=DIGITS):
    errors = np.abs(errors)
    return bool((errors[1:] < np.maximum(errors[:-1], least)).all())


def centre_errors(square, fix, thickness, element, reference):
    results = [square({"fix": fix}, thickness, n, element) for n in MESHES]
    return np.array([result.deflection[node(result, (0, 0))] * d / reference - 1 for result, d in results])


@pytest.mark.parametrize(("thickness", "digits"), [(0.0, 406235), (0.01, 406446), (0.1, 427284), (0.2, 490431)])
def test_the_hard_series_gives_the_published_digits(thickness, digits):
    assert hard_deflection(thickness) == pytest.approx(digits * 1e-8, abs=1e-8)


@both_elements
@pytest.mark.parametrize("thickness", [1e-4, 0.01, 0.1, 0.2])
def test_hard_simply_supported(square, thickness, element):
    errors = centre_errors(square, "hard", thickness, element, hard_deflection(thickness))
    assert falling(errors, least=1e-6)
    assert abs(errors[-1]) < 1e-3
    assert element == "q8r" or (np.abs(errors) < 1e-5).all()


@both_elements
@pytest.mark.parametrize("thickness", SOFT)
def test_soft_simply_supported(square, thickness, element):
    errors = centre_errors(square, "simple", thickness, element, SOFT[thickness])
    assert falling(errors)
    assert abs(errors[-1]) < 3e-3


@both_elements
@pytest.mark.parametrize("thickness", CLAMPED)
def test_clamped(square, thickness, element):
    errors = centre_errors(square, "clamped", thickness, element, CLAMPED[thickness])
    assert falling(errors)
    assert abs(errors[-1]) < 3e-3


@both_elements
@pytest.mark.parametrize("thickness", CLAMPED)
def test_clamped_edge_moment(square, thickness, element):
    results = [square({"fix": "clamped"}, thickness, n, element)[0] for n in MESHES]
    errors = np.array([-r.moment[node(r, (0.5, 0)), 0] / CLAMPED_MOMENT[thickness] - 1 for r in results])
    assert falling(errors)
    assert abs(errors[-1]) < 3e-3


@pytest.mark.parametrize("fix", ["hard", "simple", "clamped"])
@pytest.mark.parametrize("thickness", [0.001, 0.2])
def test_edges_carry_the_whole_load(square, fix, thickness):
    result, _ = square({"fix": fix}, thickness, 16)
    assert result.reactions["edges"] == pytest.approx(0.25, rel=1e-9)
    assert result.certificate.passed


@both_elements
def test_corner_force_from_the_twisting_moment_of_the_hard_plate(square, element):
    results = [square({"fix": "hard"}, 0.01, n, element)[0] for n in MESHES]
    errors = np.array([2 * abs(r.moment[node(r, (0.5, 0.5)), 2]) / CORNER_FORCE - 1 for r in results])
    assert falling(errors)
    assert abs(errors[0]) < 2e-2
    assert abs(errors[-1]) < 2e-3


def test_corner_force_of_the_soft_plate_spreads_over_its_boundary_layer(square):
    """All that pulls down near a corner; the layer, as wide as the plate is thick, costs 5.5 % of Kirchhoff's force."""
    result, _ = square({"fix": "simple"}, 0.01, 64)
    pulls = result.supports[0].reactions < 0
    assert (result.supports[0].positions[pulls].min(axis=1) > 0.45).all()
    down = -result.supports[0].reactions[pulls].sum()
    assert down == pytest.approx(0.945 * CORNER_FORCE, rel=5e-3)
