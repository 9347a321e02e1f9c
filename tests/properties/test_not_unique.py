"""Where more answers than one are right, the least is given, whatever the order of supports and the way of solving."""

import json

import numpy as np
import pytest
from models import rectangular
from scipy.optimize import LinearConstraint, minimize

import signorini
from signorini import _core, contact_problem
from signorini.contact.strategy import attempts
from signorini.discretise.quadrature import area_quadrature
from signorini.output import results_json

CORNERS = [[0, 0], [4, 0], [4, 3], [0, 3]]
INSIDE = [3.13, 2.37]
ON_ONE_SIDE = [[0.03, 0], [0.15, 0], [0.27, 0], [0.48, 0]]
SLANTED = [[0.3, 0.2], [3.6, 2.7]]
WEIGHT = [{"pressure": 5e3}]
BALANCED = [{"force": 2e4, "at": CORNERS}, {"force": -8e4, "at": [2, 1.5]}]
ON_A_DIAGONAL = [{"force": 3e4, "at": [[0.5, 0.375], [3.5, 2.625]]}, {"force": 1e4, "at": [2, 1.5]}]


def down(at, **more):
    return {"at": at, "resists": "down", **more}


def up(at, **more):
    return {"at": at, "resists": "up", **more}


REACTIONS = {
    "bearings at one node": [down(CORNERS), down([4, 3]), down([4, 3])],
    "bearings at one place between nodes": [down(CORNERS), down(INSIDE), down([INSIDE, [1.1, 1.7]])],
    "bearings that settle together": [down(CORNERS), *2 * [down(INSIDE, settlement=-2e-3)]],
    "a bearing, an anchor and a pin": [down(CORNERS), down(INSIDE), up(INSIDE), {"at": INSIDE}],
    "pins at one place between nodes": [down(CORNERS), *3 * [{"at": INSIDE}]],
    "pins at one node": [down(CORNERS), *3 * [{"at": [2.5, 1]}]],
    "four pins on the side of one element": [{"at": ON_ONE_SIDE}, down(CORNERS[1:])],
    "four bearings of two supports on the side of one element": [
        down(ON_ONE_SIDE[::2]),
        down(ON_ONE_SIDE[1::2]),
        down(CORNERS[2:]),
    ],
    "an edge twice and a bearing on it": [*2 * [{"edge": ["left", "right"], "resists": "down"}], down([0, 1.5])],
    "a slanted line twice": [down(CORNERS), *2 * [{"line": SLANTED, "resists": "down", "settlement": -1e-3}]],
    "an area twice": 2 * [{"area": {"rectangle": [1, 0.7, 3.1, 2.3]}, "resists": "down"}],
    "a held edge twice and a pin on it": [*2 * [{"edge": "left", "fix": "simple"}], {"at": [0, 1.5]}, down([4, 1.5])],
}
MOTIONS = {
    "stops far above and below": ([{"at": CORNERS, "gap": 0.5}], BALANCED),
    "a floor, and stops far above": ([down(CORNERS), up(CORNERS, gap=0.5)], BALANCED),
    "a floor that has settled": ([down(CORNERS, settlement=0.1), up(CORNERS, settlement=0.04)], BALANCED),
    "stops at other heights": ([down(CORNERS[:2]), up(CORNERS[1:], settlement="-1e-3*x")], BALANCED),
    "three on a diagonal, two beside it": (
        [down([CORNERS[0], CORNERS[2], [2, 1.5]]), down([[4, 0], [0, 3]], gap=0.2)],
        ON_A_DIAGONAL,
    ),
    "an elastic bed that has settled": ([{"area": "all", "resists": "down", "stiffness": 1e6, "gap": 0.01}], BALANCED),
    "no load between stops": ([{"at": CORNERS, "gap": "1e-3*(1+x)"}], [{"force": 0.0, "at": [1, 1]}]),
}
CASES = {name: (support, WEIGHT) for name, support in REACTIONS.items()} | MOTIONS
PRESSED = "four bearings of two supports on the side of one element"
CASES[PRESSED] = REACTIONS[PRESSED], [{"pressure": 5e5, "area": {"rectangle": [0, 0, 0.5, 0.2]}}]


def model_of(support, load, **more):
    named = [{"name": f"{number}", **one} for number, one in enumerate(support)]
    return rectangular(size=[4, 3], divisions=[8, 6], support=named, load=load, **more)


def turned_round(support):
    """The same supports in another order, and the points of each."""
    turned = [{**one, "name": f"{number}"} for number, one in enumerate(support)][::-1]
    several = [one for one in turned if np.ndim(one.get("at", 0)) == 2]
    for one in several:
        one["at"] = one["at"][::-1]
    return turned


def told(result):
    """Reactions by support and place, and the deflection, in one array."""
    points = sorted(
        (support.name, *at, reaction, gap, float(closed))
        for support in result.supports
        for at, reaction, gap, closed in zip(
            support.positions.round(9).tolist(), support.reactions, support.gaps, support.closed, strict=True
        )
    )
    return np.array([point[1:] for point in points]), result.deflection


def assert_same(found, wanted):
    ours, theirs = told(found), told(wanted)
    force, length = (np.abs(theirs[0][:, column]).max(initial=1e-6) for column in (2, 3))
    length = max(length, np.abs(theirs[1]).max())
    assert ours[0][:, 2] == pytest.approx(theirs[0][:, 2], abs=1e-9 * force)
    assert ours[0][:, 3] == pytest.approx(theirs[0][:, 3], abs=1e-9 * length)
    assert np.array_equal(ours[0][:, 4], theirs[0][:, 4])
    assert ours[1] == pytest.approx(theirs[1], abs=1e-9 * length)
    assert [one.what for one in found.not_unique] == [one.what for one in wanted.not_unique]


@pytest.mark.parametrize("case", CASES)
def test_the_order_of_supports_and_points_does_nothing(case):
    support, load = CASES[case]
    result = signorini.solve(model_of(support, load))["all"]
    (kind,) = {one.what for one in result.not_unique}
    assert kind == ("reactions" if case in REACTIONS else "deflection")
    again = signorini.solve(model_of(turned_round(support), load))["all"]
    assert_same(again, result)
    assert {frozenset(one.supports) for one in again.not_unique} == {
        frozenset(one.supports) for one in result.not_unique
    }


@pytest.mark.parametrize("case", CASES)
def test_every_way_of_solving_gives_the_same(case):
    support, load = CASES[case]
    result = signorini.solve(model_of(support, load))["all"]
    in_table = {"combinations": "table", "fields": "all"}
    table = signorini.solve(model_of(support, load, output=in_table))
    assert_same(table["all"], result)
    assert table.combined.not_unique == 1
    total = np.array([table.envelope[f"reaction:{one.name}"].max for one in result.supports])
    size = np.abs(total).max(initial=1.0)
    assert total == pytest.approx([one.reaction for one in result.supports], abs=1e-9 * size)
    for method in ("lemke", "active_set"):
        assert_same(signorini.solve(model_of(support, load, solver={"method": method}))["all"], result)
    model = model_of(support, [{**one, "case": "Q"} for one in load], combination=[{"factors": {"Q": 1.0}}])
    answer = contact_problem(model).solve(signorini.discretise.discretise(model).cases["Q"])
    if answer.status == "solved":
        assert answer.not_unique == result.not_unique
        assert answer.hi[::3] == pytest.approx(result.deflection, abs=1e-9 * np.abs(result.deflection).max())


@pytest.mark.parametrize("case", [*REACTIONS, "three on a diagonal, two beside it"])
def test_a_load_path_passes_through_the_same(case):
    support, load = CASES[case]
    found = signorini.path(model_of(turned_round(support), load), start=None, add="load", until=1.0)
    result = signorini.solve(model_of(support, load))["all"]
    assert_same(found.at(1.0), result)
    by_name = dict(zip([one.name for one in found.model.support], found.stops[-1].reactions, strict=True))
    size = max(map(abs, by_name.values()))
    assert by_name == pytest.approx({one.name: one.reaction for one in result.supports}, abs=1e-9 * size)
    assert found.stops[-1].largest == pytest.approx(result.deflection.max(), rel=1e-9)


def least_reactions(problem, answer):
    """Least Σ λ² over weights with Gᵀλ, the forces on every node, as it is; by a general solver."""
    found = problem.discretisation
    points = found.points
    at_holds = np.zeros((0, found.dof_count))
    if len(found.held.nodes):
        at_holds = np.eye(found.dof_count)[3 * found.held.nodes]
    rows = np.vstack([points.rows.matrix(found.mesh.elements, found.dof_count).toarray(), at_holds])
    imbalance = problem.discretisation.plate.residual(found.springs.arrays, problem.load("all"), answer.hi, answer.lo)
    force = rows.T @ np.concatenate([answer.shared, np.zeros(len(at_holds))])
    force[found.held.dofs] = imbalance[found.held.dofs]
    touching = np.append(answer.gap, np.zeros(len(found.repeated))) < 1e-12
    power = np.array([{"at": 0, "area": 2}.get(one.place, 1) for one in found.model.support])
    weights = points.weights / np.sqrt(found.mesh.element_area.sum()) ** power[points.support]
    weights = np.append(weights, np.ones(len(at_holds)))
    lowest = np.where(points.two_sided, -np.inf, 0.0)
    highest = np.where(touching, np.inf, 0.0)
    bounds = [*zip(lowest, highest, strict=True), *[(None, None)] * len(at_holds)]
    size = np.abs(force).max()
    basis = np.linalg.svd(rows[:, (rows != 0).any(axis=0)], full_matrices=False)
    rank = int((basis[1] > 1e-12).sum())
    equations = (basis[0][:, :rank] * basis[1][:rank]).T
    wanted = basis[2][:rank] @ force[(rows != 0).any(axis=0)] / size
    start = np.linalg.lstsq(equations, wanted, rcond=None)[0]
    best = minimize(
        lambda x: 0.5 * (x**2 / weights).sum(),
        np.clip(start, [low if low is not None else -np.inf for low, _ in bounds], None),
        jac=lambda x: x / weights,
        constraints={"type": "eq", "fun": lambda x: equations @ x - wanted, "jac": lambda x: equations},
        bounds=bounds,
        method="SLSQP",
        options={"ftol": 1e-16, "maxiter": 1000},
    )
    return size * best.x[: len(points)]


SMALL = [case for case in REACTIONS if "area" not in case and "edge twice" not in case and "slanted" not in case]


@pytest.mark.parametrize("case", SMALL)
def test_reactions_are_the_least_that_a_general_solver_finds(case):
    problem = contact_problem(model_of(*CASES[case], solver={"method": "active_set"}))
    load = problem.discretisation.cases["load"]
    # Not every way settles on supports that repeat each other exactly.
    answers = (attempt.solve(load) for attempt in attempts(problem))
    answer = next(answer for answer in answers if answer.status == "solved")
    if not len(answer.shared):
        pytest.skip("nodes alone are held")
    wanted = least_reactions(problem, answer)
    assert answer.shared == pytest.approx(wanted, abs=2e-6 * np.abs(wanted).max())


@pytest.mark.parametrize("case", MOTIONS)
def test_the_deflection_is_the_least_that_a_general_solver_finds(case):
    """Least ∫ w² over rigid motions that leave the plate in equilibrium on the same reactions."""
    problem = contact_problem(model_of(*CASES[case]))
    found = problem.discretisation
    answer = problem.solve(found.cases["load"])
    over = area_quadrature(found.mesh)
    values, _ = _core.serendipity(over.xi)
    deflection = answer.hi[::3]
    unit = max(np.abs(deflection).max(), 1e-6 * problem.gaps.max())
    at = np.einsum("qi,qi->q", values, deflection[found.mesh.elements[over.elements]]) / unit
    ways = np.column_stack([np.ones(len(at)), over.positions - found.middle])
    moves = problem.G @ found.rigid_motions
    pushing = answer.reaction > 1e-9 * max(np.abs(answer.reaction).max(), np.abs(problem.load("all")).max())
    room = (problem.gaps - problem.G @ (answer.hi + answer.lo)) / unit
    best = minimize(
        lambda y: 0.5 * (over.weights * (at + ways @ y) ** 2).sum(),
        np.zeros(3),
        jac=lambda y: ways.T @ (over.weights * (at + ways @ y)),
        constraints=[
            LinearConstraint(moves, np.where(pushing, 0.0, -np.inf), np.where(pushing, 0.0, np.maximum(room, 0.0)))
        ],
        method="SLSQP",
        options={"ftol": 1e-15, "maxiter": 500},
    )
    # No other motion reduces the integral.
    assert np.abs(ways @ best.x).max() < 1e-5


@pytest.mark.parametrize(
    ("length", "force", "method"), [(1, 1, "auto"), (37.3, 1e7, "auto"), (1e3, 1e-3, "active_set")]
)
def test_rounding_does_not_turn_a_plate_up_to_its_stops(length, force, method):
    """A curvature has no resultant, but its forces leave 1e-10 of themselves in the stops."""
    tables = {
        "material": {"E": 3e10 * force / length**2, "nu": 0.2},
        "plate": {"shape": "rectangle", "size": [10 * length, 10 * length], "thickness": 0.05 * length},
        "mesh": {"divisions": [8, 8]},
        "support": [
            {"at": [[7.3206 * length, 5 * length], [5 * length, 3.2138 * length]]},
            {"edge": ["left", "right", "top", "bottom"], "resists": "down", "gap": 6.5e-3 * length},
        ],
        "load": [{"curvature": [1e-5 / length, 0, 0]}],
        "solver": {"method": method},
    }
    result = signorini.solve(signorini.validate(tables))["all"]
    assert result.deflection.max() / length == pytest.approx(1.7728e-4, rel=1e-3)
    assert [choice.what for choice in result.not_unique] == ["deflection"]


@pytest.mark.parametrize("apart", [2.01e-2, 1e-10])
def test_supports_that_nearly_repeat_each_other_have_one_answer(apart):
    near = [INSIDE[0] + apart, INSIDE[1]]
    result = signorini.solve(model_of([down(CORNERS), down(INSIDE), down(near)], WEIGHT))["all"]
    assert result.certificate.passed and not result.not_unique


def test_a_gap_that_differs_tells_bearings_at_one_place_apart():
    first, second = down(INSIDE), down(INSIDE, gap=1e-6)
    for support in ([first, second], [second, first]):
        result = signorini.solve(model_of([down(CORNERS), *support], WEIGHT))["all"]
        assert not result.not_unique
        assert sorted(one.reaction for one in result.supports[1:])[0] == 0.0


def test_ordinary_supports_have_one_answer():
    for support in (
        [{"edge": edge, "fix": "simple"} for edge in ("left", "right", "bottom", "top")],
        [down(CORNERS), {"at": INSIDE, "gap": 1e-3}],
        [{"edge": ["left", "right", "bottom", "top"], "resists": "down"}],
        [{"line": SLANTED}, down(CORNERS)],
    ):
        assert signorini.solve(model_of(support, WEIGHT))["all"].not_unique == ()


def test_a_corner_is_shared_by_the_edges_that_meet_there():
    edges = [{"edge": edge, "fix": "simple"} for edge in ("left", "right", "bottom", "top")]
    result = signorini.solve(model_of(edges, WEIGHT))["all"]
    left, right, bottom, top = (one.reaction for one in result.supports)
    assert (left, bottom) == pytest.approx((right, top), rel=1e-9)


def test_a_finer_line_shares_with_its_double_alike():
    """Forces count over the lengths they stand for, so that a share does not hang on the mesh."""
    lines = [{"edge": "left", "resists": "down"}, {"line": [[0, 0], [0, 3]], "resists": "down"}]
    result = signorini.solve(model_of([*lines, down(CORNERS[1:3])], WEIGHT))["all"]
    first, second = result.supports[:2]
    assert first.reactions == pytest.approx(second.reactions, rel=1e-9)


def test_results_say_what_is_not_unique():
    results = signorini.solve(model_of([down(CORNERS), down([4, 3])], WEIGHT))
    (found,) = results_json(results)["combinations"]
    assert found["not_unique"] == [{"what": "reactions", "supports": ["0", "1"], "motion": ""}]
    results = signorini.solve(model_of(*MOTIONS["three on a diagonal, two beside it"]))
    (found,) = results_json(results)["combinations"]
    (said,) = json.loads(json.dumps(found["not_unique"]))
    assert said["what"] == "deflection" and said["motion"].startswith("turning about the line through [2, 1.5]")


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_a_plate_on_four_legs_far_below_its_ceiling_rests_on_all_of_them(method):
    # One of four legs carries only rounding, and the ceiling is half a million deflections away.
    legs = {"name": "legs", "at": [[1, 1], [9, 1], [9, 9], [1, 9]], "resists": "down"}
    model = rectangular(
        size=[10, 10],
        thickness=0.3,
        divisions=[2, 5],
        support=[legs, {"name": "ceiling", "at": [[5, 5], [1, 5]], "resists": "up", "gap": 0.5}],
        load=[{"force": 1e3, "at": [2, 5]}, {"force": -2e3, "at": [5, 5]}, {"force": 1e3, "at": [8, 5]}],
        solver={"method": method},
    )
    result = signorini.solve(model)["all"]
    assert result.supports[0].gaps == pytest.approx(np.zeros(4), abs=1e-9 * np.abs(result.deflection).max())


@pytest.mark.parametrize("fix", ["simple", "hard", "clamped"])
@pytest.mark.parametrize("element", ["mitc9", "q8r"])
def test_rigid_points_that_repeat_each_other_beside_a_held_edge_lose_none_of_the_load(fix, element):
    # With held nodes at the edge, three points have two independent rows; at held nodes each has its own part.
    model = signorini.Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3, "element": element},
        mesh={"divisions": [2, 2]},
        support=[
            {"name": "wall", "edge": "bottom", "fix": fix},
            {"name": "piers", "at": [[5, 1], [5, 2], [5, 3]]},
        ],
        load=[{"force": 1e4, "at": [3, 4]}],
        combination=[{"name": f"c{k}", "factors": {"load": 1.0 + k}} for k in range(13)],
        output={"combinations": "table", "fields": "all"},
    )
    for k, result in enumerate(signorini.solve(model).values()):
        assert sum(result.reactions.values()) == pytest.approx(1e4 * (1 + k), rel=1e-9)
        assert result.nodal_reaction.sum() == pytest.approx(1e4 * (1 + k), rel=1e-9)
    followed = signorini.path(model, None, "load", until=1.0)
    assert sum(followed.at(0.5).reactions.values()) == pytest.approx(5e3, rel=1e-9)
    assert followed.stops[-1].reactions.sum() == pytest.approx(1e4, rel=1e-9)
