"""Write files atomically, without overwriting files of other programs."""

from __future__ import annotations

import errno
import os
import re
import secrets
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from signorini.base import arguments

MARK = "signorini"
"""Marker file of a hidden directory of this program; it is locked while the directory is in use."""
_MARKED = "A directory of signorini's, which removes it.\n"
"""Content of the marker file."""
_LONGEST_NAME = 50
"""Characters of a file's name in the name of a hidden directory; file systems allow 255 bytes."""
_NEW, _OLD = "new", "replaced"
"""Subdirectories of a hidden directory: the new files, and the files that they replace."""


@contextmanager
def hidden_directory(beside: str | os.PathLike[str], name: str) -> Iterator[Path]:
    """Context with a hidden directory in the directory ``beside``; it contains the marker file.

    Its name is ``.name-`` and eight random hexadecimal digits. It is removed at the end. If the context ends without an
    error, directories that killed processes have left for this name are removed too.
    """
    hidden = Path(beside) / f".{name[:_LONGEST_NAME]}-{secrets.token_hex(4)}"
    hidden.mkdir()
    try:
        with open(hidden / MARK, "x", encoding="utf-8") as mark:
            # Locked before it is marked, so that no process considers it abandoned.
            with suppress(OSError):
                _lock(mark.fileno(), wait=False)
            mark.write(_MARKED)
            mark.flush()
            yield hidden
        for other in left_by_killed(beside, name):
            shutil.rmtree(other, ignore_errors=True)
    finally:
        shutil.rmtree(hidden, ignore_errors=True)


def left_by_killed(beside: Path | str | os.PathLike[str], name: str) -> Iterator[Path]:
    """Yield the hidden directories for a name that have the marker file and are not locked."""
    named = re.compile(rf"\.{re.escape(name[:_LONGEST_NAME])}-[0-9a-f]{{8}}")
    with suppress(OSError):
        for hidden in [Path(entry.path) for entry in os.scandir(beside) if named.fullmatch(entry.name)]:
            mark = hidden / MARK
            if hidden.is_symlink() or mark.is_symlink() or not mark.is_file():
                continue
            with suppress(OSError), open(mark, "r+", encoding="utf-8", errors="replace") as file:
                if file.read(len(_MARKED) + 1) == _MARKED:
                    _lock(file.fileno(), wait=False)
                    yield hidden


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Context with a temporary path to write to, which is moved to ``path`` at the end.

    A reader sees the old file or the new one, both complete. If the body raises, ``path`` is unchanged and no temporary
    file remains. A link is followed to its file. The directory must exist.
    """
    target = Path(os.path.realpath(arguments.path(path, "a file", "path")))
    if target.exists() and not target.is_file():
        kind = errno.EISDIR if target.is_dir() else errno.EEXIST
        raise OSError(kind, "this name is taken, and it is not a regular file", str(path))
    with hidden_directory(target.parent, target.name) as hidden:
        yield hidden / target.name
        (hidden / target.name).replace(target)


@contextmanager
def replacing_together(
    directory: str | os.PathLike[str], former: Callable[[Path], Iterable[str]], seal: str
) -> Iterator[Path]:
    """Context with an empty directory to write files to, all of which are moved into ``directory`` at the end.

    The directory is made if necessary. The new files replace the former set, whose names ``former`` reads from the file
    ``seal``. Other files stay; a new file with the name of another file is refused. After an error the directory is
    unchanged. Several processes move their files one after another: the set of the last one remains, complete. The seal
    is removed first and written last, so that a directory with a seal is complete.
    """
    target = Path(directory).absolute()
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "it is a file, not a directory", str(target))
    parents = [parent for parent in target.parents if not parent.exists()]
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with hidden_directory(target if target.is_dir() else target.parent, target.name) as hidden:
            new = hidden / _NEW
            new.mkdir()
            yield new
            # Another process may have made the directory meanwhile.
            with suppress(OSError):
                if not target.exists():
                    new.rename(target)
            if new.exists():
                _exchange(new, target, former, seal)
    except BaseException:
        with suppress(OSError):
            for parent in parents:
                parent.rmdir()
        raise
    # An earlier run may have been killed before it made the directory.
    for hidden in left_by_killed(target.parent, target.name):
        shutil.rmtree(hidden, ignore_errors=True)


def require_free(target: Path, names: Iterable[str], former: Callable[[Path], Iterable[str]]) -> set[str]:
    """Refuse names of files of other programs in a directory; return the names of the files of this program.

    These are the ``former`` files of `replacing_together`, and files that a killed process was moving.
    """
    abandoned = [
        hidden / part
        for place in (target, target.parent)
        for hidden in left_by_killed(place, target.name)
        for part in (_NEW, _OLD)
    ]
    ours = {name for place in (target, *abandoned) for name in former(place) if os.path.lexists(target / name)}
    for name in sorted({*names, *ours}):
        if (target / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, f"a directory has the name of a file to be written, {name}")
        if name not in ours and os.path.lexists(target / name):
            raise FileExistsError(errno.EEXIST, f"{name} exists, and was not written by an earlier run")
    return ours


@contextmanager
def alone_in(directory: Path) -> Iterator[None]:
    """Context that locks a directory for one process at a time; without effect on Windows."""
    if sys.platform == "win32":
        yield
        return
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        with suppress(OSError):
            _lock(descriptor, wait=True)
        yield
    finally:
        os.close(descriptor)


def _exchange(new: Path, target: Path, former: Callable[[Path], Iterable[str]], seal: str) -> None:
    """Move the former files out of the target and the new files into it."""
    old = new.with_name(_OLD)
    old.mkdir()
    done: list[tuple[Path, Path]] = []
    with alone_in(target):
        added = sorted((entry.name for entry in new.iterdir()), key=lambda name: (name == seal, name))
        removed = sorted(require_free(target, added, former), key=lambda name: (name != seal, name))
        moves = [(target / name, old / name) for name in removed]
        moves += [(new / name, target / name) for name in added]
        try:
            for source, destination in moves:
                done.append((source, destination))
                source.rename(destination)
        except BaseException:
            for source, destination in reversed(done):
                if not source.exists():
                    destination.rename(source)
            raise


def _lock(file: int, wait: bool) -> None:
    """Lock an open file, or raise an OSError."""
    if sys.platform == "win32":
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))
    import fcntl

    fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
