"""Geometry of a drawn plate [m]: closed lines, open lines, points, and center lines of walls."""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain, combinations, pairwise
from typing import NamedTuple

import numpy as np

from signorini.errors import InputError, point
from signorini.shapes import Polygon
from signorini.shapes.arrays import Bools, Floats
from signorini.shapes.distances import Targets
from signorini.shapes.regions import inside, overlap

GAP = 1e-3
"""Points up to this distance [m] apart coincide: less than any built dimension, more than gaps of careless drawing."""
_WALL = 3.0
"""Smallest ratio of length to width of a rectangle that counts as a wall."""
_MAX_PLACES = 3
"""Largest number of points that a message lists."""
_FINE = math.radians(4)
"""Largest angle [rad] of the parts of an arc that are replaced by chords."""
_FINER = math.radians(0.2)
"""Largest angle [rad] of chords in the test whether a point is inside; they deviate by at most 2e-6 of the radius."""
_ON_PLATE = 1e-6
"""Points up to this distance [m] from the plate count as on the plate: one unit of the last digit of the input file."""
_PASSES = 8
"""Largest number of moves by which a footprint is brought onto the plate; at a corner each edge needs a move."""


Spot = tuple[float, float]
"""A point (x, y) [m]."""
Footprint = tuple[float, ...]
"""Size of a support's footprint [m]: rectangle (a, b), rotated rectangle (a, b, degrees), circle (r,) or point ()."""
_UNIT_CORNERS = ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))


class Corner(NamedTuple):
    """A corner (x, y) [m] and the bulge tan(φ/4) of the side that begins there.

    φ is the angle of the arc, positive if it turns left, and 0 for a straight side.
    """

    x: float
    y: float
    bulge: float = 0.0

    def is_at(self, other: Corner) -> bool:
        """Whether this corner and another corner coincide within `GAP`."""
        return max(abs(self.x - other.x), abs(self.y - other.y)) < GAP


@dataclass(frozen=True)
class Loop:
    """A closed line with sides from corner to corner, or a circle.

    A circle has its center as its only corner, and a ``radius`` [m].
    """

    corners: tuple[Corner, ...]
    radius: float = 0.0

    def __iter__(self) -> Iterator[tuple[Corner, Corner]]:
        """Iterate over the sides as pairs of their first and last corner."""
        return zip(self.corners, self.corners[1:] + self.corners[:1], strict=True)

    @property
    def area(self) -> float:
        """Enclosed area [m²], positive for both orientations of the line."""
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
        """Bounding box (xmin, ymin, xmax, ymax) [m] of the corners or of the circle."""
        x, y = [c.x for c in self.corners], [c.y for c in self.corners]
        return min(x) - self.radius, min(y) - self.radius, max(x) + self.radius, max(y) + self.radius

    @property
    def middle(self) -> tuple[float, float]:
        """Center (x, y) [m] of the line's bounding box."""
        left, bottom, right, top = self.box
        return (left + right) / 2, (bottom + top) / 2

    @property
    def sides(self) -> tuple[float, float] | None:
        """Side lengths [m] along x and y of a rectangle parallel to the axes; None for other lines."""
        left, bottom, right, top = self.box
        at_corners = all(
            c.bulge == 0 and min(c.x - left, right - c.x) < GAP and min(c.y - bottom, top - c.y) < GAP
            for c in self.corners
        )
        box_area = (right - left) * (top - bottom)
        return (right - left, top - bottom) if at_corners and self.area > box_area / 2 > 0 else None

    @property
    def turned_sides(self) -> tuple[float, float, float] | None:
        """Side lengths [m] of a rectangle and the angle of its first side, -45° to 45°; None for other lines."""
        if not self.is_rectangle:
            return None
        a, b, c, _ = self.corners
        first, second = math.dist(a[:2], b[:2]), math.dist(b[:2], c[:2])
        degrees = math.degrees(math.atan2(b.y - a.y, b.x - a.x))
        turns = round(degrees / 90.0)
        return (*((first, second) if turns % 2 == 0 else (second, first)), degrees - 90.0 * turns)

    @property
    def footprint(self) -> Footprint | None:
        """Footprint size [m] of a circle or rectangle, rounded to millimetres; None for other closed lines."""
        size = (self.radius,) if self.radius else self.sides or self.turned_sides
        return None if size is None else tuple(round(part, 3) for part in size)

    @property
    def middle_line(self) -> tuple[tuple[float, float], ...] | None:
        """Corners [m] of the center line of the wall whose outline is this closed line; None if it is not a wall.

        A wall has constant thickness, and is at least 3 times as long as thick.
        """
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
        """Whether the line is a rectangle, parallel to the axes or not."""
        if len(self.corners) != 4 or any(corner.bulge for corner in self.corners):
            return False
        a, b, c, d = self.corners
        meets = math.hypot(a.x + c.x - b.x - d.x, a.y + c.y - b.y - d.y) < 2 * GAP
        return meets and abs(math.dist(a[:2], c[:2]) - math.dist(b[:2], d[:2])) < 2 * GAP

    @cached_property
    def points(self) -> list[tuple[float, float]]:
        """Corners [m] of the closed line, and points at most 4° apart on its arcs."""
        return self.chords(_FINE)

    def chords(self, turn: float) -> list[tuple[float, float]]:
        """Corners [m] of the closed line, and points of its arcs at most ``turn`` [rad] apart; at least three."""
        if self.radius:
            right, left = (Corner(self.corners[0].x + side * self.radius, self.corners[0].y, 1.0) for side in (1, -1))
            return Loop((right, left)).chords(turn)
        if len(self.corners) == 2:
            turn = min([turn, *(2 * math.atan(abs(corner.bulge)) for corner in self.corners if corner.bulge)])
        return flattened((*self.corners, self.corners[0]), turn)[:-1]

    @cached_property
    def is_simple(self) -> bool:
        """Whether the closed line neither crosses nor touches itself."""
        try:
            return bool(self.radius) or Polygon(tuple(self.points)).area > 0
        except InputError:
            return False

    @property
    def is_thin(self) -> bool:
        """Whether all points of the closed line are on one straight line."""
        x, y = max(self.points, key=lambda point: math.dist(point, self.points[0]))
        far = max(self.points, key=lambda point: math.dist(point, (x, y)))
        length = math.dist(far, (x, y))
        rises = (abs((far[0] - x) * (b - y) - (far[1] - y) * (a - x)) for a, b in self.points)
        return max(rises) <= GAP * length

    @cached_property
    def _fine(self) -> Floats:
        """Corners (k, 2) [m] of a polygon that approximates the line within 2e-6 of the radius of its arcs."""
        return np.array(self.chords(_FINER))

    @cached_property
    def sides_drawn(self) -> Targets:
        """Straight sides and arcs of the closed line, in a form for computing distances from points."""
        if self.radius:
            return Targets.of(arcs=[(*self.corners[0][:2], self.radius, 0.0, math.tau)])
        return Targets.on((a[:2], through(a, b) if a.bulge else None, b[:2]) for a, b in self)

    def has(self, points: Iterable[tuple[float, float]]) -> Bools:
        """Mask (q,) of the points (q, 2) inside the line."""
        return inside(np.array([*points]).reshape(-1, 2), self._fine)

    def near(self, points: Iterable[tuple[float, float]]) -> Bools:
        """Mask (q,) of the points (q, 2) that are on a side, within `GAP`."""
        _, far = self.sides_drawn.nearest(np.array([*points]).reshape(-1, 2))
        return np.asarray(far < GAP)

    def holds(self, other: Loop) -> bool:
        """Whether another line is inside this line without touching it."""
        return other.area < self.area and bool((self.has(other.points) & ~self.near(other.points)).all())

    def covers(self, points: Sequence[tuple[float, float]]) -> bool:
        """Whether all points are inside this line or on a side."""
        return bool((self.has(points) | self.near(points)).all())


def place(xy: tuple[float, float]) -> str:
    """Write a point [m] as "[x, y]" for a message."""
    return point(xy, size=1.0)


def about(places: Sequence[tuple[float, float]]) -> str:
    """Return the part ", at [x, y], ..." of a message, with the first three points of a list."""
    more = ", …" if len(places) > _MAX_PLACES else ""
    return f", at {', '.join(map(place, places[:_MAX_PLACES]))}{more}"


def off_line(at: Corner, a: Corner, b: Corner) -> float:
    """Distance [m] of the point ``at`` from the straight line through a and b."""
    x, y, length = b.x - a.x, b.y - a.y, math.dist(a[:2], b[:2])
    return abs(x * (at.y - a.y) - y * (at.x - a.x)) / length if length else math.dist(at[:2], a[:2])


def between(first: Sequence[Corner], second: Sequence[Corner]) -> tuple[tuple[float, float], ...] | None:
    """Corners [m] of the polyline midway between two polylines; None if the two are not at constant distance."""
    distances = []
    for (a, b), (c, d) in zip(itertools.pairwise(first), itertools.pairwise(second), strict=True):
        along = (b.x - a.x) * (d.x - c.x) + (b.y - a.y) * (d.y - c.y)
        at_c, at_d = off_line(c, a, b), off_line(d, a, b)
        at_ab = min(off_line(a, c, d), off_line(b, c, d))
        if along <= 0 or max(at_c, at_d, at_ab) - min(at_c, at_d, at_ab) > 2 * GAP:
            return None
        distances.append(at_c)
    if max(distances) - min(distances) > 2 * GAP or min(distances) <= GAP:
        return None
    return tuple(((p.x + q.x) / 2, (p.y + q.y) / 2) for p, q in zip(first, second, strict=True))


def _triples(corners: Sequence[Corner]) -> Iterator[tuple[Corner, Corner, Corner]]:
    """Iterate over triples (previous corner, corner, next corner) of a closed line."""
    return zip((*corners[-1:], *corners[:-1]), corners, (*corners[1:], *corners[:1]), strict=True)


def flattened(line: Sequence[Corner], turn: float) -> list[tuple[float, float]]:
    """Points [m] of an open line in which arcs are replaced by chords, each for at most ``turn`` [rad] of the arc."""
    points = [(line[0].x, line[0].y)]
    for a, b in itertools.pairwise(line):
        chords = math.ceil(abs(4 * math.atan(a.bulge)) / turn) if a.bulge else 1
        points += [_along(a, b, i / chords) for i in range(1, chords)] + [(b.x, b.y)]
    return points


def _along(a: Corner, b: Corner, part: float) -> tuple[float, float]:
    """Point [m] of the arc from a to b at the fraction ``part`` of its length."""
    half = 2 * math.atan(a.bulge)
    turn = 2 * half * part
    radius = math.hypot(b.x - a.x, b.y - a.y) / (2 * math.sin(half))
    start = math.atan2(b.y - a.y, b.x - a.x) - half
    chord = 2 * radius * math.sin(turn / 2)
    return a.x + chord * math.cos(start + turn / 2), a.y + chord * math.sin(start + turn / 2)


def through(a: Corner, b: Corner) -> tuple[float, float]:
    """Point (x, y) [m] in the middle of the arc from corner a to corner b."""
    return (a.x + b.x + a.bulge * (b.y - a.y)) / 2, (a.y + b.y - a.bulge * (b.x - a.x)) / 2


def footprint_at(at: tuple[float, float], size: Footprint) -> Loop:
    """Outline of a footprint of the given size, with its center at the point ``at`` [m]."""
    if len(size) == 1:
        return Loop((Corner(*at),), size[0])
    along = cmath.rect(1.0, math.radians(size[2] if len(size) > 2 else 0.0))
    corners = (complex(*at) + complex(u * size[0], v * size[1]) * along for u, v in _UNIT_CORNERS)
    return Loop(tuple(Corner(z.real, z.imag) for z in corners))


@dataclass(frozen=True)
class Slab:
    """Outline of a plate, and outlines of its holes."""

    outline: Loop
    holes: Sequence[Loop]

    def beyond(self, points: Iterable[tuple[float, float]]) -> Floats:
        """Vectors (q, 2) [m] from points outside the plate to the nearest edge point; zero for points on the plate."""
        xy = np.array([*points]).reshape(-1, 2)
        off = np.any([~self.outline.has(xy), *(hole.has(xy) for hole in self.holes)], axis=0)
        return np.where(off[:, None], self._edges.nearest(xy)[0] - xy, 0.0)

    @cached_property
    def _edges(self) -> Targets:
        return Targets.join([loop.sides_drawn for loop in (self.outline, *self.holes)])

    def covers(self, points: Iterable[tuple[float, float]], within: float) -> bool:
        """Whether all points are on the plate or at most ``within`` [m] from the plate."""
        return bool((np.hypot(*self.beyond(points).T) <= within).all())

    def _push(self, shape: Loop) -> complex:
        """Vector [m] by which a shape is moved so that its point farthest outside the plate is on an edge."""
        if not shape.radius:
            return max((complex(x, y) for x, y in self.beyond(shape.points).tolist()), key=abs)
        middle = np.array([shape.corners[0][:2]])
        (back,), (off,) = self.beyond(middle.tolist()), middle - self._edges.nearest(middle)[0]
        inward, reach = (back, math.hypot(*back)) if back.any() else (off, -math.hypot(*off))
        return complex(*inward) / (abs(reach) or 1.0) * max(shape.radius + reach, 0.0) if reach else shape.radius + 0j

    def moved(self, at: tuple[float, float], size: Footprint, most: float) -> tuple[float, float] | None:
        """Center [m] of a footprint moved onto the plate; None if this needs a move of more than √2 ``most`` [m]."""
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
        """Center and size of the part of a rectangular footprint on the plate; None if this part is not a rectangle."""
        whole, place, sides = footprint_at(at, size), complex(*at), np.array(size[:2])
        along = cmath.rect(1.0, math.radians(size[2] if len(size) > 2 else 0.0))
        for _ in range(_PASSES if len(size) > 1 else 0):
            part = (place.real, place.imag), (*sides.round(6).tolist(), *size[2:])
            push = self._push(footprint_at(*part))
            if abs(push) <= _ON_PLATE:
                edges = (self.outline, *self.holes)
                overlaps = [overlap(np.array(whole.points), np.array(edge.points)) for edge in edges]
                same = abs(2.0 * overlaps[0] - sum(overlaps) - sides.prod()) < GAP * sides.sum()
                return part if same else None
            local = push / along
            sides, place = sides - np.abs([local.real, local.imag]), place + 0.5 * push
            if sides.min() <= GAP:
                break
        return None


class Lost(NamedTuple):
    """Shapes of one role (such as "holes") that were not imported: role, number of shapes, message with the reason."""

    role: str
    number: int
    line: str


@dataclass(frozen=True)
class Drawing:
    """A drawn plate: shapes of the drawing by their roles in the model; lengths in metres."""

    outline: Loop
    holes: tuple[Loop, ...]
    zones: tuple[Loop, ...]
    """Outlines of zones with another thickness or material."""
    points: dict[Footprint, list[tuple[float, float]]]
    """Positions (x, y) [m] of point supports, grouped by the size of their footprints."""
    lines: tuple[tuple[Corner, ...], ...]
    """Open lines with straight sides and arcs, which become supports."""
    took: tuple[str, ...]
    left: tuple[str, ...]
    """Messages about all shapes of the drawing that were not imported."""
    lost: tuple[Lost, ...] = ()
    """Shapes that have a role but could not be imported; they make `signorini import-dxf` fail."""

    @property
    def counts(self) -> list[str]:
        """Texts such as "holes: 2 of 3": for each role the number of imported shapes and the number of drawn shapes."""
        used = {"holes": len(self.holes), "zones": len(self.zones), "points": sum(map(len, self.points.values()))}
        used["lines"] = len(self.lines)
        drawn = {role: n + sum(lost.number for lost in self.lost if lost.role == role) for role, n in used.items()}
        return [f"{role}: {used[role]} of {count}" for role, count in drawn.items() if count]


THICKNESSES = (0.05, 0.6)
"""Smallest and largest thickness [m] of a wall."""
_MATCHED, _SHARED = 0.75, 0.25
"""Smallest length on which two faces of a wall are opposite each other, as a fraction of the longer face.

The first value is for single straight lines; the second for lines of several sides and for possible walls.
"""
_LONG = 3.0
"""Smallest ratio of length to distance at which two lines count as the faces of a wall."""
_ASKEW = 0.01
"""Two lines are parallel up to this slope between them, half a degree: the accuracy of drawings."""


def middles_of_loops(loops: Sequence[Loop]) -> tuple[list[tuple[Corner, ...]], list[Loop]]:
    """Find pairs of closed lines that are the outer and inner faces of a wall.

    Return the closed center lines of these walls, and the other closed lines.
    """
    middles: list[tuple[Corner, ...]] = []
    rest: list[Loop] = []
    for loop in sorted(loops, key=lambda loop: loop.area):
        for inner in rest:
            if len(inner.corners) == len(loop.corners) > 2 and loop.holds(inner) and (ring := _ring(loop, inner)):
                rest.remove(inner)
                middles.append(ring)
                break
        else:
            rest.append(loop)
    return middles, rest


def _ring(outer: Loop, inner: Loop) -> tuple[Corner, ...] | None:
    closed_outer = (*outer.corners, outer.corners[0])
    if any(corner.bulge for corner in (*closed_outer, *inner.corners)):
        return None
    for corners in (inner.corners, inner.corners[::-1]):
        for i in range(len(corners)):
            ring = (*corners[i:], *corners[: i + 1])
            if _faces(closed_outer, ring, _SHARED) and (middle := between(closed_outer, ring)):
                return tuple(Corner(*xy) for xy in middle)
    return None


def middles_of_lines(
    lines: Sequence[tuple[Corner, ...]],
) -> tuple[list[tuple[Corner, ...]], list[tuple[float, tuple[float, float]]]]:
    """Replace each pair of open lines that are the faces of a wall by the center line.

    Return the lines, with center lines in place of faces, and the thickness and start of each wall.
    """
    straight = {i: line for i, line in enumerate(lines) if not any(corner.bulge for corner in line[:-1])}
    pairs = sorted(
        (distance, i, j)
        for (i, first), (j, second) in combinations(straight.items(), 2)
        if len(first) == len(second)
        and (distance := _faces(first, _oriented_as(first, second), _MATCHED if len(first) == 2 else _SHARED))
    )
    middles: dict[int, tuple[Corner, ...]] = {}
    walls: list[tuple[float, tuple[float, float]]] = []
    for distance, i, j in pairs:
        first, second = straight[i], _oriented_as(straight[i], straight[j])
        if i in middles or j in middles or sum(math.dist(a[:2], b[:2]) for a, b in pairwise(first)) < _LONG * distance:
            continue
        middle = tuple(Corner((p.x + q.x) / 2, (p.y + q.y) / 2) for p, q in zip(first, second, strict=True))
        if len(first) > 2 and between(first, second) is None:
            continue
        middles |= {i: middle, j: ()}
        walls.append((distance, (middle[0].x, middle[0].y)))
    return [kept for i, line in enumerate(lines) if (kept := middles.get(i, line))], walls


def _oriented_as(line: tuple[Corner, ...], other: tuple[Corner, ...]) -> tuple[Corner, ...]:
    """The line ``other``, reversed if its last point is nearer to the start of ``line`` than its first point."""
    return other[::-1] if math.dist(line[0][:2], other[0][:2]) > math.dist(line[0][:2], other[-1][:2]) else other


def _faces(first: Sequence[Corner], second: Sequence[Corner], share: float) -> float | None:
    """Distance [m] of two lines if corresponding sides of both lines are faces of a wall; None otherwise."""
    distances = [_face_distance(a, b, share) for a, b in zip(pairwise(first), pairwise(second), strict=True)]
    return distances[0] if all(distances) else None


def beside_others(lines: Sequence[tuple[Corner, ...]]) -> list[tuple[float, float]]:
    """Start points of lines of which a side and a side of an earlier line may be the two faces of a wall."""
    sides = [[(a, b) for a, b in pairwise(line) if not a.bulge] for line in lines]
    return [
        (line[0].x, line[0].y)
        for i, line in enumerate(lines)
        if any(_face_distance(side, earlier, _SHARED) is not None for side in sides[i] for earlier in chain(*sides[:i]))
    ]


def _face_distance(first: tuple[Corner, Corner], second: tuple[Corner, Corner], share: float) -> float | None:
    """Distance [m] of two parallel sides if they are faces of a wall; None otherwise.

    The sides must be opposite each other along at least the fraction ``share`` of the longer side.
    """
    (a, b), (c, d) = first, second
    length, along = math.dist(a[:2], b[:2]), (b.x - a.x, b.y - a.y)
    if length < math.dist(c[:2], d[:2]):
        return _face_distance(second, first, share)

    def local(p: Corner) -> tuple[float, float]:
        x, y = p.x - a.x, p.y - a.y
        return (x * along[0] + y * along[1]) / length, (x * along[1] - y * along[0]) / length

    (u, v), (s, t) = local(c), local(d)
    distance, common = abs(v + t) / 2, min(max(u, s), length) - max(min(u, s), 0.0)
    parallel = abs(v - t) < 2 * GAP + _ASKEW * abs(u - s)
    matches = parallel and THICKNESSES[0] <= distance <= THICKNESSES[1] and common >= share * length
    return distance if matches else None
