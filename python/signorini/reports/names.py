"""Labels of combinations in a report: "C17" or "C17: ULS"; with fewer than three combinations only their names."""

from __future__ import annotations

from signorini.analysis.results import Results


def short(results: Results, name: str) -> str:
    """Number of a combination, such as "C17"; its name if there are fewer than three combinations."""
    return f"C{results.number_of(name) + 1}" if len(results) > 2 and name in results else name


def numbered(results: Results, name: str) -> str:
    """Number of a combination with its name, such as "C17: ULS"; the name alone if there are fewer than three."""
    code = short(results, name)
    return name if code == name else f"{code}: {name}"
