"""Load paths against closed forms: first lift-off, contact gained, tipping."""

import numpy as np
import pytest
from scipy.special import bei, beip, ber, berp, kei, keip, ker, kerp

import signorini

GAUSS = (1 - 0.6**0.5) / 2
"""Distance of the outermost quadrature points from the edge of an element of size 1."""


def test_a_heavy_strip_on_soil_lifts_off_at_its_closed_form_load() -> None:
    """A long beam under a force P rises most at π/β from it, by Pβ e^{−π}/2k; its weight q presses it in by q/k."""
    height, young, bed, weight = 0.05, 1e9, 1e6, 1e3
    length = (young * height**3 / 12 / bed) ** 0.25
    beta = 1 / (np.sqrt(2) * length)
    half = 5 * np.pi / beta
    model = signorini.Model(
        material={"E": young, "nu": 0.0},
        plate={"shape": "rectangle", "size": [half, half / 80], "thickness": height},
        mesh={"divisions": [80, 1]},
        support=[
            {"edge": "left", "fix": "symmetry"},
            {"edge": ["bottom", "top"], "fix": "symmetry"},
            {"name": "soil", "area": "all", "resists": "down", "stiffness": bed},
        ],
        load=[
            {"case": "weight", "pressure": weight},
            {"case": "force", "line_load": 0.5, "edge": "left"},
        ],
    )
    found = signorini.path(model, "weight", "force", until=2.5 * weight * np.exp(np.pi) / beta)
    exact = 2 * weight * np.exp(np.pi) / beta
    event = found.events[0]
    assert event.t == pytest.approx(exact, rel=0.005)
    assert not event.switched[0].closes
    assert event.switched[0].at[0] == pytest.approx(np.pi / beta, abs=half / 80)
    assert found.ending == "until"


def lift_off_of_disc(ratio, at):
    """Force in q ℓ² at which a free disc of radius ratio·ℓ lifts off at the radius at·ℓ (thin plate, ν = 0.3)."""
    nu = 0.3

    def terms(x):
        """ber, bei, kei: value, slope, Laplacian and its slope; ∇²ber = −bei, ∇²bei = ber, ∇²kei = ker."""
        return np.array(
            [
                [ber(x), berp(x), -bei(x), -beip(x)],
                [bei(x), beip(x), ber(x), berp(x)],
                [kei(x), keip(x), ker(x), kerp(x)],
            ]
        )

    _, slope, laplacian, shear = terms(ratio).T
    moment = laplacian - (1 - nu) * slope / ratio
    a, b = np.linalg.solve([moment[:2], shear[:2]], [moment[2] / (2 * np.pi), shear[2] / (2 * np.pi)])
    w = terms(at)[:, 0]
    return -1 / (a * w[0] + b * w[1] - w[2] / (2 * np.pi))


def test_a_heavy_disc_on_soil_lifts_off_at_its_closed_form_load() -> None:
    height, young, bed, weight = 0.005, 64e9, 1e6, 1e3
    length = (young * height**3 / 12 / (1 - 0.09) / bed) ** 0.25
    radius = 3 * length
    model = signorini.Model(
        material={"E": young, "nu": 0.3},
        plate={"shape": "disc", "radius": radius, "sector": 90, "thickness": height},
        mesh={"divisions": [12, 12]},
        support=[
            {"edge": ["start", "end"], "fix": "symmetry"},
            {"name": "soil", "area": "all", "resists": "down", "stiffness": bed},
        ],
        load=[{"case": "weight", "pressure": weight}, {"case": "force", "force": 0.25, "at": [0, 0]}],
    )
    thin = lift_off_of_disc(3.0, 3.0) * weight * length**2
    event = signorini.path(model, "weight", "force", until=1.5 * thin).events[0]
    at = float(np.hypot(*event.switched[0].at))
    assert at > 0.98 * radius
    assert event.t == pytest.approx(lift_off_of_disc(3.0, at / length) * weight * length**2, rel=0.01)


@pytest.mark.parametrize("element", ["mitc9", "q8r"])
def test_the_gap_under_a_clamped_plate_closes_at_half_the_load(element) -> None:
    side, pressure = 100.0, 64 / 100.0**2

    def plate(young):
        return signorini.Model(
            material={"E": young, "nu": 0.3},
            plate={"shape": "rectangle", "size": [side, side], "thickness": 20.0, "element": element},
            mesh={"divisions": [2, 2]},
            support=[
                {"edge": ["bottom", "left"], "fix": "clamped"},
                {"edge": ["right", "top"], "fix": "symmetry"},
                {"name": "centre", "at": [side, side], "resists": "down", "gap": 0.48e-4},
            ],
            load=[{"pressure": pressure}],
        )

    first = signorini.path(plate(2e5), None, "load").events[0].t
    found = signorini.path(plate(2e5 * 0.5 / first), None, "load", until=1.0)
    (event,) = found.events
    assert event.t == pytest.approx(0.5, rel=1e-12) and event.switched[0].closes
    # Two stages are two segments: the reactions of both add up to those of one step.
    whole = signorini.solve(found.model)["all"]
    assert found.at(1.0).nodal_reaction == pytest.approx(whole.nodal_reaction, abs=64e-10)
    assert found.stops[-1].reactions.sum() == pytest.approx(64, rel=1e-10)


def test_a_rigid_footing_opens_at_a_sixth_and_tips_at_half_its_width() -> None:
    """Discrete points of a bed have their own width: they reach x from the middle instead of B/2."""
    width, divisions, force = 4.0, 4, 1e3
    model = signorini.Model(
        material={"E": 1e10, "nu": 0.2},
        plate={"shape": "rectangle", "size": [width, width], "thickness": 1.0},
        mesh={"divisions": [divisions, divisions]},
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e5}],
        load=[{"case": "N", "pressure": force / width**2}, {"case": "M", "moment": [1.0, 0.0], "at": [2, 2]}],
    )
    found = signorini.path(model, "N", "M")
    outermost = width / 2 - GAUSS * width / divisions
    # N/A = M x / I at the outermost points; the rule integrates x² exactly.
    assert found.events[0].t == pytest.approx(force * width**2 / 12 / outermost, rel=1e-4)
    assert found.ending == "no_equilibrium" and found.limit == pytest.approx(force * outermost, rel=1e-9)


def test_a_table_on_four_legs_loses_two_at_once_as_it_tips() -> None:
    model = signorini.Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.1},
        mesh={"divisions": [4, 4]},
        support=[{"name": "legs", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}],
        load=[{"case": "G", "pressure": 1e3}, {"case": "Q", "force": 1e3, "at": [4, 2]}],
    )
    found = signorini.path(model, "G", "Q")
    assert (found.ending, found.events) == ("no_equilibrium", ())
    assert found.end == pytest.approx(16, rel=1e-9)
    assert found.at(16.0).supports[0].reactions == pytest.approx([0, 16e3, 16e3, 0], abs=1e-3)
