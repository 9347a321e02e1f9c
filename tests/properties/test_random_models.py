"""Random plates: every answer is judged by dense linear algebra and by a linear program that share no code with it."""

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from signorini import InputError, Model, NoEquilibriumError, loads, solve
from signorini.contact.problem import contact_problem
from signorini.contact.strategy import answered

FEW = 7
"""Contact points whose every state is tried."""


def posed(tables, dense):
    """The problem, its load and its dense twin; None if the input is refused or supports repeat each other."""
    try:
        problem = contact_problem(Model(**tables))
    except InputError as error:
        assert str(error).endswith(".") and (error.place or all(one.place for one in error.parts))
        return None
    load = problem.discretisation.cases["load"]
    twin = dense.of(problem, load.nodal)
    return None if twin.redundant else (problem, load, twin)


@settings(max_examples=200)
@given(data=st.data())
def test_a_model_written_as_toml_is_read_as_the_same_model(data, drawing):
    model = Model(**data.draw(drawing.models()))
    assert loads(model.to_toml()) == Model(**model.model_dump()) == model


@settings(max_examples=60)
@given(data=st.data())
def test_answers_satisfy_the_conditions_or_no_reactions_exist(data, drawing, dense, equilibrium_exists):
    tables = data.draw(drawing.models())
    found = posed(tables, dense)
    assume(found is not None)
    problem, load, twin = found
    exists = equilibrium_exists(problem, load.nodal)
    try:
        result = solve(problem.discretisation.model)["all"]
    except NoEquilibriumError as error:
        assert not exists or "contradict" in str(error)
        # Past the check, Lemke's ray says the same.
        assert problem.solve(load).status == "no_equilibrium"
        return
    except InputError as error:
        # Balanced on the supports' outlines, which the mesh's points do not reach.
        assert not exists and "not at the contact points of this mesh" in str(error)
        return
    assert exists and result.certificate.passed
    answer = answered(problem, load).answer
    u = (answer.hi + answer.lo)[twin.free]
    assert max(twin.violations(u, answer.reaction).values()) < 1e-8
    assert np.array_equal(result.deflection, (answer.hi + answer.lo)[::3])


@settings(max_examples=30)
@given(data=st.data())
def test_few_points_agree_with_every_contact_state_tried(data, drawing, dense):
    tables = data.draw(drawing.models(kinds=("at",)))
    found = posed(tables, dense)
    assume(found is not None)
    problem, load, twin = found
    assume((~twin.two_sided).sum() <= FEW)
    answer = problem.solve(load)
    states = list(twin.states())
    u = (answer.hi + answer.lo)[twin.free]
    if answer.status == "solved" and not states and not twin.pins(answer.reaction):
        # Nothing presses the plate: the signs of reactions in regular states are rounding, the answer decides.
        assert max(twin.violations(u, answer.reaction).values()) < 1e-8
        return
    assert (answer.status == "solved") == bool(states)
    if states and twin.pins(answer.reaction):
        # Rounding of K alone moves the solution of badly conditioned equations.
        apart = min(np.abs(u - v).max() / max(1e-8, 1e-15 * condition) for v, _, condition in states)
        assert apart <= twin.length(u)


@settings(max_examples=30)
@given(data=st.data())
def test_dual_and_stiffness_forms_agree(data, drawing, dense):
    tables = data.draw(drawing.models(shapes=("rectangle", "annulus")))
    found = posed(tables, dense)
    assume(found is not None)
    problem, load, twin = found
    dual, stiffness = problem.solve(load, "dual"), problem.solve(load, "stiffness")
    assert dual.status == stiffness.status
    if dual.status == "solved" and twin.pins(dual.reaction):
        u, v = dual.hi + dual.lo, stiffness.hi + stiffness.lo
        assert np.abs(u - v).max() <= 1e-8 * twin.length(u)
