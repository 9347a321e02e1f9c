"""Preloaded bolts: joints whose parts are rigid, elastic interaction, and settlements that say the same."""

import csv
import json
from typing import Any

import numpy as np
import pytest
from models import rectangular as build
from scipy.sparse.linalg import spsolve

import signorini
from signorini import (
    InputError,
    Model,
    NoEquilibriumError,
    contact_problem,
    estimate,
    lemke,
    path,
    recover,
    solve,
    tightened,
    validate,
)
from signorini.analysis.check import check
from signorini.discretise import discretise

BED, BOLT, FORCE = 2e9, 2e8, 50e3
"""Stiffness of the bed as a whole, of each bolt, and the force to which bolts are tightened."""
PLACES = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75], [0.75, 0.75]]


def bolts(**keys: Any) -> dict[str, Any]:
    return {"name": "bolts", "at": PLACES, "resists": "up", "stiffness": BOLT, "preload": FORCE} | keys


SOIL = {"name": "bed", "area": "all", "resists": "down", "stiffness": BED}


def block(*supports: dict[str, Any], first: dict[str, Any] = SOIL, **keys: Any) -> Model:
    """A square that moves as one body, on a bed that only pushes."""
    tables: dict[str, Any] = {
        "material": {"E": 210e9, "nu": 0.3},
        "plate": {"shape": "rectangle", "size": [1, 1], "thickness": 0.1},
        "mesh": {"divisions": [4, 4], "error": False},
        "zone": [{"area": {"rectangle": [0, 0, 1, 1]}, "rigid": True}],
        "support": [first, *supports],
        "load": [{"case": "P", "pressure": -1.0}],
    }
    return validate(tables | keys)


def pulled(pull: float, **keys: Any) -> signorini.Result:
    return solve(block(bolts(**keys), load=[{"pressure": -pull}]))["all"]


def test_a_bolt_of_a_rigid_joint_gets_its_part_of_the_pull_until_the_parts_separate() -> None:
    n, separates = 4, 4 * FORCE * (4 * BOLT + BED) / BED
    for pull in (1.0, 50e3, 0.999 * separates):
        result = pulled(pull)
        each = FORCE + BOLT * pull / (n * BOLT + BED)
        assert -result.supports[1].reactions == pytest.approx(np.full(n, each), rel=1e-9)
        assert result.supports[0].reaction == pytest.approx(n * each - pull, rel=1e-9)
        assert result.supports[1].prying == pytest.approx(n * each / pull, rel=1e-9)
        assert result.supports[1].preloads == pytest.approx(np.full(n, -FORCE), rel=1e-12)
        assert result.supports[1].changes == pytest.approx(np.full(n, FORCE - each), rel=1e-5)
    beyond = pulled(1.2 * separates)
    assert -beyond.supports[1].reactions == pytest.approx(np.full(n, 0.3 * separates), rel=1e-12)
    assert beyond.supports[0].reaction == 0.0
    assert beyond.supports[1].prying == pytest.approx(1.0, rel=1e-12)


def test_a_joint_is_followed_from_its_preload_through_separation() -> None:
    found = path(block(bolts()), None, "P", until=400e3)
    separates = 4 * FORCE * (4 * BOLT + BED) / BED
    assert {one.support for one in found.support_events} == {"bed"}
    assert [one.t for one in found.support_events] == pytest.approx([separates] * 5, rel=2e-6)
    assert found.stops[0].reactions == pytest.approx([4 * FORCE, -4 * FORCE], rel=1e-12)
    assert found.stops[-1].reactions == pytest.approx([0.0, -400e3], rel=1e-12)
    exact = path(block(bolts()), None, "P", until=400e3, events="all")
    assert exact.stops[1].t == pytest.approx(separates, rel=1e-9)


def test_a_bolt_opens_where_a_load_presses_its_preload_out_of_it() -> None:
    found = path(block(bolts(), load=[{"case": "P", "pressure": 1.0}]), None, "P")
    (event, *_) = found.support_events
    assert (event.support, event.change) == ("bolts", "opens")
    assert event.t == pytest.approx(FORCE * (4 * BOLT + BED) / BOLT, rel=1e-7)
    assert np.isnan(found.at(event.t).supports[1].prying)


@pytest.mark.parametrize(
    "gives", [{"limit": 60e3}, {"stiffness": None, "law": [[0, 0], [60e3 / BOLT, 60e3], [1, 60e3]]}]
)
def test_a_bolt_yields_at_its_limit_as_the_pull_adds_to_its_preload(gives: dict[str, Any]) -> None:
    keys = {key: value for key, value in (bolts() | gives).items() if value is not None}
    found = path(block(keys), None, "P", until=235e3)
    yields = [one.t for one in found.support_events if one.change == "yields"]
    assert yields == pytest.approx([10e3 * (4 * BOLT + BED) / BOLT] * 4, rel=1e-7)
    assert found.stops[-1].reactions == pytest.approx([5e3, -240e3], rel=1e-9)


def test_bolts_tightened_in_turn_loosen_each_other_as_their_elastic_interaction_says() -> None:
    """A rigid plate in three unknowns on four feet, by a script of its own."""
    feet = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]])
    places, forces = np.array([[0.3, 0.4], [0.7, 0.5], [0.45, 0.65]]), np.array([50e3, 40e3, 60e3])
    model = block(
        *(
            {"at": at, "resists": "up", "stiffness": BOLT, "preload": force, "order": order}
            for order, (at, force) in enumerate(zip(places.tolist(), forces.tolist(), strict=True), start=1)
        ),
        load=[{"pressure": 10e3}],
        first={"name": "feet", "at": feet.tolist(), "resists": "down", "stiffness": BED / 4},
    )
    rows, down = (np.column_stack([np.ones(len(at)), at - 0.5]) for at in (places, feet))
    stiffness, rest = BED / 4 * down.T @ down, np.zeros(3)

    def settled(load: np.ndarray, count: int) -> np.ndarray:
        held = rows[:count]
        whole = stiffness + BOLT * held.T @ held
        return np.linalg.solve(whole, load + BOLT * held.T @ rest[:count])

    for turn in range(3):
        motion = settled(rows[turn] * forces[turn], turn)
        # Held up, a bolt pulls by k (rest - w).
        rest[turn] = rows[turn] @ motion + forces[turn] / BOLT
    before = BOLT * (rest - rows @ settled(rows[2] * 0.0, 3))
    after = BOLT * (rest - rows @ settled(np.array([10e3, 0.0, 0.0]), 3))
    result = solve(model)["all"]
    found = np.array([(-one.preloads[0], -one.reactions[0]) for one in result.supports[1:]]).T
    assert found[0] == pytest.approx(before, rel=1e-9)
    assert found[1] == pytest.approx(after, rel=1e-9)
    assert found[0][2] == pytest.approx(60e3, rel=1e-12)
    assert (found[0][:2] < 0.97 * forces[:2]).all()


def test_a_factor_of_the_preload_is_another_preload_and_without_one_bolts_only_stand_there() -> None:
    load = [{"case": "P", "pressure": -150e3}]
    factors = {"loose": 0.8, "tight": 1.2, "not tightened": 0.0}
    named = [{"name": name, "factors": {"P": 1, "bolts": factor}} for name, factor in factors.items()]
    named.append({"name": "unnamed", "factors": {"P": 1}})
    results = solve(block(bolts(preload_case="bolts"), load=load, combination=named))
    for name, factor in factors.items():
        own = bolts(preload=factor * FORCE) if factor else {k: v for k, v in bolts().items() if k != "preload"}
        alone = solve(block(own, load=load))["all"]
        assert results[name].deflection == pytest.approx(alone.deflection, rel=1e-12)
        assert results[name].supports[1].reactions == pytest.approx(alone.supports[1].reactions, rel=1e-10)
    assert (results["unnamed"].deflection == results["not tightened"].deflection).all()
    assert (results["unnamed"].supports[1].preloads == 0.0).all()


def plate(*supports: dict[str, Any], **keys: Any) -> Model:
    """A plate that bends, on bearings that only push."""
    bearings = {"name": "bearings", "at": [[0, 0], [4, 0], [0, 4], [4, 4], [2, 2]], "resists": "down"}
    tables = {"support": [bearings | {"stiffness": 1e7}, *supports], "load": [{"case": "G", "pressure": 5e3}]}
    return build(**{"mesh": {"divisions": [4, 4], "error": False}} | tables | keys)


ANCHORS = {"name": "anchors", "at": [[1, 1], [3, 1], [2, 3]], "resists": "up", "stiffness": 2e6, "preload": 20e3}


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_a_table_of_factors_is_its_combinations_one_by_one(method: str) -> None:
    variable = {"Q": [1.0, 1.5], "W": [-1.0, 1.0, 3.0]}
    patterns = {"permanent": {"bolts": [0.8, 1.2], "G": [1.0, 1.35]}, "variable": variable}
    model = plate(
        ANCHORS | {"preload_case": "bolts"},
        {"name": "late", "at": [2.5, 3.5], "resists": "up", "stiffness": 2e6, "preload": 10e3, "order": 2},
        load=[
            {"case": "G", "pressure": 5e3},
            {"case": "Q", "force": -60e3, "at": [2, 1]},
            {"case": "W", "pressure": -4e3, "area": {"rectangle": [0, 0, 2, 4]}},
        ],
        combination=[{"name": "ULS", "generate": "patterns", **patterns}],
        solver={"method": method},
    )
    results = solve(model)
    assert len(results) == 2 * 2 * 3 * 4 and results.combined.alone == 0
    table, catalogue = results.table, results.combined.layout.catalogue
    told = [one for one in catalogue if one.home in ("support", "point")]
    largest = {one.quantity.kind: 0.0 for one in told}
    for one in told:
        largest[one.quantity.kind] = max(largest[one.quantity.kind], float(np.abs(table[one.column]).max()))
    for row, name in enumerate(results):
        alone = (
            signorini.solve(
                validate(
                    model.model_dump(exclude_unset=True)
                    | {
                        "combination": [
                            {"name": name, "factors": dict(model.effective_combinations[row].factors or {})}
                        ]
                    }
                )
            )[name]
            if row % 7 == 0
            else results[name]
        )
        for one in told:
            wanted = alone.numbers[alone.catalogue.by_path[one.path]]
            assert abs(table[one.column][row] - wanted) <= 1e-9 * largest[one.quantity.kind], one.column
    assert set(np.round(table["preload_at:late[1]"] / 10e3, 9)) == {-1.0}
    least = results.envelope["reaction:anchors"]
    assert least.min == table["reaction:anchors"].min() == table["reaction:anchors"][least.min_by]


def random_joint(seed: int) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    """Supports under a plate, and bolts of every kind that hold it there."""
    draw = np.random.default_rng(seed)
    under = [{"name": "bed", "area": {"rectangle": [0, 0, 4, 4]}, "resists": "down", "stiffness": 4e6}]
    if seed % 2:
        under[0] |= {"limit": 60e3}
    if seed % 3 == 0:
        under.append({"name": "stop", "at": [2.0, 2.0], "resists": "down", "gap": 1e-3})
    places = draw.permutation([[x, y] for x in (0.6, 1.7, 3.3) for y in (0.5, 2.4, 3.6)])[:4]
    kinds: list[dict[str, Any]] = [
        {"resists": "up", "stiffness": 3e6},
        {"resists": "up"},
        {"resists": "both", "stiffness": 5e6, "radius": 0.1},
        {"resists": "up", "law": [[0, 0], [0.004, 15e3], [0.02, 40e3], [0.1, 40e3]]},
        {"resists": "up", "stiffness": 3e6, "limit": 30e3, "settlement": 5e-4},
    ]
    which = draw.choice(len(kinds), len(places), replace=False)
    made = [
        kinds[kind] | {"at": at.tolist(), "preload": float(draw.uniform(5e3, 25e3)), "order": int(draw.integers(1, 4))}
        for kind, at in zip(which.tolist(), places, strict=True)
    ]
    loads = [
        {"case": "G", "pressure": 2e3},
        {"case": "G", "force": float(draw.uniform(-40e3, 40e3)), "at": draw.uniform(0.5, 3.5, 2).tolist()},
    ]
    return {"support": under, "load": loads}, made


@pytest.mark.parametrize("seed", range(8))
def test_the_travel_that_tightening_finds_is_a_settlement_that_does_the_same(seed: int) -> None:
    tables, made = random_joint(seed)
    mesh = {"divisions": [6, 6], "error": False}
    tight = build(**tables | {"mesh": mesh, "support": [*tables["support"], *made]})
    problem = contact_problem(tight)
    moved, contacts = tightened(problem, "all").gaps - problem.gaps, problem.discretisation.contacts
    settled = []
    for index, bolt in enumerate(made, start=len(tables["support"])):
        (own,) = np.flatnonzero(contacts.support == index)
        settlement = bolt.get("settlement", 0.0) + contacts.direction[own] * moved[own]
        settled.append({k: v for k, v in bolt.items() if k not in ("preload", "order")} | {"settlement": settlement})
    loose = build(**tables | {"mesh": mesh, "support": [*tables["support"], *settled]})
    found, wanted = solve(tight)["all"], solve(loose)["all"]
    size = max(np.abs(one.reactions).max() for one in wanted.supports)
    assert np.abs(found.deflection - wanted.deflection).max() < 1e-9 * np.abs(wanted.deflection).max()
    for one, other in zip(found.supports, wanted.supports, strict=True):
        assert np.abs(one.reactions - other.reactions).max() < 1e-9 * size
        assert one.states == other.states
    # Without loads every bolt of the last order carries its tightening force.
    bare = build(**tables | {"mesh": mesh, "support": [*tables["support"], *made]}, combination=[{"factors": {}}])
    (rest,) = solve(bare).values()
    for bolt, support in zip(made, rest.supports[len(tables["support"]) :], strict=True):
        if "settlement" not in bolt and not any("settlement" in one for one in made):
            assert support.changes == pytest.approx([0.0], abs=1e-7 * bolt["preload"])
        if bolt["order"] == max(one["order"] for one in made):
            assert support.preloads == pytest.approx([-bolt["preload"]], rel=1e-12)


@pytest.mark.parametrize("seed", range(8, 14))
def test_tightening_is_a_sequence_of_models_with_forces_and_settlements(seed: int) -> None:
    tables, made = random_joint(seed)
    made = [{key: value for key, value in bolt.items() if key != "radius"} for bolt in made]
    mesh = {"divisions": [6, 6], "error": False}
    result = solve(build(**tables | {"mesh": mesh, "support": [*tables["support"], *made]}))["all"]
    locked: list[dict[str, Any]] = []
    for order in sorted({bolt["order"] for bolt in made}):
        now = [bolt for bolt in made if bolt["order"] == order]
        load = [{"force": bolt["preload"], "at": bolt["at"]} for bolt in now]
        stage = solve(build(mesh=mesh, load=load, support=[*tables["support"], *locked]))["all"]
        for bolt, probe in zip(now, stage.probe([bolt["at"] for bolt in now]), strict=True):
            force, stiffness = bolt["preload"], bolt.get("stiffness", np.inf)
            travel = np.interp(force, *np.transpose(bolt["law"][:3])[::-1]) if "law" in bolt else force / stiffness
            own = {key: value for key, value in bolt.items() if key not in ("preload", "order", "settlement")}
            locked.append(own | {"settlement": float(probe.deflection + travel)})
    at = [bolt["at"] for bolt in made]
    for bolt in locked:
        bolt["settlement"] += made[at.index(bolt["at"])].get("settlement", 0.0)
    final = solve(build(**tables | {"mesh": mesh, "support": [*tables["support"], *locked]}))["all"]
    size = max(np.abs(one.reactions).max() for one in final.supports)
    assert np.abs(result.deflection - final.deflection).max() < 1e-9 * np.abs(final.deflection).max()
    found = {tuple(one.positions[0].tolist()): one.reaction for one in result.supports[len(tables["support"]) :]}
    for one in final.supports[len(tables["support"]) :]:
        assert abs(found[tuple(one.positions[0].tolist())] - one.reaction) < 1e-9 * size


@pytest.mark.parametrize("method", ["lemke", "active_set"])
def test_every_method_tightens_and_solves_to_the_same(method: str) -> None:
    tables, made = random_joint(2)
    keys = tables | {"mesh": {"divisions": [4, 4], "error": False}, "support": [*tables["support"], *made]}
    wanted, found = solve(build(**keys))["all"], solve(build(**keys, solver={"method": method}))["all"]
    for one, other in zip(found.supports, wanted.supports, strict=True):
        assert one.reactions == pytest.approx(other.reactions, rel=1e-8, abs=1e-4)
        if one.preloads is not None:
            assert one.preloads == pytest.approx(other.preloads, rel=1e-8, abs=1e-4)


def test_each_mesh_tightens_its_own_bolts() -> None:
    model = plate(
        ANCHORS, {"name": "late", "at": [2.5, 3.5], "resists": "up", "stiffness": 2e6, "preload": 9e3, "order": 2}
    )
    widths = estimate(solve(model))["all"].plus_minus["supports"]
    early, late = widths[1]["points"][2], widths[2]["points"][0]
    assert late["preload"] < 1e-7 * 9e3 < early["preload"] < 0.05 * 20e3
    assert 0.0 < early["change"] < 0.05 * 20e3
    assert widths[1]["prying"] is None


def test_a_path_of_preloaded_bolts_has_half_widths_of_its_events() -> None:
    model = plate(ANCHORS, load=[{"case": "Q", "pressure": -5e3}], mesh={"divisions": [8, 8]})
    found = path(model, None, "Q", until=4.0)
    assert found.support_events
    widths = estimate(found)
    assert all(width is not None and width < 0.2 for width in widths.events)


def test_a_researcher_has_the_gaps_of_the_tightened_bolts() -> None:
    model = plate(
        ANCHORS | {"preload_case": "bolts"},
        {"edge": "left", "fix": "simple"},
        {"edge": "right", "fix": "simple"},
        combination=[{"name": "tight", "factors": {"G": 1, "bolts": 1}}, {"name": "loose", "factors": {"G": 1}}],
    )
    problem = contact_problem(model)
    moved = tightened(problem, "tight")
    assert tightened(moved, "loose") == problem and tightened(problem, "loose") is problem
    P, s = moved.dual(problem.load("tight"))
    assert (problem.dual(problem.load("tight"))[0] == P).all()
    answer = lemke(P, -s)
    result = recover(problem, "tight", answer.z)
    assert result.supports[1].reactions == pytest.approx(solve(model)["tight"].supports[1].reactions, rel=1e-9)


def test_results_tell_preload_change_and_prying(tmp_path: Any) -> None:
    model = block(bolts(), load=[{"pressure": -50e3}])
    signorini.write(solve(model), tmp_path)
    (combination,) = json.loads((tmp_path / "results.json").read_text())["combinations"]
    bed, own = combination["supports"]
    each = FORCE + BOLT * 50e3 / (4 * BOLT + BED)
    assert own["kind"] == "points, holds down only, elastic, preloaded"
    assert own["prying"] == pytest.approx(4 * each / 50e3) and "prying" not in bed
    assert own["points"][0]["preload"] == pytest.approx(-FORCE)
    assert own["points"][0]["change"] == pytest.approx(FORCE - each)
    with (tmp_path / "reactions.csv").open() as file:
        rows = {(row["support"], row["point"]): row for row in csv.DictReader(file)}
    assert float(rows["bolts", "1"]["preload"]) == pytest.approx(-FORCE)
    assert float(rows["bolts", "1"]["change"]) == pytest.approx(FORCE - each)
    pressed = solve(block(bolts(), load=[{"pressure": 50e3}]))
    signorini.write(pressed, tmp_path)
    (combination,) = json.loads((tmp_path / "results.json").read_text())["combinations"]
    assert combination["supports"][1]["prying"] is None


def test_bolts_beyond_what_they_press_on_tip_the_plate_as_they_are_tightened() -> None:
    load = [{"pressure": 1e3}]
    pads = {"name": "pads", "area": {"rectangle": [1, 1, 3, 3]}, "resists": "down", "stiffness": 1e7}
    bolt = {"name": "bolt", "at": [3.5, 2], "resists": "up", "stiffness": 1e6, "preload": 1e3}
    model = build(load=load, support=[pads, bolt])
    with pytest.raises(NoEquilibriumError, match="all: While tightening bolt: The plate tips about the line x = 3"):
        solve(model)
    (resultant,) = check(model).resultants
    assert resultant.message.startswith("While tightening bolt: The plate tips about the line x = 3")
    with pytest.raises(NoEquilibriumError, match="While tightening bolt"):
        path(model, None, "load")
    alone = build(load=load, support=[bolt | {"at": [[1, 1], [3, 1], [2, 3]], "resists": "both"}])
    with pytest.raises(InputError, match="While tightening bolt: Nothing holds the plate against this motion"):
        solve(alone)


WRONG: list[tuple[dict[str, Any], str]] = [
    ({"resists": "down"}, "support[2].preload: a support with resists = down cannot pull the plate down"),
    ({"resists": None, "stiffness": None, "fix": "simple"}, "support[2].preload: a preload is not allowed with fix"),
    (
        {"at": None, "edge": "left"},
        "support[2].preload: a preload belongs to bolts at points; use at or nodes, not edge",
    ),
    ({"gap": 1e-3}, "support[2].gap: a gap is not allowed with a preload"),
    ({"preload": 0}, "support[2].preload: found 0; it must be greater than 0"),
    ({"preload": -1e3}, "support[2].preload: found -1000; it must be greater than 0"),
    ({"preload": None, "order": 2}, "support[2].order: order needs a preload"),
    ({"preload": None, "preload_case": "B"}, "support[2].preload_case: preload_case needs a preload"),
    ({"order": 0}, "support[2].order"),
    ({"preload_case": "P"}, 'support[2].preload_case: "P" is also a case of [[load]]'),
    ({"preload_case": "C"}, 'support[2].preload_case: no combination has the case "C"'),
]


@pytest.mark.parametrize(("keys", "message"), WRONG)
def test_what_no_bolt_can_have_is_refused_with_its_place(keys: dict[str, Any], message: str) -> None:
    own = {key: value for key, value in (bolts() | keys).items() if value is not None}
    with pytest.raises(InputError) as caught:
        block(own, combination=[{"factors": {"P": 1}}])
    assert message in str(caught.value).replace(' ("bolts")', "")


BEYOND: list[tuple[dict[str, Any], float, str]] = [
    ({"limit": 40e3}, 1.0, "support[2].preload: found 50000; at [0.25, 0.25] the bolt gives 40000 at most"),
    ({"limit": "60e3 - 20e3*x"}, 1.0, "support[2].preload: found 50000; at [0.75, 0.25] the bolt gives 45000 at most"),
    ({"limit": 55e3}, 1.2, "combination[1].factors.B: found 60000, 1.2 times the preload of bolts; at [0.25, 0.25]"),
    ({"stiffness": None, "law": [[0, 0], [1e-3, 30e3], [1, 30e3]]}, 1.0, "support[2].preload: found 50000; at [0.25"),
    ({"preload": "x - 0.5"}, 1.0, "support[2].preload"),
    ({}, -0.5, 'combination[1].factors.B: found the factor -0.5 of the preload "B"; it must not be negative'),
]


@pytest.mark.parametrize(("keys", "factor", "message"), BEYOND)
def test_more_than_a_bolt_gives_is_refused_where_it_is_asked_for(
    keys: dict[str, Any], factor: float, message: str
) -> None:
    own = {key: value for key, value in (bolts(preload_case="B") | keys).items() if value is not None}
    with pytest.raises(InputError) as caught:
        discretise(block(own, combination=[{"factors": {"P": 1, "B": factor}}]))
    assert message in str(caught.value).replace(' ("bolts")', "")


def test_a_bolt_where_the_plate_is_held_is_refused() -> None:
    held = {"edge": "left", "fix": "simple"}
    for resists in ("up", "both"):
        bolt = {"at": [[2, 2], [0, 2]], "resists": resists, "preload": 1e3}
        with pytest.raises(InputError, match=r"support\[3\]\.at\[2\]: rigid supports hold the plate both ways there"):
            discretise(plate(held, bolt, {"edge": "right", "fix": "simple"}))


def test_a_load_that_changes_a_preload_does_not_grow_along_a_path() -> None:
    model = block(
        bolts(preload_case="B"),
        combination=[{"name": "tight", "factors": {"B": 1}}, {"name": "both", "factors": {"P": 1e5, "B": 1}}],
    )
    for add in ("B", "both"):
        with pytest.raises(InputError, match=f'add: "{add}" changes the preload "B"'):
            path(model, "tight", add)
    start, end = (path(model, "tight", "P", until=1e5).stops[at].reactions for at in (0, -1))
    assert start == pytest.approx([4 * FORCE, -4 * FORCE], rel=1e-12)
    assert end == pytest.approx([one.reaction for one in solve(model)["both"].supports], rel=1e-9)


STAR = [[1, 4], [2, 5], [3, 6]]
"""Six bolts on a circle, those that face each other together."""


def flange(rounds: list[dict[str, Any]], **bolt: Any) -> Model:
    """A blind flange on a ring with a gasket between, in N and mm; bolts on a circle of 160."""
    ring = {"shape": "annulus", "inner": 103.25, "outer": 187.5, "thickness": 34, "mesh": {"size": 60}}
    turn = np.arange(6) * np.pi / 3
    named = {"bolts": 1} if "preload_case" in bolt or any("case" in one for one in rounds) else {}
    bolts = {
        "name": "bolts",
        "between": ["blind", "ring"],
        "at": (160 * np.column_stack([np.cos(turn), np.sin(turn)])).tolist(),
        "radius": 20,
        "resists": "up",
        "stiffness": 1e6,
    }
    return validate(
        {
            "material": {"E": 205e3, "nu": 0.3},
            "mesh": {"error": False},
            "plates": {
                "blind": {"shape": "disc", "radius": 187.5, "thickness": 36, "mesh": {"size": 60}},
                "ring": ring,
            },
            "contact": [
                {
                    "name": "gasket",
                    "between": ["blind", "ring"],
                    "area": {"annulus": {"inner": 110, "outer": 140}},
                    "stiffness": 500,
                }
            ],
            "support": [
                {"plate": "ring", "edge": "inner", "fix": "simple", "rotational_stiffness": 1e6},
                bolts | bolt,
            ],
            "tightening": rounds,
            "load": [{"case": "p", "plate": "blind", "pressure": -4, "area": {"circle": {"radius": 110}}}],
            "combination": [{"name": "tightened", "factors": named}, {"factors": {"p": 1} | named}],
        }
    )


def left_by_lengths(model: Model, turns: list[tuple[list[int], float]]) -> np.ndarray:
    """Forces that are left in the bolts, by an own solution that tracks the unstressed length of each bolt.

    K of the plates and rows G of bolts and gasket are sparse matrices; an active set says where these press.
    """
    problem = contact_problem(model)
    free = np.flatnonzero(~problem.held)
    K, G = problem.K[free][:, free], problem.G[:, free]
    k, length = 1.0 / problem.compliance, problem.gaps.copy()
    (bolts,) = np.nonzero(problem.discretisation.contacts.support == 1)
    there, closed = np.ones(len(k), np.bool_), np.ones(len(k), np.bool_)
    there[bolts] = False

    def settled(pull: np.ndarray) -> np.ndarray:
        for _ in range(50):
            on = np.flatnonzero(there & closed)
            u = spsolve((K + G[on].T @ (k[on, None] * G[on])).tocsc(), G[on].T @ (k[on] * length[on]) - G.T @ pull)
            before = closed[there]
            closed[there] = (G @ u > length)[there]
            if (closed[there] == before).all():
                return np.asarray(G @ u)
        raise AssertionError("no contact set")

    for group, force in turns:
        now = bolts[np.array(group) - 1]
        there[now], pull = False, np.zeros(len(k))
        pull[now] = force
        length[now] = settled(pull)[now] - force / k[now]
        there[now] = closed[now] = True
    return np.asarray((k * np.maximum(settled(np.zeros(len(k))) - length, 0.0))[bolts])


def test_rounds_of_tightening_leave_the_forces_of_bolts_whose_lengths_are_tracked() -> None:
    scatter = [52e3, 47e3, 50e3, 49e3, 51e3, 48e3]
    check = [{"support": "bolts", "force": 110e3, "sequence": [[6], [2]]}]
    rounds = [{"support": "bolts", "force": scatter, "sequence": STAR}, {"support": "bolts", "force": 100e3}]
    model = flange([*rounds[:1], rounds[1] | {"sequence": STAR}, *check])
    turns: list[tuple[list[int], Any]] = [(group, np.array(scatter)[np.array(group) - 1]) for group in STAR]
    wanted = left_by_lengths(model, [*turns, *((group, 100e3) for group in STAR), ([6], 110e3), ([2], 110e3)])
    own = solve(model)["tightened"].supports[1]
    assert own.preloads is not None and own.tightened_to is not None
    assert -own.preloads == pytest.approx(wanted, rel=1e-9)
    assert -own.tightened_to == pytest.approx([100e3, 110e3, 100e3, 100e3, 100e3, 110e3], rel=1e-12)
    assert own.preload == pytest.approx(-wanted.sum()) and wanted.min() < 95e3
    # All together at last, every bolt has the force of the last round.
    together = solve(flange(rounds))["tightened"].supports[1]
    assert together.preloads == pytest.approx(np.full(6, -100e3), rel=1e-12)


def test_a_round_is_what_a_preload_with_an_order_is() -> None:
    by_order = flange([], preload=[8e4, 9e4, 1e5, 7e4, 8e4, 9e4], order=[1, 2, 3, 1, 2, 3], preload_case="bolts")
    force = list(by_order.support[1].preload.source)
    by_round = flange([{"support": "bolts", "force": force, "sequence": STAR, "case": "bolts"}])
    for one, other in zip(solve(by_order).values(), solve(by_round).values(), strict=True):
        for name in ("tightened_to", "preloads", "reactions"):
            assert getattr(one.supports[1], name) == pytest.approx(getattr(other.supports[1], name), rel=1e-12)


def test_a_bolt_that_no_round_tightens_is_in_contact_without_force_when_all_are_tightened() -> None:
    model = flange([{"support": "bolts", "force": 50e3, "sequence": [[1, 4], 2]}])
    tightened_only, loaded = (one.supports[1] for one in solve(model).values())
    assert tightened_only.preloads is not None and tightened_only.tightened_to is not None
    assert tightened_only.reactions == pytest.approx(tightened_only.preloads, rel=1e-7, abs=1e-4)
    assert tightened_only.preloads[[2, 4, 5]] == pytest.approx(np.zeros(3), abs=1e-9)
    assert (tightened_only.tightened_to[[2, 4, 5]] == 0.0).all()
    assert tightened_only.gaps == pytest.approx(np.zeros(6), abs=1e-12)
    # The pressure opens the joint, and these bolts take part of it.
    assert (loaded.reactions[[2, 4, 5]] < -1e3).all()


def test_results_of_rounds_tell_each_bolt_and_the_sum_of_the_joint(tmp_path: Any) -> None:
    bare = {key: value for key, value in bolts().items() if key != "preload"}
    others = bolts(name="others", at=[0.5, 0.5])
    rounds = [{"support": "bolts", "force": [5e4, 6e4, 7e4, 8e4], "sequence": [[1, 4], [2, 3]]}]
    signorini.write(solve(block(bare, others, tightening=rounds)), tmp_path)
    (combination,) = json.loads((tmp_path / "results.json").read_text())["combinations"]
    _, own, other = combination["supports"]
    assert [one["tightened_to"] for one in own["points"]] == pytest.approx([-5e4, -6e4, -7e4, -8e4])
    assert own["preload"] == pytest.approx(sum(one["preload"] for one in own["points"]))
    (joint,) = combination["joints"]
    assert (joint["supports"], joint["bolts"]) == (["bolts", "others"], 5)
    assert joint["preload"] == pytest.approx(own["preload"] + other["preload"])
    assert joint["reaction"] == pytest.approx(own["reaction"] + other["reaction"])
    with (tmp_path / "reactions.csv").open() as file:
        rows = {row["point"]: row for row in csv.DictReader(file) if row["support"] == "bolts"}
    assert float(rows["2"]["tightened_to"]) == pytest.approx(-6e4)
    assert float(rows["total"]["preload"]) == pytest.approx(own["preload"])


def test_a_table_of_combinations_has_the_forces_of_tightening() -> None:
    rounds = [{"support": "anchors", "force": [10e3, 12e3, 14e3], "sequence": [[3], [1, 2]], "case": "bolts"}]
    bare = {key: value for key, value in ANCHORS.items() if key != "preload"}
    factors = {"permanent": {"bolts": [0.8, 1.2], "G": [1.0]}, "variable": {"Q": [1.5]}}
    model = plate(
        bare,
        load=[{"case": "G", "pressure": 5e3}, {"case": "Q", "force": -30e3, "at": [2, 1]}],
        tightening=rounds,
        combination=[{"name": "ULS", "generate": "patterns", **factors}],
        output={"combinations": "table"},
    )
    results = solve(model)
    table = results.table
    assert set(np.round(table["tightened_to_at:anchors[2]"], 6)) == {-0.8 * 12e3, -1.2 * 12e3}
    points = sum(table[f"preload_at:anchors[{number}]"] for number in (1, 2, 3))
    assert table["preload:anchors"] == pytest.approx(points)
    for row, name in enumerate(results):
        assert table["preload:anchors"][row] == pytest.approx(results[name].supports[1].preload, rel=1e-9)


def test_bolts_of_rounds_are_tightened_beyond_nothing_that_holds_the_plate() -> None:
    pads = {"name": "pads", "area": {"rectangle": [1, 1, 3, 3]}, "resists": "down", "stiffness": 1e7}
    bolt = {"name": "bolt", "at": [[2, 2], [3.5, 2]], "resists": "up", "stiffness": 1e6}
    rounds = [{"support": "bolt", "force": 1e3, "sequence": [2, 1]}]
    with pytest.raises(NoEquilibriumError, match=r"While tightening bolt\[2\]: The plate tips"):
        solve(build(load=[{"pressure": 1e3}], support=[pads, bolt], tightening=rounds))


WRONG_ROUNDS: list[tuple[dict[str, Any], dict[str, Any], str]] = [
    ({"support": "bolt"}, {}, "tightening[1].support: Unknown support 'bolt'"),
    ({}, {"preload": 1e3}, 'tightening[1].support: "bolts" has a preload'),
    ({}, {"resists": "down"}, "tightening[1].support: a support with resists = down"),
    ({}, {"gap": 1e-3}, "tightening[1].support: a gap is not allowed with a preload"),
    ({"support": "bed"}, {}, "tightening[1].support: a support with resists = down"),
    ({"force": [1e3, 2e3]}, {}, "tightening[1].force: found a list of 2 for 4 points"),
    ({"force": 0}, {}, "tightening[1].force: found 0; it must be greater than 0"),
    ({"sequence": [[1, 5]]}, {}, 'tightening[1].sequence[1]: found point 5; "bolts" has the points 1 to 4'),
    ({"sequence": [[1], [2, 1]]}, {}, "tightening[1].sequence[2]: found point 1 twice"),
    ({"sequence": [[0]]}, {}, "tightening[1].sequence"),
    ({"sequence": []}, {}, "tightening[1].sequence"),
    ({"case": "P"}, {}, 'tightening[1].case: "P" is also a case of [[load]]'),
    ({"case": "C"}, {}, 'tightening[1].case: no combination has the case "C"'),
    ({}, {"limit": 40e3}, "tightening[1].force: found 50000; at [0.25, 0.25] the bolt gives 40000 at most"),
    ({}, {"limit": [60e3, 60e3, 40e3, 60e3]}, "tightening[1].force: found 50000; at [0.25, 0.75]"),
]


@pytest.mark.parametrize(("table", "keys", "message"), WRONG_ROUNDS)
def test_a_round_that_no_bolt_can_have_is_refused_with_its_place(
    table: dict[str, Any], keys: dict[str, Any], message: str
) -> None:
    own = {key: value for key, value in (bolts(preload=None) | keys).items() if value is not None}
    rounds = [{"support": "bolts", "force": FORCE} | table]
    with pytest.raises(InputError) as caught:
        discretise(block(own, tightening=rounds, combination=[{"factors": {"P": 1}}]))
    assert message in str(caught.value)


def test_a_round_has_the_factor_of_its_case_and_is_left_out_without_one() -> None:
    rounds = [{"support": "bolts", "force": 20e3}, {"support": "bolts", "force": FORCE, "case": "second"}]
    factors = {"first only": {}, "both": {"second": 1.0}, "more": {"second": 1.2}}
    named = [{"name": name, "factors": {"P": 1} | own} for name, own in factors.items()]
    results = solve(
        block({key: value for key, value in bolts().items() if key != "preload"}, tightening=rounds, combination=named)
    )
    for name, force in {"first only": 20e3, "both": FORCE, "more": 1.2 * FORCE}.items():
        assert results[name].supports[1].preloads == pytest.approx(np.full(4, -force), rel=1e-12)
