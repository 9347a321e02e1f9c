"""What a load amounts to, in plan: its resultant, and the line about which it tips the plate."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from signorini.errors import point
from signorini.plot.labels import Labels
from signorini.plot.marks import Entry

_GOOD, _BAD = "#1b6e53", "#b3261e"
_ARROW = 22.0
"""Points that the arrow to a resultant is long that is off the picture."""
_MOST_NAMED = 8
"""Combinations that have names in the picture; of more these are some that cannot be balanced, if there are any."""

_NEAR = 0.02
"""Part of the picture's size within which resultants are at one place."""

Point = tuple[float, float]


@dataclass(frozen=True)
class BalanceMark:
    """The resultant of a combination, and how it ends.

    Attributes
    ----------
    name : str
        Its name in the legend.
    at : (x, y) or None
        Where the resultant acts; None for a couple.
    upward : bool
        Whether it points up.
    unbalanced : bool
        Whether no reactions balance it.
    axis : ((x, y), (x, y)) or None
        Two points of the line about which the plate tips.
    """

    name: str
    at: Point | None
    upward: bool = False
    unbalanced: bool = False
    axis: tuple[Point, Point] | None = None


def draw_balances(marks: Iterable[BalanceMark], axes: Axes, labels: Labels) -> list[Entry]:
    """Draw what becomes of every combination, of many only a few by name."""
    marks = list(marks)
    named = marks if len(marks) <= _MOST_NAMED else [mark for mark in marks if mark.unbalanced][:_MOST_NAMED]
    entries = [entry for mark in _together(named, axes) for entry in _draw(mark, axes, labels)]
    for colour, unbalanced in ((_GOOD, False), (_BAD, True)):
        others = [mark.at for mark in marks if mark.unbalanced == unbalanced and mark not in named and mark.at]
        if others:
            at = np.array(others)
            away = _away(at, axes)
            look: dict[str, Any] = {"marker": "s", "linestyle": "none", "color": colour, "markersize": 3.0}
            axes.plot(*at[away == 0.0].T, zorder=7.5, scalex=False, scaley=False, **look)
            more = " more" if named else ""
            ending = ", not balanced" if unbalanced else ""
            words = f"resultants of {len(others)}{more} combinations{ending}"
            if away.any():
                words += f", {np.count_nonzero(away)} of them off the picture, as at {point(at[away.argmax()])}"
            entries.append((words, (Line2D([], [], **look),)))
    return entries


def _away(at: NDArray[np.float64], axes: Axes) -> NDArray[np.float64]:
    """How far places (k, 2) are from the picture; 0 in it."""
    low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
    return np.asarray(np.hypot(*(at - np.clip(at, low, high)).T))


def _together(marks: list[BalanceMark], axes: Axes) -> list[BalanceMark]:
    """Join marks at one place, whose names would lie on each other, into one with all their names."""
    near = _NEAR * max(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()))
    groups: list[list[BalanceMark]] = []
    for mark in marks:
        for group in groups:
            one = group[0]
            alike = (mark.upward, mark.unbalanced, mark.axis) == (one.upward, one.unbalanced, one.axis)
            if alike and mark.at is not None and one.at is not None and np.hypot(*np.subtract(mark.at, one.at)) < near:
                group.append(mark)
                break
        else:
            groups.append([mark])
    return [
        replace(group[0], name=group[0].name if len(group) == 1 else f"{group[0].name} and {len(group) - 1} more")
        for group in groups
    ]


def _draw(mark: BalanceMark, axes: Axes, labels: Labels) -> list[Entry]:
    """Draw a resultant as a named cross in a square, off the picture as an arrow to it, a tipping axis dash-dotted."""
    entries: list[Entry] = []
    colour = _BAD if mark.unbalanced else _GOOD
    low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
    if mark.at is not None:
        at = np.array(mark.at)
        way = "upward resultant" if mark.upward else "resultant"
        ending = ", not balanced" if mark.unbalanced else ""
        place = ""
        look: dict[str, Any] = {"marker": "$\\boxtimes$", "linestyle": "none", "color": colour, "markersize": 10.0}
        if _away(at[None], axes)[0] == 0.0:
            labels.keep_free(at, 10.0)
            axes.plot(*at, zorder=8, **look)
            labels.beside(mark.name, at, color=colour, zorder=8)
        else:
            middle = 0.5 * (low + high)
            border = middle + (at - middle) / np.max(np.abs(at - middle) / (0.5 * (high - low)))
            start = border - _ARROW / labels.scale * (at - middle) / np.hypot(*(at - middle))
            arrow = {"arrowstyle": "-|>", "color": colour, "linewidth": 2.0, "shrinkA": 0, "shrinkB": 0}
            axes.annotate("", border, start, arrowprops=arrow, zorder=8)
            labels.keep_free([start, border], 8.0)
            labels.beside(f"{mark.name}: at {point(mark.at)}", start, color=colour, zorder=8)
            place = f" at {point(mark.at)}, off the picture"
        entries.append((f"{mark.name}: {way}{place}{ending}", (Line2D([], [], **look),)))
    if mark.axis is not None:
        start, end = np.array(mark.axis)
        reach = (end - start) / max(float(np.hypot(*(end - start))), 1e-300) * float((high - low).max())
        dashed: dict[str, Any] = {"color": colour, "linestyle": "-."}
        axes.plot(*np.array([start - reach, end + reach]).T, zorder=7, scalex=False, scaley=False, **dashed)
        entries.append((f"{mark.name}: tips about this line", (Line2D([], [], **dashed),)))
    return entries
