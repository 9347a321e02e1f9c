"""One field on a plan: its colours, its extremes, and the supports."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from numpy.typing import NDArray

from signorini.plot.field import PAPER, Scale, add_colour_bar, checked_field, draw_field
from signorini.plot.marks import Entry, SupportMark, draw_supports
from signorini.plot.plan import INK, Plan, inches_per_unit, literal, set_window
from signorini.plot.pressure import PressureLayer, draw_pressure, pressure_scale

_NAME = (1.8, 0.35)
"""Inches that the name of an extreme takes."""
_ABOVE = 18.0
"""Points from a plan to its title: the name of an extreme at the upper edge is between them."""


@dataclass(frozen=True, eq=False)
class Panel:
    """One field in a picture.

    Attributes
    ----------
    values : ndarray, shape (n,), or sequence of PressureLayer
        At the nodes; or the pressures of areas.
    label : str
        What it is, with its unit: beside the colour bar.
    colours : str
        A map whose middle is zero.
    limits : (low, high) or None
        Range of the colours; None for that of the field.
    extremes : sequence of (str, (x, y))
        What is written in the picture, and where.
    title : str
        Above the panel.
    """

    values: NDArray[np.float64] | Sequence[PressureLayer]
    label: str = ""
    colours: str = "RdBu"
    limits: tuple[float, float] | None = None
    extremes: Sequence[tuple[str, Sequence[float]]] = ()
    title: str = ""


def draw_panel(axes: Axes, plan: Plan, panel: Panel, marks: Iterable[SupportMark]) -> list[Entry]:
    """Draw a field with its colour bar, its extremes and the supports; return their entries in the legend."""
    set_window(axes, plan)
    scale = scale_of(plan, panel)
    frame(axes, panel, scale)
    return draw_on(axes, plan, panel, scale, marks)


def frame(axes: Axes, panel: Panel, scale: Scale, bar: Axes | None = None) -> None:
    """Draw a panel's colour bar, on axes of its own if there are any, and its title."""
    add_colour_bar(axes, scale, panel.label, bar)
    if panel.title:
        axes.set_title(literal(panel.title), fontsize=8.5, color=INK, pad=_ABOVE)


def scale_of(plan: Plan, panel: Panel) -> Scale:
    """Choose the bands of colours of a panel."""
    if not isinstance(panel.values, np.ndarray):
        return pressure_scale(plan, panel.values, panel.colours, panel.limits)
    limits = panel.limits or (float(panel.values.min()), float(panel.values.max()))
    return Scale.of(*limits, panel.colours)


def draw_on(axes: Axes, plan: Plan, panel: Panel, scale: Scale, marks: Iterable[SupportMark]) -> list[Entry]:
    """Draw what differs from result to result."""
    if isinstance(panel.values, np.ndarray):
        draw_field(axes, plan, checked_field(plan, panel.values), scale)
    else:
        draw_pressure(axes, plan, panel.values, scale)
    if panel.extremes:
        places = np.array([at for _, at in panel.extremes], dtype=float)
        ways = _ways(places, plan, inches_per_unit(axes))
        for (words, _), at, way in zip(panel.extremes, places, ways, strict=True):
            _name_place(axes, words, at, way)
    return [*draw_supports(marks, axes), *jumps(plan)]


def jumps(plan: Plan) -> list[Entry]:
    """Give the entry in the legend of the dashed lines inside the plate, if there are any."""
    if not np.size(plan.edges[2].vertices):
        return []
    return [("moments and shears jump", (Line2D([], [], color=INK, linewidth=0.7, linestyle="dashed"),))]


def _ways(places: NDArray[np.float64], plan: Plan, inches: float) -> NDArray[np.int64]:
    """To which side of its place (k, 2) each name goes: to the middle, or where names would meet above and below."""
    low, high = plan.window
    ways = np.where(places > (low + high) / 2, -1, 1)
    if (np.ptp(places, axis=0) * inches < _NAME).all():
        ways[:, 1] = np.where(np.arange(len(places)) == places[:, 1].argmax(), 1, -1)
        room = np.minimum(places - low, high - places)[:, 0] * inches
        ways[room >= 0.5 * _NAME[0], 0] = 0
    return np.asarray(ways, dtype=np.int64)


def _name_place(axes: Axes, words: str, at: NDArray[np.float64], way: NDArray[np.int64]) -> None:
    """Mark a place with a value, written on one side of it."""
    halo = [withStroke(linewidth=2.5, foreground="white")]
    axes.plot(*at, marker="+", color=INK, markersize=8, markeredgewidth=1.2, path_effects=halo, zorder=6)
    look: dict[str, Any] = {"fontsize": 8.5, "color": INK, "bbox": PAPER, "zorder": 7}
    look |= {"ha": ("center", "left", "right")[way[0]], "va": "bottom" if way[1] > 0 else "top"}
    axes.annotate(words, (at[0], at[1]), xytext=(7.0 * way[0], 7.0 * way[1]), textcoords="offset points", **look)
