"""Columns into a Parquet file, block by block."""

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
    """Takes the columns of one block after the other, always the same ones."""

    def __call__(self, columns: Iterable[tuple[str, Column]]) -> None:
        """Write a block, a row group of the file."""


def widen(
    path: str | os.PathLike[str], others: Sequence[str | os.PathLike[str]], more: Callable[[Sequence[Blocks]], Blocks]
) -> None:
    """Add columns to a Parquet file that follow from its own and those of other files with the same rows.

    ``more`` gives them of the numbers of a block: of the file, and of every other one.
    """
    own = pq.ParquetFile(path)
    metadata = {name.decode(): text.decode() for name, text in (own.schema_arrow.metadata or {}).items()}
    readers = [_Rows(pq.ParquetFile(other)) for other in others]
    with writing(path, metadata) as sink:
        for group in range(own.num_row_groups):
            block = own.read_row_group(group)
            blocks = [block, *(reader.take(len(block)) for reader in readers)]
            added = more([_numbers(one) for one in blocks])
            sink([*zip(block.schema.names, block.columns, strict=True), *added.items()])


class _Rows:
    """Rows of a file in blocks of any size."""

    def __init__(self, file: pq.ParquetFile) -> None:
        self._groups = (file.read_row_group(group) for group in range(file.num_row_groups))
        self._left: Any = None

    def take(self, count: int) -> Any:
        """The next rows."""
        while self._left is None or len(self._left) < count:
            more = next(self._groups)
            self._left = more if self._left is None else pa.concat_tables([self._left, more])
        result, self._left = self._left.slice(0, count), self._left.slice(count)
        return result


def _numbers(block: Any) -> Blocks:
    """Columns of numbers, absent ones NaN."""
    columns = zip(block.schema.names, block.schema.types, strict=True)
    return {name: block.column(name).to_numpy() for name, kind in columns if pa.types.is_floating(kind)}


@contextmanager
def writing(path: str | os.PathLike[str], metadata: Mapping[str, str]) -> Iterator[Sink]:
    """Write a Parquet file that is there whole once the context ends, or not at all.

    The sink takes columns as pairs of a name and an array or a list of texts. NaN becomes an absent value. The schema
    carries the metadata.
    """
    with replacing(path) as beside:
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
                    writer = pq.ParquetWriter(beside, block.schema)
                writer.write_table(block)

            yield sink
        finally:
            if writer is not None:
                writer.close()
