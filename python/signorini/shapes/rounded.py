"""Regions with arcs among their sides."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from signorini.errors import InputError
from signorini.shapes.contours import Contour, arc_through, farthest
from signorini.shapes.outlines import Box, Outline, Straight, points_of

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

_KINK = 0.1
"""Turn of an outline, in radians, from which on it has a corner: less is where arcs were meant to go on smoothly."""


@dataclass(frozen=True)
class Rounded(Straight):
    """A simple region of straight sides and arcs, in either orientation; its sides are not named.

    Examples
    --------
    A half disc.

    >>> half = Rounded(Contour(((-1.0, 0.0), (1.0, 0.0)), (None, (0.0, 1.0)), ("", "")))
    >>> round(half.area, 6), half.bounds
    (1.570796, (-1.0, 0.0, 1.0, 1.0))
    >>> half.contains(np.array([[0.7, 0.7], [0.8, 0.7], [0.0, -0.1]]))
    array([ True, False, False])
    """

    contour: Contour

    def __post_init__(self) -> None:
        """Refuse points that are no numbers."""
        through = [point for point in self.contour.through if point is not None]
        points_of("A polygon", [*self.contour.corners, *through])
        if not self.area > 0.0:
            raise InputError("The polygon encloses nothing.")

    @cached_property
    def outline(self) -> Outline:
        """The straight sides and arcs, in the order given."""
        sides = self.contour.sides
        straight = [(a, b) for a, m, b in sides if m is None or arc_through(a, m, b) is None]
        arcs = [(a, m, b) for a, m, b in sides if m is not None and arc_through(a, m, b) is not None]
        return Outline(np.array(straight).reshape(-1, 2, 2), arcs=np.array(arcs).reshape(-1, 3, 2))

    @property
    def drawn(self) -> Floats:
        """Points (k, 2) along the outline, of arcs one a degree."""
        return self.contour.points()

    @property
    def corners(self) -> Floats:
        """Corners (c, 2), but not where an arc goes on as a side does."""
        points, count = self.drawn, len(self.drawn)
        ahead = np.roll(points, -1, axis=0) - points
        turn = np.arctan2(ahead[:, 1], ahead[:, 0])
        bend = np.abs((turn - np.roll(turn, 1) + np.pi) % (2.0 * np.pi) - np.pi)
        at = [i for i in range(count) if tuple(points[i]) in self.contour.corners and bend[i] > _KINK]
        return np.asarray(points[at])

    @property
    def tips(self) -> Floats:
        """Corners, and points (t, 2) of arcs farthest along x and y."""
        return np.concatenate([self.corners, *self._farthest])

    @cached_property
    def area(self) -> float:
        """Area."""
        total = 0.0
        corners = np.array(self.contour.corners) - self.contour.corners[0]
        total += float(np.sum(_cross(corners, np.roll(corners, -1, axis=0))))
        for _, radius, _, sweep in self._arcs:
            total += radius**2 * (sweep - math.sin(sweep))
        return 0.5 * abs(total)

    @property
    def bounds(self) -> Box:
        """Bounding box xmin, ymin, xmax, ymax."""
        every = np.concatenate([np.array(self.contour.corners), *self._farthest])
        low, high = every.min(axis=0).tolist(), every.max(axis=0).tolist()
        return (*low, *high)

    def contains(self, points: Floats) -> Bools:
        """Whether each of the points (q, 2) is inside, by counting crossings; on the outline either answer may come."""
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
        """Of every arc the points farthest along x and y, but its ends."""
        return [farthest(*arc) for arc in self._arcs]

    @cached_property
    def _arcs(self) -> list[tuple[Floats, float, float, float]]:
        """Centre, radius, angle of the first end and angle turned through of every arc."""
        result = [arc_through(*map(tuple, arc)) for arc in self.outline.arcs.tolist()]
        return [arc for arc in result if arc is not None]

    @cached_property
    def _monotone(self) -> list[tuple[Floats, float, float, float, float]]:
        """Parts of arcs that rise or fall: centre, radius, ordinates of their ends, and 1 right of the centre or −1."""
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


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
