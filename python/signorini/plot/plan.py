"""The plan of a plate: triangles of its mesh, axes, outline, and placement of labels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.textpath import text_to_path
from matplotlib.transforms import ScaledTranslation
from matplotlib.tri import Triangulation
from numpy.typing import ArrayLike, NDArray

from signorini.shapes.arrays import Floats
from signorini.shapes.tessellation import Tessellation, tessellate

INK = "#1c2733"
_SHEET = "#eef2f5"
HATCHED: dict[str, Any] = {"facecolor": _SHEET, "edgecolor": "#aeb8c0", "hatch": "////", "linewidth": 0.0}
"""Hatch of excluded areas."""
_FINE = 4000
"""Largest number of elements that are drawn with fine triangles. If there are more, each is drawn as two triangles."""
_SAME = 1e-7
"""Distance of equal points, relative to the plate's size: far above rounding."""
_FAINTEST = 0.07
"""Smallest opacity of element edges; fainter edges are not drawn."""
_MARGIN = 0.04
"""Margin around the plate, relative to its larger side."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A mesh with the triangles, edges and outline that its pictures share."""

    nodes: Floats  # (n, 2)
    cells: NDArray[np.int64]  # (e, 8)
    left_out: NDArray[np.bool_] | None = None  # (e,): hatched in place of a field
    beside: Floats = field(default_factory=lambda: np.zeros((0, 2)))  # (k, 2): further points inside the window

    @cached_property
    def cut(self) -> Tessellation:
        """Triangles of the whole plate."""
        return tessellate(self.cells, 1 if len(self.cells) > _FINE else None)

    @cached_property
    def triangles(self) -> Triangulation:
        """The triangles of ``cut`` as a matplotlib triangulation."""
        return triangulation(self.cut, self.nodes)

    @cached_property
    def window(self) -> tuple[Floats, Floats]:
        """Lower left and upper right corner of the plan."""
        vertices = np.concatenate([np.column_stack([self.triangles.x, self.triangles.y]), self.beside])
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        margin = _MARGIN * float((high - low).max())
        return low - margin, high + margin

    @cached_property
    def edges(self) -> tuple[Path, Path, Path]:
        """Edges between elements, the outline of the plate, and inner borders, where each side has its own nodes."""
        vertices = np.column_stack([self.triangles.x, self.triangles.y])[self.cut.edges]
        # The two sides of a border have the same points in opposite order.
        steps = np.round(vertices / (_SAME * np.ptp(vertices))).astype(np.int64)
        ends = np.sort(steps[..., 0] + 1j * steps[..., 1], axis=1)
        _, which, uses = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
        border = self.cut.outer & (uses[which.ravel()] > 1)
        sorts = ~self.cut.outer, self.cut.outer & ~border, border
        return tuple(_joined(vertices[chosen]) for chosen in sorts)  # type: ignore[return-value]


def triangulation(cut: Tessellation, nodes: Floats) -> Triangulation:
    """Triangulation for matplotlib of a mesh or a part of it."""
    x, y = cut.interpolate(nodes).T
    made = Triangulation(x, y, cut.triangles)
    # Otherwise matplotlib would check the triangles for each picture.
    made.is_delaunay = False
    return made


def literal(text: str) -> str:
    """Escape a text for matplotlib, where a dollar sign begins a formula."""
    return text.replace("$", r"\$")


@cache
def _width(text: str, size: float) -> float:
    """Width of a text [inches]."""
    return float(text_to_path.get_text_width_height_descent(text, FontProperties(size=size), False)[0]) / 72


def wrapped(text: str, inches: float, size: float) -> str:
    """Wrap a text at blanks to lines of a width; words wider than a line are divided."""
    lines = [""]
    for word in text.split(" "):
        joined = f"{lines[-1]} {word}" if lines[-1] else word
        lines[-1:] = [joined] if not lines[-1] or _width(joined, size) <= inches else [lines[-1], word]
        while _width(lines[-1], size) > inches and len(lines[-1]) > 1:
            fits = max(1, int(len(lines[-1]) * inches / _width(lines[-1], size)))
            while fits > 1 and _width(lines[-1][:fits], size) > inches:
                fits -= 1
            lines[-1:] = [lines[-1][:fits], lines[-1][fits:]]
    return "\n".join(lines)


def draw_sheet(axes: Axes, plan: Plan, colour: str = _SHEET) -> Path:
    """Fill the plate with a pale colour, and return its outline with holes."""
    drawn = axes.tricontourf(plan.triangles, np.zeros(len(plan.triangles.x)), levels=[-1, 1], colors=[colour])
    return drawn.get_paths()[0]


def draw_mesh(axes: Axes, plan: Plan) -> None:
    """Draw the elements' edges, fainter the more there are."""
    fade = 0.3 * min(1.0, (900 / len(plan.cells)) ** 0.5)
    if fade > _FAINTEST:
        look: dict[str, Any] = {"facecolors": "none", "edgecolors": INK, "linewidths": 0.5, "alpha": fade}
        axes.add_collection(PathCollection(plan.edges[:1], zorder=1.8, label="_elements", **look), autolim=False)


def draw_outlines(axes: Axes, plan: Plan, hatched: bool = True) -> None:
    """Draw the plate's outline, and the borders of zones dashed; hatch excluded areas."""
    _, outline, borders = plan.edges
    if hatched and plan.left_out is not None and plan.left_out.any():
        part = Triangulation(plan.triangles.x, plan.triangles.y, plan.cut.triangles[plan.left_out[plan.cut.parents]])
        (path,) = axes.tricontourf(part, np.zeros(len(part.x)), levels=[-1, 1], alpha=0.0).get_paths()
        axes.add_patch(PathPatch(path, zorder=2.1, **HATCHED))
    look: dict[str, Any] = {"facecolors": "none", "edgecolors": INK, "linewidths": 1.2, "capstyle": "round"}
    axes.add_collection(PathCollection([outline], zorder=1.9, label="_outline", **look), autolim=False)
    if np.size(borders.vertices):
        look = {"facecolors": "none", "edgecolors": INK, "linewidths": 0.7, "linestyles": "dashed"}
        axes.add_collection(PathCollection([borders], zorder=1.9, label="_borders", **look), autolim=False)


def set_window(axes: Axes, plan: Plan) -> None:
    """Set the limits of the axes, with equal scales."""
    axes.set_aspect("equal")
    (x0, y0), (x1, y1) = plan.window
    axes.set_xlim(x0, x1)
    axes.set_ylim(y0, y1)
    axes.spines[:].set_visible(False)
    axes.tick_params(bottom=False, left=False, labelsize=8.5)


def figure_of(axes: Axes) -> Figure:
    """Return the figure that contains the axes."""
    figure = axes.get_figure(root=True)
    assert figure is not None, "axes are made with their figure"
    return figure


def put_label(axis: Axis, across: float, up: float, right: float, above: float) -> None:
    """Place the label of an axis at a fixed offset [inches] from its axes; automatic placement is slow."""
    away = ScaledTranslation(right, above, figure_of(axis.axes).dpi_scale_trans)
    axis.set_label_coords(across, up, axis.axes.transAxes + away)


def inches_per_unit(axes: Axes) -> float:
    """Drawn size of a unit of length of the plate [inches]."""
    size = axes.get_position(original=True).size * figure_of(axes).get_size_inches()
    spans = np.abs([np.diff(axes.get_xlim())[0], np.diff(axes.get_ylim())[0]])
    return float((size / spans).min())


def _joined(chains: Floats) -> Path:
    """Put polylines (k, n, 2) into one path."""
    codes = np.full(chains.shape[:2], Path.LINETO, Path.code_type)
    codes[:, 0] = Path.MOVETO
    return Path(chains.reshape(-1, 2), codes.ravel())


def runs(outline: Floats) -> list[slice]:
    """Slices of a polyline (k, 2) between its rows of NaN."""
    ends = [-1, *np.flatnonzero(np.isnan(outline[:, 0])).tolist(), len(outline)]
    return [slice(a + 1, b) for a, b in pairwise(ends) if b > a + 1]


def pieces(outline: Floats) -> list[Floats]:
    """Split a polyline (k, 2) at its rows of NaN."""
    return [outline[rows] for rows in runs(outline)]


def enclosed(outline: Floats) -> Path:
    """The area enclosed by closed polylines (k, 2), separated by rows of NaN: the first without the others."""
    parts = []
    for number, loop in enumerate(pieces(outline)):
        (x, y), (u, v) = loop[:-1].T, loop[1:].T
        # The outline is made counterclockwise and holes clockwise, so that the path excludes the holes.
        turned = float(np.sum(x * v - y * u)) > 0.0
        codes = [Path.MOVETO, *[Path.LINETO] * (len(loop) - 2), Path.CLOSEPOLY]
        parts.append(Path(loop if turned == (number == 0) else loop[::-1], codes))
    return Path.make_compound_path(*parts)


PAPER = {"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 0.6}
"""Style of the background of text on colours."""
_LETTER, _LINE = 0.6, 1.25
"""Width of a letter and height of a line, relative to the font size."""
_AROUND = np.array([[1, 1], [-1, 1], [1, -1], [-1, -1], [0, 1], [0, -1], [1, 0], [-1, 0]], dtype=np.float64)
_FAR = (5.0, 14.0, 26.0, 40.0)
"""Distances from a point to its label [points], in order of preference."""
_LEADER = 10.0
"""Smallest distance [points] of a label from its position with a line between them."""
_APART, _MISTAKEN = 3.0, 400
"""Distance [points] by which a label must be nearer to its own position than to others, and the cost if it is not."""
_ON_WORDS, _OUTSIDE, _ON_MARKS = 20.0, 10.0, 6.0
"""Costs of covering text, of leaving the plan, and of covering marks; the eighth candidate position costs 1."""


@dataclass(eq=False)
class Labels:
    """Text in axes with fixed limits; occupied boxes (k, 4) are in points from the lower left of the axes."""

    axes: Axes
    words: list[Floats] = field(default_factory=list)
    marks: list[Floats] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Measure the axes."""
        self.scale = 72.0 * inches_per_unit(self.axes)
        (left, right), (low, high) = self.axes.get_xlim(), self.axes.get_ylim()
        self._corner = np.array([left, low])
        self._size = np.array([right - left, high - low]) * self.scale

    def points(self, at: ArrayLike) -> Floats:
        """Convert positions (k, 2) of the plan to points from its lower left corner."""
        return np.asarray((np.atleast_2d(np.asarray(at, dtype=np.float64)) - self._corner) * self.scale)

    def keep_free(self, at: ArrayLike, size: float) -> None:
        """Reserve squares of width ``size`` [points] at the positions (k, 2) of marks."""
        middle = self.points(at)
        self.marks.append(np.hstack([middle - 0.5 * size, middle + 0.5 * size]))

    def beside(
        self, words: str, places: ArrayLike, size: float = 8.0, color: str = INK, others: ArrayLike = (), **look: Any
    ) -> None:
        """Write a label at one of the candidate positions (k, 2), preferably the first; a distant label has a line.

        The label is not closer to ``others`` (r, 2), positions with other labels.
        """
        at = np.atleast_2d(np.asarray(places, dtype=np.float64))
        extent = np.array([_LETTER * len(words), _LINE]) * size
        ways = np.concatenate([gap * _AROUND for gap in _FAR])
        moved = np.tile(ways, (len(at), 1)) + 0.5 * extent * np.sign(np.tile(ways, (len(at), 1)))
        anchors = np.repeat(np.arange(len(at)), len(ways))
        order = np.tile(np.arange(len(ways)), len(at)) + 3 * anchors
        middles, own = self.points(at)[anchors] + moved, self.points(at)[anchors]
        beside_others = np.zeros(len(moved), np.bool_)
        for other in self.points(others) if np.size(others) else ():
            away = [_away(middles, extent, place) for place in (other, own)]
            beside_others |= away[0] <= away[1] + _APART
        best = self._best(middles, extent, order + _MISTAKEN * beside_others)
        anchor, (x, y) = at[anchors[best]], moved[best]
        offset: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "center"}
        if np.abs(ways[best % len(ways)]).max() > _LEADER:
            offset["arrowprops"] = {"arrowstyle": "-", "color": color, "linewidth": 0.6, "shrinkA": 0, "shrinkB": 3}
        self.axes.annotate(literal(words), tuple(anchor), (x, y), **offset, **_look(size, color, look))

    def along(
        self, words: str, places: ArrayLike, turns: Sequence[float], size: float, color: str = INK, **look: Any
    ) -> None:
        """Write a text at one of the positions (k, 2), rotated there by ``turns``; skip it if no position is free."""
        at, angle = np.atleast_2d(np.asarray(places, dtype=np.float64)), np.radians(turns)
        long, high = _LETTER * len(words) * size, _LINE * size
        cos, sin = np.abs(np.cos(angle)), np.abs(np.sin(angle))
        extent = np.column_stack([long * cos + high * sin, long * sin + high * cos])
        best = self._best(self.points(at), extent, np.arange(len(at)), free=True)
        if best >= 0:
            x, y = at[best].tolist()
            turned = self.axes.text(x, y, literal(words), ha="center", va="center", rotation_mode="anchor")
            turned.set(rotation=turns[best], **_look(size, color, look))

    def _best(self, middles: Floats, extent: Floats, order: NDArray[np.int64], free: bool = False) -> int:
        """Choose the box of least cost among centers (k, 2) [points]; -1 if ``free`` is required and impossible."""
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


def _away(middles: Floats, extent: Floats, places: Floats) -> Floats:
    """Distances (c,) of positions (c, 2) from boxes with centers ``middles`` (c, 2)."""
    return np.asarray(np.hypot(*np.maximum(np.abs(places - middles) - 0.5 * extent, 0.0).T))


def _look(size: float, color: str, look: dict[str, Any]) -> dict[str, Any]:
    return {"fontsize": size, "color": color, "zorder": 7, "bbox": PAPER} | look


def _covered(boxes: Floats, taken: Sequence[Floats]) -> Floats:
    """Areas (k,) of boxes (k, 4) covered by occupied boxes."""
    if not taken:
        return np.zeros(len(boxes))
    others = np.concatenate(taken)
    low = np.maximum(boxes[:, None, :2], others[:, :2])
    high = np.minimum(boxes[:, None, 2:], others[:, 2:])
    return np.asarray(np.prod(np.maximum(high - low, 0.0), axis=2).sum(axis=1))
