"""Thresholds on a load path: the t at which a result that has a name comes to a value."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from signorini.discretise import Discretisation
from signorini.errors import InputError, unknown
from signorini.results.path_stop import PathStop, numbers_at_stops
from signorini.results.quantities import SMOOTH


@dataclass(frozen=True)
class Threshold:
    """A result that is to be found at a value.

    Parameters
    ----------
    when : str
        As it was asked for: ``"bolts[1].reaction = 203e3"``.
    quantity : str
        Its name.
    value : float
    t : float or None
        Where it first comes to the value; None where it does not on the path.
    """

    when: str
    quantity: str
    value: float
    t: float | None = None

    @property
    def linear(self) -> bool:
        """Whether the quantity is linear in t as long as nothing opens or closes."""
        return self.quantity.rpartition(".")[-1] not in SMOOTH


def thresholds(discretisation: Discretisation, when: Sequence[str]) -> tuple[Threshold, ...]:
    """Read what is asked for.

    Raises
    ------
    InputError
        If a text is no equation of a name and a number, or no result has the name.
    """
    if isinstance(when, str) or not isinstance(when, Sequence):
        raise InputError('it must be a list of texts such as ["bolts[1].reaction = 203e3"].', place="when")
    known, asked = numbers_at_stops(discretisation).by_name, []
    for text in when:
        name, equals, number = text.rpartition("=") if isinstance(text, str) else ("", "", "")
        try:
            value = float(number)
        except ValueError:
            value = math.nan
        if not (equals and name.strip() and math.isfinite(value)):
            raise InputError(
                f'found {text!r}; it must be a name and a number, such as "bolts[1].reaction = 203e3".', place="when"
            )
        quantity = re.sub(r"\s*([\[\].])\s*", r"\1", name.strip())
        if quantity not in known:
            raise InputError(unknown("quantity", quantity, known), place="when")
        asked.append(Threshold(text.strip(), quantity, value))
    return tuple(asked)


def first_reached(threshold: Threshold, stops: Sequence[PathStop]) -> Threshold:
    """Say at which stop a quantity first comes to the value of a threshold, or has gone past it."""
    beyond = [stop.number(threshold.quantity) >= threshold.value for stop in stops]
    row = next((row for row in range(1, len(stops)) if beyond[row] != beyond[0]), None)
    return threshold if row is None else replace(threshold, t=stops[row].t)
