"""The least of many: a small least-squares problem with inequalities, as a least-distance problem.

Lawson and Hanson (1974), *Solving Least Squares Problems*, chapter 23.
"""

from __future__ import annotations

import numpy as np

from signorini.base.linear_program import minimise
from signorini.discretise.rows import Floats

_ACTIVE = 1e-10
"""Part of the largest multiplier below which one is rounding."""

_ROUNDING = 64 * float(np.finfo(float).eps)
"""What a few sums of products of the free least leave of it."""


def span_of_cone(sides: Floats) -> Floats:
    """Basis (d, e) of what the directions y with C y ≤ 0 span; of no column where 0 is the only one.

    Parameters
    ----------
    sides : (c, d) array
        C, of rows about as long as one another.

    Examples
    --------
    Between two walls that face each other a point moves along them only.

    >>> abs(span_of_cone(np.array([[1.0, 0.0], [-1.0, 0.0]]))).tolist()
    [[0.0], [1.0]]
    """
    from scipy.linalg import null_space

    count, size = sides.shape
    if not count:
        return np.eye(size)
    # A cone holds the sum of its directions and their multiples: every side that one of them leaves, one leaves at all.
    free, stays = np.full(size, np.inf), np.zeros(count)
    bounds = np.append(-free, stays), np.append(free, stays + 1.0)
    cost = np.append(np.zeros(size), -np.ones(count))
    leave = minimise(cost, np.column_stack([sides, np.eye(count)]), (-np.inf, 0.0), bounds)
    never = np.ones(count, np.bool_) if leave is None else leave[size:] < 0.5
    return np.asarray(null_space(sides[never], rcond=_ACTIVE) if never.any() else np.eye(size))


def least(matrix: Floats, offset: Floats, sides: Floats, room: Floats) -> Floats:
    """Minimise ‖A y + b‖ with C y ≤ r, of which y = 0 is one, r ≥ 0.

    Parameters
    ----------
    matrix : (p, d) array
        A, whose columns are independent.
    offset : (p,) array
        b.
    sides : (c, d) array
        C.
    room : (c,) array
        r.

    Returns
    -------
    (d,) array
        y; 0 where arithmetic tells no better one.

    Examples
    --------
    The point of the quarter plane x ≤ 2, y ≤ 0 nearest to [3, 1].

    >>> least(np.eye(2), np.array([-3.0, -1.0]), np.eye(2), np.array([2.0, 0.0])).tolist()
    [2.0, 0.0]
    """
    from scipy.optimize import nnls

    q, r = np.linalg.qr(matrix)
    free = -np.linalg.solve(r, q.T @ offset)
    if ((sides @ free) <= room).all():
        return np.asarray(free)
    # With x = R y + Qᵀb it is the least x with −C R⁻¹ x ≥ C y_free − r; rows and sizes are brought to one.
    rows = np.linalg.solve(r.T, sides.T).T
    size = np.linalg.norm(rows, axis=1)
    kept = np.flatnonzero(size > 0)
    beyond = (sides @ free - room)[kept] / size[kept]
    # A side far away must not make those that are in the way look like rounding.
    unit = float(beyond.max())
    facing = np.vstack([-(rows[kept] / size[kept, None]).T, beyond / unit])
    try:
        multipliers, _ = nnls(facing, np.append(np.zeros(len(r)), 1.0))
    except RuntimeError:
        return np.zeros(len(r))
    # The sides that it rests on are equations; solved as such it is right to the last digits. One of them may have a
    # multiplier that is rounding.
    on = multipliers[: len(kept)] > _ACTIVE * multipliers.max(initial=0.0)
    for _ in kept:
        rests = kept[on]
        y = free - np.linalg.solve(r, np.linalg.pinv(rows[rests]) @ (sides[rests] @ free - room[rests]))
        # It is what is left of the free least, whose rounding it has.
        rounding = _ACTIVE * (np.abs(sides) @ np.abs(y) + np.abs(room)) + _ROUNDING * (np.abs(sides) @ np.abs(free))
        over = (sides @ y - room - rounding)[kept]
        if not (over > 0.0).any():
            return np.asarray(y)
        on[int(over.argmax())] = True
    return np.zeros(len(r))
