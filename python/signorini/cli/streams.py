"""Standard output and standard error, whose readers may have gone.

Results are in files; the output is a copy. So a reader that has gone, as in ``signorini solve f.toml | head``, or a
full disk behind a redirection, does not change the end of a run.
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

_WIDTH_OF_FILES = 100_000
"""Where the output is no terminal, tables keep their width, so that programs find a row on a line."""


def stdout() -> Console:
    """Give the console for the messages of a run."""
    return _console(sys.stdout)


def stderr() -> Console:
    """Give the console of why it ends as it does."""
    return _console(sys.stderr)


def flush() -> None:
    """Flush the stream without raising, at the end of the process."""
    for stream in (sys.stdout, sys.stderr):
        _Shown(stream).flush()


def discard(stream: IO[str]) -> None:
    """Discard all further output, including the buffer."""
    # A stream that tests put there has no file behind it.
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def visible(text: object) -> str:
    r"""Replace terminal control characters, such as an escape in a file name, by readable ones.

    Examples
    --------
    >>> visible("slab\x1b[31m.toml: no such file.") == r"slab\x1b[31m.toml: no such file."
    True
    """
    return "".join(sign if sign.isprintable() or sign == "\n" else repr(sign)[1:-1] for sign in str(text))


class _Shown:
    """A stream that accepts all output, with or without a reader."""

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


def _console(stream: IO[str]) -> Console:
    """Make a console that takes text as it is: no markup, no colours guessed, no lines broken."""
    shown: Any = _Shown(stream)
    console = Console(file=shown, markup=False, highlight=False, emoji=False, soft_wrap=True)
    if not console.is_terminal:
        console.width = _WIDTH_OF_FILES
    return console


_BESIDE = 4
"""Columns that the turning mark takes, and one to spare."""
_EVERY = 60.0
"""Seconds between lines of a log: a run of hours leaves a few pages."""


@contextmanager
def progress_line() -> Iterator[Callable[[object], None]]:
    """Give a function that shows its argument on standard error: on a terminal in place of the last one's.

    Elsewhere it is a line of its own, with the seconds since the beginning, if there was none for a minute. How far a
    mesh came on the way to an accuracy stays on a terminal.
    """
    console = Console(stderr=True, markup=False, highlight=False, emoji=False)
    if not sys.stderr.isatty() or console.is_dumb_terminal:
        yield _now_and_then()
        return
    with console.status("", spinner="line") as status:

        def show(said: object) -> None:
            if isinstance(said, Progress) and said.stage == "refined":
                console.print(str(said))
                return
            text = Text(" ".join(str(said).split()))
            text.truncate(max(console.width - _BESIDE, 1), overflow="ellipsis")
            status.update(text)

        yield show


def _now_and_then() -> Callable[[object], None]:
    console, begun, told = stderr(), time.monotonic(), 0.0

    def show(said: object) -> None:
        nonlocal told
        since = time.monotonic() - begun
        if since >= told + _EVERY:
            told = since
            console.print(visible(f"after {since:.0f} s: {' '.join(str(said).split())}"))

    return show
