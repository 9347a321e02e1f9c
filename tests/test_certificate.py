"""Faults planted in right answers, which the certificate has to find; and right answers that it must not refuse."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from models import rectangular

import signorini
from signorini import InputError, Model, solve
from signorini import path as follow
from signorini.contact.certificate import Certificate, certify
from signorini.contact.problem import contact_problem
from signorini.discretise import CaseLoad, Discretisation

CORNERS = [[0.5, 0.5], [3.5, 0.4], [3.3, 3.6], [0.4, 3.2]]
PUSH = [{"pressure": 5.0}, {"force": 30.0, "at": [0.7, 0.9]}]


@dataclass
class Answer:
    """An answer that may be tampered with."""

    found: Discretisation
    load: CaseLoad
    hi: np.ndarray
    lo: np.ndarray
    reaction: np.ndarray

    def judged(self) -> Certificate:
        return certify(self.found, self.load, self.hi, self.lo, self.reaction)


def model(supports, loads=PUSH, scale=1.0, **more) -> Model:
    """A plate of 4 by 4 metres, in a unit of length given per metre; kN."""
    return rectangular(
        material={"E": 30e6 / scale**2, "nu": 0.2},
        size=[4 * scale, 4 * scale],
        thickness=0.2 * scale,
        divisions=[6, 6],
        support=supports,
        load=loads,
        **more,
    )


def answer(supports, loads=PUSH, **more) -> Answer:
    problem = contact_problem(model(supports, loads, **more))
    found = problem.discretisation
    load = found.cases["load"]
    solved = problem.solve(load)
    assert solved.status == "solved"
    return Answer(found, load, solved.hi.copy(), solved.lo.copy(), solved.reaction.copy())


MODELS = {
    "bearings": [{"at": CORNERS, "resists": "down"}],
    "bearings and a gap": [{"at": CORNERS, "resists": "down"}, {"at": [2.0, 2.0], "resists": "down", "gap": 1e-4}],
    "wall and prop": [{"edge": "left", "fix": "clamped"}, {"at": [[3.5, 1.0], [3.5, 3.0]], "resists": "down"}],
    "soil": [{"area": "all", "resists": "down", "stiffness": 3e4}],
    "wall on its line": [{"line": [[0.3, 1.1], [3.7, 1.7]], "resists": "down"}, {"edge": "top", "fix": "simple"}],
}


@pytest.fixture(params=MODELS.values(), ids=MODELS)
def right(request) -> Answer:
    return answer(request.param)


def largest(values) -> int:
    return int(np.abs(values).argmax())


def test_a_right_answer_passes(right: Answer) -> None:
    assert right.judged().passed


def flip(right: Answer) -> None:
    right.reaction[largest(right.reaction)] *= -1


def drop(right: Answer) -> None:
    right.reaction[largest(right.reaction)] = 0.0


def exchange(right: Answer) -> None:
    order = np.argsort(right.reaction)
    right.reaction[order[[-1, 0]]] = right.reaction[order[[0, -1]]]


def round_to_single_precision(right: Answer) -> None:
    right.hi, right.lo = right.hi.astype(np.float32).astype(float), np.zeros_like(right.lo)


def load_more(right: Answer) -> None:
    right.load = (1 + 1e-6) * right.load


@pytest.mark.parametrize(
    ("spoil", "least"),
    [
        (flip, {"tension": 1e-5, "equilibrium": 1e-5}),
        (drop, {"balance": 1e-4}),
        (exchange, {}),
        (round_to_single_precision, {}),
        (load_more, {"equilibrium": 1e-8, "balance": 1e-8}),
    ],
)
def test_a_fault_planted_in_a_right_answer_is_found(right: Answer, spoil, least) -> None:
    spoil(right)
    judged = right.judged()
    assert not judged.passed and all(getattr(judged, name) > value for name, value in least.items())


@pytest.mark.parametrize("dof", [0, 1, 2])
def test_a_field_perturbed_at_one_node_by_a_millionth(right: Answer, dof: int) -> None:
    free = ~right.found.held.dofs.reshape(-1, 3)[:, dof]
    node = int(np.flatnonzero(free)[40])
    right.hi[3 * node + dof] += 1e-6 * np.abs(right.hi[dof::3]).max()
    judged = right.judged()
    assert not judged.passed and judged.equilibrium > 1e-7


@pytest.mark.parametrize("motion", [0, 1, 2])
def test_a_rigid_motion_added(right: Answer, motion: int) -> None:
    """Forces do not show it; the supports' gaps do."""
    moved = right.found.rigid_motions[:, motion]
    right.hi += 1e-6 * np.abs(right.hi[::3]).max() / np.abs(moved[::3]).max() * moved
    judged = right.judged()
    assert not judged.passed and max(judged.penetration, judged.complementarity) > 1e-8


@pytest.mark.parametrize("where", ["hi", "lo", "reaction"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_number_that_is_none(right: Answer, where: str, value: float) -> None:
    for index in (0, 1, len(getattr(right, where)) - 1):
        spoilt = Answer(right.found, right.load, right.hi.copy(), right.lo.copy(), right.reaction.copy())
        getattr(spoilt, where)[index] = value
        assert not spoilt.judged().passed


def test_a_point_closed_that_ought_to_open() -> None:
    """On two-sided bearings one of them pulls; that answer is wrong for bearings that only push."""
    load = [{"pressure": 1.0}, {"force": 40.0, "at": [0.1, 0.1]}]
    asked = answer(MODELS["bearings"], load)
    held = answer([{"at": CORNERS, "resists": "both"}], load)
    assert held.reaction.min() < 0
    asked.hi, asked.lo, asked.reaction = held.hi, held.lo, held.reaction
    judged = asked.judged()
    assert not judged.passed and judged.tension > 0.01 and judged.equilibrium < 1e-8


def test_a_point_open_that_ought_to_close() -> None:
    asked = answer(MODELS["bearings and a gap"])
    missed = answer([{"at": CORNERS, "resists": "down"}])
    asked.hi, asked.lo = missed.hi, missed.lo
    asked.reaction = np.append(missed.reaction, 0.0)
    judged = asked.judged()
    assert not judged.passed and judged.penetration > 0.01 and judged.equilibrium < 1e-8


def test_a_reaction_across_a_small_gap() -> None:
    """A small force over a small gap: neither is large, nor is their product."""
    asked = answer([{"at": CORNERS, "resists": "both"}, {"at": [2.0, 2.0], "resists": "down", "gap": 1.0}])
    held = answer([{"at": CORNERS, "resists": "both"}, {"at": [2.0, 2.0], "resists": "down", "stiffness": 0.1}])
    asked.hi, asked.lo, asked.reaction = held.hi, held.lo, held.reaction
    distance = np.append(asked.found.contacts.distance[:-1], 1.0001 * held.hi.max())
    asked.found = replace(asked.found, contacts=replace(asked.found.contacts, distance=distance))
    judged = asked.judged()
    assert 0 < held.reaction[-1] < 1e-4 * held.reaction.max()
    assert not judged.passed and judged.complementarity > 1e-7


@pytest.mark.parametrize("scale", [1.0, 1e3], ids=["metres", "millimetres"])
def test_a_clamped_slope_that_gives_way(scale: float) -> None:
    wall = {"edge": "left", "fix": "clamped"}
    right = answer([wall], [{"pressure": 5.0 / scale**2}], scale=scale)
    assert right.judged().passed
    slopes = np.flatnonzero(right.found.held.dofs.reshape(-1, 3)[:, 1])
    # A rotation about the wall is rigid: all forces balance, and the wall does not deflect.
    turn = right.found.rigid_motions[:, 1] + 2 * scale * right.found.rigid_motions[:, 0]
    right.hi += 1e-6 * np.abs(right.hi[1::3]).max() * turn
    assert len(slopes) and np.abs(right.hi[3 * slopes]).max() < 1e-15 * np.abs(right.hi).max()
    judged = right.judged()
    assert not judged.passed and judged.penetration > 1e-7


def test_a_stop_far_away_excuses_nothing() -> None:
    right = answer([*MODELS["bearings"], {"at": [2.0, 2.0], "resists": "both", "gap": 1e6}])
    assert right.judged().passed
    right.hi[::3] += 1e-3 * np.abs(right.hi[::3]).max()
    judged = right.judged()
    assert not judged.passed and judged.penetration > 1e-4


@pytest.mark.parametrize("loads", [[{"moment": [3.0, -2.0], "at": [1.3, 2.2]}], [{"curvature": [1e-3, 0.0, 2e-4]}]])
def test_loads_without_a_force_are_judged_too(loads) -> None:
    right = answer([{"edge": "left", "fix": "simple"}, {"at": CORNERS[1], "resists": "both"}], loads)
    assert right.judged().passed
    right.reaction *= 2.0
    right.hi *= 1 + 1e-3
    judged = right.judged()
    assert not judged.passed
    assert np.isfinite([judged.balance_limit, judged.equilibrium_limit]).all() and judged.balance_limit < 1e-6


@pytest.mark.parametrize(
    "supports",
    [
        [{"at": CORNERS, "resists": "down", "gap": 1e-4}],
        [{"at": CORNERS, "resists": "down", "settlement": "1e-4*x"}],
        [{"area": "all", "resists": "down", "stiffness": 3e4, "gap": "1e-4*x"}, {"at": CORNERS[:3], "fix": "clamped"}],
        [{"at": CORNERS[:2], "resists": "both", "gap": "1e-4*x"}, {"line": CORNERS[2:], "resists": "down"}],
        [{"edge": "left", "fix": "simple", "settlement": 1e-3}, {"at": CORNERS[1], "resists": "down"}],
    ],
)
def test_where_nothing_pushes_rounding_is_no_fault(supports) -> None:
    assert answer(supports, [{"pressure": 0.0}]).judged().passed


def test_supports_that_push_against_each_other_are_judged_by_the_rounding_of_their_forces() -> None:
    near = [{"at": [[2.0, 2.0]], "resists": "both"}, {"at": [[2.021, 2.0]], "resists": "both", "settlement": 0.02}]
    right = answer([*MODELS["wall and prop"], *near], loads=[{"pressure": 1e-6}])
    judged = right.judged()
    assert judged.passed and judged.limited and np.abs(right.reaction).max() > 1e9 * np.abs(right.load.nodal).max()
    right.reaction[largest(right.reaction)] *= 1 + 1e-12
    assert not right.judged().passed


def test_loads_that_cancel_leave_none() -> None:
    """A floating plate: the rounding of its weight and of the water's pressure must not move it."""
    right = answer(MODELS["bearings"], [{"pressure": 0.3}, {"pressure": -0.1}, {"pressure": -0.2}])
    assert not right.load.nodal.any() and not right.reaction.any() and right.judged().passed


STIFF_BED = [{"name": "bed", "at": CORNERS, "resists": "both", "stiffness": 1.5e14}]
"""Each spring gives by less than the rounding of the nodes around it."""


def test_forces_of_stiff_springs_between_nodes_are_reported_as_certified(tmp_path: Path) -> None:
    result = solve(model(STIFF_BED))["all"]
    assert [result.reactions["bed"], result.supports[0].reactions.sum()] == pytest.approx([110.0] * 2, rel=1e-10)
    many = [{"name": f"c{k}", "factors": {"load": 1.0 + k}} for k in range(20)]
    solve(model(STIFF_BED, combination=many), table=tmp_path / "t.parquet")
    reactions = pq.read_table(tmp_path / "t.parquet").to_pydict()["reaction:bed"]
    assert reactions == pytest.approx([110.0 * (1 + k) for k in range(20)], rel=1e-10)
    followed = follow(model(STIFF_BED), None, "load", until=1.0)
    shown = [followed.at(1.0).reactions["bed"], *followed.stops[-1].reactions]
    assert shown == pytest.approx([110.0, 110.0], rel=1e-10)


@pytest.mark.parametrize("thickness", [1.0, 0.1, 0.01, 0.002])
@pytest.mark.parametrize("fix", ["edges", "corners"])
def test_a_mechanism_of_q8r_that_no_support_holds_has_no_answer(thickness: float, fix: str) -> None:
    # Alone, its factor may have a pivot of rounding, of either sign; the load need not work on the mechanism.
    corners = {"at": [[0, 0], [10, 0], [0, 10], [10, 10]], "resists": "down"}
    edges = {"edge": ["left", "right", "top", "bottom"], "fix": "simple"}
    plate = rectangular(
        plate={"shape": "rectangle", "size": [10, 10], "thickness": thickness, "element": "q8r"},
        divisions=[1, 1],
        support=[edges if fix == "edges" else corners],
        load=[{"pressure": 1.0}],
    )
    with pytest.raises(InputError, match=r'bends in some shapes without resistance.*"mitc9"'):
        solve(plate)


BIG = {"case": "sun", "curvature": [1e10, 3e9, 0.0]}
WEIGHT = {"case": "G", "pressure": 1e3}
PADS = {"at": [[1, 1], [3, 1], [2.1, 3.2]]}
CLAMPED_ALL_ROUND = {"edge": ["left", "right", "bottom", "top"], "fix": "clamped"}
WAVE = {"case": "wave", "pressure": "1e19*cos(pi*x/2)*cos(pi*y/2)"}


def plate_of(support, loads, **more):
    return rectangular(divisions=[8, 8], support=support, load=loads, **more)


@pytest.mark.parametrize("hiding", [BIG, WAVE], ids=["a curvature", "a pressure that balances itself"])
@pytest.mark.parametrize(
    "supports", [[PADS], [{"edge": ["left", "right"], "fix": "simple"}], [{"area": "all", "stiffness": 1e7}]]
)
def test_a_weight_lost_in_what_has_no_resultant_is_refused(supports, hiding) -> None:
    with pytest.raises(signorini.NotCertifiedError, match=r"reactions miss the load by .* lost in its rounding"):
        signorini.solve(plate_of(supports, [WEIGHT, hiding]))


@pytest.mark.parametrize("part", [0.01, 0.003])
@pytest.mark.parametrize("pads", [{"resists": "down"}, {"patch": [0.6, 0.6]}], ids=["bearings", "footprints"])
def test_reactions_miss_the_weight_by_no_more_than_the_certificate_says(pads, part) -> None:
    """Statics gives the reactions of three pads; a small curvature does not change them."""
    support, reactions = [{**PADS, **pads}], []
    for curvature in ([1e10 * part, 3e9 * part, 0.0], [0.1, 0.03, 0.0]):
        problem = contact_problem(plate_of(support, [WEIGHT, {"case": "sun", "curvature": curvature}]))
        found = problem.discretisation
        load = found.load(found.model.effective_combinations[0])
        answer = problem.solve(load)
        reactions.append((answer.reaction, certify(found, load, answer.hi, answer.lo, answer.reaction).lost))
    (found_ones, lost), (right_ones, _) = reactions
    assert 0.0 < np.abs(found_ones - right_ones).max() <= 1.1 * lost * np.abs(right_ones).max()


def test_a_table_and_a_path_refuse_a_lost_weight_as_a_solve_does() -> None:
    rows = [{"name": f"row {i}", "factors": {"G": 1.0 + i, "sun": 1.0}} for i in range(14)]
    model = plate_of([PADS], [WEIGHT, BIG], combination=rows)
    assert model.tabulated
    with pytest.raises(signorini.NotCertifiedError, match="reactions miss the load"):
        signorini.solve(model)
    bed = [{"area": "all", "resists": "down", "stiffness": 1e7}]
    with pytest.raises(signorini.NotCertifiedError):
        signorini.solve(plate_of(bed, [WEIGHT, BIG], combination=rows))
    followed = signorini.path(plate_of([{**PADS, "resists": "down"}], [WEIGHT, BIG]), "G", "sun")
    assert followed.ending == "stopped" or followed.end < 1.0
    assert followed.certificate.lost <= 1e-4


@pytest.mark.parametrize(
    ("supports", "loads"),
    [
        ([CLAMPED_ALL_ROUND], [BIG]),
        ([PADS], [BIG]),
        ([{"edge": ["left", "right"], "fix": "simple"}], [BIG, {"pressure": 0.0}]),
        ([PADS], [{"force": 1e6, "at": [1.3, 2.2]}, {"force": -1e6, "at": [1.3, 2.2]}]),
        ([PADS], [{"force": 1e6, "at": [1.3, 2.2]}, {"force": -1e6, "at": [2.3, 2.2]}]),
        ([PADS], [WAVE]),
        ([PADS], [WEIGHT, {"case": "sun", "curvature": [1e-3, 0.0, 0.0]}]),
        ([{**PADS, "resists": "down"}], [WEIGHT, {"case": "sun", "curvature": [1.0, -2.0, 0.5]}]),
    ],
)
def test_loads_without_a_resultant_lose_nothing_by_themselves(supports, loads) -> None:
    certificate = signorini.solve(plate_of(supports, loads))["all"].certificate
    assert certificate.passed and certificate.lost < 1e-8
