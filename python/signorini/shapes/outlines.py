"""Outlines of plates, regions and curves: straight sides, circles and arcs; grid lines that meshes need along them."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np

from signorini.shapes.arrays import Floats

Point: TypeAlias = tuple[float, float]
Box: TypeAlias = tuple[float, float, float, float]
Side: TypeAlias = tuple[Point, Point | None, Point]
"""A side: its first point; a point of the arc between, None for a straight side; its last point."""


@dataclass(frozen=True, eq=False)
class Outline:
    """Segments (k, 2, 2), full circles (m, 3) as x, y, radius, and arcs (n, 3, 2) of an outline or a curve.

    An arc is its first point, a point between, and its last point.
    """

    segments: Floats = field(default_factory=lambda: np.empty((0, 2, 2)))
    circles: Floats = field(default_factory=lambda: np.empty((0, 3)))
    arcs: Floats = field(default_factory=lambda: np.empty((0, 3, 2)))

    @cached_property
    def whole_circles(self) -> Floats:
        """Circles (m + n, 3) as x, y, radius: ``circles``, then the full circle of each arc."""
        (a, m, b) = self.arcs.transpose(1, 2, 0)
        u, v = m - a, b - a
        bend = 2.0 * (u[0] * v[1] - u[1] * v[0])
        uu, vv = (u * u).sum(axis=0), (v * v).sum(axis=0)
        offset = np.array([v[1] * uu - u[1] * vv, u[0] * vv - v[0] * uu]) / bend
        return np.concatenate([self.circles, np.column_stack([*(a + offset), np.hypot(*offset)])])


class Drawn(ABC):
    """Base class of shapes with an outline, along which a mesh should have grid lines or circles."""

    @property
    @abstractmethod
    def outline(self) -> Outline:
        """Segments, circles and arcs of which the shape's outline consists."""

    @property
    def x_lines(self) -> tuple[float, ...]:
        """Abscissae x at which a rectangular mesh should have grid lines: those of sides along the y axis."""
        return self._lines(0)

    @property
    def y_lines(self) -> tuple[float, ...]:
        """Ordinates y at which a rectangular mesh should have grid lines: those of sides along the x axis."""
        return self._lines(1)

    def radii(self, center: Point) -> tuple[float, ...]:
        """Radii of the shape's circles around `center`; a round mesh should have such circles."""
        return tuple(r for x, y, r in self.outline.circles.tolist() if math.dist(center, (x, y)) <= 1e-9 * r)

    def _lines(self, axis: int) -> tuple[float, ...]:
        segments = self.outline.segments
        parallel = (segments[:, 0] == segments[:, 1]).any(axis=1)
        return tuple(np.unique(segments[parallel][..., axis]).tolist())


class Straight(Drawn):
    """A line, or a region with a single outline, that consists of straight sides."""

    @property
    def drawn(self) -> Floats:
        """Points (k, 2) in order along the outline."""
        return np.asarray(self.outline.segments[:, 0])

    @property
    def loops(self) -> tuple[Floats, ...]:
        """Points (k, 2) in order along each outline; there is one outline."""
        return (self.drawn,)

    @property
    def corners(self) -> Floats:
        """Corners (c, 2) of the outline."""
        return self.drawn


@dataclass(frozen=True)
class Round(Drawn):
    """A circle, or the disc inside a circle."""

    center: Point
    radius: float

    @property
    def outline(self) -> Outline:
        """Outline that consists of the circle."""
        return Outline(circles=np.array([[*self.center, self.radius]]))

    @property
    def bounds(self) -> Box:
        """Bounding box xmin, ymin, xmax, ymax of the circle."""
        (x, y), r = self.center, self.radius
        return (x - r, y - r, x + r, y + r)


def closed(points: Sequence[Point]) -> Floats:
    """Segments (k, 2, 2) from each point to the next and from the last to the first."""
    corners = np.array(points)
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


def bounds_of(points: Sequence[Point]) -> Box:
    """Bounding box xmin, ymin, xmax, ymax of a list of points."""
    x, y = zip(*points, strict=True)
    return (min(x), min(y), max(x), max(y))


_TURN = 360
"""Number of points that represent a full circle; the chords deviate from it by at most 4e-5 of the radius."""
_FLAT = 1e-9
"""Largest ratio of rise to chord of an arc that counts as a straight side."""


@dataclass(frozen=True)
class Contour:
    """A closed line with a side from each corner to the next, and from the last corner to the first.

    ``through`` has for each corner a point of the arc that begins there, None for a straight side. ``names`` are the
    names of the sides; several sides may have the same name. ``whole``, unless empty, is a name of all sides together.
    """

    corners: tuple[Point, ...]
    through: tuple[Point | None, ...]
    names: tuple[str, ...]
    whole: str = ""

    @property
    def sides(self) -> list[Side]:
        """The side from each corner: the corner, the point on the arc or None, and the next corner."""
        return list(zip(self.corners, self.through, (*self.corners[1:], self.corners[0]), strict=True))

    @property
    def edges(self) -> dict[str, list[int]]:
        """Indices of the sides that have each name, including the name ``whole``."""
        result: dict[str, list[int]] = {self.whole: list(range(len(self.names)))} if self.whole else {}
        for side, name in enumerate(self.names):
            result.setdefault(name, []).append(side)
        return result

    def points(self, name: str | None = None) -> Floats:
        """Points (k, 2) along the sides with a name, by default all: corners, and one point per degree on arcs."""
        sides = self.sides
        chosen = sides if name is None else [sides[side] for side in self.edges[name]]
        result = [along_side(a, m, b) for a, m, b in chosen]
        return np.concatenate(result if name is None else [*result, [b for _, _, b in chosen]])

    @property
    def bounds(self) -> Box:
        """Bounding box xmin, ymin, xmax, ymax of the contour."""
        return bounds_of(self.points().tolist())


def directions(degrees: Floats) -> Floats:
    """Unit vectors (q, 2) at angles (q,) [°] from the x axis, exact at multiples of 90° and symmetric about 45°."""
    quarter = np.round(degrees / 90.0)
    rest = np.radians(degrees - 90.0 * quarter)
    c, s = np.cos(rest), np.sin(rest)
    turn = quarter.astype(np.int64) % 4
    return np.column_stack([np.choose(turn, [c, -s, -c, s]), np.choose(turn, [s, c, -s, -c])])


def straight(corners: Sequence[Point], names: Sequence[str]) -> Contour:
    """Make a contour with straight sides between corners; ``names`` are the names of the sides."""
    return Contour(tuple(corners), (None,) * len(corners), tuple(names))


def circle(center: Point, radius: float, name: str) -> Contour:
    """Make a contour of four quarter circles, all with the same name."""
    (*corners, _), through = _arc(center, radius, 0.0, 360.0)
    return Contour(tuple(corners), through, (name,) * len(corners))


def sector(center: Point, inner: float, outer: float, degrees: float, names: tuple[str, str, str, str]) -> Contour:
    """Make the contour of a sector of ``degrees`` from the x axis, between two radii.

    ``names`` are the names of start side, outer arc, end side and inner arc. With an inner radius of 0, the start and
    end sides meet at the center.
    """
    start, rim, end, hub = names
    rims, rim_through = _arc(center, outer, 0.0, degrees)
    hubs, hub_through = _arc(center, inner, degrees, 0.0) if inner > 0.0 else ((center,), ())
    corners = (*rims, *hubs)
    through = (*rim_through, None, *hub_through, None)
    return Contour(corners, through, (*[rim] * len(rim_through), end, *[hub] * len(hub_through), start))


def _arc(center: Point, radius: float, start: float, end: float) -> tuple[tuple[Point, ...], tuple[Point, ...]]:
    """Divide an arc from angle ``start`` to ``end`` [°] into parts of at most 90°.

    Return the ends of the parts, and the middle of each part.
    """
    count = max(1, math.ceil(abs(end - start) / 90.0))
    points = np.array(center) + radius * directions(np.linspace(start, end, 2 * count + 1))
    places = [(float(x), float(y)) for x, y in points]
    return tuple(places[::2]), tuple(places[1::2])


def along_side(a: Point, through: Point | None, b: Point) -> Floats:
    """Points (k, 2) along a side, including ``a`` but not ``b``; an arc has one point per degree."""
    arc = None if through is None else arc_through(a, through, b)
    if arc is None:
        return np.array(a)[None]
    center, radius, start, sweep = arc
    # If the arc sweeps a whole number of degrees, rounding must not add a point.
    count = max(1, math.ceil(_TURN * abs(sweep) / math.tau - 1e-6))
    turn = start + sweep * np.arange(1, count) / count
    return np.vstack([a, center + radius * np.column_stack([np.cos(turn), np.sin(turn)])])


def arc_through(a: Point, through: Point, b: Point) -> tuple[Floats, float, float, float] | None:
    """Centre, radius, angle of ``a``, and swept angle of an arc from ``a`` to ``b``; None if nearly straight.

    Examples
    --------
    >>> center, radius, start, sweep = arc_through((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0))
    >>> center.tolist(), radius, start, round(sweep, 6)
    ([0.0, 0.0], 1.0, 0.0, 3.141593)
    """
    first, last = np.array(a), np.array(b)
    u, v = np.array(through) - first, last - first
    bend = u[0] * v[1] - u[1] * v[0]
    if abs(bend) <= _FLAT * (v @ v):
        return None
    center = first + np.array([v[1] * (u @ u) - u[1] * (v @ v), u[0] * (v @ v) - v[0] * (u @ u)]) / (2.0 * bend)
    start, end = (math.atan2(*(p - center)[::-1]) for p in (first, last))
    sweep = (end - start) % math.tau if bend > 0.0 else -((start - end) % math.tau)
    return center, float(np.hypot(*(first - center))), start, sweep


def farthest(center: Floats, radius: float, start: float, sweep: float) -> Floats:
    """Points (k, 2) of an arc, except its ends, with the largest or smallest x or y; arguments as in `arc_through`."""
    quarters = np.arange(4) * (math.pi / 2)
    passed = ((quarters - start) * math.copysign(1.0, sweep)) % math.tau < abs(sweep)
    return np.asarray(center + radius * directions(np.degrees(quarters[passed])))


def along_arc(a: Point, through: Point, b: Point) -> Floats:
    """Points (k, 2) on an arc from ``a`` to ``b``, one per degree, including both ends."""
    return np.vstack([along_side(a, through, b), b])
