"""Provenance of results: the program with version and commit, and the input with its SHA-256."""

from __future__ import annotations

import base64
import gzip
import hashlib
import json
import subprocess
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any, Self

from signorini._core import __version__
from signorini.base.regular import open_regular

PROGRAM = "signorini"
FUNCTION = "function"
"""Key of the table {"function": name} that replaces a Python function in the JSON of an input."""
_LARGEST_FILE = 4_000_000_000
"""Largest allowed size in bytes of a file that an input names, such as a mesh file."""
LARGEST_EMBEDDED = 20_000_000
"""Largest size in bytes of a file named in the input whose content is embedded in results."""
_LARGEST_PACKED = 1_000_000
"""Largest size in bytes, after compression, of a file whose content is embedded in results."""
_SOURCES = Path(__file__).resolve().parents[3]
"""Root directory of the repository, if the package runs from its sources."""


@cache
def commit() -> str | None:
    """Return the hash of the source's commit, with "-dirty" if files are modified; None for an installed package."""
    if not (_SOURCES / ".git").exists():
        return None
    describe = ("describe", "--always", "--dirty", "--abbrev=40", "--exclude=*")
    try:
        described = subprocess.run(
            ["git", "--no-optional-locks", "-C", str(_SOURCES), *describe], capture_output=True, text=True, check=True
        )
    except (OSError, subprocess.CalledProcessError):
        return None
    return described.stdout.strip()


@dataclass(frozen=True)
class Provenance:
    """Origin of an input: its file and content.

    Parameters
    ----------
    file : str or None
        Name of the input file; None for a model made in Python.
    sha256 : str
        SHA-256 of the file's bytes; without a file, of ``text`` in UTF-8.
    text : str
        The whole input as compact JSON.
    path : str or None
        Path of the input file.
    """

    file: str | None
    sha256: str
    text: str
    path: str | None = None

    @classmethod
    def of(cls, tables: Mapping[str, Any], file: tuple[str, str] | None, path: str | None) -> Self:
        """Return the provenance of an input with these tables; ``file`` is the name and the SHA-256 of its file.

        ``path`` is the input file from which the tables were read, perhaps before a change of the tables.
        """
        text = _compact(tables)
        name, sha256 = file or (None, _sha256(text))
        return cls(name, sha256, text, path)

    @cached_property
    def read(self) -> list[str]:
        """Paths of the files that a run with this input reads: the input file, and the files that the input names."""
        model = json.loads(self.text)
        named = [one[key] for key in ("file", "logo") for one in tables_with(key, model)]
        return [self.path, *named] if self.path else named

    def json(self, options: Mapping[str, Any]) -> dict[str, Any]:
        """The keys "program", "input" and "options" of ``results.json`` and ``path.json``."""
        return {
            "program": {"name": PROGRAM, "version": __version__, "commit": commit()},
            "input": {
                "file": self.file,
                "sha256": self.sha256,
                "model": (model := json.loads(self.text)),
                "model_sha256": sha256_of(model),
                "files": [_embedded(file) for file in dict.fromkeys(one["file"] for one in tables_with("file", model))],
            },
            "options": dict(options),
        }

    @property
    def metadata(self) -> dict[str, str]:
        """Metadata for pictures, VTU and Parquet files: program, commit, name and SHA-256 of the input file."""
        known = {"Software": f"{PROGRAM} {__version__}", "Commit": commit(), "Input": self.file}
        return {name: text for name, text in known.items() if text} | {"Input-SHA256": self.sha256}


def sha256_of(model: Any) -> str:
    """SHA-256 of the compact JSON of an input."""
    return _sha256(_compact(model))


def tables_with(key: str, node: Any) -> Iterator[dict[str, Any]]:
    """Yield the tables of an input in which ``key`` has a text, which for "file" is the name of a mesh or CSV file."""
    if isinstance(node, dict) and isinstance(node.get(key), str):
        yield node
    for value in node.values() if isinstance(node, dict) else node if isinstance(node, list) else ():
        yield from tables_with(key, value)


def _embedded(file: str) -> dict[str, str | None]:
    """Return SHA-256 and content (base64 of gzip) of a file that the input names; None if unreadable or too large."""
    try:
        with open_regular(file, _LARGEST_FILE) as opened:
            sha256 = hashlib.file_digest(opened, "sha256").hexdigest()
            small = opened.tell() <= LARGEST_EMBEDDED
            opened.seek(0)
            packed = gzip.compress(opened.read(), mtime=0) if small else b""
    except OSError:
        return {"file": file, "sha256": None, "gzip": None}
    embedded = small and len(packed) <= _LARGEST_PACKED
    return {"file": file, "sha256": sha256, "gzip": base64.b64encode(packed).decode("ascii") if embedded else None}


def _compact(tables: Mapping[str, Any]) -> str:
    return json.dumps(tables, separators=(",", ":"), ensure_ascii=False, default=_plain)


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def _plain(value: object) -> object:
    """Convert a path to its text or a function to a table with its name, for `json.dumps`."""
    if isinstance(value, Path):
        return str(value)
    return {FUNCTION: getattr(value, "__qualname__", type(value).__name__)}
