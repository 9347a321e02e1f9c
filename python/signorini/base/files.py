"""Writing files whole or not at all, and over nobody else's."""

from __future__ import annotations

import errno
import json
import os
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from signorini.base import arguments
from signorini.base.rooms import alone_in, remove_left, room_beside, rooms_left

_MOVES = "moves.json"
"""In a room: what the files are, by size and time, that it puts into a directory and takes out of it."""


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Give a path to write to, beside ``path``, and put it in the place of ``path`` once it is written.

    A reader sees the old file or the new one, never half of one. If the body raises, ``path`` is as it was
    and nothing is left beside it.

    Parameters
    ----------
    path : path-like
        The file to create or to replace; of a link, the file that it leads to. Its directory must exist.

    Yields
    ------
    Path
        The same name in a new directory beside it.

    Raises
    ------
    OSError
        The directory does not exist or cannot be written to, or the path leads to a device or the like.

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
    target = Path(os.path.realpath(arguments.path(path, "a file", "path")))
    if target.exists() and not target.is_file():
        kind = errno.EISDIR if target.is_dir() else errno.EEXIST
        raise OSError(kind, "there is something else than a file of this name", str(path))
    with room_beside(target.parent, target.name) as room:
        yield room / target.name
        (room / target.name).replace(target)


@contextmanager
def replacing_together(
    directory: str | os.PathLike[str], former: Callable[[], Iterable[str]] = tuple, seal: str = ""
) -> Iterator[Path]:
    """Give an empty directory to write files to, and put them all into ``directory`` once they are written.

    The directory is made if need be. The former set of files in it is replaced; others stay, and one that has the name
    of a new file is refused. If anything fails, everything is as it was. Of several processes one after the other puts
    its files there, so that the directory holds the set of the last one and nothing of the others.

    Parameters
    ----------
    directory : path-like
    former : callable
        Names of the files of an earlier set in ``directory``; asked when no other process changes it.
    seal : str
        Name of the file that goes first and comes last, so that whoever finds it finds its set whole.

    Yields
    ------
    Path
        A new directory on the same file system.

    Raises
    ------
    OSError
        The directory cannot be made or written to, or a name is taken by a directory or by a file of none of the sets.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     target = pathlib.Path(place, "results")
    ...     for name in "ab":
    ...         with replacing_together(target, former=lambda: ["a"]) as beside:
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
            new = room / "new"
            new.mkdir()
            yield new
            if not _becomes(new, target):
                with alone_in(target):
                    _exchange(room, target, former, seal)
    except BaseException:
        with suppress(OSError):
            for parent in made:
                parent.rmdir()
        raise
    # An earlier run may have been killed before the directory was there.
    remove_left(target.parent, target.name)


def _becomes(new: Path, target: Path) -> bool:
    """Make a directory the target where there is none yet."""
    if target.exists():
        return False
    try:
        new.rename(target)
    except OSError:
        # Another process may have been faster.
        if target.is_dir():
            return False
        raise
    return True


def require_free(target: Path, names: Iterable[str], former: Callable[[], Iterable[str]]) -> set[str]:
    """Refuse names that files of none of ours have in a directory.

    Parameters
    ----------
    target : Path
    names : iterable of str
        Of files to be put there.
    former : callable
        As for `replacing_together`.

    Returns
    -------
    set of str
        The files there that are ours: former ones, and those that a process was moving when it was killed.

    Raises
    ------
    OSError
        A directory or a file of somebody else's has one of the names.
    """
    ours = {name for name in {*former(), *_left_amid(target)} if os.path.lexists(target / name)}
    for name in sorted({*names, *ours}):
        if (target / name).is_dir():
            raise IsADirectoryError(errno.EISDIR, f"a directory has the name of a file to be written, {name}")
        if name not in ours and os.path.lexists(target / name):
            raise FileExistsError(errno.EEXIST, f"{name} is there already, and no earlier run says that it wrote it")
    return ours


def _exchange(room: Path, target: Path, former: Callable[[], Iterable[str]], seal: str) -> None:
    """Move the new files in a room into the target, and the former ones out of it."""
    first = lambda name: (name != seal, name)  # noqa: E731
    new = sorted((entry.name for entry in (room / "new").iterdir()), key=first, reverse=True)
    out = sorted(require_free(target, new, former), key=first)
    replaced = room / "replaced"
    replaced.mkdir()
    moves = [(target / name, replaced / name) for name in out]
    moves += [(room / "new" / name, target / name) for name in new]
    (room / _MOVES).write_text(json.dumps([[old.name, *_identity(old)] for old, _ in moves]), "utf-8")
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


def _identity(path: Path) -> tuple[int, int]:
    """Size and time of a file, which stay when it is moved and hardly ever when another takes its name."""
    result = path.lstat()
    return result.st_size, result.st_mtime_ns


def _left_amid(target: Path) -> set[str]:
    """Files in a directory that a process was moving when it was killed."""
    result = set()
    for place in (target, target.parent):
        for room in rooms_left(place, target.name):
            with suppress(OSError, ValueError, TypeError):
                moved = json.loads((room / _MOVES).read_text("utf-8"))
                result |= {name for name, *identity in moved if _is(target / Path(name).name, tuple(identity))}
    return result


def _is(path: Path, identity: tuple[int, ...]) -> bool:
    try:
        return stat.S_ISREG(path.lstat().st_mode) and _identity(path) == identity
    except OSError:
        return False
