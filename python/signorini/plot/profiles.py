"""Fields along lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from signorini.plot.field import line
from signorini.plot.plan import INK, literal

Panels = Sequence[tuple[str, Sequence[tuple[str, ArrayLike]]]]
"""Of each panel what stands beside it, and its curves by name."""


def profiles_picture(profiles: Sequence[tuple[str, ArrayLike, Panels]], unit: str = "", title: str = "") -> Figure:
    """Draw the panels of each profile, its name, distances and panels given, side by side; positive values downwards.

    Curves have gaps where values are NaN; panels without any value stay empty.

    Examples
    --------
    >>> curves = [("mx", [0, 2, 0]), ("my", [0, 1, 0])]
    >>> panels = [("deflection [m]", [("deflection", [0.0, 1e-3, 0.0])]), ("moment", curves)]
    >>> figure = profiles_picture([("middle", [0, 1, 2], panels)], "m")
    >>> [len(axes.lines) for axes in figure.axes]
    [1, 2]
    """
    wide = max(len(panels) for _, _, panels in profiles)
    figure = Figure(figsize=(3.4 * wide, 0.4 + 2.6 * len(profiles)), layout="constrained")
    figure.suptitle(literal(title), fontsize=11, color=INK)
    grid = figure.subplots(len(profiles), wide, squeeze=False)
    for row, (name, distance, panels) in zip(grid, profiles, strict=True):
        for axes, (label, curves) in zip(row, panels, strict=True):
            for curve, values in curves:
                if not np.isnan(np.asarray(values, dtype=float)).all():
                    line(distance, values, ax=axes, label=curve if len(curves) > 1 else "")
            axes.set_ylabel(literal(label), fontsize=8.5, color=INK)
            axes.set_xlabel(literal(f"{name} [{unit}]" if unit else name), fontsize=8.5, color=INK)
            axes.tick_params(labelsize=8)
    return figure
