"""Solves in forked processes, in several threads and in callbacks: none waits for threads that are not there."""

import multiprocessing
import os
import subprocess
import sys

import numpy as np
import pytest
from models import rectangular

import signorini

SECONDS = 60

if sys.platform == "win32":
    pytest.skip("there is no fork", allow_module_level=True)


def model(load: float = 5.0, **changes: object) -> signorini.Model:
    data = {
        "material": {"E": 30e6, "nu": 0.2},
        "divisions": [6, 6],
        "support": [{"name": "feet", "at": [[1, 1], [3, 1], [3, 3], [1, 3]], "resists": "down"}],
        "load": [{"case": "G", "pressure": load}, {"case": "Q", "force": 10, "at": [4, 2]}],
    }
    return rectangular(**data | changes)


def on_soil(load: float) -> signorini.Model:
    """Combinations that are solved side by side, with threads for each."""
    soil = [{"name": "soil", "area": "all", "resists": "down", "stiffness": 1e4}]
    wanted = [{"name": f"{i}", "factors": {"G": 1, "Q": 0.2 * i}} for i in range(14)]
    return model(load, support=soil, combination=wanted)


def solved(load: float) -> bytes:
    return signorini.solve(model(load))["all"].deflection.tobytes()


def tabulated(load: float) -> bytes:
    combined = signorini.solve(on_soil(load)).combined
    assert combined is not None
    return combined.envelope.fields["deflection"].largest.tobytes()


def followed(load: float) -> bytes:
    path = signorini.path(model(load), start="G", add="Q")
    return np.array([stop.t for stop in path.stops]).tobytes()


@pytest.mark.filterwarnings("ignore:This process:DeprecationWarning")
@pytest.mark.parametrize("answer", [solved, tabulated, followed])
def test_a_forked_process_solves_what_its_parent_solves(answer) -> None:
    loads = [5.0, 7.0, 9.0]
    here = [answer(load) for load in loads]
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.map_async(answer, loads).get(timeout=SECONDS) == here


IN_CALLBACKS = """
import sys, threading
sys.path.insert(0, {folder!r})
from test_processes import followed, model, on_soil
import signorini

where = set()
def asked(progress):
    where.add(threading.current_thread())
    if nested:
        nested.pop()
        signorini.solve(on_soil(3.0), progress=asked)

nested = [1]
signorini.solve(on_soil(5.0), progress=asked)
assert where == {{threading.main_thread()}} and not nested
alone = followed(5.0)
found = []
threads = [threading.Thread(target=lambda: found.append(followed(5.0))) for _ in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
assert found == 4 * [alone]
"""


@pytest.mark.parametrize("threads", ["1", "2"])
def test_a_callback_runs_on_the_thread_that_asked_and_may_solve_itself(threads: str) -> None:
    """All threads of the core may wait for callbacks: of a solve in a solve, and of four paths at once."""
    code = IN_CALLBACKS.format(folder=os.path.dirname(__file__))
    environment = {**os.environ, "RAYON_NUM_THREADS": threads}
    subprocess.run([sys.executable, "-c", code], env=environment, timeout=SECONDS, check=True)
