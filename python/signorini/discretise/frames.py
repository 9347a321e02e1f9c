"""Dofs held at nodes, and the frames that let one slope be held alone."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from signorini.discretise.rows import Bools, Floats, Ints

PARALLEL = np.sin(np.radians(10.0))
"""Directions closer than this count as one: a rim's tangent, from its parabolas, is not quite square to a radius."""


@dataclass(eq=False)
class Holds:
    """Collects what supports hold at nodes: deflections at prescribed values, and slopes along directions."""

    node_count: int
    value: dict[int, float] = field(default_factory=dict)
    by: dict[int, dict[int, int]] = field(default_factory=dict)
    directions: dict[int, list[tuple[float, float]]] = field(default_factory=dict)
    slope_by: dict[int, int] = field(default_factory=dict)

    def deflection(self, node: int, value: float, support: int, number: int) -> None:
        """Hold a node's deflection; supports that do so, which agree on its value, share its reaction."""
        self.value.setdefault(node, value)
        self.by.setdefault(node, {}).setdefault(support, number)

    def slope(self, node: int, direction: tuple[float, float], support: int) -> None:
        """Hold a node's slope along a unit direction."""
        self.directions.setdefault(node, []).append(direction)
        self.slope_by.setdefault(node, support)

    def settle(self) -> Held:
        """Turn what was collected into dofs and frames."""
        held = np.zeros((self.node_count, 3), dtype=np.bool_)
        value = np.zeros((self.node_count, 3))
        support = np.full((self.node_count, 3), -1, dtype=np.int64)
        frames = np.tile([1.0, 0.0], (self.node_count, 1))
        for node, deflection in self.value.items():
            held[node, 0], value[node, 0], support[node, 0] = True, deflection, next(iter(self.by[node]))
        for node, directions in self.directions.items():
            first, *others = directions
            support[node, 1:] = self.slope_by[node]
            if any(abs(first[0] * d[1] - first[1] * d[0]) > PARALLEL for d in others):
                held[node, 1:] = True
            elif abs(first[1]) < 1e-9:
                held[node, 1] = True
            elif abs(first[0]) < 1e-9:
                held[node, 2] = True
            else:
                held[node, 1] = True
                frames[node] = np.array(first) / np.hypot(*first)
        framed = bool((frames[:, 1] != 0).any())
        holders = [(node, *one) for node in sorted(self.by) for one in self.by[node].items()]
        *pairs, numbers = np.array(holders, np.int64).reshape(-1, 3).T
        by_node = np.column_stack(pairs)
        return Held(held.ravel(), value.ravel(), support.ravel(), by_node, numbers, frames if framed else None)


@dataclass(frozen=True, eq=False)
class Held:
    """Held dofs (3n,), their values, the supports that hold them, and frames (n, 2), or None for x and y.

    ``support`` (3n,) names of several the first, and −1 where there is none; ``holders`` (k, 2) are all pairs of a node
    and a support that holds its deflection, by node, and ``numbers`` (k,) which of the support's points that is, from
    0; 0 along lines.
    """

    dofs: Bools
    values: Floats
    support: Ints
    holders: Ints
    numbers: Ints
    frames: Floats | None

    def to_global(self, rotations: Floats) -> Floats:
        """Turn rotations (n, 2) from the frames to x and y."""
        if self.frames is None:
            return rotations
        c, s = self.frames.T
        first, second = rotations.T
        return np.column_stack([c * first - s * second, s * first + c * second])

    def from_global(self, covector: Floats) -> Floats:
        """Turn nodal couples (n, 2) from x and y into the frames."""
        if self.frames is None:
            return covector
        c, s = self.frames.T
        x, y = covector.T
        return np.column_stack([c * x + s * y, c * y - s * x])

    def rigid_motions(self, points: Floats, middle: Floats) -> Floats:
        """Nodal vectors (3n, 3), of the motions w = 1, w = x − x0, w = y − y0 of points (n, 2) about a middle."""
        motions = np.zeros((len(points), 3, 3))
        motions[:, 0, 0] = 1.0
        motions[:, 0, 1:] = points - middle
        for i in (0, 1):
            slope = np.zeros((len(points), 2))
            slope[:, i] = 1.0
            motions[:, 1:, 1 + i] = self.from_global(slope)
        return motions.reshape(-1, 3)
