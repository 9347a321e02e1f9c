"""Meshes of triangles, or of both, from meshes of quadrilaterals."""

import numpy as np

from signorini.mesh import Mesh


def halved(mesh, part=1.0, seed=1):
    """Halve a part of a mesh's quadrilaterals, chosen at random, along one or the other diagonal."""
    random = np.random.default_rng(seed)
    points, elements = list(mesh.points), []
    for element in mesh.elements:
        if element[2] == element[3] or random.random() >= part:
            elements.append(element)
            continue
        turn = random.integers(4)
        (a, b, c, d), (ab, bc, cd, da) = np.roll(element[:4], -turn), np.roll(element[4:], -turn)
        middle = len(points)
        points.append(0.5 * (mesh.points[a] + mesh.points[c]))
        elements += [[a, b, c, c, ab, bc, c, middle], [c, d, a, a, cd, da, a, middle]]
    return Mesh(np.array(points), np.array(elements), mesh.edges)
