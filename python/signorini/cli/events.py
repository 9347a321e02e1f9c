"""Print the events of a load path as a table."""

from __future__ import annotations

import math

from rich.console import Console
from rich.text import Text

from signorini.accuracy.comparison import PathEstimate, t_in_words
from signorini.base.numbers import in_unit, number, size_of
from signorini.cli.grid import UNKNOWN, Column, Grid, numbers, say, say_checked
from signorini.results.load_path import LoadPath, motion_of

_UNSETTLED = f"{UNKNOWN}: on another mesh the event does not occur, or occurs at a very different t"
_MAX_EVENTS = 40
"""Largest number of events for which all events are printed; of more events, only the first 20 and the last 20."""
_MAX_INTERVALS = 3
"""Largest number of intervals of t with a non-unique solution that are printed."""
_MAX_COLUMNS = 6
"""Largest number of supports whose reactions are printed; of more supports, no reactions are printed."""


def print_path(console: Console, path: LoadPath, estimate: PathEstimate | None) -> None:
    """Print a row for each event of a path: t, points that open or close, largest deflection, reactions."""
    model, units = path.model, path.model.units
    if model.title:
        say(console, model.title, style="bold")
    say(console, Text(path.name, style="bold") + Text(f": {len(path.stops)} stops by {path.method}"))
    names = [support.name for support in model.support]
    if len(names) > _MAX_COLUMNS:
        names = []
    columns = [Column("t"), Column("event"), *numbers(f"largest deflection{in_unit(units.length)}")]
    columns += numbers(*(f"{name}{in_unit(units.force)}" for name in names))
    rows = Grid(columns, heads=2, unknown=_UNSETTLED)
    farthest = size_of([stop.utmost for stop in path.stops])
    events = [(index, event) for index in range(len(path.stops)) if (event := path.words(index))]
    omitted = max(len(events) - _MAX_EVENTS, 0)
    half = _MAX_EVENTS // 2
    for position, (index, event) in enumerate(events):
        if omitted and position == half:
            rows.add("...", f"{omitted} more events, all in path.csv", *[""] * (1 + len(names)))
        if omitted and half <= position < half + omitted:
            continue
        stop = path.stops[index]
        largest = size_of(stop.reactions)
        shown = [number(value, largest) for value in stop.reactions.tolist()[: len(names)]]
        rows.add(t_in_words(path, index, estimate), event, number(stop.utmost, farthest), *shown)
    rows.show(console)
    say(console, f"all {len(path.stops)} stops are in path.csv")
    for threshold in path.thresholds:
        if threshold.t is None:
            say(console, f"{threshold.when}: this value is not reached on the path")
    if path.interrupted:
        say(console, f"Interrupted at t = {path.end:.9g}; all results up to this t are certified.", style="yellow")
    say(console, _ending(path))
    for begin, end, not_unique in path.not_unique[:_MAX_INTERVALS]:
        first, last = f"{begin:.9g}", f"{end:.9g}"
        where = f"At t = {first}" if first == last else f"From t = {first} to {last}"
        say(console, f"{where} {not_unique.otherwise}: the solution is not unique.")
    if len(path.not_unique) > _MAX_INTERVALS:
        say(
            console,
            f"{len(path.not_unique) - _MAX_INTERVALS} more intervals of t without a unique solution, in path.json.",
        )
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
            how = f", and {motion}" if (motion := motion_of(path)) else ""
            return f"Equilibrium ends at t = {path.limit:.9g}: beyond it no reactions balance the load{how}."
        case "no_more_events":
            return "After the last event no point opens or closes for any larger t."
        case "until":
            return f"Followed to t = {path.end:.9g}. Equilibrium {_end_of_equilibrium(path)}."
        case _:
            return f"Followed to t = {path.end:.9g} only: beyond this t rounding decides which points are in contact."


def _end_of_equilibrium(path: LoadPath) -> str:
    if math.isfinite(path.limit):
        return f"ends at t = {path.limit:.9g}"
    holding = [support.name for support in path.model.support if support.holds_w and support.direction != "down"]
    more = len(holding) - _MAX_COLUMNS
    names = ", ".join(holding[:_MAX_COLUMNS]) + (f" and {more} more" if more > 0 else "")
    uplift = f"; {names} also against uplift" if holding else ""
    return f"does not end for any t: the supports hold without limit{uplift}"
