"""Time of the envelopes of 8 design fields, relative to those of the linear fields: 20,000 nodes, 1,000 combinations.

Design fields are the design moments and the required reinforcement at both faces along x and y. Solves of both kinds
and of the same table without envelopes alternate; the time of the envelopes is the difference of the medians.

    python benchmarks/design_envelopes.py [--elements 81] [--combinations 1000] [--repeat 5]
    python benchmarks/design_envelopes.py --check     values against NumPy, on a small model
"""

import argparse
import statistics
import sys
import time

import numpy as np
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
    """Slab B with reinforcement, and envelopes of the named fields or, with "each", all results of each combination."""
    data = tables(elements, combinations)
    data["output"] = (
        {"combinations": "each"} if envelope == "each" else data["output"] | {"envelope": ENVELOPES[envelope]}
    )
    data |= {"units": {"length": "m", "force": "N"}, "mesh": {"divisions": [elements, elements], "error": False}}
    return signorini.Model(**data, reinforcement={"code": "EN 1992-1-1:2004"} | BARS)


def at_bottom(mx, my, mxy):
    """Moments (2, n) of Wood and Armer for bars at the bottom along x and y."""
    x, y, zero = mx + abs(mxy), my + abs(mxy), np.zeros_like(mx)
    with np.errstate(divide="ignore", invalid="ignore"):
        for_x, for_y = mx + mxy**2 / abs(my), my + mxy**2 / abs(mx)
    alone = [np.where(y < 0, for_x, x), np.where(x < 0, for_y, y)]
    return np.maximum(
        np.select([(x < 0) & (y < 0), x < 0, y < 0], [[zero, zero], [zero, alone[1]], [alone[0], zero]], alone), 0
    )


def check():
    """Compare envelopes with extremes of single solves, design moments with formulas, bars with equilibrium."""
    table = signorini.solve(model(20, 40, "design"))
    each = signorini.solve(model(20, 40, "each"))
    every = {name: np.array([one.fields[name] for one in each.values()]) for name in each["c0"].fields}
    axes = [f"m{axis}_{face}" for face in ("bottom", "top") for axis in "xy"]
    mx, my, mxy = (every[name] for name in ("mx", "my", "mxy"))
    size, worst = max(abs(of).max() for of in (mx, my, mxy)), 0.0
    for name, moments in zip(axes, [*at_bottom(mx, my, mxy), *-at_bottom(-mx, -my, mxy)], strict=True):
        worst = max(worst, abs(every[name] - moments).max() / size)
    for name in ENVELOPES["design"]:
        of, ends = table.envelope.fields[name], (every[name].max(axis=0), every[name].min(axis=0))
        for found, end in zip((of.largest, of.smallest), ends, strict=True):
            worst = max(worst, abs(found - end).max() / abs(every[name]).max())
    block, strength, bars = 30e6 / 1.5, 500e6 / 1.15, 0
    for name in REINFORCEMENT:
        depth = 0.3 - BARS["cover"]["top"] - BARS["bar"] * (0.5 if "_x_" in name else 1.5)
        area, least = every[name], max(0.26 * 0.3 * 30 ** (2 / 3) / 500, 0.0013) * depth
        more = area > least * (1 + 1e-9)
        resisted = strength * area * (depth - strength * area / (2 * block))
        worst = max(worst, abs(resisted - abs(every[REINFORCEMENT[name]]))[more].max(initial=0.0) / size)
        bars += int(more.sum())
    print(f"40 combinations, {bars} areas above the minimum: largest relative difference {worst:.1e}")
    sys.exit(0 if worst <= 1e-9 and bars > 100 else 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=81)
    parser.add_argument("--combinations", type=int, default=1000)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--check", action="store_true")
    args = parser.parse_args()
    if args.check:
        check()
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
