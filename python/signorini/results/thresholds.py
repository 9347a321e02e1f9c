"""Thresholds on a load path: the t at which a result that has a name comes to a value."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from signorini.discretise import Discretisation
from signorini.errors import InputError, unknown
from signorini.results.path_stop import PathStop, listed_points
from signorini.results.section_result import columns_of

_SMOOTH = ("contact_area", "max_pressure", "closed_part")
"""Quantities that are not linear in t on one contact set."""


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
        return not self.quantity.endswith(_SMOOTH)


def quantities(found: Discretisation) -> Mapping[str, Callable[[PathStop], float]]:
    """Every result of a stop by its name: of supports, their points, probes, sections, strips and the whole plate.

    Examples
    --------
    >>> from signorini import Model
    >>> from signorini.discretise import discretise
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.2},
    ...     mesh={"divisions": [2, 2]},
    ...     support=[{"name": "feet", "at": [[1, 1], [3, 3]], "resists": "down"}],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> sorted(quantities(discretise(model)))[:4]
    ['deflection.max', 'deflection.min', 'feet.closed_part', 'feet.reaction']
    """
    model = found.model
    known: dict[str, Callable[[PathStop], float]] = {
        "deflection.max": lambda stop: stop.largest,
        "deflection.min": lambda stop: stop.smallest,
    }
    for i, support in enumerate(model.support):
        known[f"{support.name}.reaction"] = _of("reactions", i)
        known[f"{support.name}.closed_part"] = _of("parts", i)
        if support.area is not None:
            known[f"{support.name}.contact_area"] = _of("contact_areas", i)
            known[f"{support.name}.max_pressure"] = _of("max_pressures", i)
    for i, one in enumerate(listed_points(found)):
        name = f"{model.support[one.support].name}[{one.point}]"
        known |= {f"{name}.reaction": _of("at_points", i), f"{name}.gap": _of("gaps", i)}
    known |= {f"probe[{i + 1}].deflection": _of("deflections", i) for i in range(len(found.probe_positions))}
    for i, column in enumerate(columns_of(model)):
        known[".".join(column.rsplit(":", 1))] = _of("through", i)
    return known


def _of(array: str, index: int) -> Callable[[PathStop], float]:
    return lambda stop: float(getattr(stop, array)[index])


def thresholds(found: Discretisation, when: Sequence[str]) -> tuple[Threshold, ...]:
    """Read what is asked for.

    Raises
    ------
    InputError
        If a text is no equation of a name and a number, or no result has the name.
    """
    if isinstance(when, str) or not isinstance(when, Sequence):
        raise InputError('it must be a list of texts such as ["bolts[1].reaction = 203e3"].', place="when")
    known, asked = quantities(found), []
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


def first_reached(found: Discretisation, threshold: Threshold, stops: Sequence[PathStop]) -> Threshold:
    """Say at which stop a quantity first comes to the value of a threshold, or has gone past it."""
    of = quantities(found)[threshold.quantity]
    beyond = [of(stop) >= threshold.value for stop in stops]
    row = next((row for row in range(1, len(stops)) if beyond[row] != beyond[0]), None)
    return threshold if row is None else replace(threshold, t=stops[row].t)
