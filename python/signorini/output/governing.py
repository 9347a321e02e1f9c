"""Which combinations give the largest and the smallest reaction of each bearing, and what the others do in them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from signorini.analysis.combinations import Bearing, Concurrent, Layout
from signorini.analysis.solve import Results


@dataclass(frozen=True)
class Governing:
    """One extreme of one bearing: the combination, and the reactions of all bearings in it, in their order."""

    bearing: Bearing
    largest: bool
    combination: str
    own: float
    reactions: tuple[float, ...]


def governing_reactions(results: Results) -> list[Governing]:
    """Give the extremes of every bearing, the largest before the smallest; of equals the first combination's."""
    combined = results.combined
    if combined is not None:
        layout, found = combined.layout, combined.envelope.bearings
        names = {by: combined.name(by) for by in (*found.extremes.largest_by, *found.extremes.smallest_by)}
    else:
        solved = [result for result in results.values() if result.status == "solved"]
        layout, names = Layout.of(results.discretisation, ()), {at: one.name for at, one in enumerate(solved)}
        found = Concurrent.none(len(layout.bearings))
        reactions = [np.concatenate([np.zeros(0), *(s.reactions for s in one.supports)]) for one in solved]
        found.take(layout.of_bearings(np.array(reactions)), np.arange(len(solved)))
    sides = (
        (True, found.extremes.largest_by, found.with_largest),
        (False, found.extremes.smallest_by, found.with_smallest),
    )
    return [
        Governing(bearing, largest, names[int(by[at])], float(beside[at, at]), tuple(beside[at].tolist()))
        for at, bearing in enumerate(layout.bearings)
        for largest, by, beside in sides
    ]


def governing_json(results: Results) -> list[dict[str, Any]]:
    """Give the key "governing_reactions" of results.json."""
    model = results.discretisation.model
    every = governing_reactions(results)
    return [
        {
            "support": model.support[high.bearing.support].name,
            "point": high.bearing.point,
            "at": None if high.bearing.at is None else list(high.bearing.at),
            **_side("max", high),
            **_side("min", low),
        }
        for high, low in zip(every[::2], every[1::2], strict=True)
    ]


def _side(side: str, one: Governing) -> dict[str, Any]:
    return {side: one.own, f"{side}_by": one.combination, f"{side}_with": list(one.reactions)}
