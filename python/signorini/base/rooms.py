"""Hidden directories to write in, of which those that killed processes left can be told from everybody else's."""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
import stat
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

MARK = "signorini"
"""The file in every room that says whose it is; its lock, that the room is in use."""
_MARKED = b"A directory of signorini's, which removes it.\n"
_LONGEST_NAME = 50
"""File systems allow 255 bytes."""
_PATIENCE = 30.0
"""Seconds to wait for another process that puts its files into a directory, which takes it some milliseconds."""
_ASKING = 0.01
"""Seconds between two looks at whether it has."""


@contextmanager
def room_beside(directory: str | os.PathLike[str], name: str) -> Iterator[Path]:
    """Give a hidden directory in another, empty but for its mark, for as long as the context lasts.

    If the context ends well, rooms of the same purpose that killed processes left go with it: real directories that
    bear the mark, which nobody has locked. Nothing else is removed, whatever its name.

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
    ...     pathlib.Path(place, ".results-20240115").mkdir()
    ...     with room_beside(place, "results") as room:
    ...         len(os.listdir(place)), room.is_dir()
    ...     os.listdir(place)
    (2, True)
    ['.results-20240115']
    """
    room = Path(directory) / f".{name[:_LONGEST_NAME]}-{secrets.token_hex(4)}"
    room.mkdir()
    lock = None
    try:
        # Locked before it is marked: nobody takes it for left in between.
        lock = os.open(room / MARK, os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_CLOEXEC", 0), 0o600)
        with suppress(OSError):
            # A file system that knows no locks: then nobody removes what was left there.
            _lock(lock)
        os.write(lock, _MARKED)
        yield room
        remove_left(directory, name)
    finally:
        remove(room)
        if lock is not None:
            os.close(lock)


def remove(room: Path) -> None:
    """Remove a room, its mark last, so that what is left of it can still be told for a room's."""
    with suppress(OSError):
        for entry in room.iterdir():
            if entry.is_dir() and not entry.is_symlink():
                shutil.rmtree(entry, ignore_errors=True)
            elif entry.name != MARK:
                entry.unlink()
        (room / MARK).unlink(missing_ok=True)
        room.rmdir()


def remove_left(directory: str | os.PathLike[str], name: str) -> None:
    """Remove the rooms for one purpose that killed processes left in a directory."""
    for room in rooms_left(directory, name):
        remove(room)


def rooms_left(directory: str | os.PathLike[str], name: str) -> Iterator[Path]:
    """Give the rooms for one purpose that killed processes left in a directory, each locked while it is looked at."""
    named = re.compile(rf"\.{re.escape(name[:_LONGEST_NAME])}-[0-9a-f]{{8}}")
    try:
        entries = [Path(entry.path) for entry in os.scandir(directory) if named.fullmatch(entry.name)]
    except OSError:
        return
    for room in entries:
        lock = _lock_of_left(room)
        if lock is not None:
            try:
                yield room
            finally:
                os.close(lock)


def _lock_of_left(room: Path) -> int | None:
    """Lock a room whose process is gone; None if it is in use, or no room."""
    try:
        if not stat.S_ISDIR(room.lstat().st_mode) or not stat.S_ISREG((room / MARK).lstat().st_mode):
            return None
        lock = os.open(room / MARK, os.O_RDWR | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
    except OSError:
        return None
    try:
        if os.read(lock, len(_MARKED) + 1) == _MARKED:
            _lock(lock)
            return lock
    except OSError:
        pass
    os.close(lock)
    return None


def _lock(file: int) -> None:
    """Lock an open file. One that another has locked is a BlockingIOError, no locks at all another OSError."""
    if sys.platform == "win32":
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))
    import fcntl

    fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)


@contextmanager
def alone_in(directory: str | os.PathLike[str]) -> Iterator[None]:
    """Let one process after the other into a directory, for as long as the context lasts.

    Where there are no locks (Windows, some network file systems) it lets everybody in.

    Raises
    ------
    OSError
        The directory does not exist, or another process does not come out of it.
    """
    if sys.platform == "win32":
        yield
        return
    end = time.monotonic() + _PATIENCE
    directory = os.fspath(directory)
    while True:
        lock = os.open(directory, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        try:
            _wait_for(lock, end)
            # Another process may have put another directory in its place meanwhile.
            if os.path.samestat(os.fstat(lock), os.stat(directory)):
                yield
                return
        finally:
            os.close(lock)


def _wait_for(lock: int, end: float) -> None:
    while True:
        try:
            _lock(lock)
        except BlockingIOError:
            if time.monotonic() > end:
                raise TimeoutError(errno.ETIMEDOUT, "another run has been writing there for half a minute") from None
            time.sleep(_ASKING)
        except OSError:
            return
        else:
            return
