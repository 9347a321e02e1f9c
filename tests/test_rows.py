"""Contact rows as matrices, and what work on them costs in memory."""

import tracemalloc

import numpy as np
import pytest
from tensionless import slab_a

from signorini import Model
from signorini.contact.certificate import certify
from signorini.contact.problem import contact_problem
from signorini.discretise import Discretisation, Rows, discretise


@pytest.fixture(scope="module")
def slab() -> Discretisation:
    return discretise(slab_a(40))


def test_a_matrix_of_rows_has_their_coefficients_at_the_dofs_of_their_elements() -> None:
    elements = np.array([[0, 1, 2, 3, 4, 5, 6, 7], [1, 8, 9, 2, 10, 11, 12, 5]])
    coefficients = np.random.default_rng(3).random((3, 24))
    coefficients[:, [4, 11]] = 0.0
    coefficients[1, 7] = 0.0
    rows = Rows(np.array([1, 0, 1]), coefficients)
    expected = np.zeros((3, 39))
    np.put_along_axis(expected, rows.dofs(elements), coefficients, axis=1)
    matrix = rows.matrix(elements, 39)
    assert (matrix.toarray() == expected).all()
    assert matrix.nnz == np.count_nonzero(coefficients)
    assert Rows.join([]).matrix(elements, 39).shape == (0, 39)


def test_rows_of_a_deflection_keep_eight_of_their_columns(slab: Discretisation) -> None:
    # On a side of an element three deflections count, at a node one.
    assert np.diff(slab.contact_rows.indptr).max() == 8
    assert 0.9 * 8 * len(slab.contacts) < slab.contact_rows.nnz < 8 * len(slab.contacts)


def test_certifying_takes_little_more_memory_than_the_rows_have(slab: Discretisation) -> None:
    answer = contact_problem(slab).solve(slab.cases["load"])
    assert slab.contact_rows.nnz and slab.rigid_motions.size  # made once and kept
    tracemalloc.start()
    certificate = certify(slab, slab.cases["load"], answer.hi, answer.lo, answer.reaction)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert certificate.passed
    assert peak < 2 * slab.contacts.rows.coefficients.nbytes


def test_where_nothing_is_held_every_contact_point_stays() -> None:
    tables = slab_a(4).model_dump(exclude_unset=True)
    wall = {"name": "wall", "edge": "left", "fix": "clamped"}
    free, held = (
        discretise(Model.model_validate({**tables, "support": support}))
        for support in (tables["support"], [*tables["support"], wall])
    )
    # Four points across a side on the outline, three elsewhere and beside nodes that are held.
    assert len(free.contacts) == 4 * 9 + 8 * 12 + 4 * 16
    assert len(held.contacts) < len(free.contacts)
