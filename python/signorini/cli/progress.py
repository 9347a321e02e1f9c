"""What is being done: a line on a terminal, gone at the end; in a log one now and then; of meshes lines that stay."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.text import Text

from signorini.base.progress import Progress
from signorini.cli.streams import stderr, visible

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
