"""Which combinations give the largest and the smallest reaction of each bearing, and what the others do in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from signorini.analysis.solve import Results
from signorini.results.columns import Bearing

Widths = Mapping[str, Any] | None
"""Half-widths of a combination, or of an envelope, as in results.json; None where there are none."""


@dataclass(frozen=True)
class Governing:
    """One extreme of one bearing: the combination, and the reactions of all bearings in it, in their order."""

    bearing: Bearing
    largest: bool
    combination: str
    own: float
    reactions: tuple[float, ...]


def governing_reactions(results: Results, group: str = "") -> list[Governing]:
    """Give the extremes of every bearing, the largest before the smallest; of equals the first combination's.

    Over a group of combinations, or over all; none where none of them has an equilibrium.
    """
    if group and group not in results.groups:
        return []
    bearings, found = results.combined.layout.bearings, results.combined.over(group).bearings
    sides = (
        (True, found.extremes.largest_by, found.with_largest),
        (False, found.extremes.smallest_by, found.with_smallest),
    )
    return [
        Governing(bearing, largest, results.key(int(by[at])), float(beside[at, at]), tuple(beside[at].tolist()))
        for at, bearing in enumerate(bearings)
        for largest, by, beside in sides
    ]


def governing_json(results: Results, group: str = "", envelope: Widths = None) -> list[dict[str, Any]]:
    """Give the key "governing_reactions" of results.json, or of a group; with the half-widths of rows' envelope."""
    model = results.discretisation.model
    every = governing_reactions(results, group)
    return [
        {
            "support": model.support[high.bearing.support].name,
            "point": high.bearing.point,
            "at": None if high.bearing.at is None else list(high.bearing.at),
            **_side("max", results, high, envelope),
            **_side("min", results, low, envelope),
        }
        for high, low in zip(every[::2], every[1::2], strict=True)
    ]


def half_widths_of(results: Results, one: Governing, envelope: Widths) -> tuple[Widths, tuple[str | int, ...]]:
    """Half-widths among which is that of what a bearing itself does where it governs, and the keys that lead to it.

    Of rows of a table these are those of their envelope, else those of the combination.
    """
    point, tabulated = one.bearing.point, results.model.tabulated
    path = ("supports", one.bearing.support, *(() if point is None else ("points", point - 1)), "reaction")
    if tabulated:
        return envelope, (*path, "max" if one.largest else "min")
    return results.full[one.combination].asked_estimate.plus_minus, path


def _side(side: str, results: Results, one: Governing, envelope: Widths) -> dict[str, Any]:
    widths, path = half_widths_of(results, one, envelope)
    width: Any = widths
    for key in path if widths is not None else ():
        width = width[key]
    found = {side: one.own, f"{side}_plus_minus": width, f"{side}_by": one.combination}
    return found | {f"{side}_with": list(one.reactions)}
