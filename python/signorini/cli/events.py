"""The table of a load path's events."""

from __future__ import annotations

from rich.console import Console
from rich.text import Text

from signorini.cli.cells import in_unit, number, point, table, unit_of
from signorini.path import Path
from signorini.path_stop import PathStop

_MOST_EVENTS = 40
"""Events printed; of more the first and last halves of these."""
_MOST_POINTS = 3
"""Points of one support named at an event."""


def print_path(console: Console, path: Path) -> None:
    """Print every event: where on the path, which points open or close, and what the plate does there."""
    model, units = path.model, path.model.units
    if model.title:
        console.print(Text(model.title, style="bold"))
    console.print(Text(path.name, style="bold") + Text(f": followed by {path.problem.method}"))
    rows = table("t", "event", right=[f"largest deflection{in_unit(units.length)}", f"reactions{in_unit(units.force)}"])
    kept = list(path.stops)
    left_out = max(len(kept) - _MOST_EVENTS, 0)
    half = _MOST_EVENTS // 2
    for index, stop in enumerate(kept):
        if left_out and index == half:
            rows.add_row("...", f"{left_out} more events, all in path.json", "", "")
        if left_out and half <= index < half + left_out:
            continue
        reactions = ", ".join(number(value) for value in _shown(stop))
        rows.add_row(f"{stop.t:.9g}", Text(_event(path, index)), number(stop.largest), reactions)
    console.print(rows)
    console.print(Text(_ending(path)))
    console.print(f"reactions of {', '.join(support.name for support in model.support)}, positive up{unit_of('')}")
    console.print(f"certificate, the worst of {len(path.stops)} stops: {path.certificate}")


def _shown(stop: PathStop) -> list[float]:
    least = 1e-12 * float(abs(stop.reactions).max(initial=0.0))
    return [float(value) if abs(value) > least else 0.0 for value in stop.reactions]


def _event(path: Path, index: int) -> str:
    stop = path.stops[index]
    if not stop.switched:
        return "begin" if index == 0 else "end"
    said = []
    for name, change in dict.fromkeys((switch.support, switch.change) for switch in stop.switched):
        places = [switch.at for switch in stop.switched if (switch.support, switch.change) == (name, change)]
        some = " ".join(point(at) for at in places[:_MOST_POINTS])
        more = f" and {len(places) - _MOST_POINTS} more" if len(places) > _MOST_POINTS else ""
        said.append(f"{name} {change} at {some}{more}")
    return "; ".join(said)


def _ending(path: Path) -> str:
    match path.ending:
        case "no_equilibrium":
            return f"Equilibrium ends at t = {path.end:.9g}: for a larger t no reactions balance the load."
        case "no_more_events":
            return "After the last event nothing opens or closes any more, however large t is."
        case "until":
            return f"Followed to t = {path.end:.9g}."
        case _:
            return f"Followed to t = {path.end:.9g} only; beyond, rounding decides which points are in contact."
