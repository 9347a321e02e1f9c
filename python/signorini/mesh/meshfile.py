"""Read mesh files of 8- or 9-node quadrilaterals and 6-node triangles, in any format of meshio."""

from __future__ import annotations

import contextlib
import ctypes
import io
import os
import re
import threading
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import meshio  # type: ignore[import-untyped]

from signorini.base.regular import open_regular
from signorini.errors import InputError
from signorini.mesh import Mesh
from signorini.mesh.cells import node_blocks, node_numbers

_T = TypeVar("_T")

_LARGEST_FILE = 4_000_000_000
"""Largest size of a mesh file in bytes; ten million elements as text need about three quarters of it."""
_SECONDS, _SECONDS_PER_MB = 10.0, 10.0
"""Seconds allowed for reading a file: a constant, and seconds per megabyte, a hundred times the usual time. Wrong
counts in a damaged file can make a parser read forever."""
_LONGEST_REASON = 200
"""Largest number of characters of a parser's message that an error quotes."""


def read(path: str | Path) -> Mesh:
    """Read a mesh file.

    Coincident nodes (within 1e-9 of the size) are merged, clockwise elements reversed, center nodes of 9-node
    quadrilaterals and unused nodes removed. The extension selects the format (.msh, .vtu, .inp, .med, ...). For the
    edges see `Mesh.from_meshio`.
    """
    return _read(Path(path), Mesh.from_meshio)


def read_numbered(path: str | Path) -> tuple[Mesh, dict[int, tuple[float, float]]]:
    """Read a mesh file; return the mesh, and the position of each node by its number in the file.

    The positions include merged and unused nodes. Formats without node numbers are refused; see `signorini.mesh.cells`.
    """
    path = Path(path)

    def numbered(data: meshio.Mesh) -> tuple[Mesh, dict[int, tuple[float, float]]]:
        numbers = node_numbers(path, len(data.points)).tolist()
        points = data.points[:, :2].astype(float).tolist()
        return Mesh.from_meshio(data), {number: (x, y) for number, (x, y) in zip(numbers, points, strict=True)}

    return _read(path, numbered)


def _read(path: Path, make: Callable[[meshio.Mesh], _T]) -> _T:
    try:
        with open_regular(path, _LARGEST_FILE) as file:
            data = _load(path, os.fstat(file.fileno()).st_size)
    except FileNotFoundError:
        raise InputError("The mesh file does not exist.", place=str(path)) from None
    except IsADirectoryError:
        raise InputError("This is a directory; give the mesh file.", place=str(path)) from None
    except InputError:
        raise
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise InputError(f"The mesh file cannot be read: {why}.", place=str(path)) from None
    try:
        return make(data)
    except InputError as error:
        raise InputError(error.message, place=str(path)) from None


def _load(path: Path, size: int) -> meshio.Mesh:
    """Read a file of ``size`` bytes with meshio, whose parsers may print, exit, raise any exception, or never end."""
    output = io.StringIO()
    outcome: list[meshio.Mesh | BaseException] = []

    def read_it() -> None:
        try:
            outcome.append(meshio.read(path))
        except BaseException as error:
            outcome.append(error)

    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        reader = threading.Thread(target=read_it, daemon=True)
        reader.start()
        reader.join(_SECONDS + _SECONDS_PER_MB * size / 1e6)
        if reader.is_alive() and reader.ident is not None:
            outcome[:] = [TimeoutError("reading it does not terminate")]
            # End the thread, which would otherwise continue to read in the background.
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(reader.ident), ctypes.py_object(SystemExit))
    if outcome and isinstance(outcome[0], meshio.Mesh):
        return outcome[0]
    error = outcome[0]
    if path.suffix.lower() == ".inp" and (blocks := node_blocks(path)) > 1:
        raise InputError(
            f"Its nodes are in {blocks} blocks *NODE, of which meshio reads only the last. Put them all under one "
            "heading *NODE.",
            place=str(path),
        )
    reason = " ".join((output.getvalue() if isinstance(error, SystemExit) else str(error)).split())
    reason = re.sub(r"\b(Warning|Error): ", "", reason)
    if isinstance(error, LookupError):
        reason = f"it refers to {reason}, which it does not contain"
    reason = reason if len(reason) <= _LONGEST_REASON else f"{reason[:_LONGEST_REASON]}..."
    raise InputError(
        f"The file cannot be read as a mesh ({reason or type(error).__name__}). Check that its extension fits its "
        "format and that it is complete.",
        place=str(path),
    )
