"""Provenance of results: the program with version and commit, and the input with its SHA-256."""

from __future__ import annotations

import hashlib
import json
import subprocess
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Self

from signorini._core import __version__

PROGRAM = "signorini"
_SOURCES = Path(__file__).resolve().parents[3]
"""The repository, if the package runs from its sources."""


@cache
def commit() -> str | None:
    """Hash of the commit of the sources, with "-dirty" if files are modified; None for an installed package."""
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
    """

    file: str | None
    sha256: str
    text: str

    @classmethod
    def of(cls, tables: Mapping[str, Any], file: tuple[str, str] | None) -> Self:
        """Return the provenance of the input's tables, with the name and the SHA-256 of its file."""
        text = json.dumps(tables, separators=(",", ":"), ensure_ascii=False, default=_name)
        name, sha256 = file or (None, hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest())
        return cls(name, sha256, text)

    def json(self, options: Mapping[str, Any]) -> dict[str, Any]:
        """The keys "program", "input" and "options" of ``results.json`` and ``path.json``."""
        return {
            "program": {"name": PROGRAM, "version": __version__, "commit": commit()},
            "input": {"file": self.file, "sha256": self.sha256, "model": json.loads(self.text)},
            "options": dict(options),
        }

    @property
    def metadata(self) -> dict[str, str]:
        """Metadata of pictures, VTU and Parquet files."""
        known = {"Software": f"{PROGRAM} {__version__}", "Commit": commit(), "Input": self.file}
        return {name: text for name, text in known.items() if text} | {"Input-SHA256": self.sha256}


def _name(value: object) -> str:
    """Name of a path or a function; JSON cannot represent the object itself."""
    return str(value) if isinstance(value, Path) else getattr(value, "__qualname__", type(value).__name__)
