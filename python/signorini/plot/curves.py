"""Curves over the factor of a load path, along lines of a plate, and over the dofs of refined meshes."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from signorini.base.numbers import plain, size_of
from signorini.plot.plan import INK, PAPER, literal, wrapped
from signorini.shapes.arrays import Floats

_CURVES = ("#1f5fa8", "#d95f02", "#1b6e53", "#7a3e9d", "#8c6d1f", "#b3261e")
_STYLES: tuple[Literal["solid", "dashed", "dotted"], ...] = ("solid", "dashed", "dotted")
"""Line styles of curves; when every colour has been used, the colours repeat in the next style."""
_MAX_CURVES = len(_CURVES) * len(_STYLES)
_END, _ASKED, _EVENT = "#b3261e", "#5c5c5c", "#3f6f8f"
_WIDEST = 2.6
"""Largest width of a line of legend text [inches]."""
_DESIGN, _DWARFED = 0.97, 2.5
"""If a value in the last 3 % of t exceeds 2.5 times all earlier ones, the panel's scale is that of the earlier 97 %."""
_ROOM, _LONGEST = 0.04, 40
"""Smallest distance in t of two event labels, relative to the last t; largest number of characters of a label."""
_PART = "part closed [%]"
_ALIKE = 1e-6
"""Largest difference of two curves that count as equal, relative to the largest value of all curves."""
_HEIGHT, _ROW = 2.3, 0.19
"""Least height of a panel, and height of a row of its legend [inches]."""


def line(
    x: ArrayLike,
    y: ArrayLike,
    *,
    ax: Axes | None = None,
    label: str = "",
    xlabel: str = "",
    ylabel: str = "",
    title: str = "",
    upward: bool = False,
) -> Axes:
    """Draw values (k,) at positions (k,) along a line, positive values down as deflections, or ``upward``.

    With ``ax``, the axes of an earlier call, several curves are drawn together. ``label`` is the curve's name in the
    legend.
    """
    axes = Figure(figsize=(7, 3.6), layout="constrained").add_subplot() if ax is None else ax
    axes.plot(np.asarray(x, dtype=float), np.asarray(y, dtype=float), label=label or "_curve", linewidth=1.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(alpha=0.25)
    axes.yaxis.set_inverted(not upward)
    axes.set_xlabel(xlabel or axes.get_xlabel())
    axes.set_ylabel(ylabel or axes.get_ylabel())
    axes.set_title(title or axes.get_title())
    if axes.get_legend_handles_labels()[1]:
        axes.legend(frameon=False)
    return axes


def load_path_picture(
    t: ArrayLike,
    deflections: Mapping[str, ArrayLike],
    reactions: Mapping[str, ArrayLike],
    closed: Mapping[str, ArrayLike],
    thresholds: Mapping[str, float] | None = None,
    *,
    of_points: Mapping[str, ArrayLike] | None = None,
    pressures: Mapping[str, ArrayLike] | None = None,
    events: Sequence[tuple[float, str]] = (),
    stepwise: Collection[str] = (),
    limit: float | None = None,
    until: float | None = None,
    last: float | None = None,
    title: str = "",
    factor: str = "t",
    length: str = "",
    force: str = "",
) -> Figure:
    """Draw reactions of supports and points, largest pressures, closed fractions and deflections over t, a panel each.

    Curves (k,) by name are at the values ``t`` (k,); closed fractions are from 0 to 1. A name has the same colour in
    all panels. Equal curves are drawn once. A panel draws at most 18 curves and counts the others. If the last values
    are far larger than all earlier values, they are cut off, with a note. ``thresholds`` are values of t to mark, by
    name; ``events`` are values of t with labels. The closed fractions of the supports ``stepwise`` jump at events.
    Equilibrium ends at ``limit``, to which the axis reaches; beyond ``until`` deflections are too large for the theory.
    Curves end at ``until`` or ``last``.
    """
    stops = np.asarray(t, dtype=float)
    drawn = min((to for to in (until, last) if to is not None), default=np.inf)
    shown = np.append(stops[stops < drawn], drawn) if drawn < stops[-1] else stops

    def at_shown(values: ArrayLike) -> Floats:
        every = np.asarray(values, dtype=float)
        return every if shown is stops else np.interp(shown, stops, every)

    panels = {
        f"reaction{_unit(force)}, positive up": reactions,
        f"reaction of a point{_unit(force)}": of_points or {},
        f"largest pressure{_unit(f'{force}/{length}²' if force and length else '')}": pressures or {},
        _PART: {name: 100.0 * np.asarray(of, dtype=float) for name, of in closed.items()},
        f"deflection{_unit(length)}, positive down": deflections,
    }
    curves = {label: {name: at_shown(of) for name, of in panel.items()} for label, panel in panels.items() if panel}
    rows = [max(_HEIGHT, _ROW * (min(len(of), _MAX_CURVES) + 2)) for of in curves.values()]
    figure = Figure(figsize=(8.6, 0.9 + sum(rows)), layout="constrained")
    axes = figure.subplots(len(curves), 1, sharex=True, squeeze=False, height_ratios=rows)[:, 0].tolist()
    figure.suptitle(literal(title), fontsize=11, color=INK)
    named = dict.fromkeys(name for of in curves.values() for name in of)
    looks = {
        name: (_CURVES[i % len(_CURVES)], _STYLES[i // len(_CURVES) % len(_STYLES)]) for i, name in enumerate(named)
    }
    for panel, (label, of) in zip(axes, curves.items(), strict=True):
        _draw_curves(panel, shown, of, label, stepwise if label == _PART else (), looks)
    axes[-1].invert_yaxis()
    _mark_events(axes, [(at, words) for at, words in events if at <= shown[-1]], float(shown[-1]))
    axes[-1].set_xlabel(literal(factor), fontsize=9, color=INK)
    if until is not None:
        _mark(axes, until, "larger t is not drawn: deflections are too large", _ASKED, bottom=True)
    if limit is not None:
        _mark(axes, limit, f"equilibrium ends at t = {plain(limit, 6)}", _END)
        axes[-1].set_xlim(right=max(_ROOM * limit + limit, axes[-1].get_xlim()[1]))
    for name, value in (thresholds or {}).items():
        if value <= shown[-1]:
            _mark(axes, value, name, _ASKED)
    return figure


def _unit(unit: str) -> str:
    return literal(f" [{unit}]" if unit else "")


def _mark(axes: list[Axes], t: float, words: str, color: str, bottom: bool = False) -> None:
    """Draw a line at ``t`` in all panels, and its label at the top or the ``bottom`` of the first."""
    for panel in axes:
        panel.axvline(t, color=color, linewidth=1.2, linestyle="solid" if color == _END else (0, (4, 2)))
    paper = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5}
    look: dict[str, Any] = {"ha": "right", "va": "bottom" if bottom else "top", "fontsize": 8, "color": color}
    offset = (-3, 3 if bottom else -3)
    _write_at_edge(axes[0], t, 0.0 if bottom else 1.0, words, xytext=offset, rotation=90, bbox=paper, **look)


def _write_at_edge(axes: Axes, t: float, edge: float, words: str, **look: Any) -> None:
    """Write a text at ``t`` at an edge of a panel: 0 is the lower edge, 1 the upper edge."""
    place: dict[str, Any] = {"xycoords": ("data", "axes fraction"), "textcoords": "offset points"}
    axes.annotate(literal(words), (t, edge), **place, **look)


def _mark_events(axes: list[Axes], events: Sequence[tuple[float, str]], end: float) -> None:
    """Draw a dotted line in all panels at each event, and above the first panel its label if there is space."""
    before = -np.inf
    for t, words in events:
        for panel in axes:
            panel.axvline(t, color=_EVENT, linewidth=0.7, linestyle="dotted", zorder=0.9)
        if t - before >= _ROOM * end:
            short = words if len(words) <= _LONGEST else f"{words[: _LONGEST - 1]}…"
            _write_at_edge(axes[0], t, 1.0, short, xytext=(0, 2), rotation=40, fontsize=7, color=_EVENT)
            before = t


def _leave_out_end(axes: Axes, stops: Floats, curves: Sequence[Floats]) -> None:
    """If values in the last 3 % of t are much larger, scale a panel by earlier values and write the largest as text."""
    before, every = stops <= _DESIGN * stops[-1], np.array(curves)
    low, high = float(every[:, before].min()), float(every[:, before].max())
    ends = float(every.min()), float(every.max())
    if high <= low or np.abs(ends).max() <= _DWARFED * np.abs([low, high]).max():
        return
    room = 0.1 * (high - low)
    axes.set_ylim(low - room, high + room)
    beyond = [plain(end, 3) for end, kept in zip(ends, (low, high), strict=True) if end != kept]
    words = f"to {' and '.join(beyond)} at t = {plain(float(stops[-1]), 3)}"
    look: dict[str, Any] = {"ha": "right", "va": "top", "fontsize": 7.5, "color": _END, "bbox": PAPER}
    axes.text(0.97, 0.97, words, transform=axes.transAxes, **look)


def _together(curves: Mapping[str, Floats]) -> list[tuple[list[str], Floats]]:
    """Merge equal curves (k,); return each distinct curve with the names of all curves equal to it."""
    tolerance = _ALIKE * size_of(list(curves.values()))
    merged: list[tuple[list[str], Floats]] = []
    for name, values in curves.items():
        same = next((names for names, other in merged if np.abs(other - values).max() <= tolerance), None)
        if same is None:
            merged.append(([name], values))
        else:
            same.append(name)
    return merged


def _draw_curves(
    axes: Axes,
    stops: Floats,
    curves: Mapping[str, Floats],
    label: str,
    stepwise: Collection[str],
    looks: Mapping[str, tuple[str, Literal["solid", "dashed", "dotted"]]],
) -> None:
    every = _together(curves)
    for names, values in every[:_MAX_CURVES]:
        colour, style = looks[names[0]]
        line = Line2D(stops, values, color=colour, linestyle=style)
        line.set(label=literal(wrapped(", ".join(names), _WIDEST, 8.0)), linewidth=1.5)
        line.set_drawstyle("steps-post" if set(names) & set(stepwise) else "default")
        axes.add_line(line)
    left_out = len(every) - _MAX_CURVES
    if left_out > 0:
        axes.add_line(Line2D([], [], label=f"{left_out} more are not drawn", linestyle="none"))
    axes.autoscale_view()
    axes.margins(x=0.01)
    _leave_out_end(axes, stops, [values for _, values in every[:_MAX_CURVES]])
    _without_rounding(axes, size_of(list(curves.values())))
    axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    axes.grid(alpha=0.25, linewidth=0.5)
    axes.spines[["top", "right"]].set_visible(False)
    _write_labels(axes, None, label, 9, 8.5)


def _write_labels(axes: Axes, x: str | None, y: str, size: float, numbers: float) -> None:
    """Label the axes of a panel; ``x`` is None if the panel below has the label of the x axis."""
    if x is not None:
        axes.set_xlabel(x, fontsize=size, color=INK)
    axes.set_ylabel(y, fontsize=size, color=INK)
    axes.tick_params(labelsize=numbers)


def _without_rounding(axes: Axes, size: float) -> None:
    """Extend the value range by a tenth of ``size`` on both sides if it is less than 1e-6 ``size``.

    A curve that varies by rounding then looks constant.
    """
    low, high = axes.get_ylim()
    if abs(high - low) < _ALIKE * size:
        room = 0.1 * size * (np.sign(high - low) or 1.0)
        axes.set_ylim(low - room, high + room)


_COLOURS = 10
"""Number of line colours; curve 11 and those after it repeat the colours in the next line style."""


def _unit_of(label: str) -> str:
    return label.partition("[")[2]


_ACROSS = 4
"""Largest number of panels side by side in a picture of profiles, as on a landscape page."""


def profile_picture(
    distance: ArrayLike,
    panels: Mapping[str, Mapping[str, ArrayLike]],
    along: str = "",
    title: str = "",
    upward: Collection[str] = (),
) -> Figure:
    """Draw each quantity along a line in its own panel. Positive values point down, those of ``upward`` quantities up.

    ``panels`` has the curves (k,) of each quantity by combination; ``along`` is the label of the distance (k,). A curve
    is interrupted at NaN. A quantity with NaN only has no panel.
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
    sizes: dict[str, float] = {}
    for name, curves in shown.items():
        largest = np.nanmax(np.abs([np.asarray(values, dtype=float) for values in curves.values()]))
        sizes[_unit_of(name)] = max(sizes.get(_unit_of(name), 0.0), float(largest))
    for axes, (name, curves) in zip(grid, shown.items(), strict=False):
        for i, values in enumerate(curves.values()):
            line(distance, values, ax=axes, upward=name in upward)
            axes.lines[-1].set_linestyle(_STYLES[i // _COLOURS % len(_STYLES)])
        _without_rounding(axes, sizes[_unit_of(name)])
        axes.set_xlim(float(np.min(distance)), float(np.max(distance)))
        _write_labels(axes, literal(along), literal(name), 8.5, 8)
    names = [literal(name) for curves in list(shown.values())[:1] for name in curves]
    figure.legend(grid[0].lines, names, loc="outside lower center", ncols=5, frameon=False, fontsize=8.5)
    return figure


_FOUND, _LIMIT = "#1f5fa8", "#b3261e"


def refinement_picture(dofs: ArrayLike, worst: ArrayLike, asked: float, order: float, title: str = "") -> Figure:
    """Draw the largest relative half-width over the number of dofs, and the curve expected for uniform refinement.

    ``asked`` is the half-width that ``mesh.accuracy`` requires; ``order`` is the expected order of convergence in the
    element size.
    """
    n, half_width = np.asarray(dofs, dtype=float), np.asarray(worst, dtype=float)
    figure = Figure(figsize=(6.4, 4.0), layout="constrained")
    axes = figure.subplots()
    figure.suptitle(literal(title), fontsize=11, color=INK)
    axes.loglog(n, half_width, color=_FOUND, marker="o", markersize=4, label="these meshes")
    axes.axhline(asked, color=_LIMIT, linewidth=1.2, label="mesh.accuracy")
    range_of_n = np.array([n[0], max(n[-1], n[0] * (half_width[0] / asked) ** (2 / order))])
    expected = half_width[0] * (range_of_n / n[0]) ** (-order / 2)
    axes.loglog(range_of_n, expected, color=INK, linewidth=1, linestyle="--", label="uniform refinement, expected")
    _write_labels(axes, "dofs", "largest ±, relative to the largest value of its field", 9, 8.5)
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(fontsize=8.5, frameon=False)
    return figure
