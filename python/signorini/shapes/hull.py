"""The convex hull of points."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

_ON_LINE = 1e-12
"""Breadth over length below which points are on one line."""
_ROUNDING = 1e-14
"""Twice a triangle's area, over the square of the size, that is rounding."""


def hull(points: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
    """Which of points (k, 2) are corners of their hull, in order and counter-clockwise; of points on one line its ends.

    Andrew's monotone chain (1979). `scipy.spatial` does the same; to read it takes longer than this.

    Examples
    --------
    >>> hull(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5]])).tolist()
    [0, 2, 3]
    """
    about = points - points.mean(axis=0)
    _, axes = np.linalg.eigh(about.T @ about)
    along = about @ axes[:, 1]
    if len(points) < 3 or np.ptp(about @ axes[:, 0]) <= _ON_LINE * np.ptp(along):
        return np.array([along.argmin(), along.argmax()])
    order = np.lexsort(points.T[::-1])
    # Of points above each other only the lowest and the highest can be corners.
    step = np.diff(points[order, 0]) > 0
    order = order[np.append(True, step) | np.append(step, True)]
    flat = _ROUNDING * float(np.ptp(points, axis=0).max()) ** 2
    corners: list[int] = []
    for way in (order, order[::-1]):
        side: list[tuple[int, float, float]] = []
        for index, (x, y) in zip(way.tolist(), points[way].tolist(), strict=True):
            while len(side) > 1:
                (_, ax, ay), (_, bx, by) = side[-2:]
                if (bx - ax) * (y - ay) - (by - ay) * (x - ax) > flat:
                    break
                side.pop()
            side.append((index, x, y))
        corners += [index for index, _, _ in side[:-1]]
    return np.array(corners)
