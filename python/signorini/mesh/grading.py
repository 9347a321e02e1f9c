"""Divide a length into elements that are small where it is asked and grow gently away from there."""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Cap = tuple[float, float, float]
"""From, to, and the largest size between."""

STEEPEST = 1.3
"""Size of an element over that of its neighbour, at most."""

_SHORTEST = 0.5
"""Part of the size asked for below which a piece between two lines is too short for an element: a line is left out."""
_SAMPLES = 4000
_ROUNDS = 50


def graded(
    start: float,
    stop: float,
    size: float,
    caps: Sequence[Cap],
    lines: Sequence[float] = (),
    lesser: Sequence[float] = (),
) -> Floats:
    """Divide an interval into elements of at most a size, smaller under caps, with joints at lines, first at `lines`.

    Away from a cap the size grows by the distance times ln 1.3, so that neighbours differ by 1.3 at most. Between
    lines the joints share ∫ dx/size equally; a piece whose elements come out smaller is a cap to the others.

    Returns
    -------
    (n + 1,) float array
        Joints, the two ends included.

    Examples
    --------
    >>> graded(0.0, 10.0, 2.0, [(0.0, 0.0, 0.5)]).round(2)
    array([ 0.  ,  0.53,  1.2 ,  2.05,  3.14,  4.53,  6.29,  8.14, 10.  ])
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
    """Lines with room for an element between them and beside the ends; the groups in turn."""
    knots = [start, stop]
    for line in (line for group in groups for line in sorted(group)):
        asked = _SHORTEST * float(_size(np.array([line]), size, caps)[0])
        place = bisect.bisect(knots, line)
        if 0 < place < len(knots) and line - knots[place - 1] >= asked and knots[place] - line >= asked:
            knots.insert(place, line)
    return knots


def _size(x: Floats, size: float, caps: Sequence[Cap]) -> Floats:
    result = np.full(len(x), size)
    for a, b, most in caps:
        away = np.maximum(np.maximum(a - x, x - b), 0.0)
        result = np.minimum(result, most + math.log(STEEPEST) * away)
    return result


def _divided(a: float, b: float, size: float, caps: Sequence[Cap]) -> Floats:
    x = np.unique(np.concatenate([np.linspace(a, b, _SAMPLES), np.clip([c for cap in caps for c in cap[:2]], a, b)]))
    middle = 0.5 * (x[1:] + x[:-1])
    share = np.concatenate([[0.0], np.cumsum(np.diff(x) / _size(middle, size, caps))])
    count = max(1, math.ceil(share[-1] - 1e-6))
    joints = np.asarray(np.interp(np.linspace(0.0, share[-1], count + 1), share, x))
    joints[[0, -1]] = a, b
    return joints
