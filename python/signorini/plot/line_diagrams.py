"""Diagrams of reactions per length, drawn along line supports on the plan of a plate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from signorini.plot.marks import LARGEST, Entry, draw_supports
from signorini.plot.page import Page
from signorini.plot.picture import LineDiagram, Picture
from signorini.plot.plan import INK, Labels, Plan, draw_outlines, draw_sheet
from signorini.shapes.arrays import Floats

_UP, _DOWN = "#1f78b4", "#d7301f"
_LARGEST = 0.14
"""Length of the largest ordinate of a diagram, relative to the plate's size."""


def line_diagrams(plan: Plan, picture: Picture, largest: float, length: str) -> Figure:
    """Draw the plate, its supports, and the reactions per length of line supports.

    ``largest``, the largest reaction per length of all pictures, sets the scale.
    """
    scale = _LARGEST * float(np.ptp(plan.nodes, axis=0).max()) / (largest or 1.0)
    tips = [_tips(diagram, values, scale) for diagram in picture.diagrams for values in diagram.values]
    page = Page(replace(plan, beside=np.concatenate(tips)), 1, length, bars=False)
    (axes,) = page.plans
    draw_sheet(axes, plan)
    draw_outlines(axes, plan, hatched=False)
    entries = draw_supports(picture.marks, axes)
    labels = Labels(axes)
    for diagram in picture.diagrams:
        for values in diagram.values:
            _draw(axes, diagram, values, scale)
            labels.keep_free(_tips(diagram, values, scale), 4.0)
        if len(diagram.corners):
            axes.plot(*diagram.corners.T, "s", color=INK, markersize=4.5, zorder=6)
            labels.keep_free(diagram.corners, LARGEST)
    for diagram in picture.diagrams:
        for words, station, value in diagram.words:
            tip = diagram.positions[station] + scale * value * diagram.normals[station]
            labels.beside(words, tip, 8.0, color=_DOWN if value < 0.0 else _UP)
        for words, corner in zip(diagram.corner_words, diagram.corners, strict=True):
            if words:
                labels.beside(words, corner, 8.0)
    page.finish(picture.title, [*entries, *_legend(picture.diagrams)])
    return page.figure


def _tips(diagram: LineDiagram, values: Floats, scale: float) -> Floats:
    return np.asarray(diagram.positions + scale * values[:, None] * diagram.normals)


def _draw(axes: Axes, diagram: LineDiagram, values: Floats, scale: float) -> None:
    """Draw the ordinates (k,) of each connected run of stations; positive reactions are to the right of the line."""
    tips, firsts = _tips(diagram, values, scale), np.flatnonzero(diagram.begins).tolist()
    for first, last in pairwise([*firsts, len(values)]):
        run = slice(first, last)
        for sign, colour in ((1.0, _UP), (-1.0, _DOWN)):
            line, end = _of_sign(diagram.positions[run], tips[run], sign * values[run])
            fill: dict[str, Any] = {"facecolor": to_rgba(colour, 0.25), "edgecolor": colour, "linewidth": 0.9}
            axes.add_patch(Polygon(np.concatenate([line, end[::-1]]), closed=True, zorder=3.5, **fill))


def _of_sign(line: Floats, tips: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Base points and tips of the positive ordinates ``values`` (k,).

    Negative ordinates are drawn with length zero. Between stations of opposite sign a point of value zero is inserted.
    """
    begin, end = values[:-1], values[1:]
    (crossed,) = np.nonzero(begin * end < 0.0)
    part = (begin[crossed] / (begin[crossed] - end[crossed]))[:, None]
    zeros = line[crossed] + part * (line[crossed + 1] - line[crossed])
    tips = np.where((values > 0.0)[:, None], tips, line)
    return np.insert(line, crossed + 1, zeros, axis=0), np.insert(tips, crossed + 1, zeros, axis=0)


def _legend(diagrams: Sequence[LineDiagram]) -> list[Entry]:
    per_length, force = diagrams[0].units
    values = np.concatenate([diagram.values.ravel() for diagram in diagrams])
    entries: list[Entry] = []
    for colour, words, present in ((_UP, "pushes the plate up", values > 0.0), (_DOWN, "holds it down", values < 0.0)):
        if present.any():
            patch = Patch(facecolor=to_rgba(colour, 0.25), edgecolor=colour)
            entries.append((f"reaction per length{per_length}: {words}", (patch,)))
    if any(len(diagram.corners) for diagram in diagrams):
        square = Line2D([], [], marker="s", color=INK, linestyle="none", markersize=4.5)
        entries.append((f"concentrated force{force}", (square,)))
    return entries
