"""Regions and curves of the plane on which loads and supports act."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import shapely

from signorini.errors import InputError
from signorini.shapes import outlines
from signorini.shapes.arrays import Bools, Floats

_TOUCHING = 1e-12
"""Largest distance of two sides that count as touching, relative to the polygon's size."""
_KINK = 0.1
"""Smallest change of direction [rad] of an outline at a corner; where arcs join smoothly the change is smaller."""
_SAME = 1e-6
"""Largest area by which a hole may overlap another hole or extend outside, relative to the hole's area."""


@dataclass(frozen=True)
class Rectangle(outlines.Straight):
    """A rectangle with sides along the axes; points on the outline belong to it."""

    x0: float
    y0: float
    x1: float
    y1: float

    def __post_init__(self) -> None:
        """Refuse a rectangle without area, which may result from snapping its sides onto edges."""
        if not (self.x1 > self.x0 and self.y1 > self.y0):
            raise InputError(
                f"Rectangle [{self.x0:g}, {self.y0:g}, {self.x1:g}, {self.y1:g}] encloses nothing; "
                "give [x0, y0, x1, y1] with x1 > x0 and y1 > y0."
            )

    @property
    def outline(self) -> outlines.Outline:
        """The four sides of the rectangle, counter-clockwise."""
        corners = ((self.x0, self.y0), (self.x1, self.y0), (self.x1, self.y1), (self.x0, self.y1))
        return outlines.Outline(segments=outlines.closed(corners))

    @property
    def area(self) -> float:
        """Area of the rectangle."""
        return (self.x1 - self.x0) * (self.y1 - self.y0)

    @property
    def bounds(self) -> outlines.Box:
        """Bounding box xmin, ymin, xmax, ymax: the rectangle itself."""
        return (self.x0, self.y0, self.x1, self.y1)

    def contains(self, points: Floats) -> Bools:
        """Whether each of the points (q, 2) is inside or on the outline."""
        inside = (points >= (self.x0, self.y0)) & (points <= (self.x1, self.y1))
        return np.asarray(inside.all(axis=1))


@dataclass(frozen=True)
class Circle(outlines.Round):
    """A disc; points on the circle belong to it."""

    @property
    def area(self) -> float:
        """Area of the disc."""
        return math.pi * self.radius**2

    @property
    def loops(self) -> tuple[Floats, ...]:
        """Points (k, 2) along the circle, one per degree."""
        return (outlines.circle(self.center, self.radius, "").points(),)

    @property
    def corners(self) -> Floats:
        """Corners (0, 2): a disc has no corners."""
        return np.zeros((0, 2))

    def contains(self, points: Floats) -> Bools:
        """Whether each of the points (q, 2) is inside or on the outline."""
        return np.asarray(np.hypot(*(points - self.center).T) <= self.radius)


@dataclass(frozen=True)
class Polygon(outlines.Straight):
    """A polygon, convex or not, with corners in either orientation.

    A polygon that crosses or touches itself is refused.
    """

    points: tuple[outlines.Point, ...]

    def __post_init__(self) -> None:
        """Refuse a polygon whose sides cross or touch."""
        _require_simple(self.outline.segments)

    @property
    def outline(self) -> outlines.Outline:
        """The sides of the polygon, in the order of its corners."""
        return outlines.Outline(segments=outlines.closed(self.points))

    @property
    def area(self) -> float:
        """Area inside the polygon, in either orientation."""
        local = np.array(self.points) - self.points[0]
        return float(0.5 * abs(np.sum(_cross(local, np.roll(local, -1, axis=0)))))

    @property
    def bounds(self) -> outlines.Box:
        """Bounding box xmin, ymin, xmax, ymax of the polygon."""
        return outlines.bounds_of(self.points)

    def contains(self, points: Floats) -> Bools:
        """Whether each of the points (q, 2) is inside or on the outline."""
        return inside(points, self.points)


@dataclass(frozen=True)
class Rounded(outlines.Straight):
    """A region with one outline of straight sides and arcs, in either orientation; names of sides are ignored."""

    contour: outlines.Contour

    def __post_init__(self) -> None:
        """Refuse an outline that encloses no area, such as two equal arcs."""
        if not self.area > 0.0:
            raise InputError("The polygon encloses nothing.")

    @cached_property
    def outline(self) -> outlines.Outline:
        """The straight sides and the arcs, each in the order of the contour."""
        sides = self.contour.sides
        straight = [(a, b) for a, m, b in sides if m is None or outlines.arc_through(a, m, b) is None]
        arcs = [(a, m, b) for a, m, b in sides if m is not None and outlines.arc_through(a, m, b) is not None]
        return outlines.Outline(np.array(straight).reshape(-1, 2, 2), arcs=np.array(arcs).reshape(-1, 3, 2))

    @property
    def drawn(self) -> Floats:
        """Points (k, 2) along the outline: corners, and one point per degree on arcs."""
        return self.contour.points()

    @property
    def corners(self) -> Floats:
        """Corners (c, 2), without points at which an arc joins its neighbour smoothly."""
        points, count = self.drawn, len(self.drawn)
        ahead = np.roll(points, -1, axis=0) - points
        turn = np.arctan2(ahead[:, 1], ahead[:, 0])
        bend = np.abs((turn - np.roll(turn, 1) + np.pi) % (2.0 * np.pi) - np.pi)
        at = [i for i in range(count) if tuple(points[i]) in self.contour.corners and bend[i] > _KINK]
        return np.asarray(points[at])

    @property
    def tips(self) -> Floats:
        """Points (t, 2): corners, and points of arcs with the largest or smallest x or y."""
        return np.concatenate([self.corners, *self._farthest])

    @cached_property
    def area(self) -> float:
        """Area inside the outline, in either orientation."""
        corners = np.array(self.contour.corners) - self.contour.corners[0]
        total = float(np.sum(_cross(corners, np.roll(corners, -1, axis=0))))
        return 0.5 * abs(total + sum(radius**2 * (sweep - math.sin(sweep)) for _, radius, _, sweep in self._arcs))

    @property
    def bounds(self) -> outlines.Box:
        """Bounding box xmin, ymin, xmax, ymax of the region, arcs included."""
        return outlines.bounds_of(np.concatenate([np.array(self.contour.corners), *self._farthest]).tolist())

    def contains(self, points: Floats) -> Bools:
        """Mask (q,) of the points (q, 2) inside, by counting crossings; a point on the outline may be in or out."""
        (x, y), count = points.T, np.zeros(len(points), np.int64)
        for (ax, ay), (bx, by) in self.outline.segments:
            level = (ay > y) != (by > y)
            if level.any():
                count += level & (x < ax + (y - ay) / (by - ay) * (bx - ax))
        for (cx, cy), radius, low, high, side in self._monotone:
            level = (low > y) != (high > y)
            reach = np.sqrt(np.maximum(radius**2 - (y - cy) ** 2, 0.0))
            count += level & (x < cx + side * reach)
        return np.asarray(count % 2 == 1)

    @cached_property
    def _farthest(self) -> list[Floats]:
        """For each arc, the points with the largest or smallest x or y, except its ends."""
        return [outlines.farthest(*arc) for arc in self._arcs]

    @cached_property
    def _arcs(self) -> list[tuple[Floats, float, float, float]]:
        """Centre, radius, angle of the first end, and swept angle of every arc."""
        result = [outlines.arc_through(*map(tuple, arc)) for arc in self.outline.arcs.tolist()]
        return [arc for arc in result if arc is not None]

    @cached_property
    def _monotone(self) -> list[tuple[Floats, float, float, float, float]]:
        """Parts of arcs on which y only rises or only falls.

        Each part has the centre, radius, y of both ends, and 1 if the part is right of the centre, −1 if it is left.
        """
        result = []
        for (begin, _, end), (center, radius, start, sweep) in zip(self.outline.arcs, self._arcs, strict=True):
            low, high = sorted((start, start + sweep))
            first = math.ceil((low - math.pi / 2) / math.pi)
            turns = [math.pi / 2 + k * math.pi for k in range(first, first + 4)]
            breaks = [low, *(turn for turn in turns if low < turn < high), high]
            levels = [center[1] + radius * round(math.sin(angle)) for angle in breaks]
            levels[0], levels[-1] = (begin[1], end[1]) if sweep > 0.0 else (end[1], begin[1])
            for i, (a, b) in enumerate(pairwise(breaks)):
                side = math.copysign(1.0, math.cos(0.5 * (a + b)))
                result.append((center, radius, levels[i], levels[i + 1], side))
        return result


@dataclass(frozen=True)
class Polyline(outlines.Straight):
    """A line that consists of straight segments from each point to the next."""

    points: tuple[outlines.Point, ...]

    @property
    def sides(self) -> list[outlines.Side]:
        """The side from each point to the next: first point, None since it is straight, last point."""
        return [(a, None, b) for a, b in pairwise(self.points)]

    @property
    def outline(self) -> outlines.Outline:
        """The segments of the line, in the order of its points."""
        return outlines.Outline(np.array(list(pairwise(self.points))))

    @property
    def length(self) -> float:
        """Length of the line."""
        return math.fsum(math.dist(a, b) for a, b in pairwise(self.points))

    @property
    def bounds(self) -> outlines.Box:
        """Bounding box xmin, ymin, xmax, ymax of the points."""
        return outlines.bounds_of(self.points)


@dataclass(frozen=True)
class Ring(outlines.Round):
    """The circumference of a circle, on which a support or load acts."""

    @property
    def length(self) -> float:
        """Length of the circumference."""
        return 2.0 * math.pi * self.radius

    @property
    def sides(self) -> list[outlines.Side]:
        """The four quarters of the circle in order: first point, a point of the arc between, last point."""
        return outlines.circle(self.center, self.radius, "").sides


Whole: TypeAlias = Rectangle | Circle | Polygon | Rounded
Curve: TypeAlias = Polyline | Ring


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def inside(points: Floats, corners: Floats | Sequence[outlines.Point]) -> Bools:
    """Mask (q,) of the points (q, 2) inside or on the polygon with corners (n, 2)."""
    polygon = shapely.Polygon(corners)
    shapely.prepare(polygon)
    return np.asarray(shapely.intersects_xy(polygon, points))


def _require_simple(segments: Floats) -> None:
    """Refuse a polygon whose sides cross, touch or fold back; neighbouring sides may share only their corner."""
    count = len(segments)
    coincide = (segments[:, 0] == segments[:, 1]).all(axis=1)
    if coincide.any():
        corner = int(np.argmax(coincide)) + 1
        raise InputError(f"Corners {corner} and {corner % count + 1} of the polygon coincide; leave one out.")
    met = meeting(segments, True)
    if met is None:
        return
    one, other = met
    if other == (one + 1) % count:
        raise InputError(f"The polygon folds back on itself at corner {other + 1}: it encloses nothing there.")
    raise InputError(
        f"The polygon crosses or touches itself: the sides from corners {one + 1} and {other + 1} meet. Give the "
        "corners in order around the outline, or split it into several polygons."
    )


def meeting(segments: Floats, closed: bool) -> tuple[int, int] | None:
    """Indices of the first two segments (k, 2, 2) of a line that cross, touch or fold back; None if no two do.

    Each segment may touch the next one at their common point only; so may the last and the first of a closed line.
    """
    count = len(segments)
    along = segments[:, 1] - segments[:, 0]
    size = float(np.ptp(segments.reshape(-1, 2), axis=0).max())
    onward = np.roll(along, -1, axis=0)
    folds = (np.abs(_cross(along, onward)) <= _TOUCHING * size**2) & ((along * onward).sum(axis=1) < 0.0)
    folds[-1] &= closed
    if folds.any():
        piece = int(np.argmax(folds))
        return piece, (piece + 1) % count
    sides = np.asarray(shapely.linestrings(segments))
    i, j = shapely.STRtree(sides).query(sides, "dwithin", _TOUCHING * size)
    # Keep each pair of segments once, and leave out neighbouring segments, since they share a point.
    apart = (j > i + 1) & ((i > 0) | (j < count - 1) | (not closed))
    return min(zip(i[apart].tolist(), j[apart].tolist(), strict=True), default=None)


def meet(one: Floats, other: Floats, within: float) -> bool:
    """Whether the least distance between two sets of segments, (k, 2, 2) and (m, 2, 2), is at most ``within``."""
    return bool(shapely.dwithin(shapely.MultiLineString([*one]), shapely.MultiLineString([*other]), within))


@dataclass(frozen=True)
class Hollow(outlines.Drawn):
    """A region with holes, each a region without holes.

    Holes that extend outside the region ``around``, or that overlap each other, are refused.
    """

    around: Whole
    holes: tuple[Whole, ...]

    def __post_init__(self) -> None:
        """Refuse holes that overlap or extend outside the region."""
        (around,) = self.around.loops
        for number, hole in enumerate(self.holes):
            (own,) = hole.loops
            size = overlap(own, own)
            if overlap(own, around) < (1.0 - _SAME) * size:
                raise InputError(f"Hole {number + 1} reaches out of the area. Cut the hole at the area's outline.")
            for other, earlier in enumerate(self.holes[:number]):
                if overlap(own, earlier.loops[0]) > _SAME * size:
                    raise InputError(f"Holes {other + 1} and {number + 1} overlap. Draw them as one.")
        if not self.area > 0.0:
            raise InputError("The holes cover the whole area.")

    @cached_property
    def parts(self) -> tuple[Whole, ...]:
        """The outer region, followed by the holes."""
        return (self.around, *self.holes)

    @cached_property
    def outline(self) -> outlines.Outline:
        """The outline of the outer region together with the outlines of the holes."""
        drawn = [part.outline for part in self.parts]
        return outlines.Outline(
            *(np.concatenate([getattr(one, of) for one in drawn]) for of in ("segments", "circles", "arcs"))
        )

    @property
    def loops(self) -> tuple[Floats, ...]:
        """Points (k, 2) along every outline; the outline of the outer region is the first."""
        return tuple(loop for part in self.parts for loop in part.loops)

    @property
    def corners(self) -> Floats:
        """Corners (c, 2) of all outlines."""
        return np.concatenate([part.corners for part in self.parts])

    @cached_property
    def area(self) -> float:
        """Area of the outer region less the areas of the holes."""
        return self.around.area - sum(hole.area for hole in self.holes)

    @property
    def bounds(self) -> outlines.Box:
        """Bounding box xmin, ymin, xmax, ymax of the outer region."""
        return self.around.bounds

    def contains(self, points: Floats) -> Bools:
        """Mask (q,) of the points (q, 2) in the region and in no hole; points on a hole's outline may be in or out."""
        inside = self.around.contains(points)
        for hole in self.holes:
            inside &= ~hole.contains(points)
        return inside


Region: TypeAlias = Whole | Hollow


def overlap(one: Floats, other: Floats) -> float:
    """Common area of two polygons with corners (n, 2) and (m, 2), each in either orientation."""
    first, second = (
        shapely.make_valid(shapely.Polygon(corners), method="structure", keep_collapsed=False)
        for corners in (one, other)
    )
    return first.intersection(second).area
