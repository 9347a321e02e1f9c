"""Handle the signals SIGINT and SIGTERM also while Rust code runs, which delays Python's signal handlers."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

INTERRUPTED = 130
TERMINATED = 143
MESSAGE = "Interrupted; no files are written."

_GRACE = 1.0
"""Seconds that Python code has, after a signal, to end by itself before the process is ended."""
PATH_GRACE = 30.0
"""Seconds that an interrupted load path has to end and write its files before the process is ended."""


@contextmanager
def exit_on_signal(temporary: Path | None, grace: float = _GRACE) -> Iterator[None]:
    """Context that ends the process within ``grace`` seconds after a signal, also while Rust code runs.

    Python runs signal handlers between its instructions, so a factorization delays them. The interpreter also writes
    each signal to a pipe immediately. A thread reads the pipe and ends the process if the handlers do not. Before, the
    thread removes the directory ``temporary``, if given, which must contain all open files.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    read, write = os.pipe()
    os.set_blocking(write, False)
    former = signal.set_wakeup_fd(write, warn_on_full_buffer=False)
    finished = threading.Event()
    watcher = threading.Thread(target=_watch, args=(read, finished, temporary, grace), daemon=True)
    watcher.start()
    try:
        yield
    finally:
        finished.set()
        signal.set_wakeup_fd(former)
        os.close(write)
        watcher.join()


def _watch(read: int, finished: threading.Event, temporary: Path | None, grace: float) -> None:
    codes = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}
    while signals := os.read(read, 1):
        code = codes.get(signal.Signals(signals[0]))
        if code is not None and not finished.wait(grace):
            if temporary is not None:
                shutil.rmtree(temporary, ignore_errors=True)
            sys.stderr.write(f"{MESSAGE}\n")
            sys.stderr.flush()
            os._exit(code)
    os.close(read)
