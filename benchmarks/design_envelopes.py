"""Time of the envelopes of 8 design fields, relative to those of the linear fields: 20,000 nodes, 1,000 combinations.

Design fields are the design moments and the required reinforcement at both faces along x and y. Solves of both kinds
and of the same table without envelopes alternate; the time of the envelopes is the difference of the medians.

    python benchmarks/design_envelopes.py [--elements 81] [--combinations 1000] [--repeat 5]
"""

import argparse
import statistics
import time

from combinations import tables

import signorini
from signorini.results.quantities import DESIGN_MOMENTS, LINEAR, REINFORCEMENT

BARS = {"fck": 30e6, "fyk": 500e6, "cover": {"top": 0.03, "bottom": 0.03}, "bar": 0.012}
ENVELOPES = {
    "none": [],
    "linear": [name for name in LINEAR if not name.startswith("rotation")],
    "design": [*DESIGN_MOMENTS, *REINFORCEMENT],
}


def model(elements, combinations, envelope):
    """Slab B with reinforcement, and envelopes of the named fields."""
    data = tables(elements, combinations)
    data["output"]["envelope"] = ENVELOPES[envelope]
    data |= {"units": {"length": "m", "force": "N"}, "mesh": {"divisions": [elements, elements], "error": False}}
    return signorini.Model(**data, reinforcement={"code": "EN 1992-1-1:2004"} | BARS)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=81)
    parser.add_argument("--combinations", type=int, default=1000)
    parser.add_argument("--repeat", type=int, default=5)
    args = parser.parse_args()
    models = {name: model(args.elements, args.combinations, name) for name in ENVELOPES}
    seconds = {name: [] for name in models}
    for _ in range(args.repeat):
        for name, of in models.items():
            begun = time.perf_counter()
            results = signorini.solve(of)
            seconds[name].append(time.perf_counter() - begun)
    nodes = results.discretisation.mesh.node_count
    medians = {name: statistics.median(of) for name, of in seconds.items()}
    print(f"{nodes} nodes, {args.combinations} combinations, {results.discretisation.stress_nodes.count} stress nodes")
    for name, of in medians.items():
        print(f"{name:>8}: {len(ENVELOPES[name])} envelopes, solve {of:.3f} s (least {min(seconds[name]):.3f} s)")
    linear, design = (medians[name] - medians["none"] for name in ("linear", "design"))
    print(f"whole solves {medians['design'] / medians['linear']:.2f}, envelopes alone {design / linear:.2f}")


if __name__ == "__main__":
    main()
