"""Sides of elements: along lines and circles, around holes, and their places nearest to points."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from signorini.mesh.isoparametric import BoxTree, side_boxes
from signorini.shapes import Ring
from signorini.shapes.arrays import Bools, Floats, Ints
from signorini.shapes.outlines import Box, Side

_STEPS = 8
"""Steps of Gauss and Newton to the nearest point of a side, of which straight ones take one."""


@dataclass(frozen=True, eq=False)
class Sides:
    """Sides (k, 3, 2) by corner, midside and corner, and how far from them anything is looked for."""

    nodes: Floats
    within: float

    @property
    def bounds(self) -> Box:
        """A box xmin, ymin, xmax, ymax around them."""
        boxes = side_boxes(self.nodes)
        (x0, y0), (x1, y1) = boxes[:, :2].min(axis=0).tolist(), boxes[:, 2:].max(axis=0).tolist()
        return x0, y0, x1, y1

    @property
    def off_arcs(self) -> float:
        """How far they may be off the arcs that they stand for: a tenth of the largest rise over a chord, or less."""
        rise = self.nodes[:, 1] - 0.5 * (self.nodes[:, 0] + self.nodes[:, 2])
        return 0.1 * float(np.hypot(*rise.T).max(initial=0.0))

    def nearest(self, at: Floats) -> tuple[Floats, Floats]:
        """The nearest places (q, 2) of these to some (q, 2), and how far they are: infinitely if not within."""
        places, apart = at.copy(), np.full(len(at), np.inf)
        if not len(self.nodes):
            return places, apart
        boxes = side_boxes(self.nodes) + self.within * np.array([-1.0, -1.0, 1.0, 1.0])
        point, side = BoxTree.build(boxes).pairs(at)
        result = onto(self.nodes[side], at[point])
        far = np.hypot(*(result - at[point]).T)
        order = np.lexsort((side, far, point))
        point, first = np.unique(point[order], return_index=True)
        places[point], apart[point] = result[order[first]], far[order[first]]
        return places, np.where(apart <= self.within, apart, np.inf)


def onto(sides: Floats, points: Floats) -> Floats:
    """The places (k, 2) of sides (k, 3, 2) nearest to points (k, 2), one of each, or to one point (2,)."""
    a, middle, b = np.moveaxis(sides, 1, 0)
    slope, bend = 0.5 * (b - a), 0.5 * (a + b) - middle
    t = np.zeros((len(a), 1))
    for _ in range(_STEPS):
        off, along = points - (middle + t * (slope + t * bend)), slope + 2.0 * t * bend
        t = np.clip(t + (off * along).sum(axis=1, keepdims=True) / (along**2).sum(axis=1, keepdims=True), -1.0, 1.0)
    return np.asarray(middle + t * (slope + t * bend))


_KINK = 0.1
"""Smallest angle of a corner of a line."""

_GAP_SAMPLES = np.array([1e-3, *np.linspace(0.05, 0.95, 19), 1.0 - 1e-3])


@dataclass(frozen=True, eq=False)
class OnRing:
    """Sides (k, 3) on a circle, counter-clockwise, and points (q, 2) of the circle between sides that do not meet."""

    triples: Ints
    gaps: Floats


def edges_on_polyline(points: Floats, triples: Ints, sides: Sequence[Side], tolerance: float) -> Ints | None:
    """Find the sides of elements that cover those of a polyline.

    Every side of the mesh (k, 3) is there once; nodes may lie off the polyline's straight sides by the tolerance. The
    sides found are in the order and direction of the polyline; None if some part is not covered.
    """
    result = [_edges_on_side(points, triples, side, tolerance) for side in sides]
    covered = [chain for chain in result if chain is not None]
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
    """Find the sides (k, 3) of elements on those of a polyline, straight or arcs, that these cover by half or more."""
    result = [np.zeros((0, 3), np.int64)]
    for side in sides:
        length, station, on = _on_side(points, side, tolerance)
        those = triples[on[triples].all(axis=1)]
        ends = np.sort(station[those[:, [0, 2]]], axis=1)
        covered = np.clip(ends, 0.0, length)
        result.append(those[np.diff(covered, axis=1)[:, 0] >= 0.5 * np.diff(ends, axis=1)[:, 0]])
    return np.vstack(result)


def _on_side(points: Floats, side: Side, tolerance: float) -> tuple[float, Floats, Bools]:
    """Length of a side; position of points along it, and whether they are on it, apart from its ends."""
    a, _, b = side
    length = math.dist(a, b)
    along = np.subtract(b, a) / length
    offset = points - a
    return length, offset @ along, np.abs(offset @ np.array([-along[1], along[0]])) <= tolerance


def edges_on_ring(points: Floats, triples: Ints, ring: Ring, tolerance: float) -> OnRing | None:
    """Find the sides with all nodes on a circle; None if there are none.

    Every side of the mesh (k, 3) is there once; nodes may lie off the circle by the tolerance.
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
    """Tell which sides (k, 3) end where no other of them goes on in nearly their direction."""
    a, m, b = (points[triples[:, i]] for i in range(3))
    leaving = np.concatenate([4 * m - 3 * a - b, 4 * m - a - 3 * b])
    leaving /= np.hypot(*leaving.T)[:, None]
    node = np.concatenate([triples[:, 0], triples[:, 2]])
    # Unit vectors of two sides that are one line cancel.
    total = np.column_stack([np.bincount(node, part) for part in leaving.T])
    return np.asarray((np.hypot(*total.T)[node] > _KINK).reshape(2, -1).any(axis=0))


def _turn(begin: Floats | float, end: Floats) -> Floats:
    """Angle from one direction to another, counter-clockwise, in [0, 2π)."""
    return np.asarray(np.mod(end - begin, 2.0 * np.pi))


_MISSED = 1e-4
"""Part of a hole's area that chords of its curved sides may miss."""


def holes(points: Floats, boundary: Ints) -> tuple[Floats, ...]:
    """Points (k, 2) along every hole, of curved sides so many that chords between them are as good.

    ``boundary`` (k, 3) has the plate on its left, loop after loop, so that it runs around holes clockwise.
    """
    return tuple(hole for loop in _loops(boundary) if (hole := _drawn(points[loop])) is not None)


def _loops(boundary: Ints) -> Iterator[Ints]:
    """Divide sides (k, 3) into closed loops; one that passes a corner twice is two."""
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


def _drawn(sides: Floats) -> Floats | None:
    """Points along a loop of sides (k, 3, 2); none where the plate is inside."""
    begin, middle, end = np.moveaxis(sides, 1, 0)
    rise = middle - 0.5 * (begin + end)
    area = 0.5 * float((begin[:, 0] * end[:, 1] - begin[:, 1] * end[:, 0]).sum())
    # A parabola encloses two thirds of its chord times its rise.
    curved = 2.0 / 3.0 * ((end - begin)[:, 0] * rise[:, 1] - (end - begin)[:, 1] * rise[:, 0])
    area -= float(curved.sum())
    if area >= 0.0:
        return None
    chords = max(1, int(np.ceil(np.sqrt(np.abs(curved).sum() / (_MISSED * -area)))))
    t = np.arange(chords)[:, None] / chords
    along = begin[:, None] + t * (end - begin)[:, None] + 4.0 * t * (1.0 - t) * rise[:, None]
    return np.asarray(along.reshape(-1, 2))
