"""Element sides: those along lines, circles and holes, and their points nearest to given points."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from signorini.mesh.isoparametric import side_boxes
from signorini.shapes import Ring
from signorini.shapes.arrays import Bools, Floats, Ints
from signorini.shapes.boxes import BoxTree
from signorini.shapes.outlines import Box, Side

_STEPS = 8
"""Number of Gauss–Newton steps to the nearest point of a curved side; a straight side needs one."""


@dataclass(frozen=True, eq=False)
class Sides:
    """Element sides (k, 3, 2) as corner, midside, corner; `nearest` ignores sides beyond the distance ``within``."""

    nodes: Floats
    within: float

    @property
    def bounds(self) -> Box:
        """Bounding box xmin, ymin, xmax, ymax of all sides."""
        boxes = side_boxes(self.nodes)
        (x0, y0), (x1, y1) = boxes[:, :2].min(axis=0).tolist(), boxes[:, 2:].max(axis=0).tolist()
        return x0, y0, x1, y1

    @property
    def off_arcs(self) -> float:
        """Upper bound of the distance between arcs and the parabolic sides: a tenth of the largest rise of a side."""
        rise = self.nodes[:, 1] - 0.5 * (self.nodes[:, 0] + self.nodes[:, 2])
        return 0.1 * float(np.hypot(*rise.T).max(initial=0.0))

    def nearest(self, points: Floats) -> tuple[Floats, Floats]:
        """Position (q, 2) on the sides nearest to each point (q, 2), and the distance (q,); ∞ if beyond ``within``."""
        positions, distances = points.copy(), np.full(len(points), np.inf)
        if not len(self.nodes):
            return positions, distances
        boxes = side_boxes(self.nodes) + self.within * np.array([-1.0, -1.0, 1.0, 1.0])
        point, side = BoxTree(boxes).pairs(points)
        candidates = onto(self.nodes[side], points[point])
        distance = np.hypot(*(candidates - points[point]).T)
        order = np.lexsort((side, distance, point))
        point, first = np.unique(point[order], return_index=True)
        positions[point], distances[point] = candidates[order[first]], distance[order[first]]
        return positions, np.where(distances <= self.within, distances, np.inf)


def onto(sides: Floats, points: Floats) -> Floats:
    """Position (k, 2) on each side (k, 3, 2) nearest to its point (k, 2), or to one point (2,) for all sides."""
    a, middle, b = np.moveaxis(sides, 1, 0)
    slope, bend = 0.5 * (b - a), 0.5 * (a + b) - middle
    t = np.zeros((len(a), 1))
    for _ in range(_STEPS):
        off, along = points - (middle + t * (slope + t * bend)), slope + 2.0 * t * bend
        t = np.clip(t + (off * along).sum(axis=1, keepdims=True) / (along**2).sum(axis=1, keepdims=True), -1.0, 1.0)
    return np.asarray(middle + t * (slope + t * bend))


_KINK = 0.1
"""Smallest change of direction [rad] at which a line has a corner."""

_GAP_SAMPLES = np.array([1e-3, *np.linspace(0.05, 0.95, 19), 1.0 - 1e-3])


@dataclass(frozen=True, eq=False)
class OnRing:
    """Element sides (k, 3) on a circle, counter-clockwise, and points (q, 2) of the circle between these sides."""

    triples: Ints
    gaps: Floats


def edges_on_polyline(points: Floats, triples: Ints, sides: Sequence[Side], tolerance: float) -> Ints | None:
    """Find the element sides that cover a polyline.

    ``triples`` (k, 3) are the unique sides of the mesh; their nodes may be off the polyline by the tolerance. The
    returned sides have the order and direction of the polyline; None if a part of it is not covered.
    """
    chains = [_edges_on_side(points, triples, side, tolerance) for side in sides]
    covered = [chain for chain in chains if chain is not None]
    return np.vstack(covered) if len(covered) == len(sides) else None


def _edges_on_side(points: Floats, triples: Ints, side: Side, tolerance: float) -> Ints | None:
    length, station, on = _on_side(points, side, tolerance)
    on &= (station >= -tolerance) & (station <= length + tolerance)
    chain = triples[on[triples].all(axis=1)]
    chain = np.where((station[chain[:, 0]] > station[chain[:, 2]])[:, None], chain[:, ::-1], chain)
    chain = chain[np.argsort(station[chain[:, 1]])]
    if not len(chain) or (chain[:-1, 2] != chain[1:, 0]).any():
        return None
    ends = station[[chain[0, 0], chain[-1, 2]]]
    return chain if np.abs(ends - (0.0, length)).max() <= tolerance else None


def sides_mostly_on(points: Floats, triples: Ints, sides: Sequence[Side], tolerance: float) -> Ints:
    """Find the element sides (k, 3) of which at least half lies on one of the straight sides of a polyline."""
    found = [np.zeros((0, 3), np.int64)]
    for side in sides:
        length, station, on = _on_side(points, side, tolerance)
        near = triples[on[triples].all(axis=1)]
        ends = np.sort(station[near[:, [0, 2]]], axis=1)
        covered = np.clip(ends, 0.0, length)
        found.append(near[np.diff(covered, axis=1)[:, 0] >= 0.5 * np.diff(ends, axis=1)[:, 0]])
    return np.vstack(found)


def _on_side(points: Floats, side: Side, tolerance: float) -> tuple[float, Floats, Bools]:
    """Length of a straight side; coordinates (n,) of points (n, 2) along its line; mask (n,) of points on the line."""
    a, _, b = side
    length = math.dist(a, b)
    along = np.subtract(b, a) / length
    offset = points - a
    return length, offset @ along, np.abs(offset @ np.array([-along[1], along[0]])) <= tolerance


def edges_on_ring(points: Floats, triples: Ints, ring: Ring, tolerance: float) -> OnRing | None:
    """Find the element sides with all nodes on a circle; None without such sides.

    ``triples`` (k, 3) are the unique sides of the mesh; nodes may be off the circle by the tolerance.
    """
    offset = points - ring.center
    on = np.abs(np.hypot(*offset.T) - ring.radius) <= tolerance
    chain = triples[on[triples].all(axis=1)]
    if not len(chain):
        return None
    angle = np.arctan2(offset[:, 1], offset[:, 0])
    clockwise = _turn(angle[chain[:, 0]], angle[chain[:, 1]]) > np.pi
    chain = np.where(clockwise[:, None], chain[:, ::-1], chain)
    chain = chain[np.argsort(angle[chain[:, 1]])]
    apart = np.flatnonzero(chain[:, 2] != np.roll(chain[:, 0], -1))
    if len(apart):
        chain = np.roll(chain, -(int(apart[-1]) + 1), axis=0)
        apart = np.flatnonzero(chain[:, 2] != np.roll(chain[:, 0], -1))
    begin, end = angle[chain[apart, 2]], angle[np.roll(chain[:, 0], -1)[apart]]
    theta = (begin[:, None] + _turn(begin, end)[:, None] * _GAP_SAMPLES).ravel()
    return OnRing(chain, ring.center + ring.radius * np.column_stack([np.cos(theta), np.sin(theta)]))


def at_ends(points: Floats, triples: Ints) -> Bools:
    """Mask (k,) of the sides (k, 3) with an end at which no other side continues in nearly the same direction."""
    a, m, b = (points[triples[:, i]] for i in range(3))
    leaving = np.concatenate([4 * m - 3 * a - b, 4 * m - a - 3 * b])
    leaving /= np.hypot(*leaving.T)[:, None]
    node = np.concatenate([triples[:, 0], triples[:, 2]])
    # At an interior node of a smooth line the unit vectors along its two sides cancel.
    total = np.column_stack([np.bincount(node, part) for part in leaving.T])
    return np.asarray((np.hypot(*total.T)[node] > _KINK).reshape(2, -1).any(axis=0))


def _turn(begin: Floats | float, end: Floats) -> Floats:
    """Counter-clockwise angle in [0, 2π) from the direction ``begin`` to the direction ``end`` [rad]."""
    return np.asarray(np.mod(end - begin, 2.0 * np.pi))


_MISSED = 1e-4
"""Largest area between a hole's curved sides and the chords that replace them, relative to the hole's area."""


def holes(points: Floats, boundary: Ints) -> tuple[Floats, ...]:
    """Polygon (k, 2) of each hole, with enough points on curved sides for an accurate area.

    ``boundary`` (k, 3) are the boundary sides with the plate on their left, loop after loop: clockwise around holes.
    """
    return tuple(hole for loop in _loops(boundary) if (hole := _hole_polygon(points[loop])) is not None)


def _loops(boundary: Ints) -> Iterator[Ints]:
    """Divide boundary sides (k, 3) into closed loops; a loop that visits a corner twice is divided there."""
    ends = boundary[:, [0, 2]].tolist()
    path: list[int] = []
    at: dict[int, int] = {}
    for side, (begin, end) in enumerate(ends):
        at[begin] = len(path)
        path.append(side)
        if end in at:
            first = at[end]
            yield boundary[path[first:]]
            for gone in path[first:]:
                at.pop(ends[gone][0], None)
            del path[first:]


def _hole_polygon(sides: Floats) -> Floats | None:
    """Points (k, 2) along a loop of sides (k, 3, 2); None if the loop is an outer boundary."""
    begin, middle, end = np.moveaxis(sides, 1, 0)
    rise = middle - 0.5 * (begin + end)
    area = 0.5 * float((begin[:, 0] * end[:, 1] - begin[:, 1] * end[:, 0]).sum())
    # The area between a parabola and its chord is 2/3 chord × rise.
    curved = 2.0 / 3.0 * ((end - begin)[:, 0] * rise[:, 1] - (end - begin)[:, 1] * rise[:, 0])
    area -= float(curved.sum())
    if area >= 0.0:
        return None
    chords = max(1, int(np.ceil(np.sqrt(np.abs(curved).sum() / (_MISSED * -area)))))
    t = np.arange(chords)[:, None] / chords
    along = begin[:, None] + t * (end - begin)[:, None] + 4.0 * t * (1.0 - t) * rise[:, None]
    return np.asarray(along.reshape(-1, 2))
