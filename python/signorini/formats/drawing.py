"""What a drawing says about a plate, in metres: closed lines, open ones and points, and the middles of walls."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise
from typing import NamedTuple

import numpy as np

from signorini.errors import InputError, point
from signorini.shapes import Polygon
from signorini.shapes.arrays import Bools, Floats
from signorini.shapes.distances import Targets
from signorini.shapes.outlines import closed
from signorini.shapes.regions import inside, overlap

GAP = 1e-3
"""Metres between ends that count as one place: less than anything built, more than a careless end."""
_WALL = 3.0
"""Length over width from which on a rectangle is a wall."""
_MOST_PLACES = 3
"""Places that are named of many."""
_FINE = math.radians(4)
"""Turn of the chords that stand for arcs."""
_FINER = math.radians(0.2)
"""Turn of the chords that decide whether a point is inside, within 2e-6 of the radius."""
_ON_PLATE = 1e-6
"""Metres off the plate that are rounding: the digits of the input file."""
_PASSES = 8
"""Largest number of moves onto the plate; a corner takes a move for each edge."""


Spot = tuple[float, float]
"""A place (x, y) [m]."""
Footprint = tuple[float, ...]
"""(a, b) of a rectangle [m], (a, b, degrees) of one askew, (r,) of a circle, () of none."""
_AROUND = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))


class Corner(NamedTuple):
    """A corner [m] and the bulge of the side that begins there: tan(arc/4), positive where the arc turns left."""

    x: float
    y: float
    bulge: float = 0.0

    def is_at(self, other: Corner) -> bool:
        """Whether both are one place."""
        return max(abs(self.x - other.x), abs(self.y - other.y)) < GAP


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
        """What it encloses [m²]."""
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

    @property
    def turned_sides(self) -> tuple[float, float, float] | None:
        """Lengths [m] of the sides if it is a rectangle, askew too, and the degrees from x to the first, −45 to 45."""
        if not self.is_rectangle:
            return None
        a, b, c, _ = self.corners
        first, second = math.dist(a[:2], b[:2]), math.dist(b[:2], c[:2])
        degrees = math.degrees(math.atan2(b.y - a.y, b.x - a.x))
        turns = round(degrees / 90.0)
        return (*((first, second) if turns % 2 == 0 else (second, first)), degrees - 90.0 * turns)

    @property
    def footprint(self) -> Footprint | None:
        """Its size to the millimetre if it is a circle or a rectangle."""
        size = (self.radius,) if self.radius else self.sides or self.turned_sides
        return None if size is None else tuple(round(part, 3) for part in size)

    @property
    def middle_line(self) -> tuple[tuple[float, float], ...] | None:
        """Corners [m] of the line along the middle of a wall: of one thickness, and three times as long at least."""
        if self.radius or any(corner.bulge for corner in self.corners):
            return None
        corners = [b for a, b, c in _triples(self.corners) if off_line(b, a, c) > GAP]
        half, odd = divmod(len(corners), 2)
        for i in range(0 if odd else half):
            turned = corners[i:] + corners[:i]
            middle = between(turned[:half], turned[: half - 1 : -1])
            width = math.dist(turned[0][:2], turned[-1][:2])
            if middle and _WALL * width <= sum(itertools.starmap(math.dist, itertools.pairwise(middle))):
                return middle
        return None

    @property
    def is_rectangle(self) -> bool:
        """Whether it has four straight sides at right angles, in any direction."""
        if len(self.corners) != 4 or any(corner.bulge for corner in self.corners):
            return False
        a, b, c, d = self.corners
        meets = math.hypot(a.x + c.x - b.x - d.x, a.y + c.y - b.y - d.y) < 2 * GAP
        return meets and abs(math.dist(a[:2], c[:2]) - math.dist(b[:2], d[:2])) < 2 * GAP

    @cached_property
    def points(self) -> list[tuple[float, float]]:
        """Corners [m], and of arcs points a few degrees apart."""
        return self.chords(_FINE)

    def chords(self, turn: float) -> list[tuple[float, float]]:
        """Corners [m], and of arcs points so that chords turn by an angle or less; three at least."""
        if self.radius:
            right, left = (Corner(self.corners[0].x + side * self.radius, self.corners[0].y, 1.0) for side in (1, -1))
            return Loop((right, left)).chords(turn)
        if len(self.corners) == 2:
            turn = min([turn, *(2 * math.atan(abs(corner.bulge)) for corner in self.corners if corner.bulge)])
        return flattened((*self.corners, self.corners[0]), turn)[:-1]

    @cached_property
    def is_simple(self) -> bool:
        """Whether it neither crosses nor touches itself."""
        try:
            return bool(self.radius) or Polygon(tuple(self.points)).area > 0
        except InputError:
            return False

    @property
    def is_thin(self) -> bool:
        """Whether it is all on one line."""
        x, y = max(self.points, key=lambda at: math.dist(at, self.points[0]))
        far = max(self.points, key=lambda at: math.dist(at, (x, y)))
        length = math.dist(far, (x, y))
        rises = (abs((far[0] - x) * (b - y) - (far[1] - y) * (a - x)) for a, b in self.points)
        return max(rises) <= GAP * length

    @cached_property
    def _chords(self) -> Floats:
        """Straight sides (k, 2, 2) that stand for it."""
        return closed(self.chords(_FINER))

    @cached_property
    def sides_drawn(self) -> Targets:
        """Its straight sides and arcs."""
        if self.radius:
            return Targets.of(arcs=[(*self.corners[0][:2], self.radius, 0.0, math.tau)])
        return Targets.on((a[:2], through(a, b) if a.bulge else None, b[:2]) for a, b in self)

    def has(self, points: Iterable[tuple[float, float]]) -> Bools:
        """Which points are inside."""
        return inside(np.array([*points]).reshape(-1, 2), self._chords)

    def near(self, points: Iterable[tuple[float, float]]) -> Bools:
        """Which points are on one of the sides."""
        _, far = self.sides_drawn.nearest(np.array([*points]).reshape(-1, 2))
        return np.asarray(far < GAP)

    def holds(self, other: Loop) -> bool:
        """Whether another one is inside, away from the sides."""
        return other.area < self.area and bool((self.has(other.points) & ~self.near(other.points)).all())

    def covers(self, points: Sequence[tuple[float, float]]) -> bool:
        """Whether points are inside or on the sides."""
        return bool((self.has(points) | self.near(points)).all())


def place(at: tuple[float, float]) -> str:
    """Write a place [m] without the digits that are rounding."""
    return point(at, size=1.0)


def about(places: Sequence[tuple[float, float]]) -> str:
    """Say where things are, of many where the first are."""
    more = ", …" if len(places) > _MOST_PLACES else ""
    return f", at {', '.join(map(place, places[:_MOST_PLACES]))}{more}"


def off_line(at: Corner, a: Corner, b: Corner) -> float:
    """Distance [m] of a place from the line through two others."""
    x, y, length = b.x - a.x, b.y - a.y, math.dist(a[:2], b[:2])
    return abs(x * (at.y - a.y) - y * (at.x - a.x)) / length if length else math.dist(at[:2], a[:2])


def between(one: Sequence[Corner], other: Sequence[Corner]) -> tuple[tuple[float, float], ...] | None:
    """Corners [m] of the line along the middle of two straight-sided ones, if they are as far apart all along."""
    aparts = []
    for (a, b), (c, d) in zip(itertools.pairwise(one), itertools.pairwise(other), strict=True):
        along = (b.x - a.x) * (d.x - c.x) + (b.y - a.y) * (d.y - c.y)
        first, last = off_line(c, a, b), off_line(d, a, b)
        beside = min(off_line(a, c, d), off_line(b, c, d))
        if along <= 0 or max(first, last, beside) - min(first, last, beside) > 2 * GAP:
            return None
        aparts.append(first)
    if max(aparts) - min(aparts) > 2 * GAP or min(aparts) <= GAP:
        return None
    return tuple(((p.x + q.x) / 2, (p.y + q.y) / 2) for p, q in zip(one, other, strict=True))


def _triples(corners: Sequence[Corner]) -> Iterator[tuple[Corner, Corner, Corner]]:
    """Every corner between its neighbours."""
    return zip((*corners[-1:], *corners[:-1]), corners, (*corners[1:], *corners[:1]), strict=True)


def flattened(line: Sequence[Corner], turn: float) -> list[tuple[float, float]]:
    """Points of an open line, its arcs by chords that turn by an angle or less."""
    result = [(line[0].x, line[0].y)]
    for a, b in itertools.pairwise(line):
        pieces = math.ceil(abs(4 * math.atan(a.bulge)) / turn) if a.bulge else 1
        result += [_along(a, b, i / pieces) for i in range(1, pieces)] + [(b.x, b.y)]
    return result


def _along(a: Corner, b: Corner, part: float) -> tuple[float, float]:
    """Point of an arc at a part of its length."""
    half = 2 * math.atan(a.bulge)
    turn = 2 * half * part
    radius = math.hypot(b.x - a.x, b.y - a.y) / (2 * math.sin(half))
    start = math.atan2(b.y - a.y, b.x - a.x) - half
    chord = 2 * radius * math.sin(turn / 2)
    return a.x + chord * math.cos(start + turn / 2), a.y + chord * math.sin(start + turn / 2)


def through(a: Corner, b: Corner) -> tuple[float, float]:
    """Middle [m] of the arc from a corner to the next."""
    return (a.x + b.x + a.bulge * (b.y - a.y)) / 2, (a.y + b.y - a.bulge * (b.x - a.x)) / 2


def footprint_at(at: tuple[float, float], size: Footprint) -> Loop:
    """The shape of a footprint about a place [m]."""
    if len(size) == 1:
        return Loop((Corner(*at),), size[0])
    along = cmath.rect(1.0, math.radians(size[2] if len(size) > 2 else 0.0))
    corners = (complex(*at) + complex(u * size[0], v * size[1]) * along for u, v in _AROUND)
    return Loop(tuple(Corner(z.real, z.imag) for z in corners))


@dataclass(frozen=True)
class Slab:
    """The edges of a plate: its outline and its holes."""

    outline: Loop
    holes: Sequence[Loop]

    def beyond(self, points: Iterable[tuple[float, float]]) -> Floats:
        """Vectors (q, 2) [m] from points off the plate to the nearest place on it; zero for points on it."""
        at = np.array([*points]).reshape(-1, 2)
        off = np.any([~self.outline.has(at), *(hole.has(at) for hole in self.holes)], axis=0)
        return np.where(off[:, None], self._edges.nearest(at)[0] - at, 0.0)

    @cached_property
    def _edges(self) -> Targets:
        return Targets.join([loop.sides_drawn for loop in (self.outline, *self.holes)])

    def covers(self, points: Iterable[tuple[float, float]], within: float) -> bool:
        """Whether all points are on the plate, or nearer to it than a distance [m]."""
        return bool((np.hypot(*self.beyond(points).T) <= within).all())

    def _push(self, shape: Loop) -> complex:
        """The vector [m] that brings the point of a shape that is farthest off the plate onto an edge."""
        if not shape.radius:
            return max((complex(x, y) for x, y in self.beyond(shape.points).tolist()), key=abs)
        middle = np.array([shape.corners[0][:2]])
        (back,), (off,) = self.beyond(middle.tolist()), middle - self._edges.nearest(middle)[0]
        inward, reach = (back, math.hypot(*back)) if back.any() else (off, -math.hypot(*off))
        return complex(*inward) / (abs(reach) or 1.0) * max(shape.radius + reach, 0.0) if reach else shape.radius + 0j

    def moved(self, at: tuple[float, float], size: Footprint, most: float) -> tuple[float, float] | None:
        """The place [m] where a footprint is on the plate; None if it moves farther than a distance."""
        place = complex(*at)
        for _ in range(_PASSES):
            push = self._push(footprint_at((place.real, place.imag), size))
            if abs(push) <= _ON_PLATE:
                return place.real, place.imag
            place += push
            if abs(place - complex(*at)) > math.sqrt(2.0) * most:
                break
        return None

    def cut(self, at: tuple[float, float], size: Footprint) -> tuple[tuple[float, float], Footprint] | None:
        """The part of a rectangle [m] that is on the plate, if that is a rectangle."""
        whole, place, sides = footprint_at(at, size), complex(*at), np.array(size[:2])
        along = cmath.rect(1.0, math.radians(size[2] if len(size) > 2 else 0.0))
        for _ in range(_PASSES if len(size) > 1 else 0):
            rest = (place.real, place.imag), (*sides.round(6).tolist(), *size[2:])
            push = self._push(footprint_at(*rest))
            if abs(push) <= _ON_PLATE:
                parts = [overlap(np.array(whole.points), np.array(one.points)) for one in (self.outline, *self.holes)]
                same = abs(2.0 * parts[0] - sum(parts) - sides.prod()) < GAP * sides.sum()
                return rest if same else None
            local = push / along
            sides, place = sides - np.abs([local.real, local.imag]), place + 0.5 * push
            if sides.min() <= GAP:
                break
        return None


class Lost(NamedTuple):
    """Shapes of a role that were not taken, or footprints of points: how many, and the line that names them."""

    role: str
    number: int
    line: str


@dataclass(frozen=True)
class Drawing:
    """A plate as it is drawn."""

    outline: Loop
    holes: tuple[Loop, ...]
    zones: tuple[Loop, ...]
    """Parts of the plate that are made otherwise."""
    points: dict[Footprint, list[tuple[float, float]]]
    """By footprint the places (x, y) [m] that have it."""
    lines: tuple[tuple[Corner, ...], ...]
    """Open lines, arcs as they are."""
    took: tuple[str, ...]
    left: tuple[str, ...]
    """What became of every layer, in words."""
    lost: tuple[Lost, ...] = ()
    """The lines among them that name shapes of a role that were not taken."""

    @property
    def counts(self) -> list[str]:
        """How many shapes of each role were taken of those that are drawn."""
        taken = {"holes": len(self.holes), "zones": len(self.zones), "points": sum(map(len, self.points.values()))}
        taken["lines"] = len(self.lines)
        drawn = {role: some + sum(one.number for one in self.lost if one.role == role) for role, some in taken.items()}
        return [f"{role}: {taken[role]} of {count}" for role, count in drawn.items() if count]


THICKNESSES = (0.05, 0.6)
"""Metres between the faces of walls."""
_MATCHED, _SHARED = 0.75, 0.25
"""Part of the longer of two faces that both have: of those taken for one wall, and of those that may be."""
_LONG = 3.0
"""Length over distance from which on two lines are a wall."""
_ASKEW = 0.01
"""Slope to each other of parallel lines: half a degree, that of a careless drawing."""


def middles_of_loops(loops: Sequence[Loop]) -> tuple[list[tuple[Corner, ...]], list[Loop]]:
    """Closed lines along the middles of walls all around, of both faces; and the loops that are none."""
    result: list[tuple[Corner, ...]] = []
    rest: list[Loop] = []
    for loop in sorted(loops, key=lambda one: one.area):
        for inner in rest:
            if len(inner.corners) == len(loop.corners) > 2 and loop.holds(inner) and (ring := _ring(loop, inner)):
                rest.remove(inner)
                result.append(ring)
                break
        else:
            rest.append(loop)
    return result, rest


def _ring(outer: Loop, inner: Loop) -> tuple[Corner, ...] | None:
    around = (*outer.corners, outer.corners[0])
    if any(corner.bulge for corner in (*around, *inner.corners)):
        return None
    for corners in (inner.corners, inner.corners[::-1]):
        for i in range(len(corners)):
            ring = (*corners[i:], *corners[: i + 1])
            if _faces(around, ring, _SHARED) and (middle := between(around, ring)):
                return tuple(Corner(*at) for at in middle)
    return None


def middles_of_lines(
    lines: Sequence[tuple[Corner, ...]],
) -> tuple[list[tuple[Corner, ...]], list[tuple[float, tuple[float, float]]]]:
    """Lines, of those that are two faces of a wall the middle; distances of those, and where they begin."""
    straight = {i: line for i, line in enumerate(lines) if not any(corner.bulge for corner in line[:-1])}
    pairs = sorted(
        (apart, i, j)
        for (i, one), (j, other) in combinations(straight.items(), 2)
        if len(one) == len(other)
        and (apart := _faces(one, _alongside(one, other), _MATCHED if len(one) == 2 else _SHARED))
    )
    middle: dict[int, tuple[Corner, ...]] = {}
    result: list[tuple[float, tuple[float, float]]] = []
    for apart, i, j in pairs:
        one, other = straight[i], _alongside(straight[i], straight[j])
        if i in middle or j in middle or sum(math.dist(a[:2], b[:2]) for a, b in pairwise(one)) < _LONG * apart:
            continue
        ends = tuple(Corner((p.x + q.x) / 2, (p.y + q.y) / 2) for p, q in zip(one, other, strict=True))
        if len(one) > 2 and between(one, other) is None:
            continue
        middle |= {i: ends, j: ()}
        result.append((apart, (ends[0].x, ends[0].y)))
    return [one for i, line in enumerate(lines) if (one := middle.get(i, line))], result


def _alongside(one: tuple[Corner, ...], other: tuple[Corner, ...]) -> tuple[Corner, ...]:
    """Another line in the sense of one."""
    return other[::-1] if math.dist(one[0][:2], other[0][:2]) > math.dist(one[0][:2], other[-1][:2]) else other


def _faces(one: Sequence[Corner], other: Sequence[Corner], share: float) -> float | None:
    """Distance [m] of two lines of which every side is beside that of the other."""
    aparts = [_apart(a, b, share) for a, b in zip(pairwise(one), pairwise(other), strict=True)]
    return aparts[0] if all(aparts) else None


def beside_others(lines: Sequence[tuple[Corner, ...]]) -> list[tuple[float, float]]:
    """Where lines begin of which a straight side is beside one of an earlier line."""
    sides = [[(a, b) for a, b in pairwise(line) if not a.bulge] for line in lines]
    return [
        (line[0].x, line[0].y)
        for i, line in enumerate(lines)
        if any(_apart(one, other, _SHARED) is not None for one in sides[i] for of in sides[:i] for other in of)
    ]


def _apart(one: tuple[Corner, Corner], other: tuple[Corner, Corner], share: float) -> float | None:
    """Distance [m] of parallel sides as far apart as the faces of a wall, with a share of the longer one in common."""
    (a, b), (c, d) = one, other
    length, along = math.dist(a[:2], b[:2]), (b.x - a.x, b.y - a.y)
    if length < math.dist(c[:2], d[:2]):
        return _apart(other, one, share)

    def local(p: Corner) -> tuple[float, float]:
        x, y = p.x - a.x, p.y - a.y
        return (x * along[0] + y * along[1]) / length, (x * along[1] - y * along[0]) / length

    (u, v), (s, t) = local(c), local(d)
    apart, common = abs(v + t) / 2, min(max(u, s), length) - max(min(u, s), 0.0)
    parallel = abs(v - t) < 2 * GAP + _ASKEW * abs(u - s)
    return apart if parallel and THICKNESSES[0] <= apart <= THICKNESSES[1] and common >= share * length else None
