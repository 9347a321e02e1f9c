"""Print a verification: values that differ, and values that are not compared."""

from __future__ import annotations

import json
from collections import Counter
from typing import Any

from rich.console import Console

import signorini
from signorini.cli.grid import Column, Grid, numbers, say
from signorini.cli.streams import visible
from signorini.output.verification import TOLERANCE, Difference, Verification

_MOST_ROWS = 50
"""Largest number of differences that are listed."""
_LONGEST = 60
"""Largest number of characters of a value that are shown."""


def print_verification(console: Console, verification: Verification) -> None:
    """Print the differences as a table with path, stored value, computed value and difference; then their number."""
    shown = Grid([Column("path"), *numbers("stored", "computed", "difference")])
    for one in verification.differences[:_MOST_ROWS]:
        shown.add(*_row(one))
    shown.show(console, apart=True)
    if (more := len(verification.differences) - _MOST_ROWS) > 0:
        say(console, f"And {more} more.")
    counts = Counter(one.what for one in verification.differences)
    identical = verification.compared - counts.total() - len(verification.rounding)
    parts = [f"{identical} identical", f"{len(verification.rounding)} equal up to rounding ({TOLERANCE:g})"]
    parts += [f"{counts['value']} different", f"{counts['missing']} missing", f"{counts['additional']} additional"]
    say(console, f"{verification.compared} values compared: {', '.join(parts)}.")
    say(console, f"Not compared: {', '.join(verification.not_compared)}.")
    if verification.version != signorini.__version__:
        written = visible(verification.version) or "an unknown version"
        say(console, f"The file is from signorini {written}, and was compared with {signorini.__version__}.")
    say(console, "Equal." if verification.equal else "Not equal.", style="" if verification.equal else "bold red")


def _row(one: Difference) -> list[str]:
    stored = "absent" if one.what == "missing" else _written(one.stored)
    computed = "absent" if one.what == "additional" else _written(one.computed)
    difference = one.difference
    return [visible(one.place), stored, computed, "" if difference is None else f"{difference:.3g}"]


def _written(value: Any) -> str:
    text = visible(f"{value:.12g}" if isinstance(value, float) else json.dumps(value, ensure_ascii=False))
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"
