"""Processor time of a solve with half-widths, relative to the solve alone.

python benchmarks/plus_minus.py [--along 80 120] [--check]
"""

import argparse
import time

from signorini import Model, estimate, solve
from signorini.results.figures import figures

SOIL = [{"area": "all", "resists": "down", "stiffness": 30e6}]
BEARINGS = [{"at": [[x, y] for x in (0.5, 3.5, 6.5, 9.5) for y in (0.5, 3.5, 6.5, 9.5)], "resists": "down"}]
EDGES = [{"edge": ["left", "right", "bottom", "top"], "resists": "down"}]


def seconds(supports, along):
    """Processor time [s] of a solve, and of its half-widths."""
    model = Model(
        material={"E": 30e9, "nu": 0.2},
        plate={"shape": "rectangle", "size": [10, 10], "thickness": 0.3},
        mesh={"divisions": [along, along]},
        support=supports,
        load=[{"pressure": 2e3}, {"pressure": 500e3, "area": {"rectangle": [0.5, 0.5, 1.5, 1.5]}}],
        probe=[{"at": [[5, 5], [1, 1]]}],
    )
    begun = time.process_time()
    results = solve(model)
    figures(results["all"])
    solved = time.process_time()
    estimate(results)
    return solved - begun, time.process_time() - solved


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--along", type=int, nargs="+", default=[80, 120], help="elements along a side")
    parser.add_argument("--check", action="store_true", help="a small plate, to test the script")
    asked = parser.parse_args()
    seconds(BEARINGS, 8)
    for along in [36] if asked.check else asked.along:
        for name, supports in (("soil", SOIL), ("bearings", BEARINGS), ("edges", EDGES)):
            alone, more = min(seconds(supports, along) for _ in range(3))
            print(f"{along}x{along} {name:9} solve {alone:.2f} s, with ± {alone + more:.2f} s: {1 + more / alone:.2f}")


if __name__ == "__main__":
    main()
