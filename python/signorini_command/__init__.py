"""Entry point of the command ``signorini``, which handles Ctrl-C while its modules are imported (0.25 s).

It is a package of its own, since importing any module of `signorini` imports NumPy and SciPy first.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
from types import FrameType

_INTERRUPTED = 130
ASKED: list[int] = []
"""Signals received from the user, who asks the program to end."""
POOLS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS", "OMP_NUM_THREADS")


def main() -> None:
    """Run the command line; Ctrl-C ends it with a message, also during imports."""
    for pool in POOLS:
        # Rust computes large products, with at most --threads threads. NumPy and SciPy would start one more per core.
        os.environ.setdefault(pool, "1")
    handled = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if handled:
        signal.signal(signal.SIGINT, _interrupted)
    # Imports create no garbage; its collection takes 5 % of their time.
    gc.disable()
    from signorini.cli import main as run

    gc.freeze()
    gc.enable()
    if handled:
        signal.signal(signal.SIGINT, _asked)
    try:
        run()
    except KeyboardInterrupt:
        _interrupted()


def _asked(number: int, frame: FrameType | None) -> None:
    """Record the signal and raise KeyboardInterrupt, which a half-imported module may take for its own error."""
    ASKED.append(number)
    signal.default_int_handler(number, frame)


def _interrupted(number: int = signal.SIGINT, frame: FrameType | None = None) -> None:
    """End the process at once, since half-imported modules may catch an exception as their own; no file is open."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a second signal would write the message again
    sys.stderr.write("Interrupted; no files are written.\n")
    sys.stderr.flush()
    os._exit(_INTERRUPTED)
