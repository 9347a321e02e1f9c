"""Random ribbons: long narrow thin plates on a few elements, compared with beams in closed form.

Width over length is from 1e-3 to 1, thickness over length from 1e-6 to 1e-2, both log-uniform. The short edges are
held, or supported from below only. The load is a pressure or a stress-free curvature. With nu = 0 the plate is exactly
a beam; with nu = 0.3 it is a beam within a percent if its width is at most a tenth of its length. For the worst ribbons
double precision cannot separate bending from shear: an answer must be within 2 %, or refused.

    python benchmarks/ribbons.py [--samples 700] [--seed 1]
    python benchmarks/ribbons.py --check        40 samples; fails if a certified answer is wrong
"""

from __future__ import annotations

import argparse
import collections
import sys

import numpy as np

from signorini import Model, solve
from signorini.errors import SignoriniError

WRONG = 0.02
"""Largest relative error of a right deflection; the error of four quadratic beam elements is far smaller."""


def ribbon(seed, number):
    """Keywords of `Model` for one ribbon, and the exact deflection at the middle of the ribbon."""
    rng = np.random.default_rng((seed, number))
    length = 10.0 ** rng.uniform(-1, 3)
    nu = float(rng.choice([0.0, 0.3]))
    width = length * 10.0 ** rng.uniform(-3, -1 if nu else 0)
    thickness = length * 10.0 ** rng.uniform(-6, -2)
    young = 10.0 ** rng.uniform(3, 11)
    edges = {"edge": ["left", "right"]} | ({"fix": "simple"} if rng.random() < 0.5 else {"resists": "down"})
    turned = rng.random() < 0.25
    if turned:
        edges["edge"] = ["bottom", "top"]
    size, divisions = [length, width], [int(rng.integers(4, 9)), int(rng.choice([1, 2, 4]))]
    # A curvature would lift the plate off one-sided edges, so there the load is a pressure.
    curved = edges.get("fix") == "simple" and rng.random() < 0.3
    load = 10.0 ** rng.uniform(-3, 3)
    if curved:
        load *= 1e-3 / length
        along, across = load, -nu * load
        loads = {"curvature": [across, along, 0.0] if turned else [along, across, 0.0]}
        exact = -load * length**2 / 8
    else:
        loads = {"pressure": load}
        shear = 5 / 6 * young * thickness / (2 * (1 + nu))
        exact = load * length**4 * 5 / 384 / (young * thickness**3 / 12) + load * length**2 / (8 * shear)
    if turned:
        size, divisions = size[::-1], divisions[::-1]
    model = {
        "material": {"E": young, "nu": nu},
        "plate": {"shape": "rectangle", "size": size, "thickness": thickness},
        "mesh": {"divisions": divisions},
        "support": [{"name": "edges", **edges}],
        "load": [loads],
        "probe": [{"at": [size[0] / 2, size[1] / 2]}],
    }
    return model, exact


def judged(seed, number):
    """Verdict on one ribbon, the error if there is an answer, and the certificate or the reason of a refusal."""
    model, exact = ribbon(seed, number)
    try:
        result = solve(Model(**model))["all"]
    except SignoriniError as refusal:
        return "refused", 0.0, f"{type(refusal).__name__}: {refusal}"
    error = abs(result.probes[0].deflection / exact - 1)
    return "limited" if result.certificate.limited else "certified", error, str(result.certificate)


def main():
    """Judge all samples; return 1 if a certified answer is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--samples", type=int, default=700)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--verbose", action="store_true", help="print every refused or wrong sample")
    given = parser.parse_args()
    counts, worst, wrong = collections.Counter(), collections.defaultdict(float), 0
    for number in range(40 if given.check else given.samples):
        verdict, error, words = judged(given.seed, number)
        counts[verdict] += 1
        worst[verdict] = max(worst[verdict], error)
        wrong += error > WRONG
        if error > WRONG or (given.verbose and verdict == "refused"):
            size = ribbon(given.seed, number)[0]
            print(f"{number}: {verdict}, wrong by {error:.3g}; {words}\n    {size}")
    for verdict, count in counts.items():
        print(f"{verdict}: {count}" + (f", wrong by at most {worst[verdict]:.2g}" if verdict != "refused" else ""))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
