"""Convex hull and diameter of points; largest distances of points of a plate that count as equal."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from signorini.shapes.arrays import Floats

_ON_LINE = 1e-12
"""Largest distance from a side, relative to the hull's size, of a hull point that is not counted as a corner."""


def hull(points: Floats) -> Floats:
    """Corners (h, 2) of the convex hull of points (k, 2), counter-clockwise; the two end points if all are on a line.

    If this line is oblique, rounding may add points between its ends.

    Examples
    --------
    >>> hull(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5]])).tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]]
    """
    # A polyline through the points has the same convex hull; shapely makes one polyline faster than many points.
    convex = shapely.convex_hull(shapely.linestrings(np.concatenate([points, points[:1]])))
    size = float(np.ptp(points, axis=0).max())
    corners = shapely.get_coordinates(shapely.simplify(convex, _ON_LINE * size))
    closed = len(corners) > 1 and (corners[0] == corners[-1]).all()
    # shapely returns the corners of a hull clockwise.
    return corners[:0:-1] if closed else corners


def diameter(points: Floats) -> float:
    """Largest distance between two of the points (k, 2); a rotation of the points changes it by rounding only."""
    corners = hull(points)
    return max(float(np.hypot(*(corners - one).T).max()) for one in corners)


@dataclass(frozen=True)
class Tolerances:
    """Distances at which points of a plate with diameter ``extent`` count as equal, as on a line, or as too close.

    ``thickness`` is the plate's thickness, at one point or at several (q,); 0 if `apart` is not used.
    """

    extent: float
    thickness: float | Floats = 0.0

    @property
    def place(self) -> float:
        """Largest distance of two points that count as equal.

        Each contact point has a row in the constraint matrix G. If two points are closer, their rows differ by less
        than rounding. With 1e-9 in place of 1e-8, two such rigid points with a spring beside them changed
        deflections by 3 %.
        """
        return 1e-8 * self.extent

    @property
    def written(self) -> float:
        """Largest distance from an edge or circle of a point that counts as on it; inputs may have only six digits."""
        return 1e-6 * self.extent

    @property
    def apart(self) -> float | Floats:
        """Smallest allowed distance of two rigid supports at different points.

        Their reactions grow with the inverse square of the distance.
        """
        return self.thickness / 10.0
