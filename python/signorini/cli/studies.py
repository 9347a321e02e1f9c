"""Print the progress and the summary of a study."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from statistics import fmean

import numpy as np
from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from signorini.base.numbers import number
from signorini.cli.grid import Column, Grid, numbers, say
from signorini.cli.streams import progress_line, visible
from signorini.studies.study import StudyProgress
from signorini.studies.summary import Study

_SHOWN = (0.05, 0.5, 0.95)
"""Probabilities of the printed quantiles of results."""
_MOST_REASONS = 5
"""Largest number of printed reasons for which variants have no numbers."""


@contextmanager
def live_table(results: tuple[str, ...]) -> Iterator[Callable[[StudyProgress], None]]:
    """Context with a function that prints progress: on a terminal a table of results so far, otherwise log lines."""
    console = Console(stderr=True, markup=False, highlight=False, emoji=False)
    values: dict[str, list[float]] = {name: [] for name in results}
    if not console.is_terminal or console.is_dumb_terminal:
        with progress_line() as show:
            yield lambda now: show(_line(now))
        return
    with Live(console=console, transient=True, refresh_per_second=4) as live:

        def show_table(now: StudyProgress) -> None:
            for name, own in values.items():
                value = float(now.row[name]) if now.row is not None else np.nan
                if np.isfinite(value):
                    own.append(value)
            table = Table("result", "least", "mean", "largest")
            for name, own in values.items():
                size = max(map(abs, own), default=0.0)
                table.add_row(visible(name), *(number(f(own), size) if own else "" for f in (min, fmean, max)))
            live.update(Group(Text(_line(now)), table))

        yield show_table


def _line(now: StudyProgress) -> str:
    unsolved = f", {now.unsolved} not solved" if now.unsolved else ""
    left = f", about {now.left:.0f} s left" if now.left >= 1.0 else ""
    return f"{now.done} of {now.total} variants{unsolved}{left}"


def print_study(console: Console, study: Study) -> None:
    """Print quantiles, first-order sensitivities, probabilities of failure, and reasons of unsolved variants."""
    say(console, f"{len(study.rows)} of {study.count} variants, {int(study.solved.sum())} solved")
    titles = [f"{probability:.0%}" for probability in _SHOWN]
    grid = Grid([Column("result"), *numbers("smallest", *titles, "largest", "largest ±")])
    for name in study.results:
        values = study[name][study.solved]
        values = values[np.isfinite(values)]
        if not len(values):
            grid.add(visible(name), *[""] * (len(_SHOWN) + 3))
            continue
        size, of = float(np.abs(values).max()), study.quantiles(name)
        shown = (values.min(), *(of[probability] for probability in _SHOWN), values.max())
        widths = study[f"plus_minus:{name}"]
        width = number(float(np.nanmax(widths)), size) if np.isfinite(widths).any() else ""
        grid.add(visible(name), *(number(float(value), size) for value in shown), width)
    grid.show(console)
    sensitivities = Grid([Column("first-order sensitivity"), *numbers(*map(visible, study.results))])
    of_results = {name: study.sensitivities(name) for name in study.results}
    for parameter in study.parameters:
        cells = [of[parameter] for of in of_results.values()]
        sensitivities.add(visible(parameter), *("" if np.isnan(cell) else f"{cell:.2f}" for cell in cells))
    sensitivities.show(console)
    for name in study.results if study.random else ():
        if name.endswith(".utilisation"):
            found = study.failure_probability(name)
            low, high = found.interval
            said = f"{visible(name)} > 1: {found.failed} of {found.count} variants, probability {low:.2g} to {high:.2g}"
            say(
                console,
                f"{said} with 95 % confidence; with ± subtracted or added {found.certain} to {found.possible} variants",
            )
    reasons = Counter((row["status"], row["message"].split("\n")[0]) for row in study.rows if row["status"] != "solved")
    for (status, message), count in reasons.most_common(_MOST_REASONS):
        say(console, visible(f"{count} × {status}: {message}"), style="yellow")
