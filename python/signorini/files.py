"""Writing files whole or not at all."""

from __future__ import annotations

import errno
import os
import secrets
import shutil
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
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


@contextmanager
def replacing_together(directory: str | os.PathLike[str], former: Iterable[str] = (), seal: str = "") -> Iterator[Path]:
    """Give an empty directory to write files to, and put them all into ``directory`` once they are written.

    The directory is made if need be. Files in it of the same names, and the former ones named, are replaced as a
    set; others stay. If anything fails, everything is as it was.

    Parameters
    ----------
    directory : path-like
    former : iterable of str
        Names of files of an earlier set in ``directory``, which go even if no new file has their name.
    seal : str
        Name of the file that goes first and comes last, so that whoever finds it finds its set whole.

    Yields
    ------
    Path
        A new directory on the same file system.

    Raises
    ------
    OSError
        The directory cannot be made or written to, or one of the names in it is a directory's.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     target = pathlib.Path(place, "results")
    ...     for name in "ab":
    ...         with replacing_together(target, former=["a"]) as beside:
    ...             _ = (beside / name).write_text("")
    ...     [entry.name for entry in target.iterdir()]
    ['b']
    """
    target = Path(directory).absolute()
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "it is a file, not a directory", str(target))
    made = [parent for parent in target.parents if not parent.exists()]
    beside = (target if target.is_dir() else target.parent) / f".{target.name}-{secrets.token_hex(4)}"
    try:
        beside.mkdir(parents=True)
        yield beside
        if target.is_dir():
            _exchange(beside, target, set(former), seal)
        else:
            beside.rename(target)
    except BaseException:
        shutil.rmtree(beside, ignore_errors=True)
        with suppress(OSError):
            for parent in made:
                parent.rmdir()
        raise
    shutil.rmtree(beside, ignore_errors=True)


def _exchange(source: Path, target: Path, former: set[str], seal: str) -> None:
    """Move every file of ``source`` into ``target``, and what stood there, or is former, out of it."""
    new = sorted((entry.name for entry in source.iterdir()), key=lambda name: (name == seal, name))
    replaced = source / f".replaced-{secrets.token_hex(4)}"
    replaced.mkdir()
    moves: list[tuple[Path, Path]] = []
    for name in sorted({*new, *former}, key=lambda name: (name != seal, name)):
        if (target / name).is_dir():
            raise IsADirectoryError(
                errno.EISDIR, "a directory has the name of a file to be written", str(target / name)
            )
        if (target / name).is_symlink() or (target / name).exists():
            moves.append((target / name, replaced / name))
    moves += [(source / name, target / name) for name in new]
    done: list[tuple[Path, Path]] = []
    try:
        for old, place in moves:
            done.append((old, place))
            old.rename(place)
    except BaseException:
        for old, place in reversed(done):
            if not old.exists():
                place.rename(old)
        raise
