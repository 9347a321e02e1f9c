"""The command ``signorini`` before its modules are read, which takes a quarter of a second.

A package of its own, since reading any module of `signorini` reads NumPy and SciPy first.
"""

from __future__ import annotations

import gc
import os
import signal
import sys
from types import FrameType

_INTERRUPTED = 130
ASKED: list[int] = []
"""Signals by which the user has asked to end."""
POOLS = ("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS", "OMP_NUM_THREADS")


def main() -> None:
    """Run the command line; Ctrl-C ends it with a word also while its modules are read."""
    for pool in POOLS:
        # Large products are left to Rust, whose threads --threads bounds; NumPy and SciPy would start one a core more.
        os.environ.setdefault(pool, "1")
    handled = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if handled:
        signal.signal(signal.SIGINT, _interrupted)
    # Modules are no garbage, and looking for some among them takes a twentieth of their time.
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
    """Raise, and remember the signal: a half-imported module may take the exception for an error of its own."""
    ASKED.append(number)
    signal.default_int_handler(number, frame)


def _interrupted(number: int = signal.SIGINT, frame: FrameType | None = None) -> None:
    """End without unwinding: modules half read may take an exception for a fault of their own; no file is open."""
    sys.stderr.write("Interrupted; no files are written.\n")
    sys.stderr.flush()
    os._exit(_INTERRUPTED)
