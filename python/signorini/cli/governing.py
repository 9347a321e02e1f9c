"""What governs among many combinations, as tables."""

from __future__ import annotations

from collections.abc import Mapping

from rich.console import Console
from rich.text import Text

from signorini.analysis.combinations import Combined
from signorini.cli.cells import in_unit, number, point, table
from signorini.contact.certificate import FIGURES
from signorini.model import Units

_MOST_NAMED = 5
"""Combinations without equilibrium that are named; the rest are in the files."""


def print_combined(console: Console, combined: Combined, chosen: Mapping[str, object]) -> None:
    """Print how many were solved, and the extremes with the combinations that they come from."""
    units = combined.layout.model.units
    total = len(combined.combinations)
    console.print(Text(f"{total} combinations", style="bold") + Text(f": {combined.solved} solved"))
    if combined.solved < total:
        names = list(combined.unbalanced)
        more = total - combined.solved - len(names[:_MOST_NAMED])
        listed = ", ".join(names[:_MOST_NAMED]) + (f" and {more} more" if more else "")
        console.print(Text(f"{total - combined.solved} without equilibrium: {listed}", style="bold red"))
    if combined.not_unique:
        console.print(Text(f"{combined.not_unique} not unique: the least of equal answers are given", style="yellow"))
    console.print()
    _print_fields(console, combined, units)
    _print_supports(console, combined, units)
    figures = ", ".join(f"{name} {combined.certificate[name]:.1e}" for name in FIGURES)
    console.print(f"worst certificate passed: {figures}")
    if chosen:
        console.print(f"all results of: {', '.join(chosen)}")


def _print_fields(console: Console, combined: Combined, units: Units) -> None:
    fields = combined.envelope.fields
    if not fields:
        return
    titles = {"deflection": f"deflection{in_unit(units.length)}", "reaction": "nodal reaction"}
    shown = table("field", right=["largest"])
    shown.add_column("of")
    shown.add_column("smallest", justify="right")
    shown.add_column("of")
    for name, (high, high_by, low, low_by) in combined.envelope.governing().items():
        if name in fields:
            names = (Text(combined.name(by)) for by in (high_by, low_by))
            shown.add_row(titles.get(name, name), number(high), next(names), number(low), next(names))
    console.print(shown)
    console.print()


def _print_supports(console: Console, combined: Combined, units: Units) -> None:
    model, governing = combined.layout.model, combined.envelope.governing()
    shown = table("support", right=[f"largest reaction{in_unit(units.force)}"])
    shown.add_column("of")
    shown.add_column("smallest", justify="right")
    shown.add_column("of")
    shown.add_column("points lifted", justify="right")
    every = zip(model.support, combined.envelope.supports, combined.layout.supports, strict=True)
    for index, (support, envelope, points) in enumerate(every):
        high, high_by, low, low_by = governing[f"reaction:{index}"]
        lifted = f"{int((envelope.lifted > 0).sum())} of {points.rows.shape[1]}" if points.rows.size else ""
        names = [Text(combined.name(by)) for by in (high_by, low_by)]
        shown.add_row(Text(support.name), number(high), names[0], number(low), names[1], lifted)
    console.print(shown)
    console.print()
    for support, envelope, points in zip(
        model.support, combined.envelope.supports, combined.layout.supports, strict=True
    ):
        if support.place == "at" and envelope.lifted.any():
            at = int(envelope.gap.largest.argmax())
            name = combined.name(int(envelope.gap.largest_by[at]))
            opening = number(float(envelope.gap.largest[at]))
            where = point(points.positions[at].tolist())
            console.print(Text(f"{support.name}: widest gap {opening} at {where} in {name}"))
