"""Print the verdicts of validation cases."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console

from signorini.cli.grid import Column, Grid, numbers, say
from signorini.validation.pages import rows_of, summary
from signorini.validation.runner import Outcome


def print_validation(console: Console, outcomes: Sequence[Outcome]) -> None:
    """Print each validated number with error, tolerance and verdict; then for how many numbers ± covers the error."""
    shown = Grid([Column("case"), Column("number"), *numbers("error", "tolerance"), Column("verdict")])
    for outcome in outcomes:
        for one in outcome.comparisons:
            verdict = ("differs" if one.number.differs else "agrees") if one.holds else "does not hold"
            shown.add(
                outcome.case.name, one.number.label, f"{one.errors[-1]:.1e}", f"{one.number.tolerance:g}", verdict
            )
    shown.show(console, apart=True)
    holding = sum(outcome.holds for outcome in outcomes)
    say(console, f"{holding} of {len(outcomes)} cases hold.", style="" if holding == len(outcomes) else "bold red")
    counts = summary(list(rows_of(outcomes)))
    own = f"{counts['covered'] - counts['alone']} with the reference's own error"
    say(console, f"± covers the error of {counts['alone']} of {counts['known']} numbers on all meshes, {own}.")
