"""Slabs A and B by signorini: n/2 × n/2 elements mitc9, so that a side has as many nodes as with the other programs.

The time is without the estimate of the mesh error (±), which the other programs do not have.
"""

from __future__ import annotations

from typing import Any

from absent import missing
from slab import BEARINGS, PATCH, PATCH_ENDS, POISSON, SIDE, SOIL, THICKNESS, UNIFORM, YOUNG, Grid, main

try:
    from signorini import Model
    from signorini import solve as solved
except ImportError:
    missing("signorini")


def solve(case: str, n: int) -> dict[str, Any]:
    """Solve a case with n/2 × n/2 elements."""
    begin, end = PATCH_ENDS
    support = {"A": {"area": "all", "stiffness": SOIL}, "B": {"at": BEARINGS}}[case]
    model = Model(
        material={"E": YOUNG, "nu": POISSON},
        plate={"shape": "rectangle", "size": [SIDE, SIDE], "thickness": THICKNESS},
        mesh={"divisions": [Grid(n).n // 2] * 2, "error": False},
        support=[{"name": "support", "resists": "down", **support}],
        load=[{"pressure": UNIFORM}, {"pressure": PATCH, "area": {"rectangle": [begin, begin, end, end]}}],
    )
    result = solved(model)["all"]
    if not result.certificate.passed:
        raise RuntimeError(str(result.certificate))
    found = {"settlement": float(result.deflection.max()), "uplift": -float(result.deflection.min())}
    below = result.supports[0]
    if case == "B":
        return found | {"reactions": below.reactions.tolist()}
    return found | {"pressure": below.max_pressure, "contact": (below.contact_area or 0.0) / SIDE**2}


if __name__ == "__main__":
    main(solve)
