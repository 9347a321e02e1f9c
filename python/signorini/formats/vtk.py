"""Fields on a mesh of 8-node quadrilaterals and 6-node triangles for other programs, by meshio: ParaView, PyVista."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini.base.files import replacing

if TYPE_CHECKING:
    import meshio  # type: ignore[import-untyped]

_OF_TRIANGLE = [0, 1, 2, 4, 5, 7]
"""Nodes of a triangle [a, b, c, c, ab, bc, c, ca] that are its own."""


def as_meshio(
    points: NDArray[np.float64],
    elements: NDArray[np.int64],
    point_data: Mapping[str, ArrayLike],
    cell_data: Mapping[str, ArrayLike] | None = None,
) -> meshio.Mesh:
    """Give fields on a plate as a mesh of meshio: in the plane z = 0, quadrilaterals before triangles.

    Scalars keep the signs of the package (deflection positive down); give the vector of :func:`displacement_vector` to
    warp by. Points (n, 2) are in the model's unit of length; a triangle among the elements (e, 8) is [a, b, c, c, ab,
    bc, c, ca].
    """
    # Only files and other programs need meshio, which takes long to read.
    import meshio

    triangles = elements[:, 2] == elements[:, 3]
    every = [
        (kind, some, elements[some][:, own])
        for kind, some, own in (("quad8", ~triangles, range(8)), ("triangle6", triangles, _OF_TRIANGLE))
        if some.any()
    ]
    of_cells = {name: [np.asarray(data)[some] for _, some, _ in every] for name, data in (cell_data or {}).items()}
    places = np.column_stack([points, np.zeros(len(points))])
    return meshio.Mesh(places, [(kind, cells) for kind, _, cells in every], dict(point_data), of_cells)


def write_vtu(path: str | os.PathLike[str], mesh: meshio.Mesh, metadata: Mapping[str, str] | None = None) -> None:
    """Write a mesh to a compressed binary VTK file, whole or not at all; metadata are a comment at its beginning."""
    import meshio

    # A comment in XML contains no two dashes.
    words = "; ".join(f"{name}: {text}" for name, text in (metadata or {}).items()).replace("--", "- -")
    with replacing(path) as beside:
        meshio.vtu.write(beside, mesh)
        content = beside.read_bytes()
        head = content.index(b"<VTKFile")
        beside.write_bytes(content[:head] + f"<!-- {words} -->\n".encode() + content[head:])


def displacement_vector(deflection: ArrayLike) -> NDArray[np.float64]:
    """Turn deflections, positive down, into vectors of a space whose z points up.

    ``(0, 0, -w)``: ParaView's *Warp By Vector* then moves the plate down where it goes down.
    """
    down = np.asarray(deflection, dtype=float)
    vectors = np.zeros((len(down), 3))
    vectors[:, 2] = -down
    return vectors
