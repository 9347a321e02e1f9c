"""Read regular files of limited size; pipes and devices are refused."""

from __future__ import annotations

import errno
import os
import stat
from io import BufferedReader

_KINDS = {
    stat.S_IFIFO: "a pipe (FIFO)",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


def open_regular(path: str | os.PathLike[str], largest: int) -> BufferedReader:
    """Open a regular file, or a link to a regular file, of at most ``largest`` bytes.

    Other files raise an OSError, whose ``strerror`` names the kind of file found and the kind allowed.
    """
    status = os.stat(path)
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, "it is a directory; only regular files are read", os.fspath(path))
    if not stat.S_ISREG(status.st_mode):
        kind = _KINDS.get(stat.S_IFMT(status.st_mode), "no file")
        raise OSError(errno.EINVAL, f"it is {kind}; only regular files are read", os.fspath(path))
    if status.st_size > largest:
        why = f"the file is larger than {largest // 10**6} MB, the largest size allowed"
        raise OSError(errno.EFBIG, why, os.fspath(path))
    return open(path, "rb")


def read_regular(path: str | os.PathLike[str], largest: int) -> bytes:
    """Read the bytes of a regular file of at most ``largest`` bytes."""
    with open_regular(path, largest) as file:
        return file.read()
