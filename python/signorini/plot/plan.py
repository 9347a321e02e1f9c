"""The plan of a plate: its mesh ready to be drawn, axes of its proportions, its outline."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, Self

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.collections import PathCollection
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.transforms import ScaledTranslation
from matplotlib.tri import Triangulation
from numpy.typing import ArrayLike, NDArray

from signorini.errors import InputError
from signorini.shapes.tessellation import Tessellation, tessellate

INK = "#1c2733"
_SHEET = "#eef2f5"
HATCHED: dict[str, Any] = {"facecolor": _SHEET, "edgecolor": "#aeb8c0", "hatch": "////", "linewidth": 0.0}
"""What is left out."""
_FINE = 4000
"""Elements from which on two flat triangles of each are as good as more: they are some dots wide."""
_SAME = 1e-7
"""Part of the plate's size within which points of sides that coincide are one: far above rounding."""
_MARGIN = 0.04
"""Room around the plate, in parts of its larger side."""


@dataclass(frozen=True, eq=False)
class Plan:
    """A mesh and what all its pictures share: triangles, edges, outline.

    Attributes
    ----------
    nodes : ndarray, shape (n, 2)
    cells : ndarray of int, shape (e, 8)
    left_out : ndarray of bool, shape (e,), or None
        Elements that are hatched in place of a field, as their values are not to be compared with the others'.
    """

    nodes: NDArray[np.float64]
    cells: NDArray[np.int64]
    left_out: NDArray[np.bool_] | None = None

    @classmethod
    def of(cls, points: ArrayLike, elements: ArrayLike, left_out: NDArray[np.bool_] | None = None) -> Self:
        """Check the shapes of a mesh."""
        nodes, cells = np.asarray(points, dtype=float), np.asarray(elements, dtype=np.int64)
        if nodes.shape[1:] != (2,) or cells.shape[1:] != (8,) or not len(cells):
            raise InputError(
                f"The nodes have the shape {nodes.shape} and the elements {cells.shape}; "
                "they must be (n, 2) and (e, 8)."
            )
        return cls(nodes, cells, left_out)

    @cached_property
    def cut(self) -> Tessellation:
        """Triangles of the whole plate."""
        return tessellate(self.cells, 1 if len(self.cells) > _FINE else None)

    @cached_property
    def triangles(self) -> Triangulation:
        """The same for matplotlib."""
        return triangulation(self.cut, self.nodes)

    @cached_property
    def window(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lower left and upper right corner of the plan."""
        vertices = np.column_stack([self.triangles.x, self.triangles.y])
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        margin = _MARGIN * float((high - low).max())
        return low - margin, high + margin

    @cached_property
    def edges(self) -> tuple[Path, Path, Path]:
        """Edges between elements, the outline of the plate, and borders inside it, at which nodes are twice."""
        vertices = np.column_stack([self.triangles.x, self.triangles.y])[self.cut.edges]
        # One side of a border is the other's, the other way round.
        steps = np.round(vertices / (_SAME * np.ptp(vertices))).astype(np.int64)
        ends = np.sort(steps[..., 0] + 1j * steps[..., 1], axis=1)
        _, which, uses = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
        border = self.cut.outer & (uses[which.ravel()] > 1)
        sorts = ~self.cut.outer, self.cut.outer & ~border, border
        return tuple(_joined(vertices[chosen]) for chosen in sorts)  # type: ignore[return-value]


def triangulation(cut: Tessellation, nodes: NDArray[np.float64]) -> Triangulation:
    """Give matplotlib the triangles of a mesh, or of a part of it."""
    x, y = cut.interpolate(nodes).T
    made = Triangulation(x, y, cut.triangles)
    # matplotlib would look at every triangle again for each picture.
    made.is_delaunay = False
    return made


def literal(text: str) -> str:
    """Let matplotlib show a text as it is: a dollar is no mathematics."""
    return text.replace("$", r"\$")


def plan_axes(plan: Plan, title: str) -> Axes:
    """Make a figure whose shape suits the plate's."""
    width, height = plan.window[1] - plan.window[0]
    figure = Figure(figsize=(7.4, float(np.clip(5.6 * height / width, 1.8, 8.5)) + 1.3), layout="constrained")
    axes = figure.add_subplot()
    axes.set_title(literal(title), fontsize=11, color=INK, wrap=True)
    return axes


def draw_sheet(axes: Axes, plan: Plan) -> Path:
    """Fill the plate with a pale colour, and return its outline with holes."""
    drawn = axes.tricontourf(plan.triangles, np.zeros(len(plan.triangles.x)), levels=[-1, 1], colors=[_SHEET])
    return drawn.get_paths()[0]


def draw_mesh(axes: Axes, plan: Plan) -> None:
    """Draw the elements' edges, fainter the more there are."""
    fade = 0.3 * min(1.0, (900 / len(plan.cells)) ** 0.5)
    if fade > _FAINTEST:
        look: dict[str, Any] = {"facecolors": "none", "edgecolors": INK, "linewidths": 0.5, "alpha": fade}
        axes.add_collection(PathCollection(plan.edges[:1], zorder=1.8, label="_elements", **look), autolim=False)


def draw_outlines(axes: Axes, plan: Plan) -> None:
    """Draw the plate's outline, dashed the borders of zones, and hatch what is left out."""
    _, outline, borders = plan.edges
    if plan.left_out is not None and plan.left_out.any():
        part = Triangulation(plan.triangles.x, plan.triangles.y, plan.cut.triangles[plan.left_out[plan.cut.parents]])
        (path,) = axes.tricontourf(part, np.zeros(len(part.x)), levels=[-1, 1], alpha=0.0).get_paths()
        axes.add_patch(PathPatch(path, zorder=2.1, **HATCHED))
    look: dict[str, Any] = {"facecolors": "none", "edgecolors": INK, "linewidths": 1.2, "capstyle": "round"}
    axes.add_collection(PathCollection([outline], zorder=1.9, label="_outline", **look), autolim=False)
    if np.size(borders.vertices):
        look = {"facecolors": "none", "edgecolors": INK, "linewidths": 0.7, "linestyles": "dashed"}
        axes.add_collection(PathCollection([borders], zorder=1.9, label="_borders", **look), autolim=False)


def set_window(axes: Axes, plan: Plan) -> None:
    """Set the plan's limits, both axes alike."""
    axes.set_aspect("equal")
    (x0, y0), (x1, y1) = plan.window
    axes.set_xlim(x0, x1)
    axes.set_ylim(y0, y1)
    axes.spines[:].set_visible(False)
    axes.tick_params(bottom=False, left=False, labelsize=8.5)


def put_label(axis: Axis, across: float, up: float, right: float, above: float) -> None:
    """Put the label of an axis at a part of its axes, and so many inches from there; finding its place takes time."""
    figure = axis.axes.get_figure(root=True)
    assert figure is not None, "axes are made with their figure"
    away = ScaledTranslation(right, above, figure.dpi_scale_trans)
    axis.set_label_coords(across, up, axis.axes.transAxes + away)


def inches_per_unit(axes: Axes) -> float:
    """How large the unit of length of the plate is drawn."""
    figure = axes.get_figure(root=True)
    assert figure is not None, "axes are made with their figure"
    size = axes.get_position(original=True).size * figure.get_size_inches()
    spans = np.abs([np.diff(axes.get_xlim())[0], np.diff(axes.get_ylim())[0]])
    return float((size / spans).min())


_FAINTEST = 0.07
"""How faint edges of elements may be: fainter ones nobody sees, and they take their time."""


def _joined(chains: NDArray[np.float64]) -> Path:
    """Put polylines (k, n, 2) into one path."""
    codes = np.full(chains.shape[:2], Path.LINETO, Path.code_type)
    codes[:, 0] = Path.MOVETO
    return Path(chains.reshape(-1, 2), codes.ravel())


def runs(outline: NDArray[np.float64]) -> list[slice]:
    """Rows of a polyline (k, 2) between those of NaN."""
    ends = [-1, *np.flatnonzero(np.isnan(outline[:, 0])).tolist(), len(outline)]
    return [slice(a + 1, b) for a, b in pairwise(ends) if b > a + 1]


def pieces(outline: NDArray[np.float64]) -> list[NDArray[np.float64]]:
    """Split a polyline (k, 2) at its rows of NaN."""
    return [outline[rows] for rows in runs(outline)]


def enclosed(outline: NDArray[np.float64]) -> Path:
    """What closed polylines (k, 2), rows of NaN between them, enclose: the first one without the others."""
    parts = []
    for number, loop in enumerate(pieces(outline)):
        (x, y), (u, v) = loop[:-1].T, loop[1:].T
        # What runs the other way is left out.
        turned = float(np.sum(x * v - y * u)) > 0.0
        codes = [Path.MOVETO, *[Path.LINETO] * (len(loop) - 2), Path.CLOSEPOLY]
        parts.append(Path(loop if turned == (number == 0) else loop[::-1], codes))
    return Path.make_compound_path(*parts)
