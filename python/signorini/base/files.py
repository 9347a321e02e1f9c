"""Write files atomically, without overwriting files of other programs."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from signorini.base import arguments

_LONGEST_NAME = 50
"""Number of leading characters of a file's name that the name of its temporary directory contains."""


@contextmanager
def temporary_directory(beside: Path, name: str) -> Iterator[Path]:
    """Context with a new hidden directory inside the directory ``beside``; the new directory is removed at the end."""
    with TemporaryDirectory(prefix=f".{name[:_LONGEST_NAME]}-", dir=beside, ignore_cleanup_errors=True) as hidden:
        yield Path(hidden)


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Context with the path of a temporary file to write; at the end of the context this file replaces ``path``.

    Other programs see the old file or the new file, both complete. If the body raises, ``path`` is unchanged and no
    temporary file remains. If ``path`` is a link, the file to which it points is replaced. The directory must exist.
    """
    with _beside(path) as (hidden, target):
        yield hidden / target.name
        (hidden / target.name).replace(target)


def require_replaceable(path: str | os.PathLike[str]) -> None:
    """Raise an OSError if `replacing` could not write ``path``; to be called before the content is computed."""
    with _beside(path):
        pass


def require_unread(path: str | os.PathLike[str], read: Iterable[str]) -> None:
    """Raise an OSError if ``path`` leads to one of the files ``read`` by a run, which its output would replace."""
    path = arguments.path(path, "a file", "path")
    if os.path.exists(path) and any(os.path.exists(one) and os.path.samefile(path, one) for one in read):
        raise FileExistsError(errno.EEXIST, f"this run reads {os.path.basename(path)}")


@contextmanager
def _beside(path: str | os.PathLike[str]) -> Iterator[tuple[Path, Path]]:
    """Context with the file to which ``path`` leads, links resolved, and a temporary directory beside this file."""
    target = Path(os.path.realpath(arguments.path(path, "a file", "path")))
    if target.exists() and not target.is_file():
        kind = errno.EISDIR if target.is_dir() else errno.EEXIST
        raise OSError(kind, "the path exists and is not a regular file", str(path))
    with temporary_directory(target.parent, target.name) as hidden:
        yield hidden, target


@contextmanager
def replacing_together(
    directory: str | os.PathLike[str],
    former: Callable[[Path], Iterable[str]],
    seal: str,
    read: Collection[str] = (),
) -> Iterator[Path]:
    """Context with an empty directory to write files to, all of which are moved into ``directory`` at the end.

    The directory is made if necessary. The new files replace the files of an earlier run, whose names ``former`` reads
    from the file ``seal``. Files of other programs, and the files ``read`` by this run, stay; a new file must not have
    the name of such a file. After an error the directory is unchanged. Several processes move their files one after
    another, so that the complete set of the last process remains. The seal is removed first and written last, so that a
    directory with a seal is complete.
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
                removed = sorted(require_free(target, added, former, read), key=lambda name: (name != seal, name))
                _move(
                    [(target / name, old / name) for name in removed] + [(new / name, target / name) for name in added]
                )
    except BaseException:
        with suppress(OSError):
            for place in made:
                place.rmdir()
        raise


def require_free(
    target: Path, names: Iterable[str], former: Callable[[Path], Iterable[str]], read: Collection[str] = ()
) -> set[str]:
    """Raise an OSError if the directory ``target`` has a file of another program with one of the ``names``.

    The same holds for a file of an earlier run that is one of the files ``read`` by this run.

    Return the names of existing files of an earlier run in this directory; ``former`` reads these names from it.
    """
    ours = {name for name in former(target) if os.path.lexists(target / name)}
    for name in sorted({*names, *ours}):
        require_unread(target / name, read)
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
    """Context in which this process has an exclusive lock on a directory; without effect on Windows."""
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
