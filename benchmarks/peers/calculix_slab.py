"""Slabs A and B by CalculiX: a layer of C3D8I on linear springs.

Springs that pull are removed and the slab is solved again, until none pulls and no removed spring would push. Nonlinear
springs of CalculiX act in geometrically nonlinear steps only; on rigid points these did not converge. A rigid point
indents a solid, so that the deflections of slab B depend on the mesh. Needs the program `ccx`, in Debian the package
calculix-ccx.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from absent import missing
from slab import POISSON, THICKNESS, YOUNG, Grid, main

MOST_SOLUTIONS = 30
"""Largest number of solutions of a slab."""


def deck(grid: Grid, springs: dict[int, float]) -> Iterator[str]:
    """Yield the lines of the input file; nodes are those of the bottom, then of the top, from 1."""
    count = len(grid.points)
    yield "*NODE, NSET=ALL"
    for layer, z in enumerate((0.0, THICKNESS)):
        for node, (x, y) in enumerate(grid.points.tolist(), start=1 + layer * count):
            yield f"{node}, {x:.9g}, {y:.9g}, {z:.9g}"
    yield "*ELEMENT, TYPE=C3D8I, ELSET=SLAB"
    for number, nodes in enumerate((grid.elements + 1).tolist(), start=1):
        yield ", ".join(map(str, (number, *nodes, *(node + count for node in nodes))))
    yield from ("*MATERIAL, NAME=CONCRETE", "*ELASTIC", f"{YOUNG:.9e}, {POISSON}")
    yield "*SOLID SECTION, ELSET=SLAB, MATERIAL=CONCRETE"
    by_stiffness: dict[float, list[int]] = {}
    for node, stiffness in springs.items():
        by_stiffness.setdefault(round(stiffness, 3), []).append(node)
    last = len(grid.elements)
    for index, (stiffness, nodes) in enumerate(by_stiffness.items()):
        yield f"*ELEMENT, TYPE=SPRING1, ELSET=SPRINGS{index}"
        for node in nodes:
            last += 1
            yield f"{last}, {node + 1}"
        # A number without a decimal point is a dof, one with a decimal point is a stiffness.
        yield from (f"*SPRING, ELSET=SPRINGS{index}", "3", f"{stiffness:.9e}")
    # The springs hold vertical motions only.
    yield from ("*BOUNDARY", "1, 1, 2", f"{grid.n + 1}, 2")
    yield from ("*STEP", "*STATIC", "*CLOAD")
    for node, force in enumerate(grid.forces.tolist(), start=1):
        yield f"{node + count}, 3, {-force:.12e}"
    yield from ("*NODE PRINT, NSET=ALL", "U", "*END STEP")


def deflections(program: str, grid: Grid, springs: dict[int, float]) -> Any:
    """Deflections (k,) of the bottom, positive down, on linear springs."""
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "slab.inp").write_text("\n".join(deck(grid, springs)) + "\n")
        ran = subprocess.run([program, "slab"], cwd=name, capture_output=True, text=True)
        if ran.returncode:
            raise RuntimeError(ran.stdout[-2000:] + ran.stderr)
        rows = [row.split() for row in (Path(name) / "slab.dat").read_text().split("\n")]
    return -np.array([float(row[3]) for row in rows if len(row) == 4][: len(grid.points)])


def solve(case: str, n: int) -> dict[str, Any]:
    """Solve a case with n × n elements."""
    program = shutil.which("ccx")
    if program is None:
        missing("CalculiX (ccx)")
    grid = Grid(n)
    every = grid.supports(case)
    closed = set(every)
    for _ in range(MOST_SOLUTIONS):
        w = deflections(program, grid, {node: every[node] for node in closed})
        pushed = {node for node in every if w[node] > 0}
        if pushed == closed:
            return grid.figures(case, w)
        closed = pushed
    raise RuntimeError("the contact state repeats")


if __name__ == "__main__":
    main(solve)
