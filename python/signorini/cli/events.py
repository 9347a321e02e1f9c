"""The table of a load path's events."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from signorini.cli.cells import in_unit, number, table
from signorini.results.load_path import LoadPath
from signorini.results.path_stop import PathStop

_MOST_EVENTS = 40
"""Events printed; of more the first and last halves of these."""
_MOST_STRETCHES = 3
"""Stretches with more answers than one that are printed."""
_MOST_COLUMNS = 6
"""Supports with a column of their own; of more the reactions are in one."""


def print_path(console: Console, path: LoadPath) -> None:
    """Print every event: where on the path, which points open or close, and what the plate does there."""
    model, units = path.model, path.model.units
    if model.title:
        console.print(Text(model.title, style="bold"))
    console.print(Text(path.name, style="bold") + Text(f": followed by {path.problem.method}"))
    names = [support.name for support in model.support]
    apart = len(names) <= _MOST_COLUMNS
    reactions = names if apart else [f"reactions{in_unit(units.force)}"]
    rows = table("t", "event", right=[f"largest deflection{in_unit(units.length)}", *reactions])
    kept = list(path.stops)
    left_out = max(len(kept) - _MOST_EVENTS, 0)
    half = _MOST_EVENTS // 2
    for index, stop in enumerate(kept):
        if left_out and index == half:
            rows.add_row("...", f"{left_out} more events, all in path.csv", *[""] * (1 + len(reactions)))
        if left_out and half <= index < half + left_out:
            continue
        shown = [number(value) for value in _shown(stop)]
        cells = shown if apart else [", ".join(shown)]
        rows.add_row(f"{stop.t:.9g}", Text(path.words(index)), number(stop.utmost), *cells)
    console.print(rows)
    console.print(Text(_ending(path)))
    for begin, end, one in path.not_unique[:_MOST_STRETCHES]:
        console.print(Text(f"From t = {begin:.9g} to {end:.9g} {one.otherwise}: more answers than one are right."))
    if len(path.not_unique) > _MOST_STRETCHES:
        console.print(f"So on {len(path.not_unique) - _MOST_STRETCHES} more stretches, all in path.json.")
    unit = f" in {units.force}" if units.force and apart else ""
    of_all = "" if apart else f" of {', '.join(names)},"
    console.print(f"reactions{unit}{of_all} positive up")
    console.print(f"certificate, the worst of {len(path.stops)} stops: {path.certificate}")


def _shown(stop: PathStop) -> list[float]:
    least = 1e-12 * float(abs(stop.reactions).max(initial=0.0))
    return [float(value) if abs(value) > least else 0.0 for value in stop.reactions]


def _ending(path: LoadPath) -> str:
    match path.ending:
        case "no_equilibrium":
            return f"Equilibrium ends at t = {path.end:.9g}: for a larger t no reactions balance the load."
        case "no_more_events":
            return "After the last event nothing opens or closes any more, however large t is."
        case "until":
            return f"Followed to t = {path.end:.9g}."
        case _:
            return f"Followed to t = {path.end:.9g} only; beyond, rounding decides which points are in contact."
