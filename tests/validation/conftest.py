"""Common code of validation tests: a square plate, and a plate solved with prescribed dofs only."""

import numpy as np
import pytest
from tensionless import quarter_square

import signorini
from signorini import _core

NO_ROWS = (np.zeros(0, np.int64), np.zeros((0, 24)), np.zeros(0, np.int64))
NO_SPRINGS = (*NO_ROWS, np.zeros(0), np.zeros(0))
NO_CONTACTS = {
    **dict(zip(("elements", "rows", "further"), NO_ROWS, strict=True)),
    **dict.fromkeys(("distance", "scale", "unit", "regularization"), np.zeros(0)),
    "law": np.zeros(0, np.int64),
}


def _square(support, thickness, n, element="mitc9", twist_held=False):
    """Result of `quarter_square`, and D."""
    model = quarter_square(support, thickness, n, element, twist_held)
    return signorini.solve(model)["all"], thickness**3 / 12 / (1 - 0.3**2)


def _prescribed(plate, held, values, load=None):
    """Displacements (hi, lo) of a core plate with ``held`` dofs at ``values`` under nodal forces."""
    load = np.zeros(plate.dof_count) if load is None else load
    answer = _core.ContactProblem(plate, held, NO_SPRINGS, NO_CONTACTS, []).solve(load, values)
    assert answer.status == "solved"
    return answer.hi, answer.lo


@pytest.fixture(scope="session")
def square():
    return _square


@pytest.fixture(scope="session")
def prescribed():
    return _prescribed
