"""Whole figures, and how they reach a file."""

from __future__ import annotations

import os
from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.tri import Triangulation
from numpy.typing import ArrayLike

from signorini.files import replacing
from signorini.plot.balance import BalanceMark, draw_balance
from signorini.plot.field import contour
from signorini.plot.marks import Entry, LoadMark, SupportMark, draw_legend, draw_load, draw_support
from signorini.plot.plan import INK, checked_mesh, draw_outlines, plan_axes
from signorini.plot.tessellation import tessellate

_SHEET = "#eef2f5"


def deflection_picture(
    points: ArrayLike,
    elements: ArrayLike,
    deflection: ArrayLike,
    marks: Iterable[SupportMark] = (),
    *,
    title: str = "",
    label: str = "deflection, positive down",
    length: str = "",
) -> Figure:
    """Draw the deflection with its extremes, and the supports open or closed, as one figure.

    Parameters
    ----------
    points, elements, deflection
        As for :func:`contour`.
    marks : iterable of SupportMark
    title, label : str
    length : str
        The unit of length, for the two axes.

    Returns
    -------
    Figure
    """
    axes = contour(points, elements, deflection, label=label, title=title)
    nodes, field = np.asarray(points, dtype=float), np.asarray(deflection, dtype=float)
    centre = (nodes.min(axis=0) + nodes.max(axis=0)) / 2
    for name, node in [("max", int(field.argmax())), ("min", int(field.argmin()))]:
        inward = np.where(nodes[node] > centre, -1, 1)
        halo = [withStroke(linewidth=2.5, foreground="white")]
        axes.plot(*nodes[node], marker="+", color=INK, markersize=8, markeredgewidth=1.2, path_effects=halo, zorder=6)
        axes.annotate(
            f"{name} {field[node]:.4g}".replace("-", "−"),
            (nodes[node, 0], nodes[node, 1]),
            xytext=(float(9 * inward[0]), float(9 * inward[1])),
            textcoords="offset points",
            ha="left" if inward[0] > 0 else "right",
            va="bottom" if inward[1] > 0 else "top",
            fontsize=8.5,
            color=INK,
            path_effects=halo,
            zorder=7,
        )
    return _finished(axes, [draw_support(mark, axes) for mark in marks], length)


def check_picture(
    points: ArrayLike,
    elements: ArrayLike,
    *,
    supports: Iterable[SupportMark] = (),
    loads: Iterable[LoadMark] = (),
    balance: Iterable[BalanceMark] = (),
    title: str = "",
    length: str = "",
) -> Figure:
    """Draw a model before it is solved: mesh, supports and loads, and what the loads amount to.

    Parameters
    ----------
    points, elements
        As for :func:`contour`.
    supports : iterable of SupportMark
    loads : iterable of LoadMark
    balance : iterable of BalanceMark
    title : str
    length : str
        The unit of length, for the two axes.

    Returns
    -------
    Figure
    """
    nodes, cells = checked_mesh(points, elements)
    axes = plan_axes(nodes, title)
    cut = tessellate(cells)
    vertices = cut.interpolate(nodes)
    sheet = Triangulation(vertices[:, 0], vertices[:, 1], cut.triangles)
    axes.tricontourf(sheet, np.zeros(len(vertices)), levels=[-1, 1], colors=[_SHEET])
    draw_outlines(axes, vertices, cut, inner=0.3)
    held = [draw_support(mark, axes) for mark in supports]
    entries = held + [draw_load(mark, axes) for mark in loads]
    for mark in balance:
        entries += draw_balance(mark, axes)
    return _finished(axes, entries, length)


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure to a file, whole or not at all; the suffix (``.png``, ``.svg``, ``.pdf``) gives the format.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with replacing(path) as beside:
        figure.savefig(beside, dpi=160, bbox_inches="tight", pad_inches=0.12)


def _finished(axes: Axes, entries: list[Entry], length: str) -> Figure:
    """Name the axes, add the legend and make room for it."""
    unit = f" [{length}]" if length else ""
    axes.set_xlabel(f"x{unit}", fontsize=9)
    axes.set_ylabel(f"y{unit}", fontsize=9)
    draw_legend(axes, entries)
    figure = axes.get_figure(root=True)
    assert figure is not None, "the axes were made with their figure"
    figure.set_figheight(figure.get_figheight() + 0.19 * len(entries))
    return figure
