"""Sections and strips in plan: their lines, with the way that these run, and the strips' borders."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from signorini.plot.labels import Labels
from signorini.plot.marks import Entry

_HEAD = 0.01
"""Of the last piece of a line, what is under its arrow."""
_SECTION, _STRIP = "#a0356d", "#2f7f86"


@dataclass(frozen=True)
class CutMark:
    """A section or a strip as it is drawn.

    Attributes
    ----------
    name : str
    line : ndarray, shape (k, 2)
        From its first point on.
    borders : ndarray, shape (2, n, 2), or None
        Of a strip, at its stations.
    """

    name: str
    line: NDArray[np.float64]
    borders: NDArray[np.float64] | None = None


def draw_cuts(marks: Iterable[CutMark], axes: Axes, labels: Labels) -> list[Entry]:
    """Draw sections as lines with an arrow at their end, strips as bands, each with its name at its beginning."""
    entries: dict[str, Entry] = {}
    for mark in marks:
        strip = mark.borders is not None
        colour = _STRIP if strip else _SECTION
        look: dict[str, Any] = {"color": colour, "linestyle": (0, (6, 2, 1, 2)), "linewidth": 1.0 if strip else 1.5}
        axes.plot(*mark.line.T, zorder=6.5, **look)
        arrow = {"arrowstyle": "-|>", "color": colour, "shrinkA": 0, "shrinkB": 0}
        last = mark.line[-1] - _HEAD * (mark.line[-1] - mark.line[-2])
        axes.annotate("", mark.line[-1], last, arrowprops=arrow, zorder=6.5)
        labels.beside(mark.name, [mark.line[0], mark.line[-1]], color=colour, zorder=8)
        if mark.borders is None:
            entries["section"] = "section, its left and right as the arrow points", (Line2D([], [], **look),)
            continue
        left, right = mark.borders
        band: dict[str, Any] = {"facecolor": to_rgba(colour, 0.12), "edgecolor": colour, "linewidth": 0.6}
        axes.fill(*np.concatenate([left, right[::-1]]).T, zorder=1.8, **band)
        entries["strip"] = "strip", (Patch(**band),)
    return list(entries.values())
