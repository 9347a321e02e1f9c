"""The table of a load path's events."""

from __future__ import annotations

import math

from rich.console import Console
from rich.text import Text

from signorini.accuracy.comparison import PathEstimate
from signorini.base.numbers import in_unit, number, size_of
from signorini.cli.grid import UNKNOWN, Column, Grid, numbers, say, say_checked
from signorini.results.load_path import LoadPath

_UNSETTLED = f"{UNKNOWN}: on the next mesh it happens not at all, or at quite another t"
_MOST_EVENTS = 40
"""Events printed; of more the first and last halves of these."""
_MOST_STRETCHES = 3
"""Stretches with more answers than one that are printed."""
_MOST_COLUMNS = 6
"""Supports with a column of their own; those of more are in path.csv."""


def print_path(console: Console, path: LoadPath, estimate: PathEstimate | None) -> None:
    """Print every event: its t, the points that open or close, and the largest deflection and reactions there."""
    model, units = path.model, path.model.units
    if model.title:
        say(console, model.title, style="bold")
    say(console, Text(path.name, style="bold") + Text(f": {len(path.stops)} stops by {path.method}"))
    names = [support.name for support in model.support]
    if len(names) > _MOST_COLUMNS:
        names = []
    columns = [Column("t"), Column("event"), *numbers(f"largest deflection{in_unit(units.length)}")]
    columns += numbers(*(f"{name}{in_unit(units.force)}" for name in names))
    rows = Grid(columns, heads=2, unknown=_UNSETTLED)
    farthest = size_of([stop.utmost for stop in path.stops])
    told = [(index, words) for index in range(len(path.stops)) if (words := path.words(index))]
    left_out = max(len(told) - _MOST_EVENTS, 0)
    half = _MOST_EVENTS // 2
    for place, (index, words) in enumerate(told):
        if left_out and place == half:
            rows.add("...", f"{left_out} more events, all in path.csv", *[""] * (1 + len(names)))
        if left_out and half <= place < half + left_out:
            continue
        stop = path.stops[index]
        largest = size_of(stop.reactions)
        shown = [number(value, largest) for value in stop.reactions.tolist()[: len(names)]]
        t = f"{stop.t:.6g}" if estimate is None else estimate.words(path, index)
        rows.add(t, words, number(stop.utmost, farthest), *shown)
    rows.show(console)
    say(console, f"all {len(path.stops)} stops are in path.csv")
    for threshold in path.thresholds:
        if threshold.t is None:
            say(console, f"{threshold.when}: not reached on this path")
    if path.interrupted:
        say(console, f"Interrupted at t = {path.end:.9g}; what there is, is certified.", style="yellow")
    say(console, _ending(path))
    for begin, end, one in path.not_unique[:_MOST_STRETCHES]:
        first, last = f"{begin:.9g}", f"{end:.9g}"
        where = f"At t = {first}" if first == last else f"From t = {first} to {last}"
        say(console, f"{where} {one.otherwise}: more answers than one are right.")
    if len(path.not_unique) > _MOST_STRETCHES:
        say(console, f"So on {len(path.not_unique) - _MOST_STRETCHES} more stretches, all in path.json.")
    say(console, "reactions positive up" if names else "reactions of the supports, positive up, are in path.csv")
    say(console, f"certificate, the worst of {len(path.stops)} stops: {path.certificate}")
    say_checked(console, () if estimate is None else estimate.elements, model.estimated)
    for sentence in (*path.warnings, *(estimate.warnings if estimate else ())):
        say(console, f"Warning: {sentence}", style="yellow")


def _ending(path: LoadPath) -> str:
    if path.interrupted and path.ending == "stopped":
        return f"Followed to t = {path.end:.9g}, where it was interrupted."
    match path.ending:
        case "no_equilibrium":
            how = f", and the plate {path.mechanism}" if path.mechanism else ""
            return f"Equilibrium ends at t = {path.limit:.9g}: for a larger t no reactions balance the load{how}."
        case "no_more_events":
            return "After the last event nothing opens or closes any more, however large t is."
        case "until":
            return f"Followed to t = {path.end:.9g}. Equilibrium {_end_of_equilibrium(path)}."
        case _:
            return f"Followed to t = {path.end:.9g} only; beyond, rounding decides which points are in contact."


def _end_of_equilibrium(path: LoadPath) -> str:
    if math.isfinite(path.limit):
        return f"ends at t = {path.limit:.9g}"
    holding = [one.name for one in path.model.support if one.resists in ("up", "both") or "w" in one.fixed]
    more = len(holding) - _MOST_COLUMNS
    names = ", ".join(holding[:_MOST_COLUMNS]) + (f" and {more} more" if more > 0 else "")
    against = f", {names} against lifting too" if holding else ""
    return f"does not end, however large t is: supports hold without limit{against}"
