"""Walls that a drawing shows with their faces: the lines along their middles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import combinations, pairwise

from signorini.formats.drawing import GAP, Corner, Loop, between

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
