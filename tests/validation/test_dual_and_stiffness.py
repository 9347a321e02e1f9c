"""The paper's dual form, whose unknown is the reaction, and the stiffness form, whose unknown is the gap, agree."""

import numpy as np
import pytest
from models import rectangular

import signorini
from signorini import contact_problem

CLAMPED = {"edge": "left", "fix": "clamped"}
OFF_NODES = [[3.9, 0.1], [3.71, 2.83], [2.13, 1.37]]
ALL_EDGES = {"edge": ["left", "right", "top", "bottom"], "resists": "down"}

HELD = {
    "points at nodes": [CLAMPED, {"at": [[4, 0], [4, 3], [2, 1.5]], "resists": "down"}],
    "points between nodes": [CLAMPED, {"at": OFF_NODES, "resists": "down"}],
    "an edge and points": [
        CLAMPED,
        {"edge": "right", "resists": "down", "gap": 2e-5},
        {"at": OFF_NODES, "resists": "up"},
    ],
    "elastic points and line": [
        CLAMPED,
        {"at": OFF_NODES, "resists": "down", "stiffness": 5e7},
        {"line": [[1.1, 0], [1.1, 3]], "resists": "up", "stiffness": 1e8, "gap": 1e-5},
    ],
    "elastic points with travel both ways": [CLAMPED, {"at": OFF_NODES, "gap": 5e-5, "stiffness": 3e7}],
}
ALONE = {
    "edges, with three points both ways": [
        {"at": [[0.3, 0.3], [3.7, 0.3], [2.1, 2.9]]},
        {"edge": ["top", "right"], "resists": "down", "gap": 1e-5},
    ],
    "edges": [ALL_EDGES],
    "edges and anchors": [ALL_EDGES, {"at": [[0.2, 0.2], [3.8, 2.8]], "resists": "up", "gap": 1e-6}],
    "elastic points": [{"at": [[0.3, 0.3], [3.7, 0.3], [2.1, 2.9], [0.4, 2.8]], "resists": "down", "stiffness": 1e7}],
    "settled edges and a line": [
        {"edge": ["left", "right"], "resists": "down", "settlement": "1e-4*x"},
        {"line": [[2, 0], [2, 3]], "resists": "down", "gap": 1e-4},
    ],
}


def problem_of(support, thickness=0.2):
    model = rectangular(
        size=[4, 3],
        thickness=thickness,
        divisions=[8, 6],
        support=support,
        load=[{"pressure": 5e3}, {"force": 50e3, "at": [0.7, 0.9]}],
    )
    return contact_problem(model)


def relative(found, wanted):
    return np.abs(found - wanted).max() / np.abs(wanted).max()


@pytest.mark.parametrize("thickness", [0.2, 0.004])
@pytest.mark.parametrize("support", HELD | ALONE)
def test_both_forms_give_the_same_plate(support, thickness):
    problem = problem_of((HELD | ALONE)[support], thickness)
    assert problem.freedom.regular == (support in HELD)
    load = problem.discretisation.cases["load"]
    dual, stiffness = (problem.solve(load, form) for form in ("dual", "stiffness"))
    assert dual.status == stiffness.status == "solved"
    assert relative(dual.hi + dual.lo, stiffness.hi + stiffness.lo) < 1e-8
    assert relative(dual.reaction, stiffness.reaction) < 1e-8
    assert np.abs(dual.gap - stiffness.gap).max() < 1e-8 * max(np.abs(problem.gaps).max(), np.abs(dual.hi[::3]).max())
    assert (dual.closed == stiffness.closed).all()


@pytest.mark.parametrize("support", HELD | ALONE)
def test_both_linear_complementarity_problems_have_the_same_solution(support):
    """Each as posed, solved on its own, before any refinement."""
    problem = problem_of((HELD | ALONE)[support])
    load = problem.load("all")
    reactions, gaps = [], []
    for form in ("dual", "stiffness"):
        posed = problem.lcp(load, form)
        answer = signorini.lemke(posed.M, posed.q)
        assert answer.status == "solved"
        reaction, gap = np.zeros((2, len(problem.gaps)))
        reaction[posed.points] = np.where(posed.gap_is_z, answer.w, answer.z)
        gap[posed.points] = np.where(posed.gap_is_z, answer.z, answer.w)
        reactions.append(reaction)
        gaps.append(gap)
    assert relative(reactions[0], reactions[1]) < 1e-8
    assert np.abs(gaps[0] - gaps[1]).max() < 1e-8 * max(gaps[1].max(), problem.gaps.max(), 1e-6)


BY_POINTS = {
    "soft points at nodes": {"at": [[4, 0], [4, 3], [2, 1.5]], "resists": "down", "stiffness": 5e5},
    "stiff points at nodes": {"at": [[4, 0], [4, 3]], "resists": "down", "stiffness": 1e13},
    "soft points with gaps": {"at": OFF_NODES, "resists": "down", "stiffness": "1e5*x", "gap": 1e-5},
    "settled points": {"at": OFF_NODES, "resists": "down", "settlement": 2e-4},
    "points held both ways": {"at": [[3.71, 2.83], [2.13, 1.37]], "resists": "both", "settlement": 1e-4},
    "travel both ways": {"at": OFF_NODES[:2], "gap": 2e-5, "stiffness": 1e6},
}
STATED = {name: [CLAMPED, support] for name, support in BY_POINTS.items()} | {
    "all of them": [{**CLAMPED, "settlement": 3e-4}, {"at": [1, 2], "stiffness": 3e6}, *BY_POINTS.values()],
    "an edge and points": HELD["an edge and points"],
    "an edge, as an active set": [CLAMPED, {"area": "all", "resists": "down", "stiffness": 1e6}],
}


def densely(problem):
    """K over the free dofs, G, and the displacements under a load with the held dofs at their values."""
    held = problem.discretisation.held
    stiffness, free = problem.K.toarray(), ~held.dofs

    def displaced(load):
        out = held.values.copy()
        out[free] = np.linalg.solve(stiffness[np.ix_(free, free)], (load - stiffness @ held.values)[free])
        return out

    flexibility = np.zeros_like(stiffness)
    flexibility[np.ix_(free, free)] = np.linalg.inv(stiffness[np.ix_(free, free)])
    return flexibility, displaced


@pytest.mark.parametrize("support", STATED)
def test_the_dual_is_the_papers(support):
    """P = G K⁻¹ Gᵀ + C and s = G K⁻¹ f − g, (26) and (27) of the paper, whatever the factor carries."""
    problem = problem_of(STATED[support])
    load, g = problem.load("all"), problem.G.toarray()
    p, s = problem.dual(load)
    flexibility, displaced = densely(problem)
    assert p == pytest.approx(g @ flexibility @ g.T + np.diag(problem.compliance), rel=1e-8, abs=1e-10 * p.max())
    assert s == pytest.approx(g @ displaced(load) - problem.gaps, rel=1e-8, abs=1e-10 * np.abs(s).max())
    # The solution satisfies this statement too.
    answer = problem.solve(problem.discretisation.cases["load"])
    assert answer.gap == pytest.approx(p @ answer.reaction - s, abs=1e-9 * np.abs(s).max())


@pytest.mark.parametrize("form", ["auto", "dual", "stiffness"])
@pytest.mark.parametrize("support", [*STATED, *ALONE])
def test_the_lcp_says_what_its_unknowns_are_and_leads_back_to_reactions(support, form):
    problem = problem_of((STATED | ALONE)[support])
    load = problem.load("all")
    if (support, form) == ("all of them", "stiffness"):
        # Some of them are rigid and at one place.
        with pytest.raises(signorini.SignoriniError, match="repeat each other"):
            problem.lcp(load, form)
        return
    posed = problem.lcp(load, form)
    one_sided = np.flatnonzero(~problem.discretisation.contacts.two_sided)
    assert np.array_equal(np.sort(posed.points), one_sided)
    assert form != "stiffness" or posed.gap_is_z.all()
    z = signorini.lemke(posed.M, posed.q).z if len(one_sided) else posed.q
    reaction, gap = posed.contact(z)
    given = np.full(len(problem.gaps), np.nan)
    given[posed.points] = reaction
    found = signorini.recover(problem, "all", given)
    wanted = problem.solve(problem.discretisation.cases["load"])
    assert found.certificate.passed
    assert relative(found.deflection, (wanted.hi + wanted.lo)[::3]) < 1e-9
    assert reaction == pytest.approx(wanted.reaction[posed.points], abs=1e-7 * np.abs(wanted.reaction).max())
    assert gap == pytest.approx(wanted.gap[posed.points], abs=1e-7 * np.abs(wanted.hi[::3]).max())
    # Rows hold for any z if P and s exist and no row is eliminated.
    if problem.freedom.regular and len(one_sided) == len(problem.gaps):
        p, s = problem.dual(load)
        size = np.where(posed.gap_is_z, np.abs(wanted.hi[::3]).max(), np.abs(wanted.reaction).max())
        reaction, gap = posed.contact(np.linspace(0.5, 1.5, len(z)) * size)
        left = p[np.ix_(posed.points, posed.points)] @ reaction - s[posed.points]
        assert left == pytest.approx(gap, abs=1e-9 * (np.abs(p) @ np.abs(reaction)).max())


WITH_LAWS = {
    "a limit": {"at": OFF_NODES, "resists": "down", "limit": 6e3},
    "a spring with a limit": {"at": OFF_NODES, "resists": "down", "stiffness": 1e7, "limit": 6e3},
    "a limit both ways": {"at": OFF_NODES, "resists": "both", "stiffness": 1e7, "limit": 6e3},
    "a limit and travel both ways": {"at": OFF_NODES, "resists": "both", "gap": 1e-4, "stiffness": 1e8, "limit": 6e3},
    "a law": {"at": OFF_NODES, "resists": "down", "law": [[0, 0], [0, 2e3], [1e-3, 5e3], [2e-3, 5e3]]},
    "a law both ways": {"at": OFF_NODES, "law": [[-2e-3, -3e4], [-1e-3, -3e4], [0, 0], [2e-3, 5e3], [3e-3, 9e3]]},
    "soil that crushes": {"area": "all", "resists": "down", "stiffness": 1e6, "limit": 5e3},
}


@pytest.mark.parametrize("form", ["dual", "stiffness"])
@pytest.mark.parametrize("law", WITH_LAWS)
def test_rows_of_limits_and_laws_lead_back_to_the_reactions_of_their_points(law, form):
    problem = problem_of([CLAMPED, WITH_LAWS[law], {"at": [3.71, 1.1], "resists": "both"}])
    load = problem.load("all")
    posed = problem.lcp(load, form)
    assert len(posed.q) > len(np.unique(posed.points))
    answer = signorini.lemke(posed.M, posed.q)
    reactions = np.full(len(problem.gaps), np.nan)
    reactions[posed.points], gaps = posed.contact(answer.z)
    wanted = problem.solve(problem.discretisation.cases["load"])
    assert reactions[posed.points] == pytest.approx(wanted.reaction[posed.points], abs=1e-7 * wanted.reaction.max())
    travel = problem.G @ (wanted.hi + wanted.lo) - problem.gaps
    found = (problem.compliance * wanted.reaction - travel)[posed.points]
    assert gaps == pytest.approx(found, abs=1e-7 * np.abs(wanted.hi[::3]).max())
    assert signorini.recover(problem, "all", reactions).certificate.passed


def test_there_is_no_dual_where_one_sided_supports_alone_hold_the_plate():
    problem = problem_of(ALONE["edges"])
    with pytest.raises(signorini.SignoriniError, match="need K to be regular"):
        problem.dual(problem.load("all"))


def test_rigid_travel_both_ways_is_contact_on_the_side_that_is_reached():
    """Opposite rigid stops share a dof, so that only the dual form exists; it has the solution with each stop alone."""
    point = {"at": [[3.71, 2.83]], "gap": 2e-5}
    between = problem_of([CLAMPED, point])
    stop = problem_of([CLAMPED, {**point, "resists": "down"}])
    load = between.discretisation.cases["load"]
    answer, alone = between.solve(load), stop.solve(stop.discretisation.cases["load"])
    assert answer.reaction == pytest.approx([alone.reaction[0], 0.0], rel=1e-10)
    lifted = between.solve(-1.0 * load)
    assert lifted.reaction[::-1] == pytest.approx(answer.reaction, rel=1e-10)
    assert lifted.hi == pytest.approx(-answer.hi, rel=1e-10, abs=1e-20)
