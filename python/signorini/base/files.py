"""Write files atomically, without overwriting files of other programs."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from signorini.base import arguments

_LONGEST_NAME = 50
"""Largest number of characters of a file's name that are copied into the name of its temporary directory."""


@contextmanager
def temporary_directory(beside: Path, name: str) -> Iterator[Path]:
    """Context with a new hidden directory inside the directory ``beside``; the new directory is removed at the end."""
    with TemporaryDirectory(prefix=f".{name[:_LONGEST_NAME]}-", dir=beside, ignore_cleanup_errors=True) as hidden:
        yield Path(hidden)


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Context with a temporary path to write to; the written file is moved to ``path`` at the end.

    Other programs see the old file or the new file, both complete. If the body raises, ``path`` is unchanged and no
    temporary file remains. If ``path`` is a link, the file to which it points is replaced. The directory must exist.
    """
    with _beside(path) as (hidden, target):
        yield hidden / target.name
        (hidden / target.name).replace(target)


def require_replaceable(path: str | os.PathLike[str]) -> None:
    """Raise the OSError that `replacing` would raise, before the content of a file is computed."""
    with _beside(path):
        pass


@contextmanager
def _beside(path: str | os.PathLike[str]) -> Iterator[tuple[Path, Path]]:
    """Context with a temporary directory beside the file to which a path leads, and with the path of this file."""
    target = Path(os.path.realpath(arguments.path(path, "a file", "path")))
    if target.exists() and not target.is_file():
        kind = errno.EISDIR if target.is_dir() else errno.EEXIST
        raise OSError(kind, "this name is taken, and it is not a regular file", str(path))
    with temporary_directory(target.parent, target.name) as hidden:
        yield hidden, target


@contextmanager
def replacing_together(
    directory: str | os.PathLike[str], former: Callable[[Path], Iterable[str]], seal: str
) -> Iterator[Path]:
    """Context with an empty directory to write files to, all of which are moved into ``directory`` at the end.

    The directory is made if necessary. The new files replace the files of the former run, whose names ``former`` reads
    from the file ``seal``. Files of other programs stay; a new file with the name of such a file is refused. After an
    error the directory is unchanged. Several processes move their files one after another, so that the complete set of
    the last process remains. The seal is removed first and written last, so that a directory with a seal is complete.
    """
    target = Path(directory).absolute()
    made = [place for place in (target, *target.parents) if not place.exists()]
    try:
        target.mkdir(parents=True, exist_ok=True)
        with temporary_directory(target, target.name) as hidden:
            new, old = hidden / "new", hidden / "replaced"
            new.mkdir()
            old.mkdir()
            yield new
            with locked(target):
                added = sorted((entry.name for entry in new.iterdir()), key=lambda name: (name == seal, name))
                removed = sorted(require_free(target, added, former), key=lambda name: (name != seal, name))
                _move(
                    [(target / name, old / name) for name in removed] + [(new / name, target / name) for name in added]
                )
    except BaseException:
        with suppress(OSError):
            for place in made:
                place.rmdir()
        raise


def require_free(target: Path, names: Iterable[str], former: Callable[[Path], Iterable[str]]) -> set[str]:
    """Refuse ``names`` that files of other programs have in the directory ``target``.

    Return the names of files of an earlier run that exist there; ``former`` reads these names from the directory.
    """
    ours = {name for name in former(target) if os.path.lexists(target / name)}
    for name in sorted({*names, *ours}):
        if (target / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, f"a directory has the name of a file to be written, {name}")
        if name not in ours and os.path.lexists(target / name):
            raise FileExistsError(errno.EEXIST, f"{name} exists, and was not written by an earlier run")
    return ours


def _move(moves: list[tuple[Path, Path]]) -> None:
    """Rename files from the first to the second path of each pair; after an error, undo all renames."""
    done: list[tuple[Path, Path]] = []
    try:
        for source, destination in moves:
            done.append((source, destination))
            source.rename(destination)
    except BaseException:
        for source, destination in reversed(done):
            if not source.exists():
                destination.rename(source)
        raise


@contextmanager
def locked(directory: Path) -> Iterator[None]:
    """Context that locks a directory for one process at a time; without effect on Windows."""
    if sys.platform == "win32":
        yield
        return
    import fcntl

    descriptor = os.open(directory, os.O_RDONLY)
    try:
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)
