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
LABEL_SIZE = 9.0
"""Font size of the labels of axes and colour bars [points]."""
_SHEET = "#eef2f5"
HATCHED: dict[str, Any] = {"facecolor": _SHEET, "edgecolor": "#aeb8c0", "hatch": "////", "linewidth": 0.0}
"""Style of the hatching of elements that extremes exclude."""
_FINE = 4000
"""Largest number of elements that are each drawn as several triangles; if there are more, each is drawn as two."""
_SAME = 1e-7
"""Largest distance of points that coincide, relative to the plate's size: far above rounding."""
_FAINTEST = 0.07
"""Smallest opacity of drawn element edges; if it would be less, edges are not drawn."""
_MARGIN = 0.04
"""Margin around the plate, relative to the longer side of the plate."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A mesh in plan, with the triangles, edges and outline that all pictures use."""

    nodes: Floats  # (n, 2): positions of the nodes
    cells: NDArray[np.int64]  # (e, 8): node numbers of the elements
    left_out: NDArray[np.bool_] | None = None  # (e,): elements that are hatched and show no field
    beside: Floats = field(default_factory=lambda: np.zeros((0, 2)))  # (k, 2): more points in the picture

    @cached_property
    def cut(self) -> Tessellation:
        """Division of all elements into flat triangles."""
        return tessellate(self.cells, 1 if len(self.cells) > _FINE else None)

    @cached_property
    def triangles(self) -> Triangulation:
        """The triangles of ``cut`` as a matplotlib triangulation."""
        return triangulation(self.cut, self.nodes)

    @cached_property
    def window(self) -> tuple[Floats, Floats]:
        """Lower left and upper right corner of the drawn part of the plane."""
        vertices = np.concatenate([np.column_stack([self.triangles.x, self.triangles.y]), self.beside])
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        margin = _MARGIN * float((high - low).max())
        return low - margin, high + margin

    @cached_property
    def edges(self) -> tuple[Path, Path, Path]:
        """Edges between elements; the plate's outline; inner borders, where elements on either side share no nodes."""
        vertices = np.column_stack([self.triangles.x, self.triangles.y])[self.cut.edges]
        # Along an inner border, the edges of the two elements have the same points in opposite order.
        steps = np.round(vertices / (_SAME * np.ptp(vertices))).astype(np.int64)
        ends = np.sort(steps[..., 0] + 1j * steps[..., 1], axis=1)
        _, which, uses = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
        border = self.cut.outer & (uses[which.ravel()] > 1)
        sorts = ~self.cut.outer, self.cut.outer & ~border, border
        return tuple(_joined(vertices[chosen]) for chosen in sorts)  # type: ignore[return-value]


def triangulation(cut: Tessellation, nodes: Floats) -> Triangulation:
    """Convert triangles and node positions (n, 2) to a triangulation of matplotlib."""
    x, y = cut.interpolate(nodes).T
    made = Triangulation(x, y, cut.triangles)
    # Without this line matplotlib would test for each picture whether these are Delaunay triangles.
    made.is_delaunay = False
    return made


def literal(text: str) -> str:
    """Escape the dollar signs of a text, with which formulas of matplotlib begin."""
    return text.replace("$", r"\$")


@cache
def text_width(text: str, size: float) -> float:
    """Width [inches] of a text with the font size ``size`` [points]."""
    return float(text_to_path.get_text_width_height_descent(text, FontProperties(size=size), False)[0]) / 72


def wrapped(text: str, inches: float, size: float) -> str:
    """Divide a text at blanks into lines of at most ``inches``; a longer word is divided anywhere."""
    lines = [""]
    for word in text.split(" "):
        joined = f"{lines[-1]} {word}" if lines[-1] else word
        lines[-1:] = [joined] if not lines[-1] or text_width(joined, size) <= inches else [lines[-1], word]
        while text_width(lines[-1], size) > inches and len(lines[-1]) > 1:
            fits = max(1, int(len(lines[-1]) * inches / text_width(lines[-1], size)))
            while fits > 1 and text_width(lines[-1][:fits], size) > inches:
                fits -= 1
            lines[-1:] = [lines[-1][:fits], lines[-1][fits:]]
    return "\n".join(lines)


def draw_sheet(axes: Axes, plan: Plan, colour: str = _SHEET) -> Path:
    """Fill the plate with a pale colour; return the outline of the plate with its holes."""
    drawn = axes.tricontourf(plan.triangles, np.zeros(len(plan.triangles.x)), levels=[-1, 1], colors=[colour])
    return drawn.get_paths()[0]


def draw_mesh(axes: Axes, plan: Plan) -> None:
    """Draw the edges of elements, fainter in finer meshes."""
    fade = 0.3 * min(1.0, (900 / len(plan.cells)) ** 0.5)
    if fade > _FAINTEST:
        look: dict[str, Any] = {"facecolors": "none", "edgecolors": INK, "linewidths": 0.5, "alpha": fade}
        axes.add_collection(PathCollection(plan.edges[:1], zorder=1.8, label="_elements", **look), autolim=False)


def draw_outlines(axes: Axes, plan: Plan, hatched: bool = True) -> None:
    """Draw the plate's outline, and dashed the lines where moments and shears jump; hatch excluded elements."""
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
    """Set the limits of the axes to the plan's window, with equal scales along x and y."""
    axes.set_aspect("equal")
    (x0, y0), (x1, y1) = plan.window
    axes.set_xlim(x0, x1)
    axes.set_ylim(y0, y1)
    axes.spines[:].set_visible(False)
    axes.tick_params(bottom=False, left=False, labelsize=8.5)


def figure_of(axes: Axes) -> Figure:
    """Return the figure that contains the axes."""
    figure = axes.get_figure(root=True)
    assert figure is not None, "axes without a figure"
    return figure


def put_label(axis: Axis, across: float, up: float, right: float, above: float) -> None:
    """Place the label of an axis at fractions of the axes plus an offset [inches]; automatic placement is slow."""
    away = ScaledTranslation(right, above, figure_of(axis.axes).dpi_scale_trans)
    axis.set_label_coords(across, up, axis.axes.transAxes + away)


def inches_per_unit(axes: Axes) -> float:
    """Length in the drawing [inches] of one unit of the plate's length."""
    size = axes.get_position(original=True).size * figure_of(axes).get_size_inches()
    spans = np.abs([np.diff(axes.get_xlim())[0], np.diff(axes.get_ylim())[0]])
    return float((size / spans).min())


def _joined(chains: Floats) -> Path:
    """Join k polylines (k, n, 2) in one path."""
    codes = np.full(chains.shape[:2], Path.LINETO, Path.code_type)
    codes[:, 0] = Path.MOVETO
    return Path(chains.reshape(-1, 2), codes.ravel())


def runs(outline: Floats) -> list[slice]:
    """Slices of the rows of a polyline (k, 2) between rows of NaN, which separate its pieces."""
    ends = [-1, *np.flatnonzero(np.isnan(outline[:, 0])).tolist(), len(outline)]
    return [slice(a + 1, b) for a, b in pairwise(ends) if b > a + 1]


def pieces(outline: Floats) -> list[Floats]:
    """Split a polyline (k, 2) at its rows of NaN."""
    return [outline[rows] for rows in runs(outline)]


def enclosed(outline: Floats) -> Path:
    """The area inside the first of several closed polylines and outside the others; rows of NaN separate them."""
    parts = []
    for number, loop in enumerate(pieces(outline)):
        (x, y), (u, v) = loop[:-1].T, loop[1:].T
        # The path excludes holes if the outline is counterclockwise and the holes are clockwise.
        turned = float(np.sum(x * v - y * u)) > 0.0
        codes = [Path.MOVETO, *[Path.LINETO] * (len(loop) - 2), Path.CLOSEPOLY]
        parts.append(Path(loop if turned == (number == 0) else loop[::-1], codes))
    return Path.make_compound_path(*parts)


PAPER = {"facecolor": "white", "alpha": 0.75, "linewidth": 0, "pad": 0.6}
"""Style of the white background of text on colours."""
_LETTER, _LINE = 0.6, 1.25
"""Assumed width of a letter and height of a line, relative to the font size."""
_AROUND = np.array([[1, 1], [-1, 1], [1, -1], [-1, -1], [0, 1], [0, -1], [1, 0], [-1, 0]], dtype=np.float64)
_FAR = (5.0, 14.0, 26.0, 40.0)
"""Distances from a point to its label [points], in order of preference."""
_LEADER = 10.0
"""Smallest distance from a label to its point at which a line joins them [points]."""
_APART, _MISTAKEN = 3.0, 400
"""Distance [points] by which a label must be nearer to its own point than to other points; cost, in eighths, of a label
that is not."""
_ON_WORDS, _OUTSIDE, _ON_MARKS = 20.0, 10.0, 6.0
"""Costs of a label wholly on text, outside the plan, or on marks; each further candidate position costs 1/8 more."""


@dataclass(eq=False)
class Labels:
    """Places labels in axes with fixed limits so that they do not overlap.

    ``words`` and ``marks`` are boxes (k, 4) that texts and marks occupy, in points from the lower left corner of the
    axes.
    """

    axes: Axes
    words: list[Floats] = field(default_factory=list)
    marks: list[Floats] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Compute scale and size of the axes in points."""
        self.scale = 72.0 * inches_per_unit(self.axes)
        (left, right), (low, high) = self.axes.get_xlim(), self.axes.get_ylim()
        self._corner = np.array([left, low])
        self._size = np.array([right - left, high - low]) * self.scale

    def points(self, at: ArrayLike) -> Floats:
        """Convert positions (k, 2) of the plate to points from the lower left corner of the axes."""
        return np.asarray((np.atleast_2d(np.asarray(at, dtype=np.float64)) - self._corner) * self.scale)

    def keep_free(self, at: ArrayLike, size: float) -> None:
        """Reserve a square of width ``size`` [points] around each position (k, 2), where a mark is drawn."""
        middle = self.points(at)
        self.marks.append(np.hstack([middle - 0.5 * size, middle + 0.5 * size]))

    def beside(
        self, words: str, places: ArrayLike, size: float = 8.0, color: str = INK, others: ArrayLike = (), **look: Any
    ) -> None:
        """Write a label near one of the positions (k, 2), preferably the first; a line joins a distant label to it.

        The label is inside the axes, and nearer to its own position than to each of ``others`` (r, 2), the positions of
        other labels, if possible.
        """
        at = np.atleast_2d(np.asarray(places, dtype=np.float64))
        extent = np.array([_LETTER * len(words), _LINE]) * size
        ways = np.concatenate([gap * _AROUND for gap in _FAR])
        moved = np.tile(ways, (len(at), 1)) + 0.5 * extent * np.sign(np.tile(ways, (len(at), 1)))
        anchors = np.repeat(np.arange(len(at)), len(ways))
        order = np.tile(np.arange(len(ways)), len(at)) + 3 * anchors
        own, room = self.points(at)[anchors], np.minimum(0.5 * extent, 0.5 * self._size)
        middles = np.clip(own + moved, room, self._size - room)
        beside_others = np.zeros(len(moved), np.bool_)
        for other in self.points(others) if np.size(others) else ():
            away = [_away(middles, extent, place) for place in (other, own)]
            beside_others |= away[0] <= away[1] + _APART
        best = self._best(middles, extent, order + _MISTAKEN * beside_others)
        anchor, (x, y) = at[anchors[best]], middles[best] - own[best]
        offset: dict[str, Any] = {"textcoords": "offset points", "ha": "center", "va": "center"}
        if np.abs(ways[best % len(ways)]).max() > _LEADER:
            offset["arrowprops"] = {"arrowstyle": "-", "color": color, "linewidth": 0.6, "shrinkA": 0, "shrinkB": 3}
        self.axes.annotate(literal(words), tuple(anchor), (x, y), **offset, **_look(size, color, look))

    def along(
        self, words: str, places: ArrayLike, turns: Sequence[float], size: float, color: str = INK, **look: Any
    ) -> None:
        """Write a text at one of the positions (k, 2), rotated there by ``turns`` (k,) degrees, if one is free."""
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
        """Choose and reserve the box of least cost; ``order`` (k,), in eighths, is added to its cost.

        The boxes have centers (k, 2) and sizes ``extent`` in points. Return the index of the box, or -1 if ``free`` is
        True and it covers text.
        """
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
    """Distance (c,) of each position (c, 2) from the box of size ``extent`` with center ``middles`` (c, 2)."""
    return np.asarray(np.hypot(*np.maximum(np.abs(places - middles) - 0.5 * extent, 0.0).T))


def _look(size: float, color: str, look: dict[str, Any]) -> dict[str, Any]:
    return {"fontsize": size, "color": color, "zorder": 7, "bbox": PAPER} | look


def _covered(boxes: Floats, taken: Sequence[Floats]) -> Floats:
    """Area (k,) of each box (k, 4) that the boxes ``taken`` cover."""
    if not taken:
        return np.zeros(len(boxes))
    others = np.concatenate(taken)
    low = np.maximum(boxes[:, None, :2], others[:, :2])
    high = np.minimum(boxes[:, None, 2:], others[:, 2:])
    return np.asarray(np.prod(np.maximum(high - low, 0.0), axis=2).sum(axis=1))
