"""Lemke's algorithm on plate problems, against QuantEcon's ``lcp_lemke``: ratio of times and accuracy of both.

The problems are contact problems of a simply supported rectangular Kirchhoff plate, 1.3 by 1, whose compliance between
the points of a grid is summed from Navier's double sine series, without finite elements. The load is a checkerboard of
pressures with an eccentric patch on top, over m points of support that only push up, at gaps that vary from point to
point. Each problem comes in its dual form (M the compliance, z the reaction) and in its stiffness form (M the inverse
of the compliance, z the remaining gap).

Both programs run in this process, one after the other, after QuantEcon has been compiled; times are medians. The error
is computed for both in extended precision, from z alone: max_i |min(z_i / max z, w_i / t_i)| with w = Mz + q and t =
|q| + |M||z|.

    python benchmarks/lemke.py            # the table
    python benchmarks/lemke.py --check    # exits with 1 unless both are right and agree
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from quantecon.optimize import lcp_lemke

from signorini._core import lemke

Array = NDArray[np.float64]

SIDES = (1.3, 1.0)
GRIDS = ((10, 5), (10, 10), (20, 10), (25, 20), (40, 25))
MODES = 80
TOLERANCE = 1e-8


def sines(points: int, side: float) -> tuple[Array, Array]:
    """Normalised sine functions (points, MODES) at the inner points of a uniform grid, and their wave numbers."""
    numbers = np.arange(1, MODES + 1) * np.pi / side
    at = side * np.arange(1, points + 1) / (points + 1)
    return np.sqrt(2 / side) * np.sin(np.outer(at, numbers)), numbers


def plate(columns: int, rows: int) -> tuple[Array, Array]:
    """Compliance P (m, m) and s (m,) of m = columns × rows points; s is the unsupported deflection minus the gap."""
    (across, kx), (along, ky) = sines(columns, SIDES[0]), sines(rows, SIDES[1])
    shapes = np.einsum("im,jn->ijmn", across, along).reshape(columns * rows, MODES**2)
    compliance = shapes / np.add.outer(kx**2, ky**2).ravel() ** 2
    fine = 200
    (sx, _), (sy, _) = sines(fine, SIDES[0]), sines(fine, SIDES[1])
    x, y = np.meshgrid(*(np.arange(1, fine + 1) / (fine + 1),) * 2, indexing="ij")
    checkerboard = np.where((np.floor(4 * x) + np.floor(3 * y)) % 2 == 0, 1.0, -0.6)
    patch = 3.0 * ((abs(x - 0.7) < 0.15) & (abs(y - 0.35) < 0.15))
    cell = SIDES[0] * SIDES[1] / (fine + 1) ** 2
    load = (sx.T @ (checkerboard + patch) @ sy).ravel() * cell
    free = compliance @ load
    gap = 0.02 * free.max() * np.random.default_rng(7).random(len(free))
    return compliance @ shapes.T, free - gap


def error(matrix: Array, q: Array, z: Array) -> float:
    """Complementarity error max_i |min(z_i / max z, w_i / t_i)| of z, see above."""
    m, load, unknown = (np.asarray(a, dtype=np.longdouble) for a in (matrix, q, z))
    slack, size = m @ unknown + load, abs(m) @ abs(unknown) + abs(load)
    return float(abs(np.minimum(unknown / abs(unknown).max(), slack / size)).max())


def median_seconds(run: Callable[[], object], repeats: int) -> float:
    """Median time of several runs [s]."""
    seconds = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds)


def compare(name: str, matrix: Array, q: Array, repeats: int) -> bool:
    """Print times and errors of one problem; return whether both programs solve it and agree."""
    ours, theirs = lemke(matrix, q), lcp_lemke(matrix, q)
    mine = median_seconds(lambda: lemke(matrix, q), repeats)
    peer = median_seconds(lambda: lcp_lemke(matrix, q), repeats)
    errors = error(matrix, q, ours.z), error(matrix, q, theirs.z)
    apart = float(abs(ours.z - theirs.z).max() / abs(ours.z).max())
    print(
        f"{name:<10} {len(q):>5} {int(ours.basis.sum()):>6} {ours.pivots:>7} {theirs.num_iter:>7} {mine * 1e3:>10.2f} "
        f"{peer * 1e3:>10.2f} {mine / peer:>7.3f} {errors[0]:>9.1e} {errors[1]:>9.1e} {apart:>9.1e}"
    )
    return ours.status == "solved" and bool(theirs.success) and max(*errors, apart) <= TOLERANCE


def main() -> int:
    """Compare both programs on every size in both forms."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="exit with 1 unless both programs are right and agree")
    parser.add_argument("--repeats", type=int, default=5, help="runs of each program (default 5)")
    options = parser.parse_args()

    lcp_lemke(np.eye(2), -np.ones(2))
    print(f"{'':<10} {'':>5} {'z > 0':>6} {'pivots':^15} {'time, ms':^21} {'':>7} {'error':^19}")
    print(f"{'form':<10} {'m':>5} {'':>6} {'ours':>7} {'theirs':>7} {'ours':>10} {'theirs':>10} {'ratio':>7} ", end="")
    print(f"{'ours':>9} {'theirs':>9} {'apart':>9}")
    right = True
    for grid in GRIDS:
        compliance, free = plate(*grid)
        stiffness = np.linalg.inv(compliance)
        stiffness = (stiffness + stiffness.T) / 2
        right &= compare("dual", compliance, -free, options.repeats)
        right &= compare("stiffness", stiffness, stiffness @ free, options.repeats)
    print("both right and in agreement" if right else "NOT in agreement, or not right")
    return 0 if right or not options.check else 1


if __name__ == "__main__":
    sys.exit(main())
