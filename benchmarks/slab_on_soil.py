"""Slab A on soil that only pushes, from model to certified result: time and memory relative to GetFEM.

GetFEM solves 160 × 160 elements, MITC4 and Newton's method (`peers/getfem_slab.py`). This program solves the coarsest
mesh that meets the accuracy: settlement to 0.05 %, largest pressure to 0.1 %, fraction in contact to 0.002. Runs
alternate, each in its own process. Times are medians without imports. Memory is the process's peak, including imports.
"Warm" is a second solve in the same process.

    python benchmarks/slab_on_soil.py [--elements 40] [--peer-elements 160] [--repeat 5]
    python benchmarks/slab_on_soil.py --check           answers only, and GetFEM's on 40 × 40 if it is installed

GetFEM is Debian's python3-getfem; without it only this program's results are shown.
"""

import argparse
import json
import statistics
import subprocess
import sys
import time
from pathlib import Path

from processes import peak_mb, run

PEER = Path(__file__).parent / "peers" / "getfem_slab.py"
CONVERGED = {"settlement": 4.229e-3, "contact": 0.916, "pressure": 126.86e3}
"""Values on which GetFEM, CalculiX and OpenSees agree."""


def ours(elements: int) -> dict[str, float]:
    begun = time.perf_counter()
    from tensionless import slab_a, slab_a_figures

    from signorini import solve

    imports, idle = time.perf_counter() - begun, peak_mb()
    seconds = []
    for turn in range(2):
        begun = time.perf_counter()
        result = solve(slab_a(elements))["all"]
        seconds.append(time.perf_counter() - begun)
        if turn == 0:
            peak = peak_mb()
    assert result.certificate.passed
    return {
        **slab_a_figures(result),
        "seconds": seconds[0],
        "warm": seconds[1],
        "imports": imports,
        "idle_mb": idle,
        "peak_mb": peak,
    }


def accurate(found: dict[str, float]) -> bool:
    """Whether settlement, pressure and contact area are accurate enough."""
    return (
        abs(found["settlement"] / CONVERGED["settlement"] - 1) <= 5e-4
        and abs(found["pressure"] / CONVERGED["pressure"] - 1) <= 1e-3
        and abs(found["contact"] - CONVERGED["contact"]) <= 2e-3
    )


def peer_python() -> str | None:
    """Path of a Python that has GetFEM; None if there is none."""
    for python in ("/usr/bin/python3", sys.executable):
        try:
            if subprocess.run([python, "-c", "import getfem"], capture_output=True).returncode == 0:
                return python
        except FileNotFoundError:
            continue
    print("GetFEM is not installed: no comparison (Debian: apt-get install python3-getfem)")
    return None


def median(rows: list[dict[str, float]]) -> dict[str, float]:
    return {key: statistics.median(row[key] for row in rows) for key in rows[0]}


def show(name: str, elements: int, found: dict[str, float]) -> None:
    print(
        f"{name:8} {elements:4} × {elements:<4} {found['seconds']:7.3f} s  peak {found['peak_mb']:4.0f} MB "
        f"(idle {found['idle_mb']:.0f})  settlement {1e3 * found['settlement']:.5f} mm  "
        f"pressure {found['pressure'] / 1e3:.3f} kPa  contact {found['contact']:.4f}"
    )


def compare(elements: int, peer_elements: int, repeat: int) -> None:
    python = peer_python()
    mine, theirs = [], []
    for turn in range(repeat):
        mine.append(run(__file__, "--run", "--elements", elements))
        if python and turn < 3:
            theirs.append(run(str(PEER), "A", peer_elements, python=python))
    us = median(mine)
    show("ours", elements, us)
    print(f"         warm {us['warm']:.3f} s, imports {us['imports']:.2f} s; accurate enough: {accurate(us)}")
    if theirs:
        them = median(theirs)
        show("GetFEM", peer_elements, them)
        print(
            f"ours is {them['seconds'] / us['seconds']:.1f} times faster ({them['seconds'] / us['warm']:.1f} warm) "
            f"in {us['peak_mb'] / them['peak_mb']:.2f} of the memory"
        )


def check() -> None:
    """Check that this program's result is accurate, and that GetFEM's on the same mesh is close to it."""
    us = run(__file__, "--run", "--elements", 40)
    show("ours", 40, us)
    passed = accurate(us)
    if python := peer_python():
        them = run(str(PEER), "A", 40, python=python)
        show("GetFEM", 40, them)
        passed &= abs(them["settlement"] / us["settlement"] - 1) < 1e-3 and abs(them["contact"] - us["contact"]) < 5e-3
    sys.exit(0 if passed else 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=40)
    parser.add_argument("--peer-elements", type=int, default=160)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--run", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.run:
        print(json.dumps(ours(given.elements)))
    elif given.check:
        check()
    else:
        compare(given.elements, given.peer_elements, given.repeat)


if __name__ == "__main__":
    main()
