"""Divide intervals of a curve where a function along it jumps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from signorini.discretise.quadrature.stepped import Levels

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_INSIDE = 1e-6
"""Part of an interval, at either end, in which a jump counts as one at the end."""

_SEEN = 17
"""Points at which an interval is looked at: what begins and ends between two of them is missed."""

_BISECTIONS = 50


def divided(
    begin: Floats, end: Floats, at: Callable[[Ints, Floats], Floats], levels: Levels
) -> tuple[Ints, Floats, Floats]:
    """Divide intervals where a level changes its sign.

    Parameters
    ----------
    begin, end : (k,) float arrays
        The intervals, of whatever parameter.
    at : function
        Positions (q, 2) for intervals (q,) and parameters (q,).
    levels : sequence of functions
        Of positions; see `signorini.discretise.quadrature.stepped`.

    Returns
    -------
    (m,) int array, (m,) float array, (m,) float array
        Which interval each part is of, and where the part begins and ends; in order.

    Examples
    --------
    >>> along_x = lambda interval, s: np.column_stack([s, 0 * s])
    >>> divided(np.array([0.0, 2.0]), np.array([2.0, 4.0]), along_x, [lambda points: points[:, 0] - 0.5])
    (array([0, 0, 1]), array([0. , 0.5, 2. ]), array([0.5, 2. , 4. ]))
    """
    if not (len(begin) and len(levels)):
        return np.arange(len(begin)), begin, end
    stations = np.linspace(_INSIDE, 1.0 - _INSIDE, _SEEN)
    samples = begin[:, None] + (end - begin)[:, None] * stations
    interval = np.repeat(np.arange(len(begin)), _SEEN)
    owners, breaks = [np.arange(len(begin))], [begin]
    for level in levels:
        above = (level(at(interval, samples.ravel())) > 0.0).reshape(samples.shape)
        which, gap = np.nonzero(above[:, 1:] != above[:, :-1])
        low, high, first = samples[which, gap], samples[which, gap + 1], above[which, gap]
        for _ in range(_BISECTIONS if len(which) else 0):
            middle = 0.5 * (low + high)
            same = (level(at(which, middle)) > 0.0) == first
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        owners.append(which)
        breaks.append(0.5 * (low + high))
    owner, s = np.concatenate(owners), np.concatenate(breaks)
    order = np.lexsort((s, owner))
    owner, s = owner[order], s[order]
    keep = np.append(True, (np.diff(owner) > 0) | (np.diff(s) > _INSIDE * (end - begin)[owner[1:]]))
    owner, s = owner[keep], s[keep]
    last = np.append(np.diff(owner) > 0, True)
    return owner, s, np.where(last, end[owner], np.append(s[1:], 0.0))
