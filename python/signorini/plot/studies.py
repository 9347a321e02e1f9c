"""Pictures of studies: histogram with quantiles, parallel coordinates, first-order sensitivities."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure

from signorini.base.numbers import number
from signorini.plot.plan import INK, PAPER, literal
from signorini.shapes.arrays import Floats

_BAR, _LINE = "#1f5fa8", "#b3261e"
_MOST_LINES = 2000
"""Largest number of variants in parallel coordinates; more lines hide each other."""


def study_picture(
    result: str,
    values: Floats,
    parameters: Mapping[str, Floats],
    quantiles: Mapping[float, float],
    sensitivities: Mapping[str, float],
    units: Mapping[str, str],
    limit: float | None = None,
) -> Figure:
    """Draw one result of a study: values (n,) of the solved variants, and values (n,) of each parameter.

    ``units`` are those of the result and of the parameters, by name. Values above ``limit`` are counted in the legend.
    """

    def label(name: str) -> str:
        return literal(f"{name} [{units[name]}]" if units.get(name) else name)

    figure = Figure(figsize=(10, 7.2), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.5, 1.0), height_ratios=(1.0, 1.15))
    histogram, bars, below = (figure.add_subplot(part) for part in (grid[0, 0], grid[0, 1], grid[1, :]))
    _histogram(histogram, values, quantiles, limit)
    histogram.set_xlabel(label(result))
    _bars(bars, sensitivities)
    _coordinates(below, {label(name): column for name, column in {**parameters, result: values}.items()})
    return figure


def _histogram(axes: Axes, values: Floats, quantiles: Mapping[float, float], limit: float | None) -> None:
    axes.hist(values, bins="auto", color=_BAR, alpha=0.8)
    largest = float(np.abs(values).max(initial=0.0))
    for probability in (0.05, 0.5, 0.95):
        at = quantiles[probability]
        axes.axvline(at, color=_LINE, linewidth=1.0, linestyle="solid" if probability == 0.5 else "dashed")
        axes.annotate(
            f"{probability * 100:.0f} %: {number(at, largest)}",
            (at, 1.0),
            (0, 2),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            rotation=30,
            fontsize=8,
            color=_LINE,
        )
    if limit is not None:
        words = f"limit {number(limit)}: {np.count_nonzero(values > limit)} of {len(values)} above"
        axes.axvline(limit, color=INK, linewidth=2.0, label=words)
        axes.legend(fontsize=8, frameon=True, framealpha=0.9, loc="upper right")
    axes.set_ylabel("variants")
    axes.spines[["top", "right"]].set_visible(False)


def _bars(axes: Axes, sensitivities: Mapping[str, float]) -> None:
    named = sorted(sensitivities.items(), key=lambda item: np.nan_to_num(item[1]))
    axes.barh([literal(name) for name, _ in named], [np.nan_to_num(value) for _, value in named], color=_BAR)
    axes.set_xlim(0.0, 1.0)
    axes.set_title("first-order sensitivity", color=INK, fontsize=10)
    axes.spines[["top", "right"]].set_visible(False)


def _coordinates(axes: Axes, columns: Mapping[str, Floats]) -> None:
    """Draw each variant as a line over axes of parameters, coloured by the result, which is the last axis."""
    table = np.array(list(columns.values()))
    table = table[:, np.linspace(0, table.shape[1] - 1, min(table.shape[1], _MOST_LINES)).astype(int)]
    least, most = table.min(axis=1), table.max(axis=1)
    scaled = (table - least[:, None]) / np.where(most > least, most - least, 1.0)[:, None]
    places = np.arange(len(columns), dtype=float)
    lines = [np.column_stack([places, column]) for column in scaled.T]
    drawn = LineCollection(lines, array=scaled[-1], cmap=colormaps["viridis"], linewidths=0.8, alpha=0.6)
    axes.add_collection(drawn)
    for place, low, high in zip(places, least.tolist(), most.tolist(), strict=True):
        axes.axvline(place, color=INK, linewidth=0.8)
        size = max(abs(low), abs(high))
        for at, value, side in ((-0.03, low, "top"), (1.03, high, "bottom")):
            axes.text(place, at, number(value, size), ha="center", va=side, fontsize=8, bbox=PAPER)
    axes.set_xlim(-0.2, len(columns) - 0.8)
    axes.set_ylim(-0.12, 1.12)
    axes.set_xticks(places, list(columns))
    axes.set_yticks([])
    axes.spines[:].set_visible(False)
