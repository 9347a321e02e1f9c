"""Fuzz the command line with mesh files: small plates in every format, with a few wrong bytes, numbers or lines.

python tests/fuzz/meshes.py [--count 100000] [--first 0] [--seconds 600] [--processes 2]
python tests/fuzz/meshes.py --show SEED     the mesh file of a seed, and its outcome
"""

from __future__ import annotations

import contextlib
import functools
import io
import re
import sys
import tempfile
from collections import Counter
from pathlib import Path
from random import Random

import campaign
import inputs
import meshio
import numpy as np

from signorini.mesh.meshers import rectangle
from signorini.mesh.meshfile import read

FORMATS = {
    "gmsh22": (".msh", {"binary": False}),
    "gmsh22 binary": (".msh", {"binary": True}),
    "gmsh": (".msh", {"binary": False}),
    "abaqus": (".inp", {}),
    "vtu": (".vtu", {"binary": False}),
    "vtu binary": (".vtu", {"binary": True}),
    "vtk": (".vtk", {"binary": False}),
    "ply": (".ply", {"binary": False}),
}
MODEL = """material = {{ E = 30e6, nu = 0.2 }}
plate = {{ shape = "mesh", file = "{file}", thickness = 0.2 }}
support = [{{ area = "all", stiffness = 1.0 }}, {{ edge = "{edge}", fix = "simple" }}]
load = [{{ pressure = 5 }}]
"""
_NUMBER = re.compile(rb"-?\d+(\.\d+)?(e[+-]?\d+)?")
_NUMBERS = [b"0", b"-1", b"1", b"2", b"7", b"3.5", b"999999", b"nan", b"inf", b"1e300", b"1e-300", b"1e61", b"9" * 23]
_GRID = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, 15)] * 2), axis=-1).reshape(-1, 2)
_PIECES = [b"\xff\xfe", b"\0", b"$EndNodes\n", b"<", b">", b"*NODE\n", b"1 ", b"x", b"\n"]


@functools.cache
def written(kind: str, degrees: int = 0) -> bytes:
    """A plate of four elements with the group ``wall`` as a file of a kind; or a strip bent by ``degrees``."""
    plate = rectangle((0.0, 0.0), (4.0, 4.0), (12, 1) if degrees else (2, 2))
    x, y = plate.points.T
    if degrees:
        angle, radius = np.radians(degrees) * x / 4.0, 8.0 - y - 0.4 * x
        x, y = radius * np.cos(angle), radius * np.sin(angle)
    points, wall = np.column_stack([x, y, np.zeros(len(x))]), plate.edges["left"]
    cells, sets = [("quad8", plate.elements)], {"point_sets": {"wall": np.unique(wall)}}
    if kind != "gmsh":
        cells.append(("line3", wall[:, [0, 2, 1]]))
        sets["cell_sets"] = {"wall": [np.array([], dtype=int), np.arange(len(wall))]}
    suffix, options = FORMATS[kind]
    with tempfile.TemporaryDirectory() as directory:
        path = Path(directory, f"plate{suffix}")
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            meshio.Mesh(points, cells, **sets).write(path, file_format=kind.partition(" ")[0], **options)
        return path.read_bytes()


def file(rng: Random) -> tuple[str, bytes]:
    """Draw a mesh file: its name and content."""
    kind = rng.choice(sorted(FORMATS))
    content = written(kind, rng.choice([0, 0, 0, rng.choice([200, 350, 380, 400])]))
    for _ in range(rng.choice([0, 1, 1, 1, 2, 5])):
        content = rng.choice([_number, _number, _number, _line, _bytes])(rng, content)
    return f"plate{FORMATS[kind][0]}", content


def _number(rng: Random, content: bytes) -> bytes:
    found = rng.choice(list(_NUMBER.finditer(content)) or [None])
    return content if found is None else content[: found.start()] + rng.choice(_NUMBERS) + content[found.end() :]


def _line(rng: Random, content: bytes) -> bytes:
    lines = content.split(b"\n")
    at = rng.randrange(len(lines))
    return b"\n".join([*lines[:at], *[lines[at]] * rng.choice([0, 2, 50]), *lines[at + 1 :]])


def _bytes(rng: Random, content: bytes) -> bytes:
    at = rng.randrange(len(content) + 1)
    put, drop = rng.choice([(rng.choice(_PIECES), 0), (b"", 1), (b"", 100), (b"", 10**6), (rng.randbytes(1), 1)])
    return content[:at] + put + content[at + drop :]


def _overlaps(file: Path) -> bool:
    """Whether points well inside an element are in another one too."""
    mesh = read(file)
    inside = mesh.spread(np.arange(len(mesh.elements)), _GRID, 0.9)
    return bool((np.bincount(mesh.holding(inside.reshape(-1, 2))[0]) > 1).any())


def one(seed: int) -> tuple[Counter[str], list[str]]:
    """Draw and solve one plate: its outcome and its faults."""
    rng = Random(seed)
    name, content = file(rng)
    with tempfile.TemporaryDirectory() as directory:
        Path(directory, name).write_bytes(content)
        model = MODEL.format(file=name, edge=rng.choice(["wall", "boundary"]))
        code, _, wrong = inputs.ended(model.encode(), "solve", Path(directory), pictures=False)
        if code == 0 and _overlaps(Path(directory, name)):
            wrong.append("elements overlap")
    return Counter({f"exit {code}": 1}), wrong


def show(seed: int) -> None:
    """Print the mesh file of a seed."""
    sys.stdout.buffer.write(file(Random(seed))[1])
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(campaign.main(__doc__, one, show))
