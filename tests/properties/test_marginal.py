"""Marginal cases: degenerate supports, resultants on the hull, extreme numbers."""

import numpy as np
import pytest
from models import rectangular

from signorini import InputError, Model, NoEquilibriumError, solve
from signorini.contact.problem import contact_problem

CORNERS = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
INSIDE = [[0.7, 0.6], [3.4, 0.5], [3.3, 3.2], [0.5, 3.5]]


def model(supports, loads=None, **plate):
    return Model(
        material={"E": plate.pop("E", 1000.0), "nu": 0.3},
        mesh={"divisions": plate.pop("divisions", [4, 4])},
        plate={"shape": "rectangle", "size": [4.0, 4.0], "thickness": 0.3, **plate},
        support=supports,
        load=loads or [{"pressure": 1.0}],
    )


def run(*args, **kwargs):
    result = solve(model(*args, **kwargs))["all"]
    assert result.certificate.passed
    return result


@pytest.mark.parametrize("points", [CORNERS, INSIDE], ids=["nodes", "between nodes"])
@pytest.mark.parametrize("at", [0.0, 0.25, 0.5, 1.0])
def test_resultant_on_the_edge_of_the_hull(points, at):
    (ax, ay), (bx, by) = points[:2]
    place = [ax + at * (bx - ax), ay + at * (by - ay)]
    result = run([{"at": points, "resists": "down"}], [{"force": 1.0, "at": place}])
    reactions = result.supports[0].reactions
    assert reactions == pytest.approx([1 - at, at, 0, 0], abs=1e-9)


@pytest.mark.parametrize("points", [CORNERS, INSIDE], ids=["nodes", "between nodes"])
@pytest.mark.parametrize("beyond", [1e-7, 1e-6, 1e-3, 0.1])
def test_resultant_just_beyond_the_edge_of_the_hull(points, beyond):
    supports = [{"name": "bearings", "at": [[x, y + 0.2] for x, y in points[:2]] + [[2.0, 2.0]], "resists": "down"}]
    (ax, ay), (bx, by) = supports[0]["at"][:2]
    across = np.array([by - ay, ax - bx]) / np.hypot(by - ay, ax - bx)
    place = np.array([(ax + bx) / 2, (ay + by) / 2]) + beyond * across
    with pytest.raises(NoEquilibriumError, match=r"tips about .* of bearings, short by a moment of"):
        solve(model(supports, [{"force": 1.0, "at": place.tolist()}]))
    problem = contact_problem(model(supports, [{"force": 1.0, "at": place.tolist()}]))
    assert problem.solve(problem.discretisation.cases["load"]).status == "no_equilibrium"


@pytest.mark.parametrize("way", ["down", "up", "both"])
@pytest.mark.parametrize("points", [[[1, 1], [2, 2], [3.3, 3.3]], [[1, 1]], [[0, 0], [4, 0], [1.7, 0]]])
def test_points_on_one_line_are_a_mechanism(points, way):
    with pytest.raises(InputError, match="Nothing holds the plate against this motion: turning about"):
        solve(model([{"at": points, "resists": way}]))


def test_edges_that_settle_apart_contradict_at_their_corner():
    edges = [{"edge": "left", "fix": "clamped"}, {"edge": "bottom", "fix": "simple", "settlement": 0.01}]
    with pytest.raises(InputError, match=r"^support\[2\]: Supports contradict each other at \[0, 0\]: .* support\[1\]"):
        solve(model(edges))
    assert run([edges[0], {**edges[1], "settlement": "0.01*x"}]).supports[1].reaction != 0.0


def test_a_spring_below_a_settled_edge_is_pressed():
    supports = [{"edge": "left", "fix": "simple", "settlement": 0.02}, {"edge": "right", "fix": "simple"}]
    result = run([*supports, {"name": "pad", "at": [0.0, 2.0], "resists": "down", "stiffness": 50.0}])
    assert result.reactions["pad"] == pytest.approx(1.0)


@pytest.mark.parametrize("young", [1e-6, 1.0, 1e12])
@pytest.mark.parametrize("pressure", [1e-60, 1e-30, 1e30, 1e60])
def test_numbers_far_from_one(young, pressure):
    supports = [{"at": INSIDE, "resists": "down"}]
    one, far = run(supports), run(supports, [{"pressure": pressure}], E=young)
    assert far.deflection / (pressure * 1000.0 / young) == pytest.approx(one.deflection, rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("case", [{"at": INSIDE, "resists": "up"}, {"at": INSIDE, "resists": "up", "gap": 0.1}])
def test_nothing_below_means_falling(case):
    with pytest.raises(NoEquilibriumError, match=r"drops away from its supports: the load's resultant is 16 down"):
        solve(model([case]))


@pytest.mark.parametrize("way", ["down", "both"])
@pytest.mark.parametrize(
    ("place", "share"), [({"area": "all"}, 16.0), ({"at": INSIDE}, 4.0), ({"edge": ["left", "right"]}, 8.0)]
)
@pytest.mark.parametrize(("part", "thickness"), [(2e-10, 0.3), (1e-8, 0.3), (1e-8, 4e-3), (2e-10, 4e-3)])
def test_a_plate_on_springs_lost_beside_it_sinks_as_a_rigid_body(way, place, share, part, thickness):
    total = part * 1000.0 * thickness**3 / 12 / 16
    support = {**place, "resists": way, "stiffness": total / share}
    result = run([support], [{"pressure": 1.0}, {"force": 4.0, "at": [2.3, 1.9]}], thickness=thickness)
    # Stiffness of the springs in the three rigid motions, as a sum over points and weights.
    (of,) = result.supports
    at = np.column_stack([np.ones(len(of.positions)), of.positions - 2.0])
    weight = of.weights / of.weights.sum() * total
    motion = np.linalg.solve(at.T @ (weight[:, None] * at), [20.0, 4.0 * 0.3, 4.0 * -0.1])
    corners = np.column_stack([np.ones(4), np.array(CORNERS) - 2.0]) @ motion
    found = [probe.deflection for probe in result.probe(CORNERS)]
    assert of.closed.all() and of.reaction == pytest.approx(20.0, rel=1e-8)
    assert found == pytest.approx(corners, rel=1e-6)


@pytest.mark.parametrize("part", [1e-8, 2e-10])
@pytest.mark.parametrize("thickness", [0.3, 4e-3])
def test_a_plate_that_tilts_on_a_bed_lost_beside_it_lies_on_a_strip(part, thickness):
    """Under a force at a twelfth of its length from the edge a rigid plate presses on a quarter, by a triangle."""
    stiffness = part * 1000.0 * thickness**3 / 12 / 16**2
    bed = {"area": "all", "resists": "down", "stiffness": stiffness}
    result = run([bed], [{"force": 1.0, "at": [1 / 3, 2.0]}], thickness=thickness, divisions=[16, 4])
    at_edge, at_end = (probe.deflection for probe in result.probe([(0.0, 2.0), (1.0, 2.0)]))
    assert at_edge * stiffness == pytest.approx(0.5, rel=1e-3)
    assert at_end == pytest.approx(0.0, abs=1e-3 * at_edge)
    assert result.supports[0].reaction == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("way", ["down", "both"])
@pytest.mark.parametrize("part", [1.1e-6, 1e-4])
def test_a_hinged_plate_on_a_soft_bed_turns_as_a_rigid_one(way, part):
    bed = {"name": "bed", "area": "all", "resists": way, "stiffness": part * 1000.0 * 0.3**3 / 12 / 16**2}
    result = run([{"edge": "left", "fix": "simple"}, bed], [{"pressure": 1.0}, {"force": 4.0, "at": [2.3, 1.9]}])
    # About the hinge: ∫ x k (x φ) = 16·2 + 4·2.3, and k φ ∫ x over the plate.
    assert result.reactions["bed"] == pytest.approx(32 * (16 * 2 + 4 * 2.3) / (256 / 3), rel=1e-3)
    assert sum(result.reactions.values()) == pytest.approx(20.0, rel=1e-7)


@pytest.mark.parametrize("soft", [1e-4, 1e-8, 1e-10])
def test_a_load_on_the_edge_of_a_bed_does_not_turn_the_plate_on_soft_springs(soft) -> None:
    """A rounding error in the resultant of internal forces would be a moment that only the springs resist."""
    found = []
    for unit in (1.0, 12.0, 100.0):
        bed = {"area": {"rectangle": [0, 0, 5 * unit, 10 * unit]}, "resists": "down"}
        slab = rectangular(
            size=[10 * unit, 10 * unit],
            thickness=0.0736 * unit,
            divisions=[2, 12],
            support=[bed, {"area": "all", "resists": "up", "stiffness": soft / unit}],
            load=[{"pressure": 0.1}],
        )
        result = solve(slab)["all"]
        assert result.certificate.passed and not result.not_unique
        found.append(result.deflection / unit)
    assert np.abs(found - found[0]).max() <= 1e-6 * np.abs(found[0]).max()


@pytest.mark.parametrize("beyond", [1e-8, 1e-7, 1e-6])
def test_a_plate_on_two_adjacent_walls_tips_about_its_diagonal(beyond) -> None:
    """A tolerance of 1e-7, which linear programs have by default, would leave that to a certificate to find."""
    supports = [{"edge": ["right", "top"], "gap": "1e-4*abs(x)", "resists": "down"}]
    with pytest.raises(NoEquilibriumError, match=r"tips about the line x \+ y = 4 through"):
        solve(model(supports, [{"force": 1.0, "at": [2 - beyond, 2 - beyond]}]))
    solve(model(supports, [{"force": 1.0, "at": [2 + beyond, 2 + beyond]}]))
