"""Convex hull and diameter of points; tolerances for equal places on a plate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely

from signorini.shapes.arrays import Floats

_ON_LINE = 1e-12
"""Largest distance of a hull point from a side, relative to the hull's size, at which the point is not a corner."""


def hull(points: Floats) -> Floats:
    """Corners (h, 2) of the convex hull of points (k, 2), counter-clockwise; for points on one line, its ends.

    Rounding may add points of an oblique line to its ends.

    Examples
    --------
    >>> hull(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.5]])).tolist()
    [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0]]
    """
    convex = shapely.convex_hull(shapely.multipoints(points))
    size = float(np.ptp(points, axis=0).max())
    corners = shapely.get_coordinates(shapely.simplify(convex, _ON_LINE * size))
    closed = len(corners) > 1 and (corners[0] == corners[-1]).all()
    # The ring of a hull is clockwise.
    return corners[:0:-1] if closed else corners


def diameter(points: Floats) -> float:
    """Largest distance between any two of the points (k, 2); a rotation changes it by rounding only."""
    corners = hull(points)
    return max(float(np.hypot(*(corners - one).T).max()) for one in corners)


@dataclass(frozen=True)
class Tolerances:
    """Tolerances for places on a plate with diameter ``extent``.

    ``thickness`` is the plate's thickness, at one place or at several (q,); 0 if `apart` is not used.
    """

    extent: float
    thickness: float | Floats = 0.0

    @property
    def place(self) -> float:
        """Largest distance of two places that count as one.

        Rows of nearer points differ by less than their rounding: at 1e-9 two rigid points with a spring beside them
        changed deflections by 3 %.
        """
        return 1e-8 * self.extent

    @property
    def written(self) -> float:
        """Tolerance for a place on an edge or circle: coordinates are written with six digits."""
        return 1e-6 * self.extent

    @property
    def apart(self) -> float | Floats:
        """Smallest distance of rigid supports at different places.

        Reactions between two such supports grow with the inverse square of their distance.
        """
        return self.thickness / 10.0
