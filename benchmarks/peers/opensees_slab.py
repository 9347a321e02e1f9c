"""Slabs A and B by OpenSeesPy: ShellMITC4 on springs without tension (ENT), by Newton's method."""

from __future__ import annotations

from typing import Any

import numpy as np
from absent import missing
from slab import POISSON, THICKNESS, YOUNG, Grid, main

try:
    import openseespy.opensees as ops
except (ImportError, RuntimeError):
    missing("openseespy")


def solve(case: str, n: int) -> dict[str, Any]:
    """Solve a case with n × n elements."""
    grid = Grid(n)
    count = len(grid.points)
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    for node, (x, y) in enumerate(grid.points.tolist(), start=1):
        ops.node(node, x, y, 0.0)
        ops.fix(node, 1, 1, 0, 0, 0, 1)
    ops.section("ElasticMembranePlateSection", 1, YOUNG, POISSON, THICKNESS, 0.0)
    for number, nodes in enumerate(grid.elements.tolist(), start=1):
        ops.element("ShellMITC4", number, *(node + 1 for node in nodes), 1)
    materials: dict[float, int] = {}
    for node, stiffness in grid.supports(case).items():
        if stiffness not in materials:
            materials[stiffness] = len(materials) + 1
            ops.uniaxialMaterial("ENT", materials[stiffness], stiffness)
        ground = count + node + 1
        ops.node(ground, *grid.points[node].tolist(), 0.0)
        ops.fix(ground, 1, 1, 1, 1, 1, 1)
        # The spring shortens where the slab moves down, against z.
        material = "-mat", materials[stiffness], "-dir", 3
        ops.element("zeroLength", len(grid.elements) + node + 1, ground, node + 1, *material)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for node, force in enumerate(grid.forces.tolist(), start=1):
        ops.load(node, 0.0, 0.0, -force, 0.0, 0.0, 0.0)
    ops.system("UmfPack")
    ops.numberer("RCM")
    ops.constraints("Plain")
    ops.test("NormDispIncr", 1e-10, 100)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    if ops.analyze(1):
        raise RuntimeError("OpenSees has not converged")
    return grid.figures(case, np.array([-ops.nodeDisp(node, 3) for node in range(1, count + 1)]))


if __name__ == "__main__":
    main(solve)
