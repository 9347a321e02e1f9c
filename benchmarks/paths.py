"""Load paths: what they cost beside single solves, in CPU seconds on one thread, and how many solves they take.

- A strip of 400 x 1 elements on tensionless soil, weight and a growing line load until 60, with its half-widths, over
  one solve of the same model with its half-widths; likewise the base plate of examples/, whose anchors come to pull.
- Slab A, 10 m x 10 m on tensionless soil under 2 kPa and 500 kN on 1 m x 1 m near a corner that grows, at 160 x 160
  elements and without half-widths, over one linear solve: meshing, factoring and solving on soil that holds both ways.

    python benchmarks/paths.py [--divisions 160]
    python benchmarks/paths.py --check        slab A at 40 x 40, and fails where a path costs more than it may
"""

from __future__ import annotations

import argparse
import os
import sys
import time
import tomllib
from pathlib import Path

os.environ.setdefault("RAYON_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")

from signorini import Model, path, solve
from signorini.analysis.sampler import Sampler
from signorini.contact.problem import contact_problem

_MOST_SOLVES, _MOST_LINEAR = 20, 60
_SOIL = {"name": "soil", "area": "all", "stiffness": 30e6}
_CONCRETE = {"E": 30e9, "nu": 0.2}


def strip(**more):
    """A strip on soil that a line load lifts off it."""
    return Model(
        material=_CONCRETE,
        plate={"shape": "rectangle", "size": [40, 0.1], "thickness": 0.3},
        mesh={"divisions": [400, 1]},
        support=[{**_SOIL, "resists": "down"}],
        load=[{"case": "G", "pressure": 7.5e3}, {"case": "Q", "line_load": 20e3, "line": [[20, 0], [20, 0.1]]}],
        **more,
    )


def base_plate(factors):
    """The base plate of the examples, with one combination."""
    file = Path(__file__).parents[1] / "examples" / "base_plate.toml"
    return Model(**tomllib.loads(file.read_text("utf-8")) | {"combination": [{"name": "one", "factors": factors}]})


def slab(support, divisions):
    """Slab A."""
    return Model(
        material=_CONCRETE,
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        mesh={"divisions": [divisions, divisions]},
        support=[support],
        load=[
            {"case": "G", "pressure": 2e3},
            {"case": "Q", "pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}},
        ],
    )


def seconds_of(action):
    """CPU seconds, what the action returns, and the solves on the way."""
    count, plain = [0], Sampler.state

    def counted(self, *given, **more):
        count[0] += 1
        return plain(self, *given, **more)

    Sampler.state = counted
    begun = time.process_time()
    try:
        answer = action()
    finally:
        Sampler.state = plain
    return time.process_time() - begun, answer, count[0]


def with_half_widths(name, model, single, *given):
    """Print the figures of a path with its half-widths; its seconds over those of one solve."""
    alone, _, _ = seconds_of(lambda: [result.plus_minus for result in solve(single).values()])
    spent, found, own = seconds_of(lambda: path(model, *given))
    more, estimate, others = seconds_of(lambda: found.estimate)
    print(
        f"{name}: {len(found.support_events)} named events, {len(found.stops)} stops to t = {found.end:.6g} "
        f"({found.ending}); {own} solves in {spent:.2f} s, {others} on meshes of {estimate.elements[1:]} elements for "
        f"half-widths in {more:.2f} s; one solve with half-widths {alone:.2f} s; ratio {(spent + more) / alone:.1f}"
    )
    return (spent + more) / alone


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--divisions", type=int, default=160)
    parser.add_argument("--check", action="store_true")
    given = parser.parse_args()
    seconds_of(lambda: [one.plus_minus for one in solve(base_plate({"column": 1.0})).values()])  # reads all modules
    grown = strip(combination=[{"name": "one", "factors": {"G": 1.0, "Q": 60.0}}])
    ratios = [
        with_half_widths("strip", strip(), grown, "G", "Q", 60.0),
        with_half_widths(
            "base plate", base_plate({"wind": -1.0}), base_plate({"column": 1.0, "wind": -1.0}), "column", "one"
        ),
    ]
    divisions = 40 if given.check else given.divisions

    def linear():
        problem = contact_problem(slab(_SOIL, divisions))
        return problem.solve(problem.discretisation.cases["G"])

    alone, _, _ = seconds_of(linear)
    spent, found, own = seconds_of(lambda: path(slab({**_SOIL, "resists": "down"}, divisions), "G", "Q"))
    print(
        f"slab A, {divisions} x {divisions}: {len(found.support_events)} named events, {len(found.stops)} stops to "
        f"t = {found.end:.6g} ({found.ending}); {own} solves in {spent:.2f} s; a linear solve {alone:.2f} s; "
        f"ratio {spent / alone:.1f}"
    )
    sys.exit(0 if max(ratios) <= _MOST_SOLVES and spent / alone <= _MOST_LINEAR else 1)


if __name__ == "__main__":
    main()
