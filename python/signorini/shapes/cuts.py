"""Cut lines through a plate: on which side of the line points are, and the part of a region on its left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from signorini.shapes.arrays import Bools, Floats, Ints
from signorini.shapes.outlines import Box, Outline, Point
from signorini.shapes.regions import Polyline, Region

LEFT, RIGHT = -1, 1
_APART = 1e-12
"""Largest distance of two crossings of a segment that count as one, relative to the segment's length."""


@dataclass(frozen=True, eq=False)
class Near:
    """Positions of points (q,) relative to a cut line with p segments.

    ``piece`` (q,) is the number of the nearest segment; ``station`` (q,) is the point's coordinate along that segment.
    ``shares`` (q, p) are weights with the sum 1: 1 for the nearest segment, equal parts for equally near ones, as at a
    corner. ``off`` (q, p) is the distance from the straight line through each segment, positive to the right. ``side``
    (q,) is LEFT, RIGHT, or 0 on the line.
    """

    piece: Ints
    shares: Floats
    station: Floats
    off: Floats
    side: Ints


class CutLine:
    """A polyline that is continued beyond both ends, or that is closed: its last point is its first point.

    Points within a distance ``touching`` are on the line. ``ways`` (2,) are the directions of the continuations at the
    first and the last point, None for a straight continuation. They only influence the side on which a point is.
    """

    def __init__(
        self, points: Sequence[Point] | Floats, touching: float, ways: Sequence[Floats | None] = (None, None)
    ) -> None:
        corners = np.array(points, dtype=np.float64)
        self.closed = len(corners) > 2 and bool((corners[0] == corners[-1]).all())
        self.touching = touching
        self.begin, pieces = corners[:-1], np.diff(corners, axis=0)
        self.lengths: Floats = np.hypot(*pieces.T)
        self.along: Floats = pieces / self.lengths[:, None]
        self.normals: Floats = np.column_stack([self.along[:, 1], -self.along[:, 0]])
        """Unit normals (p, 2) of the p segments, pointing to the right."""
        self._onward = [straight if way is None else way for way, straight in zip(ways, self._straight, strict=True)]
        self._whole = None if ways[0] is None and ways[1] is None else CutLine(self._extended(1.0), touching)

    @property
    def _straight(self) -> list[Floats]:
        return [-self.along[0], self.along[-1]]

    @property
    def ends(self) -> Floats:
        """First and last point (2, 2) of the line."""
        return np.stack([self.begin[0], self.begin[-1] + self.lengths[-1] * self.along[-1]])

    def extended(self, by: float) -> Polyline:
        """The line with a further segment of length ``by`` at both ends; a closed line is returned unchanged."""
        return Polyline(tuple((float(x), float(y)) for x, y in self._extended(by)))

    def _extended(self, by: float) -> Floats:
        first, last = self.ends
        corners = [*self.begin, last]
        if not self.closed:
            corners = [first + by * self._onward[0], *corners, last + by * self._onward[1]]
        return np.array(corners)

    def near(self, points: Floats) -> Near:
        """Compute the positions of points (q, 2) relative to the line."""
        offset = points[:, None] - self.begin
        station, off = (np.einsum("qkd,kd->qk", offset, way) for way in (self.along, self.normals))
        low, high = np.zeros(len(self.lengths)), self.lengths.copy()
        if not self.closed:
            low[0], high[-1] = -np.inf, np.inf
        on_piece = np.clip(station, low, high)
        distance = np.hypot(off, station - on_piece)
        piece = np.argmin(distance, axis=1)
        shares = distance <= distance.min(axis=1)[:, None] + self.touching
        pick = np.arange(len(points)), piece
        beyond = station[pick] - on_piece[pick]
        # A point on the outer side of a corner projects beyond the ends of both segments: use the sum of their normals.
        other = (piece + np.where(beyond > 0.0, 1, -1)) % len(self.lengths)
        both = self.normals[piece] + self.normals[other]
        corner = self.begin[piece] + on_piece[pick][:, None] * self.along[piece]
        across = np.where(beyond == 0.0, off[pick], ((points - corner) * both).sum(axis=1))
        near = np.hypot(off[pick], beyond) <= self.touching
        side = np.where(near, 0, np.where(across > 0.0, RIGHT, LEFT))
        if self._whole is not None:
            side = self._whole.near(points).side
        return Near(piece, shares / shares.sum(axis=1)[:, None], station[pick], off, side)


@dataclass(frozen=True, eq=False)
class LeftOf:
    """The part of a box on the left of a cut line; with ``region``, the part of this region on the left.

    The region may extend beyond the box.
    """

    line: CutLine
    box: Box
    region: Part | None = None

    @property
    def outline(self) -> Outline:
        """Segments of the cut line that may meet the box, and the outline of the region, if there is one."""
        x0, y0, x1, y1 = self.box
        segments = self.line.extended(abs(x1 - x0) + abs(y1 - y0)).outline.segments
        if self.region is None:
            return Outline(segments)
        around = self.region.outline
        pieces = [_divided(a, b, around) for a, b in segments]
        return Outline(np.concatenate([*pieces, around.segments]), around.circles, around.arcs)

    @property
    def area(self) -> float:
        """Area of the region or, without a region, of the box; the cut line has no influence."""
        x0, y0, x1, y1 = self.box
        return (x1 - x0) * (y1 - y0) if self.region is None else self.region.area

    @property
    def bounds(self) -> Box:
        """The box xmin, ymin, xmax, ymax."""
        return self.box

    def contains(self, points: Floats) -> Bools:
        """Mask (q,) of the points (q, 2) on the left of the line and, if there is a region, in the region."""
        left = self.line.near(points).side < 0
        return left if self.region is None else np.asarray(left & self.region.contains(points))


@dataclass(frozen=True, eq=False)
class Common:
    """The intersection of a region with another region, or with a part of one."""

    region: Region
    part: Part

    @property
    def outline(self) -> Outline:
        """Outlines of the region and the part; segments are divided where they cross the other outline."""
        both = self.region.outline, self.part.outline
        pieces = [_divided(a, b, other) for own, other in (both, both[::-1]) for a, b in own.segments]
        segments = np.concatenate([np.zeros((0, 2, 2)), *pieces])
        return Outline(segments, *(np.concatenate([getattr(own, key) for own in both]) for key in ("circles", "arcs")))

    @property
    def area(self) -> float:
        """Upper bound of the intersection's area."""
        return min(self.region.area, self.part.area)

    @property
    def bounds(self) -> Box:
        """Intersection of the bounding boxes of the region and the part."""
        (a, b, c, d), (x0, y0, x1, y1) = self.region.bounds, self.part.bounds
        return max(a, x0), max(b, y0), min(c, x1), min(d, y1)

    def contains(self, points: Floats) -> Bools:
        """Mask (q,) of the points (q, 2) that are both in the region and in the part."""
        return np.asarray(self.region.contains(points) & self.part.contains(points))


Part: TypeAlias = "Region | LeftOf | Common"
"""A region or a part of a region; elements can be divided along its outline."""


def _divided(a: Floats, b: Floats, outline: Outline) -> Floats:
    """Parts (k, 2, 2) of the segment from ``a`` to ``b``, which is divided where it crosses an outline."""
    along = b - a
    other = outline.segments[:, 1] - outline.segments[:, 0]
    offset = outline.segments[:, 0] - a
    with np.errstate(divide="ignore", invalid="ignore"):
        across = along[0] * other[:, 1] - along[1] * other[:, 0]
        of_segments = (offset[:, 0] * other[:, 1] - offset[:, 1] * other[:, 0]) / across
        x, y, radius = outline.whole_circles.T
        square, half = along @ along, (a[0] - x) * along[0] + (a[1] - y) * along[1]
        root = np.sqrt(half**2 - square * ((a[0] - x) ** 2 + (a[1] - y) ** 2 - radius**2))
        of_circles = np.concatenate([-half - root, -half + root]) / square
    t = np.concatenate([[0.0, 1.0], of_segments, of_circles])
    t = np.sort(t[(t >= 0.0) & (t <= 1.0)])
    t = t[np.append(True, np.diff(t) > _APART)]
    corners = a + t[:, None] * along
    return np.stack([corners[:-1], corners[1:]], axis=1)
