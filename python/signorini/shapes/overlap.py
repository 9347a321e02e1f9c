"""How much of one polygon is in another."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

_CHUNK = 4_000_000
"""Crossings of sides with stations that are looked at together."""


def overlap(one: Floats, other: Floats) -> float:
    """Area that two simple polygons, corners (n, 2) and (m, 2) in either sense, have in common.

    Between the abscissae of corners and crossings the height that is in both is linear in x, so that its middle counts.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> overlap(square, square[::-1] + [1.0, 0.5]), overlap(square, square + 3.0)
    (1.5, 0.0)
    """
    (a, b), (c, d) = ((corners, np.roll(corners, -1, axis=0)) for corners in (one, other))
    u, v = (b - a)[:, None], (d - c)[None]
    from_a = c[None] - a[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        area = u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
        s = (from_a[..., 0] * v[..., 1] - from_a[..., 1] * v[..., 0]) / area
        t = (from_a[..., 0] * u[..., 1] - from_a[..., 1] * u[..., 0]) / area
    i, j = np.nonzero((s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0))
    stations = np.unique(np.concatenate([a[:, 0], c[:, 0], a[i, 0] + s[i, j] * (b - a)[i, 0]]))
    middles, widths = 0.5 * (stations[1:] + stations[:-1]), np.diff(stations)
    begin, end = np.concatenate([a, c]), np.concatenate([b, d])
    first = np.arange(len(begin)) < len(a)
    total = 0.0
    for part in np.array_split(np.arange(len(middles)), 1 + len(middles) * len(begin) // _CHUNK):
        x = middles[part, None]
        crossed = (begin[:, 0] > x) != (end[:, 0] > x)
        with np.errstate(divide="ignore", invalid="ignore"):
            rise = begin[:, 1] + (x - begin[:, 0]) / (end[:, 0] - begin[:, 0]) * (end[:, 1] - begin[:, 1])
        height = np.where(crossed, rise, np.inf)
        order = np.argsort(height, axis=1)
        height = np.take_along_axis(height, order, axis=1)
        in_one = np.cumsum(first[order], axis=1) % 2 == 1
        in_both = in_one & (np.cumsum(~first[order], axis=1) % 2 == 1)
        both = in_both[:, :-1] & np.isfinite(height[:, 1:])
        steps = np.subtract(height[:, 1:], height[:, :-1], where=both, out=np.zeros_like(height[:, 1:]))
        total += float(widths[part] @ steps.sum(axis=1))
    return total
