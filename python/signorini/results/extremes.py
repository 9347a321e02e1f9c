"""Largest and smallest values of fields over the nodes, away from where they have no limit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from signorini.discretise.rows import Bools, Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.results.quantities import FIELDS, PEAKING, TOLD
from signorini.singularities.singularity import Singularity, away_from

_ALIKE = 1e-9
"""Part of a field's size, and of the distance between places, within which numbers differ by rounding."""


def peak(values: Floats, places: Floats) -> int:
    """Which of values (n,) is the largest; of those alike but for rounding that at the least x, and then y.

    Places are (n, 2). Values of minus infinity do not count.

    Examples
    --------
    >>> peak(np.array([1.0, 3.0 - 1e-12, 3.0]), np.array([[0.0, 0.0], [1.0, 1.0], [2.0, 1.0]]))
    1
    """
    size = float(np.abs(values[np.isfinite(values)]).max(initial=0.0))
    near = np.flatnonzero(values >= values.max() - _ALIKE * size)
    if len(near) == 1:
        return int(near[0])
    alike = places[near] - places[near].min(axis=0)
    x, y = np.round(alike / (_ALIKE * max(float(alike.max()), 1e-300))).T
    return int(near[np.lexsort((y, x))[0]])


@dataclass(frozen=True)
class FieldExtremes:
    """Extremes of a field over the nodes; of places alike but for rounding that of the least x, and then y."""

    max: float
    max_at: tuple[float, float]
    # the singularity at which the field is larger still, or smaller, and has no limit; empty where there is none
    max_beside: str
    min: float
    min_at: tuple[float, float]
    min_beside: str

    @classmethod
    def of(
        cls, values: Floats, nodes: StressNodes, away: Bools, singular: Sequence[Singularity] = (), number: str = ""
    ) -> FieldExtremes:
        """Find the extremes of a field at nodes of the mesh (n,) that are ``away`` from singularities of its number."""
        places, counting = nodes.points[: len(values)], nodes.counting(len(values)) & ~np.isnan(values)
        if not counting.any():
            nowhere = (math.nan, (math.nan, math.nan), "")
            return cls(*nowhere, *nowhere)
        away = away[nodes.nodes[: len(values)]] & counting
        away = away if away.any() else counting
        ends: list[tuple[float, tuple[float, float], str]] = []
        for signed in (values, -values):
            own, highest = np.where(away, signed, -np.inf), int(np.where(counting, signed, -np.inf).argmax())
            x, y = places[peak(own, places)].tolist()
            beside = "" if away[highest] else _nearest(places[highest], singular, number)
            ends.append((float(values[own.argmax()]), (x, y), beside))
        return cls(*ends[0], *ends[1])


def of_plates(each: Sequence[Mapping[str, FieldExtremes]]) -> dict[str, FieldExtremes]:
    """The extremes over several plates."""
    result = {}
    for name in each[0]:
        most, least = (
            max((of[name] for of in each), key=lambda one: one.max),
            min((of[name] for of in each), key=lambda one: one.min),
        )
        result[name] = replace(most, min=least.min, min_at=least.min_at, min_beside=least.min_beside)
    return result


def extremes(
    fields: Mapping[str, Floats], nodes: StressNodes, singular: Sequence[Singularity]
) -> dict[str, FieldExtremes]:
    """Find the extremes of the deflection, and of what moments and shears make away from where these have no limit."""
    numbers = {name: one.singular if name in PEAKING else "" for name, one in FIELDS.items() if name in TOLD}
    away = {number: away_from(nodes.mesh, singular, number) for number in dict.fromkeys(numbers.values())}
    return {
        name: FieldExtremes.of(fields[name], nodes, away[number], singular, number) for name, number in numbers.items()
    }


def _nearest(at: Floats, singular: Sequence[Singularity], number: str) -> str:
    """What singularity of a number is nearest."""
    those = [one for one in singular if number in one.numbers and one.where and not (one.line or one.limited)]
    return min(those, key=lambda one: min(math.dist(at, place) for place in one.where)).what
