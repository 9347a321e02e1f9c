"""Slabs A and B by PyNite: MITC4 quadrilaterals on springs that only push, which an iteration switches off."""

from __future__ import annotations

from typing import Any

import numpy as np
from absent import missing
from slab import POISSON, THICKNESS, YOUNG, Grid, main

try:
    from Pynite import FEModel3D
except ImportError:
    missing("PyNiteFEA")


def solve(case: str, n: int) -> dict[str, Any]:
    """Solve a case with n × n elements."""
    grid, model = Grid(n), FEModel3D()
    model.add_material("concrete", YOUNG, YOUNG / 2 / (1 + POISSON), POISSON, 0.0)
    for node, (x, y) in enumerate(grid.points.tolist()):
        model.add_node(str(node), x, y, 0.0)
        model.def_support(str(node), True, True, False, False, False, True)
    for number, nodes in enumerate(grid.elements.tolist()):
        model.add_quad(str(number), *map(str, nodes), THICKNESS, "concrete")
    for node, stiffness in grid.supports(case).items():
        model.def_support_spring(str(node), "DZ", stiffness, "-")
    for node, force in enumerate(grid.forces.tolist()):
        model.add_node_load(str(node), "FZ", -force)
    model.analyze(sparse=True, max_iter=100)
    w = np.array([-model.nodes[str(node)].DZ["Combo 1"] for node in range(len(grid.points))])
    return grid.figures(case, w)


if __name__ == "__main__":
    main(solve)
