"""Lemke's algorithm on plain arrays: its face in Python; the solver itself is tested in core/tests."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from signorini import InputError, lemke

UNIQUE = np.array([[60.0, 26, 37], [26, 36, 29], [37, 29, 30]]), -np.ones(3)
INFEASIBLE = np.array([[1.0, -1], [-1, 1]]), -np.ones(2)


def murty(n):
    lower = np.eye(n) + 2 * np.tri(n, k=-1)
    return lower, 2.0 ** (n + 1 - np.arange(1, n + 1)) - 2.0 ** (n + 1)


def test_solution_carries_both_vectors_and_the_basis():
    matrix, q = UNIQUE
    solution = lemke(matrix, q)
    assert solution.status == "solved"
    np.testing.assert_allclose(solution.z, [0, 1 / 239, 7 / 239], rtol=1e-15, atol=0)
    np.testing.assert_allclose(solution.w, matrix @ solution.z + q, atol=1e-15)
    assert solution.basis.dtype == bool and solution.basis.tolist() == [False, True, True]
    assert solution.ray is None
    assert repr(solution) == f"LcpSolution(order=3, status='solved', pivots={solution.pivots})"


@pytest.mark.parametrize("n", range(1, 11))
def test_murty_takes_two_to_the_n_pivots(n):
    solution = lemke(*murty(n))
    assert solution.pivots == 2**n
    assert solution.z.tolist() == [2**n] + [0] * (n - 1)


def test_infeasible_problem_ends_in_a_ray_that_proves_it():
    matrix, q = INFEASIBLE
    solution = lemke(matrix, q)
    assert solution.status == "ray" and np.isnan(solution.z).all() and np.isnan(solution.w).all()
    assert not solution.basis.any()
    assert (solution.ray >= 0).all() and (matrix.T @ solution.ray <= 0).all() and q @ solution.ray < 0
    assert "copositive-plus" in solution.message


def test_pivot_limit_claims_nothing():
    solution = lemke(*murty(5), max_pivots=31)
    assert (solution.status, solution.pivots) == ("pivot_limit", 31)
    assert np.isnan(solution.z).all() and solution.ray is None


def test_start_at_a_solution_makes_no_pivot():
    matrix, q = murty(8)
    cold = lemke(matrix, q)
    warm = lemke(matrix, q, start=cold.basis)
    assert warm.pivots == 0 and warm.z.tolist() == cold.z.tolist()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"q": -np.ones(2)}, "M is 3 x 3 and q has 2 entries"),
        ({"M": np.ones((3, 2))}, "M is 3 x 2 and q has 3 entries"),
        ({"M": np.diag([1.0, np.nan, 1.0])}, r"M\[1, 1\] is NaN"),
        ({"q": np.array([0, np.inf, 0])}, r"q\[1\] is inf"),
        ({"covering": np.ones(2)}, "covering has 2 entries"),
        ({"covering": np.array([1.0, 0, 1])}, r"covering\[1\] is 0; every entry must be finite and greater than zero"),
        ({"start": np.ones(4, dtype=bool)}, "basis has 4 entries"),
        ({"start": np.ones(3)}, "start: found an array of float64"),
        ({"M": np.ones(3)}, "M: found an array of shape \\(3,\\); it must be an array of numbers with 2 dimensions"),
        ({"q": ["a"]}, "q: found"),
        ({"max_pivots": -1}, "max_pivots: found -1"),
    ],
)
def test_bad_input_is_a_value_error_that_names_it(arguments, message):
    matrix, q = UNIQUE
    with pytest.raises(InputError, match=message) as caught:
        lemke(**{"M": matrix, "q": q, **arguments})
    assert isinstance(caught.value, ValueError)


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 30), st.integers(0, 2**32 - 1))
def test_positive_definite_problems_are_solved(order, seed):
    random = np.random.default_rng(seed)
    root = random.standard_normal((order, order))
    matrix, q = root @ root.T + 0.01 * np.eye(order), random.standard_normal(order)
    solution = lemke(matrix, q, covering=random.uniform(0.5, 2, order))
    slack = matrix @ solution.z + q
    size = abs(q) + abs(matrix) @ solution.z
    assert solution.status == "solved"
    assert (solution.z >= 0).all() and (solution.w >= 0).all()
    assert (solution.z[~solution.basis] == 0).all() and (solution.w[solution.basis] == 0).all()
    assert (abs(solution.w - slack) <= 1e-12 * size).all()
