"""Loads as they are drawn in plan, with their values."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from numpy.typing import NDArray

from signorini.plot.labels import Labels
from signorini.plot.marks import Entry
from signorini.plot.plan import enclosed, inches_per_unit, pieces

_COLOURS = ("#b3261e", "#7a3e9d", "#b8860b", "#1b6e53", "#c2185b", "#4d5b9e")
"""Those of load cases, one after the other."""
_MOST_VALUES = 12
"""Points of a load beside which its value stands; of more the legend has it."""
_MOST_PLACES = 5
"""Places along a line at which its value may stand."""
_WITHIN = np.array([[0.2, 0.8], [0.5, 0.5], [0.8, 0.2], [0.2, 0.2], [0.8, 0.8]])
"""Places in an area, in parts of its size, at which its value may stand."""
_SYMBOL = 11.0
"""Points that the mark of a force is wide."""


@dataclass(frozen=True)
class LoadMark:
    """A load as it is drawn.

    Attributes
    ----------
    case : str
        Its load case: those of one case have one colour.
    name : str
        What it is, in the legend.
    positions : ndarray, shape (k, 2)
        Points of application, vertices of the loaded line, or the outline of the loaded area; a row of NaN starts a
        new piece. None at all, shape (0, 2), for a load on the whole plate, which the legend only names.
    style : {"points", "line", "area"}
        Which of the three.
    upward : bool
        A point load away from the reader is a crossed circle; one towards him, upward, is a dotted circle.
    couple : (mx, my) or None
        Of a moment, which is drawn as the pair of forces that it is: crossed circle down, dotted circle up.
    value : str
        How much it is, with its unit: in the legend and beside it.
    footprints : ndarray, shape (k, 2)
        Outlines of what the points' forces are spread over; a row of NaN starts a new one.
    """

    case: str
    name: str
    positions: NDArray[np.float64]
    style: Literal["points", "line", "area"] = "points"
    upward: bool = False
    couple: tuple[float, float] | None = None
    value: str = ""
    footprints: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))

    @property
    def label(self) -> str:
        """What the legend says: the case, the name and the value."""
        return f"{self.case}: {self.name}{', ' if self.value else ''}{self.value}"


def draw_load(mark: LoadMark, axes: Axes, colour: str, plate: Path) -> Entry:
    """Draw one load, areas on the plate only, and return its entry in the legend."""
    positions = np.asarray(mark.positions, dtype=float)
    words = mark.label
    ring: dict[str, Any] = {"markersize": 11.0, "linestyle": "none", "color": colour, "markeredgewidth": 0.4}
    ring |= {"clip_on": False, "zorder": 6}
    down, up = ring | {"marker": r"$\otimes$"}, ring | {"marker": r"$\odot$"}
    look: dict[str, Any]
    for piece in pieces(mark.footprints):
        axes.fill(*piece.T, facecolor=to_rgba(colour, 0.10), edgecolor=colour, linewidth=0.8, zorder=3)
    if mark.couple is not None:
        arm = np.array(mark.couple) / max(np.hypot(*mark.couple), 1e-300) * 0.16 / inches_per_unit(axes)
        for at in positions:
            axes.plot(*np.array([at - arm, at + arm]).T, color=colour, linewidth=1.4, zorder=5.8, clip_on=False)
        axes.plot(*(positions + arm).T, **down)
        axes.plot(*(positions - arm).T, **up)
        return words, (Line2D([], [], **up), Line2D([], [], color=colour, linewidth=1.4), Line2D([], [], **down))
    if mark.style == "points":
        look = up if mark.upward else down
        axes.plot(*positions.T, **look)
        return words, (Line2D([], [], **look),)
    if mark.style == "line":
        look = {"color": colour, "linewidth": 2.4, "solid_capstyle": "butt"}
        axes.plot(*positions.T, zorder=4.5, **look)
        return words, (Line2D([], [], **look),)
    look = {
        "facecolor": to_rgba(colour, 0.10),
        "edgecolor": colour,
        "hatch": "oo" if mark.upward else "....",
        "linewidth": 1.2,
    }
    if len(positions):
        axes.add_patch(PathPatch(enclosed(positions), zorder=3, **look)).set_clip_path(plate, axes.transData)
    return words, (Patch(**look),)


def draw_loads(
    marks: Iterable[LoadMark], axes: Axes, totals: Mapping[str, str], plate: Path, labels: Labels
) -> list[Entry]:
    """Draw loads, those of one case in one colour, and return their entries in the legend, sums of cases last.

    Loads of which the legend would say the same have one entry.
    """
    marks = list(marks)
    cases = list(dict.fromkeys(mark.case for mark in marks))
    colours = {case: _COLOURS[place % len(_COLOURS)] for place, case in enumerate(cases)}
    entries = list(dict(draw_load(mark, axes, colours[mark.case], plate) for mark in marks).items())
    for mark in marks:
        if mark.value:
            _write_value(mark, colours[mark.case], labels)
    look: dict[str, Any] = {"marker": "s", "markersize": 4.0, "linestyle": "none"}
    sums = [(f"{case}: {totals[case]} in all", colours[case]) for case in cases if case in totals]
    return entries + [(words, (Line2D([], [], color=colour, **look),)) for words, colour in sums]


def _write_value(mark: LoadMark, colour: str, labels: Labels) -> None:
    """Write a load's value beside its points, its line or in its area."""
    positions = np.asarray(mark.positions, dtype=float)
    for piece in pieces(positions)[:1] if mark.style != "points" else ():
        inside = piece
        if mark.style == "area":
            low, high = piece.min(axis=0), piece.max(axis=0)
            inside = low + _WITHIN * (high - low)
        labels.beside(mark.value, inside[_spread(len(inside))], 7.5, colour, zorder=6.4)
    for at in positions if mark.style == "points" and len(positions) <= _MOST_VALUES else ():
        labels.beside(mark.value, at, 7.5, colour, zorder=6.4)


def _spread(count: int) -> NDArray[np.int64]:
    """Some of so many places, the middle one first."""
    if count <= _MOST_PLACES:
        return np.roll(np.arange(count), -(count // 2))
    return np.linspace(0, count - 1, _MOST_PLACES).astype(np.int64)[[2, 1, 3, 0, 4]]
