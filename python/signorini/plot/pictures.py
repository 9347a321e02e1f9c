"""Whole figures, and how they reach a file."""

from __future__ import annotations

import os
import struct
import textwrap
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from signorini.base.files import replacing
from signorini.base.plain import plain
from signorini.errors import InputError
from signorini.plot.balance import BalanceMark, draw_balances
from signorini.plot.field import PAPER, Scale, add_colour_bar, checked_field, draw_field
from signorini.plot.loads import LoadMark, draw_loads
from signorini.plot.marks import Entry, SupportMark, ZoneMark, draw_legend, draw_supports, draw_zones, legend_words
from signorini.plot.places import EdgeMark, SingularMark, draw_edges, draw_singular
from signorini.plot.plan import INK, Plan, draw_outlines, draw_sheet, inches_per_unit, literal, put_label, set_window
from signorini.plot.pressure import PressureLayer, draw_pressure, pressure_scale

DRAWN_BY = "signorini"
"""What the metadata of pictures name as the program that drew them."""
_FAST = 1
"""zlib's level for .png files: a fifth larger than by default, in a fourth of the time."""
_DOTS = 160
"""Dots per inch of .png files."""
_WIDEST, _TALLEST = 5.6, 7.6
"""Inches that the plan of a plate may take."""
_BESIDE_EACH_OTHER = 3.4
"""Inches that it takes where there are several in a row, which they are unless they are ..."""
_WIDE = 1.7
"""times as wide as high."""
_SMALLEST = (1.6, 0.8)
"""Inches that it takes at least."""
_LEFT, _BETWEEN, _BELOW, _GAP, _BAR, _RIGHT, _LINE = 0.68, 0.1, 0.5, 0.12, 0.15, 0.8, 0.2
"""Inches left of a plan, of the next one beside it, and below it, to its colours, for them and for their numbers; for a
line of text."""
_TALLEST_BAR = 5.0
_TICKS = 0.6
"""Inches from one number of an axis to the next, about."""
_NAME = (1.8, 0.35)
"""Inches that the name of an extreme takes."""
_SMALLEST_NUMBER = 2.5
"""Points that a node's number is high at least."""
_MOST_NUMBERS = 5000
"""Nodes that have their numbers drawn."""


@dataclass(frozen=True, eq=False)
class Panel:
    """One field in a picture.

    Attributes
    ----------
    values : ndarray, shape (n,), or sequence of PressureLayer
        At the nodes; or the pressures of areas.
    label : str
        What it is, with its unit: beside the colour bar.
    colours : str
        A map whose middle is zero.
    limits : (low, high) or None
        Range of the colours; None for that of the field.
    extremes : sequence of (str, float, (x, y))
        Values that are named in the picture, and where.
    """

    values: NDArray[np.float64] | Sequence[PressureLayer]
    label: str = ""
    colours: str = "RdBu"
    limits: tuple[float, float] | None = None
    extremes: Sequence[tuple[str, float, Sequence[float]]] = ()


def draw_panel(axes: Axes, plan: Plan, panel: Panel, marks: Iterable[SupportMark]) -> list[Entry]:
    """Draw a field with its colour bar, its extremes and the supports; return their entries in the legend."""
    set_window(axes, plan)
    scale = _scale(plan, panel)
    add_colour_bar(axes, scale, panel.label)
    return _draw(axes, plan, panel, scale, marks)


def field_picture(
    plan: Plan, panels: Sequence[Panel], marks: Sequence[SupportMark] = (), *, title: str = "", length: str = ""
) -> Figure:
    """Draw fields side by side, each with the supports, open or closed, as one figure.

    Parameters
    ----------
    plan : Plan
        The plate; one for all pictures of a run.
    panels : sequence of Panel
    marks : sequence of SupportMark
    title : str
        Wrapped to the figure's width.
    length : str
        The unit of length, for the axes.

    Returns
    -------
    Figure
        Its first axes are the plans of the panels, in their order.

    Examples
    --------
    >>> nodes = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [2, 0.5], [1, 1], [0, 0.5]]
    >>> plan = Plan.of(nodes, [range(8)])
    >>> figure = field_picture(plan, [Panel(plan.nodes[:, 0], "mx [N]"), Panel(plan.nodes[:, 1], "my [N]")])
    >>> [axes.get_ylabel() for axes in figure.axes]
    ['y', 'y', 'mx [N]', 'my [N]']
    """
    page = _Page(plan, len(panels), length, bars=True)
    scales = page.draw_bars(panels)
    page.finish(title, page.draw_fields(panels, scales, marks))
    return page.figure


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture of one result, to be saved as a .png file.

    Attributes
    ----------
    path : path-like
    panels : callable
        Gives the fields, each with its limits, when they are needed.
    marks : sequence of SupportMark
    title : str
    """

    path: str | os.PathLike[str]
    panels: Callable[[], Sequence[Panel]]
    marks: Sequence[SupportMark]
    title: str


def save_pictures(plan: Plan, pictures: Sequence[Picture], length: str = "") -> None:
    """Save pictures of one kind, of several results, as `field_picture` draws them; not aside first.

    Their panels have the same labels and limits. What they share, axes and colour bars, is drawn once.

    Raises
    ------
    OSError
        A file cannot be written.
    """
    if not pictures:
        return
    page = _Page(plan, len(first := pictures[0].panels()), length, bars=True)
    scales = page.draw_bars(first)
    for picture in pictures:
        page.make_room(picture.title, legend_words(picture.marks))
    page.figure.set_dpi(_DOTS)
    canvas: Any = page.canvas  # matplotlib leaves its methods without types
    canvas.draw()
    shared = canvas.copy_from_bbox(page.figure.bbox)
    before = set(map(id, page.artists()))
    for picture in pictures:
        canvas.restore_region(shared)
        page.finish(picture.title, page.draw_fields(picture.panels(), scales, picture.marks))
        drawn = [artist for artist in page.artists() if id(artist) not in before]
        for artist in sorted(drawn, key=lambda artist: artist.get_zorder()):
            artist.draw(canvas.get_renderer())
        # Without the alpha channel, of which a page has no need, there is a fourth less to compress.
        Path(picture.path).write_bytes(_as_png(np.asarray(canvas.buffer_rgba())[..., :3]))
        for artist in drawn:
            artist.remove()


def check_picture(
    plan: Plan,
    *,
    zones: Iterable[ZoneMark] = (),
    supports: Iterable[SupportMark] = (),
    loads: Iterable[LoadMark] = (),
    totals: Mapping[str, str] | None = None,
    edges: Iterable[EdgeMark] = (),
    singular: Sequence[SingularMark] = (),
    balance: Iterable[BalanceMark] = (),
    poorest: tuple[tuple[float, float], str] | None = None,
    title: str = "",
    length: str = "",
    numbers: bool = False,
) -> Figure:
    """Draw a model before it is solved: mesh, supports and loads, and what the loads amount to.

    Parameters
    ----------
    plan : Plan
    zones : iterable of ZoneMark
    supports : iterable of SupportMark
    loads : iterable of LoadMark
    totals : mapping of str, optional
        The sums of load cases, in words.
    edges : iterable of EdgeMark
    singular : sequence of SingularMark
    balance : iterable of BalanceMark
    poorest : ((x, y), str), optional
        The corner of the worst element, and words about it.
    title : str
    length : str
        The unit of length, for the two axes.
    numbers : bool
        Whether to write the numbers of the nodes, from 0.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        There are too many nodes for their numbers.
    """
    if numbers and len(plan.nodes) > _MOST_NUMBERS:
        raise InputError(
            f"numbers of {len(plan.nodes)} nodes cannot be read in a picture; {_MOST_NUMBERS} is the most. Leave them "
            "out, or take a coarser mesh."
        )
    page = _Page(plan, 1, length, bars=False)
    (axes,) = page.plans
    sheet = draw_sheet(axes, plan)
    draw_outlines(axes, plan, inner=0.3)
    entries = draw_zones(zones, axes, sheet) + draw_supports(supports, axes)
    entries += draw_loads(loads, axes, totals or {}) + draw_singular(singular, axes)
    draw_edges(edges, axes)
    if numbers:
        _number_nodes(axes, plan)
    entries += draw_balances(balance, axes)
    if poorest is not None:
        at, words = poorest
        (ring,) = axes.plot(*at, "o", markerfacecolor="none", markeredgecolor="#7a4fb5", markersize=9, zorder=6)
        entries.append((words, (ring,)))
    page.finish(title, entries)
    return page.figure


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a figure to a file, whole or not at all; the suffix (``.png``, ``.svg``, ``.pdf``) gives the format.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    with replacing(path) as beside:
        png = beside.suffix.lower() == ".png"
        options = {"pil_kwargs": {"compress_level": _FAST}} if png else {}
        metadata = {"Software" if png else "Creator": DRAWN_BY}
        figure.savefig(beside, dpi=_DOTS, metadata=metadata, **options)  # type: ignore[arg-type]


def _as_png(dots: NDArray[np.uint8]) -> bytes:
    """Give dots (h, w, 3) as a PNG file, its lines unfiltered: as small as matplotlib's in half the time."""
    height, width, _ = dots.shape
    lines = np.zeros((height, 1 + 3 * width), np.uint8)
    lines[:, 1:] = dots.reshape(height, -1)
    per_metre = round(_DOTS / 0.0254)
    chunks = (
        (b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)),
        (b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1)),
        (b"tEXt", f"Software\0{DRAWN_BY}".encode("latin-1")),
        (b"IDAT", zlib.compress(lines.tobytes(), _FAST)),
        (b"IEND", b""),
    )
    written = (
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks
    )
    return b"\x89PNG\r\n\x1a\n" + b"".join(written)


class _Page:
    """A figure whose parts have their places in inches, so that none need be sought by drawing it."""

    def __init__(self, plan: Plan, count: int, length: str, *, bars: bool) -> None:
        low, high = plan.window
        width, height = high - low
        self._plan = plan
        self._columns = count if width <= _WIDE * height else 1
        self._rows, self._beside = -(-count // self._columns), _GAP + _BAR + _RIGHT if bars else 0.3
        widest = _WIDEST if self._columns == 1 else _BESIDE_EACH_OTHER
        scale = min(widest / width, _TALLEST / height)
        self._box = np.maximum([scale * width, scale * height], _SMALLEST)
        self._above = self._below = 0.0
        self.figure = Figure(figsize=self._size)
        self.canvas = FigureCanvasAgg(self.figure)
        self.plans = [self.figure.add_axes((0, 0, 1, 1)) for _ in range(count)]
        self.bars = [self.figure.add_axes((0, 0, 1, 1)) for _ in range(count if bars else 0)]
        unit = literal(f" [{length}]" if length else "")
        for place, axes in enumerate(self.plans):
            set_window(axes, plan)
            for axis, size, name in ((axes.xaxis, self._box[0], "x"), (axes.yaxis, self._box[1], "y")):
                axis.set_major_locator(MaxNLocator(int(np.clip(size / _TICKS, 2, 8)), steps=[1, 2, 5, 10]))
                axis.set_label_text(f"{name}{unit}", fontsize=9)
            put_label(axes.xaxis, 0.5, 0.0, 0.0, -0.36)
            put_label(axes.yaxis, 0.0, 0.5, -0.5, 0.0)
            # Of plans beside each other the first one's numbers are enough.
            axes.yaxis.set_visible(place % self._columns == 0)
        self._place()

    def artists(self) -> list[Artist]:
        """Everything that there is on the plans, and on the page beside them."""
        return [artist for part in (*self.plans, self.figure) for artist in part.get_children()]

    def draw_bars(self, panels: Sequence[Panel]) -> list[Scale]:
        """Draw the colour bars, and return their scales."""
        scales = [_scale(self._plan, panel) for panel in panels]
        for axes, bar, scale, panel in zip(self.plans, self.bars, scales, panels, strict=True):
            add_colour_bar(axes, scale, panel.label, bar)
        return scales

    def draw_fields(
        self, panels: Sequence[Panel], scales: Sequence[Scale], marks: Sequence[SupportMark]
    ) -> list[Entry]:
        """Draw fields and supports, and return the entries of the legend."""
        entries: list[Entry] = []
        for axes, panel, scale in zip(self.plans, panels, scales, strict=True):
            entries = _draw(axes, self._plan, panel, scale, marks)
        return entries

    def make_room(self, title: str, words: Sequence[str]) -> None:
        """Grow, if need be, by the room of a title above and of a legend below."""
        lines = self._title(title).count("\n") + 1 if title else 0
        self._above = max(self._above, 0.12 + _LINE * lines)
        heights = [0.165 * (self._words(part).count("\n") + 1) + 0.035 for part in words]
        self._below = max(self._below, sum(heights) + 0.12 if heights else 0.0)
        self.figure.set_size_inches(*self._size)
        self._place()

    def finish(self, title: str, entries: list[Entry]) -> None:
        """Put the title above and the legend below."""
        self.make_room(title, [words for words, _ in entries])
        across, up = self._size
        if title:
            self.figure.text(
                0.5, 1 - 0.08 / up, literal(self._title(title)), ha="center", va="top", fontsize=11, color=INK
            )
        wrapped = [(self._words(words), samples) for words, samples in entries]
        draw_legend(self.plans[0], wrapped, (across / 2, self._below))

    def _title(self, title: str) -> str:
        # A letter of this size is about 0.088 inches wide.
        return textwrap.fill(title, max(20, int(self._size[0] / 0.088)))

    def _words(self, words: str) -> str:
        return textwrap.fill(words, max(30, int((self._size[0] - 0.9) / 0.068)))

    @property
    def _pitch(self) -> NDArray[np.float64]:
        """From one plan to the next, to the right and down."""
        return np.asarray(self._box + np.array([_BETWEEN + self._beside, _BELOW + 0.1]))

    @property
    def _size(self) -> tuple[float, float]:
        across, up = self._pitch * [self._columns, self._rows] + [_LEFT - _BETWEEN, self._above + self._below]
        return float(across), float(up)

    def _place(self) -> None:
        size = np.array(self._size)
        for place, axes in enumerate(self.plans):
            row, column = divmod(place, self._columns)
            corner = self._pitch * [column, self._rows - 1 - row] + [_LEFT, self._below + _BELOW]
            axes.set_position((*(corner / size), *(self._box / size)))
            if self.bars:
                tall = min(self._box[1], _TALLEST_BAR)
                at = corner + np.array([self._box[0] + _GAP, (self._box[1] - tall) / 2])
                self.bars[place].set_position((*(at / size), *(np.array([_BAR, tall]) / size)))


def _scale(plan: Plan, panel: Panel) -> Scale:
    if not isinstance(panel.values, np.ndarray):
        return pressure_scale(plan, panel.values, panel.colours, panel.limits)
    limits = panel.limits or (float(panel.values.min()), float(panel.values.max()))
    return Scale.of(*limits, panel.colours)


def _draw(axes: Axes, plan: Plan, panel: Panel, scale: Scale, marks: Iterable[SupportMark]) -> list[Entry]:
    """Draw what differs from result to result."""
    if isinstance(panel.values, np.ndarray):
        draw_field(axes, plan, checked_field(plan, panel.values), scale)
    else:
        draw_pressure(axes, plan, panel.values, scale)
    if panel.extremes:
        places = np.array([at for _, _, at in panel.extremes], dtype=float)
        ways = np.where(places > (plan.window[0] + plan.window[1]) / 2, -1, 1)
        # Names that would lie on each other go apart.
        if (np.ptp(places, axis=0) * inches_per_unit(axes) < _NAME).all():
            ways[:, 1] = np.where(np.arange(len(places)) == places[:, 1].argmax(), 1, -1)
        for (name, value, _), at, way in zip(panel.extremes, places, ways, strict=True):
            _name_place(axes, f"{name} {plain(value, 4)}", at, way)
    return draw_supports(marks, axes)


def _number_nodes(axes: Axes, plan: Plan) -> None:
    """Write the number of every node beside it, as large as there is room."""
    side = float(np.hypot(*(plan.nodes[plan.cells[:, 4]] - plan.nodes[plan.cells[:, 0]]).T).min())
    size = float(np.clip(0.35 * side * inches_per_unit(axes) * 72, _SMALLEST_NUMBER, 8.0))
    halo = [withStroke(linewidth=0.3 * size, foreground="white")]
    for node in np.unique(plan.cells).tolist():
        words = axes.annotate(str(node), plan.nodes[node], (0.25 * size, 0.25 * size), textcoords="offset points")
        words.set(fontsize=size, color="#0b5d8f", path_effects=halo, zorder=6.5)


def _name_place(axes: Axes, words: str, at: NDArray[np.float64], way: NDArray[np.int64]) -> None:
    """Mark a place with a value, written to the right and above it, or the other way."""
    halo = [withStroke(linewidth=2.5, foreground="white")]
    axes.plot(*at, marker="+", color=INK, markersize=8, markeredgewidth=1.2, path_effects=halo, zorder=6)
    look: dict[str, Any] = {"fontsize": 8.5, "color": INK, "bbox": PAPER, "zorder": 7}
    look |= {"ha": "left" if way[0] > 0 else "right", "va": "bottom" if way[1] > 0 else "top"}
    axes.annotate(words, (at[0], at[1]), xytext=(7.0 * way[0], 7.0 * way[1]), textcoords="offset points", **look)
