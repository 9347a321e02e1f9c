"""Read regular files of limited size; pipes and devices are refused."""

from __future__ import annotations

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from typing import BinaryIO

_KINDS = {
    stat.S_IFIFO: "a pipe (FIFO)",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
_FLAGS = ("O_BINARY", "O_CLOEXEC", "O_NOCTTY", "O_NONBLOCK")
"""Flags of `os.open`, as far as the system has them; O_NONBLOCK: opening a pipe does not wait for its writer."""
_BLOCK = 1 << 20
"""Bytes per read."""


@contextmanager
def open_regular(path: str | os.PathLike[str], largest: int) -> Iterator[BinaryIO]:
    """Open a regular file, or a link to one, of at most ``largest`` bytes.

    Other files raise an OSError, whose ``strerror`` names the kind of file found and the kind allowed.
    """
    file = os.open(path, os.O_RDONLY | sum(getattr(os, flag, 0) for flag in _FLAGS))
    try:
        _require_regular(path, os.fstat(file), largest)
    except OSError:
        os.close(file)
        raise
    with os.fdopen(file, "rb") as opened:
        yield opened


def _require_regular(path: str | os.PathLike[str], status: os.stat_result, largest: int) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, "it is a directory; only regular files are read", os.fspath(path))
    if not stat.S_ISREG(status.st_mode):
        kind = _KINDS.get(stat.S_IFMT(status.st_mode), "no file")
        raise OSError(errno.EINVAL, f"it is {kind}; only regular files are read", os.fspath(path))
    if status.st_size > largest:
        raise _too_large(path, largest)


def read_regular(path: str | os.PathLike[str], largest: int) -> bytes:
    """Read a regular file of at most ``largest`` bytes, also if it grows or its size is unknown."""
    content = bytearray()
    with open_regular(path, largest) as file:
        # In blocks: one read of ``largest`` bytes would allocate as many.
        while block := file.read(_BLOCK):
            content += block
            if len(content) > largest:
                raise _too_large(path, largest)
    return bytes(content)


def _too_large(path: str | os.PathLike[str], largest: int) -> OSError:
    return OSError(
        errno.EFBIG, f"the file is larger than {largest // 10**6} MB, the largest size allowed", os.fspath(path)
    )
