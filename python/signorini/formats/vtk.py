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
    warp by.

    Parameters
    ----------
    points : (n, 2) array
        Nodes, in the model's unit of length.
    elements : (e, 8) array
        Corners counter-clockwise, then midsides; a triangle is [a, b, c, c, ab, bc, c, ca].
    point_data : mapping of str to (n,), (n, 2) or (n, 3) array
        Nodal fields.
    cell_data : mapping of str to (e,) array, optional
        Fields with one value an element.
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


def write_vtu(path: str | os.PathLike[str], mesh: meshio.Mesh) -> None:
    """Write a mesh to a compressed binary VTK file, whole or not at all.

    Parameters
    ----------
    path : path-like
        The ``.vtu`` file to create or to replace.
    mesh : meshio.Mesh

    Raises
    ------
    OSError
        The file cannot be written.

    Examples
    --------
    >>> import meshio, pathlib, tempfile
    >>> points = np.array([[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [2, 0.5], [1, 1], [0, 0.5]])
    >>> deflection = [0, 0, 0, 0, 1e-3, 0, 1e-3, 0]
    >>> fields = {"deflection": deflection, "displacement": displacement_vector(deflection)}
    >>> with tempfile.TemporaryDirectory() as directory:
    ...     path = pathlib.Path(directory, "plate.vtu")
    ...     write_vtu(path, as_meshio(points, np.arange(8)[None], fields))
    ...     meshio.read(path).point_data["displacement"][4].tolist()
    [0.0, 0.0, -0.001]
    """
    import meshio

    with replacing(path) as beside:
        meshio.vtu.write(beside, mesh)


def displacement_vector(deflection: ArrayLike) -> NDArray[np.float64]:
    """Turn deflections, positive down, into vectors of a space whose z points up.

    Parameters
    ----------
    deflection : array_like, shape (n,)

    Returns
    -------
    ndarray, shape (n, 3)
        ``(0, 0, -w)``: ParaView's *Warp By Vector* then moves the plate down where it goes down.

    Examples
    --------
    >>> displacement_vector([2.0, -1.0]).tolist()
    [[0.0, 0.0, -2.0], [0.0, 0.0, 1.0]]
    """
    down = np.asarray(deflection, dtype=float)
    vectors = np.zeros((len(down), 3))
    vectors[:, 2] = -down
    return vectors
