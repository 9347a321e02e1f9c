"""Fields on 8-node quadrilaterals and 6-node triangles as meshio meshes and .vtu files (ParaView, PyVista)."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

import numpy as np
from numpy.typing import ArrayLike, NDArray

from signorini.base.files import replacing

if TYPE_CHECKING:
    import meshio  # type: ignore[import-untyped]

_TRIANGLE_NODES = [0, 1, 2, 4, 5, 7]
"""Indices of the six distinct nodes of a triangle, which is stored as 8 nodes [a, b, c, c, ab, bc, c, ca]."""


def as_meshio(
    points: NDArray[np.float64],
    elements: NDArray[np.int64],
    point_data: Mapping[str, ArrayLike],
    cell_data: Mapping[str, ArrayLike] | None = None,
) -> meshio.Mesh:
    """Return a meshio mesh in the plane z = 0 with fields; quadrilaterals precede triangles.

    Points (n, 2) are in the model's unit of length. A triangle among the elements (e, 8) is [a, b, c, c, ab, bc, c,
    ca]. Scalars keep their signs (deflection is positive down). To draw the deformed plate, add the vectors of
    `displacement_vector`.
    """
    # Import meshio only here, because it is rarely needed and slow to import.
    import meshio

    triangles = elements[:, 2] == elements[:, 3]
    blocks = [
        (kind, mask, elements[mask][:, nodes])
        for kind, mask, nodes in (("quad8", ~triangles, range(8)), ("triangle6", triangles, _TRIANGLE_NODES))
        if mask.any()
    ]
    block_data = {name: [np.asarray(data)[mask] for _, mask, _ in blocks] for name, data in (cell_data or {}).items()}
    points_3d = np.column_stack([points, np.zeros(len(points))])
    return meshio.Mesh(points_3d, [(kind, cells) for kind, _, cells in blocks], dict(point_data), block_data)


def write_vtu(path: str | os.PathLike[str], mesh: meshio.Mesh, metadata: Mapping[str, str] | None = None) -> None:
    """Write a mesh to a compressed binary VTK file, atomically; the metadata become a comment at its beginning."""
    import meshio

    # A comment in XML must not contain "--".
    comment = "; ".join(f"{name}: {text}" for name, text in (metadata or {}).items()).replace("--", "- -")
    # meshio writes names of fields without escapes, so escape characters that XML reserves.
    fields = {escape(name, {'"': "&quot;"}): values for name, values in mesh.point_data.items()}
    with replacing(path) as temporary:
        meshio.vtu.write(temporary, meshio.Mesh(mesh.points, mesh.cells, fields, mesh.cell_data))
        content = temporary.read_bytes()
        head = content.index(b"<VTKFile")
        temporary.write_bytes(content[:head] + f"<!-- {comment} -->\n".encode() + content[head:])


def write_pvtu(path: str | os.PathLike[str], pieces: Sequence[str], *fields: Mapping[str, NDArray[np.float64]]) -> None:
    """Write a .pvtu file atomically: it lists ``pieces``, .vtu files beside it, and their fields."""

    def arrays(data: Mapping[str, NDArray[np.float64]]) -> str:
        columns = ((name, 1 if values.ndim == 1 else values.shape[1]) for name, values in data.items())
        return "".join(
            f'<PDataArray type="Float64" Name="{escape(name, {chr(34): "&quot;"})}" NumberOfComponents="{count}"/>'
            for name, count in columns
        )

    at_nodes, in_elements = map(arrays, fields)
    listed = "".join(f'<Piece Source="{escape(piece)}"/>' for piece in pieces)
    text = (
        '<?xml version="1.0"?>\n<VTKFile type="PUnstructuredGrid" version="0.1" byte_order="LittleEndian">\n'
        '<PUnstructuredGrid GhostLevel="0">\n'
        '<PPoints><PDataArray type="Float64" Name="Points" NumberOfComponents="3"/></PPoints>\n'
        f"<PPointData>{at_nodes}</PPointData>\n<PCellData>{in_elements}</PCellData>\n"
        f"{listed}\n</PUnstructuredGrid>\n</VTKFile>\n"
    )
    with replacing(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def displacement_vector(deflection: ArrayLike) -> NDArray[np.float64]:
    """Return vectors (0, 0, -w) of deflections w, positive down, for *Warp By Vector* of ParaView, with z up."""
    down = np.asarray(deflection, dtype=float)
    vectors = np.zeros((len(down), 3))
    vectors[:, 2] = -down
    return vectors
