"""Processes that read matplotlib while this one solves, and then draw for it."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from signorini.plot.picture import Job, Sheet

_ENOUGH = 24
"""Panels that one process draws in about the time in which another one reads matplotlib."""
_MOST_ELEMENTS = 100_000
"""Largest number of elements for which several processes draw at once; limits memory."""


class Artist:
    """A process that draws, started ahead; of many pictures more of them."""

    def __init__(self) -> None:
        self._processes = [_started()]
        self._pool: ThreadPoolExecutor | None = None

    def __enter__(self) -> Self:
        """Give the artist."""
        return self

    def __exit__(self, *error: object) -> None:
        """End the processes."""
        for process in self._processes:
            process.kill()
        if self._pool is not None:
            self._pool.shutdown()
        else:
            self._processes[0].communicate()

    def drawn(self, jobs: Sequence[Job]) -> Iterator[tuple[str, bytes]]:
        """Begin to draw pictures; then give name and content of each file."""
        panels, elements = (
            sum(sheet.panels for job in jobs for sheet in job.sheets),
            sum(len(job.elements) for job in jobs),
        )
        wanted = panels // _ENOUGH if elements <= _MOST_ELEMENTS else 1
        self._processes += [_started() for _ in range(min(cores(), wanted) - 1)]
        shared = [_shared(job.sheets, len(self._processes)) for job in jobs]
        shares = [
            [replace(job, sheets=share) for job, share in zip(jobs, own, strict=True)]
            for own in zip(*shared, strict=True)
        ]
        self._pool = ThreadPoolExecutor(len(shares))
        return chain.from_iterable(self._pool.map(_asked, self._processes, shares))


def cores() -> int:
    """Count the cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _started() -> subprocess.Popen[bytes]:
    # In a session of its own: Ctrl-C is for the process that this comes from, which then ends it.
    code = f"from {__name__} import main; main()"
    return subprocess.Popen(
        [sys.executable, "-P", "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
    )


def _shared(sheets: Sequence[Sheet], count: int) -> list[list[Sheet]]:
    """Share sheets out, the largest first, each to whom has least to do."""
    shares: list[list[Sheet]] = [[] for _ in range(count)]
    for sheet in sorted(sheets, key=lambda sheet: -sheet.panels):
        min(shares, key=lambda share: sum(one.panels for one in share)).append(sheet)
    return shares


def _asked(process: subprocess.Popen[bytes], jobs: Sequence[Job]) -> list[tuple[str, bytes]]:
    given, _ = process.communicate(pickle.dumps(jobs, pickle.HIGHEST_PROTOCOL))
    if process.returncode:
        raise ChildProcessError(f"the process that draws the pictures ended with {process.returncode}")
    files: list[tuple[str, bytes]] = pickle.loads(given)
    return files


def main() -> None:
    """Be such a process: read matplotlib, take jobs from standard input, and give their files to standard output."""
    from signorini.plot.pictures import drawn

    given = sys.stdin.buffer.read()
    if given:
        files = list(chain.from_iterable(map(drawn, pickle.loads(given))))
        sys.stdout.buffer.write(pickle.dumps(files, pickle.HIGHEST_PROTOCOL))
