"""The convex hull of points."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

_ON_LINE = 1e-12
"""Breadth over length below which points are on one line."""
_ROUNDING = 1e-14
"""Twice a triangle's area, over the square of the size, that is rounding."""
_ASKEW = np.array([[np.cos(1.0), -np.sin(1.0)], [np.sin(1.0), np.cos(1.0)]])
"""A turn by an angle that sides do not make: of points of a side across the order, rounding would choose the first."""
_TURN = np.arange(8) * np.pi / 4
_DIRECTIONS = np.column_stack([np.cos(_TURN), np.sin(_TURN)])


def hull(points: Floats) -> npt.NDArray[np.int64]:
    """Which of points (k, 2) are corners of their hull, in order and counter-clockwise; of points on one line its ends.

    Andrew's monotone chain (1979) of those outside the hull of the farthest (Akl and Toussaint 1978). `scipy.spatial`
    does the same; to read it takes longer than this.

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
    axes[:, 0] *= np.linalg.det(axes)
    askew = about @ axes @ _ASKEW
    flat = _ROUNDING * float(np.ptp(askew, axis=0).max()) ** 2
    farthest = np.unique([(askew @ direction).argmax() for direction in _DIRECTIONS])
    corners = askew[_chain(askew, farthest, flat)]
    outside = np.zeros(len(points), bool)
    for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        normal = np.array([ay - by, bx - ax])
        outside |= askew @ normal <= flat + normal @ (ax, ay)
    return np.array(_chain(askew, np.flatnonzero(outside), flat))


def diameter(points: Floats) -> float:
    """The largest distance between two of points (k, 2), which no turn of them changes but by rounding.

    Examples
    --------
    >>> diameter(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]]))
    5.0
    """
    corners = points[hull(points)]
    return max(float(np.hypot(*(corners - one).T).max()) for one in corners)


def _chain(points: Floats, which: npt.NDArray[np.int64], flat: float) -> list[int]:
    """Which of some points are corners of their hull; triangles up to twice that area are flat."""
    order = which[np.argsort(points[which, 0])]
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
    return corners
