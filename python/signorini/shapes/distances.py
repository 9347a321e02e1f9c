"""Distances of points from straight sides."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


def distances(points: Floats, begin: Floats, end: Floats) -> Floats:
    """Distance (q, k) of points (q, 2) from the sides between ``begin`` and ``end`` (k, 2).

    Examples
    --------
    >>> distances(np.array([[1.0, 1.0], [3.0, 0.0]]), np.zeros((1, 2)), np.array([[2.0, 0.0]])).tolist()
    [[1.0], [1.0]]
    """
    side, offset = end - begin, points[:, None] - begin
    length = np.maximum((side**2).sum(axis=1), np.finfo(float).tiny)
    part = np.clip((offset * side).sum(axis=2) / length, 0.0, 1.0)
    return np.asarray(np.hypot(*np.moveaxis(offset - part[..., None] * side, -1, 0)))
