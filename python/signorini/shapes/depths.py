"""How deep points are inside a region."""

from __future__ import annotations

import numpy as np

from signorini.shapes import Circle, Floats, Hollow, Polygon, Rectangle, Region, Rounded


def depth(region: Region, points: Floats) -> Floats:
    """Distance of points (q, 2) from a region's outline, negative outside.

    Outside a rectangle it is the distance from the farthest side's line.

    Examples
    --------
    >>> depth(Rectangle(0.0, 0.0, 4.0, 2.0), np.array([[1.0, 0.5], [5.0, 0.5]]))
    array([ 0.5, -1. ])
    """
    if isinstance(region, Hollow):
        deep = depth(region.around, points)
        for hole in region.holes:
            deep = np.minimum(deep, -depth(hole, points))
        return deep
    if isinstance(region, Rectangle):
        low, high = points - (region.x0, region.y0), (region.x1, region.y1) - points
        return np.asarray(np.minimum(low, high).min(axis=1))
    if isinstance(region, Circle):
        return np.asarray(region.radius - np.hypot(*(points - region.center).T))
    if isinstance(region, Rounded):
        # Points one a degree miss an arc by 4e-5 of its radius.
        return depth(Polygon(tuple((x, y) for x, y in region.drawn.tolist())), points)
    nearest = np.full(len(points), np.inf)
    for a, b in region.outline.segments:
        along = b - a
        part = np.clip((points - a) @ along / (along @ along), 0.0, 1.0)
        nearest = np.minimum(nearest, np.hypot(*(points - a - part[:, None] * along).T))
    return np.where(region.contains(points), nearest, -nearest)
