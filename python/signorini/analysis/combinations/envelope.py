"""The largest and the smallest of many combinations, and which combinations they come from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signorini import _core
from signorini.discretise.rows import Floats, Ints

NONE = -1
"""Number of no combination."""


@dataclass(frozen=True, eq=False)
class Extremes:
    """Largest and smallest values (n,) met so far, with the numbers of the combinations, of equals the first."""

    largest: Floats
    largest_by: Ints
    smallest: Floats
    smallest_by: Ints

    @classmethod
    def none(cls, size: int) -> Extremes:
        """Nothing met yet."""
        who = np.full(size, NONE, dtype=np.int64)
        return cls(np.full(size, -np.inf), who, np.full(size, np.inf), who.copy())

    def take(self, values: Floats, who: Ints) -> None:
        """Meet values (k, n) of combinations (k,)."""
        if not values.size:
            return
        columns = np.arange(values.shape[1])
        for bound, by, at, sign in (
            (self.largest, self.largest_by, values.argmax(axis=0), 1.0),
            (self.smallest, self.smallest_by, values.argmin(axis=0), -1.0),
        ):
            found = values[at, columns]
            better = sign * found > sign * bound
            bound[better], by[better] = found[better], who[at[better]]

    def take_sums(self, coefficients: Floats, vectors: Floats, who: Ints) -> tuple[Floats, Ints]:
        """Meet sums of vectors (b, n) with coefficients (k, b); return each one's extremes and their places (k, 2)."""
        return _core.envelop(coefficients, vectors, who, self.largest, self.largest_by, self.smallest, self.smallest_by)


@dataclass(frozen=True, eq=False)
class SupportEnvelope:
    """Extremes of one support.

    Parameters
    ----------
    reaction : Extremes
        Of its total (1,).
    points : Extremes
        Of the reaction of every point (p,).
    gap : Extremes
        Of what is left of the travel of every point (p,); the largest is by the combination that lifts it most.
    lifted : (p,) array
        In how many combinations the point is open.
    pressure : Extremes
        Of an area, the pressures at its points and, if it is elastic, its nodes behind them; else none.
    places : (q, 2) array
        Where these are.
    """

    reaction: Extremes
    points: Extremes
    gap: Extremes
    lifted: Ints
    pressure: Extremes
    places: Floats


@dataclass(frozen=True, eq=False)
class Envelope:
    """Extremes over all combinations that were solved.

    Parameters
    ----------
    fields : dict of Extremes
        At every node (n,), by the field's name.
    pressures : dict
        "contact_pressure" at the nodes of elastic areas, "rigid_contact_pressure" on the elements of rigid ones: which
        nodes or elements (k,), and the extremes there.
    supports : tuple of SupportEnvelope
        In the order of the model.
    probes : Extremes
        Of every field at every probe, (8q,).
    """

    fields: dict[str, Extremes]
    pressures: dict[str, tuple[Ints, Extremes]]
    supports: tuple[SupportEnvelope, ...]
    probes: Extremes

    def governing(self) -> dict[str, tuple[float, int, float, int]]:
        """Largest value, by which combination, smallest value, and by which; of fields and of supports' reactions.

        Keys are names of fields, and "reaction:" with a support's place in the model.
        """
        found = {}
        for name, extremes in self.fields.items():
            high, low = int(extremes.largest.argmax()), int(extremes.smallest.argmin())
            found[name] = (
                float(extremes.largest[high]),
                int(extremes.largest_by[high]),
                float(extremes.smallest[low]),
                int(extremes.smallest_by[low]),
            )
        for index, support in enumerate(self.supports):
            total = support.reaction
            found[f"reaction:{index}"] = (
                float(total.largest[0]),
                int(total.largest_by[0]),
                float(total.smallest[0]),
                int(total.smallest_by[0]),
            )
        return found
