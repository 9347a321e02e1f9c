"""Rows of a study on disk: files with some of the rows while the study runs, and the complete table at its end."""

from __future__ import annotations

import json
import shutil
import uuid
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from signorini.errors import InputError
from signorini.formats.parquet import read_rows, write_rows
from signorini.studies.variant import Row

TABLE = "study.parquet"
_PARTS = "study-rows"
"""Name of the directory, inside the study's directory, of the files with rows of an unfinished study."""
_KEY = "Study-SHA256"
"""Key in a table's metadata; its value is the SHA-256 of the study's template, parameters, results and program."""


class Store:
    """The rows of one study, stored in a directory to which several processes may write."""

    def __init__(self, directory: Path, sha256: str, metadata: Mapping[str, str], types: Mapping[str, type]) -> None:
        self.directory, self._types = directory, types
        self._metadata = {**metadata, _KEY: sha256}

    def rows(self) -> dict[int, Row]:
        """Return all stored rows of the study by the number of the variant.

        Raises
        ------
        InputError
            If a file has rows of another study.
        """
        result: dict[int, Row] = {}
        for file in (self.directory / TABLE, *sorted((self.directory / _PARTS).glob("*.parquet"))):
            # Another process may remove the files with rows as soon as it has written the complete table.
            with suppress(FileNotFoundError):
                rows, metadata = read_rows(file)
                if metadata.get(_KEY) != self._metadata[_KEY]:
                    why = "it has rows of another study: another template, parameters, results or program."
                    raise InputError(f"{why} Give another directory with -o, or remove the file.", str(file))
                result |= {row["row"]: row for row in rows}
        return result

    def add(self, rows: Iterable[Row]) -> None:
        """Write some rows of the study atomically as one file."""
        parts = self.directory / _PARTS
        parts.mkdir(parents=True, exist_ok=True)
        self._write(parts / f"{uuid.uuid4().hex}.parquet", rows)

    def finish(self, rows: Sequence[Row]) -> None:
        """Write all rows of the study as its complete table, and remove the files with some of the rows."""
        self._write(self.directory / TABLE, rows)
        shutil.rmtree(self.directory / _PARTS, ignore_errors=True)

    def _write(self, file: Path, rows: Iterable[Row]) -> None:
        texts = [name for name, kind in self._types.items() if kind is str]
        plain = (row | {name: _as_text(row[name]) for name in texts} for row in rows)
        write_rows(file, plain, self._types, self._metadata)


def _as_text(value: object) -> str:
    """Return a value for a text column: a text unchanged, other values as JSON."""
    return value if isinstance(value, str) else json.dumps(value)


def type_of(values: Collection[object]) -> type:
    """Return the type of a parameter's column: float, bool, or str if values are texts, lists or of several types."""
    kinds = {
        float if isinstance(value, int | float) and not isinstance(value, bool) else type(value) for value in values
    }
    return kinds.pop() if kinds in ({float}, {bool}) else str
