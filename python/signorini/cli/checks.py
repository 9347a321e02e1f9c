"""Table of the checks on the terminal."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from signorini.analysis.checks import check_results
from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.base.numbers import estimated, number
from signorini.cli.grid import Column, Grid, numbers, say
from signorini.cli.sentences import Labels
from signorini.errors import point

_STYLES = {True: "green", False: "bold red", None: "yellow"}


def print_checks(console: Console, results: Results, estimates: Estimates | None, labels: Labels) -> None:
    """Print a row for each check, failed checks first: value, limit, utilisation, governing combination, verdict."""
    checks = sorted(check_results(results, estimates), key=lambda one: one.passed is not False)
    columns = [Column("check"), Column("of", spare=True), *numbers("value", "limit", "utilisation")]
    shown = Grid([*columns, Column("governing", coded=labels.numbered), Column("at", spare=True), Column("verdict")])
    for one in checks:
        cells = ["", "", "∞" if one.governing and one.utilisation is None else ""]
        if one.value is not None and one.limit is not None and one.utilisation is not None:
            width = one.plus_minus
            used = number(one.utilisation, 1.0) if width is None else estimated(one.utilisation, width, 1.0)
            cells = [number(one.value), f"{one.limit:g}", used]
        by = labels.cell(one.governing) if one.governing else ""
        at = point(one.place, results.discretisation.mesh.size) if isinstance(one.place, tuple) else one.place or ""
        shown.add(one.name, one.of, *cells, by, at, Text(one.verdict, style=_STYLES[one.passed]))
    if checks:
        say(console, "Checks")
        shown.show(console, apart=True)
    missing = max((one.without_equilibrium for one in checks), default=0)
    if missing:
        say(console, f"Checked combinations without equilibrium: {missing}.", style="bold red")
    failed = [one.name for one in checks if one.passed is False]
    if failed:
        say(console, f"Failed checks: {', '.join(failed)}.", style="bold red")
