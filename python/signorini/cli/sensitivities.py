"""Print derivatives of numbers with respect to parameters of the input."""

from __future__ import annotations

import math

from rich.console import Console

from signorini.base.numbers import in_unit, number
from signorini.cli.grid import Column, Grid, numbers, say
from signorini.cli.sentences import Labels
from signorini.cli.streams import visible
from signorini.results.sensitivity import Derivative, Sensitivity


def print_sensitivities(console: Console, each: tuple[Sensitivity, ...], labels: Labels) -> None:
    """Print a table for each number: parameters, derivatives, elasticities, and ranges without a change of contact."""
    for one in each:
        say(
            console,
            f"sensitivities of {visible(one.name)} = {number(one.value)} {one.unit}".rstrip()
            + (f" in {visible(labels.code(one.combination))}" if labels.named or one.combination != "all" else "")
            + ", while no contact point opens, closes or reaches a limit (from, to: to first order)",
        )
        grid = Grid([Column("parameter"), *numbers("value", "derivative", "elasticity", "from", "to")])
        for row in one.derivatives:
            slope = _finite(row.derivative) + in_unit(row.derivative_unit)
            ends = [_finite(end) for end in row.valid]
            grid.add(visible(row.path), f"{number(row.value)}{in_unit(row.unit)}", slope, _elasticity(row), *ends)
        grid.show(console)
        for row in one.derivatives:
            if row.why:
                say(console, f"{visible(row.path)}: {row.why}")
        console.print()


def _finite(value: float) -> str:
    return number(value) if math.isfinite(value) else "?" if math.isnan(value) else "∞" if value > 0.0 else "-∞"


def _elasticity(row: Derivative) -> str:
    return "" if math.isnan(row.elasticity) else f"{row.elasticity:.3f}"
