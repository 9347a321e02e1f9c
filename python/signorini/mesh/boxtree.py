"""A tree of bounding boxes: which boxes contain which points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_FANOUT = 4


@dataclass(frozen=True, eq=False)
class BoxTree:
    """Boxes packed four to a parent along a Morton curve (Guttman 1984; Kamel and Faloutsos 1993).

    Parameters
    ----------
    order : (n,) int array
        The boxes in the order of the leaves.
    levels : tuple of (n_i, 4) float arrays
        Boxes xmin, ymin, xmax, ymax of each level, leaves first.

    Examples
    --------
    >>> tree = BoxTree.build(np.array([[0.0, 0.0, 1.0, 1.0], [0.5, 0.0, 2.0, 1.0]]))
    >>> tree.pairs(np.array([[0.7, 0.5], [1.5, 0.5], [3.0, 0.5]]))
    (array([0, 0, 1]), array([0, 1, 1]))
    """

    order: Ints
    levels: tuple[Floats, ...]

    @classmethod
    def build(cls, boxes: Floats) -> BoxTree:
        """Build the tree of boxes (n, 4), n ≥ 1, given as xmin, ymin, xmax, ymax."""
        order = np.argsort(_morton(0.5 * (boxes[:, :2] + boxes[:, 2:])), kind="stable")
        levels = [boxes[order]]
        while len(levels[-1]) > _FANOUT:
            below = levels[-1]
            starts = np.arange(0, len(below), _FANOUT)
            lower = np.minimum.reduceat(below[:, :2], starts)
            upper = np.maximum.reduceat(below[:, 2:], starts)
            levels.append(np.hstack([lower, upper]))
        return cls(order, tuple(levels))

    def pairs(self, points: Floats) -> tuple[Ints, Ints]:
        """Find indices of points (q, 2) and of the boxes that contain them, by point and then box."""
        top = len(self.levels[-1])
        point = np.repeat(np.arange(len(points)), top)
        box = np.tile(np.arange(top), len(points))
        for i in range(len(self.levels) - 1, -1, -1):
            p, b = points[point], self.levels[i][box]
            inside = (p[:, 0] >= b[:, 0]) & (p[:, 1] >= b[:, 1]) & (p[:, 0] <= b[:, 2]) & (p[:, 1] <= b[:, 3])
            point, box = point[inside], box[inside]
            if i:
                point = np.repeat(point, _FANOUT)
                box = (box[:, None] * _FANOUT + np.arange(_FANOUT)).ravel()
                present = box < len(self.levels[i - 1])
                point, box = point[present], box[present]
        box = self.order[box]
        by_point = np.lexsort((box, point))
        return point[by_point], box[by_point]


def _morton(centres: Floats) -> Ints:
    """Morton codes of the ranks of the coordinates, so that graded meshes are packed as well as even ones."""
    bits = 16
    code = np.zeros(len(centres), dtype=np.int64)
    for axis in range(2):
        rank = np.empty(len(centres), dtype=np.int64)
        rank[np.argsort(centres[:, axis], kind="stable")] = np.arange(len(centres))
        cell = rank * (1 << bits) // len(centres)
        for bit in range(bits):
            code |= ((cell >> bit) & 1) << (2 * bit + axis)
    return code
