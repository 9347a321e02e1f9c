"""What pictures show, as arrays: made, and handed to another process, without matplotlib.

Outlines (k, 2) have a row of NaN between their pieces. Texts go into legends, but for labels and titles.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from signorini.shapes.arrays import Floats
from signorini.shapes.tessellation import Tessellation

Place = tuple[float, float]
Style = Literal["points", "line", "area"]
Kind = Literal["down", "up", "both", "clamped", "hinged", "symmetry"]

ACTIONS = {"down": "pushes up only", "up": "holds down only", "both": "holds both ways"}


def _nothing() -> Floats:
    return np.zeros((0, 2))


@dataclass(frozen=True)
class SupportMark:
    """A support as it is drawn.

    At points a triangle up pushes the plate up, a triangle down holds it down, a diamond does both. Along a line
    ``clamped`` has a hatch, ``hinged`` circles, and ``symmetry`` is dash-dotted.
    """

    name: str
    kind: Kind
    positions: Floats  # (k, 2): points, or the vertices of a line or outline
    closed: NDArray[np.bool_] | None = None  # (k,): in contact is filled, open is hollow; None: not known, always held
    style: Style = "points"
    boundary: Sequence[Floats] = ()  # edges of contact of an area, polylines (n, 2)
    elastic: bool = False  # drawn with a spring, or as a zigzag line
    gap: bool = False  # drawn with a bar before the mark
    words: str = ""  # what it is; by default what the kind means
    counts: tuple[int, int] | None = None  # how many points are closed and open; by default those of ``closed``
    footprints: Floats = field(default_factory=_nothing)  # outlines of what the points' reactions are spread over
    numbers: Sequence[str] = ()  # what is written beside each point

    @property
    def label(self) -> str:
        """The name, the kind, and how many points are closed and open."""
        words = f"{self.name}: {self.words or ACTIONS.get(self.kind, self.kind)}"
        counts = self.counts
        if counts is None and self.closed is not None:
            counts = int(self.closed.sum()), int((~self.closed).sum())
        return words if counts is None else f"{words}, {counts[0]} closed, {counts[1]} open"


@dataclass(frozen=True)
class LoadMark:
    """A load as it is drawn: a force is a crossed circle, one upward a dotted circle, a couple the pair of both."""

    case: str  # loads of one case have one colour
    name: str
    positions: Floats  # points, vertices of a line, or an outline; none of a load on the whole plate
    style: Style = "points"
    upward: bool = False
    couple: tuple[float, float] | None = None
    value: str = ""  # how much it is, with its unit
    footprints: Floats = field(default_factory=_nothing)

    @property
    def label(self) -> str:
        """The case, the name and the value."""
        return f"{self.case}: {self.name}{', ' if self.value else ''}{self.value}"


@dataclass(frozen=True)
class ZoneMark:
    """A zone: what it is, in the legend after its number, and its outline."""

    words: str
    outline: Floats


@dataclass(frozen=True)
class CutMark:
    """A section or a strip: its line from the first point on, and the borders (2, n, 2) of a strip."""

    name: str
    line: Floats
    borders: Floats | None = None


@dataclass(frozen=True)
class EdgeMark:
    """An edge's name, at a place of it, with the direction along which the plate is on the left."""

    name: str
    at: Place
    along: Place


@dataclass(frozen=True)
class SingularMark:
    """Places (k, 2), or a line, where numbers have no limit as the mesh is refined, or one that this mesh misses."""

    words: str
    places: Floats
    line: bool = False
    limited: bool = False


@dataclass(frozen=True)
class BalanceMark:
    """The resultant of a combination, None where it is a couple, and two points of the line about which it tips."""

    name: str
    at: Place | None
    upward: bool = False
    unbalanced: bool = False
    axis: tuple[Place, Place] | None = None


@dataclass(frozen=True, eq=False)
class PressureLayer:
    """The pressure of one area, on the elements that it is on.

    Between ``bounds`` is what the area can exert; values beyond say where there is a gap, and are not drawn.
    """

    cut: Tessellation
    values: Floats  # (v,) at the vertices, or (e,) one an element
    bounds: tuple[float, float]
    outline: Floats | None = None  # None where the elements end with the area

    @property
    def an_element(self) -> bool:
        """Whether there is one value an element."""
        return len(self.values) == len(self.cut.elements)


@dataclass(frozen=True, eq=False)
class Panel:
    """One field in a picture: values (n,) at nodes, or pressures of areas."""

    values: Floats | Sequence[PressureLayer]
    limits: tuple[float, float]  # range of the colours; of pressures with 0
    label: str = ""  # beside the colour bar
    colours: str = "RdBu"  # a map whose middle is zero
    extremes: Sequence[tuple[str, Sequence[float]]] = ()  # what is written in the picture, and where
    title: str = ""
    hatched: Floats = field(default_factory=lambda: np.zeros((0, 3)))  # (c, 3): x, y and radius of excluded discs


@dataclass(frozen=True, eq=False)
class LineDiagram:
    """Values (m, k) at stations (k, 2) of a line as ordinates along normals (k, 2): of a result, or both ends of many.

    Runs begin at the stations ``begins`` (k,). Beside the tips stand ``words``, each with its station and value; beside
    ``corners`` (c, 2) their words. ``units`` are those of values and corners, in brackets.
    """

    positions: Floats
    normals: Floats
    begins: NDArray[np.bool_]
    values: Floats
    words: Sequence[tuple[str, int, float]]
    corners: Floats
    corner_words: Sequence[str]
    units: tuple[str, str]


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture of one result: panels, of one kind with the same labels, limits and titles, or diagrams along lines."""

    panels: Sequence[Panel]
    marks: Sequence[SupportMark]
    title: str
    diagrams: Sequence[LineDiagram] = ()


@dataclass(frozen=True, eq=False)
class Sheet:
    """Pictures of one kind and in one scale, the file of each, and in how many rows their panels are.

    Where there are places ``seen``, of the nodes (n, 2) in each picture, these are views, else plans.
    """

    files: Sequence[str]
    pictures: Sequence[Picture]
    rows: int = 1
    seen: Sequence[Floats] = ()

    @property
    def panels(self) -> int:
        """How many fields are to be drawn in all."""
        return sum(len(picture.panels) or 1 for picture in self.pictures)

    @property
    def largest(self) -> float:
        """Largest ordinate of all diagrams."""
        values = [np.abs(one.values).max(initial=0.0) for picture in self.pictures for one in picture.diagrams]
        return float(max(values, default=0.0))


@dataclass(frozen=True, eq=False)
class Job:
    """Pictures of one plate: nodes (n, 2), elements (e, 8), of which some (e,) are hatched in place of a field.

    ``metadata`` are texts by name in each file.
    """

    points: Floats
    elements: NDArray[np.int64]
    sheets: Sequence[Sheet]
    metadata: Mapping[str, str]
    length: str = ""
    left_out: NDArray[np.bool_] | None = None
