"""Combinations in a report: "C17" in narrow places, "C17: ULS" elsewhere; with fewer than three only their names."""

from __future__ import annotations

from signorini.analysis.results import Results


def short(results: Results, name: str) -> str:
    """Number of a combination, "C17"."""
    return f"C{results.number_of(name) + 1}" if len(results) > 2 and name in results else name


def numbered(results: Results, name: str) -> str:
    """Number of a combination with its name, "C17: ULS"."""
    code = short(results, name)
    return name if code == name else f"{code}: {name}"
