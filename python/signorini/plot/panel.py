"""One field on a plan: its colours, its extremes, and the supports."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes as Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from signorini.plot.field import Scale, add_colour_bar, checked_field, draw_field
from signorini.plot.labels import Labels
from signorini.plot.layers import draw_pressure, pressure_scale
from signorini.plot.marks import LARGEST, Entry, draw_supports
from signorini.plot.picture import Panel, SupportMark
from signorini.plot.plan import HATCHED, INK, Plan, literal, set_window

_ABOVE = 18.0
"""Points from a plan to its title: the name of an extreme at the upper edge is between them."""


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
    labels, marks = Labels(axes), list(marks)
    for mark in marks:
        if mark.style == "points" and len(mark.positions):
            labels.keep_free(mark.positions, LARGEST)
        for line in mark.boundary:
            labels.keep_free(line, 4.0)
    if panel.extremes:
        places = np.array([at for _, at in panel.extremes], dtype=float)
        labels.keep_free(places, LARGEST)
        for colour, width in (("white", 3.5), (INK, 1.2)):
            axes.plot(*places.T, "+", color=colour, markersize=6.8 + width, markeredgewidth=width, zorder=6)
        for (words, _), at in zip(panel.extremes, places, strict=True):
            labels.beside(words, at, 8.5)
    if isinstance(panel.values, np.ndarray):
        draw_field(axes, plan, checked_field(plan, panel.values), scale, labels)
    else:
        draw_pressure(axes, plan, panel.values, scale, labels)
    return [*draw_supports(marks, axes), *remarks(plan)]


def remarks(plan: Plan) -> list[Entry]:
    """Give the entries in the legend of dashed lines inside the plate and of what is hatched, if there are any."""
    dashed = Line2D([], [], color=INK, linewidth=0.7, linestyle="dashed")
    result: list[Entry] = [("moments and shears jump", (dashed,))] * bool(np.size(plan.edges[2].vertices))
    if plan.left_out is not None and plan.left_out.any():
        result.append(("left out of the extremes", (Patch(**HATCHED),)))
    return result
