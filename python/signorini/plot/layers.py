"""Contact pressure of areas, which ends at their outlines and at the edge of contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import Colormap, to_rgba
from matplotlib.path import Path
from numpy.typing import ArrayLike, NDArray

from signorini.plot.field import BANDS, Scale, add_colour_bar, label_contours
from signorini.plot.labels import Labels
from signorini.plot.picture import PressureLayer
from signorini.plot.plan import (
    INK,
    Plan,
    draw_outlines,
    draw_sheet,
    enclosed,
    literal,
    pieces,
    plan_axes,
    set_window,
    triangulation,
)

_ON_OUTLINE = 1e-9
"""Part of the plate's size within which a point is on an area's outline."""


def _exerted(layer: PressureLayer, nodes: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the values that an area exerts, NaN out of its outline."""
    values = np.clip(layer.values, *layer.bounds)
    if layer.an_element:
        return values
    return np.where(_within(layer, layer.cut.interpolate(nodes), float(np.ptp(nodes))), values, np.nan)


def _within(layer: PressureLayer, places: NDArray[np.float64], size: float) -> NDArray[np.bool_]:
    """Return which places are on an area, its outline included, of a plate of a size."""
    if layer.outline is None:
        return np.ones(len(places), np.bool_)
    # Which sign of the radius takes in what is on the outline depends on the way that runs.
    slack = _ON_OUTLINE * size
    (around, *holes), ways = map(Path, pieces(layer.outline)), (slack, -slack)
    within: NDArray[np.bool_] = np.any([around.contains_points(places, radius=way) for way in ways], axis=0)
    for hole in holes:
        within &= ~np.all([hole.contains_points(places, radius=way) for way in ways], axis=0)
    return within


def _range(layer: PressureLayer, nodes: NDArray[np.float64]) -> tuple[float, float]:
    """Return the smallest and the largest value of an area, or 0 beyond them."""
    values = _exerted(layer, nodes)
    if layer.largest is not None:
        values = np.append(values, layer.largest[0])
    return float(np.fmin.reduce(values, initial=0.0)), float(np.fmax.reduce(values, initial=0.0))


def pressure(
    points: ArrayLike,
    elements: ArrayLike,
    layers: Sequence[PressureLayer],
    *,
    ax: Axes | None = None,
    label: str = "pressure",
    title: str = "",
    levels: int = BANDS,
    cmap: str | Colormap = "PuOr",
    limits: tuple[float, float] | None = None,
) -> Axes:
    """Draw the contact pressure of areas, one over the other, on a plate that is pale where there is none.

    Parameters
    ----------
    points, elements, ax, label, title, levels, cmap, limits
        As for :func:`signorini.plot.contour`.
    layers : sequence of PressureLayer

    Returns
    -------
    Axes

    Examples
    --------
    >>> nodes = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [2, 0.5], [1, 1], [0, 0.5]]
    >>> from signorini.plot.picture import PressureLayer
    >>> from signorini.shapes.tessellation import tessellate
    >>> cut = tessellate(np.arange(8)[None])
    >>> soil = PressureLayer(cut, cut.interpolate(np.array(nodes))[:, 0] - 1, bounds=(0, np.inf))
    >>> axes = pressure(nodes, [range(8)], [soil], label="pressure [kPa]")
    >>> [round(float(end), 12) for end in axes.figure.axes[1].get_ylim()], axes.figure.axes[1].get_ylabel()
    ([0.0, 1.0], 'pressure [kPa]')
    """
    plan = Plan.of(points, elements)
    axes = plan_axes(plan, title) if ax is None else ax
    if ax is not None and title:
        axes.set_title(literal(title), wrap=True)
    scale = pressure_scale(plan, layers, cmap, limits, levels)
    set_window(axes, plan)
    draw_pressure(axes, plan, layers, scale, Labels(axes))
    add_colour_bar(axes, scale, label)
    return axes


def pressure_scale(
    plan: Plan,
    layers: Sequence[PressureLayer],
    cmap: str | Colormap,
    limits: tuple[float, float] | None,
    levels: int = BANDS,
) -> Scale:
    """Choose colours for pressures, from 0 on."""
    ranges = [limits] if limits is not None else [_range(layer, plan.nodes) for layer in layers]
    low, high = min((a for a, _ in ranges), default=0.0), max((b for _, b in ranges), default=0.0)
    return Scale.of(low, high if high > low else 1.0, cmap, levels)


def draw_pressure(axes: Axes, plan: Plan, layers: Sequence[PressureLayer], scale: Scale, labels: Labels) -> None:
    """Draw pressures on a pale plate, and the plate's outline."""
    draw_sheet(axes, plan)
    draw_outlines(axes, plan)
    for layer in layers:
        _draw(axes, plan.nodes, layer, scale, labels)


def _draw(axes: Axes, nodes: NDArray[np.float64], layer: PressureLayer, scale: Scale, labels: Labels) -> None:
    look: dict[str, Any] = {"cmap": scale.colours, "norm": scale.norm}
    triangles = triangulation(layer.cut, nodes)
    drawn: list[Artist] = []
    if layer.an_element:
        values = layer.values[layer.cut.parents]
        triangles.set_mask(values == 0)
        drawn.append(axes.tripcolor(triangles, facecolors=values, **look))
    elif np.clip(layer.values, *layer.bounds).any():
        levels = scale.bounds[(scale.bounds >= layer.bounds[0]) & (scale.bounds <= layer.bounds[1])]
        # Beyond the scale is its last colour, beyond the layer's bounds nothing.
        low, high = scale.clipped(np.array([-np.inf, np.inf]))
        within = layer.bounds[0] >= scale.bounds[0], layer.bounds[1] <= scale.bounds[-1]
        values = np.clip(layer.values, -np.inf if within[0] else low, np.inf if within[1] else high)
        drawn.append(axes.tricontourf(triangles, values, levels=levels, **look))
        drawn[-1].set(edgecolor=to_rgba(INK, 0.3), linewidth=0.3)
        before = len(axes.collections), len(axes.texts)
        size, shown = float(np.ptp(nodes)), np.clip(layer.values, levels[0], levels[-1])
        label_contours(axes, triangles, shown, levels, labels, lambda places: _within(layer, places, size))
        drawn += axes.collections[before[0] :]
        drawn += axes.texts[before[1] :]
    if layer.outline is not None:
        for part in drawn:
            part.set_clip_path(enclosed(layer.outline), axes.transData)
