"""Standard output and standard error with a tolerance for closed pipes and full disks.

Results are in files, and the output repeats them. So a closed pipe, as in ``signorini solve f.toml | head``, or a full
disk does not change the exit code. Only a command that prints an answer without a file ends with an error.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import IO, Any

from rich.console import Console
from rich.text import Text

from signorini.base.progress import Progress

_FILE_WIDTH = 100_000
"""Line width in characters if the output is not a terminal: each table row stays on one line, easy to parse."""


def stdout() -> Console:
    """Return the console of standard output for text that files or the exit code repeat; write errors are ignored."""
    return _console(tolerant(sys.stdout))


def answer() -> Console:
    """Return the console of standard output for text that is in no file; if writing fails, it raises an OSError."""
    return _console(sys.stdout)


def stderr() -> Console:
    """Return the console of standard error."""
    return _console(tolerant(sys.stderr))


def tolerant(stream: IO[str]) -> Any:
    """Return a stream that writes to ``stream``, but discards all further output after an OSError."""
    return _Tolerant(stream)


def open_closed() -> None:
    """Open standard output and standard error if they are closed; writing to them then raises an OSError.

    Otherwise a results file that is opened later could get the descriptor 1 or 2 of a closed stream.
    """
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_RDONLY), "w", encoding="utf-8"))


def flush() -> None:
    """Flush standard output and standard error at the end of the process; errors are ignored."""
    for stream in (sys.stdout, sys.stderr):
        tolerant(stream).flush()


def discard(stream: IO[str]) -> None:
    """Discard the buffered text of ``stream`` and all its further output."""
    # Errors are suppressed because streams that pytest captures have no file descriptor.
    with suppress(OSError, ValueError):
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, stream.fileno())
        os.close(null)


def visible(text: object) -> str:
    r"""Replace terminal control characters, such as an escape in a file name, by printable escapes.

    Examples
    --------
    >>> visible("slab\x1b[31m.toml: no such file.") == r"slab\x1b[31m.toml: no such file."
    True
    """
    return "".join(char if char.isprintable() or char == "\n" else repr(char)[1:-1] for char in str(text))


class _Tolerant:
    """A stream that discards all further output after an OSError."""

    def __init__(self, stream: IO[str]) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        try:
            return self._stream.write(text)
        except OSError:
            discard(self._stream)
            return len(text)

    def flush(self) -> None:
        try:
            self._stream.flush()
        except OSError:
            discard(self._stream)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def _console(stream: Any) -> Console:
    """Return a console that neither interprets nor highlights text, and that does not break lines."""
    console = Console(file=stream, markup=False, highlight=False, emoji=False, soft_wrap=True)
    if not console.is_terminal:
        console.width = _FILE_WIDTH
    return console


_SPINNER_WIDTH = 4
"""Width of the progress spinner with its margins [characters]."""
_LOG_INTERVAL = 60.0
"""Seconds between progress lines in a log, so that the log of a run of some hours has a few pages."""


@contextmanager
def progress_line() -> Iterator[Callable[[object], None]]:
    """Context with a function that prints progress messages on standard error.

    On a terminal a message replaces the previous message; messages about refined meshes remain. If standard error is no
    terminal, at most one line per minute is printed, with the seconds since the start.
    """
    console = Console(stderr=True, markup=False, highlight=False, emoji=False)
    if not sys.stderr.isatty() or console.is_dumb_terminal:
        yield _log_lines()
        return
    with console.status("", spinner="line") as status:

        def show(message: object) -> None:
            if isinstance(message, Progress) and message.stage == "refined":
                console.print(str(message))
                return
            text = Text(" ".join(str(message).split()))
            text.truncate(max(console.width - _SPINNER_WIDTH, 1), overflow="ellipsis")
            status.update(text)

        yield show


def _log_lines() -> Callable[[object], None]:
    console, start, printed = stderr(), time.monotonic(), 0.0

    def show(message: object) -> None:
        nonlocal printed
        elapsed = time.monotonic() - start
        if elapsed >= printed + _LOG_INTERVAL:
            printed = elapsed
            console.print(visible(f"after {elapsed:.0f} s: {' '.join(str(message).split())}"))

    return show
