"""Slabs A and B for all programs of this directory: dimensions, loads, a square mesh, and the line of JSON.

A slab 10 m × 10 m × 0.3 m, E = 30 GPa, ν = 0.2, under 2 kPa and 500 kN on the square of side 1 m around (1, 1). Slab A
lies on soil that only pushes, 30 MN/m³. Slab B lies on 16 rigid points that only push. Every script runs as

    python benchmarks/peers/pynite_slab.py CASE N

with the case A or B and N elements along a side, N a multiple of 20. It prints a line of JSON in m, Pa and N. Exit code
3 means that the program is not installed. This module needs NumPy only, since each program runs in a Python of its own.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

SIDE, THICKNESS, YOUNG, POISSON, SOIL = 10.0, 0.3, 30e9, 0.2, 30e6
UNIFORM, PATCH, PATCH_ENDS = 2e3, 500e3, (0.5, 1.5)
BEARINGS = [(x, y) for y in (0.5, 3.5, 6.5, 9.5) for x in (0.5, 3.5, 6.5, 9.5)]
RIGID = 1e12
"""Stiffness N/m in place of a rigid point: 10⁴ times that of the slab at a point, EI-like Eh³/L²."""


@dataclass(frozen=True)
class Grid:
    """Square mesh of n × n elements; nodes are numbered from 0, row by row."""

    n: int

    def __post_init__(self) -> None:
        """Refuse meshes that cut the loaded square or miss the bearings."""
        if self.n % 20:
            sys.exit(f"{self.n} elements along a side; the number must be a multiple of 20.")

    @cached_property
    def points(self) -> Any:
        """Nodes (k, 2)."""
        stations = np.linspace(0.0, SIDE, self.n + 1)
        return np.array([(x, y) for y in stations for x in stations])

    @cached_property
    def elements(self) -> Any:
        """Four nodes (n², 4) of each element, counter-clockwise."""
        first = np.array([[row * (self.n + 1) + column for column in range(self.n)] for row in range(self.n)]).ravel()
        return np.column_stack([first, first + 1, first + self.n + 2, first + self.n + 1])

    @cached_property
    def loaded(self) -> Any:
        """Whether each element (n²,) is in the loaded square."""
        centre = self.points[self.elements].mean(axis=1)
        return ((centre > PATCH_ENDS[0]) & (centre < PATCH_ENDS[1])).all(axis=1)

    @cached_property
    def areas(self) -> Any:
        """Part of the slab's area (k,) that belongs to each node."""
        return self._lumped(np.ones(len(self.elements)))

    @cached_property
    def forces(self) -> Any:
        """Load (k,) at each node, positive down."""
        return self._lumped(UNIFORM + PATCH * self.loaded)

    @cached_property
    def bearings(self) -> list[int]:
        """Nodes of the 16 points."""
        return [int(np.argmin(np.hypot(*(self.points - at).T))) for at in BEARINGS]

    def _lumped(self, pressure: Any) -> Any:
        result = np.zeros(len(self.points))
        np.add.at(result, self.elements.ravel(), np.repeat(pressure * (SIDE / self.n) ** 2 / 4, 4))
        return result

    def supports(self, case: str) -> dict[int, float]:
        """Stiffness, N/m, of the spring that only pushes, by node."""
        if case == "A":
            return dict(enumerate((SOIL * self.areas).tolist()))
        return dict.fromkeys(self.bearings, RIGID)

    def figures(self, case: str, w: Any) -> dict[str, Any]:
        """Figures of the deflections (k,), positive down, with one spring at each node."""
        found: dict[str, Any] = {"settlement": float(w.max()), "uplift": float(-w.min())}
        if case == "A":
            return found | {"pressure": SOIL * float(w.max()), "contact": float(self.areas[w > 0].sum()) / SIDE**2}
        reactions = RIGID * np.maximum(w[self.bearings], 0.0)
        return found | {"reactions": reactions.tolist()}


def peak_mb() -> float:
    """Largest memory of this process and of the programs that it has run, in MB."""
    who = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return max(resource.getrusage(one).ru_maxrss for one in who) / 1024


def main(solve: Callable[[str, int], dict[str, Any]]) -> None:
    """Solve the case of the command line, and print its figures, time and memory as a line of JSON."""
    case, n = sys.argv[1], int(sys.argv[2])
    idle, begun = peak_mb(), time.perf_counter()
    found = solve(case, n)
    print(json.dumps({**found, "seconds": time.perf_counter() - begun, "idle_mb": idle, "peak_mb": peak_mb()}))
