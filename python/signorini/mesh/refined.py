"""A mesh whose elements are divided into four."""

from __future__ import annotations

import numpy as np

from signorini.mesh.mesh import Mesh


def refined(mesh: Mesh, times: int = 1) -> Mesh:
    """Divide every element into four, so many times; sides keep their curves, and edges their names.

    Examples
    --------
    >>> points = np.array([[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]], float)
    >>> fine = refined(Mesh(points, np.arange(8)[None], {"bottom": np.array([[0, 4, 1]])}))
    >>> len(fine.elements), fine.points[fine.edges["bottom"], 0].tolist()
    (4, [[0.0, 1.0, 2.0], [2.0, 3.0, 4.0]])
    """
    return mesh if times == 0 else refined(_halved(mesh), times - 1)


def _halved(mesh: Mesh) -> Mesh:
    count, n = len(mesh.elements), mesh.node_count
    # Of every side the nodes at its quarters, once; the centre of every element, and the middles of its four joints.
    sides = mesh.unique_sides
    number = np.full(n, -1)
    number[sides[:, 1]] = np.arange(len(sides))
    a, m, b = mesh.points[sides].transpose(1, 0, 2)
    quarters = np.stack([0.375 * a + 0.75 * m - 0.125 * b, -0.125 * a + 0.75 * m + 0.375 * b], axis=1)
    inside = np.array([[0.0, 0.0], [0.0, -0.5], [0.5, 0.0], [0.0, 0.5], [-0.5, 0.0]])
    every = np.repeat(np.arange(count), len(inside))
    within = mesh.map(every, np.tile(inside, (count, 1)))
    points = np.vstack([mesh.points, quarters.reshape(-1, 2), within])
    centre = n + 2 * len(sides) + 5 * np.arange(count)

    # Quarter nodes of every element's sides, in the element's own sense.
    first = n + 2 * number[mesh.sides[..., 1]]
    along = sides[number[mesh.sides[..., 1]], 0] == mesh.sides[..., 0]
    near, far = np.where(along, first, first + 1), np.where(along, first + 1, first)
    corner, middle = mesh.elements[:, :4], mesh.elements[:, 4:]
    parts = []
    for i in range(4):
        j = i - 1
        joints = centre + 1 + i, centre + 1 + j % 4
        parts.append(
            np.stack([corner[:, i], middle[:, i], centre, middle[:, j], near[:, i], *joints, far[:, j]], axis=1)
        )
    edges = {}
    for name, triples in mesh.edges.items():
        start = n + 2 * number[triples[:, 1]]
        same = sides[number[triples[:, 1]], 0] == triples[:, 0]
        one, other = np.where(same, start, start + 1), np.where(same, start + 1, start)
        halves = np.stack([triples[:, 0], one, triples[:, 1], triples[:, 1], other, triples[:, 2]], axis=1)
        edges[name] = halves.reshape(-1, 3)
    return Mesh(points, np.concatenate(parts), edges)
