"""Print explanations of keys, numbers, columns and errors."""

from __future__ import annotations

from collections.abc import Iterable

from rich.console import Console

from signorini.cli.grid import say
from signorini.output.explain import Explanation

_MOST_PATHS = 4
"""Largest number of paths of keys that are printed in one explanation."""


def print_explanations(out: Console, explanations: Iterable[Explanation]) -> None:
    """Print explanations: the paths of the key or number, its meaning, and lines with unit, type, allowed values."""
    for one in explanations:
        more = [f"{len(one.keys) - _MOST_PATHS} other paths"] if len(one.keys) > _MOST_PATHS else []
        for place, path in enumerate([*one.keys[:_MOST_PATHS], *more]):
            say(out, f"{one.source}: {path}" if not place else f"    also {path}")
        said = {"": one.meaning, "unit": one.unit, "type": one.type, "allowed": one.allowed, "default": one.default}
        for name, text in {**said, "documented": one.documented}.items():
            if text:
                say(out, f"    {name + ': ' if name else ''}{text}")
