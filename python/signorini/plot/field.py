"""Filled contours of nodal fields and of contact pressures, with labels and colour bars."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, Colormap, ListedColormap, Normalize, to_rgba
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator, ScalarFormatter
from matplotlib.tri import Triangulation
from numpy.typing import NDArray

from signorini.base.numbers import POWERS, plain
from signorini.plot.picture import Panel, PressureLayer
from signorini.plot.plan import (
    INK,
    LABEL_SIZE,
    Labels,
    Plan,
    draw_outlines,
    draw_sheet,
    enclosed,
    figure_of,
    literal,
    pieces,
    put_label,
    text_width,
    triangulation,
)
from signorini.shapes.arrays import Floats

_NOISE = 1e-9
_TINT = 0.3
"""Difference of the palest colour of a pressure from white, as a fraction of the colour range."""
_BANDS = 14
_STEPS = (1, 1.5, 2, 2.5, 3, 4, 5, 10)
"""Allowed widths of colour bands, apart from a power of ten: their limits then have few digits."""
_MAX_LABELS = 7
"""Approximate number of contour levels with a label."""
_SHORTEST = 50.0
"""Smallest length of a contour that gets a label [points]."""
_PARTS = np.array([0.5, 0.3, 0.7, 0.15, 0.85])
"""Candidate positions of a contour's label, as fractions of the contour's length."""
_ON_OUTLINE = 1e-9
"""Largest distance from an outline of a point that counts as on the outline, relative to the plate's size."""
_NUMBERS = 8.5
"""Font size of the numbers of a colour bar [points]."""
_LEAST_AWAY, _BESIDE = 0.45, 0.15
"""Least distance of a colour bar's label from the bar, and space for ticks and gaps beside the numbers [inches]."""
_EDGE: dict[str, Any] = {"edgecolor": to_rgba(INK, 0.3), "linewidth": 0.3}


@dataclass(frozen=True, eq=False)
class Scale:
    """Colour bands: limits (k + 1,) of k bands, the colour map, and the normalisation of values to the map."""

    bounds: Floats
    colours: Colormap
    norm: Normalize

    @classmethod
    def of(cls, panel: Panel) -> Self:
        """Choose bands and colours: with both signs, zero has the middle colour; one sign uses half of the map."""
        low, high = panel.limits
        if not isinstance(panel.values, np.ndarray) and high <= low:
            high = 1.0
        bounds = np.asarray(MaxNLocator(_BANDS, steps=_STEPS).tick_values(*_settled(low, high)))
        low, high = bounds[[0, -1]].tolist()
        if low < 0 < high:
            norm = Normalize(-max(-low, high), max(-low, high))
        else:
            # The colour of the smallest pressure must differ from white, the colour of places with zero pressure.
            more = (high - low) * (1.0 if isinstance(panel.values, np.ndarray) else 1.0 + _TINT)
            norm = Normalize(low - more, high) if high > 0 else Normalize(low, high + more)
        return cls(bounds, colormaps[panel.colours], norm)

    def clipped(self, values: Floats) -> Floats:
        """Clip values (n,) to the range of the bands."""
        low, high = self.bounds[[0, -1]]
        # A value equal to the upper limit would be in no band.
        return np.clip(values, low, high - _NOISE * (high - low))

    @property
    def bar(self) -> ScalarMappable:
        """The colours and limits of the bands, as matplotlib needs them for a colour bar."""
        shown = self.colours(self.norm(0.5 * (self.bounds[1:] + self.bounds[:-1])))
        return ScalarMappable(BoundaryNorm(self.bounds, len(shown)), ListedColormap(shown))


def _settled(low: float, high: float) -> tuple[float, float]:
    """Widen an empty range of values, and set an end within rounding of zero to zero."""
    largest = max(abs(low), abs(high))
    low, high = (0.0 if abs(end) < _NOISE * largest else end for end in (low, high))
    if high - low <= _NOISE * largest:
        half = 0.01 * largest or 1.0
        return low - half, high + half
    return low, high


def draw_field(axes: Axes, plan: Plan, field: Floats, scale: Scale, labels: Labels) -> None:
    """Draw filled contours of nodal values (n,), labels of some contours, and the plate's outline."""
    fine = scale.clipped(plan.cut.interpolate(field))
    draw_outlines(axes, plan)
    bands = axes.tricontourf(plan.triangles, fine, levels=scale.bounds, cmap=scale.colours, norm=scale.norm)
    bands.set(**_EDGE)
    _label_contours(axes, plan.triangles, fine, scale.bounds, labels)


def draw_pressure(axes: Axes, plan: Plan, layers: Sequence[PressureLayer], scale: Scale, labels: Labels) -> None:
    """Draw the pressures of areas and the plate's outline; places with zero pressure are white."""
    draw_sheet(axes, plan, "white")
    draw_outlines(axes, plan, hatched=False)
    for layer in layers:
        drawn = _draw_layer(axes, plan.nodes, layer, scale, labels)
        if layer.outline is not None:
            for part in drawn:
                part.set_clip_path(enclosed(layer.outline), axes.transData)


def _draw_layer(axes: Axes, nodes: Floats, layer: PressureLayer, scale: Scale, labels: Labels) -> list[Artist]:
    look: dict[str, Any] = {"cmap": scale.colours, "norm": scale.norm}
    triangles = triangulation(layer.cut, nodes)
    if layer.an_element:
        values = layer.values[layer.cut.parents]
        triangles.set_mask(values == 0)
        return [axes.tripcolor(triangles, facecolors=values, **look)]
    if not np.clip(layer.values, *layer.bounds).any():
        return []
    levels = scale.bounds[(scale.bounds >= layer.bounds[0]) & (scale.bounds <= layer.bounds[1])]
    # Values outside the colour scale have its first or last colour; values outside the layer's bounds are not drawn.
    low, high = scale.clipped(np.array([-np.inf, np.inf]))
    within = layer.bounds[0] >= scale.bounds[0], layer.bounds[1] <= scale.bounds[-1]
    values = np.clip(layer.values, -np.inf if within[0] else low, np.inf if within[1] else high)
    bands = axes.tricontourf(triangles, values, levels=levels, **look)
    bands.set(**_EDGE)
    before = len(axes.collections), len(axes.texts)
    size, shown = float(np.ptp(nodes)), np.clip(layer.values, levels[0], levels[-1])
    _label_contours(axes, triangles, shown, levels, labels, lambda places: _within(layer, places, size))
    return [bands, *axes.collections[before[0] :], *axes.texts[before[1] :]]


def _within(layer: PressureLayer, places: Floats, size: float) -> NDArray[np.bool_]:
    """Mask (k,) of the points (k, 2) in a layer's outline or on it; ``size`` is the plate's size."""
    if layer.outline is None:
        return np.ones(len(places), np.bool_)
    # The sign of ``radius`` that includes points on the outline depends on the outline's orientation, so try both.
    tolerance = _ON_OUTLINE * size
    (outer, *holes), radii = map(Path, pieces(layer.outline)), (tolerance, -tolerance)
    within: NDArray[np.bool_] = np.any([outer.contains_points(places, radius=radius) for radius in radii], axis=0)
    for hole in holes:
        within &= ~np.all([hole.contains_points(places, radius=radius) for radius in radii], axis=0)
    return within


def _label_contours(
    axes: Axes,
    triangles: Triangulation,
    values: Floats,
    bounds: Floats,
    labels: Labels,
    within: Callable[[Floats], NDArray[np.bool_]] | None = None,
) -> None:
    """Draw some contours as lines and write their values where ``within`` is True; the line of zero is the widest."""
    every = -(-len(bounds) // _MAX_LABELS)
    zero = int(np.abs(bounds).argmin())
    chosen = [float(level) for i, level in enumerate(bounds) if (i - zero) % every == 0]
    chosen = [level for level in chosen if values.min() < level < values.max()]
    if not chosen:
        return
    rounding = 1e-12 * float(np.abs(bounds).max())
    widths = [0.9 if abs(level) <= rounding else 0.6 for level in chosen]
    lines = axes.tricontour(triangles, values, levels=chosen, colors=INK, linewidths=widths, linestyles="solid")
    step = float(np.diff(bounds).min())
    for level, path in zip(chosen, lines.get_paths(), strict=True):
        parts = [part for part in map(np.asarray, path.to_polygons(closed_only=False)) if len(part) > 1]
        longest = max(parts, key=lambda part: float(np.hypot(*np.diff(part, axis=0).T).sum()), default=None)
        if longest is None:
            continue
        along = np.append(0.0, np.hypot(*np.diff(longest, axis=0).T).cumsum()) * labels.scale
        before, places, after = (
            np.column_stack([np.interp(_PARTS * along[-1] + shift, along, axis) for axis in longest.T])
            for shift in (-9.0, 0.0, 9.0)
        )
        kept = np.ones(len(places), np.bool_) if within is None else within(places)
        if along[-1] > _SHORTEST and kept.any():
            turns = (np.degrees(np.arctan2(*(after - before)[kept].T[::-1])) + 90) % 180 - 90
            labels.along(_in_words(level, step), places[kept], turns.tolist(), 7, zorder=3)


def _in_words(level: float, step: float) -> str:
    """Write the value of a contour with as many digits as distinguish it from contours ``step`` away.

    Examples
    --------
    >>> _in_words(0.0015, 0.0005), _in_words(-20.0, 10.0), _in_words(2.5e6, 5e5), _in_words(-1e-19, 1)
    ('0.0015', '−20', '2.5e6', '0')
    """
    if abs(level) < 1e-9 * step:
        return "0"
    # Two digits are added, since a step such as 2.5 has two digits and its multiple 12.5 has three.
    digits = max(0, int(np.floor(np.log10(abs(level) / step) + 1e-9))) + 3
    return plain(level, digits)


def add_colour_bar(axes: Axes, scale: Scale, label: str, beside: Axes | None = None) -> None:
    """Draw the colour bar on the axes ``beside``; without them, on new axes next to ``axes``."""
    room: dict[str, Any] = {"cax": beside} if beside is not None else {"shrink": 0.92, "aspect": 28, "pad": 0.025}
    bar = figure_of(axes).colorbar(scale.bar, ax=axes, spacing="proportional", **room)
    bar.set_label(literal(label), fontsize=LABEL_SIZE)
    bar.outline.set_visible(False)
    bar.formatter = ScalarFormatter()
    bar.formatter.set_powerlimits(POWERS)
    bar.minorticks_off()
    bar.ax.tick_params(length=2.5, labelsize=_NUMBERS)
    bar.update_ticks()
    widest = max(text_width(text, _NUMBERS) for text in bar.formatter.format_ticks(bar.get_ticks().tolist()))
    put_label(bar.ax.yaxis, 1.0, 0.5, max(_LEAST_AWAY, widest + _BESIDE), 0.0)
