"""Largest and smallest values of fields over the nodes, away from where they have no limit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from signorini.discretise.rows import Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.singularities.named import Singularity, away_from

NUMBERS = {"mx": "moment", "my": "moment", "mxy": "moment", "qx": "shear", "qy": "shear"}
"""What singularities call the fields that have peaks at them. Deflections grow too slowly for one."""


@dataclass(frozen=True)
class FieldExtremes:
    """Extremes of a field over the nodes.

    Parameters
    ----------
    max, min : float
    max_at, min_at : (x, y)
    max_beside, min_beside : str
        The singularity at which the field is larger still, or smaller, and has no limit; empty where there is none.
    """

    max: float
    max_at: tuple[float, float]
    max_beside: str
    min: float
    min_at: tuple[float, float]
    min_beside: str

    @classmethod
    def of(cls, field: str, values: Floats, nodes: StressNodes, singular: Sequence[Singularity]) -> FieldExtremes:
        """Find the extremes of a field, away from singularities that leave it without a limit."""
        number = NUMBERS.get(field, "")
        places = nodes.points[: len(values)]
        away = away_from(nodes.mesh, singular, number)[nodes.nodes[: len(values)]]
        ends: list[tuple[float, tuple[float, float], str]] = []
        for signed in (values, -values):
            node, peak = int(np.where(away, signed, -np.inf).argmax()), int(signed.argmax())
            x, y = places[node].tolist()
            beside = "" if away[peak] else _nearest(places[peak], singular, number)
            ends.append((float(values[node]), (x, y), beside))
        return cls(*ends[0], *ends[1])


def _nearest(at: Floats, singular: Sequence[Singularity], number: str) -> str:
    """What singularity of a number is nearest."""
    those = [one for one in singular if number in one.numbers and one.where and not one.line]
    return min(those, key=lambda one: min(math.dist(at, place) for place in one.where)).what
