"""Contact pressure of areas, which ends at their outlines and at the edge of contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import Collection
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation
from numpy.typing import ArrayLike, NDArray

from signorini.plot.field import add_colour_bar, colour_scale
from signorini.plot.plan import INK, checked_mesh, draw_outlines, draw_sheet, literal, plan_axes
from signorini.shapes.tessellation import Tessellation, tessellate

_ON_OUTLINE = 1e-9
"""Part of the plate's size within which a point is on an area's outline."""


@dataclass(frozen=True, eq=False)
class PressureLayer:
    """The pressure of one area.

    Attributes
    ----------
    cut : Tessellation
        Of the elements that the area is on.
    values : ndarray, shape (v,) or (e,)
        Pressures at the vertices, beyond ``bounds`` where there is a gap; or one an element.
    bounds : (float, float)
        What the area can exert at least and at most. Nothing is drawn beyond.
    outline : ndarray, shape (k, 2), or None
        Of the area; None where the elements end with it.
    """

    cut: Tessellation
    values: NDArray[np.float64]
    bounds: tuple[float, float]
    outline: NDArray[np.float64] | None = None

    @property
    def an_element(self) -> bool:
        """Whether there is one value an element."""
        return len(self.values) == len(self.cut.elements)

    def exerted(self, nodes: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the values that the area exerts, NaN out of its outline."""
        values = np.clip(self.values, *self.bounds)
        if self.an_element or self.outline is None:
            return values
        # Which sign of the radius takes in what is on the outline depends on the way that runs.
        path, slack = Path(self.outline), _ON_OUTLINE * float(np.ptp(nodes))
        vertices = self.cut.interpolate(nodes)
        within = path.contains_points(vertices, radius=slack) | path.contains_points(vertices, radius=-slack)
        return np.where(within, values, np.nan)

    def largest(self, nodes: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        """Return the largest of the values at vertices, and where it is."""
        values = np.nan_to_num(self.exerted(nodes), nan=-np.inf)
        at = int(values.argmax())
        return float(values[at]), self.cut.interpolate(nodes)[at]


def pressure(
    points: ArrayLike,
    elements: ArrayLike,
    layers: Sequence[PressureLayer],
    *,
    ax: Axes | None = None,
    label: str = "pressure",
    title: str = "",
    levels: int = 14,
) -> Axes:
    """Draw the contact pressure of areas, one over the other, on a plate that is pale where there is none.

    Parameters
    ----------
    points, elements, ax, label, title, levels
        As for :func:`signorini.plot.contour`.
    layers : sequence of PressureLayer

    Returns
    -------
    Axes

    Examples
    --------
    >>> nodes = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [2, 0.5], [1, 1], [0, 0.5]]
    >>> cut = tessellate(np.arange(8)[None])
    >>> soil = PressureLayer(cut, cut.interpolate(np.array(nodes))[:, 0] - 1, bounds=(0, np.inf))
    >>> axes = pressure(nodes, [range(8)], [soil], label="pressure [kPa]")
    >>> axes.collections[1].get_clim()
    (0.0, 1.0)
    """
    nodes, cells = checked_mesh(points, elements)
    axes = plan_axes(nodes, title) if ax is None else ax
    if ax is not None and title:
        axes.set_title(literal(title))
    whole = tessellate(cells)
    vertices = whole.interpolate(nodes)
    draw_sheet(axes, vertices, whole)
    exerted = [layer.exerted(nodes) for layer in layers]
    low = min((float(np.fmin.reduce(values, initial=0.0)) for values in exerted), default=0.0)
    high = max((float(np.fmax.reduce(values, initial=0.0)) for values in exerted), default=0.0)
    if low == high:
        high = 1.0
    limits = np.asarray(MaxNLocator(levels).tick_values(low, high))
    colours, norm = colour_scale(low, high, None)
    for layer in layers:
        _draw(axes, nodes, layer, limits, {"cmap": colours, "norm": norm})
    draw_outlines(axes, vertices, whole, inner=0.16)
    add_colour_bar(axes, ScalarMappable(norm, colours), label)
    return axes


def _draw(
    axes: Axes, nodes: NDArray[np.float64], layer: PressureLayer, limits: NDArray[np.float64], look: dict[str, Any]
) -> None:
    x, y = layer.cut.interpolate(nodes).T
    triangulation = Triangulation(x, y, layer.cut.triangles)
    drawn: list[Collection] = []
    if layer.an_element:
        values = np.repeat(layer.values, len(layer.cut.triangles) // len(layer.values))
        triangulation.set_mask(values == 0)
        drawn.append(axes.tripcolor(triangulation, facecolors=values, **look))
    elif np.clip(layer.values, *layer.bounds).any():
        levels = limits[(limits >= layer.bounds[0]) & (limits <= layer.bounds[1])]
        drawn.append(axes.tricontourf(triangulation, layer.values, levels=levels, **look))
        between = levels[(levels > layer.values.min()) & (levels < layer.values.max())]
        lines: dict[str, Any] = {"colors": INK, "linewidths": 0.35, "alpha": 0.45, "linestyles": "solid"}
        if len(between):
            drawn.append(axes.tricontour(triangulation, layer.values, levels=between, **lines))
    if layer.outline is not None:
        for part in drawn:
            part.set_clip_path(Path(layer.outline), axes.transData)
