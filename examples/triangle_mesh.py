"""An equilateral triangle of 6-node triangles with an edge `base`, written as triangle.inp."""

import meshio
import numpy as np

n, side = 8, 6.0  # an equilateral triangle of 6-node triangles
rows = [[(i + j / 2, j * np.sqrt(3) / 2) for i in range(2 * n + 1 - j)] for j in range(2 * n + 1)]
first = np.cumsum([0, *map(len, rows)])
points = np.array([point for row in rows for point in row]) * side / (2 * n)


def at(i: int, j: int) -> int:
    """Number of node i of row j."""
    return int(first[j] + i)


up = [
    [at(i, j), at(i + 2, j), at(i, j + 2), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
    for j in range(0, 2 * n, 2)
    for i in range(0, 2 * n - j, 2)
]
down = [
    [at(i + 2, j + 2), at(i, j + 2), at(i + 2, j), at(i + 1, j + 2), at(i + 1, j + 1), at(i + 2, j + 1)]
    for j in range(0, 2 * n - 2, 2)
    for i in range(0, 2 * n - 2 - j, 2)
]
base = [[at(i, 0), at(i + 2, 0), at(i + 1, 0)] for i in range(0, 2 * n, 2)]
plane = np.column_stack([points, np.zeros(len(points))])
cells = [("triangle6", np.array(up + down)), ("line3", np.array(base))]
meshio.Mesh(plane, cells, cell_sets={"base": [np.zeros(0, int), np.arange(len(base))]}).write("triangle.inp")
