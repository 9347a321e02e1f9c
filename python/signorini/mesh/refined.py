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
    n = mesh.node_count
    # Of every side the nodes at its quarters, once; in every quadrilateral the centre and the middles of its four
    # joints, in every triangle those of its three.
    sides = mesh.unique_sides
    number = np.full(n, -1)
    number[sides[:, 1]] = np.arange(len(sides))
    a, m, b = mesh.points[sides].transpose(1, 0, 2)
    quarters = np.stack([0.375 * a + 0.75 * m - 0.125 * b, -0.125 * a + 0.75 * m + 0.375 * b], axis=1)
    squares, triangles = np.flatnonzero(~mesh.triangles), np.flatnonzero(mesh.triangles)
    inside = np.array([[0.0, 0.0], [0.0, -0.5], [0.5, 0.0], [0.0, 0.5], [-0.5, 0.0]])
    across = np.array([[0.25, 0.25], [0.5, 0.25], [0.25, 0.5]])
    within = [
        mesh.map(np.repeat(some, len(at)), np.tile(at, (len(some), 1)))
        for some, at in ((squares, inside), (triangles, across))
    ]
    points = np.vstack([mesh.points, quarters.reshape(-1, 2), *within])
    centre = n + 2 * len(sides) + 5 * np.arange(len(squares))
    joint = n + 2 * len(sides) + 5 * len(squares) + 3 * np.arange(len(triangles))

    # Quarter nodes of every element's sides, in the element's own sense.
    first = n + 2 * number[mesh.sides[..., 1]]
    along = sides[number[mesh.sides[..., 1]], 0] == mesh.sides[..., 0]
    near, far = np.where(along, first, first + 1), np.where(along, first + 1, first)
    corner, middle = mesh.elements[:, :4], mesh.elements[:, 4:]
    parts = []
    for i in range(4):
        j = i - 1
        joints = centre + 1 + i, centre + 1 + j % 4
        own = [corner[squares, i], middle[squares, i], centre, middle[squares, j]]
        parts.append(np.stack([*own, near[squares, i], *joints, far[squares, j]], axis=1))
    around = [0, 1, 3]
    middles = [middle[triangles, side] for side in around]
    for i, side in enumerate(around):
        a, b, c = corner[triangles, i], middles[i], middles[i - 1]
        own = [a, b, c, c, near[triangles, side], joint + i, c, far[triangles, around[i - 1]]]
        parts.append(np.stack(own, axis=1))
    a, b, c = middles
    parts.append(np.stack([a, b, c, c, joint + 1, joint + 2, c, joint], axis=1))
    edges = {}
    for name, triples in mesh.edges.items():
        start = n + 2 * number[triples[:, 1]]
        same = sides[number[triples[:, 1]], 0] == triples[:, 0]
        one, other = np.where(same, start, start + 1), np.where(same, start + 1, start)
        halves = np.stack([triples[:, 0], one, triples[:, 1], triples[:, 1], other, triples[:, 2]], axis=1)
        edges[name] = halves.reshape(-1, 3)
    return Mesh(points, np.concatenate(parts), edges)
