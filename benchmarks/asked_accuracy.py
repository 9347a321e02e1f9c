"""Refinement to a requested accuracy, compared with the coarsest uniform mesh that reaches it: time and elements.

python benchmarks/asked_accuracy.py [--accuracy 0.01] [--check]
"""

import argparse
import time

from plus_minus import EDGES, SOIL

from signorini import Model, estimate, solve
from signorini.accuracy.meshes import worst_of


def timed(supports, **mesh):
    """Processor seconds of a solve with half-widths; its results; the largest ratio of a half-width to its field."""
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        mesh=mesh,
        support=supports,
        load=[{"pressure": 2e3}, {"pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
        probe=[{"at": [[5, 5], [1, 1], [2, 2]]}],
    )
    begun = time.process_time()
    results = solve(model)
    worst = worst_of(estimate(results))
    return time.process_time() - begun, results, worst


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--accuracy", type=float, default=0.01)
    parser.add_argument("--check", action="store_true", help="a low accuracy, to test the script")
    asked = parser.parse_args()
    accuracy = 0.1 if asked.check else asked.accuracy
    for name, supports in (("slab A on soil", SOIL), ("one-sided square", EDGES)):
        spent, results, worst = timed(supports, accuracy=accuracy)
        steps = ", ".join(f"{step.elements} ± {step.worst:.2g}" for step in results.refinement)
        print(f"{name}: {spent:.1f} s to {worst.worst:.4f}; elements {steps}")
        for along in range(20, 241, 20):
            uniform, _, reached = timed(supports, divisions=[along, along])
            if reached.worst <= accuracy:
                print(f"  uniform {along}x{along}: {uniform:.1f} s to {reached.worst:.4f}; ratio {spent / uniform:.2f}")
                break
        else:
            print(f"  uniform: not reached on {along}x{along} in {uniform:.1f} s; ratio below {spent / uniform:.2f}")


if __name__ == "__main__":
    main()
