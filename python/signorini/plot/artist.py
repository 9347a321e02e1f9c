"""Drawing processes, which import matplotlib while the main process solves."""

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
"""Number of panels for each drawing process: to draw them takes about as long as to import matplotlib."""
_MAX_ELEMENTS = 100_000
"""Largest number of elements for which several processes draw in parallel; the limit saves memory."""


class Artist:
    """A process that draws pictures and is started in advance; `drawn` starts more processes for many pictures."""

    def __init__(self) -> None:
        self._processes = [_started()]
        self._pool: ThreadPoolExecutor | None = None

    def __enter__(self) -> Self:
        """Return this object, for a with statement."""
        return self

    def __exit__(self, *error: object) -> None:
        """End all drawing processes."""
        for process in self._processes:
            process.kill()
        if self._pool is not None:
            self._pool.shutdown()
        else:
            self._processes[0].communicate()

    def drawn(self, jobs: Sequence[Job]) -> Iterator[tuple[str, bytes]]:
        """Start drawing pictures; return an iterator over name and content of each file."""
        panels, elements = (
            sum(sheet.panels for job in jobs for sheet in job.sheets),
            sum(len(job.elements) for job in jobs),
        )
        wanted = panels // _ENOUGH if elements <= _MAX_ELEMENTS else 1
        self._processes += [_started() for _ in range(min(cores(), wanted) - 1)]
        shared = [_shared(job.sheets, len(self._processes)) for job in jobs]
        shares = [
            [replace(job, sheets=share) for job, share in zip(jobs, sheets, strict=True)]
            for sheets in zip(*shared, strict=True)
        ]
        self._pool = ThreadPoolExecutor(len(shares))
        return chain.from_iterable(self._pool.map(_draw, self._processes, shares))


def cores() -> int:
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _started() -> subprocess.Popen[bytes]:
    # The new session keeps Ctrl-C from this process; the parent process gets the signal and ends this process.
    code = f"from {__name__} import main; main()"
    return subprocess.Popen(
        [sys.executable, "-P", "-c", code], stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True
    )


def _shared(sheets: Sequence[Sheet], count: int) -> list[list[Sheet]]:
    """Distribute sheets of pictures over ``count`` processes: largest first, each to the one with fewest panels."""
    shares: list[list[Sheet]] = [[] for _ in range(count)]
    for sheet in sorted(sheets, key=lambda sheet: -sheet.panels):
        min(shares, key=lambda share: sum(sheet.panels for sheet in share)).append(sheet)
    return shares


def _draw(process: subprocess.Popen[bytes], jobs: Sequence[Job]) -> list[tuple[str, bytes]]:
    output, _ = process.communicate(pickle.dumps(jobs, pickle.HIGHEST_PROTOCOL))
    if process.returncode:
        raise ChildProcessError(f"the process that draws the pictures ended with {process.returncode}")
    files: list[tuple[str, bytes]] = pickle.loads(output)
    return files


def main() -> None:
    """Main function of a drawing process: read jobs from standard input, write their files to standard output."""
    from signorini.plot.pictures import drawn

    jobs = sys.stdin.buffer.read()
    if jobs:
        files = list(chain.from_iterable(map(drawn, pickle.loads(jobs))))
        sys.stdout.buffer.write(pickle.dumps(files, pickle.HIGHEST_PROTOCOL))
