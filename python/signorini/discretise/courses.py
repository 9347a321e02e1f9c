"""Lines and circles that run along something within a distance, put onto it there."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Self

import numpy as np

from signorini.discretise.quadrature.arcs import Arc, PartOfCircle, Segment, arc_of
from signorini.discretise.rows import Floats
from signorini.shapes import Curve, Polyline, Ring
from signorini.shapes.outlines import Point, Side, bounds_of

_LOOKED_AT = np.linspace(0.0, 1.0, 17)
"""Places of a stretch at which it is to be near."""
_ALONG = 0.9
"""Part of a stretch's length that has its nearest places along the other side: less where it goes across."""


@dataclass(frozen=True, eq=False)
class _Side:
    """A side by its length."""

    drawn: Side
    arc: Arc

    @classmethod
    def of(cls, drawn: Side) -> Self:
        return cls(drawn, arc_of(drawn))

    @property
    def length(self) -> float:
        return self.arc.length

    @property
    def is_straight(self) -> bool:
        return isinstance(self.arc, Segment)

    def at(self, s: Floats) -> Floats:
        return self.arc.at(s)[0]

    def point(self, s: float) -> Point:
        """The point at a length; ends as they are given."""
        if s in (0.0, self.length):
            return self.drawn[0] if s == 0.0 else self.drawn[2]
        x, y = self.at(np.array([s]))[0].tolist()
        return x, y

    def nearest(self, at: Floats) -> Floats:
        return np.asarray(np.clip(self.arc.nearest(at), 0.0, self.length))


@dataclass(frozen=True, eq=False)
class _Part:
    """A part of a line on a side, its own or one that it runs along: from a length of that side on to another."""

    of: tuple[bool, int]
    side: _Side
    begin: float
    end: float

    @property
    def is_own(self) -> bool:
        return self.of[0]


class Followed:
    """Sides that lines may run along, those that matter most first.

    Parameters
    ----------
    sides : sequence of Side

    Examples
    --------
    A wall of two chords runs along a quarter of a circle, and then on.

    >>> quarter = Followed([((1.0, 0.0), (0.6, 0.8), (0.0, 1.0))])
    >>> wall = Polyline(((1.0, 0.0), (0.8, 0.6), (0.0, 1.0), (-1.0, 1.0)))
    >>> found = quarter.course(wall.sides, 0.2, 1e-9)
    >>> found.points, [m is not None for m in found.through]
    (((1.0, 0.0), (0.0, 1.0), (-1.0, 1.0)), [True, False])
    >>> quarter.course(wall.sides, 0.01, 1e-9) is None
    True
    """

    def __init__(self, sides: Sequence[Side]) -> None:
        self._boxes, self._sides = _boxes(sides), [_Side.of(side) for side in sides]

    def and_along(self, curves: Iterable[Curve]) -> Followed:
        """These, and after them those of curves."""
        found = Followed([side for curve in curves for side in curve.sides])
        found._boxes, found._sides = np.concatenate([self._boxes, found._boxes]), self._sides + found._sides
        return found

    def course(self, sides: Sequence[Side], near: float, on: float) -> Curve | None:
        """Put sides, each of which begins where the last ended, onto these where they run along them.

        They do so from an end of either to the next one, if they are nowhere there farther apart than ``near``. What is
        nearer than ``on`` is on it as it is; None where nothing has to be moved.
        """
        boxes, parts = self._boxes, list[_Part]()
        for number, (side, box) in enumerate(zip(sides, _boxes(sides), strict=True)):
            beside = ((boxes[:, :2] <= box[2:] + near) & (boxes[:, 2:] >= box[:2] - near)).all(axis=1)
            those = {int(other): self._sides[other] for other in np.flatnonzero(beside)}
            parts += _divided(number, _Side.of(side), those, near, on)
        if all(part.is_own for part in parts):
            return None
        return _joined(parts, sides[0][0] == sides[-1][2], on)


def _boxes(sides: Sequence[Side]) -> Floats:
    """Boxes (k, 4) around sides."""
    boxes = [bounds_of((a, b)) if m is None else Polyline((a, b), (m,)).bounds for a, m, b in sides]
    return np.array(boxes).reshape(-1, 4)


def _divided(number: int, own: _Side, others: dict[int, _Side], near: float, on: float) -> Iterator[_Part]:
    """The parts of a side in order: its own, and those of sides that it runs along."""
    taken = list[tuple[float, float, _Part | None]]()
    for other, side in others.items():
        for begin, end in _without(_stretch(own, side, near), [(a, b) for a, b, _ in taken], on):
            at = own.at(begin + (end - begin) * _LOOKED_AT)
            beside = side.nearest(at)
            apart = np.hypot(*(side.at(beside) - at).T).max()
            if apart <= near and abs(beside[-1] - beside[0]) >= _ALONG * (end - begin):
                first, last = (_to_end(float(at), side.length, near) for at in beside[[0, -1]])
                taken.append((begin, end, _Part((False, other), side, first, last) if apart > on else None))
    reached = 0.0
    for begin, end, other_part in sorted(taken, key=lambda one: one[:2]):
        if other_part is not None:
            if begin - reached > on:
                yield _Part((True, number), own, reached, begin)
            yield other_part
            reached = end
    if own.length - reached > on:
        yield _Part((True, number), own, reached, own.length)


def _stretch(own: _Side, other: _Side, near: float) -> tuple[float, float]:
    """From where to where a side may run along another: between those ends of either that are near the other."""
    met = [np.zeros(0)]
    for one, two in ((own, other), (other, own)):
        ends = np.array([0.0, one.length])
        at = one.at(ends)
        feet = two.nearest(at)
        is_near = np.hypot(*(two.at(feet) - at).T) <= near
        met.append((ends if one is own else feet)[is_near])
    found = np.concatenate(met)
    return (float(found.min()), float(found.max())) if len(found) else (0.0, 0.0)


def _without(
    stretch: tuple[float, float], taken: Sequence[tuple[float, float]], least: float
) -> Iterator[tuple[float, float]]:
    """What of a stretch is beside those that are taken, but for what is no longer than the least."""
    reached, last = stretch
    for begin, end in [*sorted(taken), (last, last)]:
        if min(begin, last) - reached > least:
            yield reached, min(begin, last)
        reached = max(reached, end)


def _to_end(s: float, length: float, near: float) -> float:
    """The end of a side that a place on it is near, or the place."""
    end = 0.0 if 2.0 * s < length else length
    return end if abs(s - end) <= near else s


def _joined(parts: list[_Part], is_closed: bool, on: float) -> Curve | None:
    """Make one line of parts, those in a row on one side together; its own end where others begin."""
    if is_closed:
        # A line along one side from its end to its beginning goes on there.
        first = next((i for i, part in enumerate(parts) if part.of != parts[-1].of), 0)
        parts = parts[first:] + parts[:first]
    runs = [(run[0], run[-1]) for run in (list(those) for _, those in groupby(parts, key=lambda part: part.of))]
    begins, ends = [a.side.point(a.begin) for a, _ in runs], [b.side.point(b.end) for _, b in runs]
    corners, through = list[Point](), list[Point | None]()
    for i, (a, b) in enumerate(runs):
        onward = (i + 1) % len(runs)
        goes_on = is_closed or onward
        if a.is_own and goes_on and not runs[onward][0].is_own:
            ends[i] = begins[onward]
        if a.is_own and (is_closed or i) and not runs[i - 1][0].is_own:
            begins[i] = ends[i - 1]
        middle = None if a.side.is_straight else a.side.point(0.5 * (a.begin + b.end))
        for at, way in ((begins[i], None), (ends[i], middle)):
            if not corners:
                corners.append(at)
            elif math.dist(corners[-1], at) > on:
                corners.append(at)
                through.append(way)
    if not through:
        return None
    if is_closed:
        if math.dist(corners[0], corners[-1]) > on:
            corners.append(corners[0])
            through.append(None)
        corners[-1] = corners[0]
    return _smooth(Polyline(tuple(corners), tuple(through)).sides, on)


def _smooth(sides: Sequence[Side], on: float) -> Curve:
    """Join sides that follow each other on one circle, all around to the circle; it is divided as others on it are."""
    found: list[tuple[Side, Arc]] = []
    for side in sides:
        arc = arc_of(side)
        if found and _go_on(found[-1][1], arc, on):
            (begin, _, _), before = found.pop()
            assert isinstance(before, PartOfCircle)
            if (turned := before.length + arc.length) >= math.tau * before.radius - on:
                return Ring((float(before.center[0]), float(before.center[1])), before.radius)
            x, y = before.at(np.array([0.5 * turned]))[0][0].tolist()
            side = begin, (x, y), side[2]
            arc = arc_of(side)
        found.append((side, arc))
    joined = [side for side, _ in found]
    return Polyline((joined[0][0], *(end for *_, end in joined)), tuple(through for _, through, _ in joined))


def _go_on(one: Arc, other: Arc, on: float) -> bool:
    """Whether an arc goes on along the circle of the one before it."""
    if not isinstance(one, PartOfCircle) or not isinstance(other, PartOfCircle) or one.sweep * other.sweep < 0.0:
        return False
    return math.dist(one.center, other.center) <= on and abs(one.radius - other.radius) <= on
