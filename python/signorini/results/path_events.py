"""What the supports do along a load path: points open and close, lines and areas by their parts."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

from signorini.errors import point
from signorini.model import Support
from signorini.results.path_stop import PathStop

Change = Literal["opens", "closes", "begins to open", "begins to close", "open", "closed", "part closed"]

_WHOLE = 1e-12
"""Part of a support that is none: its weights sum to one but for rounding."""
QUARTERS = (0.75, 0.5, 0.25)
_MOST_POINTS = 3
"""Points of one support named at a stop."""


@dataclass(frozen=True)
class PathEvent:
    """A point of a support opens or closes; or a line or area begins to, has done so, or passes a quarter.

    Parameters
    ----------
    row : int
        Number of the stop, from 0.
    t : float
    support : str
    at : (x, y)
        The point or, as a line or area begins to open or close, the first one that does.
    change : str
        Of points "opens", "closes"; of lines and areas "begins to open", "begins to close", "open", "closed", and "part
        closed" as a quarter is passed.
    closed : float
        Part of the support that is closed from there on, by points, length or area; of "part closed" the quarter.
    opening : bool
        Whether less is closed than before.
    """

    row: int
    t: float
    support: str
    at: tuple[float, float] | None
    change: Change
    closed: float
    opening: bool


def path_events(supports: Sequence[Support], stops: Sequence[PathStop]) -> tuple[PathEvent, ...]:
    """Find what supports do at the stops of a path, in the order of the path."""
    found = []
    for index, support in enumerate(supports):
        parts = [float(stop.parts[index]) for stop in stops]
        for row in range(1, len(stops)):
            stop, before, now = stops[row], parts[row - 1], parts[row]
            own = [switch for switch in stop.switched if switch.support == support.name]
            if support.place == "at":
                found += [PathEvent(row, stop.t, support.name, one.at, one.change, now, not one.closes) for one in own]
            elif (change := _change(before, now)) is not None:
                first = own[0].at if own and change in ("begins to open", "begins to close") else None
                level = now if change != "part closed" else _passed(before, now)
                found.append(PathEvent(row, stop.t, support.name, first, change, level, now < before))
    return tuple(sorted(found, key=lambda event: event.row))


def crossings(stops: Sequence[PathStop], index: int, like: PathEvent) -> list[tuple[float, bool]]:
    """Every t at which a line or area does what an event says or the opposite, be it in a larger step; and if it opens.

    Part by part, in the order of the path.
    """
    level = {"begins to open": 1 - _WHOLE, "closed": 1 - _WHOLE, "open": _WHOLE, "begins to close": _WHOLE}
    beyond = [stop.parts[index] >= level.get(like.change, like.closed) for stop in stops]
    steps = zip(beyond[:-1], beyond[1:], stops[1:], strict=True)
    return [(stop.t, before) for before, now, stop in steps if before != now]


def in_words(events: Sequence[PathEvent], pulling: Collection[str] = ()) -> str:
    """Say what happens at one stop; points of ``pulling`` supports, which resist up, begin to pull as they close."""
    said = []
    for name, change in dict.fromkeys((event.support, event.change) for event in events):
        those = [event for event in events if (event.support, event.change) == (name, change)]
        places = [event.at for event in those if event.at is not None]
        where = f" at {' '.join(map(point, places[:_MOST_POINTS]))}" if places else ""
        more = f" and {len(places) - _MOST_POINTS} more" if len(places) > _MOST_POINTS else ""
        part = f"{'opens' if those[0].opening else 'closes'} on, {those[0].closed:.0%} closed"
        verb = {"open": "all open", "closed": "all closed", "part closed": part}
        if name in pulling:
            verb |= {"opens": "lets go", "closes": "begins to pull"}
        said.append(f"{name}: {verb.get(change, change)}{where}{more}")
    return "; ".join(said)


def _change(before: float, now: float) -> Change | None:
    """What a line or area does between two parts that are closed."""
    if abs(now - before) <= _WHOLE:
        return None
    if now >= 1 - _WHOLE or now <= _WHOLE:
        return "closed" if now > before else "open"
    if before >= 1 - _WHOLE or before <= _WHOLE:
        return "begins to open" if now < before else "begins to close"
    return None if _passed(before, now) == 0.0 else "part closed"


def _passed(before: float, now: float) -> float:
    """The last quarter that is passed; 0 if there is none."""
    low, high = min(before, now), max(before, now)
    between = [quarter for quarter in QUARTERS if low < quarter <= high]
    return 0.0 if not between else (min if now < before else max)(between)
