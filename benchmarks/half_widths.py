"""Coverage and size of half-widths: random plates, compared with finer meshes.

The constants of signorini.accuracy.half_width were chosen on the seeds from 3100000, 7200000 and 8300000; use other
seeds. docs/accuracy.md has the results for the seeds from 3100000 and 9100000.

    python benchmarks/half_widths.py [--count 300] [--first 100000] [--along 8 24] [--seconds 3600] [--processes 2]
    python benchmarks/half_widths.py --check        a few plates, to test the script
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import signal
import statistics
import sys
import time
from collections import Counter
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fuzz"))
import half_width_coverage

_TOO_LONG = 60


class Late(BaseException):
    """The time for a plate is over."""


def _late(number, frame):
    raise Late


def one(seed, along):
    """Numbers of a plate with half-widths and the changes to a finer mesh; None if the plate takes too long."""
    # CPU time of this process does not depend on the load of the machine.
    signal.signal(signal.SIGPROF, _late)
    signal.setitimer(signal.ITIMER_PROF, _TOO_LONG)
    try:
        return seed, half_width_coverage.judged(seed, *along)
    except Late:
        return seed, None
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=300, help="plates with an answer")
    parser.add_argument("--first", type=int, default=100_000)
    parser.add_argument("--along", type=int, nargs=2, default=[8, 24], help="elements along a side, at least and most")
    parser.add_argument("--seconds", type=float, default=math.inf, help="no new plate after this time")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--check", action="store_true")
    asked = parser.parse_args()
    count = 3 if asked.check else asked.count
    plates, late, numbers, missed, begun = 0, 0, [], [], time.monotonic()
    with multiprocessing.Pool(asked.processes) as pool:
        seeds = range(asked.first, asked.first + 20 * count)
        for seed, found in pool.imap_unordered(partial(one, along=asked.along), seeds):
            late += found is None
            if found:
                plates += 1
                numbers += found
                missed += [(seed, number) for number in found if not number.covered]
            if plates == count or time.monotonic() - begun > asked.seconds:
                break
        pool.terminate()
    print(f"{plates} plates, {len(numbers)} numbers, {late} plates took longer than {_TOO_LONG} s")
    for kind in ("all", *sorted({number.kind for number in numbers})):
        of = [number for number in numbers if kind in ("all", number.kind)]
        moved = [n for n in of if n.width is not None and n.change > n.rounding]
        ratio = statistics.median(n.width / n.change for n in moved) if moved else 0.0
        covered = sum(number.covered for number in of) / max(1, len(of))
        without = sum(number.width is None for number in of)
        print(f"{kind:14} {len(of):7}  covered {covered:.4f}  median width/change {ratio:6.1f}  no limit {without}")
    worst = sorted(missed, key=lambda one: -one[1].change / (one[1].width or 1e-300))
    for seed, number in worst[:10]:
        print(f"seed {seed}, {number.what}: {number.change:.3g} beyond ± {number.width:.3g}")
    print("most often missed:", Counter(seed for seed, _ in missed).most_common(8))


if __name__ == "__main__":
    main()
