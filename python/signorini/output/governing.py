"""Governing combinations: extremes of each bearing, with the reactions of all bearings in the same combination.

A bearing is a point of a support or a whole support (`signorini.results.rows.Bearing`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from signorini.analysis.estimate import Estimates
from signorini.analysis.results import Results
from signorini.output.names import csv_text, name_cell
from signorini.results.rows import Bearing


@dataclass(frozen=True)
class Governing:
    """One extreme of a bearing, its combination, and the reactions of all bearings in that combination."""

    bearing: Bearing
    what: str  # quantity: "reaction", "gap", "max_pressure" or "contact_area"
    largest: bool
    combination: str
    own: float
    own_width: float | None  # half-width of the extreme ``own``
    reactions: tuple[float, ...]
    widths: tuple[float | None, ...]  # half-widths of ``reactions``; None without estimate


def governing_reactions(results: Results, estimates: Estimates | None, group: str = "") -> list[Governing]:
    """Largest, then smallest reaction of each bearing over a group; ``group=""`` is all combinations."""
    return [one for one in governing(results, estimates, group) if one.what == "reaction"]


def governing(results: Results, estimates: Estimates | None, group: str = "") -> list[Governing]:
    """Extremes of each bearing: reaction as in `governing_reactions`, then gap, pressure and contact area."""
    if not results.combined.any_solved(group):
        return []
    layout, model, envelope = results.combined.layout, results.model, results.combined.over(group)
    columns, of = [bearing.column(model) for bearing in layout.bearings], envelope.values

    def width(column: str, row: int) -> float | None:
        return None if estimates is None else estimates.half_width(column, row)

    out = []
    for at, (place, (what, bearing)) in enumerate(zip(layout.governed_places, layout.governed, strict=True)):
        for largest, (extreme, by), beside in zip((True, False), of.sides, envelope.beside, strict=True):
            row = int(by[place])
            widths = tuple(width(column, row) for column in columns)
            own, reactions = float(extreme[place]), tuple(beside[at].tolist())
            own_width = width(bearing.column(model, what), row)
            out.append(Governing(bearing, what, largest, results.key(row), own, own_width, reactions, widths))
    return out


def governing_csv(results: Results, estimates: Estimates | None) -> str:
    """Extremes of every bearing as comma-separated values, over all combinations and over each group.

    Each row has an extreme: its value, its half-width, its combination, and the reactions of all bearings in that
    combination with half-widths. Points that open have a row with their largest gap.
    """
    model, rows = results.model, []
    columns = [bearing.column(model) for bearing in results.combined.layout.bearings]
    own = ("group", "support", "point", "x", "y", "what", "extreme", "value", "value:plus_minus", "combination")
    for group in ("", *model.effective_combinations.groups):
        for one in governing(results, estimates, group):
            if one.what == "gap" and not (one.largest and one.own > 0.0):
                continue
            support, (x, y) = model.support[one.bearing.support].name, one.bearing.at or ("", "")
            where = (name_cell(group), name_cell(support), one.bearing.point, x, y)
            extreme = (one.what, "max" if one.largest else "min", one.own, one.own_width, name_cell(one.combination))
            rows.append([*where, *extreme, *one.reactions, *one.widths])
    return csv_text([*own, *columns, *(f"{column}:plus_minus" for column in columns)], rows)


def governing_json(results: Results, estimates: Estimates | None, group: str = "") -> list[dict[str, Any]]:
    """Return the value of the key "governing_reactions" in results.json, for all combinations or a group."""
    model = results.model
    every = governing_reactions(results, estimates, group)
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
