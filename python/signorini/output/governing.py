"""Which combinations give the largest and the smallest reaction of each bearing, and what the others do in them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from signorini.analysis.solve import Results
from signorini.results.columns import Bearing


@dataclass(frozen=True)
class Governing:
    """One extreme of one bearing: the combination, and the reactions of all bearings in it, in their order.

    Parameters
    ----------
    bearing : Bearing
    largest : bool
    combination : str
    own : float
    reactions : tuple of float
    widths : tuple of float or None
        The half-widths of ``reactions``; all None where there are none.
    """

    bearing: Bearing
    largest: bool
    combination: str
    own: float
    reactions: tuple[float, ...]
    widths: tuple[float | None, ...]


def governing_reactions(results: Results, group: str = "") -> list[Governing]:
    """Give the extremes of every bearing, the largest before the smallest; of equals the first combination's.

    Over a group of combinations, or over all; none where none of them has an equilibrium.
    """
    if group and group not in results.groups:
        return []
    bearings, found = results.combined.layout.bearings, results.combined.over(group).bearings
    columns = [bearing.column(results.model) for bearing in bearings]
    sides = (
        (True, found.extremes.largest_by, found.with_largest),
        (False, found.extremes.smallest_by, found.with_smallest),
    )
    out = []
    for at, bearing in enumerate(bearings):
        for largest, by, beside in sides:
            row = int(by[at])
            widths = tuple(results.half_width(column, row) for column in columns)
            reactions = tuple(beside[at].tolist())
            out.append(Governing(bearing, largest, results.key(row), reactions[at], reactions, widths))
    return out


def governing_json(results: Results, group: str = "") -> list[dict[str, Any]]:
    """Give the key "governing_reactions" of results.json, or of a group."""
    model = results.model
    every = governing_reactions(results, group)
    told = any(width is not None for one in every for width in one.widths)
    return [
        {
            "support": model.support[high.bearing.support].name,
            "point": high.bearing.point,
            "at": None if high.bearing.at is None else list(high.bearing.at),
            **_side("max", high),
            **_side("min", low),
            "plus_minus": _widths("max", at, high) | _widths("min", at, low) if told else None,
        }
        for at, (high, low) in enumerate(zip(every[::2], every[1::2], strict=True))
    ]


def _side(side: str, one: Governing) -> dict[str, Any]:
    return {side: one.own, f"{side}_by": one.combination, f"{side}_with": list(one.reactions)}


def _widths(side: str, at: int, one: Governing) -> dict[str, Any]:
    return {side: one.widths[at], f"{side}_with": list(one.widths)}
