"""Numbers of the nodes in a mesh file, which meshio does not keep."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from signorini.errors import InputError

Ints = npt.NDArray[np.int64]

_BY_POSITION = (".vtu", ".vtk")


def node_numbers(path: Path, count: int) -> Ints:
    """Numbers (n,) of so many nodes, in the order of the file, which meshio has read already.

    Parameters
    ----------
    path : Path
        A file of Gmsh (.msh, as text), Abaqus (.inp) or VTK (.vtu, .vtk). The first two number their nodes; of VTK the
        first has 0, as ParaView shows it.
    count : int

    Raises
    ------
    InputError
        If it is of another format.
    """
    match path.suffix.lower():
        case suffix if suffix in _BY_POSITION:
            return np.arange(count)
        case ".inp":
            result = _abaqus(path)
        case ".msh":
            result = _gmsh(path)
        case suffix:
            raise InputError(
                f"Nodes by number are found in files .msh, .inp, .vtu and .vtk, not in {suffix}. Give points with at, "
                "or write the mesh in one of these formats."
            )
    if len(result) != count:
        raise InputError(f"The mesh file numbers {len(result)} of its {count} nodes; every node needs a number.")
    return result


def node_blocks(path: Path) -> int:
    """How many headings *NODE a file of Abaqus has."""
    return sum(map(_heads_nodes, _lines(path)))


def _heads_nodes(line: str) -> bool:
    return line.partition(",")[0].strip().upper() == "*NODE"


def _abaqus(path: Path) -> Ints:
    """Numbers under the headings *NODE."""
    result, reading = [], False
    for line in _lines(path):
        if line.startswith("*"):
            reading = _heads_nodes(line)
        elif reading and line:
            result.append(int(line.partition(",")[0]))
    return np.array(result, dtype=np.int64)


def _gmsh(path: Path) -> Ints:
    lines = _lines(path)
    version = ""
    for line in lines:
        if line == "$MeshFormat":
            version, binary = next(lines).split()[:2]
            if binary == "1":
                raise InputError(
                    "Nodes by number are found in files of Gmsh that are text; this one is binary. Write it with "
                    "Mesh.Binary = 0, or give points with at."
                )
        elif line == "$Nodes":
            break
    first = next(lines).split()
    if not version.startswith("4"):
        return np.array([int(next(lines).split()[0]) for _ in range(int(first[0]))], dtype=np.int64)
    result: list[int] = []
    for _ in range(int(first[0])):
        size = int(next(lines).split()[-1])
        result += [int(next(lines)) for _ in range(size)]
        for _ in range(size):
            next(lines)
    return np.array(result, dtype=np.int64)


def _lines(path: Path) -> Iterator[str]:
    with path.open(encoding="utf-8", errors="replace") as file:
        yield from (line.strip() for line in file)
