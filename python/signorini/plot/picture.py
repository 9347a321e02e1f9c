"""What pictures show of results, as arrays: made, and handed to another process, without matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from signorini.shapes.tessellation import Tessellation

_ACTIONS = {
    "down": "pushes up only",
    "up": "holds down only",
    "both": "holds both ways",
    "clamped": "clamped",
    "hinged": "hinged",
    "symmetry": "symmetry",
}
Kind = Literal["down", "up", "both", "clamped", "hinged", "symmetry"]


@dataclass(frozen=True)
class SupportMark:
    """A support as it is drawn.

    Attributes
    ----------
    name : str
        Its name in the legend.
    kind : {"down", "up", "both", "clamped", "hinged", "symmetry"}
        Which way it resists: a triangle up pushes the plate up, a triangle down holds it down, a diamond does both.
        Along a line ``clamped`` has a hatch, ``hinged`` circles, and ``symmetry`` is dash-dotted.
    positions : ndarray, shape (k, 2)
        Points, or the vertices of a line or outline; a row of NaN starts a new piece.
    closed : ndarray of bool, shape (k,), or None
        What is in contact (filled) and what is open (hollow). None: not known or always held.
    style : {"points", "line", "area"}
    boundary : sequence of ndarray, shape (k, 2)
        The edge of contact of an area, as polylines.
    elastic : bool
        Drawn with a spring, or as a zigzag line.
    gap : bool
        Whether it has free travel: there is a bar before its mark.
    words : str
        What it is, in the legend; by default what the kind means.
    counts : (int, int) or None
        How many points are closed and open, in the legend; by default those of ``closed``.
    footprints : ndarray, shape (k, 2)
        Outlines of what the points' reactions are spread over; a row of NaN starts a new one.
    """

    name: str
    kind: Kind
    positions: NDArray[np.float64]
    closed: NDArray[np.bool_] | None = None
    style: Literal["points", "line", "area"] = "points"
    boundary: Sequence[NDArray[np.float64]] = ()
    elastic: bool = False
    gap: bool = False
    words: str = ""
    counts: tuple[int, int] | None = None
    footprints: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 2)))

    @property
    def label(self) -> str:
        """What the legend says: the name, the kind, and how many points are closed and open."""
        words = f"{self.name}: {self.words or _ACTIONS[self.kind]}"
        counts = self.counts
        if counts is None and self.closed is not None:
            counts = int(self.closed.sum()), int((~self.closed).sum())
        return words if counts is None else f"{words}, {counts[0]} closed, {counts[1]} open"


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
    largest : (float, (x, y)) or None
        The largest pressure and its place, where they are known better than from the vertices.
    """

    cut: Tessellation
    values: NDArray[np.float64]
    bounds: tuple[float, float]
    outline: NDArray[np.float64] | None = None
    largest: tuple[float, Sequence[float]] | None = None

    @property
    def an_element(self) -> bool:
        """Whether there is one value an element."""
        return len(self.values) == len(self.cut.elements)


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
    extremes : sequence of (str, (x, y))
        What is written in the picture, and where.
    title : str
        Above the panel.
    """

    values: NDArray[np.float64] | Sequence[PressureLayer]
    label: str = ""
    colours: str = "RdBu"
    limits: tuple[float, float] | None = None
    extremes: Sequence[tuple[str, Sequence[float]]] = ()
    title: str = ""


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture of one result.

    Attributes
    ----------
    panels : sequence of Panel
        Those of one kind have the same labels, limits and titles.
    marks : sequence of SupportMark
    title : str
    """

    panels: Sequence[Panel]
    marks: Sequence[SupportMark]
    title: str


@dataclass(frozen=True, eq=False)
class Sheet:
    """Pictures of one kind, in one scale.

    Attributes
    ----------
    files : sequence of str
        A name for each.
    pictures : sequence of Picture
    rows : int
        How many rows the panels of each are in.
    """

    files: Sequence[str]
    pictures: Sequence[Picture]
    rows: int = 1

    @property
    def panels(self) -> int:
        """How many fields are to be drawn in all."""
        return sum(len(picture.panels) for picture in self.pictures)


@dataclass(frozen=True, eq=False)
class Job:
    """Pictures of one plate.

    Attributes
    ----------
    points : ndarray, shape (n, 2)
    elements : ndarray of int, shape (e, 8)
    sheets : sequence of Sheet
    length : str
        The unit of length, for the axes.
    left_out : ndarray of bool, shape (e,), or None
        Elements that are hatched in place of a field.
    """

    points: NDArray[np.float64]
    elements: NDArray[np.int64]
    sheets: Sequence[Sheet]
    length: str = ""
    left_out: NDArray[np.bool_] | None = None
