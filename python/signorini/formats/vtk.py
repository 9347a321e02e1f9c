"""Fields on a mesh of 8-node quadrilaterals and 6-node triangles, as a ``.vtu`` file for ParaView."""

from __future__ import annotations

import os
import sys
import zlib
from base64 import b64encode
from collections.abc import Mapping
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini.base.files import replacing
from signorini.errors import InputError

_BLOCK = 32768
"""Bytes that are compressed together, as VTK does by itself."""
_FAST = 1
"""zlib's level: the numbers of fields hardly get smaller at higher ones, which take three times as long."""
_QUADRATIC_TRIANGLE, _QUADRATIC_QUAD = 22, 23
_OF_TRIANGLE = np.array([True, True, True, False, True, True, False, True])
_TYPES = {"f8": "Float64", "f4": "Float32", "i8": "Int64", "i4": "Int32", "u1": "UInt8"}


class Vtu:
    """A mesh for ``.vtu`` files, encoded once for any number of them.

    Parameters
    ----------
    points : array_like, shape (n, 2)
    elements : array_like of int, shape (e, 8)

    Raises
    ------
    InputError
        An array has another shape.
    """

    def __init__(self, points: ArrayLike, elements: ArrayLike) -> None:
        nodes = np.asarray(points, dtype=float)
        cells = np.asarray(elements, dtype=np.int64)
        if nodes.ndim != 2 or nodes.shape[1] != 2:
            raise InputError(f"The nodes have the shape {nodes.shape}; it must be (n, 2).", place="points")
        if cells.ndim != 2 or cells.shape[1] != 8:
            raise InputError(f"The elements have the shape {cells.shape}; it must be (e, 8).", place="elements")
        self._nodes, self._cells = len(nodes), len(cells)
        places = _data_array("Points", np.column_stack([nodes, np.zeros(len(nodes))]))
        triangles = cells[:, 2] == cells[:, 3]
        own = np.where(triangles[:, None], _OF_TRIANGLE, True)
        parts: dict[str, NDArray[np.generic]] = {
            "connectivity": cells[own],
            "offsets": np.cumsum(own.sum(axis=1)),
            "types": np.where(triangles, _QUADRATIC_TRIANGLE, _QUADRATIC_QUAD).astype(np.uint8),
        }
        listed = "".join(_data_array(name, part) for name, part in parts.items())
        self._mesh = f"<Points>{places}</Points><Cells>{listed}</Cells>"

    def write(
        self,
        path: str | os.PathLike[str],
        point_data: Mapping[str, ArrayLike],
        cell_data: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        """Write a file of fields as `write_vtu` does, but not aside first."""
        of_nodes = (_data_array(name, _field(name, data, self._nodes, "nodes")) for name, data in point_data.items())
        of_cells = (
            _data_array(name, _field(name, data, self._cells, "elements")) for name, data in (cell_data or {}).items()
        )
        text = (
            f'<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="0.1" byte_order='
            f'"{sys.byteorder.capitalize()}Endian" compressor="vtkZLibDataCompressor"><UnstructuredGrid>'
            f'<Piece NumberOfPoints="{self._nodes}" NumberOfCells="{self._cells}">{self._mesh}'
            f"<PointData>{''.join(of_nodes)}</PointData><CellData>{''.join(of_cells)}</CellData>"
            "</Piece></UnstructuredGrid></VTKFile>\n"
        )
        Path(path).write_text(text, encoding="utf-8")


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
        Corners counter-clockwise, then midsides (VTK's quadratic quadrilateral); a triangle [a, b, c, c, ab, bc, c, ca]
        is VTK's quadratic one.
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
    mesh = Vtu(points, elements)
    with replacing(path) as beside:
        mesh.write(beside, point_data, cell_data)


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


def _data_array(name: str, data: NDArray[np.generic]) -> str:
    """Give an array as VTK's element of that name: blocks compressed, in base 64, after a header with their sizes."""
    if data.dtype.str[1:] not in _TYPES:
        data = data.astype(np.float64)
    raw = data.astype(data.dtype.newbyteorder("=")).tobytes()
    blocks = [zlib.compress(raw[start : start + _BLOCK], _FAST) for start in range(0, len(raw), _BLOCK)]
    last = len(raw) - _BLOCK * (len(blocks) - 1)
    header = np.array([len(blocks), _BLOCK, last, *map(len, blocks)], np.uint32)
    components = f' NumberOfComponents="{data.shape[1]}"' if data.ndim == 2 else ""
    text = (b64encode(header.tobytes()) + b64encode(b"".join(blocks))).decode()
    kind = _TYPES[data.dtype.str[1:]]
    return f'<DataArray type="{kind}" Name="{escape(name)}"{components} format="binary">{text}</DataArray>'
