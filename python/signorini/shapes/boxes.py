"""R-trees of boxes: which contain points, and which overlap."""

from __future__ import annotations

import numpy as np
import shapely

from signorini.shapes.arrays import Floats, Ints


class BoxTree:
    """R-tree of boxes (n, 4), xmin, ymin, xmax, ymax."""

    def __init__(self, boxes: Floats) -> None:
        self._boxes = np.asarray(shapely.box(*boxes.T))
        self._tree = shapely.STRtree(self._boxes)

    def pairs(self, points: Floats) -> tuple[Ints, Ints]:
        """Index pairs of points (q, 2) and boxes that contain them, sorted by point and box."""
        return _sorted(*self._tree.query(shapely.points(points)))

    def overlaps(self) -> tuple[Ints, Ints]:
        """Index pairs i < j of boxes that overlap or touch, sorted."""
        i, j = self._tree.query(self._boxes)
        return _sorted(i[i < j], j[i < j])


def _sorted(i: Ints, j: Ints) -> tuple[Ints, Ints]:
    order = np.lexsort((j, i))
    return i[order], j[order]
