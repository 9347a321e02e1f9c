"""A load path: deflections over the load factor, and what each support does."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import ArrayLike, NDArray

from signorini.errors import InputError
from signorini.plot.plan import INK, literal

Floats: TypeAlias = NDArray[np.float64]

_CURVES = ("#1f5fa8", "#d95f02", "#1b6e53", "#7a3e9d", "#8c6d1f", "#b3261e")
_CLOSED, _OPEN = "#1f5fa8", "#eef2f5"
_STYLES = (("solid", "o"), ("dashed", "s"))
"""Of curves of one colour the first one's and the second one's."""
_MOST_CURVES = len(_CURVES) * len(_STYLES)


def load_path_picture(
    t: ArrayLike,
    deflections: Mapping[str, ArrayLike],
    closed: Mapping[str, ArrayLike],
    *,
    limit: float | None = None,
    until: float | None = None,
    last: float | None = None,
    title: str = "",
    factor: str = "t",
    length: str = "",
) -> Figure:
    """Draw deflections against the load factor, and below the part of every support that is closed.

    Parameters
    ----------
    t : array_like, shape (k,)
        The factor at the beginning of the path, at every event and at its end.
    deflections : mapping of array_like, shape (k,)
        Curves by name, linear between the values of t; of more than twelve the first are drawn.
    closed : mapping of array_like, shape (k - 1,)
        By support, the part from 0 to 1 of its points that is closed on each stretch.
    limit : float, optional
        The factor at which equilibrium ends, if it does at the end of the path.
    until : float, optional
        The factor at which deflections leave what the theory is of; what is beyond is not drawn.
    last : float, optional
        The factor from which on nothing happens that is worth drawing.
    title, factor, length : str
        Above the picture; what the factor is; the unit of length.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        An array has another length.

    Examples
    --------
    >>> figure = load_path_picture([0, 1, 2], {"middle": [0, 1, 1]}, {"prop": [0, 1]}, factor="t of Q")
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['deflection, positive down', '']
    """
    stops = np.asarray(t, dtype=float)
    curves = {name: np.asarray(values, dtype=float) for name, values in deflections.items()}
    parts = {name: np.asarray(values, dtype=float) for name, values in closed.items()}
    for name, values, expected in (
        *((name, values, len(stops)) for name, values in curves.items()),
        *((name, values, len(stops) - 1) for name, values in parts.items()),
    ):
        if values.shape != (expected,):
            raise InputError(f"{name!r} has the shape {values.shape}; for these t it must be ({expected},).")
    end, words = limit, "equilibrium ends"
    if until is not None and (end is None or until < end):
        end, words = until, "beyond, too large to be drawn"
    drawn = min((to for to in (until, last) if to is not None), default=np.inf)
    if drawn < stops[-1]:
        stops, curves, parts = _drawn(stops, curves, parts, drawn)
    figure = Figure(figsize=(7.4, 3.9 + 0.34 * max(len(parts), 1)), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3.1, 0.34 * max(len(parts), 1) + 0.2])
    figure.suptitle(literal(title), fontsize=11, color=INK)
    _draw_curves(above, stops, curves)
    _draw_states(figure, below, stops, parts)
    unit = literal(f" [{length}]" if length else "")
    above.set_ylabel(f"deflection{unit}, positive down", fontsize=9, color=INK)
    below.set_xlabel(literal(factor), fontsize=9, color=INK)
    if end is not None and end <= stops[-1]:
        for axes in (above, below):
            axes.axvline(end, color="#b3261e", linewidth=1.4)
        above.annotate(
            words,
            (end, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(-4, -4),
            textcoords="offset points",
            ha="right",
            va="top",
            fontsize=8.5,
            color="#b3261e",
        )
    return figure


def _drawn(
    stops: Floats, curves: Mapping[str, Floats], parts: Mapping[str, Floats], until: float
) -> tuple[Floats, dict[str, Floats], dict[str, Floats]]:
    """What of a path is not beyond a factor."""
    last = int(np.searchsorted(stops, until))
    kept = np.append(stops[:last], until)
    cut = {name: np.append(values[:last], np.interp(until, stops, values)) for name, values in curves.items()}
    return kept, cut, {name: values[:last] for name, values in parts.items()}


def _draw_curves(axes: Axes, stops: Floats, curves: Mapping[str, Floats]) -> None:
    few = len(stops) <= 40
    for i, (name, values) in enumerate(list(curves.items())[:_MOST_CURVES]):
        style, marker = _STYLES[i // len(_CURVES)]
        look: dict[str, Any] = {"color": _CURVES[i % len(_CURVES)], "linestyle": style, "linewidth": 1.5}
        line = Line2D(stops, values, label=literal(name), **look)
        if few:
            line.set_marker(marker)
            line.set_markersize(3.2)
        axes.add_line(line)
    for event in stops[1:-1] if few else []:
        axes.axvline(event, color=INK, linewidth=0.5, alpha=0.25, zorder=0)
    axes.autoscale_view()
    axes.invert_yaxis()
    axes.legend(fontsize=8.5, frameon=False, loc="best")
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=8.5)


def _draw_states(figure: Figure, axes: Axes, stops: Floats, parts: Mapping[str, Floats]) -> None:
    for row, part in enumerate(parts.values()):
        widths = np.diff(stops)
        axes.barh(row, widths, left=stops[:-1], height=0.62, color=_shades(part), edgecolor=INK, linewidth=0.0)
        axes.barh(row, stops[-1] - stops[0], left=stops[0], height=0.62, fill=False, edgecolor=INK, linewidth=0.6)
    axes.set_yticks(range(len(parts)), [literal(name) for name in parts], fontsize=8.5)
    axes.invert_yaxis()
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    axes.tick_params(axis="x", labelsize=8.5)
    patches = [Patch(facecolor=colour, edgecolor=INK, linewidth=0.6) for colour in (_CLOSED, _OPEN)]
    figure.legend(patches, ["closed", "open"], loc="outside lower right", ncols=2, fontsize=8.5, frameon=False)


def _shades(part: Floats) -> Floats:
    """A colour between open and closed for each stretch."""
    open_, closed = (np.array([int(c[i : i + 2], 16) / 255 for i in (1, 3, 5)]) for c in (_OPEN, _CLOSED))
    return np.asarray(open_ + part[:, None] * (closed - open_))
