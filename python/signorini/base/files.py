"""Writing files whole or not at all, and over nobody else's."""

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
"""The file in a hidden directory that says whose it is; its lock, that the directory is in use."""
_MARKED = "A directory of signorini's, which removes it.\n"
_LONGEST_NAME = 50
"""Letters of a file's name in that of a hidden directory; file systems allow 255 bytes."""
_NEW, _OLD = "new", "replaced"
"""Directories in a hidden one: the files to come, and those that they replace."""


@contextmanager
def hidden_directory(beside: str | os.PathLike[str], name: str) -> Iterator[Path]:
    """Give a hidden, empty directory with a marker file in an existing one, for the duration of the context.

    Its name is ``.name-`` and eight random digits, shortened where necessary. If the context ends without an error,
    directories for the same name that killed processes left are removed with it.
    """
    made = Path(beside) / f".{name[:_LONGEST_NAME]}-{secrets.token_hex(4)}"
    made.mkdir()
    try:
        with open(made / MARK, "x", encoding="utf-8") as mark:
            # Locked before it is marked: nobody takes it for left in between.
            with suppress(OSError):
                _lock(mark.fileno(), wait=False)
            mark.write(_MARKED)
            mark.flush()
            yield made
        for other in left_by_killed(beside, name):
            shutil.rmtree(other, ignore_errors=True)
    finally:
        shutil.rmtree(made, ignore_errors=True)


def left_by_killed(beside: Path | str | os.PathLike[str], name: str) -> Iterator[Path]:
    """Give the hidden directories for a name that bear the mark and that nobody has locked."""
    named = re.compile(rf"\.{re.escape(name[:_LONGEST_NAME])}-[0-9a-f]{{8}}")
    with suppress(OSError):
        for made in [Path(entry.path) for entry in os.scandir(beside) if named.fullmatch(entry.name)]:
            mark = made / MARK
            if made.is_symlink() or mark.is_symlink() or not mark.is_file():
                continue
            with suppress(OSError), open(mark, "r+", encoding="utf-8", errors="replace") as file:
                if file.read(len(_MARKED) + 1) == _MARKED:
                    _lock(file.fileno(), wait=False)
                    yield made


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a temporary path to write to, and move it to ``path`` afterwards.

    A reader sees the old file or the new one, both complete. If the body raises, ``path`` is unchanged and no temporary
    file remains. A link is followed to its file. The directory must exist.
    """
    target = Path(os.path.realpath(arguments.path(path, "a file", "path")))
    if target.exists() and not target.is_file():
        kind = errno.EISDIR if target.is_dir() else errno.EEXIST
        raise OSError(kind, "there is something else than a file of this name", str(path))
    with hidden_directory(target.parent, target.name) as made:
        yield made / target.name
        (made / target.name).replace(target)


@contextmanager
def replacing_together(
    directory: str | os.PathLike[str], former: Callable[[Path], Iterable[str]], seal: str
) -> Iterator[Path]:
    """Give an empty directory to write files to, and move all of them into ``directory`` afterwards.

    The directory is made if necessary. The former set of files, whose names ``former`` reads from the file ``seal``, is
    replaced. Other files stay; a new file with the name of one of them is refused. If anything fails, everything is as
    before. Several processes move their files one after another, so that the directory holds the complete set of the
    last one. The seal is removed first and written last, so that a directory with a seal is complete.
    """
    target = Path(directory).absolute()
    if target.exists() and not target.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, "it is a file, not a directory", str(target))
    parents = [parent for parent in target.parents if not parent.exists()]
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        with hidden_directory(target if target.is_dir() else target.parent, target.name) as made:
            new = made / _NEW
            new.mkdir()
            yield new
            # Another process may be faster: then the directory is there, and not empty.
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
    # An earlier run may have been killed before the directory was there.
    for left in left_by_killed(target.parent, target.name):
        shutil.rmtree(left, ignore_errors=True)


def require_free(target: Path, names: Iterable[str], former: Callable[[Path], Iterable[str]]) -> set[str]:
    """Refuse names that foreign files have in a directory, and return our files there.

    Our files are the ``former`` ones of `replacing_together`, and those that a process was moving when it was killed.
    """
    left = [
        left / part
        for place in (target, target.parent)
        for left in left_by_killed(place, target.name)
        for part in (_NEW, _OLD)
    ]
    ours = {name for place in (target, *left) for name in former(place) if os.path.lexists(target / name)}
    for name in sorted({*names, *ours}):
        if (target / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, f"a directory has the name of a file to be written, {name}")
        if name not in ours and os.path.lexists(target / name):
            raise FileExistsError(errno.EEXIST, f"{name} is there already, and no earlier run says that it wrote it")
    return ours


@contextmanager
def alone_in(directory: Path) -> Iterator[None]:
    """Let one process after the other into a directory; where there are no locks, everybody."""
    if sys.platform == "win32":
        yield
        return
    held = os.open(directory, os.O_RDONLY)
    try:
        with suppress(OSError):
            _lock(held, wait=True)
        yield
    finally:
        os.close(held)


def _exchange(new: Path, target: Path, former: Callable[[Path], Iterable[str]], seal: str) -> None:
    """Move the new files into the target, and the former ones out of it."""
    old = new.with_name(_OLD)
    old.mkdir()
    done: list[tuple[Path, Path]] = []
    with alone_in(target):
        entering = sorted((entry.name for entry in new.iterdir()), key=lambda name: (name == seal, name))
        leaving = sorted(require_free(target, entering, former), key=lambda name: (name != seal, name))
        moves = [(target / name, old / name) for name in leaving]
        moves += [(new / name, target / name) for name in entering]
        try:
            for here, there in moves:
                done.append((here, there))
                here.rename(there)
        except BaseException:
            for here, there in reversed(done):
                if not here.exists():
                    there.rename(here)
            raise


def _lock(file: int, wait: bool) -> None:
    """Lock an open file, or raise an OSError."""
    if sys.platform == "win32":
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))
    import fcntl

    fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
