"""Fields on a mesh of 8-node quadrilaterals, as a ``.vtu`` file for ParaView."""

from __future__ import annotations

import os
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini.base.files import replacing
from signorini.errors import InputError


def write_vtu(
    path: str | os.PathLike[str],
    points: ArrayLike,
    elements: ArrayLike,
    point_data: Mapping[str, ArrayLike],
    cell_data: Mapping[str, ArrayLike] | None = None,
) -> None:
    """Write fields on a plate to a compressed binary VTK file, whole or not at all.

    The plate lies in the plane z = 0 with z up, as ParaView draws it. Scalars keep the signs of the package
    (deflection positive down); give the vector of :func:`displacement_vector` to warp by.

    Parameters
    ----------
    path : path-like
        The ``.vtu`` file to create or to replace.
    points : array_like, shape (n, 2)
        Nodes, in the model's unit of length.
    elements : array_like of int, shape (e, 8)
        Corners counter-clockwise, then midsides (VTK's quadratic quadrilateral).
    point_data : mapping of str to array_like, shape (n,), (n, 2) or (n, 3)
        Nodal fields. Two components are completed by a zero third.
    cell_data : mapping of str to array_like, shape (e,), (e, 2) or (e, 3), optional
        Fields with one value an element.

    Raises
    ------
    InputError
        An array has another shape.
    OSError
        The file cannot be written.

    Examples
    --------
    >>> import meshio, pathlib, tempfile
    >>> points = [[0, 0], [2, 0], [2, 1], [0, 1], [1, 0], [2, 0.5], [1, 1], [0, 0.5]]
    >>> deflection = [0, 0, 0, 0, 1e-3, 0, 1e-3, 0]
    >>> with tempfile.TemporaryDirectory() as directory:
    ...     path = pathlib.Path(directory, "plate.vtu")
    ...     fields = {"deflection": deflection, "displacement": displacement_vector(deflection)}
    ...     write_vtu(path, points, [range(8)], fields)
    ...     meshio.read(path).point_data["displacement"][4].tolist()
    [0.0, 0.0, -0.001]
    """
    import meshio  # type: ignore[import-untyped]

    nodes = np.asarray(points, dtype=float)
    cells = np.asarray(elements, dtype=np.int64)
    if nodes.ndim != 2 or nodes.shape[1] != 2:
        raise InputError(f"The nodes have the shape {nodes.shape}; it must be (n, 2).", place="points")
    if cells.ndim != 2 or cells.shape[1] != 8:
        raise InputError(f"The elements have the shape {cells.shape}; it must be (e, 8).", place="elements")
    mesh = meshio.Mesh(
        np.column_stack([nodes, np.zeros(len(nodes))]),
        [("quad8", cells)],
        point_data={name: _field(name, field, len(nodes), "nodes") for name, field in point_data.items()},
        cell_data={name: [_field(name, field, len(cells), "elements")] for name, field in (cell_data or {}).items()},
    )
    with replacing(path) as beside:
        mesh.write(beside, file_format="vtu", binary=True, compression="zlib")


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


def _field(name: str, field: ArrayLike, count: int, owners: str) -> NDArray[np.generic]:
    """Check a field and complete two components to three."""
    array = np.asarray(field)
    if array.shape not in [(count,), (count, 2), (count, 3)]:
        raise InputError(
            f"The field has the shape {array.shape}; for {count} {owners} it must be ({count},), "
            f"({count}, 2) or ({count}, 3).",
            place=name,
        )
    if array.dtype == bool:
        return array.astype(np.uint8)
    if array.shape[1:] == (2,):
        return np.column_stack([array, np.zeros(count, dtype=array.dtype)])
    return array
