"""Columns into a Parquet file, block by block."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Protocol

import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from signorini.base.files import replacing

Column = Sequence[str] | npt.NDArray[Any]


class Sink(Protocol):
    """Takes the columns of one block after the other, always the same ones."""

    def __call__(self, columns: Iterable[tuple[str, Column]]) -> None:
        """Write a block, a row group of the file."""


@contextmanager
def writing(path: str | os.PathLike[str]) -> Iterator[Sink]:
    """Write a Parquet file that is there whole once the context ends, or not at all.

    Parameters
    ----------
    path : path-like
        The file to create or to replace.

    Yields
    ------
    Sink
        Takes columns as pairs of a name and an array or a list of texts. NaN becomes an absent value.

    Raises
    ------
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import numpy as np
    >>> with tempfile.TemporaryDirectory() as place:
    ...     file = pathlib.Path(place, "combinations.parquet")
    ...     with writing(file) as sink:
    ...         sink([("combination", ["a", "b"]), ("reaction", np.array([1.0, 2.0]))])
    ...         sink([("combination", ["c"]), ("reaction", np.array([np.nan]))])
    ...     pq.read_table(file).to_pydict()
    {'combination': ['a', 'b', 'c'], 'reaction': [1.0, 2.0, None]}
    """
    with replacing(path) as beside:
        writer: pq.ParquetWriter | None = None
        try:

            def sink(columns: Iterable[tuple[str, Column]]) -> None:
                nonlocal writer
                block = pa.table({name: pa.array(values, from_pandas=True) for name, values in columns})
                if writer is None:
                    writer = pq.ParquetWriter(beside, block.schema)
                writer.write_table(block)

            yield sink
        finally:
            if writer is not None:
                writer.close()
