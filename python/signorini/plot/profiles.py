"""Fields along lines."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from signorini.plot.field import line
from signorini.plot.plan import INK, literal

_ACROSS = 4
"""Panels side by side: on a page in landscape each is as wide as is needed to read it."""


def profile_picture(
    distance: ArrayLike, panels: Mapping[str, Mapping[str, ArrayLike]], along: str = "", title: str = ""
) -> Figure:
    """Draw quantities along a line, a panel each; positive values downwards.

    Curves have gaps where values are NaN; panels without any value are left out.

    Parameters
    ----------
    distance : array_like, shape (k,)
    panels : mapping
        Of each quantity its curves (k,) by the name of the combination.
    along : str
        What the distance is.
    title : str

    Returns
    -------
    Figure

    Examples
    --------
    >>> moments = {"G": [0, 2, 0], "G + Q": [0, 5, 0]}
    >>> figure = profile_picture([0, 1, 2], {"moment mx": moments, "pressure": {"G": [np.nan] * 3}})
    >>> [len(axes.lines) for axes in figure.axes]
    [2]
    """
    shown = {
        name: curves
        for name, curves in panels.items()
        if not all(np.isnan(np.asarray(values, dtype=float)).all() for values in curves.values())
    }
    rows = max(math.ceil(len(shown) / _ACROSS), 1)
    figure = Figure(figsize=(3.4 * _ACROSS, 0.6 + 2.6 * rows), layout="constrained")
    figure.suptitle(literal(title), fontsize=11, color=INK)
    grid = figure.subplots(rows, _ACROSS, squeeze=False).ravel()
    for unused in grid[len(shown) :]:
        unused.remove()
    for axes, (name, curves) in zip(grid, shown.items(), strict=False):
        for values in curves.values():
            line(distance, values, ax=axes)
        axes.set_ylabel(literal(name), fontsize=8.5, color=INK)
        axes.set_xlabel(literal(along), fontsize=8.5, color=INK)
        axes.tick_params(labelsize=8)
    names = [literal(name) for curves in list(shown.values())[:1] for name in curves]
    figure.legend(grid[0].lines, names, loc="outside lower center", ncols=5, frameon=False, fontsize=8.5)
    return figure
