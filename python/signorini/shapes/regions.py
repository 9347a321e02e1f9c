"""Regions and curves of the plane on which loads and supports act."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from signorini.errors import InputError, point
from signorini.shapes.contours import circle
from signorini.shapes.outlines import (
    Box,
    Outline,
    Point,
    Round,
    Side,
    Straight,
    bounds_of,
    closed,
    points_of,
    require_circle,
    require_finite,
)
from signorini.shapes.rounded import Rounded

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

_CHUNK = 4_000_000
_PAIRS = 200_000
"""Pairs of sides that are looked at together."""


@dataclass(frozen=True)
class Rectangle(Straight):
    """A rectangle along the axes, its outline included.

    Raises
    ------
    InputError
        If the upper corner is not above and to the right of the lower one.

    Examples
    --------
    >>> patch = Rectangle(1.0, 0.0, 3.0, 1.0)
    >>> patch.area, patch.x_lines
    (2.0, (1.0, 3.0))
    >>> patch.contains(np.array([[2.0, 0.5], [0.0, 0.5]]))
    array([ True, False])
    """

    x0: float
    y0: float
    x1: float
    y1: float

    def __post_init__(self) -> None:
        """Refuse numbers that bound nothing."""
        require_finite("A rectangle", (self.x0, self.y0, self.x1, self.y1))
        if not (self.x1 > self.x0 and self.y1 > self.y0):
            raise InputError(
                f"Rectangle [{self.x0:g}, {self.y0:g}, {self.x1:g}, {self.y1:g}] encloses nothing; "
                "give [x0, y0, x1, y1] with x1 > x0 and y1 > y0."
            )

    @property
    def outline(self) -> Outline:
        """The four sides, counter-clockwise."""
        corners = ((self.x0, self.y0), (self.x1, self.y0), (self.x1, self.y1), (self.x0, self.y1))
        return Outline(segments=closed(corners))

    @property
    def area(self) -> float:
        """Area."""
        return (self.x1 - self.x0) * (self.y1 - self.y0)

    @property
    def bounds(self) -> Box:
        """Bounding box xmin, ymin, xmax, ymax."""
        return (self.x0, self.y0, self.x1, self.y1)

    def contains(self, points: Floats) -> Bools:
        """Whether each of the points (q, 2) is inside or on the outline."""
        inside = (points >= (self.x0, self.y0)) & (points <= (self.x1, self.y1))
        return np.asarray(inside.all(axis=1))


@dataclass(frozen=True)
class Circle(Round):
    """A disc, its outline included.

    Raises
    ------
    InputError
        If the radius is not positive.

    Examples
    --------
    >>> round(Circle((0.0, 0.0), 2.0).area, 3)
    12.566
    >>> Circle((0.0, 0.0), 2.0).radii((0.0, 0.0)), Circle((0.0, 0.0), 2.0).radii((1.0, 0.0))
    ((2.0,), ())
    """

    center: Point
    radius: float

    def __post_init__(self) -> None:
        """Refuse a radius that is not positive."""
        require_circle(self.center, self.radius)

    @property
    def area(self) -> float:
        """Area."""
        return math.pi * self.radius**2

    @property
    def loops(self) -> tuple[Floats, ...]:
        """Points (k, 2) along every outline: the one there is, one a degree."""
        return (circle(self.center, self.radius, "").points(),)

    @property
    def corners(self) -> Floats:
        """Corners (c, 2): none."""
        return np.zeros((0, 2))

    def contains(self, points: Floats) -> Bools:
        """Whether each of the points (q, 2) is inside or on the outline."""
        return np.asarray(np.hypot(*(points - self.center).T) <= self.radius)


@dataclass(frozen=True)
class Polygon(Straight):
    """A simple polygon, convex or not, in either orientation.

    Parameters
    ----------
    points : sequence of (x, y)
        The corners in order; the last may repeat the first.

    Raises
    ------
    InputError
        If there are fewer than three corners, or the outline crosses or touches itself.

    Examples
    --------
    >>> Polygon(((0.0, 0.0), (2.0, 0.0), (0.0, 2.0))).area
    2.0
    >>> Polygon(((0.0, 0.0), (2.0, 2.0), (2.0, 0.0), (0.0, 2.0)))
    Traceback (most recent call last):
    signorini.errors.InputError: The polygon crosses or touches itself: the sides from corners 1 and 3 meet. ...
    """

    points: tuple[Point, ...]

    def __post_init__(self) -> None:
        """Normalise the corners and refuse an outline that crosses itself."""
        points = points_of("A polygon", self.points)
        if len(points) > 1 and points[0] == points[-1]:
            points = points[:-1]
        if len(points) < 3:
            raise InputError(f"A polygon needs at least 3 corners; found {len(points)}.")
        object.__setattr__(self, "points", points)
        _require_simple(self.outline.segments)

    @property
    def outline(self) -> Outline:
        """The sides, in the order given."""
        return Outline(segments=closed(self.points))

    @property
    def area(self) -> float:
        """Area."""
        local = np.array(self.points) - self.points[0]
        x, y = local.T
        return float(0.5 * abs(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))

    @property
    def bounds(self) -> Box:
        """Bounding box xmin, ymin, xmax, ymax."""
        return bounds_of(self.points)

    def contains(self, points: Floats) -> Bools:
        """Whether each of the points (q, 2) is inside, by counting crossings; on the outline either answer may come."""
        inside = np.empty(len(points), dtype=bool)
        (ax, ay), (bx, by) = self.outline.segments.transpose(1, 2, 0)
        step = max(1, _CHUNK // len(ax))
        for start in range(0, len(points), step):
            x, y = points[start : start + step].T[..., None]
            level = (ay > y) != (by > y)
            with np.errstate(divide="ignore", invalid="ignore"):
                right = x < ax + (y - ay) / (by - ay) * (bx - ax)
            inside[start : start + step] = (level & right).sum(axis=1) % 2 == 1
        return inside


@dataclass(frozen=True)
class Polyline(Straight):
    """Straight segments from point to point.

    Parameters
    ----------
    points : sequence of (x, y)
        Where its sides meet, and its ends.

    Raises
    ------
    InputError
        If there are fewer than two points, or two that follow each other coincide.

    Examples
    --------
    >>> wall = Polyline(((0.0, 2.0), (3.0, 2.0), (7.0, 5.0)))
    >>> wall.length, wall.x_lines, wall.y_lines
    (8.0, (0.0, 3.0), (2.0,))
    """

    points: tuple[Point, ...]

    def __post_init__(self) -> None:
        """Normalise the points and refuse segments without length."""
        points = points_of("A line", self.points)
        if len(points) < 2:
            raise InputError(f"A line needs at least 2 points; found {len(points)}.")
        for i, (a, b) in enumerate(pairwise(points)):
            if a == b:
                raise InputError(f"Points {i + 1} and {i + 2} of a line coincide at {point(a)}; leave one out.")
        object.__setattr__(self, "points", points)

    @property
    def sides(self) -> list[Side]:
        """Each side in order: where it begins, None since it is straight, and where it ends."""
        return [(a, None, b) for a, b in pairwise(self.points)]

    @property
    def outline(self) -> Outline:
        """The segments in the order given."""
        return Outline(np.array(list(pairwise(self.points))))

    @property
    def length(self) -> float:
        """Length."""
        return math.fsum(math.dist(a, b) for a, b in pairwise(self.points))

    @property
    def bounds(self) -> Box:
        """Bounding box xmin, ymin, xmax, ymax."""
        return bounds_of(self.points)


@dataclass(frozen=True)
class Ring(Round):
    """The circumference of a circle.

    Raises
    ------
    InputError
        If the radius is not positive.

    Examples
    --------
    >>> round(Ring((0.0, 0.0), 2.0).length, 3)
    12.566
    """

    center: Point
    radius: float

    def __post_init__(self) -> None:
        """Refuse a radius that is not positive."""
        require_circle(self.center, self.radius)

    @property
    def length(self) -> float:
        """Length."""
        return 2.0 * math.pi * self.radius

    @property
    def sides(self) -> list[Side]:
        """Its quarters in order: where each begins, a point that it is an arc through, and where it ends."""
        return circle(self.center, self.radius, "").sides


Whole: TypeAlias = Rectangle | Circle | Polygon | Rounded
Curve: TypeAlias = Polyline | Ring


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _require_simple(segments: Floats) -> None:
    """Refuse sides that meet anywhere but at the corner they share, and sides that fold back."""
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
    """Find two of the segments (k, 2, 2) of a line that meet but where one ends in the other, or None.

    The second follows the first where it folds back on it. After the last one of a closed line comes the first.

    Examples
    --------
    >>> meeting(np.array([[[0.0, 0.0], [2.0, 0.0]], [[2.0, 0.0], [1.0, 1.0]], [[1.0, 1.0], [1.0, -1.0]]]), False)
    (0, 2)
    """
    count = len(segments)
    a, b = segments[:, 0], segments[:, 1]
    along = b - a
    tiny = 1e-12 * float(np.ptp(segments.reshape(-1, 2), axis=0).max()) ** 2
    onward = np.roll(along, -1, axis=0)
    folds = (np.abs(_cross(along, onward)) <= tiny) & ((along * onward).sum(axis=1) < 0.0)
    folds[-1] &= closed
    if folds.any():
        piece = int(np.argmax(folds))
        return piece, (piece + 1) % count
    low, high = np.minimum(a, b), np.maximum(a, b)
    numbers = np.arange(count)
    for first in np.array_split(np.arange(count), 1 + count**2 // _PAIRS):
        near = ((low[first, None] <= high) & (high[first, None] >= low)).all(axis=2)
        # Every pair once, without those that share a corner.
        near &= (numbers > first[:, None] + 1) & ((first[:, None] > 0) | (numbers < count - 1) | (not closed))
        i, j = np.nonzero(near)
        i = first[i]
        ends = np.stack([_cross(along[i], a[j] - a[i]), _cross(along[i], b[j] - a[i])])
        mine = np.stack([_cross(along[j], a[i] - a[j]), _cross(along[j], b[i] - a[j])])
        apart = (ends > tiny).all(0) | (ends < -tiny).all(0) | (mine > tiny).all(0) | (mine < -tiny).all(0)
        if not apart.all():
            return int(i[np.argmin(apart)]), int(j[np.argmin(apart)])
    return None
