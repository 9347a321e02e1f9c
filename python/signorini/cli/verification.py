"""Print the result of `signorini verify`: values that differ, and values that are not compared."""

from __future__ import annotations

import json
from collections import Counter
from typing import Any

from rich.console import Console

import signorini
from signorini.cli.grid import Column, Grid, numbers, say
from signorini.cli.streams import visible
from signorini.output.verification import TOLERANCE, Verification

_MOST_ROWS = 50
"""Largest number of differences that are listed."""


def print_verification(console: Console, verification: Verification) -> None:
    """Print the differences as a table with path, stored value, computed value and difference; then their number."""
    shown = Grid([Column("path"), *numbers("stored", "computed", "difference")])
    for one in verification.differences[:_MOST_ROWS]:
        stored = "absent" if one.what == "missing" else _written(one.stored)
        computed = "absent" if one.what == "additional" else _written(one.computed)
        shown.add(visible(one.place), stored, computed, "" if one.difference is None else f"{one.difference:.3g}")
    shown.show(console, apart=True)
    counts = Counter(one.what for one in verification.differences)
    if (more := counts.total() - _MOST_ROWS) > 0:
        say(console, f"And {more} more.")
    rounding = len(verification.rounding)
    parts = [f"{verification.compared - counts.total() - rounding} identical", f"{rounding} equal to {TOLERANCE:g}"]
    parts += [f"{counts['value']} different", f"{counts['missing']} missing", f"{counts['additional']} additional"]
    say(console, f"{verification.compared} values compared: {', '.join(parts)}.")
    say(console, f"Not compared: {', '.join(verification.not_compared)}.")
    if verification.version != signorini.__version__:
        say(console, visible(f"Written by version {verification.version}, computed by {signorini.__version__}."))
    say(console, "Equal." if verification.equal else "Not equal.", style="" if verification.equal else "bold red")


def _written(value: Any) -> str:
    text = f"{value:.12g}" if isinstance(value, float) else json.dumps(value, ensure_ascii=False)
    return visible(text if len(text) <= 60 else f"{text[:60]}…")
