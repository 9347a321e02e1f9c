"""The convex hull and the diameter of points, and how near is the same on a plate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from signorini.shapes.arrays import Floats

_ON_LINE = 1e-12
"""Largest ratio of breadth to length of collinear points."""
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
    """The largest distance between two of points (k, 2), which no turn of them changes but by rounding."""
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


@dataclass(frozen=True)
class Tolerances:
    """Lengths that tell places of a plate from each other.

    Its diameter, and its thickness at one place or some; 0 where no support is judged by it.
    """

    extent: float
    thickness: float | Floats = 0.0

    @property
    def place(self) -> float:
        """Two places nearer than this are one.

        Rows of nearer ones differ by less than their rounding: at 1e-9 two rigid points with a spring beside them
        changed deflections by 3 %.
        """
        return 1e-8 * self.extent

    @property
    def written(self) -> float:
        """Relative tolerance for a place on an edge or circle: coordinates are written with six digits."""
        return 1e-6 * self.extent

    @property
    def apart(self) -> float | Floats:
        """Smallest distance of rigid supports at different places.

        Reactions between two grow with the inverse of its square.
        """
        return self.thickness / 10.0
