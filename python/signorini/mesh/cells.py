"""Convert meshes of meshio to nodes, elements and named edges; read the node numbers of mesh files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from signorini.base.components import components
from signorini.errors import InputError, point
from signorini.expression import LARGEST, LEAST
from signorini.mesh.checks import loops, on_boundary
from signorini.mesh.isoparametric import SIDES, real_sides
from signorini.shapes.arrays import Bools, Floats, Ints

if TYPE_CHECKING:
    import meshio  # type: ignore[import-untyped]


OUTLINE = "boundary"
"""Name of the edge that consists of all boundary sides."""
_SAME = 1e-9
"""Largest distance of nodes that are merged, relative to the plate's size."""
_FLAT = 1e-6
"""Largest difference of z in a plane mesh, relative to the plate's size: some files have only seven digits."""
_MAX_OFFSET = 1e6
"""Largest distance of a plate from the origin, relative to its size: ten digits remain for positions in the plate."""
_REVERSED = [0, 3, 2, 1, 7, 6, 5, 4]
_REVERSED_TRIANGLE = [0, 2, 1, 1, 7, 5, 1, 4]
_NODES = {
    "quad8": list(range(8)),
    "quad9": list(range(8)),
    "triangle6": [0, 1, 2, 2, 3, 4, 2, 5],
}
"""Nodes of a meshio cell of each type in the order of `signorini.mesh.Mesh`."""
_KNOWN = ("vertex", "line", "line3", *_NODES)


def arrays_of(data: meshio.Mesh) -> tuple[Floats, Ints, dict[str, Ints]]:
    """Convert a mesh of meshio to points (n, 2), elements (ne, 8) and edges of `signorini.mesh.Mesh`."""
    elements, quadrilaterals = _elements(data)
    points = _plane(np.asarray(data.points, dtype=np.float64), elements)
    number, first = _merged(points, elements)
    points, elements = points[first], number[elements]
    corners = points[elements[:, :4]]
    (x, y), (x_next, y_next) = np.moveaxis(corners, 2, 0), np.moveaxis(np.roll(corners, -1, axis=1), 2, 0)
    clockwise = (x * y_next - x_next * y).sum(axis=1) < 0.0
    turned = np.where(quadrilaterals[:, None], elements[:, _REVERSED], elements[:, _REVERSED_TRIANGLE])
    elements = _collapsed_side_first(np.where(clockwise[:, None], turned, elements), quadrilaterals)
    real = real_sides(elements)
    sides, outer = elements[:, np.array(SIDES)][real], on_boundary(elements)[real]
    outline = sides[outer]
    edges = _edges_of_lines(data, number, sides, outer)
    edges |= {name: edge for name, edge in _edges_of_nodes(data, number, outline).items() if name not in edges}
    if OUTLINE in edges and len(edges[OUTLINE]) != len(outline):
        raise InputError(
            f"The mesh has a group {OUTLINE!r} that is not the whole outline; this name is reserved. Rename the group."
        )
    return points, elements, edges | {OUTLINE: loops(outline)}


def _collapsed_side_first(elements: Ints, quadrilaterals: Bools) -> Ints:
    """Rotate the nodes of each quadrilateral (mask (ne,)) with a collapsed side so that this side comes first."""
    corners = elements[:, :4]
    first = (quadrilaterals[:, None] & (corners == np.roll(corners, -1, axis=1))).argmax(axis=1)
    around = (np.arange(4) + first[:, None]) % 4
    return np.take_along_axis(elements, np.hstack([around, 4 + around]), axis=1)


def _elements(data: meshio.Mesh) -> tuple[Ints, Bools]:
    """Elements (ne, 8) of a mesh of meshio, and a mask (ne,) of those that are quadrilaterals in the file."""
    counts: Counter[str] = Counter()
    for block in data.cells:
        counts[block.type] += len(block.data)
    others = [f"{count} {kind}" for kind, count in counts.items() if count and kind not in _KNOWN]
    if others:
        raise InputError(
            "The mesh has cells that are not 8- or 9-node quadrilaterals or 6-node triangles: "
            f"{', '.join(others)}. Use only second-order elements (in Gmsh: Mesh.ElementOrder = 2, "
            "Mesh.SecondOrderIncomplete = 1; for quadrilaterals where possible Mesh.RecombineAll = 1)."
        )
    blocks = [block for block in data.cells if block.type in _NODES]
    nodes = [np.asarray(block.data, dtype=np.int64)[:, _NODES[block.type]] for block in blocks]
    if not sum(map(len, nodes)):
        raise InputError("The mesh has no elements; the plate needs 8- or 9-node quadrilaterals or 6-node triangles.")
    elements = np.vstack(nodes)
    _require_nodes(data, elements, "An element")
    return elements, np.repeat([block.type != "triangle6" for block in blocks], list(map(len, nodes)))


def _require_nodes(data: meshio.Mesh, nodes: Ints, owner: str) -> None:
    wrong = (nodes < 0) | (nodes >= len(data.points))
    if wrong.any():
        raise InputError(
            f"{owner} of the mesh refers to node index {int(nodes[wrong][0])} (the first is 0); the mesh has "
            f"{len(data.points)} nodes."
        )


def _plane(points: Floats, elements: Ints) -> Floats:
    """Check that z is constant and return the points (n, 2) without it."""
    nodes = np.unique(elements)
    used = points[nodes]
    finite = np.isfinite(used).all(axis=1)
    if not finite.all():
        node = int(np.argmin(finite))
        position = ", ".join(f"{x:g}" for x in used[node])
        raise InputError(
            f"Node {nodes[node]} (the first has index 0) of the mesh is at ({position}); every coordinate must be a "
            "finite number."
        )
    height = float(np.ptp(used[:, 2])) if points.shape[1] == 3 else 0.0
    if not height <= _FLAT * float(np.ptp(used[:, :2], axis=0).max()):
        raise InputError(f"The mesh is not plane: z varies by {height:g}. All nodes of a plate must have the same z.")
    return points[:, :2]


def _merged(points: Floats, elements: Ints) -> tuple[Ints, Ints]:
    """Merge coincident nodes, and renumber the nodes that elements use.

    Return the new number (n,) of each node, −1 if unused, and for each new number an old number.
    """
    used = np.unique(elements)
    size, farthest = float(np.ptp(points[used], axis=0).max()), float(np.abs(points[used]).max())
    if size < LEAST or farthest > LARGEST:
        raise InputError(
            f"The nodes lie within {size:g}, up to {farthest:g} from the origin; a plate's size must be at least "
            f"{LEAST:g}, its coordinates at most {LARGEST:g}."
        )
    if farthest > _MAX_OFFSET * size:
        raise InputError(
            f"The plate has the size {size:g} and lies {farthest:g} from the origin, over {_MAX_OFFSET:g} times its "
            "size. Move it to the origin."
        )
    i, j = cKDTree(points[used]).query_pairs(_SAME * size, output_type="ndarray").T
    group = components(len(used), i, j)
    number = np.full(len(points), -1, dtype=np.int64)
    number[used] = group
    return number, used[np.unique(group, return_index=True)[1]]


def _edges_of_lines(data: meshio.Mesh, number: Ints, sides: Ints, outer: Bools) -> dict[str, Ints]:
    """Edges from named groups of lines; sides on the outline are directed with the plate on their left."""
    middles, first = np.unique(sides[:, 1], return_index=True)
    edges: dict[str, Ints] = {}
    for name, kind, lines in _named_lines(data):
        _require_nodes(data, lines, f"Group {name!r}")
        if kind == "line":
            raise InputError(
                f"Group {name!r} of the mesh consists of 2-node lines; second-order elements have 3-node lines."
            )
        triples = number[lines[:, [0, 2, 1]]]
        side = first[np.minimum(np.searchsorted(middles, triples[:, 1]), len(first) - 1)]
        nodes_differ = (np.sort(triples, axis=1) != np.sort(sides[side], axis=1)).any(axis=1)
        unmatched = nodes_differ | (triples[:, 1] != sides[side, 1])
        if unmatched.any():
            place = point(data.points[lines[np.argmax(unmatched), 2], :2])
            raise InputError(f"Group {name!r} of the mesh has a line at {place} that is not a side of an element.")
        triples = np.where(outer[side, None], sides[side], triples)
        edges[name] = np.vstack([edges[name], triples]) if name in edges else triples
    return {name: triples[np.unique(triples[:, 1], return_index=True)[1]] for name, triples in edges.items()}


def _named_lines(data: meshio.Mesh) -> list[tuple[str, str, Ints]]:
    """Name, cell type and nodes of each group of lines: the cell sets of meshio and the physical groups of Gmsh."""
    named = []
    for i, block in enumerate(data.cells):
        if block.type not in ("line", "line3"):
            continue
        for name, members in data.cell_sets.items():
            if not name.startswith("gmsh:") and members[i] is not None and len(members[i]):
                named.append((name, block.type, np.asarray(block.data)[members[i]]))
        tags = data.cell_data.get("gmsh:physical")
        for name, (tag, dimension) in data.field_data.items() if tags is not None else ():
            if dimension == 1 and (tags[i] == tag).any():
                named.append((name, block.type, np.asarray(block.data)[tags[i] == tag]))
    return named


def _edges_of_nodes(data: meshio.Mesh, number: Ints, outline: Ints) -> dict[str, Ints]:
    """Edges from named groups of nodes: a side of the outline belongs to the edge if the group has its three nodes."""
    edges = {}
    for name, members in data.point_sets.items():
        inside = np.zeros(int(number.max()) + 1, dtype=bool)
        members = np.asarray(members, dtype=np.int64)
        _require_nodes(data, members, f"Group {name!r}")
        nodes = number[members]
        inside[nodes[nodes >= 0]] = True
        triples = outline[inside[outline].all(axis=1)]
        if len(triples):
            edges[name] = triples
    return edges


_BY_POSITION = (".vtu", ".vtk")


def node_numbers(path: Path, count: int) -> Ints:
    """Node numbers (n,) in a file of Gmsh (.msh, text), Abaqus (.inp) or VTK (.vtu, .vtk), in meshio's order.

    Files of Gmsh and Abaqus contain the numbers; nodes of VTK files count from 0, as in ParaView.
    """
    match path.suffix.lower():
        case suffix if suffix in _BY_POSITION:
            return np.arange(count)
        case ".inp":
            numbers = _abaqus(path)
        case ".msh":
            numbers = _gmsh(path)
        case suffix:
            raise InputError(
                f"Node numbers are read from files .msh, .inp, .vtu and .vtk, not {suffix}. Give points with at, or "
                "write the mesh in one of these formats."
            )
    if len(numbers) != count:
        raise InputError(f"The mesh file numbers {len(numbers)} of its {count} nodes; every node needs a number.")
    return numbers


def node_blocks(path: Path) -> int:
    """Number of lines *NODE, each the heading of a block of nodes, in an Abaqus file."""
    return sum(map(_heads_nodes, _lines(path)))


def _heads_nodes(line: str) -> bool:
    return line.partition(",")[0].strip().upper() == "*NODE"


def _abaqus(path: Path) -> Ints:
    """Node numbers in the blocks *NODE of an Abaqus file."""
    numbers, reading = [], False
    for line in _lines(path):
        if line.startswith("*"):
            reading = _heads_nodes(line)
        elif reading and line:
            numbers.append(int(line.partition(",")[0]))
    return np.array(numbers, dtype=np.int64)


def _gmsh(path: Path) -> Ints:
    lines = _lines(path)
    version = ""
    for line in lines:
        if line == "$MeshFormat":
            version, binary = next(lines).split()[:2]
            if binary == "1":
                raise InputError(
                    "Node numbers are read from text files of Gmsh; this file is binary. Write it with Mesh.Binary = "
                    "0, or give points with at."
                )
        elif line == "$Nodes":
            break
    first = next(lines).split()
    if not version.startswith("4"):
        return np.array([int(next(lines).split()[0]) for _ in range(int(first[0]))], dtype=np.int64)
    numbers: list[int] = []
    for _ in range(int(first[0])):
        size = int(next(lines).split()[-1])
        numbers += [int(next(lines)) for _ in range(size)]
        for _ in range(size):
            next(lines)
    return np.array(numbers, dtype=np.int64)


def _lines(path: Path) -> Iterator[str]:
    with path.open(encoding="utf-8", errors="replace") as file:
        yield from (line.strip() for line in file)
