"""Words in a plan, each beside its place and none on another one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike, NDArray

from signorini.plot.plan import INK, inches_per_unit, literal

PAPER = {"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 0.6}
"""Behind what is written on colours."""
_LETTER, _LINE = 0.6, 1.25
"""Of the size of a font, how wide a letter is and how high a line."""
_AROUND = np.array([[1, 1], [-1, 1], [1, -1], [-1, -1], [0, 1], [0, -1], [1, 0], [-1, 0]], dtype=np.float64)
_FAR = (5.0, 14.0, 26.0, 40.0)
"""Points from a place to the words beside it: nearer ones first."""
_LEADER = 10.0
"""Points from which on a line leads from the words to their place."""
_ON_WORDS, _OUTSIDE, _ON_MARKS = 20.0, 10.0, 6.0
"""What it costs to cover words, to leave the plan and to cover marks, against 1 for the eighth of the candidates."""


@dataclass(eq=False)
class Labels:
    """What is written in axes, whose limits are set.

    Attributes
    ----------
    axes : Axes
    words, marks : list of ndarray, shape (k, 4)
        Boxes that are taken, in points from the axes' lower left: left, bottom, right, top.
    """

    axes: Axes
    words: list[NDArray[np.float64]] = field(default_factory=list)
    marks: list[NDArray[np.float64]] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Measure the axes."""
        self.scale = 72.0 * inches_per_unit(self.axes)
        (left, right), (low, high) = self.axes.get_xlim(), self.axes.get_ylim()
        self._corner = np.array([left, low])
        self._size = np.array([right - left, high - low]) * self.scale

    def points(self, at: ArrayLike) -> NDArray[np.float64]:
        """Turn places (k, 2) of the plan into points from its lower left."""
        return np.asarray((np.atleast_2d(np.asarray(at, dtype=np.float64)) - self._corner) * self.scale)

    def keep_free(self, at: ArrayLike, size: float) -> None:
        """Let no words be put on marks at places (k, 2), so many points wide."""
        middle = self.points(at)
        self.marks.append(np.hstack([middle - 0.5 * size, middle + 0.5 * size]))

    def beside(self, words: str, places: ArrayLike, size: float = 8.0, color: str = INK, **look: Any) -> None:
        """Write words beside one of the places (k, 2), the first one if that is free; a line leads to it from afar."""
        at = np.atleast_2d(np.asarray(places, dtype=np.float64))
        extent = np.array([_LETTER * len(words), _LINE]) * size
        ways = np.concatenate([gap * _AROUND for gap in _FAR])
        moved = np.tile(ways, (len(at), 1)) + 0.5 * extent * np.sign(np.tile(ways, (len(at), 1)))
        anchors = np.repeat(np.arange(len(at)), len(ways))
        order = np.tile(np.arange(len(ways)), len(at)) + 3 * anchors
        best = self._best(self.points(at)[anchors] + moved, extent, order)
        anchor, (x, y) = at[anchors[best]], moved[best]
        offset: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "center"}
        if np.abs(ways[best % len(ways)]).max() > _LEADER:
            offset["arrowprops"] = {"arrowstyle": "-", "color": color, "linewidth": 0.6, "shrinkA": 0, "shrinkB": 3}
        self.axes.annotate(literal(words), tuple(anchor), (x, y), **offset, **_look(size, color, look))

    def along(
        self, words: str, places: ArrayLike, turns: Sequence[float], size: float, color: str = INK, **look: Any
    ) -> None:
        """Write words on one of the places (k, 2), turned by so many degrees there; nothing where none is free."""
        at, angle = np.atleast_2d(np.asarray(places, dtype=np.float64)), np.radians(turns)
        long, high = _LETTER * len(words) * size, _LINE * size
        cos, sin = np.abs(np.cos(angle)), np.abs(np.sin(angle))
        extent = np.column_stack([long * cos + high * sin, long * sin + high * cos])
        best = self._best(self.points(at), extent, np.arange(len(at)), free=True)
        if best >= 0:
            x, y = at[best].tolist()
            turned = self.axes.text(x, y, literal(words), ha="center", va="center", rotation_mode="anchor")
            turned.set(rotation=turns[best], **_look(size, color, look))

    def _best(
        self, middles: NDArray[np.float64], extent: NDArray[np.float64], order: NDArray[np.int64], free: bool = False
    ) -> int:
        """Take the box that costs least, of middles (k, 2) in points; -1 if it must be free and none is."""
        boxes = np.hstack([middles - 0.5 * extent, middles + 0.5 * extent])
        area = np.prod(np.broadcast_to(extent, middles.shape), axis=1)
        on_words = _covered(boxes, self.words) / area
        outside = 1.0 - _covered(boxes, [np.append(0.0 * self._size, self._size)[None]]) / area
        cost = order / len(_AROUND) + _ON_WORDS * on_words + _OUTSIDE * outside
        cost += _ON_MARKS * _covered(boxes, self.marks) / area
        best = int(cost.argmin())
        if free and on_words[best] > 0.0:
            return -1
        self.words.append(boxes[best][None])
        return best


def _look(size: float, color: str, look: dict[str, Any]) -> dict[str, Any]:
    return {"fontsize": size, "color": color, "zorder": 7, "bbox": PAPER} | look


def _covered(boxes: NDArray[np.float64], taken: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Sum the areas that boxes (k, 4) share with those that are taken."""
    if not taken:
        return np.zeros(len(boxes))
    others = np.concatenate(taken)
    low = np.maximum(boxes[:, None, :2], others[:, :2])
    high = np.minimum(boxes[:, None, 2:], others[:, 2:])
    return np.asarray(np.prod(np.maximum(high - low, 0.0), axis=2).sum(axis=1))
