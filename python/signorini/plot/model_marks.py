"""Symbols of loads, sections, strips, edges, singularities and resultants in plan."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from numpy.typing import NDArray

from signorini.errors import point
from signorini.plot.marks import Entry
from signorini.plot.picture import BalanceMark, CutMark, EdgeMark, LoadMark, SingularMark
from signorini.plot.plan import Labels, enclosed, inches_per_unit, pieces
from signorini.shapes.arrays import Floats

_COLOURS = ("#b3261e", "#7a3e9d", "#b8860b", "#1b6e53", "#c2185b", "#4d5b9e")
"""Colours of the first, second, ... load case; after the last colour they repeat."""
_MAX_VALUES = 12
"""Largest number of points of a load whose values are written beside them; for more points only the legend has the
value."""
_MAX_PLACES = 5
"""Largest number of positions that are tried for a label along a line."""
_IN_AREA = np.array([[0.2, 0.8], [0.5, 0.5], [0.8, 0.2], [0.2, 0.2], [0.8, 0.8]])
"""Candidate positions of a label in an area, relative to its bounding box."""


def draw_load(mark: LoadMark, axes: Axes, colour: str, plate: Path) -> Entry:
    """Draw one load, with its area clipped to the outline ``plate``; return the legend entry."""
    positions, words = mark.positions, mark.label
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
    marks: Sequence[LoadMark], axes: Axes, totals: Mapping[str, str], plate: Path, labels: Labels
) -> list[Entry]:
    """Draw loads, with one colour per load case; return the legend entries, last the totals of the cases.

    Loads with equal legend texts share one entry. ``totals`` are the texts of the totals by case.
    """
    cases = list(dict.fromkeys(mark.case for mark in marks))
    colours = {case: _COLOURS[place % len(_COLOURS)] for place, case in enumerate(cases)}
    entries = list(dict(draw_load(mark, axes, colours[mark.case], plate) for mark in marks).items())
    for mark in marks:
        if mark.value:
            _write_value(mark, colours[mark.case], labels)
    look: dict[str, Any] = {"marker": "s", "markersize": 4.0, "linestyle": "none"}
    sums = [(f"{case}: {totals[case]} in total", colours[case]) for case in cases if case in totals]
    return entries + [(words, (Line2D([], [], color=colour, **look),)) for words, colour in sums]


def _write_value(mark: LoadMark, colour: str, labels: Labels) -> None:
    """Write the value of a load, with its direction if upward, beside its points, along its line or in its area."""
    positions, words = mark.positions, f"{mark.value} up" if mark.upward else mark.value
    for piece in pieces(positions)[:1] if mark.style != "points" else ():
        inside = piece
        if mark.style == "area":
            low, high = piece.min(axis=0), piece.max(axis=0)
            inside = low + _IN_AREA * (high - low)
        labels.beside(words, inside[_spread(len(inside))], 7.5, colour, zorder=6.4)
    for at in positions if mark.style == "points" and len(positions) <= _MAX_VALUES else ():
        labels.beside(words, at, 7.5, colour, zorder=6.4)


def _spread(count: int) -> NDArray[np.int64]:
    """Indices of up to five evenly spaced positions for a label out of ``count``, the middle one first."""
    if count <= _MAX_PLACES:
        return np.roll(np.arange(count), -(count // 2))
    return np.linspace(0, count - 1, _MAX_PLACES).astype(np.int64)[[2, 1, 3, 0, 4]]


_HEAD = 0.01
"""Length of a section's arrow head, relative to the last segment of the section."""
_SECTION, _STRIP = "#a0356d", "#2f7f86"


def draw_cuts(marks: Iterable[CutMark], axes: Axes, labels: Labels) -> list[Entry]:
    """Draw sections as lines that end with an arrow, and strips as bands; write their names."""
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
            entries["section"] = "section; the arrow defines left and right", (Line2D([], [], **look),)
            continue
        left, right = mark.borders
        band: dict[str, Any] = {"facecolor": to_rgba(colour, 0.12), "edgecolor": colour, "linewidth": 0.6}
        axes.fill(*np.concatenate([left, right[::-1]]).T, zorder=1.8, **band)
        entries["strip"] = "strip", (Patch(**band),)
    return list(entries.values())


_NAME, _SINGULAR = "#5d6b78", "#d6006c"
_INWARD = 8.0
"""Distance from an edge to the middle of its name [points]."""
_FEW = 60
"""Largest number of singular points that are marked by rings; more points are marked by dots."""
_MAX_WORDS = 3
"""Largest number of kinds of singularities that the legend names; further kinds are counted."""
_ALONG_EDGE = np.array([0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5])
"""Candidate positions of an edge's name, as distances from the edge's middle; 1 is a fifth of the edge's length."""


def draw_edges(marks: Iterable[EdgeMark], labels: Labels) -> None:
    """Write the name of each edge along the edge, inside the plate; leave out names without space."""
    for mark in marks:
        along = np.array(mark.along)
        x, y = along / max(float(np.hypot(*along)), 1e-300)
        turn = float((np.degrees(np.arctan2(y, x)) + 90) % 180 - 90)
        at = np.array(mark.at) + _INWARD / labels.scale * np.array([-y, x]) + _ALONG_EDGE[:, None] * along
        labels.along(mark.name, at, [turn] * len(at), 7.5, _NAME, zorder=3.6)


def draw_singular(marks: Sequence[SingularMark], axes: Axes) -> list[Entry]:
    """Mark points and lines at which moments, shears or pressures are singular; return the legend entries."""
    entries: list[Entry] = []
    for limited, means in ((False, "no limit as the mesh is refined"), (True, "too small for this mesh")):
        selected = [mark for mark in marks if mark.limited == limited]
        if not selected:
            continue
        count = sum(len(mark.places) for mark in selected if not mark.line)
        look: dict[str, Any] = {"color": _SINGULAR, "linestyle": "none", "marker": "o"}
        look |= {"markerfacecolor": "none", "markeredgewidth": 0.9, "clip_on": False}
        look |= {"markersize": 13.0} if count <= _FEW else {"markersize": 1.5}
        for mark in selected:
            if mark.line:
                axes.plot(*mark.places.T, color=_SINGULAR, linewidth=1.2, linestyle=(0, (3, 2)), zorder=6.2)
            else:
                axes.plot(*mark.places.T, zorder=6.2, **look)
        words = list(dict.fromkeys(mark.words for mark in selected))
        more = f" and {len(words) - _MAX_WORDS} more" if len(words) > _MAX_WORDS else ""
        sample = Line2D([], [], **look | {"markersize": 9.0})
        entries.append((f"{means}: {', '.join(words[:_MAX_WORDS])}{more}", (sample,)))
    return entries


_GOOD, _BAD = "#1b6e53", "#b3261e"
_ARROW = 22.0
"""Length of the arrow that points to a resultant outside the picture [points]."""
_MAX_NAMED = 8
"""Largest number of combinations that are all named; if there are more, only unbalanced ones are named."""

_NEAR = 0.02
"""Largest distance of resultants that share a label, relative to the picture's size."""


def draw_balances(marks: Sequence[BalanceMark], axes: Axes, labels: Labels) -> list[Entry]:
    """Draw the resultant of the loads of each combination; if there are many, only some are named.

    Return the legend entries.
    """
    named = [*marks] if len(marks) <= _MAX_NAMED else [mark for mark in marks if mark.unbalanced][:_MAX_NAMED]
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
                words += f", {np.count_nonzero(away)} of them off the picture, such as at {point(at[away.argmax()])}"
            entries.append((words, (Line2D([], [], **look),)))
    return entries


def _away(at: Floats, axes: Axes) -> Floats:
    """Distances (k,) of points (k, 2) from the picture; 0 for points inside."""
    low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
    return np.asarray(np.hypot(*(at - np.clip(at, low, high)).T))


def _together(marks: list[BalanceMark], axes: Axes) -> list[BalanceMark]:
    """Merge resultants at nearly the same point into one mark with all names, since the names would overlap."""
    near = _NEAR * max(np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim()))
    groups: list[list[BalanceMark]] = []
    for mark in marks:
        for group in groups:
            head = group[0]
            same = (mark.upward, mark.unbalanced, mark.axis) == (head.upward, head.unbalanced, head.axis)
            if same and mark.at is not None and head.at is not None and np.hypot(*np.subtract(mark.at, head.at)) < near:
                group.append(mark)
                break
        else:
            groups.append([mark])
    return [
        replace(group[0], name=group[0].name if len(group) == 1 else f"{group[0].name} and {len(group) - 1} more")
        for group in groups
    ]


def _draw(mark: BalanceMark, axes: Axes, labels: Labels) -> list[Entry]:
    """Draw a resultant as a crossed square, outside the picture as an arrow; its tipping axis is dash-dotted."""
    entries: list[Entry] = []
    colour = _BAD if mark.unbalanced else _GOOD
    low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
    if mark.at is not None:
        at = np.array(mark.at)
        kind = "upward resultant" if mark.upward else "resultant"
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
        entries.append((f"{mark.name}: {kind}{place}{ending}", (Line2D([], [], **look),)))
    if mark.axis is not None:
        start, end = np.array(mark.axis)
        reach = (end - start) / max(float(np.hypot(*(end - start))), 1e-300) * float((high - low).max())
        dashed: dict[str, Any] = {"color": colour, "linestyle": "-."}
        axes.plot(*np.array([start - reach, end + reach]).T, zorder=7, scalex=False, scaley=False, **dashed)
        entries.append((f"{mark.name}: tips about this line", (Line2D([], [], **dashed),)))
    return entries
