"""A large block that memory does not hold is an error, and never the end of the process."""

import os
import subprocess
import sys

import pytest

from signorini import Model, SignoriniError, contact_problem
from signorini.contact import factoring
from signorini.discretise import discretise

LIMITED = """
import resource
import numpy as np
from signorini import Model, _core, contact_problem

def taken():
    lines = open("/proc/self/status").read().splitlines()
    return sum(1024 * int(line.split()[1]) for line in lines if line.startswith("VmSize:"))

{prepare}

ask()
outcomes = []
_, hard = resource.getrlimit(resource.RLIMIT_AS)
for megabytes in {megabytes}:
    resource.setrlimit(resource.RLIMIT_AS, (taken() + megabytes * 2**20, hard))
    try:
        outcomes.append(ask())
    except MemoryError as error:
        outcomes.append("does not fit into memory" in str(error))
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (hard, hard))
print(outcomes)
"""

LEMKE = """
rng = np.random.default_rng(1)
half = rng.standard_normal((1500, 1500))
M, q = half @ half.T / 1500 + np.eye(1500), rng.standard_normal(1500)
def ask():
    return _core.lemke(M, q).status
"""

CONTACT = """
line = [{{"line": [[0.5, y], [9.5, y]], "resists": "down"}} for y in np.linspace(1, 9, 9)]
model = Model(
    material={{"E": 30e9, "nu": 0.2}},
    plate={{"shape": "rectangle", "size": [10, 10], "thickness": 0.3}},
    mesh={{"divisions": [40, 40]}},
    support=line,
    load=[{{"pressure": "1e4*sin(3*x)*cos(y) + 2e3"}}],
    solver={{"method": "lemke"}},
)
problem = contact_problem(model)
nodal, held = problem.discretisation.cases["load"].nodal, problem.discretisation.held.values
def ask():
    return problem.core.solve(nodal, held, "{form}").status
"""


def test_a_factor_is_refused_once_its_pattern_is_known(monkeypatch: pytest.MonkeyPatch) -> None:
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
        mesh={"divisions": [60, 60]},
        support=[{"edge": "left", "fix": "clamped"}],
        load=[{"pressure": 5e3}],
    )
    found = discretise(model)
    entries = contact_problem(found).core.factor_entries
    monkeypatch.setattr(factoring, "available", lambda: 8.0 * entries)
    with pytest.raises(
        SignoriniError, match=r"^The factor takes 0\.\d GB of memory, and 0\.\d GB are free\. Take a coarser mesh\.$"
    ):
        contact_problem(found)
    monkeypatch.setattr(factoring, "available", lambda: 16.0 * entries)
    assert contact_problem(found).core.factor_entries == entries


@pytest.mark.skipif(sys.platform != "linux", reason="the limit is Linux's")
@pytest.mark.parametrize(
    ("prepare", "megabytes"),
    [
        (LEMKE, (5, 25, 45, 500)),
        (CONTACT.format(form="dual"), (2, 9, 500)),
        (CONTACT.format(form="stiffness"), (2, 9, 500)),
    ],
    ids=["lemke", "dual", "stiffness"],
)
def test_what_does_not_fit_is_said(prepare: str, megabytes: tuple[int, ...]) -> None:
    code = LIMITED.format(prepare=prepare, megabytes=megabytes)
    # One thread, whose own room for products the first answer takes; and large blocks given back where they are freed.
    environment = os.environ | {"RAYON_NUM_THREADS": "1", "MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_THRESHOLD_": "100000"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stderr
    outcomes = eval(done.stdout)
    assert outcomes[0] is True and outcomes[-1] == "solved" and False not in outcomes
