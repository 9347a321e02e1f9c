"""The content of pictures as arrays, without matplotlib, for another process to draw.

Outlines (k, 2) have a row of NaN between their pieces. Texts appear in legends, except labels and titles.
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
Kind = Literal["down", "up", "both", "clamped", "hinged", "symmetry", "perimeter"]

ACTIONS = {"down": "pushes up only", "up": "holds down only", "both": "holds in both directions"}


def _no_points() -> Floats:
    return np.zeros((0, 2))


@dataclass(frozen=True)
class SupportMark:
    """A drawn support.

    Symbols at points: a triangle up pushes the plate up, a triangle down holds it down, a diamond does both. Along a
    line ``clamped`` is hatched, ``hinged`` has circles, and ``symmetry`` is dash-dotted.
    A ``perimeter`` of columns is dashed.
    """

    name: str
    kind: Kind
    positions: Floats  # (k, 2): points, or the vertices of a line or outline
    closed: NDArray[np.bool_] | None = None  # (k,): filled if closed, hollow if open; None: unknown, or always held
    style: Style = "points"
    boundary: Sequence[Floats] = ()  # edges of contact of an area, polylines (n, 2)
    elastic: bool = False  # drawn with a spring, or as a zigzag line
    gap: bool = False  # drawn with a bar before the mark
    words: str = ""  # description; by default that of ``kind``
    counts: tuple[int, int] | None = None  # numbers of closed and open points; by default counted in ``closed``
    footprints: Floats = field(default_factory=_no_points)  # outlines of the footprints of the points
    numbers: Sequence[str] = ()  # a label for each point

    @property
    def label(self) -> str:
        """The name, the description, and the numbers of closed and open points."""
        words = f"{self.name}: {self.words or ACTIONS.get(self.kind, self.kind)}"
        counts = self.counts
        if counts is None and self.closed is not None:
            counts = int(self.closed.sum()), int((~self.closed).sum())
        return words if counts is None else f"{words}, {counts[0]} closed, {counts[1]} open"


@dataclass(frozen=True)
class LoadMark:
    """A drawn load: ⊗ a downward force, ⊙ an upward force, ⊙–⊗ a couple."""

    case: str  # loads of one case have one colour
    name: str
    positions: Floats  # points, vertices of a line, or an outline; empty for the whole plate
    style: Style = "points"
    upward: bool = False
    couple: tuple[float, float] | None = None
    value: str = ""  # value with its unit
    footprints: Floats = field(default_factory=_no_points)

    @property
    def label(self) -> str:
        """The case, the name and the value."""
        return f"{self.case}: {self.name}{', ' if self.value else ''}{self.value}"


@dataclass(frozen=True)
class ZoneMark:
    """A zone: its description for the legend, and its outline."""

    words: str
    outline: Floats


@dataclass(frozen=True)
class CutMark:
    """A section or a strip: its line, and the borders (2, n, 2) of a strip."""

    name: str
    line: Floats
    borders: Floats | None = None


@dataclass(frozen=True)
class EdgeMark:
    """The name of an edge, a point on it, and its direction with the plate on the left."""

    name: str
    at: Place
    along: Place


@dataclass(frozen=True)
class SingularMark:
    """Points (k, 2), or a line, at which numbers grow without limit; ``limited``: this mesh is too coarse there."""

    words: str
    places: Floats
    line: bool = False
    limited: bool = False


@dataclass(frozen=True)
class BalanceMark:
    """Position of a combination's resultant (None for a couple), and two points of its tipping axis."""

    name: str
    at: Place | None
    upward: bool = False
    unbalanced: bool = False
    axis: tuple[Place, Place] | None = None


@dataclass(frozen=True, eq=False)
class PressureLayer:
    """The pressure of one area on its elements.

    Pressures are drawn between ``bounds``, the range of the area; values outside mark a gap.
    """

    cut: Tessellation
    values: Floats  # (v,) at the vertices, or (e,) one per element
    bounds: tuple[float, float]
    outline: Floats | None = None  # None if the elements follow the outline of the area

    @property
    def an_element(self) -> bool:
        """Whether there is one value per element."""
        return len(self.values) == len(self.cut.elements)


@dataclass(frozen=True, eq=False)
class Panel:
    """One field in a picture: values (n,) at nodes, or pressures of areas."""

    values: Floats | Sequence[PressureLayer]
    limits: tuple[float, float]  # range of the colours; includes 0 for pressures
    label: str = ""  # label of the colour bar
    colours: str = "RdBu"  # a diverging colour map
    extremes: Sequence[tuple[str, Sequence[float]]] = ()  # labels and their points
    title: str = ""
    hatched: Floats = field(default_factory=lambda: np.zeros((0, 3)))  # (c, 3): x, y and radius of excluded discs


@dataclass(frozen=True, eq=False)
class LineDiagram:
    """Values (m, k) at stations (k, 2) of a line, drawn along normals (k, 2): one row, or largest and smallest values.

    ``begins`` (k,) marks the first station of each connected run. ``words`` are labels, each with its station and
    value; ``corner_words`` are labels of ``corners`` (c, 2). ``units`` are those of values and corners, in brackets.
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
    """A picture of one result: panels with equal labels, limits and titles for each kind, or diagrams along lines."""

    panels: Sequence[Panel]
    marks: Sequence[SupportMark]
    title: str
    diagrams: Sequence[LineDiagram] = ()


@dataclass(frozen=True, eq=False)
class Sheet:
    """Pictures of one kind and scale, with their files; ``rows`` is the number of rows of panels.

    With ``seen``, the positions of the nodes (n, 2) in each picture, they are oblique views, else plans.
    """

    files: Sequence[str]
    pictures: Sequence[Picture]
    rows: int = 1
    seen: Sequence[Floats] = ()

    @property
    def panels(self) -> int:
        """Total number of fields to draw."""
        return sum(len(picture.panels) or 1 for picture in self.pictures)

    @property
    def largest(self) -> float:
        """Largest ordinate of all diagrams."""
        values = [np.abs(diagram.values).max(initial=0.0) for picture in self.pictures for diagram in picture.diagrams]
        return float(max(values, default=0.0))


@dataclass(frozen=True, eq=False)
class Job:
    """Pictures of one plate with nodes (n, 2) and elements (e, 8); ``left_out`` (e,) marks elements that are hatched.

    ``metadata`` are written to each file.
    """

    points: Floats
    elements: NDArray[np.int64]
    sheets: Sequence[Sheet]
    metadata: Mapping[str, str]
    length: str = ""
    left_out: NDArray[np.bool_] | None = None
