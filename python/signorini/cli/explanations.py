"""Print explanations of keys."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import Console

from signorini.cli.grid import say
from signorini.output.explain import Explanation

_MOST_PATHS = 4
"""Largest number of paths that are printed of one explanation."""


def print_explanations(out: Console, explanations: Iterable[Explanation]) -> None:
    """Print each explanation: its paths, its meaning, and a line for each of unit, type, allowed values and so on."""
    for one in explanations:
        more = [f"{len(one.keys) - _MOST_PATHS} other paths"] if len(one.keys) > _MOST_PATHS else []
        for place, path in enumerate([*one.keys[:_MOST_PATHS], *more]):
            say(out, f"{one.source}: {path}" if not place else f"    also {path}")
        said = {"": one.meaning, "unit": one.unit, "type": one.type, "allowed": one.allowed, "default": one.default}
        for name, text in {**said, "documented": one.documented}.items():
            if text:
                say(out, f"    {name + ': ' if name else ''}{text}")
