"""First example of Bergmann, Carnicer and Sanzi: a clamped square whose centre meets a support after a gap.

A quarter of the plate, 2 x 2 elements of 8 nodes; nodes numbered row by row, 1 to 21. Nodes 1-5 and 1, 6, 9, 14, 17
are clamped, the other two sides are axes of symmetry, and node 21 is the centre of the plate, over a support that
only pushes, 0.48e-4 mm below it.

Two linear steps give the same as one unilateral one, or as one load path: R1, the free plate at the load that closes
the gap, and R2, the plate on the support for the rest of the load. Their sum is R*, the unilateral plate's reactions
in one step.

The paper gives neither size, thickness nor material, so the digits of its Table 1 are not matched (of equal
elements the nearest are 1.7 N off, of 12.6 N); it shows that one step and two agree. Here the quarter is 100 mm wide,
20 mm thick, nu = 0.3; its load is 64 N, and E is chosen so that the gap closes at exactly half of it.
"""

from __future__ import annotations

import sys
from typing import NamedTuple

import numpy as np

import signorini

SIDE, THICKNESS, NU = 100.0, 20.0, 0.3
GAP = 0.48e-4
TOTAL = 64.0
PRESSURE = TOTAL / SIDE**2
NAMES = np.array([1, 2, 3, 4, 5, 6, 8, 9, 13, 14, 16, 17, 18, 19, 20, 21])
"""The nodes that the paper's Table 1 lists: those on supports and on the axes of symmetry."""


class Table(NamedTuple):
    """Reactions at nodes 1 to 21, positive upward, of both steps and of the unilateral plate; and E."""

    first: np.ndarray
    second: np.ndarray
    unilateral: np.ndarray
    young: float


def quarter(pressure: float, young: float, element: str, *centre: dict) -> signorini.Model:
    """Make the quarter under a pressure, with or without a support under its centre."""
    return signorini.Model(
        units={"length": "mm", "force": "N"},
        material={"E": young, "nu": NU},
        plate={"shape": "rectangle", "size": [SIDE, SIDE], "thickness": THICKNESS, "element": element},
        mesh={"divisions": [2, 2]},
        support=[
            {"name": "clamped", "edge": ["bottom", "left"], "fix": "clamped"},
            {"name": "symmetry", "edge": ["right", "top"], "fix": "symmetry"},
            *({"name": "centre", "at": [SIDE, SIDE], **how} for how in centre),
        ],
        load=[{"pressure": pressure}],
    )


def plate(pressure: float, young: float, element: str, *centre: dict) -> signorini.Result:
    """Solve the quarter."""
    return signorini.solve(quarter(pressure, young, element, *centre))["all"]


def two_stages(young: float, element: str = "q8r") -> signorini.LoadPath:
    """Let the load grow from zero to its full value: both of the paper's stages are one path with one event."""
    model = quarter(PRESSURE, young, element, {"resists": "down", "gap": GAP})
    return signorini.path(model, None, "load", until=1.0)


def row_by_row(result: signorini.Result) -> np.ndarray:
    """Nodal reactions in the paper's order."""
    x, y = result.mesh.points.T
    return result.nodal_reaction[np.lexsort((x, y))]


def table(element: str = "q8r") -> Table:
    """Compute the columns of Table 1 with an element; the paper's is q8r."""
    half = PRESSURE / 2
    # Deflection is proportional to 1/E: one solution gives the E that closes the gap at half the load.
    young = 2e5 * plate(half, 2e5, element).probe([(SIDE, SIDE)])[0].deflection / GAP
    first = plate(half, young, element)
    second = plate(PRESSURE - half, young, element, {"fix": "simple"})
    unilateral = plate(PRESSURE, young, element, {"resists": "down", "gap": GAP})
    return Table(row_by_row(first), row_by_row(second), row_by_row(unilateral), young)


def printed(columns: Table) -> str:
    """Format the reactions as the paper prints them: negative upward."""
    lines = ["Node       R1        R2     R1+R2        R*"]
    total = columns.first + columns.second
    for node in NAMES:
        parts = (columns.first, columns.second, total, columns.unilateral)
        lines.append(f"{node:4d}" + "".join(f"{0.0 - round(part[node - 1], 3):10.3f}" for part in parts))
    sums = (columns.first, columns.second, total, columns.unilateral)
    lines.append(" sum" + "".join(f"{-part.sum():10.3f}" for part in sums))
    return "\n".join(lines)


def main() -> None:
    element = sys.argv[1] if len(sys.argv) > 1 else "q8r"
    columns = table(element)
    print(f"Element {element}, E = {columns.young:.6g} N/mm2. * Results in one step, unilateral support.\n")
    print("Nodal reactions in N as the paper prints them: negative where they push the plate up.")
    print(printed(columns))
    (event,) = two_stages(columns.young, element).support_events
    print(f"\nAs one path: the {event.support} {event.change} at {event.t:.12g} of the load.")
    print(f"\nlargest difference of R1+R2 and R*: {abs(columns.first + columns.second - columns.unilateral).max():.1e}")


if __name__ == "__main__":
    main()
