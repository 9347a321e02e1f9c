"""Load paths against closed forms: first lift-off, contact gained, tipping."""

import numpy as np
import pytest
from models import rectangular
from scipy.special import bei, beip, ber, berp, kei, keip, ker, kerp

import signorini


def test_a_heavy_strip_on_soil_lifts_off_at_its_closed_form_load() -> None:
    """A long beam under a force P sinks by Pβ/2k e^{−βx}(cos βx + sin βx) (Hetényi 1946), least at βx = π.

    Its weight q presses it in by q/k. The first point to open is the quadrature point nearest to π/β, so the beam is
    thin (h/ℓ = 0.016) and asked there.
    """
    height, young, bed, weight = 0.05, 1e13, 1e6, 1e3
    length = (young * height**3 / 12 / bed) ** 0.25
    beta = 1 / (np.sqrt(2) * length)
    half = 5 * np.pi / beta
    model = rectangular(
        material={"E": young, "nu": 0.0},
        size=[half, half / 80],
        thickness=height,
        divisions=[80, 1],
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
    found = signorini.path(model, "weight", "force", until=2.5 * weight * np.exp(np.pi) / beta, events="all")
    event = found.events[0]
    at = event.switched[0].at[0] * beta
    assert not event.switched[0].closes and at == pytest.approx(np.pi, abs=half * beta / 80)
    assert event.t == pytest.approx(-2 * weight / beta / (np.exp(-at) * (np.cos(at) + np.sin(at))), rel=4e-4)
    assert event.t == pytest.approx(2 * weight * np.exp(np.pi) / beta, rel=1e-3)
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


@pytest.mark.parametrize("ratio", [3.0, 5.0])
def test_a_heavy_disc_on_soil_lifts_off_at_its_closed_form_load(ratio) -> None:
    height, young, bed, weight = 0.0005, 64e12, 1e6, 1e3
    length = (young * height**3 / 12 / (1 - 0.09) / bed) ** 0.25
    radius = ratio * length
    model = signorini.Model(
        material={"E": young, "nu": 0.3},
        plate={"shape": "disc", "radius": radius, "sector": 90, "thickness": height},
        mesh={"divisions": [16, 16]},
        support=[
            {"edge": ["start", "end"], "fix": "symmetry"},
            {"name": "soil", "area": "all", "resists": "down", "stiffness": bed},
        ],
        load=[{"case": "weight", "pressure": weight}, {"case": "force", "force": 0.25, "at": [0, 0]}],
    )
    thin = lift_off_of_disc(ratio, ratio) * weight * length**2
    event = signorini.path(model, "weight", "force", until=1.2 * thin, events="all").events[0]
    at = float(np.hypot(*event.switched[0].at))
    assert at > 0.99 * radius and not event.switched[0].closes
    assert event.t == pytest.approx(lift_off_of_disc(ratio, at / length) * weight * length**2, rel=1e-4)


def test_the_prop_under_a_clamped_plate_is_met_at_the_closed_form_load() -> None:
    """A thin clamped square under q sinks by 0.00126534 q a⁴/D in its middle (h/a = 0.001; docs/validation.md)."""
    side, height, young, gap = 4.0, 0.004, 30e9, 1e-3
    rigidity = young * height**3 / 12 / (1 - 0.09)
    model = rectangular(
        material={"E": young, "nu": 0.3},
        size=[side / 2, side / 2],
        thickness=height,
        divisions=[16, 16],
        support=[
            {"edge": ["bottom", "left"], "fix": "clamped"},
            {"edge": ["right", "top"], "fix": "symmetry"},
            {"name": "prop", "at": [side / 2, side / 2], "resists": "down", "gap": gap},
        ],
        load=[{"pressure": 1.0}],
    )
    (event,) = signorini.path(model, None, "load", events="all").events
    assert event.switched[0].closes
    assert event.t == pytest.approx(gap * rigidity / (0.00126534 * side**4), rel=1e-4)


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

    first = signorini.path(plate(2e5), None, "load", events="all").events[0].t
    found = signorini.path(plate(2e5 * 0.5 / first), None, "load", until=1.0, events="all")
    (event,) = found.events
    assert event.t == pytest.approx(0.5, rel=1e-12) and event.switched[0].closes
    # Two stages are two segments: the reactions of both add up to those of one step.
    whole = signorini.solve(found.model)["all"]
    assert found.at(1.0).nodal_reaction == pytest.approx(whole.nodal_reaction, abs=64e-10)
    assert found.stops[-1].reactions.sum() == pytest.approx(64, rel=1e-10)


def test_a_rigid_footing_opens_at_a_sixth_and_tips_at_half_its_width() -> None:
    """N/A = M x / I at the edge, and the moment N B/2 at the end: the bed reaches as far as the footing."""
    width, divisions, force = 4.0, 4, 1e3
    model = rectangular(
        material={"E": 1e13, "nu": 0.2},
        size=[width, width],
        thickness=1.0,
        divisions=[divisions, divisions],
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e5}],
        load=[{"case": "N", "pressure": force / width**2}, {"case": "M", "moment": [1.0, 0.0], "at": [2, 2]}],
    )
    found = signorini.path(model, "N", "M", events="all")
    assert found.events[0].t == pytest.approx(force * width / 6, rel=1e-7)
    assert found.ending == "no_equilibrium" and found.limit == pytest.approx(force * width / 2, rel=1e-9)


@pytest.mark.parametrize("divisions", [8, 16])
def test_a_rigid_block_loses_its_contact_at_the_closed_form_eccentricities(divisions) -> None:
    """N on a width B at the eccentricity e: 3 (B/2 - e) of it are closed beyond e = B/6, none at B/2."""
    width, force = 4.0, 1e3
    model = rectangular(
        material={"E": 5e14, "nu": 0.2},
        size=[width, width],
        thickness=1.0,
        divisions=[divisions, divisions],
        support=[{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e5}],
        load=[{"case": "N", "pressure": force / width**2}, {"case": "M", "moment": [1.0, 0.0], "at": [2, 2]}],
    )
    found = signorini.path(model, "N", "M")
    assert found.ending == "no_equilibrium" and found.end == pytest.approx(force * width / 2, rel=2e-6)
    said = [(event.change, event.closed) for event in found.support_events]
    assert said == [("begins to open", 1.0), *(("part closed", part) for part in (0.75, 0.5, 0.25))]
    exact = force * width * np.array([1 / 6, 1 / 4, 1 / 3, 5 / 12])
    for event, t, width_of in zip(found.support_events, exact, signorini.estimate(found).events, strict=True):
        assert abs(event.t - t) <= width_of < 0.04 * t


def test_a_table_on_four_legs_loses_two_at_once_as_it_tips() -> None:
    model = rectangular(
        thickness=0.1,
        support=[{"name": "legs", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}],
        load=[{"case": "G", "pressure": 1e3}, {"case": "Q", "force": 1e3, "at": [4, 2]}],
    )
    found = signorini.path(model, "G", "Q", events="all")
    assert (found.ending, found.events) == ("no_equilibrium", ())
    assert found.end == pytest.approx(16, rel=1e-9)
    assert found.at(16.0).supports[0].reactions == pytest.approx([0, 16e3, 16e3, 0], abs=1e-3)


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_a_see_saw_tilts_to_its_other_stop_under_one_load(method) -> None:
    """Weights on both sides of a hinge balance at t = 1; the plate then turns by itself until the gap is closed."""
    model = rectangular(
        size=[4, 1],
        divisions=[8, 2],
        support=[
            {"name": "hinge", "line": [[2, 0], [2, 1]], "resists": "both"},
            {"name": "left", "at": [0, 0.5], "resists": "down"},
            {"name": "right", "at": [4, 0.5], "resists": "down", "gap": 0.01},
        ],
        load=[{"case": "G", "force": 1e3, "at": [0.5, 0.5]}, {"case": "Q", "force": 1e3, "at": [3.5, 0.5]}],
        solver={"method": method},
        probe=[{"at": [[0, 0.5], [4, 0.5]]}],
    )
    found = signorini.path(model, "G", "Q", until=2.0, events="all")
    rests, turns, tilted = found.segments
    assert (rests.jumps, turns.jumps, tilted.jumps) == (False, True, False)
    assert [stop.t for stop in found.events] == pytest.approx([1, 1], rel=1e-9)
    said = [(switch.support, switch.change) for stop in found.events for switch in stop.switched]
    assert said == [("left", "opens"), ("right", "closes")]
    turned = turns.end.deflections - turns.begin.deflections
    # Its own bending, the same on both sides, is in the gap.
    assert turned[0] == pytest.approx(-turned[1], rel=1e-6) and turns.end.deflections[1] == pytest.approx(
        0.01, rel=1e-9
    )
    assert turns.begin.reactions == pytest.approx([2e3, 0, 0], abs=1e-5)
    assert turns.end.reactions == pytest.approx([2e3, 0, 0], abs=1e-5)
    assert found.at(2.0).reactions["right"] == pytest.approx(1e3 * 1.5 / 2, rel=1e-9)
