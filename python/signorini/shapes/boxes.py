"""Search for the boxes that contain points, and for pairs of overlapping boxes, by an R-tree."""

from __future__ import annotations

import numpy as np
import shapely

from signorini.shapes.arrays import Floats, Ints


class BoxTree:
    """R-tree of boxes (n, 4) with the columns xmin, ymin, xmax, ymax."""

    def __init__(self, boxes: Floats) -> None:
        self._boxes = np.asarray(shapely.box(*boxes.T))
        self._tree = shapely.STRtree(self._boxes)

    def pairs(self, points: Floats) -> tuple[Ints, Ints]:
        """Index pairs (i, j) such that box j contains point i of points (q, 2), sorted by i, then by j."""
        return _sorted(*self._tree.query(shapely.points(points)))

    def overlaps(self) -> tuple[Ints, Ints]:
        """Index pairs i < j of boxes that overlap or touch, sorted by i, then by j."""
        i, j = self._tree.query(self._boxes)
        return _sorted(i[i < j], j[i < j])


def _sorted(i: Ints, j: Ints) -> tuple[Ints, Ints]:
    order = np.lexsort((j, i))
    return i[order], j[order]
