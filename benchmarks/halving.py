"""Meshes with triangles, made from meshes of quadrilaterals."""

import numpy as np

from signorini.mesh import Mesh


def halved(mesh, part=1.0, seed=1):
    """Divide a random fraction ``part`` of the quadrilaterals into triangles, each along a random diagonal."""
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
