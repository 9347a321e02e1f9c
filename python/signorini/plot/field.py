"""Contours of a nodal field, and curves along a section."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, Colormap, ListedColormap, Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from matplotlib.tri import Triangulation
from numpy.typing import ArrayLike, NDArray

from signorini.base.plain import POWERS, plain
from signorini.errors import InputError
from signorini.plot.labels import Labels
from signorini.plot.plan import INK, Plan, draw_outlines, literal, plan_axes, put_label, set_window

_NOISE = 1e-9
BANDS = 14
_STEPS = (1, 1.5, 2, 2.5, 3, 4, 5, 10)
"""Of bands, in powers of ten: their limits have few digits."""
_MOST_LABELS = 7
"""Contours, about, that have their value written on them."""
_SHORTEST = 50.0
"""Points that a contour is long at least that has its value."""
_PARTS = np.array([0.5, 0.3, 0.7, 0.15, 0.85])
"""Of a contour, where its value may stand."""


def contour(
    points: ArrayLike,
    elements: ArrayLike,
    values: ArrayLike,
    *,
    ax: Axes | None = None,
    label: str = "",
    title: str = "",
    levels: int | Sequence[float] = BANDS,
    cmap: str | Colormap = "RdBu",
    limits: tuple[float, float] | None = None,
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
    cmap : str or Colormap
        Its middle is zero: by default blue is positive, red is negative, and zero is pale. A field of one sign has its
        half alone.
    limits : (low, high), optional
        Range of the colours and levels, of several pictures that are to be compared; by default that of the field.

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
    plan = Plan.of(points, elements)
    axes = plan_axes(plan, title) if ax is None else ax
    if ax is not None and title:
        axes.set_title(literal(title), wrap=True)
    field = checked_field(plan, values)
    scale = Scale.of(*(limits or (float(field.min()), float(field.max()))), cmap, levels)
    set_window(axes, plan)
    draw_field(axes, plan, field, scale, Labels(axes))
    add_colour_bar(axes, scale, label)
    return axes


@dataclass(frozen=True, eq=False)
class Scale:
    """Bands of colours.

    Attributes
    ----------
    bounds : ndarray, shape (k + 1,)
    colours : Colormap
    norm : Normalize
        From values to colours, not banded.
    """

    bounds: NDArray[np.float64]
    colours: Colormap
    norm: Normalize

    @classmethod
    def of(cls, low: float, high: float, cmap: str | Colormap, levels: int | Sequence[float] = BANDS) -> Self:
        """Choose bands, and colours: zero in the middle where both signs occur, else half of them, pale near zero."""
        bounds = np.asarray(levels, float)
        if isinstance(levels, int):
            bounds = np.asarray(MaxNLocator(levels, steps=_STEPS).tick_values(*_settled(low, high)))
        colours, (low, high) = colormaps[cmap] if isinstance(cmap, str) else cmap, bounds[[0, -1]].tolist()
        if low < 0 < high:
            largest = max(-low, high)
            return cls(bounds, colours, Normalize(-largest, largest))
        norm = Normalize(2 * low - high, high) if high > 0 else Normalize(low, 2 * high - low)
        return cls(bounds, colours, norm)

    def clipped(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Give what lies beyond the scale its last colour."""
        low, high = self.bounds[[0, -1]]
        # The upper end itself is in no band.
        return np.clip(values, low, high - _NOISE * (high - low))

    @property
    def bar(self) -> ScalarMappable:
        """What a colour bar shows: the bands."""
        shown = self.colours(self.norm(0.5 * (self.bounds[1:] + self.bounds[:-1])))
        return ScalarMappable(BoundaryNorm(self.bounds, len(shown)), ListedColormap(shown))


def checked_field(plan: Plan, values: ArrayLike) -> NDArray[np.float64]:
    """Check that there is a number at every node."""
    field = np.asarray(values, dtype=float)
    if field.shape != (len(plan.nodes),):
        raise InputError(f"The field has the shape {field.shape}; for these nodes it must be ({len(plan.nodes)},).")
    if not np.isfinite(field).all():
        raise InputError(f"{np.count_nonzero(~np.isfinite(field))} of {len(field)} values of the field are not finite.")
    return field


def draw_field(axes: Axes, plan: Plan, field: NDArray[np.float64], scale: Scale, labels: Labels) -> None:
    """Draw filled contours, some of them with their values, and the plate's outline."""
    fine = scale.clipped(plan.cut.interpolate(field))
    draw_outlines(axes, plan)
    bands = axes.tricontourf(plan.triangles, fine, levels=scale.bounds, cmap=scale.colours, norm=scale.norm)
    bands.set(edgecolor=to_rgba(INK, 0.3), linewidth=0.3)
    label_contours(axes, plan.triangles, fine, scale.bounds, labels)


def label_contours(
    axes: Axes,
    triangles: Triangulation,
    values: NDArray[np.float64],
    bounds: NDArray[np.float64],
    labels: Labels,
    within: Callable[[NDArray[np.float64]], NDArray[np.bool_]] | None = None,
) -> None:
    """Draw some of the contours stronger, each with its value at a place that is within; zero strongest."""
    every = -(-len(bounds) // _MOST_LABELS)
    zero = int(np.abs(bounds).argmin())
    chosen = [float(level) for i, level in enumerate(bounds) if (i - zero) % every == 0]
    chosen = [level for level in chosen if values.min() < level < values.max()]
    if not chosen:
        return
    nothing = 1e-12 * float(np.abs(bounds).max())
    widths = [0.9 if abs(level) <= nothing else 0.6 for level in chosen]
    lines = axes.tricontour(triangles, values, levels=chosen, colors=INK, linewidths=widths, linestyles="solid")
    step = float(np.diff(bounds).min())
    for level, path in zip(chosen, lines.get_paths(), strict=True):
        pieces = [piece for piece in map(np.asarray, path.to_polygons(closed_only=False)) if len(piece) > 1]
        longest = max(pieces, key=lambda piece: float(np.hypot(*np.diff(piece, axis=0).T).sum()), default=None)
        if longest is None:
            continue
        along = np.append(0.0, np.hypot(*np.diff(longest, axis=0).T).cumsum()) * labels.scale
        before, places, after = (
            np.column_stack([np.interp(_PARTS * along[-1] + way, along, side) for side in longest.T])
            for way in (-9.0, 0.0, 9.0)
        )
        kept = np.ones(len(places), np.bool_) if within is None else within(places)
        if along[-1] > _SHORTEST and kept.any():
            turns = (np.degrees(np.arctan2(*(after - before)[kept].T[::-1])) + 90) % 180 - 90
            labels.along(in_words(level, step), places[kept], turns.tolist(), 7, zorder=3)


def in_words(level: float, step: float) -> str:
    """Write a level as short as its distance to the next one allows.

    Examples
    --------
    >>> in_words(0.0015, 0.0005), in_words(-20.0, 10.0), in_words(7500, 2500), in_words(2.5e6, 5e5), in_words(-1e-19, 1)
    ('0.0015', '−20', '7500', '2.5e6', '0')
    """
    if abs(level) < 1e-9 * step:
        return "0"
    # Steps of 2.5 have two digits, and five of them three.
    digits = max(0, int(np.floor(np.log10(abs(level) / step) + 1e-9))) + 3
    return plain(level, digits)


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


def add_colour_bar(axes: Axes, scale: Scale, label: str, beside: Axes | None = None) -> None:
    """Put the scale of the colours beside the axes, or into axes of its own."""
    figure = axes.get_figure(root=True)
    if figure is not None:
        room: dict[str, Any] = {"cax": beside} if beside is not None else {"shrink": 0.92, "aspect": 28, "pad": 0.025}
        bar = figure.colorbar(scale.bar, ax=axes, spacing="proportional", **room)
        bar.set_label(literal(label), fontsize=9)
        put_label(bar.ax.yaxis, 1.0, 0.5, 0.58, 0.0)
        bar.outline.set_visible(False)
        bar.formatter = ScalarFormatter()
        bar.formatter.set_powerlimits(POWERS)
        bar.minorticks_off()
        bar.ax.tick_params(length=2.5, labelsize=8.5)
        bar.update_ticks()


def _settled(low: float, high: float) -> tuple[float, float]:
    """Take a range without what is only rounding on the other side of zero, and never empty."""
    largest = max(abs(low), abs(high))
    if abs(low) < _NOISE * largest:
        low = 0.0
    if abs(high) < _NOISE * largest:
        high = 0.0
    if high - low <= _NOISE * largest:
        half = 0.01 * largest or 1.0
        return low - half, high + half
    return low, high
