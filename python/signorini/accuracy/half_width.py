"""Half-widths of numbers that are known on several meshes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from signorini.discretise.rows import Bools, Floats

FASTEST, FASTEST_OF_POINTS = 0.9, 0.5
"""Order of convergence that changes are trusted to show at most: what looks faster on three meshes may be chance. What
acts at a point lets a Mindlin plate give way by the logarithm of the mesh's size there, which is slower than any power.
"""

SLOWEST = 0.2
"""Order that is assumed at least where changes do not shrink: what is left is then seven times the last change."""

_OF_BEFORE, _OF_BEFORE_WHERE_COARSE = 0.25, 0.5
"""Part of the change before it that the last one counts as at least: two meshes may agree by chance, on coarse ones
where a finer one had to be asked all the more.
"""

_GROWS = 0.85
"""Last change over the one before, on meshes of half the size, from which on a number that grows is said to have no
limit: at points and corners it is 0.9 or more, of what converges 0.7 or less."""

_COUNTS = 0.02
"""Change over the largest of its field from which on growth is more than slow convergence."""

_ROUNDING = 1e-10
"""Part of the largest of its kind that rounding may be."""


def half_widths(
    values: Floats,
    sizes: Sequence[float],
    own: int,
    fastest: float | Floats,
    beside: Floats,
    largest: Floats,
    limited: Bools,
    fringe: Bools | bool = False,
) -> tuple[Floats, Bools]:
    """Say how far refining the mesh is expected to move numbers, and which have no limit.

    Of three meshes of sizes h₀ < h₁ < h₂ the changes d₁ = v₀ − v₁ and d₂ = v₁ − v₂ show the order p = ln|d₂/d₁| / ln r,
    r the ratio of sizes. What the finest mesh leaves is a geometric series, |d₁| / (r^p − 1), with p between an order
    that is not trusted to be more and one that is assumed at least; a half-width is that and the distance from the
    finest mesh. What grows on every finer mesh by as much as on the one before has no limit.

    Parameters
    ----------
    values : (m, ...) array
        Of m = 2 or 3 meshes, the finest first; NaN where a mesh does not tell.
    sizes : m floats
        Mean sides of elements.
    own : int
        Which of the meshes the half-widths are for.
    fastest : float or (...) array
        The order that is trusted at most.
    beside : (...) array
        A change that each counts as at least, because of others that were found with it: one may vanish by chance.
    largest : (...) array
        The largest value of each number's field.
    limited : (...) array
        Numbers that cannot grow for ever.
    fringe : (...) array
        Extremes beside nodes that are left out: they hop between what nodes are left, so that little is trusted.

    Returns
    -------
    (...) float array
        NaN where there is none.
    (...) bool array
        Which numbers have no limit.

    Examples
    --------
    >>> import numpy as np
    >>> values = np.array([[1.01, 3.0], [1.04, 2.0], [1.16, 1.0]])
    >>> nothing, largest, limited = np.zeros(2), np.full(2, 3.0), np.zeros(2, bool)
    >>> widths, growing = half_widths(values, [1.0, 2.0, 4.0], 0, 0.9, nothing, largest, limited)
    >>> widths.round(3), growing
    (array([0.035,   nan]), array([False,  True]))
    """
    change = np.abs(values[0] - values[1])
    last = np.where((values == 0).all(axis=0), 0.0, np.fmax(change, beside))
    fastest = np.where(fringe, np.minimum(fastest, FASTEST_OF_POINTS), fastest)
    order, growing = np.broadcast_to(fastest, change.shape), np.zeros(change.shape, np.bool_)
    if len(values) > 2:
        before = values[1] - values[2]
        ratio = sizes[1] / sizes[0]
        with np.errstate(divide="ignore", invalid="ignore"):
            shown = np.log(np.abs(before) / change) / np.log(sizes[2] / sizes[1])
        told = ~np.isnan(before)
        order = np.where(told & (change > 0), np.clip(np.where(np.isnan(shown), order, shown), SLOWEST, order), order)
        part = np.where(fringe, 1.0, _OF_BEFORE if own == 0 else _OF_BEFORE_WHERE_COARSE)
        last = np.where(told, np.fmax(last, part * np.abs(before)), last)
        size = np.abs(values)
        growing = (size[0] > size[1]) & (size[1] > size[2]) & (shown <= np.log(1 / _GROWS) / np.log(2))
        growing &= ~limited & (change > _COUNTS * largest) & (values[0] * values[2] > 0)
    else:
        ratio, order = sizes[1] / sizes[0], np.minimum(order, FASTEST_OF_POINTS)
    widths = np.abs(values[own] - values[0]) + last / (ratio**order - 1.0)
    widths = np.fmax(widths, np.where(np.isnan(widths), np.nan, _ROUNDING * largest))
    return np.where(growing, np.nan, widths), growing


def unsettled(values: Floats, largest: Floats) -> Bools:
    """Which numbers (...) of 2 or 3 meshes change by more than slow convergence would, not half as much as before.

    Examples
    --------
    >>> unsettled(np.array([[3.0, 1.01], [9.0, 1.04], [1.0, 1.16]]), np.full(2, 9.0)).tolist()
    [True, False]
    """
    change = np.abs(values[0] - values[1])
    settles = change < 0.5 * np.abs(values[1] - values[2]) if len(values) > 2 else np.zeros(change.shape, np.bool_)
    return np.asarray(~settles & (change > _COUNTS * largest))


def rounded(widths: Floats) -> Floats:
    """Round half-widths to three digits."""
    known = widths > 0
    power = np.floor(np.log10(widths, where=known, out=np.zeros_like(widths))) - 2
    # Powers of ten up to 22 are exact, so that what is written has no more digits.
    up, down = 10.0 ** np.maximum(power, 0), 10.0 ** np.maximum(-power, 0)
    return np.where(known, np.rint(widths * down / up) / down * up, widths)
