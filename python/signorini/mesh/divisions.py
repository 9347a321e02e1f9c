"""Division of a length into elements, with joints at given lines and limited sizes; choice of a plate's axes."""

from __future__ import annotations

import bisect
import heapq
import math
from collections.abc import Iterable, Sequence
from itertools import pairwise, product
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from signorini.shapes.arrays import Floats

_SAME = 1e-9
"""Tolerance for equal coordinates, relative to the interval, and for equal sizes, relative to the larger size."""
_MAX_RATIO = 3.0
"""Largest ratio of the element sizes on both sides of a line that `subdivide` follows."""


def subdivide(
    start: float,
    stop: float,
    count: int,
    lines: Sequence[float] = (),
    lesser: Sequence[float] = (),
    *,
    first: int = 1,
) -> Floats:
    """Divide an interval into ``count`` parts, if possible with a joint at each line; return joints (count + 1,).

    The parts are equal if the joints of equal parts include all lines. Otherwise the parts are equal between
    consecutive lines, and the parts are distributed so that the largest part is smallest. A line is skipped if there
    are too few parts, or if the parts at its sides would differ by more than 3 to 1; ``lesser`` lines are skipped
    first. Before the first line there are at least ``first`` parts.
    """
    equal = np.linspace(start, stop, count + 1)
    same = _SAME * (stop - start)
    joints, followed = equal, list[float]()
    for group in filter(len, (lines, lesser)):
        wanted = [start, *followed, stop]
        for line in sorted(group):
            place = bisect.bisect(wanted, line)
            if 0 < place < len(wanted) and line - wanted[place - 1] > same and wanted[place] - line > same:
                wanted.insert(place, line)
        joints, followed = _followed(equal, wanted[1:-1], set(followed), first)
    return joints


def _followed(equal: Floats, wanted: list[float], kept: set[float], first: int) -> tuple[Floats, list[float]]:
    """Return joints (count + 1,) at ``kept`` and as many other ``wanted`` lines as possible; also these lines."""
    start, stop, count = float(equal[0]), float(equal[-1]), len(equal) - 1
    same = _SAME * (stop - start)
    while any(np.abs(equal[first:] - line).min() > same for line in wanted):
        knots = np.array([start, *wanted, stop])
        lengths = np.diff(knots)
        counts = _share(lengths, count, first)
        if counts is None:
            culprit = _first_largest(-lengths)
        else:
            sizes = lengths / counts
            steps = np.maximum(sizes[1:] / sizes[:-1], sizes[:-1] / sizes[1:])
            if steps.max() <= _MAX_RATIO * (1.0 + _SAME):
                parts = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(knots, knots[1:], counts, strict=False)]
                return np.append(np.concatenate(parts), stop), wanted
            worst = _first_largest(steps)
            culprit = worst if sizes[worst] < sizes[worst + 1] else worst + 1
        ends = [knot for knot in knots[culprit : culprit + 2] if start < knot < stop and knot not in kept]
        if not ends:
            others = [line for line in wanted if line not in kept]
            away = np.abs(np.array(others) - 0.5 * (knots[culprit] + knots[culprit + 1]))
            ends = [others[_first_largest(-away, same)]]
        wanted.remove(ends[_first_largest(np.array([np.abs(equal - line).min() for line in ends]), same)])
    return equal, wanted


def _first_largest(values: Floats, same: float | None = None) -> int:
    """Index of the first value that equals the largest value within the tolerance ``same``.

    The tolerance makes the choice independent of units.
    """
    largest = values.max()
    return int(np.argmax(values >= largest - (_SAME * abs(largest) if same is None else same)))


def _share(lengths: Floats, count: int, first: int) -> npt.NDArray[np.int64] | None:
    """Distribute ``count`` parts over lengths: each further part goes to the length with the largest parts.

    The first length has at least ``first`` parts. None if ``count`` parts are too few.
    """
    counts = np.ones(len(lengths), dtype=np.int64)
    counts[0] = first
    if counts.sum() > count:
        return None
    heap = [(-length / n, i) for i, (length, n) in enumerate(zip(lengths, counts, strict=True))]
    heapq.heapify(heap)
    left = count - int(counts.sum())
    while left:
        # Lengths whose parts are equal up to rounding get their next part in the order of the list.
        ties = [heapq.heappop(heap)]
        while heap and heap[0][0] <= ties[0][0] * (1.0 - _SAME):
            ties.append(heapq.heappop(heap))
        for _, i in sorted(ties, key=lambda tie: tie[1]):
            counts[i] += left > 0
            left -= left > 0
            heapq.heappush(heap, (-lengths[i] / counts[i], i))
    return counts


Cap = tuple[float, float, float]
"""Limit of the element size: start and end of an interval, and the largest element size in it."""

STEEPEST = 1.3
"""Largest ratio of neighbouring element sizes in a graded division."""

_SHORTEST = 0.5
"""Smallest distance between two lines with joints, relative to the element size there; a closer line is skipped."""
_SAMPLES = 4000
"""Number of points of the numerical integral of 1/(element size) between two lines."""
_ROUNDS = 50
"""Largest number of passes that reduce the ratio of neighbouring element sizes."""


def graded(
    start: float,
    stop: float,
    size: float,
    caps: Sequence[Cap],
    lines: Sequence[float] = (),
    lesser: Sequence[float] = (),
) -> Floats:
    """Divide an interval into elements of at most ``size``, smaller in the intervals ``caps``, with joints at lines.

    Outside a cap the largest size grows by ln 1.3 times the distance, so that neighbours differ by 1.3 at most. Between
    lines the joints divide ∫ dx/size equally. Elements that are still too small for their neighbours become caps. Lines
    too close to earlier lines are skipped, first of all the ``lesser`` lines.
    """
    wanted = list(caps)
    knots = _kept(start, stop, (lines, lesser), size, wanted)
    for _ in range(_ROUNDS):
        parts = [_divided(a, b, size, wanted) for a, b in pairwise(knots)]
        joints = np.concatenate([*(part[:-1] for part in parts), [stop]])
        sides = np.diff(joints)
        steep = np.maximum(sides[1:], sides[:-1]) > STEEPEST * np.minimum(sides[1:], sides[:-1]) * (1 + 1e-9)
        if not steep.any():
            break
        for place in np.flatnonzero(steep):
            small = place if sides[place] < sides[place + 1] else place + 1
            wanted.append((float(joints[small]), float(joints[small + 1]), float(sides[small]) / 1.02))
    return joints


def _kept(
    start: float, stop: float, groups: Iterable[Sequence[float]], size: float, caps: Sequence[Cap]
) -> list[float]:
    """Ends of the interval and lines inside it at least half an element apart; earlier groups have priority."""
    knots = [start, stop]
    for line in (line for group in groups for line in sorted(group)):
        least = _SHORTEST * float(_size(np.array([line]), size, caps)[0])
        place = bisect.bisect(knots, line)
        if 0 < place < len(knots) and line - knots[place - 1] >= least and knots[place] - line >= least:
            knots.insert(place, line)
    return knots


def _size(x: Floats, size: float, caps: Sequence[Cap]) -> Floats:
    sizes = np.full(len(x), size)
    for a, b, most in caps:
        distance = np.maximum(np.maximum(a - x, x - b), 0.0)
        sizes = np.minimum(sizes, most + math.log(STEEPEST) * distance)
    return sizes


def _divided(a: float, b: float, size: float, caps: Sequence[Cap]) -> Floats:
    x = np.unique(np.concatenate([np.linspace(a, b, _SAMPLES), np.clip([c for cap in caps for c in cap[:2]], a, b)]))
    middle = 0.5 * (x[1:] + x[:-1])
    share = np.concatenate([[0.0], np.cumsum(np.diff(x) / _size(middle, size, caps))])
    count = max(1, math.ceil(share[-1] - 1e-6))
    joints = np.asarray(np.interp(np.linspace(0.0, share[-1], count + 1), share, x))
    joints[[0, -1]] = a, b
    return joints


Axes: TypeAlias = tuple[tuple[float, float], tuple[float, float]]
"""Two unit vectors: one along ±x and the other along ±y, in either order."""

ALONG_X: Axes = ((1.0, 0.0), (0.0, 1.0))
_AXES: tuple[Axes, ...] = tuple(
    axes for u, v in product((1.0, -1.0), repeat=2) for axes in (((u, 0.0), (0.0, v)), ((0.0, u), (v, 0.0)))
)
_GRID = 2.0**-30
"""Tolerance for equal coordinates, relative to the plate's extent: far above their rounding in any unit."""


def axes_of(places: Sequence[Floats]) -> Axes:
    """Choose the axes with the lexicographically largest coordinates of points, second coordinates first.

    If a plate is mirrored or turned by 90°, its axes are mirrored or turned with it, and so is the mesh.

    ``places`` are the points (k, 2) of the outline and of each shape on the plate, in order; the order of points within
    a shape has no influence. If the plate looks the same along several axes, x and y come first.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])
    >>> axes_of([square]), axes_of([square, np.array([[1.0, 2.0]])])
    (((1.0, 0.0), (0.0, 1.0)), ((0.0, 1.0), (-1.0, 0.0)))
    """
    low, high = places[0].min(axis=0), places[0].max(axis=0)
    points = np.rint((np.concatenate(places) - 0.5 * (low + high)) / (_GRID * (high - low).max()))
    shape = np.repeat(np.arange(len(places)), [len(points_of) for points_of in places])

    def along(axes: Axes) -> list[list[float]]:
        first, second = np.array(axes) @ points.T
        order = np.lexsort((-first, -second, shape))
        return np.column_stack([second[order], first[order]]).tolist()  # type: ignore[no-any-return]

    return max(_AXES, key=along)
