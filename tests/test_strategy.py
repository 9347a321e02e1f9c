"""The order in which a load's answer is sought: nothing twice, all of it watched, nothing that memory does not hold."""

import numpy as np
import pytest
from models import rectangular

import signorini
from signorini import InputError, Model, _core
from signorini.base.memory import needed, needed_by_interior_point
from signorini.contact.budget import Budget, BudgetSpent
from signorini.contact.certificate import certify
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.contact.strategy import answered, attempts, methods_along
from signorini.discretise import discretise
from signorini.shapes import Ring

CLAMPED = {"edge": "left", "fix": "clamped"}
PROPS = {"at": [[4, 0], [4, 3]], "resists": "down"}
BETWEEN = {"at": [3.13, 2.37], "resists": "down"}
BED = {"area": "all", "resists": "down", "stiffness": 2e7, "gap": "1e-4*x"}
EVERY_METHOD = ("lemke", "active_set", "saddle", "interior_point")
PRESCRIBED = ("lemke", "active_set", "interior_point")


def plate(*supports: dict[str, object], method: str = "auto", **more: object) -> Model:
    return rectangular(
        size=[4, 3],
        divisions=[8, 6],
        support=list(supports),
        load=[{"pressure": 5e3}, {"force": 4e5, "at": [3.8, 0.2]}],
        solver={"method": method},
        **more,
    )


@pytest.fixture
def factored(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Factorizations so far, and for which method each was."""
    made: list[str] = []
    core = _core.ContactProblem

    def counted(*given, **room):
        made.append(given[-1])
        return core(*given, **room)

    monkeypatch.setattr(_core, "ContactProblem", counted)
    return made


def test_a_problem_is_factored_once_for_each_method(factored: list[str]) -> None:
    problem = contact_problem(plate(CLAMPED, PROPS, method="lemke"))
    assert problem.by("lemke") is problem
    load = problem.discretisation.cases["load"]
    problem.lcp(load.nodal, "dual"), problem.dual(load.nodal)
    problem.by("interior_point").solve(load)
    assert factored == ["lemke"]
    for other in (problem.by("active_set"), problem.by("lemke").by("active_set").by("lemke").by("active_set")):
        other.solve(load)
    assert factored == ["lemke", "active_set"]


@pytest.mark.parametrize(
    "supports", [(CLAMPED, PROPS), (CLAMPED, BETWEEN), (PROPS, BETWEEN, {"edge": "left"}), (BED,), (CLAMPED,)]
)
def test_the_better_form_is_the_one_that_the_core_takes(supports: tuple[dict[str, object], ...]) -> None:
    problem = contact_problem(plate(*supports, method="lemke"))
    load, held = problem.load("all"), problem.discretisation.held.values
    for ours, theirs in zip(problem.lcp(load), problem.core.lcp(load, held), strict=True):
        assert np.array_equal(ours, theirs)


@pytest.mark.parametrize("method", PRESCRIBED)
@pytest.mark.parametrize("supports", [(CLAMPED, PROPS), (CLAMPED, PROPS, BETWEEN, BED), (CLAMPED,)])
def test_nothing_is_tried_twice(
    supports: tuple[dict[str, object], ...], method: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every answer is that of a larger load, so that none is certified."""
    tried: list[tuple[object, ...]] = []
    solve = ContactProblem.solve

    def plain(self: ContactProblem, load, form, *others):
        tried.append((self.method, form))
        return solve(self, 1.01 * load, form, *others)

    problem = contact_problem(plate(*supports, method=method))
    monkeypatch.setattr(ContactProblem, "solve", plain)
    found = answered(problem, problem.discretisation.cases["load"])
    assert not found.passed and len(set(tried)) == len(tried)
    one_sided = len(supports) > 1
    assert set(found.methods) == set(EVERY_METHOD)
    other = {"dual": "stiffness", "stiffness": "dual"}[problem.better_form]
    forms = [form for by, form in tried if by == "lemke"]
    assert forms == ([problem.better_form, other] if one_sided else [problem.better_form])


@pytest.mark.parametrize("method", PRESCRIBED)
def test_every_attempt_is_watched(method: str) -> None:
    """Lemke's algorithm tells of every 64 pivots."""

    class Enough(Exception):
        """What a watcher raises."""

    def enough(*now: float) -> None:
        raise Enough

    problem = contact_problem(plate(CLAMPED, PROPS, BED, method=method))
    load = problem.discretisation.cases["load"]
    for attempt in attempts(problem):
        if attempt.form != "auto" and attempt.solve(load).pivots < 64:
            continue
        with pytest.raises(Enough):
            attempt.solve(load, enough)


def test_a_rigid_circle_that_the_mesh_follows_in_part_is_answered_at_once() -> None:
    """Where it touches the edge the mesh leaves it; more points than dofs along the rest would repeat each other."""
    model = rectangular(
        size=[10, 7.6],
        thickness=1.2,
        mesh={"size": 0.3},
        support=[
            {"edge": ["right", "top"], "resists": "both", "stiffness": 1.7e8},
            {"circle": {"center": [2.187, 3.56], "radius": 2.187}, "resists": "down"},
        ],
        load=[{"pressure": 3.5e6}],
    )
    problem = contact_problem(model)
    found, load = problem.discretisation, problem.discretisation.cases["load"]
    circle = Ring((2.187, 3.56), 2.187)
    assert found.mesh.edges_along(circle) is None and len(found.mesh.sides_on(circle)) > 20
    answer = next(attempts(problem)).solve(load)
    assert answer.status == "solved" and certify(found, load, answer.hi, answer.lo, answer.reaction).passed


def test_methods_take_over_in_their_order() -> None:
    def methods(method: str) -> list[str]:
        problem = contact_problem(plate(CLAMPED, PROPS, method=method))
        return list(dict.fromkeys(attempt.problem.method for attempt in attempts(problem)))

    assert methods("lemke") == ["lemke", "active_set", "saddle", "interior_point"]
    assert methods("active_set") == ["active_set", "lemke", "saddle", "interior_point"]
    assert methods("interior_point") == ["interior_point", "active_set", "lemke", "saddle"]


def test_a_path_is_followed_once_with_each_core() -> None:
    def methods(method: str) -> list[str]:
        return [one.method for one in methods_along(contact_problem(plate(CLAMPED, PROPS, method=method)))]

    assert methods("lemke") == ["lemke", "active_set", "saddle"]
    assert methods("active_set") == ["active_set", "lemke", "saddle"]
    assert methods("interior_point") == ["interior_point", "active_set", "saddle"]


@pytest.mark.parametrize("method", PRESCRIBED)
def test_a_load_may_begin_with_the_answer_to_another(method: str) -> None:
    problem = contact_problem(plate(CLAMPED, PROPS, BED, method=method))
    load = problem.discretisation.cases["load"]
    first = problem.solve(1.02 * load)
    plain, near = problem.solve(load), problem.solve(load, start=first)
    assert (plain.closed == near.closed).all() and near.pivots + near.iterations <= plain.pivots + plain.iterations
    assert np.abs(plain.reaction - near.reaction).max() < 1e-10 * plain.reaction.max()


def test_methods_that_take_over_end_with_their_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    """Lemke's algorithm took minutes of 3000 points of a bed beside rigid ones that nearly repeat each other."""
    problem = contact_problem(plate(CLAMPED, PROPS, BED, method="active_set"))
    load = problem.discretisation.cases["load"]
    solve = ContactProblem.solve

    def plain(self: ContactProblem, load, *others):
        return solve(self, 1.01 * load, *others)

    monkeypatch.setattr(ContactProblem, "solve", plain)
    assert answered(problem, load).methods[:2] == ("active_set", "lemke")
    monkeypatch.setattr("signorini.contact.budget._MOST", 0.0)
    alone = answered(problem, load)
    assert alone.methods == ("active_set",) and not alone.passed
    of_lemke = 2.0 * 64.0 * len(problem.gaps) ** 2
    monkeypatch.setattr("signorini.contact.budget._MOST", 3.5 * of_lemke)
    told: list[int] = []
    budget = Budget(problem.discretisation.dof_count, len(problem.gaps))
    assert budget.allows("lemke")
    watch = budget.watching("lemke", lambda step, changing, residual: told.append(step))
    with pytest.raises(BudgetSpent):
        for step in range(10):
            watch(step, 0, 1.0)
    assert told == [0, 1, 2] and not budget.allows("lemke")


def test_the_method_of_the_problem_has_no_budget(monkeypatch: pytest.MonkeyPatch) -> None:
    """From rest an active set is no other method than from the contact set of another load."""
    problem = contact_problem(plate(CLAMPED, PROPS, BED, method="active_set"))
    load = problem.discretisation.cases["load"]
    solve = ContactProblem.solve

    def plain(self: ContactProblem, load, *others):
        return solve(self, load if self.reference is None else 1.01 * load, *others)

    monkeypatch.setattr(ContactProblem, "solve", plain)
    monkeypatch.setattr("signorini.contact.budget._MOST", 0.0)
    found = answered(problem.near(load.nodal), load)
    assert found.passed and found.methods == ("active_set",)


def test_what_memory_does_not_hold_is_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = contact_problem(plate(CLAMPED, PROPS, BED, method="active_set"))
    size = problem.discretisation.dof_count, len(problem.gaps)

    def methods(free: float) -> list[str]:
        monkeypatch.setattr("signorini.base.memory.available", lambda: free)
        return list(dict.fromkeys(attempt.problem.method for attempt in attempts(problem)))

    assert methods(0.0) == ["active_set"]
    assert [other.method for other in methods_along(problem)] == ["active_set"]
    assert methods(np.inf)[:2] == ["active_set", "lemke"] and methods(np.inf)[-1] == "interior_point"
    problem.by("lemke").solve(problem.discretisation.cases["load"])
    assert methods(0.0) == ["active_set", "lemke"]
    factored = needed(len(problem.mesh.elements) + size[1] // 9)
    assert factored < needed_by_interior_point(*size)
    assert methods(factored) == ["active_set", "lemke", "saddle"]
    assert methods(needed_by_interior_point(*size)) == ["active_set", "lemke", "saddle", "interior_point"]


def test_a_method_that_was_asked_for_and_does_not_fit_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    model = plate(CLAMPED, PROPS, method="interior_point")
    found = discretise(model)
    enough = 1.01 * needed(len(found.mesh.elements))
    assert enough < needed_by_interior_point(found.dof_count, len(found.contacts))
    monkeypatch.setattr("signorini.base.memory.available", lambda: enough)
    with pytest.raises(InputError, match=r'interior point method takes .* Leave solver.method at "auto"') as caught:
        signorini.solve(model)
    assert caught.value.place == "solver.method"
