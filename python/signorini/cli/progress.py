"""The line on a terminal that says what is being done, and is gone when it is done; lines that stay tell of meshes."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.text import Text

from signorini.base.progress import Progress

_BESIDE = 4
"""Columns that the turning mark takes, and one to spare."""


@contextmanager
def transient_line() -> Iterator[Callable[[object], None]]:
    """Give a function that shows its argument on standard error, if that is a terminal, in place of the last one's.

    How far a mesh came on the way to an accuracy stays.
    """
    console = Console(stderr=True, markup=False, highlight=False, emoji=False)
    if not sys.stderr.isatty() or console.is_dumb_terminal:
        yield lambda said: None
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
