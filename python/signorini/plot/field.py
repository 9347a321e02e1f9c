"""Contours of a nodal field, and curves along a section."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation
from numpy.typing import ArrayLike, NDArray

from signorini.errors import InputError
from signorini.plot.plan import INK, checked_mesh, draw_outlines, literal, plan_axes
from signorini.shapes.tessellation import tessellate

_NOISE = 1e-9


def contour(
    points: ArrayLike,
    elements: ArrayLike,
    values: ArrayLike,
    *,
    ax: Axes | None = None,
    label: str = "",
    title: str = "",
    levels: int | Sequence[float] = 14,
    cmap: str | Colormap | None = None,
) -> Axes:
    """Draw filled contours of a nodal field, following the elements' curved edges and shape functions.

    Parameters
    ----------
    points : array_like, shape (n, 2)
        Nodes.
    elements : array_like of int, shape (e, 8)
        Corners counter-clockwise, then midsides.
    values : array_like, shape (n,)
        The field at the nodes.
    ax : Axes, optional
        Where to draw; by default the axes of a new figure.
    label : str
        What the field is, with its unit: beside the colour bar.
    title : str
        Above the axes.
    levels : int or increasing sequence of float
        About how many bands, or their limits.
    cmap : str or Colormap, optional
        By default blue is positive, red is negative, and zero is pale.

    Returns
    -------
    Axes
        The axes drawn in; ``axes.figure`` is the figure.

    Raises
    ------
    InputError
        An array has another shape, or a value is not finite.

    Examples
    --------
    >>> nodes = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [2, 0.5], [1, 1], [0, 0.5]]
    >>> axes = contour(nodes, [range(8)], [0, 1, 1, 0, 0.3, 1, 0.3, 0], label="deflection [mm]")
    >>> axes.get_aspect()
    1.0
    """
    nodes, cells = checked_mesh(points, elements)
    field = np.asarray(values, dtype=float)
    if field.shape != (len(nodes),):
        raise InputError(f"The field has the shape {field.shape}; for these nodes it must be ({len(nodes)},).")
    if not np.isfinite(field).all():
        raise InputError(f"{np.count_nonzero(~np.isfinite(field))} of {len(field)} values of the field are not finite.")
    axes = plan_axes(nodes, title) if ax is None else ax
    if ax is not None and title:
        axes.set_title(literal(title))
    cut = tessellate(cells)
    x, y = cut.interpolate(nodes).T
    fine = cut.interpolate(field)

    low, high = _range(fine)
    limits = MaxNLocator(levels).tick_values(low, high) if isinstance(levels, int) else np.asarray(levels)
    colours, norm = colour_scale(low, high, cmap)
    triangulation = Triangulation(x, y, cut.triangles)
    fine = np.clip(fine, low, high)
    bands = axes.tricontourf(triangulation, fine, levels=limits, cmap=colours, norm=norm)
    axes.tricontour(triangulation, fine, levels=limits, colors=INK, linewidths=0.35, alpha=0.45, linestyles="solid")
    if low < 0 < high:
        axes.tricontour(triangulation, fine, levels=[0.0], colors=INK, linewidths=1.1, linestyles="solid")
    draw_outlines(axes, np.column_stack([x, y]), cut, inner=0.16)
    add_colour_bar(axes, bands, label)
    return axes


def line(
    x: ArrayLike,
    y: ArrayLike,
    *,
    ax: Axes | None = None,
    label: str = "",
    xlabel: str = "",
    ylabel: str = "",
    title: str = "",
    down: bool = True,
) -> Axes:
    """Draw a quantity along a section or a load path.

    Parameters
    ----------
    x, y : array_like, shape (k,)
    ax : Axes, optional
        Give the axes of an earlier call to draw several curves together.
    label : str
        The curve's name in the legend.
    xlabel, ylabel, title : str
    down : bool
        Whether positive values are drawn downwards, as deflections are.

    Returns
    -------
    Axes

    Examples
    --------
    >>> axes = line([0, 1, 2], [0, 1e-3, 0], ylabel="deflection [m]")
    >>> bool(axes.yaxis_inverted())
    True
    """
    axes = Figure(figsize=(7, 3.6), layout="constrained").add_subplot() if ax is None else ax
    axes.plot(np.asarray(x, dtype=float), np.asarray(y, dtype=float), label=label or "_curve", linewidth=1.6)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(alpha=0.25)
    axes.yaxis.set_inverted(down)
    axes.set_xlabel(xlabel or axes.get_xlabel())
    axes.set_ylabel(ylabel or axes.get_ylabel())
    axes.set_title(title or axes.get_title())
    if axes.get_legend_handles_labels()[1]:
        axes.legend(frameon=False)
    return axes


def add_colour_bar(axes: Axes, colours: ScalarMappable, label: str) -> None:
    """Put the scale of the colours beside the axes."""
    figure = axes.get_figure(root=True)
    if figure is not None:
        bar = figure.colorbar(colours, ax=axes, shrink=0.92, aspect=28, pad=0.025)
        bar.set_label(literal(label), fontsize=9)
        bar.outline.set_visible(False)
        bar.formatter.set_powerlimits((-3, 4))  # type: ignore[attr-defined]
        bar.ax.tick_params(length=2.5, labelsize=8.5)
        bar.update_ticks()


def _range(values: NDArray[np.float64]) -> tuple[float, float]:
    """Take the range of a field, without what is only rounding on the other side of zero, and never empty."""
    low, high = float(values.min()), float(values.max())
    largest = max(abs(low), abs(high))
    if abs(low) < _NOISE * largest:
        low = 0.0
    if abs(high) < _NOISE * largest:
        high = 0.0
    if high - low <= _NOISE * largest:
        half = 0.01 * largest or 1.0
        return low - half, high + half
    return low, high


def colour_scale(low: float, high: float, cmap: str | Colormap | None) -> tuple[Colormap, Normalize]:
    """Choose colours: diverging about zero where both signs occur, else from pale at the end nearer to zero."""
    largest = max(abs(low), abs(high))
    both = low < 0 < high
    name = "RdBu" if both else "YlGnBu" if high > 0 else "YlOrRd_r"
    colours = colormaps[name] if cmap is None else colormaps[cmap] if isinstance(cmap, str) else cmap
    return colours, Normalize(-largest, largest) if both else Normalize(low, high)
