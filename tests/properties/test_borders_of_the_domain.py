"""Random models at the borders of the domain of validity: inside each is certified, outside each is refused."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from signorini import InputError, Model, NoEquilibriumError, solve
from signorini.discretise import discretise

SIZE = 4.0
WALLS = {"name": "walls", "edge": ["left", "right", "bottom", "top"], "fix": "simple"}
BORDER = st.sampled_from([0.5, 0.999, 1.001, 2.0])
"""Over the limit."""


def model(support, thickness, away=0.0, young=30e9):
    return Model(
        material={"E": young, "nu": 0.2},
        plate={"shape": "rectangle", "size": [SIZE, SIZE], "origin": [away, away], "thickness": thickness},
        mesh={"divisions": [4, 5], "error": False},
        support=support,
        load=[
            {"pressure": 1e-7 * young * thickness**3},
            {"force": 1e-7 * young * thickness**3, "at": [away + 1.3] * 2},
        ],
    )


def turned(at, angle, by):
    return [at[0] + by * math.cos(angle), at[1] + by * math.sin(angle)]


@st.composite
def near(draw, least):
    """Two supports at a distance that is the least one times a number, given beside them, and all of the plate's size.

    One is a point, a line, a circle or an area; the other a point or a line beside it.
    """
    angle, part = draw(st.floats(0.0, math.tau)), draw(BORDER)
    at, apart = [draw(st.floats(1.6, 2.4)) for _ in "xy"], part * least
    radius = draw(st.floats(0.3, 0.7))
    edge_of_circle = turned(at, angle, radius)
    along = angle + math.pi / 2

    def line(middle):
        return [turned(middle, along, -0.4), turned(middle, along, 0.4)]

    one, beside = draw(
        st.sampled_from(
            [
                ({"at": at}, at),
                ({"line": line(at)}, at),
                ({"circle": {"center": at, "radius": radius}}, edge_of_circle),
                ({"area": {"circle": {"center": at, "radius": radius}}}, edge_of_circle),
            ]
        )
    )
    to = turned(beside, angle, apart)
    other = draw(st.sampled_from([{"at": to}, {"line": line(to)}]))
    ways = [{"resists": draw(st.sampled_from(["down", "up", "both"]))} for _ in range(2)]
    return part, [one | ways[0], other | ways[1]]


@settings(max_examples=50)
@given(data=st.data(), ratio=st.floats(-1.7, -0.31))
def test_rigid_supports_near_each_other(data, ratio):
    thickness = SIZE * 10.0**ratio
    part, supports = data.draw(near(0.1 * thickness))
    asked = model([WALLS, *supports], thickness)
    if part < 1.0:
        with pytest.raises(
            InputError, match="Rigid supports must be at one place, or at least a tenth of the thickness"
        ):
            discretise(asked)
        # One that gives way may be there.
        discretise(model([WALLS, supports[0], supports[1] | {"stiffness": 1e6}], thickness))
    else:
        assert solve(asked)["all"].certificate.passed


def least_modulus(found):
    """The least of Σ k w² over ∫ w², by points of every element's corners, edges and middle."""
    at = np.concatenate([found.springs.positions, found.contacts.positions])
    k = np.concatenate([found.springs.stiffness, 1.0 / found.contacts.compliance])
    rows = np.column_stack([np.ones(len(at)), (at - found.middle) / SIZE])
    # For a square plate about its middle.
    mean = SIZE**2 * np.diag([1.0, 1.0 / 12.0, 1.0 / 12.0])
    scale = 1.0 / np.sqrt(np.diag(mean))
    return float(np.linalg.eigvalsh(scale[:, None] * (rows.T @ (k[:, None] * rows)) * scale)[0])


@settings(max_examples=30)
@given(data=st.data(), ratio=st.floats(-4.9, -0.4), young=st.sampled_from([1e-3, 1.0, 30e9]))
def test_a_plate_on_elastic_supports_alone(data, ratio, young):
    thickness = SIZE * 10.0**ratio
    spread = data.draw(st.floats(0.2, 1.0))
    a, b = (0.5 * SIZE * (1 + sign * spread) for sign in (-1, 1))
    way = data.draw(st.sampled_from(["down", "both"]))
    places = [
        {"area": {"rectangle": [a, a, b, b]}},
        {"at": [[a, a], [b, a], [b, b]]},
        {"line": [[a, a], [b, a], [b, b]]},
    ]
    place = data.draw(st.sampled_from(places))

    def standing(stiffness):
        return model([{**place, "resists": way, "stiffness": stiffness}], thickness, young=young)

    part = data.draw(BORDER)
    # Softer than a rigid support, so that λ is proportional to the stiffness.
    of_one = 1e-4 * young * thickness**3 / SIZE**2
    least = max(1e-10, 1e-19 * (SIZE / thickness) ** 2)
    limit = least * young * thickness**3 / 12 / (1 - 0.2**2) / SIZE**4
    asked = standing(of_one * part * limit / least_modulus(discretise(standing(of_one))))
    if part < 1.0:
        with pytest.raises(InputError, match=r"alone holds the plate, .* it must be .* or more"):
            discretise(asked)
    else:
        try:
            assert solve(asked)["all"].certificate.passed
        except NoEquilibriumError:
            # The force may be beside them.
            assert way == "down"


@settings(max_examples=30)
@given(data=st.data(), ratio=st.floats(-4.9, -0.31), away=st.sampled_from([0.0, 1.0, 1e3, 1e6]))
def test_points_anywhere_inside(data, ratio, away):
    """Thin plates far from the origin, whose points may be as near to each other as their coordinates tell."""
    thickness, away = SIZE * 10.0**ratio, SIZE * away
    least = max(0.1 * thickness, 1e-7 * SIZE + 1e-9 * away)
    count = data.draw(st.integers(3, 6))
    at = [[away + data.draw(st.floats(0.4, 3.6)) for _ in "xy"] for _ in range(count)]
    at.append([at[0][0] + 1.01 * least, at[0][1]])
    at = [one for i, one in enumerate(at) if all(math.dist(one, other) >= 1.005 * least for other in at[:i])]
    asked = model(
        [{"at": at, "resists": "both"}, {"area": "all", "resists": "down", "stiffness": 1.0}], thickness, away
    )
    assert solve(asked)["all"].certificate.passed
