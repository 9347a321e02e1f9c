"""An executor with local worker processes, which go on if one of the processes is killed."""

from __future__ import annotations

import os
import pickle
import struct
import subprocess
import sys
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from typing import IO, Any, ParamSpec, TypeVar

_P = ParamSpec("_P")
_T = TypeVar("_T")

_TRIES = 5
"""Number of processes that may die during the same call before the call is given up as the cause."""
_LENGTH = struct.Struct("<Q")
"""Format of the header that is sent before each message: the message's number of bytes."""
_ONE_THREAD = {
    name: "1" for name in ("RAYON_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS")
}
"""Environment variables of a worker process, which limit it to one thread."""


class WorkerDiedError(Exception):
    """Several processes died, one after another, during the same call."""


class Workers(Executor):
    """Executor with ``count`` processes of one thread each.

    A process that dies is replaced, and its call is repeated in the new process.

    Examples
    --------
    >>> with Workers(1) as workers:
    ...     workers.submit(divmod, 7, 2).result()
    (3, 1)
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self._threads = ThreadPoolExecutor(count)
        self._own = threading.local()
        self._processes = set[subprocess.Popen[bytes]]()

    def submit(self, function: Callable[_P, _T], /, *args: _P.args, **kwargs: _P.kwargs) -> Future[_T]:
        """Call a function of an importable module in one of the worker processes; return a future."""
        return self._threads.submit(self._call, pickle.dumps((function, args, kwargs)))

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the worker processes; without ``wait`` or with ``cancel_futures`` also kill busy processes at once."""
        self._threads.shutdown(wait=wait and not cancel_futures, cancel_futures=cancel_futures)
        for process in list(self._processes):
            process.kill()
        self._threads.shutdown()
        for process in list(self._processes):
            process.communicate()

    def _call(self, message: bytes) -> Any:
        for _ in range(_TRIES):
            process: subprocess.Popen[bytes] | None = getattr(self._own, "process", None)
            if process is None:
                self._own.process = process = _started()
                self._processes.add(process)
            try:
                assert process.stdin is not None and process.stdout is not None
                _send(process.stdin, message)
                failed, value = pickle.loads(_received(process.stdout))
            except (OSError, EOFError):
                self._own.process = None
                self._processes.discard(process)
                process.kill()
                process.communicate()
                continue
            if failed:
                raise value
            return value
        raise WorkerDiedError(f"{_TRIES} worker processes died one after another during this call")


def _started() -> subprocess.Popen[bytes]:
    # In a session of its own, the worker gets no Ctrl-C; the parent process gets the signal and ends the worker.
    code = f"from {__name__} import main; main()"
    return subprocess.Popen(
        [sys.executable, "-P", "-c", code],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,
        env=os.environ | _ONE_THREAD,
    )


def _send(stream: IO[bytes], message: bytes) -> None:
    stream.write(_LENGTH.pack(len(message)) + message)
    stream.flush()


def _received(stream: IO[bytes]) -> bytes:
    """Return the next message of a stream; raise EOFError at the end of the stream."""
    head = stream.read(_LENGTH.size)
    size = _LENGTH.unpack(head)[0] if len(head) == _LENGTH.size else -1
    message = stream.read(size) if size >= 0 else b""
    if len(message) != size:
        raise EOFError
    return message


def main() -> None:
    """Main function of a worker process: read calls from standard input and write their results to standard output."""
    calls, answers = sys.stdin.buffer, os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    # Redirect prints to standard error, so that they do not mix with the results of calls.
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    while True:
        try:
            function, args, kwargs = pickle.loads(_received(calls))
        except EOFError:
            return
        try:
            answer = False, function(*args, **kwargs)
        except Exception as error:
            answer = True, error
        try:
            _send(answers, pickle.dumps(answer))
        except OSError:
            return
