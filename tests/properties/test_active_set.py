"""The active set where it is hardest: loads about to tip, checkerboards, soil from soft to rigid, gaps at random."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from models import rectangular
from scipy.sparse import csc_array
from scipy.sparse.linalg import spsolve

import signorini
from signorini import Model, NoEquilibriumError
from signorini.contact.problem import contact_problem

CHECKERBOARD = [{"pressure": "1e5*sin(3.14159265358979*x)*sin(3.14159265358979*y)"}, {"pressure": 1e4}]


def slab(thickness=0.3, stiffness=None, load=(), divisions=10, **bed) -> Model:
    bed |= {"area": "all", "resists": "down"} | ({"stiffness": stiffness} if stiffness else {})
    return rectangular(
        size=[10, 10],
        thickness=thickness,
        divisions=[divisions, divisions],
        support=[bed],
        load=list(load),
        solver={"method": "active_set"},
    )


@pytest.mark.parametrize("thickness", [0.3, 0.05])
@pytest.mark.parametrize("stiffness", [3e7, 1e11, None])
@pytest.mark.parametrize("short", [1e-2, 1e-6])
def test_a_force_about_to_tip_the_slab_over_its_edge(thickness, stiffness, short) -> None:
    at = 5 + 5 * (1 - short)
    result = signorini.solve(slab(thickness, stiffness, [{"force": 1e5, "at": [at, 5]}]))["all"]
    assert result.method == "active_set" and result.certificate.passed
    bed = result.supports[0]
    assert bed.reaction == pytest.approx(1e5, rel=1e-10) and 1 < bed.closed.sum() <= 60
    assert bed.reactions @ bed.positions / bed.reaction == pytest.approx([at, 5], rel=1e-9)
    # A small lifting force at the other edge moves the resultant past the edge.
    over = [{"force": 1e5 + 1, "at": [10, 5]}, {"force": -1, "at": [0, 5]}]
    with pytest.raises(NoEquilibriumError, match="tips about the line x = 10"):
        signorini.solve(slab(thickness, stiffness, over))


@pytest.mark.parametrize("thickness", [0.3, 0.03])
@pytest.mark.parametrize("stiffness", [1e3, 1e6, 1e9, 1e12, 1e15, None])
def test_a_checkerboard_of_loads_on_soil_from_soft_to_rigid(thickness, stiffness) -> None:
    result = signorini.solve(slab(thickness, stiffness, CHECKERBOARD, 20))["all"]
    assert result.certificate.passed and not result.unsettled
    assert result.certificate.penetration < 1e-12 and result.certificate.equilibrium < 1e-11
    assert result.supports[0].reaction == pytest.approx(1e6, rel=1e-9)


@settings(max_examples=15, deadline=None)
@given(
    st.lists(st.floats(0, 2e-3), min_size=4, max_size=4),
    st.floats(-1, 1),
    st.sampled_from([1e5, 3e7, 1e10, 1e13]),
    st.sampled_from([0.5, 0.1, 0.02]),
)
def test_one_linear_solve_on_the_set_found_gives_the_result_again(gaps, wave, stiffness, thickness) -> None:
    a, b, c, d = gaps
    gap = f"{a} + {b}*sin(x + {wave}*y)**2 + {c}*cos({wave}*x*y)**2 + {d}*abs(x-5)/5"
    model = slab(thickness, stiffness, [{"pressure": 2e3}, {"force": 2e5, "at": [3, 4]}], 8, gap=gap)
    problem = contact_problem(model)
    load, held = problem.load("all"), problem.discretisation.held
    answer = problem.solve(problem.discretisation.cases["load"])
    closed = answer.closed
    springs = csc_array((1 / problem.compliance[closed], (range(closed.sum()), range(closed.sum()))))
    rows = problem.G[closed]
    free = ~held.dofs
    matrix = (problem.K + rows.T @ springs @ rows).tocsc()[free][:, free]
    once = np.zeros(len(load))
    once[free] = spsolve(matrix, (load + rows.T @ (springs @ problem.gaps[closed]))[free])
    # A plain sparse solve is as good as K is conditioned.
    assert np.abs(once - answer.hi)[::3].max() < 1e-5 * np.abs(answer.hi[::3]).max()
    pressing = problem.G @ once - problem.gaps
    assert (pressing[closed] > -1e-6 * np.abs(once[::3]).max()).all()
    assert (pressing[~closed] < 1e-6 * np.abs(once[::3]).max()).all()
