"""The plan of a plate: axes of its proportions, its elements' edges, its outline."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from numpy.typing import ArrayLike, NDArray

from signorini.errors import InputError
from signorini.shapes.tessellation import Tessellation

INK = "#1c2733"
_SHEET = "#eef2f5"


def checked_mesh(points: ArrayLike, elements: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Check the shapes of a mesh."""
    nodes, cells = np.asarray(points, dtype=float), np.asarray(elements, dtype=np.int64)
    if nodes.shape[1:] != (2,) or cells.shape[1:] != (8,) or not len(cells):
        raise InputError(
            f"The nodes have the shape {nodes.shape} and the elements {cells.shape}; they must be (n, 2) and (e, 8)."
        )
    return nodes, cells


def literal(text: str) -> str:
    """Let matplotlib show a text as it is: a dollar is no mathematics."""
    return text.replace("$", r"\$")


def plan_axes(nodes: NDArray[np.float64], title: str) -> Axes:
    """Make a figure whose shape suits the plate's."""
    width, height = np.maximum(np.ptp(nodes, axis=0), 1e-30)
    figure = Figure(figsize=(7.4, float(np.clip(5.6 * height / width, 1.8, 8.5)) + 1.3), layout="constrained")
    axes = figure.add_subplot()
    axes.set_title(literal(title), fontsize=11, color=INK)
    return axes


def draw_sheet(axes: Axes, vertices: NDArray[np.float64], cut: Tessellation) -> None:
    """Fill the plate with a pale colour."""
    sheet = Triangulation(vertices[:, 0], vertices[:, 1], cut.triangles)
    axes.tricontourf(sheet, np.zeros(len(vertices)), levels=[-1, 1], colors=[_SHEET])


def draw_outlines(axes: Axes, vertices: NDArray[np.float64], cut: Tessellation, inner: float) -> None:
    """Draw the elements' edges, fainter the more there are, and the plate's outline; set the plan's aspect."""
    fade = inner * min(1.0, (900 / len(cut.elements)) ** 0.5)
    lines = vertices[cut.edges]
    axes.add_collection(LineCollection(list(lines[~cut.outer]), colors=INK, linewidths=0.5, alpha=fade))
    axes.add_collection(LineCollection(list(lines[cut.outer]), colors=INK, linewidths=1.2, capstyle="round"))
    axes.set_aspect("equal")
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    margin = 0.04 * float((high - low).max())
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0, labelsize=8.5)
