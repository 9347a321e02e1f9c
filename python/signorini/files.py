"""Writing a file whole or not at all."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a path to write to, beside ``path``, and put it in the place of ``path`` once it is written.

    A reader sees the old file or the new one, never half of one. If the body raises, ``path`` is as it was
    and nothing is left beside it.

    Parameters
    ----------
    path : path-like
        The file to create or to replace. Its directory must exist.

    Yields
    ------
    Path
        A new name in the same directory, with the same suffix.

    Raises
    ------
    OSError
        The directory does not exist or cannot be written to.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as directory:
    ...     target = pathlib.Path(directory, "reactions.csv")
    ...     with replacing(target) as beside:
    ...         _ = beside.write_text("support,reaction")
    ...     [entry.name for entry in pathlib.Path(directory).iterdir()]
    ['reactions.csv']
    """
    target = Path(path)
    beside = target.with_name(f".{target.stem}-{secrets.token_hex(4)}{target.suffix}")
    try:
        yield beside
        beside.replace(target)
    finally:
        beside.unlink(missing_ok=True)
