"""Events of a load path: margins of supports to their events, named events of supports, and thresholds."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from signorini.contact.selection import Answer
from signorini.discretise import Discretisation
from signorini.discretise.laws import SupportLaw
from signorini.discretise.rows import Floats
from signorini.errors import InputError, point, unknown
from signorini.model import Support
from signorini.results.checks import require_measured
from signorini.results.contact_field.areas import area_at_rest
from signorini.results.path_stop import PathStop, numbers_at_stops
from signorini.results.quantities import SMOOTH
from signorini.results.support_points import Scales, SupportPoints, closed_by_point, margin_by_part

LEVELS = (1.0, 0.75, 0.5, 0.25, 0.0)
"""Closed parts at which a line or area has an event: 1 (it begins to open), 0.75, 0.5, 0.25, and 0 (all of it is open).
"""
WHOLE = 1e-12
"""Largest difference of a support's closed part from 0 or 1 that counts as zero."""
_EQUAL = 1e-10
"""Rounding error of a quantity that has a threshold, relative to the threshold's value."""
_TOUCHING = 1e-9
"""Largest overlap of plate and area that counts as zero, relative to the largest overlap or gap at points and nodes."""


def margins(discretisation: Discretisation, index: int, answer: Answer, scales: Scales, part: float) -> Floats:
    """Margins of a support to its events: continuous functions of t that change their sign at an event.

    A support at points has p margins, ≥ 0 while the point is closed. A line or area has five, ≥ 0 while its closed part
    exceeds the values in `LEVELS`. A support with a limit has further margins, ≥ 0 below the limit: one for each of the
    points, or one for the whole line or area.
    """
    closing = _closing(discretisation, index, answer, scales, part)
    support = discretisation.model.support[index]
    if not support.can_yield:
        return closing
    room = _to_limit(discretisation, SupportPoints.of(discretisation, index), answer, scales)
    return np.append(closing, room if support.place == "at" else room.min(initial=np.inf))


def _to_limit(discretisation: Discretisation, points: SupportPoints, answer: Answer, scales: Scales) -> Floats:
    """Scaled distances (p,) of the forces of a support's points from their limits; negative where a point yields."""
    contacts, (least, most) = discretisation.contacts, discretisation.contacts.limits
    force = np.minimum(most - answer.reaction, np.where(least < 0.0, answer.reaction - least, np.inf))
    soft = contacts.compliance > 0
    rows = np.where(soft, contacts.compliance / scales.length, 1.0 / scales.force) * force
    rows = np.where(answer.gap < 0.0, answer.gap / scales.length, rows)
    own = rows[points.rows].min(axis=0, initial=np.inf)
    if points.shares is not None:
        own = np.minimum.reduceat(own[points.shares.indices], points.shares.indptr[:-1])
    return np.asarray(np.concatenate([np.full(points.fixed, np.inf), own])[points.order])


def _closing(discretisation: Discretisation, index: int, answer: Answer, scales: Scales, part: float) -> Floats:
    support, points = discretisation.model.support[index], SupportPoints.of(discretisation, index)
    own = closed_by_point(discretisation, points, answer, scales)
    if support.place == "at":
        return own
    if support.area is None or (at_rest := area_at_rest(discretisation, index)).on_means:
        return _of_parts(own, points.weights, between=support.area is None)
    deflection = (answer.hi + answer.lo)[::3]
    nodes = np.flatnonzero(at_rest.on_nodes)
    law = SupportLaw(support)
    at_nodes = law.overlap(deflection[nodes], law.travel(discretisation.mesh.points[nodes]))
    pressed = np.append(own * scales.length, at_nodes[~np.isnan(at_nodes)])
    touching = _TOUCHING * np.abs(pressed).max(initial=0.0)
    ends = (pressed.min() + touching) / scales.length, (pressed.max() - touching) / scales.length
    return np.array([ends[0], *(part - level for level in LEVELS[1:-1]), ends[1]])


def _of_parts(own: Floats, weights: Floats, between: bool) -> Floats:
    """Margins (5,) of a line or area to `LEVELS`, from margins ``own`` (p,) of its points and their weights (p,).

    If ``between``, the margin is linear between points, as on a line.
    """
    if not len(own):
        return np.ones(len(LEVELS))
    if between:
        amid = np.interp(LEVELS[1:-1], *margin_by_part(own, weights))
    else:
        order = np.argsort(-own, kind="stable")
        reached = np.cumsum(weights[order]) / weights.sum()
        amid = own[order][np.searchsorted(reached, np.array(LEVELS[1:-1]) - WHOLE).clip(0, len(own) - 1)]
    return np.array([own.min(), *amid, own.max()])


Change = Literal[
    "opens", "closes", "yields", "stops yielding", "begins to open", "begins to close", "open", "closed", "part closed"
]
"""Name of an event. Points: "opens", "closes". Lines and areas: "begins to open", "part closed" at each quarter,
"open", "begins to close", "closed". Supports with a limit: "yields" if the first point yields, "stops yielding"."""

_MOST_POINTS = 3
"""Largest number of points of one support that the description of a stop names."""


@dataclass(frozen=True, kw_only=True)
class PathEvent:
    """An event of a support: a point opens, closes or yields, or the closed part of a line or area reaches a level."""

    row: int  # number of the stop, from 0
    t: float
    support: str
    # position of the point; for a line or area that of the first point that opens, closes or yields
    at: tuple[float, float] | None
    change: Change
    # closed part of the support at the event; for "part closed" 0.75, 0.5 or 0.25
    closed: float
    opening: bool  # whether the closed part of the support decreases at the event
    # index in `margins` of the margin that changes sign (in `LEVELS` for lines and areas); 0 for points on exact paths
    number: int = 0


def closing_margins(support: Support, margins: int) -> int:
    """Number of margins to opening and closing, which come first among the ``margins`` margins of a support."""
    if support.place != "at":
        return len(LEVELS)
    return margins if not support.can_yield else margins // 2


def event_of(support: Support, number: int, opening: bool, margins: int) -> tuple[Change, float | None]:
    """Name of the event at which margin ``number`` changes its sign, and its level in `LEVELS`, None if it has none."""
    if number >= closing_margins(support, margins):
        return "yields" if opening else "stops yielding", None
    if support.place == "at":
        return "opens" if opening else "closes", None
    level = LEVELS[number]
    if level == 1.0:
        return ("begins to open" if opening else "closed"), 1.0
    if level == 0.0:
        return ("open" if opening else "begins to close"), 0.0
    return "part closed", level


def first_place(
    discretisation: Discretisation, index: int, answer: Answer, change: Change
) -> tuple[float, float] | None:
    """Position of the first point of a line or area that opens, closes or yields, by the margins of points."""
    points, scales = SupportPoints.of(discretisation, index), Scales.of(answer)
    if "yield" in change:
        own = _to_limit(discretisation, points, answer, scales)
    else:
        own = closed_by_point(discretisation, points, answer, scales)
    if not len(own):
        return None
    x, y = points.positions[int(own.argmax() if change == "begins to close" else own.argmin())].tolist()
    return x, y


def events_of_stops(supports: Sequence[Support], stops: Sequence[PathStop]) -> tuple[PathEvent, ...]:
    """Find the events of supports at the stops of an exact path, in order of t."""
    result = []
    for index, support in enumerate(supports):
        parts = [float(stop.parts[index]) for stop in stops]
        for row in range(1, len(stops)):
            stop, before, now = stops[row], parts[row - 1], parts[row]
            own = [switch for switch in stop.switched if switch.support == support.name]
            if support.place == "at":
                result += [
                    PathEvent(
                        row=row,
                        t=stop.t,
                        support=support.name,
                        at=one.at,
                        change=one.change,
                        closed=now,
                        opening=one.opens,
                    )
                    for one in own
                ]
                continue
            yielding = [one for one in own if "yield" in one.change]
            result += [
                PathEvent(
                    row=row, t=stop.t, support=support.name, at=one.at, change=one.change, closed=now, opening=one.opens
                )
                for one in yielding
            ]
            opening = now < before
            for number, level in enumerate(LEVELS):
                beyond = 1 - WHOLE if level == 1.0 else WHOLE if level == 0.0 else level
                if (before >= beyond) == (now >= beyond):
                    continue
                change, part = event_of(support, number, opening, len(LEVELS))
                # A line begins to open or close at the stop where its first point switches, before its part changes.
                begins = change in ("begins to open", "begins to close")
                begin = row - 1 if begins and support.along_line else row
                first = [one for one in stops[begin].switched if begins and one.support == support.name]
                result.append(
                    PathEvent(
                        row=begin,
                        t=stops[begin].t,
                        support=support.name,
                        at=first[0].at if first else None,
                        change=change,
                        closed=part or 0.0,
                        opening=opening,
                        number=number,
                    )
                )
    return tuple(sorted(result, key=lambda event: event.row))


def in_words(events: Sequence[PathEvent], pulling: Collection[str] = ()) -> str:
    """Describe the events of one stop.

    Supports named in ``pulling`` only hold the plate down: their points "begin to pull" when they close.
    """
    alike, said = dict[tuple[str, Change, float], list[PathEvent]](), []
    for event in events:
        part = event.closed if event.change == "part closed" else 0.0
        alike.setdefault((event.support, event.change, part), []).append(event)
    for (name, change, _), those in alike.items():
        places = [event.at for event in those if event.at is not None]
        where = f" at {' '.join(map(point, places[:_MOST_POINTS]))}" if places else ""
        more = f" and {len(places) - _MOST_POINTS} more" if len(places) > _MOST_POINTS else ""
        partly = f"{'opens' if those[0].opening else 'closes'} on, {100.0 * those[0].closed:.0f} % closed"
        verb = {"open": "all open", "closed": "all closed", "part closed": partly}
        if name in pulling:
            verb |= {"opens": "lets go", "closes": "begins to pull"}
        said.append(f"{name}: {verb.get(change, change)}{where}{more}")
    return "; ".join(said)


@dataclass(frozen=True)
class Threshold:
    """A request for the first t on the path at which a quantity has a given value."""

    when: str  # text of the request, such as ``"bolts[1].reaction = -203e3"``
    quantity: str  # name of the quantity, such as "bolts[1].reaction"
    value: float
    t: float | None = None  # first t at which the quantity has the value; None if the path does not reach it

    def margin(self, number: float, above: bool) -> float:
        """The quantity minus the value; its sign changes where the quantity reaches the value from above or from below.

        The value is moved by its rounding error toward the quantity at the start: if the value is a support's limit, a
        yielding reaction equals the value but never exceeds it.
        """
        return number - self.value - math.copysign(_EQUAL * abs(self.value), 1.0 if above else -1.0)

    @property
    def linear(self) -> bool:
        """Whether the quantity is linear in t between changes of the contact state."""
        return self.quantity.rpartition(".")[-1] not in SMOOTH


def thresholds(discretisation: Discretisation, when: Sequence[str]) -> tuple[Threshold, ...]:
    """Read thresholds from texts "name = value", each with the name of a number."""
    if isinstance(when, str) or not isinstance(when, Sequence):
        raise InputError('it must be a list of texts such as ["bolts[1].reaction = -203e3"].', place="when")
    catalogue, asked = numbers_at_stops(discretisation), list[Threshold]()
    known = catalogue.by_name
    for text in when:
        name, equals, number = text.rpartition("=") if isinstance(text, str) else ("", "", "")
        try:
            value = float(number)
        except ValueError:
            value = math.nan
        if not (equals and name.strip() and math.isfinite(value)):
            raise InputError(
                f'found {text!r}; it must be a name and a number, such as "bolts[1].reaction = -203e3".', place="when"
            )
        quantity = re.sub(r"\s*([\[\].])\s*", r"\1", name.strip())
        # The name of a punched column or a check alone stands for its utilisation.
        quantity = whole if (whole := f"{quantity}.utilisation") in known else quantity
        if quantity not in known:
            raise InputError(unknown("quantity", quantity, known), place="when")
        if (check := catalogue.numbers[known[quantity]].check) is not None:
            require_measured(discretisation, catalogue, "a load path", check)
        asked.append(Threshold(text.strip(), quantity, value))
    return tuple(asked)


def first_reached(threshold: Threshold, stops: Sequence[PathStop]) -> Threshold:
    """Return a copy of the threshold with the t of the first stop at which the quantity reaches or passes the value."""
    numbers = [stop.number(threshold.quantity) for stop in stops]
    beyond = [threshold.margin(number, numbers[0] > threshold.value) >= 0.0 for number in numbers]
    row = next((row for row in range(1, len(stops)) if beyond[row] != beyond[0]), None)
    return threshold if row is None else replace(threshold, t=stops[row].t)
