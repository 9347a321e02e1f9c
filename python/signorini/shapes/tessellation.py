"""Division of a mesh of curved 8-node quadrilaterals and 6-node triangles into flat triangles, for drawing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from signorini._core import serendipity, triangular

_WANTED_CELLS = 12_000
_FINEST = 10


@dataclass(frozen=True)
class Tessellation:
    """Flat triangles that approximate the curved elements of a mesh.

    Each element is divided by a grid of d × d cells of the reference square; d is even, so that all nodes are vertices
    of triangles. For a triangular element, one side of the square is collapsed. Elements share the vertices on a common
    edge, so that contours cross the edge without a jump.
    """

    elements: NDArray[np.int64]
    """The mesh (e, 8): corners counter-clockwise, then midsides; a triangle is [a, b, c, c, ab, bc, c, ca]."""
    owners: NDArray[np.int64]
    """Number (v,) of an element that contains each vertex."""
    weights: NDArray[np.float64]
    """Values (v, 8) at each vertex of the shape functions of the element in ``owners``."""
    triangles: NDArray[np.int64]
    """Vertex numbers (t, 3) of the triangles."""
    parents: NDArray[np.int64]
    """Number (t,) of the element of which each triangle is a part."""
    edges: NDArray[np.int64]
    """Vertex numbers (k, d + 1) along each edge of the mesh; an edge of two elements occurs once."""
    midsides: NDArray[np.int64]
    """Number (k,) of the mesh node in the middle of each edge."""
    outer: NDArray[np.bool_]
    """Mask (k,) of the edges that belong to one element only: the outline of the plate."""

    def interpolate(self, nodal: NDArray[np.float64]) -> NDArray[np.float64]:
        """Interpolate nodal values (n,) or (n, c) to the vertices: (v,) or (v, c)."""
        values: NDArray[np.float64] = np.einsum("va,va...->v...", self.weights, nodal[self.elements[self.owners]])
        return values


def tessellate(elements: NDArray[np.int64], divisions: int | None = None) -> Tessellation:
    """Cut every element into ``divisions`` × ``divisions`` cells of two triangles.

    ``divisions`` is even; by default it is larger for coarser meshes, so that pictures of all meshes are equally
    smooth.
    """
    count = len(elements)
    d = divisions or int(np.clip(2 * round(np.sqrt(_WANTED_CELLS / count) / 2), 2, _FINEST))
    shapes = grid_shapes(d)
    of_triangle = elements[:, 2] == elements[:, 3]

    local = np.arange((d + 1) ** 2).reshape(d + 1, d + 1)
    sides = np.stack([local[0, :], local[:, -1], local[-1, ::-1], local[::-1, 0]])
    _, first, vertex_of = np.unique(_names(elements, sides), return_index=True, return_inverse=True)
    vertices = vertex_of.reshape(count, -1)

    a, b, c, e = local[:-1, :-1].ravel(), local[:-1, 1:].ravel(), local[1:, 1:].ravel(), local[1:, :-1].ravel()
    cells = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, e])])
    # A side collapsed to one node has no edge, and each grid cell at it gives one triangle instead of two.
    real = (elements[:, :4] != np.roll(elements[:, :4], -1, axis=1)).ravel()
    midsides, edge, uses = np.unique(elements[:, 4:].ravel()[real], return_index=True, return_counts=True)
    owners, places = np.divmod(first, (d + 1) ** 2)
    triangles, parents = vertices[:, cells].reshape(-1, 3), np.repeat(np.arange(count), len(cells))
    whole = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
    return Tessellation(
        elements=elements,
        owners=owners,
        weights=shapes[of_triangle[owners].astype(np.int64), places],
        triangles=triangles[whole],
        parents=parents[whole],
        edges=vertices[:, sides].reshape(-1, d + 1)[real][edge],
        midsides=midsides,
        outer=uses == 1,
    )


def grid_shapes(divisions: int) -> NDArray[np.float64]:
    """Shape functions (2, v, 8) at the vertices of a grid: [0] of quadrilaterals, [1] of triangles.

    The grid has ``divisions`` × ``divisions`` cells; its vertices are numbered row by row.
    """
    xi, eta = (grid.ravel() for grid in np.meshgrid(*[np.linspace(-1, 1, divisions + 1)] * 2))
    u, v = 0.5 + 0.5 * xi, 0.5 + 0.5 * eta
    return np.stack([serendipity(np.column_stack([xi, eta]))[0], triangular(np.column_stack([u * (1 - v), v]))[0]])


def _names(elements: NDArray[np.int64], sides: NDArray[np.int64]) -> NDArray[np.int64]:
    """Number the grid points of all elements; points on a common corner or edge of elements have equal numbers."""
    count, d = len(elements), sides.shape[1] - 1
    nodes = int(elements.max()) + 1
    names = nodes * d + np.arange(count * (d + 1) ** 2).reshape(count, -1)
    steps = np.arange(1, d)
    for side, inner in enumerate(sides[:, 1:-1]):
        start, end, middle = elements[:, side], elements[:, (side + 1) % 4], elements[:, 4 + side]
        along = np.where((start < end)[:, None], steps, d - steps)
        along[start == end] = 0
        names[:, inner] = middle[:, None] * d + along
        names[:, sides[side, 0]] = start * d
    flat: NDArray[np.int64] = names.ravel()
    return flat
