"""Load paths on two slabs of 10 m x 10 m: time of the whole path over its events times one separate solve.

Slab B lies on 16 rigid points that only push, slab A on tensionless soil; 2 kPa everywhere, and 500 kN on 1 m x 1 m
near a corner grows: on the points from nothing until nothing changes any more, on the soil from 0.9 of it by a part
that makes some 50 events of the thousands that a fine mesh has. Both are factored once, and a separate solve has its
factor too. At random t the path's deflections are compared with those of a solve by itself.

    python benchmarks/paths.py [--divisions 80] [--part 0.003]
    python benchmarks/paths.py --check        20 x 20, and fails where they differ by more than 1e-9
"""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

from signorini import Model, path
from signorini.contact.problem import contact_problem

_AT = (0.5, 3.5, 6.5, 9.5)
_POINTS = {"name": "points", "at": [[x, y] for x in _AT for y in _AT], "resists": "down"}
_SOIL = {"name": "soil", "area": "all", "resists": "down", "stiffness": 30e6}
_SAMPLES = 12


def slab(support, divisions):
    """The slab on one of its supports."""
    return Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        mesh={"divisions": [divisions, divisions]},
        support=[support],
        load=[
            {"case": "G", "pressure": 2e3},
            {"case": "Q", "pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}},
        ],
        combination=[{"name": "most", "factors": {"G": 1.0, "Q": 0.9}}],
    )


def seconds_of(action):
    """CPU seconds, and what the action returns."""
    begun = time.process_time()
    answer = action()
    return time.process_time() - begun, answer


def measured(name, model, begin, until):
    """Print the figures of one slab; the largest difference from a separate solve, over the largest deflection."""
    factoring, problem = seconds_of(lambda: contact_problem(model))
    start, add = (problem.discretisation.cases[case] for case in ("G", "Q"))
    start = start + 0.9 * add if begin == "most" else start
    whole, found = seconds_of(lambda: path(model, begin, "Q", until))
    spent, events = max(whole - factoring, 0.0), len(found.events)
    separate, differences = [], []
    for t in np.random.default_rng(5).uniform(0.0, found.end, _SAMPLES):
        load = start + float(t) * add
        seconds, answer = seconds_of(lambda load=load: problem.solve(load))
        separate.append(seconds)
        direct, along = (answer.hi + answer.lo)[::3], found.at(float(t)).deflection
        differences.append(np.abs(along - direct).max() / np.abs(direct).max())
    one = float(np.median(separate))
    print(
        f"{name}: {len(problem.gaps)} contact points, {events} events to t = {found.end:.6g} ({found.ending}) in "
        f"{spent:.2f} s beside {factoring:.2f} s to mesh and factor; a separate solve {one:.4f} s; "
        f"path / (events x solve) = {spent / (max(events, 1) * one):.2f}; largest difference {max(differences):.1e}"
    )
    print(f"  certificate, the worst of {len(found.stops)} stops: {found.certificate}")
    return max(differences)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--divisions", type=int, default=80)
    parser.add_argument("--part", type=float, help="t to which the soil's path goes [default: some 50 events]")
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    divisions = 20 if given.check else given.divisions
    part = given.part or 0.003 * (80 / divisions) ** 2
    print(f"{divisions} x {divisions} elements, CPU time")
    worst = max(
        measured("points", slab(_POINTS, divisions), "G", None),
        measured("soil", slab(_SOIL, divisions), "most", part),
    )
    sys.exit(0 if worst < 1e-9 else 1)


if __name__ == "__main__":
    main()
