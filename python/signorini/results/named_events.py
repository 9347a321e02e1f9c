"""Named events of a load path: points open and close, lines and areas by their true length and area."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

from signorini.contact.selection import Answer
from signorini.discretise import Discretisation
from signorini.errors import point
from signorini.model import Support
from signorini.results.closed_part import Scales, closed_by_point
from signorini.results.margins import LEVELS, WHOLE
from signorini.results.path_stop import PathStop
from signorini.results.support_points import SupportPoints

Change = Literal["opens", "closes", "begins to open", "begins to close", "open", "closed", "part closed"]

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
        The point; of a line or area that begins to open or close where it does so first.
    change : str
        Of points "opens", "closes"; of lines and areas "begins to open", "begins to close", "open", "closed", and "part
        closed" as a quarter is passed.
    closed : float
        Part of the support that is closed there, by points, length or contact area; of "part closed" the quarter.
    opening : bool
        Whether less is closed than before.
    number : int
        Which point of the support it is, or which of the levels 1, 0.75, 0.5, 0.25, 0 of a line or area, from 0.
    """

    row: int
    t: float
    support: str
    at: tuple[float, float] | None
    change: Change
    closed: float
    opening: bool
    number: int = 0


def event_of(support: Support, number: int, opening: bool) -> tuple[Change, float | None]:
    """What happens as the margin of that number changes its sign, and the part that is closed there, if it tells."""
    if support.place == "at":
        return "opens" if opening else "closes", None
    level = LEVELS[number]
    if level == 1.0:
        return ("begins to open" if opening else "closed"), 1.0
    if level == 0.0:
        return ("open" if opening else "begins to close"), 0.0
    return "part closed", level


def first_place(
    discretisation: Discretisation, index: int, answer: Answer, opening: bool
) -> tuple[float, float] | None:
    """Where a line or area begins to open: its point that is closed least; or to close: the one that is least open."""
    points = SupportPoints.of(discretisation, index)
    own = closed_by_point(discretisation, points, answer, Scales.of(answer))
    if not len(own):
        return None
    x, y = points.positions[int(own.argmin() if opening else own.argmax())].tolist()
    return x, y


def events_of_stops(supports: Sequence[Support], stops: Sequence[PathStop]) -> tuple[PathEvent, ...]:
    """Find what supports do at the stops of a path that stops at every event, in its order."""
    result = []
    for index, support in enumerate(supports):
        parts = [float(stop.parts[index]) for stop in stops]
        for row in range(1, len(stops)):
            stop, before, now = stops[row], parts[row - 1], parts[row]
            own = [switch for switch in stop.switched if switch.support == support.name]
            if support.place == "at":
                result += [PathEvent(row, stop.t, support.name, one.at, one.change, now, not one.closes) for one in own]
                continue
            opening = now < before
            for number, level in enumerate(LEVELS):
                beyond = 1 - WHOLE if level == 1.0 else WHOLE if level == 0.0 else level
                if (before >= beyond) == (now >= beyond):
                    continue
                change, part = event_of(support, number, opening)
                at = own[0].at if own and change in ("begins to open", "begins to close") else None
                result.append(PathEvent(row, stop.t, support.name, at, change, part or 0.0, opening, number))
    return tuple(sorted(result, key=lambda event: event.row))


def in_words(events: Sequence[PathEvent], pulling: Collection[str] = ()) -> str:
    """Say what happens at one stop; points of ``pulling`` supports, which resist up, begin to pull as they close."""
    said = []
    for name, change, closed in dict.fromkeys(
        (event.support, event.change, event.closed if event.change == "part closed" else 0.0) for event in events
    ):
        those = [
            event
            for event in events
            if (event.support, event.change) == (name, change) and (change != "part closed" or event.closed == closed)
        ]
        places = [event.at for event in those if event.at is not None]
        where = f" at {' '.join(map(point, places[:_MOST_POINTS]))}" if places else ""
        more = f" and {len(places) - _MOST_POINTS} more" if len(places) > _MOST_POINTS else ""
        part = f"{'opens' if those[0].opening else 'closes'} on, {those[0].closed:.0%} closed"
        verb = {"open": "all open", "closed": "all closed", "part closed": part}
        if name in pulling:
            verb |= {"opens": "lets go", "closes": "begins to pull"}
        said.append(f"{name}: {verb.get(change, change)}{where}{more}")
    return "; ".join(said)
