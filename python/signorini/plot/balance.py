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
from signorini.plot.marks import Entry
from signorini.plot.plan import literal

_GOOD, _BAD = "#1b6e53", "#b3261e"
_FARTHEST = 1.0
"""How far off the plate, in its sizes, a resultant is still drawn."""
_FAR = "far off the plate"
_MARGIN = 0.04
"""Of the plate's size, that the axes leave around a resultant."""

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


def draw_balances(marks: Iterable[BalanceMark], axes: Axes) -> list[Entry]:
    """Draw what becomes of every combination, of many only a few by name."""
    marks = list(marks)
    named = marks if len(marks) <= _MOST_NAMED else [mark for mark in marks if mark.unbalanced][:_MOST_NAMED]
    plate = np.array([axes.get_xlim(), axes.get_ylim()]).T
    entries = [entry for mark in _together(named, axes) for entry in _draw(mark, axes, plate)]
    for colour, unbalanced in ((_GOOD, False), (_BAD, True)):
        others = [mark.at for mark in marks if mark.unbalanced == unbalanced and mark not in named and mark.at]
        if others:
            at = np.array(others)
            shown = _shown(at, axes, plate)
            look: dict[str, Any] = {"marker": "s", "linestyle": "none", "color": colour, "markersize": 3.0}
            axes.plot(*at[shown].T, zorder=7.5, scalex=False, scaley=False, **look)
            more = " more" if named else ""
            ending = ", not balanced" if unbalanced else ""
            words = f"resultants of {len(others)}{more} combinations{ending}"
            if not shown.all():
                away = np.hypot(*(at - plate.mean(axis=0)).T)
                words += f", {np.count_nonzero(~shown)} of them {_FAR}, as at {point(at[away.argmax()])}"
            entries.append((words, (Line2D([], [], **look),)))
    return entries


def _shown(at: NDArray[np.float64], axes: Axes, plate: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which resultants (k, 2) are not far off the plate, whose corners are (2, 2); widen the axes to these."""
    low, high = plate
    size = float((high - low).max())
    shown = (np.abs(at - np.clip(at, low, high)) <= _FARTHEST * size).all(axis=1)
    wide = np.array([axes.get_xlim(), axes.get_ylim()])
    for place in at[shown]:
        wide[:, 0] = np.minimum(wide[:, 0], place - _MARGIN * size)
        wide[:, 1] = np.maximum(wide[:, 1], place + _MARGIN * size)
    axes.set_xlim(*wide[0])
    axes.set_ylim(*wide[1])
    return np.asarray(shown)


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


def _draw(mark: BalanceMark, axes: Axes, plate: NDArray[np.float64]) -> list[Entry]:
    """Draw a resultant as a named cross in a square, a tipping axis dash-dotted; widen the axes to the cross."""
    entries: list[Entry] = []
    colour = _BAD if mark.unbalanced else _GOOD
    low, high = plate
    size = float((high - low).max())
    if mark.at is not None:
        at = np.array(mark.at)
        way = "upward resultant" if mark.upward else "resultant"
        ending = ", not balanced" if mark.unbalanced else ""
        look: dict[str, Any] = {"marker": "$\\boxtimes$", "linestyle": "none", "color": colour, "markersize": 10.0}
        look["clip_on"] = False
        words = f"{mark.name}: {way}{ending}"
        if _shown(at[None], axes, plate).all():
            axes.plot(*at, zorder=8, **look)
            beside: dict[str, Any] = {"textcoords": "offset points", "color": colour, "fontsize": 8, "zorder": 8}
            # On the right half its name stands left of it, as there the page may end.
            to_the_left = at[0] > 0.5 * (low[0] + high[0])
            beside |= {"ha": "right" if to_the_left else "left"}
            axes.annotate(literal(mark.name), mark.at, (-7 if to_the_left else 7, 5), **beside)
        else:
            words += f", {_FAR}"
        entries.append((words, (Line2D([], [], **look),)))
    if mark.axis is not None:
        start, end = np.array(mark.axis)
        reach = (end - start) / max(float(np.hypot(*(end - start))), 1e-300) * size
        drawn = axes.plot(*np.array([start - reach, end + reach]).T, color=colour, linestyle="-.", zorder=7)
        drawn[0].set_clip_on(True)
        sample = Line2D([], [], color=colour, linestyle="-.")
        entries.append((f"{mark.name}: tips about this line", (sample,)))
    return entries
