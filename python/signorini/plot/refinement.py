"""Meshes on the way to an accuracy that was asked for."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from signorini.plot.plan import INK, literal

_FOUND, _ASKED = "#1f5fa8", "#b3261e"


def refinement_picture(dofs: ArrayLike, worst: ArrayLike, asked: float, order: float, title: str = "") -> Figure:
    """Draw the largest half-width over its field against the dofs, beside what uniform refinement is expected to do.

    Parameters
    ----------
    dofs, worst : array_like, shape (k,)
        Of every mesh.
    asked : float
        The accuracy.
    order : float
        Order in the size of elements by which half-widths are expected to fall where all elements shrink alike.
    title : str

    Returns
    -------
    Figure

    Examples
    --------
    >>> figure = refinement_picture([1000, 2000, 4000], [0.1, 0.04, 0.009], asked=0.01, order=1.5)
    >>> [line.get_label() for line in figure.axes[0].lines]
    ['these meshes', 'asked', 'uniform refinement, expected']
    """
    at, result = np.asarray(dofs, dtype=float), np.asarray(worst, dtype=float)
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = figure.subplots()
    figure.suptitle(literal(title), fontsize=11, color=INK)
    axes.loglog(at, result, color=_FOUND, marker="o", markersize=4, label="these meshes")
    axes.axhline(asked, color=_ASKED, linewidth=1.2, label="asked")
    far = np.array([at[0], max(at[-1], at[0] * (result[0] / asked) ** (2 / order))])
    expected = result[0] * (far / at[0]) ** (-order / 2)
    axes.loglog(far, expected, color=INK, linewidth=1, linestyle="--", label="uniform refinement, expected")
    axes.set_xlabel("dofs", fontsize=9, color=INK)
    axes.set_ylabel("largest ± over the largest value of its field", fontsize=9, color=INK)
    axes.tick_params(labelsize=8.5)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize=8.5, frameon=False)
    return figure
