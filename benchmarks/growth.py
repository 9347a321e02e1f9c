"""Growth of time and memory with the number of dofs: slab A on successive meshes, from model to certified result.

Every mesh is solved in its own process; small ones several times, with the median time. Memory is the peak of the
process after its first solve, minus the memory of the imports. Exponents are computed between successive meshes and
over all. Nested dissection in the plane has the exponents n^1.5 in time and n log n in memory.

    python benchmarks/growth.py [--elements 20 40 80 160 320]      640 has 3.7 million dofs and takes many GB
    python benchmarks/growth.py --check                            answers only, on two small meshes
"""

import argparse
import json
import math
import statistics
import sys
import time

from processes import peak_mb, run

TARGETS = {"seconds": 1.5, "memory_mb": 1.15}
SETTLEMENT = 4.229e-3


def solve_once(elements: int, turns: int) -> dict[str, float]:
    from tensionless import slab_a

    from signorini import solve

    idle, seconds, memory = peak_mb(), [], 0.0
    for turn in range(turns):
        begun = time.perf_counter()
        results = solve(slab_a(elements))
        seconds.append(time.perf_counter() - begun)
        if turn == 0:
            memory = peak_mb() - idle
    result = results["all"]
    assert result.certificate.passed
    return {
        "elements": elements,
        "dofs": results.discretisation.dof_count,
        "seconds": statistics.median(seconds),
        "memory_mb": memory,
        "settlement": float(result.deflection.max()),
        "steps": result.iterations,
        **{f"{name}_s": spent for name, spent in results.seconds.items() if name != "total"},
    }


def exponent(a: dict[str, float], b: dict[str, float], what: str) -> float:
    return math.log(b[what] / a[what]) / math.log(b["dofs"] / a["dofs"])


def measure(elements: list[int]) -> None:
    rows: list[dict[str, float]] = []
    print("elements      dofs      time  memory   exponents    mesh  model  order  factor  contact  recover   steps")
    for n in elements:
        found = run(__file__, "--run", n, "--turns", 5 if n <= 80 else 1)
        powers = [exponent(rows[-1], found, what) for what in TARGETS] if rows else []
        rows.append(found)
        parts = [found[f"{name}_s"] for name in ("mesh", "assemble", "order", "factor", "contact", "recover")]
        print(
            f"{n:4} × {n:<4} {found['dofs']:8} {found['seconds']:8.3f} s {found['memory_mb']:6.0f} MB  "
            f"{'  '.join(f'{p:.2f}' for p in powers):10}  {'  '.join(f'{part:6.3f}' for part in parts)}  "
            f"{found['steps']:5}",
            flush=True,
        )
    if len(rows) > 1:
        whole = {what: exponent(rows[0], rows[-1], what) for what in TARGETS}
        print(
            f"overall n^{whole['seconds']:.2f} in time (target {TARGETS['seconds']}), "
            f"n^{whole['memory_mb']:.2f} in memory (target {TARGETS['memory_mb']})"
        )


def check() -> None:
    rows = [run(__file__, "--run", n) for n in (20, 40)]
    errors = [abs(row["settlement"] / SETTLEMENT - 1) for row in rows]
    print(
        ", ".join(f"{row['elements']} elements: settlement off by {e:.1e}" for row, e in zip(rows, errors, strict=True))
    )
    sys.exit(0 if errors[0] < 2e-3 and errors[1] < 5e-4 else 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, nargs="+", default=[20, 40, 80, 160, 320])
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--run", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--turns", type=int, default=1, help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.run:
        print(json.dumps(solve_once(given.run, given.turns)))
    elif given.check:
        check()
    else:
        measure(given.elements)


if __name__ == "__main__":
    main()
