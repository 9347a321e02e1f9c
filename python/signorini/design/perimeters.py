"""Control perimeters of punching: offsets of a column's outline, cut at free edges and behind openings.

Positions are complex numbers x + iy in any unit of length. A direction is a complex number of modulus 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from itertools import combinations
from typing import NamedTuple, Self, TypeAlias

import numpy as np
import numpy.typing as npt
import shapely

from signorini.base.on_demand import kept
from signorini.errors import InputError
from signorini.shapes.arrays import Bools, Floats, Ints

Positions: TypeAlias = npt.NDArray[np.complex128]

NUMBERS = (
    *("u0", "u1", "uout", "force", "inside", "beta", "v_ed", "v_ed_face"),
    *("v_rd_c", "v_rd_max", "utilisation", "with_links", "asw"),
)
"""Names of the numbers that a punching check of a column returns."""
_SAME = 1e-9
"""Relative tolerance for equal lengths, and for points on an edge."""
_ALIKE = 0.5
"""Largest angle [rad] between normals of free edges that count as one edge, of opposite edges that count as parallel,
and of parts of a perimeter that counts as straight."""
_MOST_EDGES = 2
"""Largest number of free edges at which a perimeter ends; with three it would be a straight line: one-way shear."""
_FAR = 4.0
"""Length by which a perimeter is continued towards a free edge before it is cut there, over the closed perimeter's."""
_SLIGHTLY = 1e-6
"""Margin by which lines of sight start off the column's centre and end beyond the perimeter, over their length."""
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
    def of(cls, pieces: Sequence[tuple[complex, ...]]) -> Self:
        """Make pieces from the parameters c, v, r, φ, θ of each z(t); pieces without length are left out."""
        centre, along, *arcs = np.array(pieces, np.complex128).T
        every = cls(centre, along, *(values.real for values in arcs))
        return every.pick(np.flatnonzero(every.lengths > 0.0))

    def pick(self, which: Ints | Bools) -> Self:
        """Select pieces by their indices, or by a mask (m,)."""
        return type(self)(*(getattr(self, key.name)[which] for key in fields(self)))

    def at(self, t: Floats) -> Positions:
        """Positions z(t) (m, k) on all pieces at parameters t (k,)."""
        angle = self.begin[:, None] + self.turn[:, None] * t
        arc = self.radius[:, None] * np.exp(1j * angle)
        return np.asarray(self.centre[:, None] + self.along[:, None] * t + arc)

    @property
    def lengths(self) -> Floats:
        """Lengths (m,)."""
        return np.asarray(np.abs(self.along) + self.radius * self.turn)

    @cached_property
    def length(self) -> float:
        """Total length."""
        return float(self.lengths.sum())

    @property
    def middles(self) -> Positions:
        """Middle (m,) of each piece."""
        return self.at(np.array([0.5]))[:, 0]

    @property
    def gauss(self) -> tuple[Positions, Floats]:
        """Gauss points (m, 12) on the pieces, and their weights, whose sum is the total length."""
        return self.at(0.5 + 0.5 * _POINTS), 0.5 * self.lengths[:, None] * _WEIGHTS

    @cached_property
    def centroid(self) -> complex:
        """Centroid of the pieces."""
        nodes, weights = self.gauss
        return complex((weights * nodes).sum() / self.length)

    def cut(self, direction: complex, level: float) -> Self:
        """Divide the pieces where the coordinate along ``direction`` equals ``level``."""
        start, slope = _along(self.centre, direction) - level, _along(self.along, direction)
        with np.errstate(divide="ignore", invalid="ignore"):
            line = np.where(self.radius > 0.0, np.nan, -start / slope)
            half = np.arccos(-start / np.where(self.radius > 0.0, self.radius, np.nan))
            angles = np.angle(direction) - self.begin + np.stack([half, -half])
            t = np.stack([line, *(angles % (2.0 * np.pi) / self.turn)], axis=1)
        t = np.where((t > 0.0) & (t < 1.0), t, 1.0)
        t = np.sort(np.pad(t, ((0, 0), (1, 1)), constant_values=(0.0, 1.0)), axis=1)
        which, place = np.nonzero(np.diff(t, axis=1) > 1e-3 * _SAME)
        first, width, own = t[which, place], np.diff(t, axis=1)[which, place], self.pick(which)
        centre, begin = own.centre + own.along * first, own.begin + own.turn * first
        return type(self)(centre, own.along * width, own.radius, begin, own.turn * width)

    def beyond(self, direction: complex, level: float) -> Self:
        """Parts of the pieces whose coordinate along ``direction`` is at least ``level``."""
        parts = self.cut(direction, level)
        return parts.pick(_along(parts.middles, direction) >= level)

    @property
    def closed(self) -> Self:
        """The pieces, in order, with lines between them that close their outline."""
        begins, ends = self.at(np.array([0.0, 1.0])).T
        rows = np.column_stack([self.centre, self.along, self.radius, self.begin, self.turn])
        gaps = np.roll(begins, -1) - ends
        lines = np.column_stack([ends, gaps, np.zeros((len(gaps), 3))])
        lines[np.abs(gaps) <= _SAME * np.abs(gaps).max()] = 0.0
        return self.of([tuple(row) for pair in zip(rows, lines, strict=True) for row in pair])

    def outside(self, centre: complex, first: complex, width: float) -> Self:
        """Parts of the pieces outside a sector with apex ``centre``, counter-clockwise from ``first`` by ``width``."""
        parts = self
        for ray in (1j * first, 1j * first * np.exp(1j * width)):
            parts = parts.cut(ray, float(_along(centre, ray)))
        return parts.pick(np.angle((parts.middles - centre) / first) % (2.0 * np.pi) >= width)

    @property
    def is_straight(self) -> bool:
        """Whether the pieces form a nearly straight line: their normals differ by at most `_ALIKE`."""
        begins = np.where(self.radius > 0.0, np.exp(1j * self.begin), -1j * self.along)
        normals = np.concatenate([begins, begins * np.exp(1j * self.turn)])
        return bool((np.abs(np.angle(normals[:, None] / normals)) <= _ALIKE).all())

    def modulus(self, direction: complex) -> float:
        """W = ∫ |e| dl with the distance e along ``direction`` from the axis through the centroid."""
        level = float(_along(self.centroid, direction))
        nodes, weights = self.cut(direction, level).gauss
        return float((weights * np.abs(_along(nodes, direction) - level)).sum())

    @property
    def principal(self) -> complex:
        """Direction along which ∫ e² dl is largest, with coordinates e relative to the centroid."""
        nodes, weights = self.gauss
        return complex(np.exp(0.5j * np.angle((weights * (nodes - self.centroid) ** 2).sum())))

    @kept
    def inertia(self, direction: complex, depth: float) -> float:
        """J = ∫ (d e² + d³ (t·n)²/12) dl: depth d, tangent t, ``direction`` n, distance e along n from the centroid."""
        angle = self.begin[:, None] + self.turn[:, None] * (0.5 + 0.5 * _POINTS)
        lines = self.along / np.where(self.along == 0.0, 1.0, np.abs(self.along))
        tangent = np.where(self.radius[:, None] > 0.0, 1j * np.exp(1j * angle), lines[:, None])
        own = depth**3 / 12.0 * _along(tangent, direction) ** 2
        nodes, weights = self.gauss
        size = (weights * (depth * _along(nodes - self.centroid, direction) ** 2 + own)).sum()
        return max(float(size), _SAME * depth * self.length**3)

    def highest(self, gradients: Positions) -> Floats:
        """Largest values (k,) on the pieces of the linear functions Re(conj(g) z) with ``gradients`` g (k,)."""
        ends, arcs = self.at(np.array([0.0, 1.0])).ravel(), self.pick(self.radius > 0.0)
        met = (np.angle(gradients)[:, None] - arcs.begin) % (2.0 * np.pi) <= arcs.turn
        top = _along(arcs.centre, gradients[:, None]) + arcs.radius * np.abs(gradients)[:, None]
        values = np.concatenate([_along(ends, gradients[:, None]), np.where(met, top, -np.inf)], axis=1)
        return np.asarray(values.max(axis=1))


@dataclass(frozen=True)
class Column:
    """Section of a column: points within ``radius`` of a convex counter-clockwise polygon; a circle has one corner."""

    corners: tuple[complex, ...]
    radius: float = 0.0

    @classmethod
    def hull(cls, corners: Sequence[complex], radius: float = 0.0) -> Self:
        """The convex hull of points."""
        hull = shapely.MultiPoint([(p.real, p.imag) for p in corners]).convex_hull
        if isinstance(hull, shapely.Polygon):
            hull = shapely.LineString(shapely.orient_polygons(hull).exterior.coords[:-1])
        return cls(tuple(complex(x, y) for x, y in hull.coords), radius)

    @cached_property
    def centre(self) -> complex:
        """Centroid of the area."""
        middle = shapely.MultiPoint([(p.real, p.imag) for p in self.corners]).convex_hull.centroid
        return complex(middle.x, middle.y)

    @property
    def axis(self) -> complex:
        """Direction of the longest side; the x direction, 1, for a circle."""
        ahead = np.roll(self.corners, -1) - self.corners
        longest = ahead[np.argmax(np.abs(ahead) >= (1.0 - _SAME) * np.abs(ahead).max())]
        return complex(longest / abs(longest)) if abs(longest) > 0.0 else 1.0 + 0.0j

    def distance(self, line: Floats) -> float:
        """Distance of the area from a polyline through points (k, 2); at most 0 if the polyline meets the area."""
        corners = shapely.MultiPoint([(p.real, p.imag) for p in self.corners]).convex_hull
        return float(shapely.distance(shapely.LineString(line), corners)) - self.radius

    def extent(self, direction: complex) -> tuple[float, float]:
        """Smallest and largest coordinate of the area along a direction."""
        along = _along(np.array(self.corners), direction)
        return float(along.min()) - self.radius, float(along.max()) + self.radius

    def size(self, direction: complex) -> float:
        """Width of the area along a direction."""
        low, high = self.extent(direction)
        return high - low

    def extended(self, normals: Sequence[complex], by: float) -> Column:
        """The convex hull of the area and of its copies, one moved by the length ``by`` along each of ``normals``."""
        moved = [corner + by * normal for normal in (0.0, *normals) for corner in self.corners]
        return Column.hull(moved, self.radius) if normals else self

    def offset(self, by: float, square: bool = False) -> Pieces:
        """The area's outline offset by a distance, with arcs at corners; ``square`` keeps corners of polygons sharp."""
        corners, radius = np.array(self.corners), self.radius + by
        if len(corners) == 1:
            return Pieces.of([(corners[0], 0.0, radius, 0.5 * np.pi * k, 0.5 * np.pi) for k in range(4)])
        ahead = np.roll(corners, -1) - corners
        normal = -1j * ahead / np.abs(ahead)
        before, pieces = np.roll(normal, 1), list[tuple[complex, ...]]()
        if square and not self.radius:
            return Column(tuple(corners + by * (before + normal) / (1.0 + _along(before, normal)))).offset(0.0)
        for corner, last, side, along in zip(corners, before, normal, ahead, strict=True):
            # At corners on a straight line the turn is 0 ± rounding; at the ends of a hull of two corners it is ± π.
            turn = float(np.angle(side / last))
            turn = abs(turn) if abs(turn) > 3.0 else max(turn, 0.0)
            count = max(1, int(np.ceil(turn / (0.5 * np.pi) - _SAME)))
            begins = np.angle(last) + turn / count * np.arange(count)
            pieces += [(corner, 0.0, radius, begin, turn / count) for begin in begins]
            pieces.append((corner + radius * side, along, 0.0, 0.0, 0.0))
        return Pieces.of(pieces)


class Edge(NamedTuple):
    """A free edge: its outward normal, and its distance from the column."""

    normal: complex
    gap: float


class Perimeter(NamedTuple):
    """A control perimeter at a distance, the closed line that it is part of, and the free edges at which it ends."""

    distance: float
    pieces: Pieces
    whole: Pieces
    edges: tuple[Edge, ...]

    @property
    def normals(self) -> tuple[complex, ...]:
        """Outward normals of the edges."""
        return tuple(edge.normal for edge in self.edges)


@dataclass(frozen=True, eq=False)
class Plan:
    """A column in a slab with free edges; ``openings`` are those that reduce perimeters."""

    column: Column
    slab: shapely.Polygon
    openings: tuple[shapely.Polygon, ...]
    widened: bool = False

    @classmethod
    def of(cls, column: Column, rings: Sequence[Floats], within: float, widened: bool = False) -> Self:
        """Plan with the openings at most ``within`` from the column; ``widened``: widths by Figure 6.14 of EN 1992-1-1.

        ``rings`` (k, 2) are the outlines of the slab and of its openings.
        """
        outer, *inner = sorted(map(shapely.Polygon, rings), key=lambda ring: -ring.area)
        slab = shapely.orient_polygons(shapely.Polygon(outer.exterior, [ring.exterior for ring in inner]))
        if not shapely.intersects_xy(slab, column.centre.real, column.centre.imag):
            raise InputError(f"The column's centre {column.centre:g} is not on the plate. Move the column.")
        near = tuple(hole for hole in inner if column.distance(shapely.get_coordinates(hole.exterior)) <= within)
        return cls(column, slab, near, widened)

    def perimeters(self, distance: float, square: bool = False) -> list[Perimeter]:
        """All valid perimeters at a distance from the column: closed ones, and those that end at one or two free edges.

        A perimeter is valid if no free edge cuts it except those at which it ends.
        """
        basic, near = self.column.offset(distance, square), list[tuple[Edge, complex, complex]]()
        low = {normal: self.column.extent(-normal) for _, normal, *_ in self._edges}
        for gap, normal, begin, end in self._edges:
            single = self.column.extended([normal], _FAR * basic.length).offset(distance, square)
            shorter = single.beyond(-normal, low[normal][0] - gap).length <= (1.0 + _SAME) * basic.length
            straight = _along(np.array([begin, end]), 1j * normal)
            ends = np.array(self.column.extent(1j * normal)) + distance * np.array([-1.0, 1.0])
            across = straight.min() <= ends[0] and ends[1] <= straight.max()
            apart = all(abs(np.angle(normal / other.normal)) > _ALIKE for other, *_ in near)
            if shorter and apart and (across or self._is_outer(begin, normal)):
                near.append((Edge(normal, gap), begin, end))
        every = list[Perimeter]()
        for some in (some for count in range(_MOST_EDGES + 1) for some in combinations(near, count)):
            found = self.perimeter(distance, tuple(edge for edge, *_ in some), square)
            others = [(begin, end) for edge, begin, end in near if edge not in found.edges]
            if found.pieces.length > 0.0 and not self._cut(found.whole, others):
                every.append(found._replace(pieces=self._unshaded(found.pieces)))
        return every

    def perimeter(self, distance: float, edges: tuple[Edge, ...], square: bool = False) -> Perimeter:
        """Control perimeter at a distance that ends at ``edges``, without parts hidden from the column's centre."""
        normals = [edge.normal for edge in edges]
        towards, reach = normals, _FAR * self.column.offset(distance, square).length
        if len(normals) == _MOST_EDGES and abs(np.angle(-normals[0] / normals[1])) <= _ALIKE:
            across = (normals[0] - normals[1]) / abs(normals[0] - normals[1])
            towards = [across, -across]
        whole = self.column.extended(towards, reach).offset(distance, square)
        parts = whole
        for normal, gap in edges:
            level = -self.column.extent(normal)[1] - gap
            whole, parts = whole.beyond(-normal, level).closed, parts.beyond(-normal, level)
        return Perimeter(distance, self._visible(parts), whole, edges)

    @kept
    def face(self, edges: tuple[Edge, ...]) -> Pieces:
        """Outline u0 of the column; at ``edges`` it ends in straight lines at the level of the outermost point."""
        pieces = self.perimeter(0.0, edges).pieces
        for normal, _ in edges:
            pieces = pieces.beyond(-normal, self.column.extent(-normal)[0])
        return self._unshaded(pieces)

    def gap(self, normal: complex) -> float:
        """Distance of the column from the free edge with the outward normal ``normal``; infinite if there is none."""
        return min((gap for gap, edge, *_ in self._edges if abs(np.angle(edge / normal)) < _SAME), default=np.inf)

    def _visible(self, pieces: Pieces) -> Pieces:
        """Parts of a perimeter in the slab that holes and re-entrant corners do not hide from the column's centre."""
        centre, parts = self.column.centre, pieces
        farthest = np.abs(pieces.at(np.linspace(0.0, 1.0, 5)) - centre).max(initial=0.0)
        reach = shapely.Point(centre.real, centre.imag).buffer(float(farthest + pieces.lengths.max(initial=0.0)))
        for begin, end in _sides(self.slab):
            if shapely.intersects(reach, shapely.LineString([(begin.real, begin.imag), (end.real, end.imag)])):
                for to in (end, centre) if begin != centre else (end,):
                    normal = -1j * (to - begin) / abs(to - begin)
                    parts = parts.cut(normal, float(_along(begin, normal)))
        return parts.pick(shapely.covers(self.slab, self._sights(parts)))

    def _sights(self, parts: Pieces) -> npt.NDArray[np.object_]:
        """Lines of sight (m,) from the column's centre to the middle of each part of a perimeter."""
        along = parts.middles - self.column.centre
        ends = self.column.centre + along * np.array([[_SLIGHTLY], [1.0 + _SLIGHTLY]])
        return np.asarray(shapely.linestrings(np.stack([ends.real, ends.imag], axis=-1).swapaxes(0, 1)))

    def _cut(self, whole: Pieces, edges: Sequence[tuple[complex, complex]]) -> bool:
        """Whether one of the free edges, given by their ends, cuts the closed perimeter ``whole``."""
        for begin, end in edges:
            normal = -1j * (end - begin) / abs(end - begin)
            beyond = whole.beyond(
                normal, float(_along((1.0 - _SLIGHTLY) * begin + _SLIGHTLY * self.column.centre, normal))
            )
            for corner in (begin, end):
                if corner != self.column.centre:
                    across = 1j * (corner - self.column.centre) / abs(corner - self.column.centre)
                    beyond = beyond.cut(across, float(_along(corner, across)))
            side = shapely.LineString([(begin.real, begin.imag), (end.real, end.imag)])
            if shapely.intersects(self._sights(beyond), side).any():
                return True
        return False

    def _is_outer(self, begin: complex, normal: complex) -> bool:
        """Whether the whole slab lies on the inner side of the line through ``begin`` with an outward normal."""
        corners = np.asarray(shapely.get_coordinates(self.slab.exterior) @ [1.0, 1j] - begin, np.complex128)
        return bool((_along(corners, normal) <= _SLIGHTLY * np.abs(corners).max()).all())

    def _unshaded(self, pieces: Pieces) -> Pieces:
        """Parts of a perimeter outside the sectors between the tangents from the column's centre to each opening."""
        for opening in self.openings:
            first, _, width = self._tangents(opening)
            pieces = pieces.outside(self.column.centre, first, width)
        if not pieces.length > 0.0:
            raise InputError("Openings around the column leave no control perimeter. Move the column or the openings.")
        if pieces.is_straight:
            raise InputError(
                "The control perimeter between edges and openings is nearly straight. Check one-way shear there."
            )
        return pieces

    def sector(self, opening: shapely.Polygon) -> tuple[complex, complex]:
        """Directions of the two tangents from the column's centre to an opening."""
        return self._tangents(opening)[:2]

    def _tangents(self, opening: shapely.Polygon) -> tuple[complex, complex, float]:
        """Directions of the two tangents from the column's centre to an opening, and the angle between them."""
        corners = shapely.get_coordinates(opening.exterior) @ [1.0, 1j] - self.column.centre
        turned = np.unwrap(np.angle(corners))
        if abs(turned[-1] - turned[0]) > np.pi:
            raise InputError("An opening surrounds the column's centre. Move the column or the opening.")
        middle = 0.5 * (turned.min() + turned.max())
        seen = corners * np.exp(-1j * middle)
        ends = np.array([turned.min(), turned.max()]) - middle
        if self.widened and ends[1] < 0.5 * np.pi:
            # The opening's width l2 counts as √(l1 l2) if its length l1 is larger.
            wider = np.sqrt(max(np.ptp(seen.real) / np.ptp(seen.imag), 1.0))
            ends = np.arctan(wider * np.tan(ends))
        first, last = np.exp(1j * (middle + ends))
        return complex(first), complex(last), float(np.ptp(ends))

    @cached_property
    def _edges(self) -> list[tuple[float, complex, complex, complex]]:
        """Sides of the slab that face the column's centre: distance of the column, outward normal, begin and end."""
        found = []
        for begin, end in _sides(self.slab):
            length = abs(end - begin)
            foot = (self.column.centre - begin) * np.conj(end - begin) / length
            normal = complex(-1j * (end - begin) / length)
            if -_SAME * length <= foot.real <= length * (1.0 + _SAME) and foot.imag >= -_SAME * length:
                own = self.column.extent(normal)[1] - float(_along(self.column.centre, normal))
                found.append((float(foot.imag) - own, normal, begin, end))
        return sorted(found, key=lambda edge: edge[0])


def numbered(*values: Floats | float) -> Mapping[str, Floats]:
    """Map each name in `NUMBERS` to its values (k,) in k combinations; ``values`` are in the same order."""
    return dict(zip(NUMBERS, map(np.asarray, np.broadcast_arrays(*values)), strict=True))


def _along(z: Positions | complex, direction: Positions | complex) -> Floats:
    """Coordinate of each position ``z`` along a direction of modulus 1."""
    return np.asarray((z * np.conj(direction)).real)


def _sides(polygon: shapely.Polygon) -> list[tuple[complex, complex]]:
    """Begin and end of every side of a polygon: of its outline and its holes."""
    rings = [shapely.get_coordinates(ring) @ [1.0, 1j] for ring in (polygon.exterior, *polygon.interiors)]
    return [(a, b) for ring in rings for a, b in zip(ring.tolist(), ring[1:].tolist(), strict=False) if a != b]
