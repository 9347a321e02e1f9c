"""Meshes of plates with any outline."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from signorini._core import mesh_outline
from signorini.errors import InputError
from signorini.mesh import Mesh
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
    lines: Floats | None = None,
    points: Floats | None = None,
    arcs: Floats | None = None,
    walls: Floats | None = None,
    most: int = MOST,
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
    lines : (l, 4) float array, optional
        Straight pieces x, y to x, y, those that matter most first. Sides of elements follow them but where they leave
        the plate, or come nearer to the outline or to earlier ones than about half an element.
    points : (p, 2) float array, optional
        Points for nodes, likewise.
    arcs : (a, 6) float array, optional
        Arcs from x, y through x, y to x, y, followed likewise, before all lines, with all nodes on them.
    walls : (w, 4) float array, optional
        Lines, followed before the others, of which the parts that have room are followed alone too.
    most : int, optional
        Elements at most, about.

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
    asked = ((refinements, 5), (arcs, 6), (walls, 4), (lines, 4), (points, 2))
    finer, bent, along, straight, at = (np.zeros((0, k)) if given is None else given for given, k in asked)
    try:
        nodes, elements, sides, of = mesh_outline(loops, size, finer, bent, along, straight, at, most)
    except ValueError as error:
        raise OutlineError(*error.args) from None
    edges = {
        name: sides[(of[:, 0] == ring) & np.isin(of[:, 1], own)]
        for ring, contour in enumerate(contours)
        for name, own in contour.edges.items()
    }
    return Mesh(nodes, elements, edges)
