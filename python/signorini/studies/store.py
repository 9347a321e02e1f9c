"""The rows of a study on disk: parts that are written while it runs, and the table at its end."""

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
"""Directory of the parts, inside that of the study."""
_KEY = "Study-SHA256"
"""Metadata of a table: SHA-256 of the study, which identifies template, parameters, results and program."""


class Store:
    """The rows of one study in a directory; several processes may write to it."""

    def __init__(self, directory: Path, sha256: str, metadata: Mapping[str, str], types: Mapping[str, type]) -> None:
        self.directory, self._types = directory, types
        self._metadata = {**metadata, _KEY: sha256}

    def rows(self) -> dict[int, Row]:
        """All rows that are stored, by number.

        Raises
        ------
        InputError
            If a file has rows of another study.
        """
        result: dict[int, Row] = {}
        for file in (self.directory / TABLE, *sorted((self.directory / _PARTS).glob("*.parquet"))):
            # Another process may remove the parts as soon as the table has all rows.
            with suppress(FileNotFoundError):
                rows, metadata = read_rows(file)
                if metadata.get(_KEY) != self._metadata[_KEY]:
                    why = "it has rows of another study: another template, parameters, results or program."
                    raise InputError(f"{why} Give another directory with -o, or remove the file.", str(file))
                result |= {row["row"]: row for row in rows}
        return result

    def add(self, rows: Iterable[Row]) -> None:
        """Write some rows as one part, whole or not at all."""
        parts = self.directory / _PARTS
        parts.mkdir(parents=True, exist_ok=True)
        self._write(parts / f"{uuid.uuid4().hex}.parquet", rows)

    def finish(self, rows: Sequence[Row]) -> None:
        """Write all rows of the study as its table; remove the parts."""
        self._write(self.directory / TABLE, rows)
        shutil.rmtree(self.directory / _PARTS, ignore_errors=True)

    def _write(self, file: Path, rows: Iterable[Row]) -> None:
        texts = [name for name, kind in self._types.items() if kind is str]
        plain = (row | {name: _as_text(row[name]) for name in texts} for row in rows)
        write_rows(file, plain, self._types, self._metadata)


def _as_text(value: object) -> str:
    """Value of a column of texts; JSON where it is no text."""
    return value if isinstance(value, str) else json.dumps(value)


def type_of(values: Collection[object]) -> type:
    """Type of the column of a parameter: text where the values have several kinds."""
    kinds = {
        float if isinstance(value, int | float) and not isinstance(value, bool) else type(value) for value in values
    }
    return kinds.pop() if kinds in ({float}, {bool}) else str
