"""Whole figures, and how they reach a file."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from numpy.typing import ArrayLike, NDArray

from signorini.base.files import replacing
from signorini.plot.balance import BalanceMark, draw_balances
from signorini.plot.field import contour
from signorini.plot.marks import Entry, LoadMark, SupportMark, draw_legend, draw_load, draw_supports
from signorini.plot.plan import INK, checked_mesh, draw_outlines, draw_sheet, literal, plan_axes
from signorini.plot.pressure import PressureLayer, pressure
from signorini.shapes.tessellation import tessellate

DRAWN_BY = "signorini"
"""What the metadata of pictures name as the program that drew them."""


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
        _name_place(axes, name, float(field[node]), nodes[node], centre)
    return _finished(axes, draw_supports(marks, axes), length)


def pressure_picture(
    points: ArrayLike,
    elements: ArrayLike,
    layers: Sequence[PressureLayer],
    marks: Iterable[SupportMark] = (),
    *,
    title: str = "",
    label: str = "contact pressure, positive up",
    length: str = "",
) -> Figure:
    """Draw the contact pressure of areas, the edge of contact and the other supports.

    The largest value is named where the pressure is a field, not a number an element.

    Parameters
    ----------
    points, elements, layers
        As for :func:`signorini.plot.pressure`.
    marks : iterable of SupportMark
        Of areas only the edge of contact is drawn.
    title, label : str
    length : str
        The unit of length, for the two axes.

    Returns
    -------
    Figure
    """
    axes = pressure(points, elements, layers, label=label, title=title)
    nodes = np.asarray(points, dtype=float)
    fields = [] if any(layer.an_element for layer in layers) else [layer.largest(nodes) for layer in layers]
    largest = max(fields, key=lambda found: found[0], default=None)
    if largest is not None and largest[0] > 0:
        _name_place(axes, "max", *largest, (nodes.min(axis=0) + nodes.max(axis=0)) / 2)
    return _finished(axes, draw_supports(marks, axes, areas=False), length)


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
    draw_sheet(axes, vertices, cut)
    draw_outlines(axes, vertices, cut, inner=0.3)
    entries = draw_supports(supports, axes) + [draw_load(mark, axes) for mark in loads]
    return _finished(axes, entries + draw_balances(balance, axes), length)


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure to a file, whole or not at all; the suffix (``.png``, ``.svg``, ``.pdf``) gives the format.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with replacing(path) as beside:
        key = "Software" if beside.suffix.lower() == ".png" else "Creator"
        figure.savefig(beside, dpi=160, bbox_inches="tight", pad_inches=0.12, metadata={key: DRAWN_BY})


def _name_place(axes: Axes, name: str, value: float, at: NDArray[np.float64], centre: NDArray[np.float64]) -> None:
    """Mark a place with a value, written on the side of the centre."""
    inward = np.where(at > centre, -1, 1)
    halo = [withStroke(linewidth=2.5, foreground="white")]
    axes.plot(*at, marker="+", color=INK, markersize=8, markeredgewidth=1.2, path_effects=halo, zorder=6)
    axes.annotate(
        f"{name} {value:.4g}".replace("-", "−"),
        (at[0], at[1]),
        xytext=(float(9 * inward[0]), float(9 * inward[1])),
        textcoords="offset points",
        ha="left" if inward[0] > 0 else "right",
        va="bottom" if inward[1] > 0 else "top",
        fontsize=8.5,
        color=INK,
        path_effects=halo,
        zorder=7,
    )


def _finished(axes: Axes, entries: list[Entry], length: str) -> Figure:
    """Name the axes, add the legend and make room for it."""
    unit = literal(f" [{length}]" if length else "")
    axes.set_xlabel(f"x{unit}", fontsize=9)
    axes.set_ylabel(f"y{unit}", fontsize=9)
    draw_legend(axes, entries)
    figure = axes.get_figure(root=True)
    assert figure is not None, "the axes were made with their figure"
    figure.set_figheight(figure.get_figheight() + 0.19 * len(entries))
    return figure
