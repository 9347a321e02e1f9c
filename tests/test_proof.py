"""Certificates of sums: never smaller figures than `certify` for the same answer, right or wrong."""

import numpy as np
import pytest
from models import rectangular

from signorini import _core, contact_problem
from signorini.analysis.combinations.terms import terms_of
from signorini.contact.certificate import FIGURES, TOLERANCE, certify

FACTORS = np.array([[1.0, 1.5, 0.0], [1.35, 0.0, 1.0], [1.0, 1.0, 1.0]])


def slab(**far):
    return rectangular(
        size=[8, 4],
        thickness=0.3,
        divisions=[8, 4],
        support=[
            {"name": "wall", "edge": "left", "fix": "simple"},
            {"at": [[4, 0], [4, 4], [8, 0], [8, 4]], "resists": "down"},
            {"at": [[6, 2]], "resists": "up", "stiffness": 1e7, "gap": 1e-4},
            {"name": "stop", "at": [3, 2], "resists": "down", "gap": 0.01, **far},
        ],
        load=[
            {"case": "G", "pressure": 5e3},
            {"case": "Q", "force": 50e3, "at": [2, 1]},
            {"case": "W", "line_load": -4e3, "edge": "right"},
        ],
    )


@pytest.fixture(params=[0.01, 1e3], ids=["near", "far"])
def sums(request):
    """A problem, its terms and their displacements, and the sums that solve its combinations."""
    problem = contact_problem(slab(gap=request.param))
    found = problem.discretisation
    terms = terms_of(problem, tuple(found.cases), ())
    verdict, pushes, reaction, *_ = _core.combine(problem.core, terms.shared, FACTORS)
    assert not verdict.any()
    responses = [
        _core.rest_response(problem.core, found.held.values),
        *_core.load_responses(problem.core, np.array([case.nodal for case in found.cases.values()])),
        *_core.point_responses(problem.core, 0, len(found.contacts)),
    ]
    return problem, terms, np.array([response.hi + response.lo for response in responses]), pushes, reaction


def both(sums, pushes, reaction):
    problem, terms, displacements, *_ = sums
    found = problem.discretisation
    coefficients = np.ascontiguousarray(np.hstack([np.ones((len(FACTORS), 1)), FACTORS, pushes]))
    bounds = terms.proof.figures(coefficients, np.ascontiguousarray(reaction))
    certified = []
    for row, factors in enumerate(FACTORS):
        parts = [a * case for a, case in zip(factors, found.cases.values(), strict=True)]
        u = coefficients[row] @ displacements
        judged = certify(found, sum(parts[1:], parts[0]), u, np.zeros_like(u), reaction[row])
        certified.append([getattr(judged, name) for name in FIGURES])
    return bounds, np.array(certified)


def test_sums_that_solve_their_combinations_pass(sums):
    bounds, certified = both(sums, *sums[3:])
    assert (bounds <= TOLERANCE).all() and (certified <= TOLERANCE).all()


@pytest.mark.parametrize("part", [1e-3, 1e-5])
@pytest.mark.parametrize("seed", range(5))
def test_sums_that_do_not_are_judged_no_better_than_by_the_certificate(sums, part, seed):
    _, _, _, pushes, reaction = sums
    random = np.random.default_rng(seed)
    pushes = pushes + part * np.abs(pushes).max() * random.uniform(-1, 1, pushes.shape)
    reaction = reaction + part * np.abs(reaction).max() * random.uniform(-1, 1, reaction.shape)
    bounds, certified = both(sums, pushes, reaction)
    assert (bounds >= 0.999 * certified - 0.01 * TOLERANCE).all()
    assert (bounds.max(axis=1) > TOLERANCE).all()
