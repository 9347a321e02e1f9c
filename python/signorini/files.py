"""Writing files whole or not at all."""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

_LONGEST_NAME = 50
"""File systems allow 255 bytes."""


@contextmanager
def room_beside(directory: str | os.PathLike[str], name: str) -> Iterator[Path]:
    """Give an empty hidden directory in another for as long as the context lasts.

    It is locked meanwhile. If the context ends well, directories of the same purpose that killed processes left go with
    it: those whose lock is free.

    Parameters
    ----------
    directory : path-like
        An existing directory.
    name : str
        What the room is for; it is named ``.name-``, cut short when long, and eight random digits.

    Yields
    ------
    Path

    Raises
    ------
    OSError
        The directory does not exist or cannot be written to.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     left = pathlib.Path(place, ".results-0a1b2c3d")
    ...     left.mkdir()
    ...     with room_beside(place, "results") as room:
    ...         len(os.listdir(place)), room.is_dir()
    ...     len(os.listdir(place))
    (2, True)
    0
    """
    name = name[:_LONGEST_NAME]
    room, lock = _locked(Path(directory), name)
    try:
        yield room
        _remove_left(Path(directory), name)
    finally:
        shutil.rmtree(room, ignore_errors=True)
        if lock is not None:
            os.close(lock)


def _locked(directory: Path, name: str) -> tuple[Path, int | None]:
    """Make a room and lock it. One that another process takes for left, before it is locked, is made anew."""
    while True:
        room = directory / f".{name}-{secrets.token_hex(4)}"
        room.mkdir()
        try:
            lock = _lock(room)
        except (BlockingIOError, FileNotFoundError):
            continue
        except OSError:
            return room, None  # The file system knows no locks: then nobody takes it for left either.
        if room.exists():
            return room, lock
        if lock is not None:
            os.close(lock)


def _lock(room: Path) -> int | None:
    if sys.platform == "win32":
        return None
    import fcntl

    lock = os.open(room, os.O_RDONLY)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BaseException:
        os.close(lock)
        raise
    return lock


def _remove_left(directory: Path, name: str) -> None:
    """Remove the rooms that killed processes left in a directory; a room in use cannot be locked."""
    left = re.compile(rf"\.{re.escape(name)}-[0-9a-f]{{8}}")
    with suppress(OSError):
        for entry in [entry.name for entry in os.scandir(directory) if left.fullmatch(entry.name)]:
            with suppress(OSError):
                lock = _lock(directory / entry)
                if lock is not None:
                    shutil.rmtree(directory / entry, ignore_errors=True)
                    os.close(lock)


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
        The same name in a new directory beside it.

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
    with room_beside(target.parent, target.name) as room:
        yield room / target.name
        (room / target.name).replace(target)


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
    place = target if target.is_dir() else target.parent
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with room_beside(place, target.name) as room:
            yield room
            if target.is_dir():
                _exchange(room, target, set(former), seal)
            else:
                room.rename(target)
    except BaseException:
        with suppress(OSError):
            for parent in made:
                parent.rmdir()
        raise
    # An earlier run may have been killed before the directory was there.
    _remove_left(target.parent, target.name[:_LONGEST_NAME])


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
