"""Meshes of plates with any outline."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from signorini._core import mesh_outline
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.mesh.axes import ALONG_X, Axes
from signorini.shapes.contours import Contour

Floats = npt.NDArray[np.float64]

MOST = 10_000_000
"""Elements above which no outline is meshed; what is prepared for so many might not fit into memory."""


class OutlineError(InputError):
    """An outline of which there is no mesh; ``contour`` and ``side`` say where, None where it is no one side."""

    def __init__(self, message: str, contour: int | None = None, side: int | None = None) -> None:
        super().__init__(message)
        self.contour, self.side = contour, side


def outlined(
    contours: Sequence[Contour],
    size: float,
    refinements: Floats | None = None,
    lines: Sequence[tuple[Floats, bool]] = (),
    points: Floats | None = None,
    most: int = MOST,
    axes: Axes = ALONG_X,
) -> Mesh:
    """Mesh what lies within a contour and outside the holes in it.

    Parameters
    ----------
    contours : sequence of Contour
        The outline, then the holes.
    size : float
        Largest side of an element, were they all squares.
    refinements : (r, 5) float array, optional
        Straight pieces with smaller elements: x, y to x, y, and the size there. From there sizes grow by a quarter of
        the distance.
    lines : sequence of (float array, bool), optional
        Groups of lines for sides of elements to follow, those that matter most first: straight pieces (l, 4), x, y to
        x, y, or arcs (a, 6) from x, y through x, y to x, y, with all nodes on them. They are followed but where they
        leave the plate, and not if they come nearer to the outline or to earlier ones than about half an element: or
        the parts that do not, if the group is followed in part.
    points : (p, 2) float array, optional
        Points for nodes, where that is too near to nothing.
    most : int, optional
        Elements at most, about.
    axes : Axes, optional
        Along which it is meshed (`signorini.mesh.axes.axes_of`). Units, place and the order of corners, holes and lines
        of a group make no difference.

    Returns
    -------
    Mesh
        Of quadrilaterals, and triangles where none fit, with the edges that the contours name. Nodes on arcs are on
        them.

    Raises
    ------
    OutlineError
        If contours cross, touch or nearly touch, a hole is outside, or the elements would be too many.

    Examples
    --------
    >>> from signorini.shapes.contours import circle, straight
    >>> square = straight(((0, 0), (4, 0), (4, 4), (0, 4)), ("south", "east", "north", "west"))
    >>> mesh = outlined([square, circle((2.0, 2.0), 1.0, "hole 1")], 0.5)
    >>> sorted(mesh.edges), round(float(mesh.element_area.sum()), 2)
    (['east', 'hole 1', 'north', 'south', 'west'], 12.86)
    """
    none = np.nan, np.nan
    loops = [
        (
            np.array(contour.corners, dtype=np.float64),
            np.array([none if m is None else m for m in contour.through], dtype=np.float64),
            [contour.whole or name for name in contour.names],
        )
        for contour in contours
    ]
    follow = [np.zeros((0, 8))]
    for rank, (group, in_part) in enumerate(lines):
        through = group[:, 2:4] if group.shape[1] == 6 else np.full((len(group), 2), np.nan)
        told = np.broadcast_to([rank, in_part], (len(group), 2))
        follow.append(np.column_stack([group[:, :2], group[:, -2:], through, told]))
    finer, at = (np.zeros((0, k)) if given is None else given for given, k in ((refinements, 5), (points, 2)))
    along = [list(axis) for axis in axes]
    try:
        nodes, elements, sides, of = mesh_outline(loops, size, finer, np.concatenate(follow), at, most, along)
    except ValueError as error:
        raise OutlineError(*error.args) from None
    edges = {
        name: sides[(of[:, 0] == ring) & np.isin(of[:, 1], own)]
        for ring, contour in enumerate(contours)
        for name, own in contour.edges.items()
    }
    return Mesh(nodes, elements, edges)
