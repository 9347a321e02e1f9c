"""A load path: over the load factor what the supports carry, which part of them is closed, and deflections."""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Mapping
from typing import Literal, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from signorini.errors import InputError
from signorini.plot.plan import INK, literal

Floats: TypeAlias = NDArray[np.float64]

_CURVES = ("#1f5fa8", "#d95f02", "#1b6e53", "#7a3e9d", "#8c6d1f", "#b3261e")
_STYLES: tuple[Literal["solid", "dashed", "dotted"], ...] = ("solid", "dashed", "dotted")
"""Of curves of one colour the first one's, the second one's and the third one's."""
_MOST_CURVES = len(_CURVES) * len(_STYLES)
_END, _ASKED = "#b3261e", "#5c5c5c"
_WIDEST = 34
"""Letters of a line of a legend."""
_PART = "part closed [%]"
_ALIKE = 1e-6
"""Difference of curves, over the largest of all, that is none."""
_HEIGHT, _ROW = 2.3, 0.19
"""Inches of a panel, and of a row of its legend."""


def load_path_picture(
    t: ArrayLike,
    deflections: Mapping[str, ArrayLike],
    reactions: Mapping[str, ArrayLike],
    closed: Mapping[str, ArrayLike],
    thresholds: Mapping[str, float] | None = None,
    *,
    stepwise: Collection[str] = (),
    limit: float | None = None,
    until: float | None = None,
    last: float | None = None,
    title: str = "",
    factor: str = "t",
    length: str = "",
    force: str = "",
) -> Figure:
    """Draw reactions, the parts of supports that are closed, and deflections against the load factor, in panels.

    Parameters
    ----------
    t : array_like, shape (k,)
        The factor at the stops of the path.
    deflections, reactions, closed : mapping of array_like, shape (k,)
        Curves by name; parts that are closed from 0 to 1. What coincides is one curve with all its names; of more than
        eighteen the first are drawn, and the panel says how many are left out.
    thresholds : mapping of float, optional
        Factors to mark, by what is reached there.
    stepwise : collection of str
        Supports whose part that is closed changes at once, from a stop on: those at points.
    limit : float, optional
        The factor at which equilibrium ends, if it does at the end of the path.
    until : float, optional
        The factor at which deflections leave what the theory is of; what is beyond is not drawn.
    last : float, optional
        The factor from which on nothing happens that is worth drawing.
    title, factor, length, force : str
        Above the picture; what the factor is; units.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        An array has another length.

    Examples
    --------
    >>> figure = load_path_picture([0, 1, 2], {"middle": [0, 1, 1]}, {"prop": [0, 0, 5]}, {"prop": [0, 1, 1]})
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['reaction, positive up', 'part closed [%]', 'deflection, positive down']
    """
    stops = np.asarray(t, dtype=float)
    panels = {
        f"reaction{_unit(force)}, positive up": reactions,
        _PART: {name: 100.0 * np.asarray(of, dtype=float) for name, of in closed.items()},
        f"deflection{_unit(length)}, positive down": deflections,
    }
    drawn = min((to for to in (until, last) if to is not None), default=np.inf)
    kept = stops[stops < drawn]
    shown = np.append(kept, drawn) if drawn < stops[-1] else stops
    curves = {
        label: {name: _cut(name, values, stops, shown) for name, values in of.items()}
        for label, of in panels.items()
        if of
    }
    rows = [max(_HEIGHT, _ROW * (min(len(of), _MOST_CURVES) + 2)) for of in curves.values()]
    figure = Figure(figsize=(8.6, 0.9 + sum(rows)), layout="constrained")
    axes = figure.subplots(len(curves), 1, sharex=True, squeeze=False, height_ratios=rows)[:, 0].tolist()
    figure.suptitle(literal(title), fontsize=11, color=INK)
    for panel, (label, of) in zip(axes, curves.items(), strict=True):
        _draw_curves(panel, shown, of, label, stepwise if label == _PART else ())
    axes[-1].invert_yaxis()
    axes[-1].set_xlabel(literal(factor), fontsize=9, color=INK)
    end, words = limit, "equilibrium ends"
    if until is not None and (end is None or until < end):
        end, words = until, "beyond, too large to be drawn"
    if end is not None and end <= shown[-1]:
        _mark(axes, end, words, _END)
    for name, value in (thresholds or {}).items():
        if value <= shown[-1]:
            _mark(axes, value, name, _ASKED)
    return figure


def _unit(unit: str) -> str:
    return literal(f" [{unit}]" if unit else "")


def _cut(name: str, values: ArrayLike, stops: Floats, shown: Floats) -> Floats:
    """The values of a curve at the factors that are shown."""
    of = np.asarray(values, dtype=float)
    if of.shape != stops.shape:
        raise InputError(f"{name!r} has the shape {of.shape}; for these t it must be ({len(stops)},).")
    return of if shown is stops else np.interp(shown, stops, of)


def _mark(axes: list[Axes], t: float, words: str, color: str) -> None:
    for panel in axes:
        panel.axvline(t, color=color, linewidth=1.2, linestyle="solid" if color == _END else (0, (4, 2)))
    axes[0].annotate(
        literal(words),
        (t, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(-3, -3),
        textcoords="offset points",
        ha="right",
        va="top",
        rotation=90,
        fontsize=8,
        color=color,
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.5},
    )


def _together(curves: Mapping[str, Floats]) -> list[tuple[str, Floats]]:
    """Curves, those that coincide as one with all their names."""
    apart = _ALIKE * max((float(np.abs(values).max()) for values in curves.values()), default=0.0)
    result: list[tuple[list[str], Floats]] = []
    for name, values in curves.items():
        same = next((names for names, of in result if np.abs(of - values).max() <= apart), None)
        if same is None:
            result.append(([name], values))
        else:
            same.append(name)
    return [(", ".join(names), values) for names, values in result]


def _draw_curves(
    axes: Axes, stops: Floats, curves: Mapping[str, Floats], label: str, stepwise: Collection[str]
) -> None:
    every = _together(curves)
    for i, (name, values) in enumerate(every[:_MOST_CURVES]):
        line = Line2D(stops, values, color=_CURVES[i % len(_CURVES)], linestyle=_STYLES[i // len(_CURVES)])
        line.set(label=literal("\n".join(textwrap.wrap(name, _WIDEST))), linewidth=1.5)
        line.set_drawstyle("steps-post" if set(name.split(", ")) & set(stepwise) else "default")
        axes.add_line(line)
    left_out = len(every) - _MOST_CURVES
    if left_out > 0:
        axes.add_line(Line2D([], [], label=f"{left_out} more are not drawn", linestyle="none"))
    axes.autoscale_view()
    axes.margins(x=0.01)
    axes.set_ylabel(label, fontsize=9, color=INK)
    axes.legend(fontsize=8, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(alpha=0.25, linewidth=0.5)
    axes.tick_params(labelsize=8.5)
