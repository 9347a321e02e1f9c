"""Control perimeters of punching: offsets of a column's outline, cut at free edges and behind openings.

Positions are complex numbers x + iy in any unit of length. A direction is a complex number of size 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import NamedTuple, Self, TypeAlias

import numpy as np
import numpy.typing as npt
import shapely

from signorini.errors import InputError
from signorini.shapes.arrays import Bools, Floats, Ints

Positions: TypeAlias = npt.NDArray[np.complex128]

_SAME = 1e-9
"""Relative tolerance for equal lengths and for points on an edge."""
_ALIKE = 0.5
"""Smallest angle in radians between the directions to two free edges; sides of a curved edge differ by less."""
_MOST_EDGES = 3
"""Largest number of free edges that a perimeter ends at."""
_BISECTIONS = 20
"""Number of bisections for the distance of a perimeter with a given length."""
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(12)


@dataclass(frozen=True, eq=False)
class Pieces:
    """Lines and arcs (m,): z(t) = c + v t + r exp(i(φ + θ t)) for 0 ≤ t ≤ 1; r = 0 on lines; v = 0, θ > 0 on arcs."""

    centre: Positions
    along: Positions
    radius: Floats
    begin: Floats
    turn: Floats

    @classmethod
    def joined(cls, pieces: Sequence[tuple[complex, complex, float, float, float]]) -> Self:
        """Make pieces from the five numbers of each; pieces without length are left out."""
        centre, along, radius, begin, turn = np.array(pieces, np.complex128).reshape(-1, 5).T
        every = cls(centre, along, radius.real, begin.real, turn.real)
        return every.pick(np.flatnonzero(every.lengths > 0.0))

    def __len__(self) -> int:
        """Count the pieces."""
        return len(self.centre)

    def pick(self, which: Ints) -> Self:
        """Pieces with given indices."""
        return type(self)(*(getattr(self, key)[which] for key in ("centre", "along", "radius", "begin", "turn")))

    def at(self, t: Floats) -> Positions:
        """Positions (m, k) at parameters (k,) or (m, k)."""
        angle = self.begin[:, None] + self.turn[:, None] * t
        arc = self.radius[:, None] * np.exp(1j * angle)
        return np.asarray(self.centre[:, None] + self.along[:, None] * t + arc)

    @property
    def lengths(self) -> Floats:
        """Lengths (m,)."""
        return np.asarray(np.abs(self.along) + self.radius * self.turn)

    @property
    def length(self) -> float:
        """Total length."""
        return float(self.lengths.sum())

    @property
    def centroid(self) -> complex:
        """Centroid of the pieces."""
        return complex((self.weights * self.nodes).sum() / self.length)

    @property
    def nodes(self) -> Positions:
        """Gauss points (m, 12)."""
        return self.at(0.5 + 0.5 * _POINTS)

    @property
    def weights(self) -> Floats:
        """Weights (m, 12) of the Gauss points; their sum is the length."""
        return np.asarray(0.5 * self.lengths[:, None] * _WEIGHTS)

    def cut(self, direction: complex, level: float) -> Self:
        """Divide the pieces where the coordinate along ``direction`` equals ``level``."""
        start = (self.centre * np.conj(direction)).real - level
        slope = (self.along * np.conj(direction)).real
        turn = np.where(self.turn == 0.0, np.nan, self.turn)
        with np.errstate(divide="ignore", invalid="ignore"):
            line = np.where(self.radius > 0.0, np.nan, -start / slope)
            half = np.arccos(-start / np.where(self.radius > 0.0, self.radius, np.nan))
        angles = np.angle(direction) - self.begin + np.stack([half, -half])
        arcs = angles % (2.0 * np.pi) / turn
        t = np.stack([line, *arcs, np.zeros(len(self)), np.ones(len(self))], axis=1)
        t = np.sort(np.where((t > 0.0) & (t < 1.0), t, np.where(t == 0.0, 0.0, 1.0)), axis=1)
        which, place = np.nonzero(np.diff(t, axis=1) > _SAME * 1e-3)
        first, width = t[which, place], t[which, place + 1] - t[which, place]
        own = self.pick(which)
        begin, centre = own.begin + own.turn * first, own.centre + own.along * first
        return type(self)(centre, own.along * width, own.radius, begin, own.turn * width)

    def where(self, kept: Bools) -> Self:
        """Pieces of a mask (m,)."""
        return self.pick(np.flatnonzero(kept))

    def beyond(self, direction: complex, level: float) -> Self:
        """Parts whose coordinate along ``direction`` is at least ``level``."""
        parts = self.cut(direction, level)
        return parts.where((parts._middles * np.conj(direction)).real >= level)

    def within(self, polygon: shapely.Polygon) -> Self:
        """Parts in a polygon."""
        parts, reach = self, np.abs(self.at(np.linspace(0.0, 1.0, 5)) - self.centroid).max() + self.lengths.max()
        middle = shapely.Point(self.centroid.real, self.centroid.imag)
        for begin, end in _sides(polygon):
            if shapely.distance(shapely.LineString([(p.real, p.imag) for p in (begin, end)]), middle) <= reach:
                normal = -1j * (end - begin) / abs(end - begin)
                parts = parts.cut(normal, (begin * np.conj(normal)).real)
        middles = parts._middles
        return parts.where(shapely.contains_xy(polygon, middles.real, middles.imag))

    def outside(self, centre: complex, first: complex, last: complex) -> Self:
        """Parts outside the sector from direction ``first`` to ``last``, less than half a turn, around a centre."""
        parts = self
        for ray in (first, last):
            parts = parts.cut(1j * ray, (centre * np.conj(1j * ray)).real)
        offset = parts._middles - centre
        inside = ((offset * np.conj(first)).imag > 0.0) & ((offset * np.conj(last)).imag < 0.0)
        return parts.where(~inside)

    def modulus(self, direction: complex, level: float) -> float:
        """W = ∫ |e| dl with the distance e along ``direction`` from the axis at ``level``."""
        parts = self.cut(direction, level)
        return float((parts.weights * np.abs((parts.nodes * np.conj(direction)).real - level)).sum())

    def inertia(self, direction: complex, level: float, depth: float) -> float:
        """J = ∫ (d e² + d³ (t·n)²/12) dl of vertical faces of depth d, with tangent t and ``direction`` n."""
        arms = (self.nodes * np.conj(direction)).real - level
        angle = self.begin[:, None] + self.turn[:, None] * (0.5 + 0.5 * _POINTS)
        lines = self.along / np.where(self.along == 0.0, 1.0, np.abs(self.along))
        tangent = np.where(self.radius[:, None] > 0.0, 1j * np.exp(1j * angle), lines[:, None])
        own = depth**3 / 12.0 * (tangent * np.conj(direction)).real ** 2
        return float((self.weights * (depth * arms**2 + own)).sum())

    def extent(self, direction: complex) -> tuple[float, float]:
        """Smallest and largest coordinate along a direction."""
        most = self.highest(np.array([direction, -direction]))
        return -float(most[1]), float(most[0])

    def highest(self, gradients: Positions) -> Floats:
        """Largest values (k,) of the linear functions Re(conj(g) z) on the pieces."""
        ends = self.at(np.array([0.0, 1.0])).ravel()
        result = (np.conj(gradients)[:, None] * ends).real.max(axis=1)
        arcs = self.where(self.radius > 0.0)
        met = (np.angle(gradients)[:, None] - arcs.begin) % (2.0 * np.pi) <= arcs.turn
        top = (np.conj(gradients)[:, None] * arcs.centre).real + arcs.radius * np.abs(gradients)[:, None]
        top = np.where(met, top, -np.inf)
        return np.asarray(np.maximum(result, top.max(axis=1, initial=-np.inf)))

    @property
    def _middles(self) -> Positions:
        return self.at(np.array([0.5]))[:, 0]


@dataclass(frozen=True)
class Column:
    """A loaded area: a convex polygon, counter-clockwise, all within ``radius``; a circle has one corner."""

    corners: tuple[complex, ...]
    radius: float = 0.0

    @classmethod
    def rectangle(cls, centre: complex, sides: tuple[float, float], angle: float = 0.0) -> Self:
        """A rectangle with its first side at an angle in degrees from x towards y."""
        b, h = sides
        turned = np.exp(1j * np.radians(angle)) if angle else 1.0
        return cls(tuple(complex(centre + turned * 0.5 * (u * b + 1j * v * h)) for u, v in _SQUARE))

    @classmethod
    def hull(cls, corners: Sequence[complex], radius: float = 0.0) -> Self:
        """The convex hull of points."""
        hull = shapely.MultiPoint([(p.real, p.imag) for p in corners]).convex_hull
        points = hull.exterior.coords[:-1] if isinstance(hull, shapely.Polygon) else hull.coords
        ordered = [complex(x, y) for x, y in points]
        area = sum((p.conjugate() * q).imag for p, q in zip(ordered, ordered[1:] + ordered[:1], strict=True))
        return cls(tuple(ordered[::-1] if area < 0.0 else ordered), radius)

    @cached_property
    def centre(self) -> complex:
        """Centroid of the area."""
        if len(self.corners) < 3:
            return complex(np.mean(self.corners))
        middle = shapely.Polygon([(p.real, p.imag) for p in self.corners]).centroid
        return complex(middle.x, middle.y)

    @property
    def axis(self) -> complex:
        """Direction of the longest side; 1 for a circle."""
        ahead = np.diff(np.append(self.corners, self.corners[0]))
        lengths = np.abs(ahead)
        if not lengths.max() > 0.0:
            return 1.0 + 0.0j
        longest = int(np.flatnonzero(lengths >= (1.0 - _SAME) * lengths.max())[0])
        return complex(ahead[longest] / lengths[longest])

    def extent(self, direction: complex) -> tuple[float, float]:
        """Smallest and largest coordinate along a direction."""
        along = (np.array(self.corners) * np.conj(direction)).real
        return float(along.min()) - self.radius, float(along.max()) + self.radius

    def size(self, direction: complex) -> float:
        """Width along a direction."""
        low, high = self.extent(direction)
        return high - low

    def extended(self, normals: Sequence[complex], by: float) -> Column:
        """The hull of the area and of its copies moved along some directions."""
        if not normals:
            return self
        return Column.hull([corner + by * normal for normal in (0.0, *normals) for corner in self.corners], self.radius)

    def offset(self, by: float, square: bool = False) -> Pieces:
        """The outline at a distance; at corners arcs or, with ``square``, corners of a polygon without radius."""
        corners, radius = np.array(self.corners), self.radius + by
        if len(corners) == 1:
            return Pieces.joined(
                [(corners[0], 0.0, radius, 0.5 * np.pi * quarter, 0.5 * np.pi) for quarter in range(4)]
            )
        ahead = np.roll(corners, -1) - corners
        normal = -1j * ahead / np.abs(ahead)
        before = np.roll(normal, 1)
        if square and not self.radius:
            moved = corners + by * (before + normal) / (1.0 + (before * np.conj(normal)).real)
            return Column(tuple(moved.tolist())).offset(0.0)
        pieces: list[tuple[complex, complex, float, float, float]] = []
        for corner, last, side, along in zip(corners, before, normal, ahead, strict=True):
            # Corners of a hull on one line turn by ± rounding, the ends of a line between two corners by ± π.
            turn = float(np.angle(side / last))
            turn = abs(turn) if abs(turn) > 3.0 else max(turn, 0.0)
            count = max(1, int(np.ceil(turn / (0.5 * np.pi) - _SAME)))
            begins = float(np.angle(last)) + turn / count * np.arange(count)
            pieces += [(corner, 0.0, radius, begin, turn / count) for begin in begins]
            pieces.append((corner + radius * side, along, 0.0, 0.0, 0.0))
        return Pieces.joined(pieces)


_SQUARE = ((-1, -1), (1, -1), (1, 1), (-1, 1))


class Perimeter(NamedTuple):
    """A control perimeter at a distance, the closed line that it is part of, and outward directions to free edges."""

    distance: float
    pieces: Pieces
    whole: Pieces
    normals: tuple[complex, ...]


@dataclass(frozen=True, eq=False)
class Plan:
    """A column in a slab with free edges; ``openings`` are those that reduce perimeters."""

    column: Column
    slab: shapely.Polygon
    openings: tuple[shapely.Polygon, ...]
    widened: bool = False

    @classmethod
    def of(cls, column: Column, rings: Sequence[Floats], within: float, widened: bool = False) -> Self:
        """Find the openings at most ``within`` from the column; ``widened`` as in Figure 6.14 of EN 1992-1-1.

        ``rings`` (k, 2) are the outlines of the slab and of its openings.
        """
        outer, *inner = sorted(map(shapely.Polygon, rings), key=lambda ring: -ring.area)
        slab = shapely.orient_polygons(shapely.Polygon(outer.exterior, [ring.exterior for ring in inner]))
        if not shapely.intersects_xy(slab, column.centre.real, column.centre.imag):
            at = f"({column.centre.real:g}, {column.centre.imag:g})"
            raise InputError(f"The column's centre {at} is not on the plate. Move the column onto the plate.")
        corners = shapely.MultiPoint([(p.real, p.imag) for p in column.corners]).convex_hull
        near = tuple(hole for hole in inner if shapely.distance(hole, corners) - column.radius <= within)
        return cls(column, slab, near, widened)

    def perimeter(self, distance: float, square: bool = False, to_edges: bool = True) -> Perimeter:
        """The shortest perimeter at a distance, free edges excluded, without the parts behind openings.

        With ``to_edges`` it may run straight to free edges.
        """
        basic = self.column.offset(distance, square)
        normals, far = self._edge_normals(0.5 * basic.length) if to_edges else [], basic.length
        best, shortest = Perimeter(distance, basic, basic, ()), np.inf
        for count in range(len(normals) + 1):
            for some in combinations(normals, count):
                whole = self.column.extended(some, far).offset(distance, square)
                pieces = whole.within(self.slab)
                # A column flush with an edge has equal perimeters with and without the edge.
                if 0.0 < pieces.length <= (1.0 + _SAME) * shortest:
                    best, shortest = Perimeter(distance, pieces, whole, some), pieces.length
        return best._replace(pieces=self.unshaded(best.pieces))

    def of_length(self, length: float) -> Pieces:
        """The perimeter of a given length, by bisection of its distance."""
        near, far = 0.0, length
        for _ in range(_BISECTIONS):
            middle = 0.5 * (near + far)
            near, far = (near, middle) if self.perimeter(middle).pieces.length >= length else (middle, far)
        return self.perimeter(far).pieces

    def face(self, normals: Sequence[complex]) -> Pieces:
        """The column's outline; towards free edges it is straight, and ends at the column's outermost point."""
        pieces = self.column.extended(normals, 4.0 * self.column.offset(0.0).length).offset(0.0)
        for normal in normals:
            pieces = pieces.beyond(-normal, self.column.extent(-normal)[0])
        return self.unshaded(pieces)

    def unshaded(self, pieces: Pieces) -> Pieces:
        """Parts of a perimeter outside the sectors between tangents from the column's centre to openings."""
        for opening in self.openings:
            pieces = pieces.outside(self.column.centre, *self._sector(opening))
        if not pieces.length > 0.0:
            raise InputError("Openings around the column leave no control perimeter. Move the column or the openings.")
        return pieces

    def _sector(self, opening: shapely.Polygon) -> tuple[complex, complex]:
        """Directions of the two tangents to an opening."""
        centre = self.column.centre
        corners = shapely.get_coordinates(opening.convex_hull)[:-1] @ [1.0, 1j] - centre
        middle = complex(opening.centroid.x, opening.centroid.y) - centre
        axis = middle / abs(middle)
        seen = corners * np.conj(axis)
        angles = np.angle(seen)
        if angles.max() - angles.min() >= np.pi * (1.0 - _SAME):
            raise InputError("An opening surrounds the column's centre. Move the column or the opening.")
        low, high = float(angles.min()), float(angles.max())
        radial, across = float(np.ptp(seen.real)), float(np.ptp(seen.imag))
        if self.widened and radial > across:
            # The width l2 counts as √(l1 l2) where the opening's length l1 is larger.
            wider = np.sqrt(radial / across)
            low, high = (
                float(np.arctan(wider * np.tan(angle))) if abs(angle) < 0.5 * np.pi else angle for angle in (low, high)
            )
        return axis * np.exp(1j * low), axis * np.exp(1j * high)

    def gap(self, normal: complex) -> float:
        """Distance of the column from the nearest free edge that has an outward normal; infinite without an edge."""
        gaps = [gap for gap, edge in self._edges if abs(np.angle(edge / normal)) < _SAME]
        return min(gaps, default=np.inf)

    @cached_property
    def _edges(self) -> list[tuple[float, complex]]:
        """Distances of the column from sides of the slab that face its centre, with the sides' outward normals."""
        found = []
        for begin, end in _sides(self.slab):
            length = abs(end - begin)
            foot = (self.column.centre - begin) * np.conj(end - begin) / length
            normal = complex(-1j * (end - begin) / length)
            if -_SAME * length <= foot.real <= length * (1.0 + _SAME) and foot.imag >= -_SAME * length:
                own = self.column.extent(normal)[1] - (self.column.centre * np.conj(normal)).real
                found.append((float(foot.imag - own), normal))
        return sorted(found, key=lambda edge: edge[0])

    def _edge_normals(self, within: float) -> list[complex]:
        """Outward normals of the free edges at most ``within`` away, the nearest first."""
        result: list[complex] = []
        for gap, normal in self._edges:
            apart = all(abs(np.angle(normal / other)) > _ALIKE for other in result)
            if gap <= within and len(result) < _MOST_EDGES and apart:
                result.append(normal)
        return result


def _sides(polygon: shapely.Polygon) -> list[tuple[complex, complex]]:
    """Sides of all rings of a polygon: begin and end."""
    rings = [shapely.get_coordinates(ring) @ [1.0, 1j] for ring in (polygon.exterior, *polygon.interiors)]
    return [(a, b) for ring in rings for a, b in zip(ring.tolist(), ring[1:].tolist(), strict=False) if a != b]
