"""Segments and circles by arc length, and where the sides of a mesh cross them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from signorini.discretise.quadrature.crossings import quadratics, touched, with_circles, with_segments
from signorini.mesh.isoparametric import side_boxes
from signorini.shapes import Curve
from signorini.shapes.outlines import Outline, Side, arc_through

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

_SAME = 1e-13
_TOUCHED = 1e-6
"""Part of an arc that counts as one point: where a side only touches a circle, rounding finds it to half the digits."""
_STRAIGHT = 1e-9
"""Part of its length that a side may be off a line on which it lies."""
_NONE = np.zeros((0, 2))


class Arc(ABC):
    """A smooth piece of a curve, by arc length."""

    @property
    @abstractmethod
    def length(self) -> float:
        """Length."""

    @abstractmethod
    def at(self, s: Floats) -> tuple[Floats, Floats]:
        """Compute positions and unit tangents (q, 2) at arc lengths (q,)."""

    @abstractmethod
    def crossings(self, sides: Floats) -> Floats:
        """Find the arc lengths (r,) at which sides (k, 3, 2) meet the arc, in any order, some of them twice."""

    @abstractmethod
    def nearest(self, points: Floats) -> Floats:
        """The arc lengths (q,) of the places nearest to points (q, 2)."""

    def breaks(self, sides: Floats, beside: Floats = _NONE) -> Floats:
        """Divide the arc where sides (k, 3, 2) meet it, and beside points (q, 2): increasing, once along it."""
        s, least = np.concatenate([self.crossings(sides), self.nearest(beside)]), _TOUCHED * self.length
        s = np.sort(s[(s > least) & (s < self.length - least)])
        s = np.concatenate([[0.0], s, [self.length]])
        return np.asarray(s[np.append(np.diff(s) > least, True)])

    def pieces(self, breaks: Floats) -> Floats:
        """Divide it further where Gauss points on its pieces would prefer a direction."""
        return breaks


@dataclass(frozen=True, eq=False)
class Segment(Arc):
    """A straight piece from one point (2,) to another."""

    begin: Floats
    end: Floats

    @property
    def length(self) -> float:
        """Length."""
        return float(np.hypot(*(self.end - self.begin)))

    def at(self, s: Floats) -> tuple[Floats, Floats]:
        """Compute positions and unit tangents (q, 2) at arc lengths (q,)."""
        along = (self.end - self.begin) / self.length
        return self.begin + s[:, None] * along, np.tile(along, (len(s), 1))

    def crossings(self, sides: Floats) -> Floats:
        """Find the arc lengths (r,) at which sides (k, 3, 2) meet the segment, in any order, some of them twice."""
        segment = np.stack([self.begin, self.end])[None]
        near, _, _, _ = touched(side_boxes(sides), Outline(segments=segment), _margin(sides))
        sides = sides[near]
        # Where a side crosses a line that it lies on is what rounding says.
        along = self._holds(sides)
        _, points = with_segments(quadratics(sides[~along]), np.repeat(segment, int((~along).sum()), axis=0))
        return self.nearest(np.concatenate([points, sides[along][:, [0, 2]].reshape(-1, 2)]))

    def _holds(self, sides: Floats) -> Bools:
        """Tell which sides (k, 3, 2) lie on the line through both ends."""
        x, y = (self.end - self.begin) / self.length
        off = np.abs((sides - self.begin) @ np.array([-y, x])).max(axis=1, initial=0.0)
        return np.asarray(off <= _STRAIGHT * np.hypot(*(sides[:, 2] - sides[:, 0]).T) + _margin(sides))

    def nearest(self, points: Floats) -> Floats:
        """The arc lengths (q,) of the places nearest to points (q, 2), on the line through both ends."""
        return np.asarray((points - self.begin) @ (self.end - self.begin) / self.length)


@dataclass(frozen=True, eq=False)
class PartOfCircle(Arc):
    """A part of a circle from an angle on, in radians, counter-clockwise if the angle turned through is positive."""

    center: Floats
    radius: float
    start: float
    sweep: float

    @property
    def length(self) -> float:
        """Length."""
        return self.radius * abs(self.sweep)

    def at(self, s: Floats) -> tuple[Floats, Floats]:
        """Compute positions and unit tangents (q, 2) at arc lengths (q,)."""
        way = np.copysign(1.0, self.sweep)
        angle = self.start + way * s / self.radius
        outward = np.column_stack([np.cos(angle), np.sin(angle)])
        return self.center + self.radius * outward, way * np.column_stack([-outward[:, 1], outward[:, 0]])

    def crossings(self, sides: Floats) -> Floats:
        """Find the arc lengths (r,) at which sides (k, 3, 2) meet its circle, in any order, some of them twice."""
        circle = np.array([[*self.center, self.radius]])
        _, _, near, _ = touched(side_boxes(sides), Outline(circles=circle), _margin(sides))
        _, points = with_circles(quadratics(sides[near]), np.repeat(circle, len(near), axis=0))
        return self.nearest(points)

    def nearest(self, points: Floats) -> Floats:
        """The arc lengths (q,) of the places nearest to points (q, 2), on all of the circle; beyond its ends too."""
        angle = np.arctan2(points[:, 1] - self.center[1], points[:, 0] - self.center[0])
        # The half turn on either side of its middle.
        turned = np.copysign(1.0, self.sweep) * (angle - self.start) - 0.5 * abs(self.sweep) + np.pi
        return np.asarray((np.mod(turned, 2.0 * np.pi) - np.pi + 0.5 * abs(self.sweep)) * self.radius)

    def pieces(self, breaks: Floats) -> Floats:
        """Divide what is longer than a third of it: Gauss points on three pieces of one length prefer no direction."""
        turns = 3.0 * np.diff(breaks) / (2.0 * np.pi * self.radius)
        parts = np.maximum(np.ceil(turns - _SAME), 1.0).astype(np.int64)
        ends = zip(breaks[:-1], breaks[1:], parts, strict=True)
        return np.append(np.concatenate([np.linspace(a, b, n, endpoint=False) for a, b, n in ends]), breaks[-1])


class FullCircle(PartOfCircle):
    """A circle, counter-clockwise from its rightmost point."""

    def __init__(self, center: Floats, radius: float) -> None:
        super().__init__(center, radius, 0.0, 2.0 * np.pi)

    def breaks(self, sides: Floats, beside: Floats = _NONE) -> Floats:
        """Divide it where sides (k, 3, 2) meet it, and beside points (q, 2): it begins and ends at the first place."""
        s = np.sort(np.concatenate([self.crossings(sides), self.nearest(beside)]))
        least = _TOUCHED * self.length
        s = s[np.append(True, np.diff(s) > least)[: len(s)]]
        if len(s) > 1 and s[0] + self.length - s[-1] <= least:
            s = s[:-1]
        return np.append(s, s[0] + self.length) if len(s) else np.array([0.0, self.length])


def arcs_of(curve: Curve) -> list[Arc]:
    """Split a curve into smooth pieces, in order."""
    return arcs_of_outline(curve.outline)


def arcs_of_outline(outline: Outline) -> list[Arc]:
    """Smooth pieces of an outline: segments in order, arcs, then circles."""
    segments: list[Arc] = [Segment(a, b) for a, b in outline.segments]
    arcs = [arc_of((tuple(a), tuple(m), tuple(b))) for a, m, b in outline.arcs.tolist()]
    return [*segments, *arcs, *(FullCircle(np.array([x, y]), radius) for x, y, radius in outline.circles.tolist())]


def arc_of(side: Side) -> Arc:
    """Take a side by its length, straight or an arc."""
    begin, through, end = side
    result = None if through is None else arc_through(begin, through, end)
    return Segment(np.array(begin), np.array(end)) if result is None else PartOfCircle(*result)


def _margin(sides: Floats) -> float:
    return _SAME * float(np.abs(sides).max(initial=0.0))
