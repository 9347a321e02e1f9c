"""The content of pictures as arrays, without matplotlib, so that another process can draw it.

Pieces of outlines (k, 2) are separated by rows of NaN. Texts appear in legends, except labels and titles.
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
    """A support in a picture.

    At points, a triangle that points up pushes the plate up, one that points down holds it down, and a diamond does
    both. Along a line ``clamped`` is hatched, ``hinged`` has circles, and ``symmetry`` is dash-dotted.
    A ``perimeter`` of columns is dashed.
    """

    name: str
    kind: Kind
    positions: Floats  # (k, 2): points, or the vertices of a line or outline
    closed: NDArray[np.bool_] | None = None  # (k,): filled if closed, hollow if open; None: unknown, or always held
    style: Style = "points"
    boundary: Sequence[Floats] = ()  # borders between contact and gap in an area, polylines (n, 2)
    elastic: bool = False  # elastic support: points have a spring, a line is a zigzag
    gap: bool = False  # support with a gap: a bar is drawn above the mark
    words: str = ""  # description in the legend; by default that of ``kind``
    counts: tuple[int, int] | None = None  # numbers of closed and open points; by default counted in ``closed``
    footprints: Floats = field(default_factory=_no_points)  # (k, 2): outlines of the footprints of points
    numbers: Sequence[str] = ()  # label of each point of the support

    @property
    def label(self) -> str:
        """Legend text: the name, the description, and the numbers of closed and open points."""
        words = f"{self.name}: {self.words or ACTIONS.get(self.kind, self.kind)}"
        counts = self.counts
        if counts is None and self.closed is not None:
            counts = int(self.closed.sum()), int((~self.closed).sum())
        return words if counts is None else f"{words}, {counts[0]} closed, {counts[1]} open"


@dataclass(frozen=True)
class LoadMark:
    """A load in a picture: ⊗ is a downward force, ⊙ an upward force, and ⊙–⊗ a couple."""

    case: str  # loads of a case have the same colour
    name: str
    positions: Floats  # (k, 2): points, vertices of a line, or an outline; empty for the whole plate
    style: Style = "points"
    upward: bool = False
    couple: tuple[float, float] | None = None
    value: str = ""  # text of the load's value with its unit
    footprints: Floats = field(default_factory=_no_points)

    @property
    def label(self) -> str:
        """Legend text: the case, the name and the value."""
        return f"{self.case}: {self.name}{', ' if self.value else ''}{self.value}"


@dataclass(frozen=True)
class ZoneMark:
    """A zone in a picture: its description for the legend, and its outline (k, 2)."""

    words: str
    outline: Floats


@dataclass(frozen=True)
class CutMark:
    """A section or a strip in a picture: its line (n, 2), and for a strip the two borders (2, n, 2)."""

    name: str
    line: Floats
    borders: Floats | None = None


@dataclass(frozen=True)
class EdgeMark:
    """Name of an edge in a picture, a point on the edge, and its direction there with the plate on the left."""

    name: str
    at: Place
    along: Place


@dataclass(frozen=True)
class SingularMark:
    """Points (k, 2), or a line, at which results are singular, that is, grow without limit as the mesh is refined.

    ``limited`` results have a limit, but this mesh is too coarse for them.
    """

    words: str
    places: Floats
    line: bool = False
    limited: bool = False


@dataclass(frozen=True)
class BalanceMark:
    """Resultant of a combination's loads: its position, None for a couple; two points of the tipping axis."""

    name: str
    at: Place | None
    upward: bool = False
    unbalanced: bool = False
    axis: tuple[Place, Place] | None = None


@dataclass(frozen=True, eq=False)
class PressureLayer:
    """Contact pressure of one area support on the elements that it meets.

    Values within ``bounds``, the range of pressures in the contact area, are drawn. Values outside it mean no contact.
    """

    cut: Tessellation
    values: Floats  # (v,) at the vertices of the triangles, or (e,) on the elements
    bounds: tuple[float, float]
    outline: Floats | None = None  # (k, 2), clips the picture; None if the elements follow the outline of the area

    @property
    def an_element(self) -> bool:
        """Whether ``values`` has one pressure per element."""
        return len(self.values) == len(self.cut.elements)


@dataclass(frozen=True, eq=False)
class Panel:
    """A field in a picture: values (n,) at nodes, or the contact pressures of area supports."""

    values: Floats | Sequence[PressureLayer]
    limits: tuple[float, float]  # smallest and largest coloured value; for pressures the range includes 0
    label: str = ""  # text beside the colour bar
    colours: str = "RdBu"  # name of a diverging colour map of matplotlib
    extremes: Sequence[tuple[str, Sequence[float]]] = ()  # label and point of each marked extreme
    title: str = ""
    hatched: Floats = field(default_factory=lambda: np.zeros((0, 3)))  # (c, 3): x, y, radius of discs to hatch


@dataclass(frozen=True, eq=False)
class LineDiagram:
    """Reactions per length (m, k) at stations (k, 2) of a line support, drawn along normals (k, 2).

    There is one row of values (m = 1), or a row of the largest and a row of the smallest (m = 2). ``begins`` (k,) marks
    the first station of each connected run. ``words`` are labels, each with its station and value; ``corner_words`` are
    labels of the points ``corners`` (c, 2). ``units`` are the units of values and of forces at corners, in brackets.
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
    """A picture of one result: fields side by side, or diagrams along lines.

    Pictures of one kind have panels with equal labels, limits and titles.
    """

    panels: Sequence[Panel]
    marks: Sequence[SupportMark]
    title: str
    diagrams: Sequence[LineDiagram] = ()


@dataclass(frozen=True, eq=False)
class Sheet:
    """Pictures of one kind and scale, and the file names; ``rows`` is the number of rows of panels.

    With ``seen``, for each picture the drawn positions (n, 2) of the nodes, the pictures are oblique views; otherwise
    plans.
    """

    files: Sequence[str]
    pictures: Sequence[Picture]
    rows: int = 1
    seen: Sequence[Floats] = ()

    @property
    def panels(self) -> int:
        """Number of fields to draw; a picture without fields counts as one."""
        return sum(len(picture.panels) or 1 for picture in self.pictures)

    @property
    def largest(self) -> float:
        """Largest absolute value of all diagrams."""
        values = [np.abs(diagram.values).max(initial=0.0) for picture in self.pictures for diagram in picture.diagrams]
        return float(max(values, default=0.0))


@dataclass(frozen=True, eq=False)
class Job:
    """Pictures of one plate with nodes (n, 2) and elements (e, 8); ``left_out`` (e,) marks elements to hatch.

    ``metadata`` is written to each file.
    """

    points: Floats
    elements: NDArray[np.int64]
    sheets: Sequence[Sheet]
    metadata: Mapping[str, str]
    length: str = ""
    left_out: NDArray[np.bool_] | None = None
