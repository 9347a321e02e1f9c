"""Search for numbers that grow without limit but are not reported as singular: random plates with points.

Each of four meshes has half the element size of the previous one; numbers that grow on all four are also computed on a
fifth mesh. The numbers are those of results.json, and the largest moments and shears on the finest mesh away from the
reported singularities (farther than `within` and than two elements of the coarsest mesh). Numbers that grow from each
mesh to the next, by the rule of signorini.accuracy.half_width, must be reported as singular. Two effects grow in the
same way, but have a limit:

- boundary layers of edges, thickness steps and ends of supports on meshes that do not resolve them
  (signorini.accuracy.layers). Plates are left out if a solid plate with an equally wide layer is thinner than the
  elements of the second finest mesh;
- all numbers of a plate on point supports, whose stiffness falls with the logarithm of the element size. Then only the
  largest moments and shears are checked, relative to the field's mean around them, which grows too.

    python benchmarks/singular_numbers.py [--count 100] [--first 700000] [--along 8 12] [--seconds 3600]
    python benchmarks/singular_numbers.py --check        a few plates, to test the script
"""

from __future__ import annotations

import argparse
import math
import signal
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fuzz"))
import half_width_coverage

from signorini import SignoriniError, solve
from signorini.accuracy.half_width import (
    away,
    half_widths,
    may_grow,
    sections_at,
    side,
    sizes_of,
)
from signorini.model.whole import supports_and_loads

_FACTORS = (0.0625, 0.125, 0.25, 0.5, 1.0)
"""Factors of the element size, the finest mesh first. The finest mesh is solved only if the others show growth."""
_TOO_LONG = 60
_FEW = (4, 5)
"""Smallest and largest number of elements along a side if only the script is tested."""


class Late(BaseException):
    """The time for a plate is over."""


def _late(number, frame):
    raise Late


def unnamed(seed, along):
    """Numbers of a plate that grow without limit but are not reported as singular; None without an answer."""
    try:
        model = half_width_coverage.plate(seed, *along)
        if not acts_at_points(model):
            return None
        first = model.effective_combinations[0]
        model = model.model_copy(update={"combination": (first,)})
        results = [_solved(model, factor) for factor in _FACTORS[1:]]
        if any(result.status != "solved" for result in results) or _thinnest(results[0]) < side(results[1].mesh):
            return None
        seen = growing(results)
        return seen and {
            name: what for name, what in growing([_solved(model, _FACTORS[0]), *results]).items() if name in seen
        }
    except SignoriniError:
        return None


def acts_at_points(model):
    """Whether a force, a couple or a support acts at a point, not on a footprint."""
    points = any(item.at is not None and not item.has_footprint for item in supports_and_loads(model))
    return points or any(moving.patch is None for moving in model.moving)


def _solved(model, factor):
    mesh = model.plate.scaled(model.mesh, factor, model.divisions)
    return solve(model.model_copy(update={"mesh": mesh}))[model.effective_combinations[0].name]


def growing(results):
    """Unreported numbers that grow from each mesh to the next, which has half the element size."""
    sizes = [side(result.mesh) for result in results]
    reach, own = 2.0 * sizes[-1], results[-1]
    numbers, largest = own.catalogue.numbers, sizes_of(own.numbers[:, None], own.catalogue.numbers, own.model, own.mesh)
    probes = np.array([probe.at for probe in own.probes]).reshape(-1, 2)
    grows = may_grow(numbers, own.model, probes, own.singular, reach).tolist()
    values = zip(*(result.numbers.tolist() for result in results), strict=True)
    rows = [
        (one.column, "", largest[one.quantity.kind].item(), list(of))
        for one, of, may in zip(numbers, values, grows, strict=True)
        if one.estimated and not may and not any("reaction" in each.numbers for each in own.singular)
    ]
    for kind in ("moment", "shear"):
        points = _away_from_named(results, kind, reach)
        if len(points) == 0:
            continue
        there = np.array([np.abs([getattr(at, kind) for at in result.probe(points)]).max(axis=1) for result in results])
        at = points[there[0].argmax()]
        around = np.sqrt((there[:, np.hypot(*(points - at).T) <= reach] ** 2).mean(axis=1))
        peaks = there.max(axis=1) * around[-1] / np.maximum(around, np.finfo(float).tiny)
        rows.append((f"largest {kind}", f" at {at.round(6).tolist()}", largest[kind].item(), peaks.tolist()))
    if not rows:
        return {}
    values, none = np.array([row[3] for row in rows]).T, np.zeros(len(rows))
    size = np.array([row[2] for row in rows])
    steps = ((values[k : k + 3], sizes[k : k + 3]) for k in range(len(results) - 2))
    grown = np.all([half_widths(*step, 2, none, size, none > 0)[1] for step in steps], axis=0)
    return {row[0]: f"{row[1]}: {row[3][::-1]}" for row, grows in zip(rows, grown, strict=True) if grows}


def _thinnest(result):
    """Thickness of the thinnest solid plate that has a boundary layer as wide as this plate's."""
    solid, rigidities, which = sections_at(result.model, result.mesh.points)
    widths = np.array([math.sqrt(10.0 * one.in_twist / np.linalg.eigvalsh(one.shear).max()) for one in rigidities])
    return (solid * widths[which]).min()


def _away_from_named(results, kind, reach):
    """Nodes of the first mesh that are on all meshes and away from the singularities of the last mesh."""
    points = results[0].mesh.points
    far = np.all([result.mesh.locate(points).inside for result in results], axis=0)
    for one in results[-1].singular:
        if kind in one.numbers:
            far &= away(points, one) > max(reach, one.within)
    return points[far]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="plates with points and an answer")
    parser.add_argument("--first", type=int, default=700_000)
    parser.add_argument("--along", type=int, nargs=2, default=[8, 12], help="elements along a side, at least and most")
    parser.add_argument("--seconds", type=float, default=math.inf, help="no new plate after this time")
    parser.add_argument("--check", action="store_true")
    asked = parser.parse_args()
    if asked.check:
        asked.count, asked.along = 3, _FEW
    signal.signal(signal.SIGPROF, _late)
    plates, late, guilty, begun, seed = 0, 0, 0, time.monotonic(), asked.first
    while plates < asked.count and time.monotonic() - begun < asked.seconds:
        signal.setitimer(signal.ITIMER_PROF, _TOO_LONG)
        try:
            found = unnamed(seed, asked.along)
        except Late:
            found, late = None, late + 1
        signal.setitimer(signal.ITIMER_PROF, 0)
        plates += found is not None
        guilty += bool(found)
        for name, what in (found or {}).items():
            print(f"seed {seed}, {name}{what}", flush=True)
        seed += 1
    print(
        f"{plates} plates with points, {guilty} with numbers that grow without a name; {late} took over {_TOO_LONG} s"
    )


if __name__ == "__main__":
    main()
