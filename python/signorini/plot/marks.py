"""Supports and loads as they are drawn in plan."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.patheffects import Normal, TickedStroke, withStroke
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from signorini.plot.plan import INK, literal

_LOAD = "#b3261e"
_EDGE = "#d95f02"
_MARKERS = {"down": "^", "up": "v", "both": "s", "fixed": "s"}
_ACTIONS = {"down": "pushes up only", "up": "holds down only", "both": "holds both ways", "fixed": "fixed"}
_SIZES = {"points": (8.5, 4.0), "line": (4.5, 2.5), "area": (3.5, 0.7)}
_UNCROWDED = {"points": 100, "line": 60, "area": 200}

Entry = tuple[str, tuple[Artist, ...]]
"""A line of the legend: its words and its samples."""


@dataclass(frozen=True)
class SupportMark:
    """A support as it is drawn.

    Attributes
    ----------
    name : str
        Its name in the legend.
    kind : {"down", "up", "both", "fixed"}
        Which way it resists: a triangle up pushes the plate up, a triangle down holds it down, a square does both;
        ``fixed`` along a line is drawn as a hatched edge.
    positions : ndarray, shape (k, 2)
        Contact points, or the vertices of a fixed line; a row of NaN starts a new piece.
    closed : ndarray of bool, shape (k,), or None
        Which points are in contact (filled) and which are open (hollow). None: not known or always held.
    style : {"points", "line", "area"}
        How large the marks are.
    boundary : sequence of ndarray, shape (k, 2)
        The edge of contact of an area, as polylines.
    """

    name: str
    kind: Literal["down", "up", "both", "fixed"]
    positions: NDArray[np.float64]
    closed: NDArray[np.bool_] | None = None
    style: Literal["points", "line", "area"] = "points"
    boundary: Sequence[NDArray[np.float64]] = ()

    @property
    def label(self) -> str:
        """What the legend says: the name, the kind, and how many points are closed and open."""
        if self.closed is None:
            return f"{self.name}: {_ACTIONS[self.kind]}"
        real = ~np.isnan(self.positions[:, 0])
        closed = int(np.count_nonzero(self.closed & real))
        return f"{self.name}: {_ACTIONS[self.kind]}, {closed} closed, {int(real.sum()) - closed} open"


@dataclass(frozen=True)
class LoadMark:
    """A load as it is drawn.

    Attributes
    ----------
    name : str
        Its name in the legend.
    positions : ndarray, shape (k, 2)
        Points of application, vertices of the loaded line, or the outline of the loaded area; a row of NaN starts a
        new piece. None at all, shape (0, 2), for a load on the whole plate, which the legend only names.
    style : {"points", "line", "area"}
        Which of the three.
    upward : bool
        A point load away from the reader is a crossed circle; one towards him, upward, is a dotted circle.
    """

    name: str
    positions: NDArray[np.float64]
    style: Literal["points", "line", "area"] = "points"
    upward: bool = False


def supports(marks: Iterable[SupportMark], ax: Axes, *, areas: bool = True) -> Axes:
    """Draw supports, closed contact points filled and open ones hollow, and edges of contact; the legend is below.

    Parameters
    ----------
    marks : iterable of SupportMark
    ax : Axes
    areas : bool
        Whether to draw the points of areas too, or only their edges of contact.

    Returns
    -------
    Axes
        ``ax``.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> pads = SupportMark("pads", "down", np.array([[0.0, 0.0], [1.0, 0.0]]), np.array([True, False]))
    >>> axes = supports([pads], Figure().add_subplot())
    >>> [entry.get_text() for entry in axes.get_legend().get_texts()]
    ['pads: pushes up only, 1 closed, 1 open']
    """
    draw_legend(ax, draw_supports(marks, ax, areas=areas))
    return ax


def draw_supports(marks: Iterable[SupportMark], axes: Axes, *, areas: bool = True) -> list[Entry]:
    """Draw supports and edges of contact and return their entries in the legend."""
    marks = list(marks)
    entries = [draw_support(mark, axes) for mark in marks if areas or mark.style != "area"]
    look: dict[str, Any] = {"color": _EDGE, "linewidth": 1.8, "solid_capstyle": "butt"}
    lines = [line for mark in marks for line in mark.boundary]
    for line in lines:
        axes.plot(*line.T, zorder=5.5, path_effects=[withStroke(linewidth=3.2, foreground="white")], **look)
    return entries + ([("edge of contact", (Line2D([], [], **look),))] if lines else [])


def draw_support(mark: SupportMark, axes: Axes) -> Entry:
    """Draw one support and return its entry in the legend."""
    positions = np.asarray(mark.positions, dtype=float)
    if mark.kind == "fixed" and mark.style == "line":
        hatch = [Normal(), TickedStroke(spacing=6, angle=-135, length=0.9)]
        held: dict[str, Any] = {"color": INK, "linewidth": 2.2, "path_effects": hatch, "clip_on": False}
        middle = np.array([sum(axes.get_xlim()), sum(axes.get_ylim())]) / 2
        for piece in _pieces(positions):
            axes.plot(*_hatched_outside(piece, middle).T, zorder=4, **held)
        return mark.label, (Line2D([], [], **held),)

    largest, smallest = _SIZES[mark.style]
    size = max(smallest, largest * min(1.0, (_UNCROWDED[mark.style] / max(len(positions), 1)) ** 0.5))
    look: dict[str, Any] = {"marker": _MARKERS[mark.kind], "linestyle": "none", "markersize": size, "clip_on": False}
    full = look | {"markerfacecolor": INK, "markeredgecolor": "white", "markeredgewidth": 0.1 * size}
    hollow = look | {"markerfacecolor": "white", "markeredgecolor": INK, "markeredgewidth": min(1.0, 0.2 * size)}
    closed = np.ones(len(positions), dtype=bool) if mark.closed is None else np.asarray(mark.closed, dtype=bool)
    samples: list[Artist] = []
    for chosen, style in [(closed, full), (~closed, hollow)]:
        if chosen.any():
            axes.plot(*positions[chosen].T, zorder=5, **style)
        if chosen.any() or (style is full and not len(positions)):
            samples.append(Line2D([], [], **(style | {"markersize": max(size, 5.5), "markeredgewidth": 0.9})))
    return mark.label, tuple(samples) or (Line2D([], [], linestyle="none"),)


def draw_load(mark: LoadMark, axes: Axes) -> Entry:
    """Draw one load and return its entry in the legend."""
    positions = np.asarray(mark.positions, dtype=float)
    look: dict[str, Any]
    if mark.style == "points":
        look = {"marker": r"$\odot$" if mark.upward else r"$\otimes$", "markersize": 11.0, "linestyle": "none"}
        look |= {"color": _LOAD, "markeredgewidth": 0.4, "clip_on": False}
        axes.plot(*positions.T, zorder=6, **look)
        return mark.name, (Line2D([], [], **look),)
    if mark.style == "line":
        look = {"color": _LOAD, "linewidth": 2.4, "solid_capstyle": "butt"}
        axes.plot(*positions.T, zorder=4.5, **look)
        return mark.name, (Line2D([], [], **look),)
    look = {"facecolor": to_rgba(_LOAD, 0.10), "edgecolor": _LOAD, "hatch": "....", "linewidth": 1.2}
    for piece in _pieces(positions):
        axes.fill(*piece.T, zorder=3, **look)
    return mark.name, (Patch(**look),)


def draw_legend(axes: Axes, entries: Sequence[Entry]) -> None:
    """Put the legend below the axes and their labels."""
    figure = axes.get_figure()
    if not entries or figure is None:
        return
    below = axes.transAxes + ScaledTranslation(0, -0.45, figure.dpi_scale_trans)
    axes.legend(
        handles=[samples for _, samples in entries],
        labels=[literal(words) for words, _ in entries],
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.5)},
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0),
        bbox_transform=below,
        frameon=False,
        fontsize=8.5,
    )


def _pieces(positions: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Split a polyline at its rows of NaN."""
    breaks = np.flatnonzero(np.isnan(positions[:, 0]))
    parts = [part[~np.isnan(part[:, 0])] for part in np.split(positions, breaks)]
    return [part for part in parts if len(part)]


def _hatched_outside(piece: NDArray[np.float64], middle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Turn a polyline so that what lies on its right is away from the middle."""
    start, step = piece[:-1] - middle, np.diff(piece, axis=0)
    turning = float(np.sum(start[:, 0] * step[:, 1] - start[:, 1] * step[:, 0]))
    return piece if turning >= 0 else piece[::-1]
