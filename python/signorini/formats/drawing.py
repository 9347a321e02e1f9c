"""What a drawing says about a plate, in metres: closed lines, open ones and points, each with its layer."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

GAP = 1e-3
"""Metres between ends that count as one place: less than anything built, more than a careless end."""


class Corner(NamedTuple):
    """A corner [m] and the bulge of the side that begins there: tan(arc/4), positive where the arc turns left."""

    x: float
    y: float
    bulge: float = 0.0


@dataclass(frozen=True)
class Loop:
    """A closed line: sides from corner to corner or, of a radius [m], a circle about its only corner."""

    corners: tuple[Corner, ...]
    radius: float = 0.0

    def __iter__(self) -> Iterator[tuple[Corner, Corner]]:
        """Yield both ends of every side."""
        return zip(self.corners, self.corners[1:] + self.corners[:1], strict=True)

    @property
    def area(self) -> float:
        """What it encloses [m²].

        Examples
        --------
        A stadium 2 m long between half circles of radius 1 m.

        >>> from signorini.formats.drawing import Corner, Loop
        >>> round(Loop((Corner(0, 0), Corner(2, 0, 1), Corner(2, 2), Corner(0, 2, 1))).area, 6)
        7.141593
        """
        total = math.pi * self.radius**2
        origin = self.corners[0]
        for a, b in self:
            total += ((a.x - origin.x) * (b.y - origin.y) - (b.x - origin.x) * (a.y - origin.y)) / 2
            if a.bulge:
                angle = 4 * math.atan(a.bulge)
                radius = math.hypot(b.x - a.x, b.y - a.y) / (2 * math.sin(angle / 2))
                total += radius**2 * (angle - math.sin(angle)) / 2
        return abs(total)

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Least x and y, greatest x and y [m] of its corners or of the circle."""
        x, y = [c.x for c in self.corners], [c.y for c in self.corners]
        return min(x) - self.radius, min(y) - self.radius, max(x) + self.radius, max(y) + self.radius

    @property
    def middle(self) -> tuple[float, float]:
        """Middle [m] of its box."""
        left, bottom, right, top = self.box
        return (left + right) / 2, (bottom + top) / 2

    @property
    def sides(self) -> tuple[float, float] | None:
        """Lengths [m] along x and y if it is a rectangle parallel to the axes."""
        left, bottom, right, top = self.box
        at_corners = all(
            c.bulge == 0 and min(c.x - left, right - c.x) < GAP and min(c.y - bottom, top - c.y) < GAP
            for c in self.corners
        )
        whole = (right - left) * (top - bottom)
        return (right - left, top - bottom) if at_corners and self.area > whole / 2 > 0 else None

    def has(self, x: float, y: float) -> bool:
        """Whether a point is inside; arcs count as their chords."""
        if self.radius:
            return math.hypot(x - self.corners[0].x, y - self.corners[0].y) < self.radius
        crossed = [x < a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x) for a, b in self if (a.y > y) != (b.y > y)]
        return sum(crossed) % 2 == 1


def through(a: Corner, b: Corner) -> tuple[float, float]:
    """Middle [m] of the arc from a corner to the next.

    Examples
    --------
    >>> from signorini.formats.drawing import Corner, through
    >>> through(Corner(1, 0, 1.0), Corner(-1, 0))
    (0.0, 1.0)
    """
    return (a.x + b.x + a.bulge * (b.y - a.y)) / 2, (a.y + b.y - a.bulge * (b.x - a.x)) / 2


@dataclass(frozen=True)
class Drawing:
    """A plate as it is drawn.

    Parameters
    ----------
    outline : Loop
    holes : of Loop
    points : dict
        By footprint, (a, b) of a rectangle [m], (r,) of a circle or () of none, the places (x, y) [m] that have it.
    lines : of corners
        Open lines, arcs as they are.
    took, left : of str
        What became of every layer, in words.
    """

    outline: Loop
    holes: tuple[Loop, ...]
    points: dict[tuple[float, ...], list[tuple[float, float]]]
    lines: tuple[tuple[Corner, ...], ...]
    took: tuple[str, ...]
    left: tuple[str, ...]
