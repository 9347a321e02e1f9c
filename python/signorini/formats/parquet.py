"""Write tables to Parquet files in blocks of rows."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, Protocol

import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from signorini.base.files import replacing

Column = Sequence[str] | npt.NDArray[Any]
Blocks = Mapping[str, npt.NDArray[Any]]


class Sink(Protocol):
    """Type of a function that appends blocks of rows to a Parquet file; all blocks have the same columns."""

    def __call__(self, columns: Iterable[tuple[str, Column]]) -> None:
        """Append a block of rows, given as pairs of column name and values, as a row group."""


def widen(
    path: str | os.PathLike[str], others: Sequence[str | os.PathLike[str]], derive: Callable[[Sequence[Blocks]], Blocks]
) -> None:
    """Add columns to a Parquet file, computed from its columns and the columns of other files with the same rows.

    For each block of rows ``derive`` gets the numeric columns of this file and of each other file; it returns the new
    columns.
    """
    file = pq.ParquetFile(path)
    metadata = {name.decode(): text.decode() for name, text in (file.schema_arrow.metadata or {}).items()}
    readers = [_Rows(pq.ParquetFile(other)) for other in others]
    with writing(path, metadata) as sink:
        for group in range(file.num_row_groups):
            block = file.read_row_group(group)
            blocks = [block, *(reader.take(len(block)) for reader in readers)]
            added = derive([_numbers(block) for block in blocks])
            sink([*zip(block.schema.names, block.columns, strict=True), *added.items()])


class _Rows:
    """Reads consecutive rows of a Parquet file in blocks of any size."""

    def __init__(self, file: pq.ParquetFile) -> None:
        self._groups = (file.read_row_group(group) for group in range(file.num_row_groups))
        self._unread: Any = None

    def take(self, count: int) -> Any:
        """Return the next ``count`` rows of the file."""
        while self._unread is None or len(self._unread) < count:
            group = next(self._groups)
            self._unread = group if self._unread is None else pa.concat_tables([self._unread, group])
        rows, self._unread = self._unread.slice(0, count), self._unread.slice(count)
        return rows


def _numbers(block: Any) -> Blocks:
    """Floating-point columns of a block of rows by name; absent values are NaN."""
    columns = zip(block.schema.names, block.schema.types, strict=True)
    return {name: block.column(name).to_numpy() for name, kind in columns if pa.types.is_floating(kind)}


@contextmanager
def writing(path: str | os.PathLike[str], metadata: Mapping[str, str]) -> Iterator[Sink]:
    """Context with a function that appends blocks of rows to a Parquet file.

    The file appears at the end of the context, and only if it is complete. A block of rows is given as pairs of column
    name and array or list of texts; NaN is an absent value. The metadata are stored in the schema of the file.
    """
    with replacing(path) as temporary:
        writer: pq.ParquetWriter | None = None
        try:

            def sink(columns: Iterable[tuple[str, Column]]) -> None:
                nonlocal writer
                block = pa.table(
                    {
                        name: values if isinstance(values, pa.ChunkedArray) else pa.array(values, from_pandas=True)
                        for name, values in columns
                    },
                    metadata=dict(metadata),
                )
                if writer is None:
                    writer = pq.ParquetWriter(temporary, block.schema)
                writer.write_table(block)

            yield sink
        finally:
            if writer is not None:
                writer.close()


_ARROW = {int: pa.int64(), float: pa.float64(), str: pa.string(), bool: pa.bool_()}


def write_rows(
    path: str | os.PathLike[str],
    rows: Iterable[Mapping[str, Any]],
    types: Mapping[str, type],
    metadata: Mapping[str, str],
) -> None:
    """Write rows to a Parquet file atomically; ``types`` are the Python types of the columns by name."""
    schema = pa.schema([(name, _ARROW[kind]) for name, kind in types.items()], metadata=dict(metadata))
    with replacing(path) as temporary:
        pq.write_table(pa.Table.from_pylist(list(rows), schema), temporary)


def read_rows(path: str | os.PathLike[str]) -> tuple[list[dict[str, Any]], Mapping[str, str]]:
    """Return the rows and the metadata of a Parquet file."""
    table = pq.read_table(path)
    return table.to_pylist(), {name.decode(): text.decode() for name, text in (table.schema.metadata or {}).items()}
