"""Table of slabs A and B by several programs: figures, time and memory.

    python benchmarks/peers/table.py [--elements 40] [--programs signorini getfem ...]

Every program runs in a process of its own, one after the other. A program that is not installed is named and left out.
PyNite and OpenSeesPy come by `pip install -e '.[benchmark]'`; GetFEM and CalculiX are Debian's python3-getfem and
calculix-ccx. Times are those from model to figures, without imports. Memory is the peak of the process.

Not compared are plate-solver 0.8 (its edges are held, while both slabs have free edges) and FERS (its licence, PolyForm
Strict, allows noncommercial use only).
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

from absent import MISSING

HERE = Path(__file__).parent
DEBIAN = "/usr/bin/python3"
PROGRAMS = {
    "signorini": ("signorini_slab.py", sys.executable),
    "getfem": ("getfem_slab.py", DEBIAN),
    "calculix": ("calculix_slab.py", sys.executable),
    "opensees": ("opensees_slab.py", sys.executable),
    "pynite": ("pynite_slab.py", sys.executable),
}
"""Script of each program, and the Python that runs it."""
HEADS = {
    "A": ("settlement [mm]", "uplift [mm]", "contact", "p max [kPa]", "time [s]", "memory [MB]"),
    "B": ("settlement [mm]", "uplift [mm]", "lifted points", "R max [kN]", "time [s]", "memory [MB]"),
}


def solved(program: str, case: str, elements: int) -> dict[str, Any] | str:
    """Figures of a case by a program, or the message of a missing program or a failure."""
    script, python = PROGRAMS[program]
    if shutil.which(python) is None:
        return f"{python} does not exist."
    command = [python, str(HERE / script), case, str(elements)]
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode:
        said = ran.stderr.strip().split("\n")[-1]
        return said if ran.returncode == MISSING else f"failed: {said}"
    lines = [line for line in ran.stdout.split("\n") if line.startswith("{")]
    found: dict[str, Any] = json.loads(lines[-1])
    return found


def row(case: str, found: dict[str, Any]) -> list[str]:
    """Cells of a program's row."""
    cells = [f"{1e3 * found['settlement']:.4f}", f"{1e3 * found['uplift']:.4f}"]
    if case == "A":
        cells += [f"{found['contact']:.4f}", f"{found['pressure'] / 1e3:.2f}"]
    else:
        reactions = found["reactions"]
        cells += [str(sum(reaction == 0 for reaction in reactions)), f"{max(reactions) / 1e3:.2f}"]
    return [*cells, f"{found['seconds']:.2f}", f"{found['peak_mb']:.0f}"]


def main() -> None:
    """Print a table for each case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--elements", type=int, default=40, help="along a side, a multiple of 20")
    parser.add_argument("--programs", nargs="+", choices=PROGRAMS, default=list(PROGRAMS))
    given = parser.parse_args()
    for case, heads in HEADS.items():
        print(f"\nSlab {case}, {given.elements} × {given.elements} (signorini: half as many, of second order)\n")
        print(f"| program | {' | '.join(heads)} |\n|---|{'---|' * len(heads)}")
        absent = []
        for program in given.programs:
            found = solved(program, case, given.elements)
            if isinstance(found, str):
                absent.append(f"{program}: {found}")
            else:
                print(f"| {program} | {' | '.join(row(case, found))} |", flush=True)
        for line in absent:
            print(line)


if __name__ == "__main__":
    main()
