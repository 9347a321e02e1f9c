"""Symbols of supports and zones in plan, and the legend."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import to_rgba
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import Normal, TickedStroke, withStroke
from matplotlib.transforms import ScaledTranslation

from signorini.plot.picture import SupportMark, ZoneMark
from signorini.plot.plan import INK, Labels, enclosed, figure_of, inches_per_unit, literal, pieces, runs
from signorini.shapes.arrays import Bools, Floats

_EDGE = "#d95f02"
_ZONE = "#3f6f8f"
LEGEND_SIZE = 8.5
"""Font size of legends [points]."""
LARGEST, _SMALLEST = 8.5, 3.2
"""Largest and smallest width of the mark of a support [points]."""
_SAMPLE = 7.0
"""Width of the mark of a support in the legend [points]."""
_FEW = 600
"""Largest number of points whose distances set the size of marks; for more points, their number per area does."""
_FITS = 0.8
"""Size of the marks of a support, relative to their typical distance."""
_SPACED = {"line": 0.55, "area": 1.1}
"""Distance of the marks along a line support, and along the outline of an area support [inches]."""
_INSIDE = 0.35
"""Largest size of a mark, relative to the footprint around it, so that the field remains visible."""
_WAVE, _SWING = 5.0, 1.7
"""Half the period and the amplitude of a zigzag line [points]."""
_FLIPPED = np.array([1.0, -1.0])
_TRIANGLE = np.array([[0.0, 0.5], [-0.5, -0.42], [0.5, -0.42], [0.0, 0.5]])
_GLYPHS = {
    "down": Path(_TRIANGLE),
    "up": Path(_TRIANGLE * _FLIPPED),
    "both": Path([[0, 0.55], [0.55, 0], [0, -0.55], [-0.55, 0], [0, 0.55]]),
    "clamped": Path(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * 0.42),
    "hinged": Path.circle(radius=0.45),
    "symmetry": Path([[-0.5, 0], [0.5, 0], [-0.5, 0]]),
}
_SPRING = np.array([[0.0, -0.45], [0.4, -0.6], [-0.4, -0.78], [0.4, -0.96], [-0.3, -1.1]])
_BAR = np.array([[-0.5, 0.85], [0.5, 0.85]])
"""Bar above the triangle of a support with a gap: it stands for the plate before contact. A spring is drawn below."""
_DETAILED = 5.0
"""Smallest size at which a mark has its spring and bar [points]."""
_WAVY = Path(np.column_stack([np.linspace(-1, 1, 9), [0, 0.22, -0.22, 0.22, -0.22, 0.22, -0.22, 0.22, 0]]))
_BOX = Path(np.array([[-1, -0.55], [1, -0.55], [1, 0.55], [-1, 0.55], [-1, -0.55]]))

Entry = tuple[str, tuple[Artist, ...]]
"""A legend entry: its text and its sample symbols."""


def draw_supports(marks: Sequence[SupportMark], axes: Axes) -> list[Entry]:
    """Draw supports and the borders of contact in areas; return the legend entries."""
    entries = [draw_support(mark, axes) for mark in marks]
    look: dict[str, Any] = {"color": _EDGE, "linewidth": 1.8, "solid_capstyle": "butt"}
    lines = [line for mark in marks for line in mark.boundary]
    if lines:
        joined = np.concatenate([part for line in lines for part in (np.full((1, 2), np.nan), line)])
        axes.plot(*joined.T, zorder=5.5, path_effects=[withStroke(linewidth=3.2, foreground="white")], **look)
    return entries + ([("edge of contact", (Line2D([], [], **look),))] if lines else [])


def legend_words(marks: Sequence[SupportMark]) -> list[str]:
    """Legend texts of the supports ``marks``."""
    return [mark.label for mark in marks] + (["edge of contact"] if any(len(mark.boundary) for mark in marks) else [])


def draw_support(mark: SupportMark, axes: Axes) -> Entry:
    """Draw one support; return its legend entry."""
    positions = np.asarray(mark.positions, dtype=float)
    closed = np.ones(len(positions), dtype=bool) if mark.closed is None else np.asarray(mark.closed, dtype=bool)
    samples: list[Artist] = []
    per_unit = inches_per_unit(axes)
    size = LARGEST
    if mark.style == "points":
        size = min(_fitting(positions, per_unit), _draw_footprints(mark, closed, axes, per_unit))
    else:
        samples += _draw_line(mark, positions, closed, axes, per_unit)
        positions, closed = _spaced(positions, closed, _SPACED[mark.style] / per_unit)
        size *= 0.75
        if mark.kind in ("clamped", "symmetry", "perimeter"):
            return mark.label, tuple(samples)
    for chosen, hollow in [(closed, mark.kind == "hinged" and mark.style != "points"), (~closed, True)]:
        if chosen.any():
            axes.plot(*positions[chosen].T, zorder=5, **_glyph(mark, size, hollow))
        if chosen.any() or (chosen is closed and not len(positions)):
            samples.append(Line2D([], [], **_glyph(mark, _SAMPLE, hollow)))
    return mark.label, tuple(samples)


def draw_numbers(marks: Iterable[SupportMark], labels: Labels) -> None:
    """Write the number of each support point beside it."""
    named = [(words, at) for mark in marks for words, at in zip(mark.numbers, mark.positions, strict=False)]
    for place, (words, at) in enumerate(named):
        others = [other for number, (_, other) in enumerate(named) if number != place]
        labels.beside(words, at, 7.5, others=others, zorder=6.3)


def _draw_footprints(mark: SupportMark, closed: Bools, axes: Axes, per_unit: float) -> float:
    """Draw a support's footprints to scale: shaded if closed, dashed if open.

    Return the largest size [points] of a mark inside a footprint.
    """
    prints = pieces(mark.footprints)
    # Before a solution no state is known, so all footprints are drawn as closed.
    states = closed if len(closed) == len(prints) else np.ones(len(prints), np.bool_)
    for chosen, shade, line in ((states, to_rgba(INK, 0.18), "solid"), (~states, "none", "dashed")):
        if chosen.any():
            path = Path.make_compound_path(*(Path(prints[i]) for i in np.flatnonzero(chosen)))
            axes.add_patch(PathPatch(path, facecolor=shade, edgecolor=INK, linewidth=0.9, linestyle=line, zorder=3))
    sides = [float(np.ptp(piece, axis=0).min()) for piece in prints]
    return max(_SMALLEST, _INSIDE * min(sides) * per_unit * 72) if sides else LARGEST


def draw_zones(marks: Iterable[ZoneMark], axes: Axes, plate: Path, labels: Labels) -> list[Entry]:
    """Draw zones and number them from 1; return the legend entries."""
    entries: list[Entry] = []
    look: dict[str, Any] = {"facecolor": to_rgba(_ZONE, 0.22), "edgecolor": _ZONE, "linewidth": 0.9}
    for number, mark in enumerate(marks, 1):
        axes.add_patch(PathPatch(enclosed(mark.outline), zorder=1.5, **look)).set_clip_path(plate, axes.transData)
        low, high = np.nanmin(mark.outline, axis=0), np.nanmax(mark.outline, axis=0)
        labels.beside(str(number), [low, 0.5 * (low + high), high], color=_ZONE, zorder=6.4)
        entries.append((f"zone {number}: {mark.words}", (Patch(**look),)))
    return entries


def _glyph(mark: SupportMark, size: float, hollow: bool) -> dict[str, Any]:
    """Style of the mark of a support point: with a spring if the support is elastic, with a bar if it has a gap."""
    shape, turned = _GLYPHS[mark.kind], _FLIPPED if mark.kind == "up" else np.ones(2)
    details = [_SPRING] if mark.elastic and mark.style == "points" else []
    details += [_BAR] if mark.gap else []
    parts = [shape, *(Path(np.concatenate([part, part[::-1]]) * turned) for part in details if size >= _DETAILED)]
    joined = Path.make_compound_path(*parts)
    edge = max(0.6, 0.12 * size)
    return {
        "marker": joined,
        # matplotlib scales a marker so that its largest coordinate becomes half of the marker size.
        "markersize": 2 * size * float(np.abs(joined.vertices).max()),
        "markerfacecolor": "white" if hollow else INK,
        "markeredgecolor": INK,
        "markeredgewidth": edge,
        "linestyle": "none",
        "clip_on": False,
    }


def _draw_line(mark: SupportMark, positions: Floats, closed: Bools, axes: Axes, per_unit: float) -> list[Artist]:
    """Draw a line support, or the outline of an area: a band, dark where closed and white inside where open.

    An elastic line support is a zigzag. ``closed`` (k,) are the states at the positions (k, 2). Return the samples of
    the legend.
    """
    width = 1.0 if mark.style == "area" else 2.2
    look: dict[str, Any] = {"color": INK, "linewidth": width, "clip_on": False, "solid_capstyle": "butt"}
    if mark.kind == "symmetry":
        look |= {"linewidth": 1.4, "linestyle": (0, (7, 2.5, 1.2, 2.5))}
        for piece in pieces(positions):
            axes.plot(*piece.T, color="white", linewidth=2.6, zorder=4, clip_on=False)
            axes.plot(*piece.T, zorder=4.1, **look)
        return [Line2D([], [], **look)]
    if mark.kind == "perimeter":
        look |= {"color": _EDGE, "linewidth": 1.1, "linestyle": "dashed"}
        axes.plot(*positions.T, zorder=4.2, **look)
        return [Line2D([], [], **look)]
    if mark.kind == "clamped":
        look["path_effects"] = [Normal(), TickedStroke(spacing=6, angle=-135, length=0.9)]
        middle = np.array([sum(axes.get_xlim()), sum(axes.get_ylim())]) / 2
        for piece in pieces(positions):
            axes.plot(*_hatched_outside(piece, middle).T, zorder=4, **look)
        return [Line2D([], [], **look)]
    core: dict[str, Any] = {"color": "white", "linewidth": 0.5 * width, "clip_on": False, "solid_capstyle": "butt"}
    opened = []
    for piece, shut in ((positions[rows], closed[rows]) for rows in runs(positions)):
        if mark.elastic and mark.style == "line":
            look["linewidth"], core["linewidth"] = 0.55 * width + 0.35, 0.3 * width + 0.2
            piece, shut = _zigzag(piece, shut, per_unit)
        axes.plot(*piece.T, zorder=4, **look)
        opened += [piece[start : end + 1] for start, end in _runs(~shut) if end > start]
    for piece in opened:
        axes.plot(*piece.T, zorder=4.1, **core)
    if mark.style == "line" and not mark.elastic:
        return [Line2D([], [], **look)]
    shape, size = (_WAVY, 20.0) if mark.style == "line" else (_BOX, 10.0)
    sample: dict[str, Any] = {"marker": shape, "markersize": size, "markeredgewidth": look["linewidth"]}
    return [Line2D([], [], linestyle="none", markeredgecolor=INK, markerfacecolor="none", **sample)]


def _fitting(positions: Floats, per_unit: float) -> float:
    """Size [points] of the marks at points (k, 2): 0.8 times their typical distance, from `_SMALLEST` to `LARGEST`."""
    if len(positions) < 2:
        return LARGEST
    spread = np.ptp(positions, axis=0) * per_unit * 72
    if len(positions) <= _FEW:
        apart = np.hypot(*(positions[:, None] - positions).transpose(2, 0, 1)) * per_unit * 72
        nearest = float(np.median(np.where(apart > 0, apart, np.inf).min(axis=1)))
    else:
        nearest = float(np.sqrt((spread[0] + 1) * (spread[1] + 1) / len(positions)))
    return float(np.clip(_FITS * nearest, _SMALLEST, LARGEST))


def _spaced(positions: Floats, closed: Bools, apart: float) -> tuple[Floats, Bools]:
    """Points along polylines at about equal distances ``apart``, and the contact state at each."""
    places, states = [np.zeros((0, 2))], [np.zeros(0, bool)]
    for piece, shut in ((positions[rows], closed[rows]) for rows in runs(positions)):
        if len(piece) < 2:
            continue
        along = _along(piece)
        count = max(1, round(along[-1] / apart))
        at, there = _at(piece, shut, along, (np.arange(count) + 0.5) / count)
        places.append(at)
        states.append(there)
    return np.concatenate(places), np.concatenate(states)


def _along(piece: Floats) -> Floats:
    """Arc length (k,) from the start of a polyline (k, 2) to each vertex."""
    return np.append(0.0, np.hypot(*np.diff(piece, axis=0).T).cumsum())


def _at(piece: Floats, shut: Bools, along: Floats, parts: Floats) -> tuple[Floats, Bools]:
    """Points at the fractions ``parts`` of a polyline's length, and the contact states there.

    ``along`` (k,) are the arc lengths of the vertices.
    """
    at = parts * along[-1]
    states = shut[np.clip(np.searchsorted(along, at), 0, len(shut) - 1)]
    return np.column_stack([np.interp(at, along, side) for side in piece.T]), states


def _zigzag(piece: Floats, shut: Bools, per_unit: float) -> tuple[Floats, Bools]:
    """Vertices of a zigzag along a polyline, and the contact state at each."""
    along = _along(piece)
    count = max(4, round(along[-1] * per_unit * 72 / _WAVE))
    places, states = _at(piece, shut, along, np.linspace(0.0, 1.0, count + 1))
    tangent = np.gradient(places, axis=0)
    tangent /= np.maximum(np.hypot(*tangent.T), 1e-300)[:, None]
    swing = _SWING / 72 / per_unit * np.where(np.arange(count + 1) % 2, 1, -1)
    swing[[0, -1]] = 0
    places += swing[:, None] * np.column_stack([-tangent[:, 1], tangent[:, 0]])
    return places, states


def _runs(chosen: Bools) -> list[tuple[int, int]]:
    """First and last index of every run of True in a mask."""
    steps = np.diff(np.concatenate([[False], chosen, [False]]).astype(int))
    return list(zip(np.flatnonzero(steps > 0).tolist(), (np.flatnonzero(steps < 0) - 1).tolist(), strict=True))


def draw_legend(axes: Axes, entries: Sequence[Entry], at: tuple[float, float] | None = None) -> None:
    """Draw the legend below the axes, or with its upper center ``at`` a position in the figure [inches]."""
    if not entries:
        return
    inches = figure_of(axes).dpi_scale_trans
    axes.legend(
        handles=[samples for _, samples in entries],
        labels=[literal(words) for words, _ in entries],
        handler_map={tuple: HandlerTuple(ndivide=None, pad=0.6)},
        loc="upper center",
        bbox_to_anchor=(0.5, 0.0) if at is None else at,
        bbox_transform=axes.transAxes + ScaledTranslation(0, -0.45, inches) if at is None else inches,
        borderaxespad=0.1,
        handlelength=2.6,
        frameon=False,
        fontsize=LEGEND_SIZE,
    )


def _hatched_outside(piece: Floats, middle: Floats) -> Floats:
    """Reverse a polyline if its right side, which is hatched, faces the center ``middle`` (2,) of the picture."""
    start, step = piece[:-1] - middle, np.diff(piece, axis=0)
    turning = float(np.sum(start[:, 0] * step[:, 1] - start[:, 1] * step[:, 0]))
    return piece if turning >= 0 else piece[::-1]
