"""Parts of triangles on which linear functions are positive."""

from __future__ import annotations

import numpy as np

from signorini.discretise.rows import Floats


def positive_part(values: Floats) -> Floats:
    """Part of a triangle where the linear function through its corner values (..., 3) is positive.

    Examples
    --------
    >>> positive_part(np.array([[1.0, -1.0, -1.0], [1.0, 2.0, 3.0]]))
    array([0.25, 1.  ])
    """
    low, middle, high = np.moveaxis(np.sort(values, axis=-1), -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        one_above = high**2 / ((high - low) * (high - middle))
        two_above = 1.0 - low**2 / ((high - low) * (middle - low))
    part = np.where(middle > 0, two_above, one_above)
    return np.asarray(np.where(low >= 0, 1.0, np.where(high <= 0, 0.0, part)))


def both_positive_part(first: Floats, second: Floats) -> Floats:
    """Part of a triangle where two linear functions, given at its corners (t, 3), are positive.

    The triangle is cut in three where the first is zero; on each piece the second is linear still.

    Examples
    --------
    >>> x, y = np.array([[0.0, 1.0, 0.0]]), np.array([[0.0, 0.0, 1.0]])
    >>> both_positive_part(x - 0.5, y - 0.25), both_positive_part(0.5 - x, 0.5 - y)
    (array([0.0625]), array([0.5]))
    """
    above = (first > 0).sum(axis=1)
    result = np.where(above == 3, positive_part(second), 0.0)
    cut = (above == 1) | (above == 2)
    f, g, alone = first[cut], second[cut], above[cut] == 1
    odd = np.where(alone, f.argmax(axis=1), f.argmin(axis=1))
    turned = (odd[:, None] + np.arange(3)) % 3
    fa, fb, fc = np.take_along_axis(f, turned, axis=1).T
    ga, gb, gc = np.take_along_axis(g, turned, axis=1).T
    s, t = fa / (fa - fb), fa / (fa - fc)
    gs, gt = ga + s * (gb - ga), ga + t * (gc - ga)
    tip = s * t * positive_part(np.stack([ga, gs, gt], axis=1))
    rest = (1 - s) * positive_part(np.stack([gs, gb, gc], axis=1))
    rest += s * (1 - t) * positive_part(np.stack([gs, gc, gt], axis=1))
    result[cut] = np.where(alone, tip, rest)
    return result
