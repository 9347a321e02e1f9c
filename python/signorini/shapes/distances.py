"""Distances of points from sides, arcs and outlines, and signed distances of points from a region's outline."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from signorini.shapes.arrays import Floats
from signorini.shapes.outlines import Box, Contour, Outline, Point, Side, arc_through, bounds_of
from signorini.shapes.regions import Circle, Hollow, Polygon, Rectangle, Region, Rounded


def distances(points: Floats, begin: Floats, end: Floats) -> Floats:
    """Distance (q, k) of each point (q, 2) from each straight side from ``begin`` (k, 2) to ``end`` (k, 2)."""
    side, offset = end - begin, points[:, None] - begin
    length = np.maximum((side**2).sum(axis=1), np.finfo(float).tiny)
    part = np.clip((offset * side).sum(axis=2) / length, 0.0, 1.0)
    return np.asarray(np.hypot(*np.moveaxis(offset - part[..., None] * side, -1, 0)))


@dataclass(frozen=True, eq=False)
class Targets:
    """Points (c, 2), straight sides (k, 2, 2) and arcs (m, 5), to which distances are computed.

    An arc is its centre x, y, its radius, the angle of its first end, and the angle swept.

    Examples
    --------
    >>> half = Targets.of(sides=[((-2.0, 0.0), (2.0, 0.0))], arcs=[(0.0, 0.0, 2.0, 0.0, math.pi)])
    >>> places, apart = half.nearest(np.array([[0.0, 1.5], [1.0, -1.0]]))
    >>> places.round(12).tolist(), apart.tolist()
    ([[0.0, 2.0], [1.0, 0.0]], [0.5, 1.0])
    """

    points: Floats
    sides: Floats
    arcs: Floats

    @classmethod
    def of(
        cls,
        points: Iterable[Point] = (),
        sides: Iterable[tuple[Point, Point]] = (),
        arcs: Iterable[Sequence[float]] = (),
    ) -> Targets:
        """Convert lists of points, straight sides and arcs to arrays."""
        shaped = ((points, (-1, 2)), (sides, (-1, 2, 2)), (arcs, (-1, 5)))
        return cls(*(np.array([*those], dtype=float).reshape(shape) for those, shape in shaped))

    @classmethod
    def along(cls, outline: Outline) -> Targets:
        """Make targets of the segments, circles and arcs of an outline."""
        rings = cls.of(arcs=[(*ring, 0.0, math.tau) for ring in outline.circles.tolist()])
        straight = cls.of(sides=outline.segments.tolist())
        return cls.join([straight, cls.on((a, m, b) for a, m, b in outline.arcs.tolist()), rings])

    @classmethod
    def on(cls, sides: Iterable[Side]) -> Targets:
        """Make targets of sides, each straight or an arc."""
        straight, arcs = list[tuple[Point, Point]](), list[tuple[float, ...]]()
        for begin, through, end in sides:
            arc = None if through is None else arc_through(begin, through, end)
            if arc is None:
                straight.append((begin, end))
            else:
                arcs.append((*arc[0].tolist(), *arc[1:]))
        return cls.of((), straight, arcs)

    @classmethod
    def join(cls, several: Sequence[Targets]) -> Targets:
        """Join several `Targets` into one."""
        none = cls.of()
        return cls(*(np.concatenate([getattr(one, key) for one in (none, *several)]) for key in vars(none)))

    @property
    def bounds(self) -> Box:
        """Box xmin, ymin, xmax, ymax that contains all points, sides, and full circles of arcs."""
        x, y, radius, _, _ = self.arcs.T
        whole = np.concatenate([np.column_stack([x - radius, y - radius]), np.column_stack([x + radius, y + radius])])
        return bounds_of(np.concatenate([self.points, self.sides.reshape(-1, 2), whole]).tolist())

    def nearest(self, at: Floats) -> tuple[Floats, Floats]:
        """Nearest position (q, 2) on the targets to each point ``at`` (q, 2), and distance (q,); ∞ without targets."""
        places = [np.broadcast_to(self.points, (len(at), *self.points.shape))]
        begin, along = self.sides[:, 0], self.sides[:, 1] - self.sides[:, 0]
        part = ((at[:, None] - begin) * along).sum(axis=2) / (along**2).sum(axis=1)
        places.append(begin + np.clip(part, 0.0, 1.0)[..., None] * along)
        x, y, radius, start, sweep = self.arcs.T
        angle = np.arctan2(at[:, 1, None] - y, at[:, 0, None] - x)
        turned = np.mod(np.sign(sweep) * (angle - start), math.tau)
        over = turned > np.abs(sweep)
        angle = np.where(over, np.where(turned - np.abs(sweep) < math.tau - turned, start + sweep, start), angle)
        places.append(np.stack([x + radius * np.cos(angle), y + radius * np.sin(angle)], axis=2))
        result = np.concatenate(places, axis=1)
        if not result.shape[1]:
            return at, np.full(len(at), np.inf)
        apart = np.hypot(*np.moveaxis(result - at[:, None], 2, 0))
        least = apart.argmin(axis=1)
        each = np.arange(len(at))
        return result[each, least], apart[each, least]


def edges_of(contours: Iterable[Contour], names: set[str]) -> dict[str, Targets]:
    """Targets along each edge of the contours whose name is in ``names``."""
    result = dict[str, list[Side]]()
    for contour in contours:
        for name, sides in contour.edges.items():
            if name in names:
                result.setdefault(name, []).extend(contour.sides[side] for side in sides)
    return {name: Targets.on(sides) for name, sides in result.items()}


def depth(region: Region, points: Floats) -> Floats:
    """Distance (q,) of points (q, 2) from a region's outline, negative outside the region.

    Outside a rectangle, the magnitude is the largest distance beyond one of the lines through the sides.
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
        # A polygon with one point per degree deviates from an arc by at most 4e-5 of the radius.
        return depth(Polygon(tuple((x, y) for x, y in region.drawn.tolist())), points)
    nearest = shapely.distance(shapely.LinearRing(region.points), shapely.points(points))
    return np.where(region.contains(points), nearest, -nearest)
