"""What several validation tests share: a square plate, and a plate solved with prescribed dofs and nothing else."""

import numpy as np
import pytest

import signorini
from signorini import _core

NO_ROWS = (np.zeros(0, np.int64), np.zeros((0, 24)))
NO_SPRINGS = (*NO_ROWS, np.zeros(0), np.zeros(0))
NO_CONTACTS = (*NO_ROWS, np.zeros(0), np.zeros(0), np.zeros(0, np.bool_), np.zeros(0))


def _square(support, thickness, n, element="mitc9", twist_held=False):
    """Unit square under p = 1, E = 1, ν = 0.3, as its quarter with n × n elements; its result and D.

    The plate's middle is the corner (0, 0), its edges are at x = 1/2 and y = 1/2. ``twist_held`` makes them hard.
    """
    edges = {"edge": ["right", "top"]}
    model = signorini.Model(
        material={"E": 1.0, "nu": 0.3},
        plate={"shape": "rectangle", "size": [0.5, 0.5], "thickness": thickness, "element": element},
        mesh={"divisions": [n, n]},
        support=[
            {"name": "edges", **edges, **support},
            {"name": "middle lines", "edge": ["left", "bottom"], "fix": "symmetry"},
            *([{"name": "hard", **edges, "fix": ["twist"]}] if twist_held else []),
        ],
        load=[{"pressure": 1.0}],
    )
    return signorini.solve(model)["all"], thickness**3 / 12 / (1 - 0.3**2)


def _prescribed(plate, held, values, load=None):
    """Displacements (hi, lo) of a core plate with ``held`` dofs at ``values`` under nodal forces."""
    load = np.zeros(plate.dof_count) if load is None else load
    answer = _core.ContactProblem(plate, held, NO_SPRINGS, NO_CONTACTS).solve(load, values)
    assert answer.status == "solved"
    return answer.hi, answer.lo


@pytest.fixture(scope="session")
def square():
    return _square


@pytest.fixture(scope="session")
def prescribed():
    return _prescribed
