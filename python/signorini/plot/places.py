"""What has a name or is named in a plan: edges, and places where numbers have no limit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from signorini.plot.labels import Labels
from signorini.plot.marks import Entry

_NAME, _SINGULAR = "#5d6b78", "#d6006c"
_INWARD = 8.0
"""Points from an edge to the middle of its name."""
_FEW = 60
"""Places that are each drawn with a ring about them; of more there are dots."""
_MOST_WORDS = 3
_PLACES = np.array([0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5])
"""Where the name of an edge may stand, from its middle, in fifths of its length."""


@dataclass(frozen=True)
class EdgeMark:
    """An edge's name, at a place of it, with the direction along which the plate is on the left."""

    name: str
    at: tuple[float, float]
    along: tuple[float, float]


@dataclass(frozen=True)
class SingularMark:
    """Places (k, 2), or a line, where numbers have no limit as the mesh is refined, or one that this mesh misses."""

    words: str
    places: NDArray[np.float64]
    line: bool = False
    limited: bool = False


def draw_edges(marks: Iterable[EdgeMark], labels: Labels) -> None:
    """Write the names of edges along them, on the plate, where there is room."""
    for mark in marks:
        along = np.array(mark.along)
        x, y = along / max(float(np.hypot(*along)), 1e-300)
        turn = float((np.degrees(np.arctan2(y, x)) + 90) % 180 - 90)
        at = np.array(mark.at) + _INWARD / labels.scale * np.array([-y, x]) + _PLACES[:, None] * along
        labels.along(mark.name, at, [turn] * len(at), 7.5, _NAME, zorder=3.6)


def draw_singular(marks: Sequence[SingularMark], axes: Axes) -> list[Entry]:
    """Ring the places where numbers have no limit, and return their entries in the legend."""
    entries: list[Entry] = []
    for limited, means in ((False, "no limit as the mesh is refined"), (True, "too small for this mesh")):
        those = [mark for mark in marks if mark.limited == limited]
        if not those:
            continue
        count = sum(len(mark.places) for mark in those if not mark.line)
        look: dict[str, Any] = {"color": _SINGULAR, "linestyle": "none", "marker": "o"}
        look |= {"markerfacecolor": "none", "markeredgewidth": 0.9, "clip_on": False}
        look |= {"markersize": 13.0} if count <= _FEW else {"markersize": 1.5}
        for mark in those:
            if mark.line:
                axes.plot(*mark.places.T, color=_SINGULAR, linewidth=1.2, linestyle=(0, (3, 2)), zorder=6.2)
            else:
                axes.plot(*mark.places.T, zorder=6.2, **look)
        words = list(dict.fromkeys(mark.words for mark in those))
        more = f" and {len(words) - _MOST_WORDS} more" if len(words) > _MOST_WORDS else ""
        sample = Line2D([], [], **look | {"markersize": 9.0})
        entries.append((f"{means}: {', '.join(words[:_MOST_WORDS])}{more}", (sample,)))
    return entries
