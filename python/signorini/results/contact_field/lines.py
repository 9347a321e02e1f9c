"""Lines along which a function that is linear on triangles changes its sign, as polylines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signorini.discretise.rows import Bools, Floats, Ints

_PASSES = 4


@dataclass(frozen=True, eq=False)
class Segments:
    """Directed segments: points (k, 2), and pairs (s, 2) of their numbers.

    A pair has the point at which a segment begins and the point at which it ends. Consecutive segments share a point.
    """

    points: Floats
    pairs: Ints


def zero_line(points: Floats, triangles: Ints, values: Floats, inside: Bools) -> Segments:
    """Find the segments along which a function, linear on each triangle, is zero; ``inside`` is on their left.

    The values (v,) at vertices are positive inside, negative outside, or zero. Triangles (t, 3) are counter-clockwise.
    Triangles without a negative value have no segment.
    """
    sides = inside[triangles]
    crossed = sides.any(axis=1) & (values[triangles] < 0).any(axis=1)
    triangles, sides = triangles[crossed], sides[crossed]
    alone = sides.sum(axis=1) == 1
    odd = np.where(alone, sides.argmax(axis=1), sides.argmin(axis=1))
    a, b, c = np.take_along_axis(triangles, (odd[:, None] + np.arange(3)) % 3, axis=1).T
    on_ab, on_ac = np.sort([a, b], axis=0), np.sort([a, c], axis=0)
    begin, end = np.where(alone, on_ab, on_ac), np.where(alone, on_ac, on_ab)
    edges, pairs = np.unique(np.hstack([begin, end]).T, axis=0, return_inverse=True)
    low, high = edges.T
    part = values[low] / np.where(values[low] == values[high], 1.0, values[low] - values[high])
    return Segments(points[low] + part[:, None] * (points[high] - points[low]), pairs.reshape(2, -1).T)


def clipped(segments: Segments, depth: Floats) -> Segments:
    """Keep the parts of segments with ``depth`` ≥ 0; ``depth`` (k,) is given at the points and linear between them."""
    pairs, within = segments.pairs, depth >= 0
    whole = within[pairs].all(axis=1)
    cut = within[pairs[:, 0]] != within[pairs[:, 1]]
    begin, end = depth[pairs[cut]].T
    part = (begin / (begin - end))[:, None]
    new = segments.points[pairs[cut, 0]] * (1 - part) + segments.points[pairs[cut, 1]] * part
    shortened = np.where(within[pairs[cut]], pairs[cut], len(segments.points) + np.arange(len(new))[:, None])
    return Segments(np.concatenate([segments.points, new]), np.concatenate([pairs[whole], shortened]))


def chained(segments: Segments) -> list[Floats]:
    """Join segments into polylines (k, 2); the last point of a closed polyline is its first point.

    Examples
    --------
    >>> triangle = Segments(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.array([[0, 1], [2, 0], [1, 2]]))
    >>> chained(triangle)[0].tolist()
    [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]]
    """
    onward: dict[int, list[int]] = {}
    for begin, end in segments.pairs.tolist():
        onward.setdefault(begin, []).append(end)
    arrivals = set(segments.pairs[:, 1].tolist())
    result = []
    for start in [*(begin for begin in onward if begin not in arrivals), *onward]:
        while onward[start]:
            line = [start]
            while onward.get(line[-1]) and (len(line) == 1 or line[-1] != start):
                line.append(onward[line[-1]].pop())
            points = segments.points[line]
            moved = np.append(True, (np.diff(points, axis=0) != 0).any(axis=1))
            if moved.sum() > 1:
                result.append(points[moved])
    return result


def thinned(line: Floats, tolerance: float) -> Floats:
    """Remove points of a polyline (k, 2) that are nearer than a tolerance to the chord between their neighbours."""
    for _ in range(_PASSES):
        before, point, after = line[:-2:2], line[1:-1:2], line[2::2]
        chord, offset = after - before, point - before
        length = np.maximum(np.hypot(*chord.T), np.finfo(float).tiny)
        off = np.abs(chord[:, 0] * offset[:, 1] - chord[:, 1] * offset[:, 0]) / length
        between = (offset * chord).sum(axis=1) > 0
        drop = 1 + 2 * np.flatnonzero((off <= tolerance) & between)
        if not len(drop):
            break
        line = np.delete(line, drop, axis=0)
    return line
