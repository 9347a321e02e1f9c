"""How near to the end of its equilibrium a combination is, against statics by hand."""

import numpy as np
import pytest
from models import rectangular

from signorini import Model, solve
from signorini.analysis.check import check as checked
from signorini.errors import NoEquilibriumError

SQUARE = [[1, 1], [3, 1], [3, 3], [1, 3]]


def model(loads, factors=None, supports=None) -> Model:
    return rectangular(
        material={"E": 30e6, "nu": 0.2},
        support=supports or [{"name": "pads", "at": SQUARE, "resists": "down"}],
        load=loads,
        combination=[{"name": "ULS", "factors": factors}] if factors else [],
    )


def resultant(*given):
    (found,) = checked(model(*given)).resultants
    return found


WEIGHT = {"case": "G", "pressure": 5.0}
CRANE = {"case": "Q", "force": 20.0, "at": [4.0, 2.0]}


@pytest.mark.parametrize(
    ("loads", "factors", "limit"),
    [
        # 80 at 2 and 20 Q at 4 about the pads' line at 3: 80 = 20 Q. The weight may shrink by as much.
        ([WEIGHT, CRANE], {"G": 1.0, "Q": 1.0}, {("Q", 4.0), ("G", 0.25)}),
        ([WEIGHT, CRANE], {"G": 1.0, "Q": 2.0}, {("Q", 2.0), ("G", 0.5)}),
        ([WEIGHT, CRANE], {"G": 1.0, "Q": 8.0}, {("Q", 0.5), ("G", 2.0)}),
        ([WEIGHT, {"case": "W", "pressure": -4.0}], {"G": 1.0, "W": 1.0}, {("W", 1.25), ("G", 0.8)}),
        ([WEIGHT, {"case": "W", "pressure": -4.0}], {"G": 1.0, "W": 2.0}, {("W", 0.625), ("G", 1.6)}),
        ([WEIGHT, {"case": "Q", "force": 20.0, "at": [2.5, 2.0]}], {"G": 1.0, "Q": 1.0}, {None}),
        ([WEIGHT], {"G": 1.0}, {None}),
        ([{"case": "W", "pressure": -4.0}], {"W": 1.0}, {None}),
    ],
)
def test_the_nearest_limit_is_that_of_statics(loads, factors, limit) -> None:
    found = resultant(loads, factors).limit
    assert any(
        found == want if want is None else found == (want[0], pytest.approx(want[1], rel=1e-9)) for want in limit
    )


def test_the_limit_that_is_named_is_where_equilibrium_ends() -> None:
    case, factor = resultant([WEIGHT, CRANE], {"G": 1.0, "Q": 1.0}).limit
    for step, balanced in ((1 - 1e-6, case == "Q"), (1 + 1e-6, case == "G")):
        factors = {"G": 1.0, "Q": 1.0} | {case: factor * step}
        assert (resultant([WEIGHT, CRANE], factors).message == "") == balanced


def test_what_would_bring_it_back_is_in_the_message() -> None:
    with pytest.raises(
        NoEquilibriumError, match=r'With the case "[GQ]" at (0\.5|2) times its factor it would just stand'
    ):
        solve(model([WEIGHT, CRANE], {"G": 1.0, "Q": 8.0}))


@pytest.mark.parametrize(
    ("at", "brink"),
    [([3.0, 2.0], True), ([3.0, 3.0], True), ([2.2, 1.0], True), ([2.9999, 2.0], False), ([2.0, 2.0], False)],
)
def test_a_resultant_on_the_edge_of_the_hull_is_on_the_brink(at, brink) -> None:
    found = resultant([{"force": 7.0, "at": at}])
    assert found.message == "" and found.brink == brink
    assert solve(model([{"force": 7.0, "at": at}]))["all"].certificate.passed


def test_three_points_and_weight_at_one_are_on_the_brink_and_a_clamped_plate_never() -> None:
    three = [{"at": SQUARE[:3], "resists": "down"}]
    assert resultant([{"force": 1.0, "at": [1, 1]}], None, three).brink
    assert not resultant([{"force": 1.0, "at": [2.5, 1.5]}], None, three).brink
    assert not resultant([{"force": 1.0, "at": [1, 1]}], None, [{"edge": "left", "fix": "clamped"}]).brink


def test_the_axis_is_the_line_of_the_supports_it_turns_on() -> None:
    ends = np.array(resultant([{"force": 1.0, "at": [3.5, 2.0]}]).axis)
    assert ends[:, 0] == pytest.approx([3.0, 3.0]) and abs(np.ptp(ends[:, 1])) == pytest.approx(4.0)
    assert resultant([{"pressure": -1.0}]).axis is None and resultant([{"pressure": 1.0}]).axis is None


@pytest.mark.parametrize(
    ("pads", "load", "line"),
    [
        ([[3, 1], [3, 3], [1, 2]], [4, 2], "x = 3"),
        ([[3, 1], [3, 3], [1, 1]], [4, 3], "x = 3"),
        ([[1, 3], [3, 3], [2, 1]], [2, 4], "y = 3"),
        ([[1, 3], [3, 1], [1, 1]], [4, 4], "x + y = 4"),
        ([[1, 1], [3, 3], [3, 1]], [0, 4], "x - y = 0"),
        ([[0, 1], [4, 3], [4, 0]], [1, 3], "-0.5 x + y = 1"),
        ([[1, 0], [3, 4], [4, 0]], [1, 3], "x - 0.5 y = 1"),
        ([[0, 0], [0.3, 4], [0.1, 4 / 3], [4, 0]], [0, 4], "x - 0.075 y = 0"),
    ],
)
@pytest.mark.parametrize("unit", [1e-5, 1.0, 1e3])
def test_the_line_is_written_without_rounding_in_any_unit(pads, load, line, unit) -> None:
    scaled = rectangular(
        material={"E": 30e6, "nu": 0.2},
        size=[4 * unit, 4 * unit],
        thickness=0.2 * unit,
        support=[{"at": (unit * np.array(pads)).tolist(), "resists": "down"}],
        load=[{"force": 1.0, "at": (unit * np.array(load)).tolist()}],
    )
    left, right = line.split(" = ")
    (found,) = checked(scaled).resultants
    assert f"tips about the line {left} = {float(right) * unit:.6g} through [" in found.message
    assert "e-17" not in found.message and "e-16" not in found.message


@pytest.mark.parametrize("seed", range(10))
def test_the_moment_that_is_short_is_the_least_couple_that_restores_equilibrium(seed) -> None:
    rng = np.random.default_rng(seed)
    found = None
    while found is None or "tips" not in found.message:
        supports = [{"at": rng.uniform(1, 3, (rng.integers(3, 7), 2)).tolist(), "resists": "down"}]
        if seed % 2:
            supports.append({"at": rng.uniform(0, 4, (2, 2)).tolist(), "resists": "up"})
        couple = {"moment": rng.normal(0, 3, 2).tolist(), "at": [2, 2]}
        loads = [{"force": 1.0, "at": rng.uniform(0, 4, 2).tolist()}, couple]
        found = resultant(loads, None, supports)
    said = float(found.message.split("short by a moment of ")[1].split(" ")[0].rstrip("."))
    begin, end = np.array(found.axis)
    normal = np.array([begin[1] - end[1], end[0] - begin[0]]) / np.hypot(*(end - begin))
    moment = float(found.couple @ normal - found.force * (begin - [2, 2]) @ normal)
    assert abs(moment) == pytest.approx(said, rel=1e-5)

    def stands(couple) -> bool:
        return resultant([*loads, {"moment": list(couple), "at": [2, 2]}], None, supports).message == ""

    assert stands(-moment * normal)
    turns = np.linspace(0, 2 * np.pi, 16)
    assert not any(stands((1 - 1e-5) * moment * np.array([np.cos(turn), np.sin(turn)])) for turn in turns)
    assert not stands(-(1 - 1e-5) * moment * normal)


def test_a_couple_alone_turns_the_plate_about_its_supports() -> None:
    found = resultant([{"moment": [1.0, 0.0], "at": [2, 2]}], None, [{"at": SQUARE[:3], "resists": "down"}])
    assert "tips about the line x = 3 through [3, 1], [3, 3] of support 1, short by a moment of 1." in found.message


def test_a_hinged_plate_tips_about_its_hinge() -> None:
    hinge = [{"edge": "left", "fix": "simple"}, {"at": [3, 2], "resists": "down"}]
    found = resultant([{"pressure": -1.0}], None, hinge)
    assert "tips about the line x = 0, short" in found.message
    assert np.array(found.axis)[:, 0] == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("beyond", [1e-1, 1e-5, 1e-8])
def test_however_little_holds_the_plate_is_told(beyond):
    """A force of 20 just outside the bed's edge at 3, and the force at 3 on the other side that holds it."""
    bed = [{"area": {"rectangle": [1, 1, 3, 3]}, "resists": "down", "stiffness": 1e4}]
    with pytest.raises(NoEquilibriumError) as none:
        solve(model([{"case": "Q", "force": 20.0, "at": [3 + beyond, 2]}], None, bed))
    extra = float(str(none.value).partition("An extra ")[2].split()[0])
    assert extra == pytest.approx(20.0 * beyond / 3, rel=1e-5)


@pytest.mark.parametrize("curvature", [1e-7, 1e-1, 1e3])
def test_curvature_without_a_resultant_hides_no_tipping(curvature):
    """Its couples at nodes may be 1e12 times the load, whose resultant alone decides."""
    loads = [{"case": "G", "force": 1.0, "at": [1.5, 1 - 1e-6]}, {"case": "G", "curvature": [curvature, 0, curvature]}]
    bearings = [{"at": [[1, 1], [3, 1], [2, 3]], "resists": "down"}]
    with pytest.raises(NoEquilibriumError, match="tips about the line y = 1 through"):
        solve(model(loads, supports=bearings))
