"""Layout of a picture's page: positions of plans, colour bars, title and legend, in inches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from signorini.plot.marks import LEGEND_SIZE, Entry, draw_legend
from signorini.plot.plan import INK, LABEL_SIZE, Plan, literal, put_label, set_window, text_width, wrapped

WIDEST, _TALLEST = 5.6, 7.6
"""Largest width and height of a plan on its page [inches]."""
_WIDTH_IN_ROW = 3.4
"""Largest width of a plan if several plans are side by side [inches]."""
_WIDE = 1.7
"""Largest ratio of width to height of plans side by side; wider plans are stacked."""
_SMALLEST = (1.6, 0.8)
"""Smallest width and height of a plan [inches]."""
_LEFT, _BETWEEN, _BELOW, _GAP, _BAR, _RIGHT, _LINE = 0.68, 0.1, 0.5, 0.12, 0.15, 0.88, 0.2
"""Distances [inches]: left of the first plan, between plans, below a plan, from plan to colour bar, width of the bar,
right of the bar for its numbers, height of a line of text."""
_TITLE = 0.4
"""Height above a plan for its title and for the label of an extreme at the upper edge [inches]."""
_TALLEST_BAR = 5.0
"""Largest height of a colour bar [inches]."""
_NARROWEST, _SAMPLES = 4.2, 1.1
"""Smallest width of a page; part of a legend's width that its sample symbols take [inches]."""
_TITLE_SIZE = 11.0
"""Font size of titles [points]."""
_TICKS = 0.6
"""Approximate distance between the numbers along an axis [inches]."""


class Page:
    """A figure whose parts have fixed positions in inches, so that matplotlib need not compute a layout."""

    def __init__(
        self,
        plan: Plan,
        count: int,
        length: str,
        *,
        bars: bool,
        rows: int = 1,
        titles: bool = False,
        widest: float = WIDEST,
    ) -> None:
        low, high = plan.window
        width, height = high - low
        self._columns = -(-count // rows) if width <= _WIDE * height else 1
        self._rows, self._beside = -(-count // self._columns), _GAP + _BAR + _RIGHT if bars else 0.3
        share = widest / WIDEST
        scale = min((WIDEST if self._columns == 1 else _WIDTH_IN_ROW) / width, _TALLEST / height) * share
        self._box = np.maximum([scale * width, scale * height], _SMALLEST)
        self._above = self._below = 0.0
        self._title_of_plan = _TITLE if titles else 0.0
        self.figure = Figure(figsize=self._size)
        self.canvas = FigureCanvasAgg(self.figure)
        self.plans = [self.figure.add_axes((0, 0, 1, 1)) for _ in range(count)]
        self.bars = [self.figure.add_axes((0, 0, 1, 1)) for _ in range(count if bars else 0)]
        unit = literal(f" [{length}]" if length else "")
        for place, axes in enumerate(self.plans):
            set_window(axes, plan)
            for axis, size, name in ((axes.xaxis, self._box[0], "x"), (axes.yaxis, self._box[1], "y")):
                axis.set_major_locator(MaxNLocator(int(np.clip(size / _TICKS, 2, 8)), steps=[1, 2, 5, 10]))
                axis.set_label_text(f"{name}{unit}", fontsize=LABEL_SIZE)
            put_label(axes.xaxis, 0.5, 0.0, 0.0, -0.36)
            put_label(axes.yaxis, 0.0, 0.5, -0.5, 0.0)
            # If plans are side by side, only the first has numbers on the y axis.
            axes.yaxis.set_visible(place % self._columns == 0)
        self._place()

    def artists(self) -> list[Artist]:
        """Artists of matplotlib in the plans and on the page."""
        return [artist for part in (*self.plans, self.figure) for artist in part.get_children()]

    def make_room(self, title: str, words: Sequence[str]) -> None:
        """Increase the page, if necessary, for a title above the plans and a legend with the texts ``words`` below."""
        lines = self._title(title).count("\n") + 1 if title else 0
        self._above = max(self._above, 0.12 + _LINE * lines)
        heights = [0.165 * (self._words(part).count("\n") + 1) + 0.035 for part in words]
        self._below = max(self._below, sum(heights) + 0.12 if heights else 0.0)
        self.figure.set_size_inches(*self._size)
        self._place()

    def make_room_for_label(self, text: str) -> None:
        """Increase the page, if necessary, for the label of a colour bar that is longer than the bar."""
        self._above = max(self._above, 0.5 * (text_width(text, LABEL_SIZE) - float(self._box[1])))
        self.figure.set_size_inches(*self._size)
        self._place()

    def finish(self, title: str, entries: list[Entry]) -> None:
        """Draw the title above the plans and the legend below them."""
        self.make_room(title, [words for words, _ in entries])
        across, up = self._size
        if title:
            self.figure.text(
                0.5, 1 - 0.08 / up, literal(self._title(title)), ha="center", va="top", fontsize=_TITLE_SIZE, color=INK
            )
        wrapped = [(self._words(words), samples) for words, samples in entries]
        draw_legend(self.plans[0], wrapped, (across / 2, self._below))

    def _title(self, title: str) -> str:
        return wrapped(title, self._size[0] - 0.3, _TITLE_SIZE)

    def _words(self, words: str) -> str:
        return wrapped(words, self._size[0] - _SAMPLES, LEGEND_SIZE)

    @property
    def _pitch(self) -> NDArray[np.float64]:
        """Horizontal and vertical distance between corresponding corners of neighbouring plans [inches]."""
        return np.asarray(self._box + np.array([_BETWEEN + self._beside, _BELOW + 0.1 + self._title_of_plan]))

    @property
    def _size(self) -> tuple[float, float]:
        across, up = self._pitch * [self._columns, self._rows] + [_LEFT - _BETWEEN, self._above + self._below]
        return max(float(across), _NARROWEST), float(up)

    def _place(self) -> None:
        size = np.array(self._size)
        left = 0.5 * (size[0] - self._pitch[0] * self._columns + _LEFT + _BETWEEN)
        for place, axes in enumerate(self.plans):
            row, column = divmod(place, self._columns)
            corner = self._pitch * [column, self._rows - 1 - row] + [left, self._below + _BELOW]
            axes.set_position((*(corner / size), *(self._box / size)))
            if self.bars:
                tall = min(self._box[1], _TALLEST_BAR)
                at = corner + np.array([self._box[0] + _GAP, (self._box[1] - tall) / 2])
                self.bars[place].set_position((*(at / size), *(np.array([_BAR, tall]) / size)))
