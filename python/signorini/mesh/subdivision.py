"""Divide a length into element sizes that follow wanted lines where they reasonably can."""

from __future__ import annotations

import bisect
import heapq
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

_SAME = 1e-9
_STEEPEST = 3.0


def subdivide(
    start: float,
    stop: float,
    count: int,
    lines: Sequence[float] = (),
    lesser: Sequence[float] = (),
    *,
    first: int = 1,
) -> Floats:
    """Divide an interval into `count` parts with joints at wanted lines.

    Parameters
    ----------
    start, stop : float
        The interval.
    count : int
        Number of parts; it is kept.
    lines : sequence of float
        Wanted joints. If equal parts have them all, the parts are equal. Else each piece between lines has equal parts,
        and the pieces share the count so that the largest part is smallest. A line is left out when there are not
        enough parts, or when parts on its two sides would differ in size by more than 3 to 1.
    lesser : sequence of float
        Others, of which those that keep one of `lines` from being followed are left out first.
    first : int
        Least number of parts before the first joint at a line.

    Returns
    -------
    (count + 1,) float array
        Joints, the two ends included; those at lines are the lines' numbers exactly.

    Examples
    --------
    >>> subdivide(0.0, 4.0, 4, [3.0])
    array([0., 1., 2., 3., 4.])
    >>> subdivide(0.0, 4.0, 4, [1.2])
    array([0.        , 1.2       , 2.13333333, 3.06666667, 4.        ])
    >>> subdivide(0.0, 4.0, 4, [0.1])
    array([0., 1., 2., 3., 4.])
    >>> subdivide(0.0, 4.0, 4, [1.2], [1.3])
    array([0.        , 1.2       , 2.13333333, 3.06666667, 4.        ])
    """
    even = np.linspace(start, stop, count + 1)
    same = _SAME * (stop - start)
    joints, followed = even, list[float]()
    for group in filter(len, (lines, lesser)):
        wanted = [start, *followed, stop]
        for line in sorted(group):
            place = bisect.bisect(wanted, line)
            if 0 < place < len(wanted) and line - wanted[place - 1] > same and wanted[place] - line > same:
                wanted.insert(place, line)
        joints, followed = _followed(even, wanted[1:-1], set(followed), first)
    return joints


def _followed(even: Floats, wanted: list[float], kept: set[float], first: int) -> tuple[Floats, list[float]]:
    """Joints at wanted lines, those kept among them, and the lines that they are at."""
    start, stop, count = float(even[0]), float(even[-1]), len(even) - 1
    same = _SAME * (stop - start)
    while any(np.abs(even[first:] - line).min() > same for line in wanted):
        knots = np.array([start, *wanted, stop])
        lengths = np.diff(knots)
        counts = _share(lengths, count, first)
        if counts is None:
            culprit = _first_largest(-lengths)
        else:
            sizes = lengths / counts
            steps = np.maximum(sizes[1:] / sizes[:-1], sizes[:-1] / sizes[1:])
            if steps.max() <= _STEEPEST * (1.0 + _SAME):
                parts = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(knots, knots[1:], counts, strict=False)]
                return np.append(np.concatenate(parts), stop), wanted
            worst = _first_largest(steps)
            culprit = worst if sizes[worst] < sizes[worst + 1] else worst + 1
        ends = [knot for knot in knots[culprit : culprit + 2] if start < knot < stop and knot not in kept]
        if not ends:
            others = [line for line in wanted if line not in kept]
            away = np.abs(np.array(others) - 0.5 * (knots[culprit] + knots[culprit + 1]))
            ends = [others[_first_largest(-away, same)]]
        wanted.remove(ends[_first_largest(np.array([np.abs(even - line).min() for line in ends]), same)])
    return even, wanted


def _first_largest(values: Floats, same: float | None = None) -> int:
    """The first of the values that are the largest but for rounding, so that units make no difference."""
    largest = values.max()
    return int(np.argmax(values >= largest - (_SAME * abs(largest) if same is None else same)))


def _share(lengths: Floats, count: int, first: int) -> npt.NDArray[np.int64] | None:
    """Share divisions among pieces, each next one to the piece with the largest parts; None if there are too few."""
    counts = np.ones(len(lengths), dtype=np.int64)
    counts[0] = first
    if counts.sum() > count:
        return None
    heap = [(-length / n, i) for i, (length, n) in enumerate(zip(lengths, counts, strict=True))]
    heapq.heapify(heap)
    left = count - int(counts.sum())
    while left:
        # Of parts that are equal but for rounding the first piece comes first.
        ties = [heapq.heappop(heap)]
        while heap and heap[0][0] <= ties[0][0] * (1.0 - _SAME):
            ties.append(heapq.heappop(heap))
        for _, i in sorted(ties, key=lambda tie: tie[1]):
            counts[i] += left > 0
            left -= left > 0
            heapq.heappush(heap, (-lengths[i] / counts[i], i))
    return counts
