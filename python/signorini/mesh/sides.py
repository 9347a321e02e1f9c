"""The nearest places of sides of elements, which are parabolas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from signorini.mesh.boxtree import BoxTree
from signorini.mesh.isoparametric import side_boxes
from signorini.shapes.outlines import Box

Floats = npt.NDArray[np.float64]

_STEPS = 8
"""Steps of Gauss and Newton to the nearest point of a side, of which straight ones take one."""


@dataclass(frozen=True, eq=False)
class Sides:
    """Sides (k, 3, 2) by corner, midside and corner, and how far from them anything is looked for.

    Examples
    --------
    >>> sides = Sides(np.array([[[-2.0, 0.0], [0.0, 0.1], [2.0, 0.0]], [[2.0, 0.0], [2.0, 1.0], [2.0, 2.0]]]), 0.5)
    >>> places, apart = sides.nearest(np.array([[0.0, 0.3], [2.1, 1.5], [5.0, 1.0]]))
    >>> places[:2].round(12).tolist(), apart.round(12).tolist()
    ([[0.0, 0.1], [2.0, 1.5]], [0.2, 0.1, inf])
    """

    nodes: Floats
    within: float

    @property
    def bounds(self) -> Box:
        """A box xmin, ymin, xmax, ymax around them."""
        boxes = side_boxes(self.nodes)
        (x0, y0), (x1, y1) = boxes[:, :2].min(axis=0).tolist(), boxes[:, 2:].max(axis=0).tolist()
        return x0, y0, x1, y1

    @property
    def off_arcs(self) -> float:
        """How far they may be off the arcs that they stand for: a tenth of the largest rise over a chord, or less."""
        rise = self.nodes[:, 1] - 0.5 * (self.nodes[:, 0] + self.nodes[:, 2])
        return 0.1 * float(np.hypot(*rise.T).max(initial=0.0))

    def nearest(self, at: Floats) -> tuple[Floats, Floats]:
        """The nearest places (q, 2) of these to some (q, 2), and how far they are: infinitely if not within."""
        places, apart = at.copy(), np.full(len(at), np.inf)
        if not len(self.nodes):
            return places, apart
        boxes = side_boxes(self.nodes) + self.within * np.array([-1.0, -1.0, 1.0, 1.0])
        point, side = BoxTree.build(boxes).pairs(at)
        result = onto(self.nodes[side], at[point])
        far = np.hypot(*(result - at[point]).T)
        order = np.lexsort((side, far, point))
        point, first = np.unique(point[order], return_index=True)
        places[point], apart[point] = result[order[first]], far[order[first]]
        return places, np.where(apart <= self.within, apart, np.inf)


def onto(sides: Floats, points: Floats) -> Floats:
    """The places (k, 2) of sides (k, 3, 2) nearest to points (k, 2), one of each, or to one point (2,)."""
    a, middle, b = np.moveaxis(sides, 1, 0)
    slope, bend = 0.5 * (b - a), 0.5 * (a + b) - middle
    t = np.zeros((len(a), 1))
    for _ in range(_STEPS):
        off, along = points - (middle + t * (slope + t * bend)), slope + 2.0 * t * bend
        t = np.clip(t + (off * along).sum(axis=1, keepdims=True) / (along**2).sum(axis=1, keepdims=True), -1.0, 1.0)
    return np.asarray(middle + t * (slope + t * bend))
