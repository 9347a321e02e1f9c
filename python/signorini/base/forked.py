"""Processes that prepare while this one works, and then do a part of its work."""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import IO, Any, NamedTuple, NoReturn

_AT_ONCE = 1 << 20
"""Bytes that a pipe holds, so that a process goes on while this one does something else; Linux allows as many."""


class _Warned(NamedTuple):
    """A warning of a process: what `warnings.warn_explicit` takes."""

    message: str
    category: type[Warning]
    filename: str
    lineno: int


_TOLD: dict[Any, Any] = {}
"""Warnings that were shown: where several processes meet the same one, it is shown once."""


class Forked:
    """A process that waits for a job."""

    def __init__(self, job: IO[bytes], done: IO[bytes]) -> None:
        self._job, self._done, self.ended = job, done, False

    def begin(self, job: object) -> None:
        """Hand over the job; it is pickled."""
        # One that is gone does nothing, as its results then say.
        with suppress(OSError):
            pickle.dump(job, self._job, pickle.HIGHEST_PROTOCOL)
            self._job.close()

    def results(self) -> Iterator[Any]:
        """Give what the job gives, one after another, to its end or to that of the process."""
        with suppress(OSError, EOFError, pickle.UnpicklingError):
            while True:
                result = pickle.load(self._done)
                if isinstance(result, _Warned):
                    warnings.warn_explicit(*result, registry=_TOLD)
                else:
                    yield result
        self.ended = True

    def close(self) -> None:
        """Hand over nothing, and take nothing any more."""
        for end in (self._job, self._done):
            with suppress(OSError):
                end.close()


@contextmanager
def forked(
    count: int, prepare: Callable[[], object], work: Callable[[Any], Iterable[object]]
) -> Iterator[list[Forked]]:
    """Fork processes that prepare once for all of them, and then each do one job.

    They only save time: whoever gives them work does himself what they do not, be it that there is no fork, that this
    process has threads, with which none should be forked, or that one ends before its time. They write nothing; their
    warnings are given here. When the context ends they are gone.

    Parameters
    ----------
    count : int
    prepare : callable
        Called in the first process, whose copies the others are.
    work : callable
        Given a job, gives its results.

    Yields
    ------
    list of Forked
        As many as ``count``, or none.

    Examples
    --------
    >>> with forked(2, lambda: None, lambda job: (number**2 for number in job)) as processes:
    ...     for process in processes:
    ...         process.begin([2, 3])
    ...     squares = [list(process.results()) for process in processes]
    >>> squares in ([[4, 9], [4, 9]], [])
    True
    """
    # Apple's libraries may not be used after a fork.
    if count < 1 or not hasattr(os, "fork") or sys.platform == "darwin" or _threads() > 1:
        yield []
        return
    pipes = [(_pipe(), _pipe()) for _ in range(count)]
    process = None
    with suppress(OSError):
        process = os.fork()
    if process == 0:
        _live(pipes, prepare, work)
    processes = []
    for (theirs, job), (done, taken) in pipes:
        os.close(theirs)
        os.close(taken)
        processes.append(Forked(os.fdopen(job, "wb"), os.fdopen(done, "rb")))
    try:
        yield processes if process is not None else []
    finally:
        for one in processes:
            one.close()
        if process is not None:
            if not all(one.ended for one in processes):
                _kill(process)
            os.waitpid(process, 0)


def _threads() -> int:
    """Threads of this process, those that Python knows nothing of among them where the system tells."""
    try:
        return len(os.listdir("/proc/self/task"))
    except OSError:
        return threading.active_count()


def _pipe() -> tuple[int, int]:
    ends = os.pipe()
    with suppress(ImportError, AttributeError, OSError):
        import fcntl

        fcntl.fcntl(ends[1], fcntl.F_SETPIPE_SZ, _AT_ONCE)
    return ends


def _kill(process: int) -> None:
    """Kill a process and its copies."""
    with suppress(OSError):
        os.setpgid(process, process)
    with suppress(OSError):
        os.killpg(process, signal.SIGKILL)


def _live(
    pipes: Sequence[tuple[tuple[int, int], tuple[int, int]]],
    prepare: Callable[[], object],
    work: Callable[[Any], Iterable[object]],
) -> NoReturn:
    """Be a forked process, to its end."""
    copies: list[int] = []
    try:
        # In a group of its own: Ctrl-C is for the process that this comes from, which then ends it.
        os.setpgid(0, 0)
        for each in (signal.SIGINT, signal.SIGTERM):
            signal.signal(each, signal.SIG_DFL)
        nothing = os.open(os.devnull, os.O_RDWR)
        for stream in (0, 1, 2):
            os.dup2(nothing, stream)
        for (_, job), (done, _) in pipes:
            os.close(job)
            os.close(done)
        prepare()
        own = _copied(len(pipes), copies)
        for number, ((job, _), (_, done)) in enumerate(pipes):
            if number != own:
                os.close(job)
                os.close(done)
        given, taken = os.fdopen(pipes[own][0][0], "rb"), os.fdopen(pipes[own][1][1], "wb")
        with given, taken, warnings.catch_warnings(record=True) as met:
            for result in work(pickle.load(given)):
                told = [_Warned(str(one.message), one.category, one.filename, one.lineno) for one in met]
                met.clear()
                for one in (*told, result):
                    pickle.dump(one, taken, pickle.HIGHEST_PROTOCOL)
                taken.flush()
    finally:
        # Whatever it was that ended the work, it is done where these processes come from.
        with suppress(OSError):
            for copy in copies:
                os.waitpid(copy, 0)
        os._exit(0)


def _copied(count: int, copies: list[int]) -> int:
    """Fork until there are so many processes, if the system allows it, and return the number of this one."""
    with suppress(OSError):
        for number in range(1, count):
            copy = os.fork()
            if copy == 0:
                copies.clear()
                return number
            copies.append(copy)
    return 0
