"""Slopes held at prescribed values, the rotations of the paper's u₀, against closed forms that the elements contain."""

import numpy as np
import pytest

from signorini import InputError, Model, Result, solve

A, B, H, E = 4.0, 1.0, 0.2, 30e9
RIGIDITY = E * H**3 / 12
PHI = 1e-3
ENDS = ([0, 0], [0, B]), ([A, 0], [A, B])


def strip(*support: dict, pressure: float = 0.0, **plate: object) -> Result:
    """A strip without Poisson's ratio, so that it bends as a beam."""
    model = Model(
        material={"E": E, "nu": 0.0},
        plate={"shape": "rectangle", "size": [A, B], "thickness": H} | plate,
        mesh={"divisions": [4, 1]},
        support=support,
        load=[{"pressure": pressure}],
    )
    return solve(model)["all"]


def end(name: str, slope: float | str, **how: object) -> dict:
    return {"edge": name, "fix": "clamped", "rotation": [slope, 0]} | how


def test_ends_turned_against_each_other_bend_a_strip_to_a_parabola() -> None:
    """w = φ x (1 − x/a), M = −D w″ = 2 D φ / a, no shear: the elements contain it."""
    result = strip(end("left", PHI), end("right", -PHI))
    x = result.mesh.points[:, 0]
    assert result.deflection == pytest.approx(PHI * x * (1 - x / A), abs=1e-12 * PHI * A)
    assert result.moment[:, 0] == pytest.approx(2 * RIGIDITY * PHI / A, rel=1e-9)
    assert np.abs(result.shear).max() < 1e-7 * RIGIDITY * PHI / A**2
    assert result.certificate.passed


def test_a_strip_that_turns_as_a_whole_feels_nothing() -> None:
    left, right = end("left", PHI, settlement=f"{PHI}*x"), end("right", PHI, settlement=f"{PHI}*x")
    result = strip(left, right)
    assert result.deflection == pytest.approx(PHI * result.mesh.points[:, 0], abs=1e-12 * PHI * A)
    assert np.abs(result.moment).max() < 1e-9 * RIGIDITY * PHI / A


def test_the_end_of_a_clamped_strip_that_is_turned_takes_the_force_of_beams_with_shear() -> None:
    """R = 6 D b φ / (a² (1 + 12 D / (S a²))), Timoshenko's beam."""
    result = strip({"name": "wall", "edge": "left", "fix": "clamped"}, {"name": "turned", **end("right", PHI)})
    shear = 5 / 6 * E / 2 * H
    force = 6 * RIGIDITY * B * PHI / A**2 / (1 + 12 * RIGIDITY / (shear * A**2))
    assert abs(result.reactions["wall"]) == pytest.approx(force, rel=1e-6)
    assert result.reactions["wall"] == pytest.approx(-result.reactions["turned"], rel=1e-9)


def test_a_rotation_of_points_is_that_of_the_edge_where_they_are_nodes_and_where_they_are_not() -> None:
    line = {"line": [[1, 0], [1, B]], "fix": "clamped", "rotation": [PHI, 0]}
    wanted = strip(end("left", 0), line)
    between = strip(end("left", 0), {**line, "line": [[1.03, 0], [1.03, B]]})
    assert wanted.probe((1, 0.5))[0].rotation[0] == pytest.approx(PHI, rel=1e-9)
    assert between.probe((1.03, 0.5))[0].rotation[0] == pytest.approx(PHI, rel=1e-6)
    # Between nodes a probe has eight functions, and the row nine.
    for x, within in ((1.0, 1e-9), (1.03, 0.05)):
        point = strip(end("left", 0), {"at": [x, 0.5], "fix": ["slope", "twist"], "rotation": [PHI, 2 * PHI]})
        probe = point.probe((x, 0.5))[0]
        assert probe.rotation == pytest.approx((PHI, 2 * PHI), rel=within)


def test_only_the_component_that_is_held_is_prescribed() -> None:
    symmetry = strip(end("left", 0), {"edge": "right", "fix": "symmetry", "rotation": [PHI, 7.0]})
    plain = strip(end("left", 0), {"edge": "right", "fix": "symmetry", "rotation": [PHI, 0.0]})
    assert np.array_equal(symmetry.deflection, plain.deflection)
    assert symmetry.deflection.max() == pytest.approx(PHI * A / 2, rel=1e-9)


def test_a_rim_that_is_turned_outwards_bends_a_disc_to_a_bowl() -> None:
    """Slope φ r / R along the radius: w = φ (r² − R²) / 2R, a sphere, M = −D (1 + ν) φ / R all over."""
    radius, nu = 2.0, 0.3
    model = Model(
        material={"E": E, "nu": nu},
        plate={"shape": "disc", "radius": radius, "thickness": H},
        mesh={"divisions": [6, 24]},
        support=[{"edge": "rim", "fix": "clamped", "rotation": [f"{PHI}*x/{radius}", f"{PHI}*y/{radius}"]}],
        load=[{"pressure": 0.0}],
    )
    result = solve(model)["all"]
    r = np.hypot(*result.mesh.points.T)
    assert result.deflection == pytest.approx(PHI * (r**2 - radius**2) / 2 / radius, abs=2e-4 * PHI * radius)
    rigidity = RIGIDITY / (1 - nu**2)
    assert result.moment[r < 1, 0] == pytest.approx(-rigidity * (1 + nu) * PHI / radius, rel=1e-3)


def test_answers_to_loads_and_rotations_add_up_while_nothing_lets_go() -> None:
    turned = strip(end("left", PHI), end("right", 0))
    pressed = strip(end("left", 0), end("right", 0), pressure=1e3)
    both = strip(end("left", PHI), end("right", 0), pressure=1e3)
    assert both.deflection == pytest.approx(turned.deflection + pressed.deflection, abs=1e-12 * both.deflection.max())


def test_a_rotation_opens_a_support_that_only_pushes() -> None:
    for slope, closed in ((PHI, True), (-PHI, False)):
        result = strip(end("left", slope), {"at": [A, B / 2], "resists": "down"})
        assert result.supports[1].closed.tolist() == [closed]


def test_rotations_that_contradict_each_other_where_supports_meet_are_refused() -> None:
    bottom = {"edge": "bottom", "fix": "clamped", "rotation": [PHI, 0]}
    with pytest.raises(InputError) as caught:
        strip(end("left", 2 * PHI), bottom)
    assert str(caught.value) == (
        "support[2].rotation: found the slopes [0.001, 0] at [0, 0], where support[1] prescribes [0.002, 0]. "
        "Prescribe the same, or let one of them not hold the slope."
    )
    assert strip(end("left", PHI), bottom).status == "solved"


@pytest.mark.parametrize("how", [{"fix": "simple"}, {"resists": "down"}, {}])
def test_a_rotation_of_what_holds_no_slope_is_refused(how: dict) -> None:
    with pytest.raises(InputError, match=r"support\[1\]\.rotation: .* does not hold a slope"):
        strip({"edge": "left", "rotation": [PHI, 0], **how})


def test_a_rotation_is_two_numbers() -> None:
    with pytest.raises(InputError, match=r"rotation: found 0\.001; it must be two slopes \[θx, θy\]"):
        strip({"edge": "left", "fix": "clamped", "rotation": PHI})
