"""What regions and curves share: their outlines, and what they ask a mesh to follow."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from signorini.errors import InputError

Floats = npt.NDArray[np.float64]
Point: TypeAlias = tuple[float, float]
Box: TypeAlias = tuple[float, float, float, float]
Side: TypeAlias = tuple[Point, Point | None, Point]
"""Where a side begins, a point that it is an arc through or None, and where it ends."""


@dataclass(frozen=True, eq=False)
class Outline:
    """What a region or curve is drawn with: straight segments (k, 2, 2), full circles (m, 3) as x, y, radius, and arcs.

    Arcs (n, 3, 2) are their first ends, points that they pass, and their other ends.
    """

    segments: Floats = field(default_factory=lambda: np.empty((0, 2, 2)))
    circles: Floats = field(default_factory=lambda: np.empty((0, 3)))
    arcs: Floats = field(default_factory=lambda: np.empty((0, 3, 2)))

    @cached_property
    def whole_circles(self) -> Floats:
        """The circles, and those that the arcs are parts of."""
        (a, m, b) = self.arcs.transpose(1, 2, 0)
        u, v = m - a, b - a
        bend = 2.0 * (u[0] * v[1] - u[1] * v[0])
        uu, vv = (u * u).sum(axis=0), (v * v).sum(axis=0)
        offset = np.array([v[1] * uu - u[1] * vv, u[0] * vv - v[0] * uu]) / bend
        return np.concatenate([self.circles, np.column_stack([*(a + offset), np.hypot(*offset)])])


class Straight(ABC):
    """What everything made of straight segments asks of a mesher: its axis-parallel lines, and where they end."""

    @property
    @abstractmethod
    def outline(self) -> Outline:
        """The segments."""

    @property
    def drawn(self) -> Floats:
        """Points (k, 2) along the outline."""
        return np.asarray(self.outline.segments[:, 0])

    @property
    def loops(self) -> tuple[Floats, ...]:
        """Points (k, 2) along every outline: the one there is."""
        return (self.drawn,)

    @property
    def corners(self) -> Floats:
        """Corners (c, 2)."""
        return self.drawn

    @property
    def x_lines(self) -> tuple[float, ...]:
        """Abscissae a rectangular mesh should have grid lines at."""
        return self._lines(0)

    @property
    def y_lines(self) -> tuple[float, ...]:
        """Ordinates a rectangular mesh should have grid lines at."""
        return self._lines(1)

    def radii(self, center: Point) -> tuple[float, ...]:
        """Radii of circles around `center` that a round mesh should have: none."""
        return ()

    def _lines(self, axis: int) -> tuple[float, ...]:
        segments = self.outline.segments
        parallel = (segments[:, 0] == segments[:, 1]).any(axis=1)
        return tuple(float(x) for x in np.unique(segments[parallel][..., axis]))


class Round:
    """What a circle asks of a mesher: its radius, of a mesh around the same centre."""

    center: Point
    radius: float

    @property
    def outline(self) -> Outline:
        """The circle itself."""
        return Outline(circles=np.array([[*self.center, self.radius]]))

    @property
    def x_lines(self) -> tuple[float, ...]:
        """Abscissae a rectangular mesh should have grid lines at: none."""
        return ()

    @property
    def y_lines(self) -> tuple[float, ...]:
        """Ordinates a rectangular mesh should have grid lines at: none."""
        return ()

    def radii(self, center: Point) -> tuple[float, ...]:
        """Radii of circles around `center` that a round mesh should have: this one's if it has the same centre."""
        return (self.radius,) if math.dist(center, self.center) <= 1e-9 * self.radius else ()

    @property
    def bounds(self) -> Box:
        """Bounding box xmin, ymin, xmax, ymax."""
        (x, y), r = self.center, self.radius
        return (x - r, y - r, x + r, y + r)


def require_finite(owner: str, numbers: Sequence[float]) -> None:
    """Refuse infinities and NaN."""
    if not all(math.isfinite(number) for number in numbers):
        raise InputError(f"{owner} needs finite coordinates; found {', '.join(f'{number:g}' for number in numbers)}.")


def require_circle(center: Point, radius: float) -> None:
    """Refuse a circle without a positive radius."""
    require_finite("A circle", (*center, radius))
    if not radius > 0.0:
        raise InputError(f"A circle's radius must be positive; found {radius:g}.")


def points_of(owner: str, points: Sequence[Sequence[float]]) -> tuple[Point, ...]:
    """Normalise a list of points."""
    for point in points:
        if len(point) != 2:
            raise InputError(f"{owner} is a list of [x, y] points; found {list(point)!r}.")
        require_finite(owner, point)
    return tuple((float(x), float(y)) for x, y in points)


def closed(points: Sequence[Point]) -> Floats:
    """Join each point to the next and the last to the first: segments (k, 2, 2)."""
    corners = np.array(points)
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


def bounds_of(points: Sequence[Point]) -> Box:
    """Bound points by xmin, ymin, xmax, ymax."""
    x, y = zip(*points, strict=True)
    return (min(x), min(y), max(x), max(y))
