"""Ctrl-C and termination while native code runs, which no signal unwinds."""

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
SAID = "Interrupted; nothing is written."

_GRACE = 1.0
"""Seconds in which Python code unwinds by itself."""
PATIENT = 30.0
"""Seconds for a cancelled solve to end and write its files."""


@contextmanager
def at_once(room: Path, grace: float = _GRACE) -> Iterator[None]:
    """End the process within so many seconds after a signal, also while native code is running.

    Open files must be in the temporary directory, which is removed then. Python runs its signal handlers between its
    own instructions, so a factorization of a minute would delay them by a minute. The interpreter writes every signal
    to a pipe at once; a thread reads it there, and ends the process if the handlers have not ended it in time.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    read, write = os.pipe()
    os.set_blocking(write, False)
    former = signal.set_wakeup_fd(write, warn_on_full_buffer=False)
    left = threading.Event()
    watcher = threading.Thread(target=_watch, args=(read, left, room, grace), daemon=True)
    watcher.start()
    try:
        yield
    finally:
        left.set()
        signal.set_wakeup_fd(former)
        os.close(write)
        watcher.join()


def _watch(read: int, left: threading.Event, room: Path, grace: float) -> None:
    codes = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}
    while signals := os.read(read, 1):
        code = codes.get(signal.Signals(signals[0]))
        if code is not None and not left.wait(grace):
            shutil.rmtree(room, ignore_errors=True)
            sys.stderr.write(f"{SAID}\n")
            sys.stderr.flush()
            os._exit(code)
    os.close(read)
