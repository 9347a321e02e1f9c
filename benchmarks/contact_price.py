"""What contact costs on top of a linear solve: slab B, on 16 points that only push, against the same points held.

Both runs are in one process, the two taking turns, and both end with refined displacements and reactions: the linear
one holds the plate at the same 16 nodes and needs no contact problem. Mesh and element matrices are shared and not
counted; ordering, assembly, factorization, condensation, Lemke's algorithm and recovery are.

    python benchmarks/contact_price.py [--elements 80] [--repeat 9]
    python benchmarks/contact_price.py --check      correctness only: the two agree where every point stays closed
"""

import argparse
import statistics
import sys
import time

import numpy as np

from signorini import Model
from signorini.discretise import discretise
from signorini.problem import contact_problem

POINTS = [[x, y] for y in (0.5, 3.5, 6.5, 9.5) for x in (0.5, 3.5, 6.5, 9.5)]


def slab(elements, resists, loads):
    return discretise(
        Model(
            material={"E": 30e9, "nu": 0.2},
            plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
            mesh={"divisions": [elements, elements]},
            support=[{"at": POINTS, "resists": resists}],
            load=loads,
        )
    )


UNIFORM = {"pressure": 2e3}
PATCH = {"pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}


def run(plate):
    begun = time.perf_counter()
    problem = contact_problem(plate)
    answer = problem.solve(plate.cases["load"])
    return time.perf_counter() - begun, answer


def compare(elements, repeat):
    plates = {way: slab(elements, way, [UNIFORM, PATCH]) for way in ("both", "down")}
    seconds = {way: [] for way in plates}
    for _ in range(repeat):
        for way, plate in plates.items():
            spent, answer = run(plate)
            seconds[way].append(spent)
    linear, contact = (statistics.median(seconds[way]) for way in ("both", "down"))
    print(f"slab B, {elements}x{elements}, {plates['down'].dof_count} dofs, median of {repeat}")
    print(f"linear {linear:.3f} s, contact {contact:.3f} s: contact costs {100 * (contact / linear - 1):.0f} % on top")
    print(f"pivots {answer.pivots}, open points {int((~answer.closed).sum())}")


def check():
    """Under a load that keeps every point closed, one-sided and held points give the same plate."""
    held, one_sided = (slab(20, way, [UNIFORM]) for way in ("both", "down"))
    _, linear = run(held)
    _, contact = run(one_sided)
    error = np.abs(linear.hi - contact.hi).max() / np.abs(linear.hi).max()
    print(f"all closed: {bool(contact.closed.all())}, largest difference, relative: {error:.1e}")
    sys.exit(0 if contact.closed.all() and error < 1e-9 else 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=80)
    parser.add_argument("--repeat", type=int, default=9)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    if given.check:
        check()
    compare(given.elements, given.repeat)


if __name__ == "__main__":
    main()
