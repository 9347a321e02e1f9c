"""Numbers, points and units the way the terminal shows them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from signorini.base.numbers import estimated, number

UNKNOWN = "± ?"
UNSETTLED = f"{UNKNOWN}: does not settle from mesh to mesh, near what is named below as singular or unresolved"


def cell(
    value: float, widths: Mapping[str, Any] | None, path: Sequence[str | int], largest: float = 0.0, digits: int = 6
) -> str:
    """Write a number, with its half-width where there are any."""
    if widths is None:
        return number(value, largest, digits)
    result: Any = widths
    for part in path:
        result = result[part]
    return estimated(value, result, largest, digits)


def in_contact(name: str, part: str, value: float, whole: float, what: str, unit: str) -> str:
    """Say on which part of its length or area a support holds.

    Examples
    --------
    >>> in_contact("soil", "209.021 ± 0.026", 209.021, 216.0, "area", " m²")
    'soil: in contact on 96.8 % of its area, 209.021 ± 0.026 of 216 m²'

    Where others hold the plate all over a support, it has no points of its own:

    >>> in_contact("ring", "0", 0.0, 0.0, "length", " m")
    'ring: others hold the plate all over it'
    """
    if not whole:
        return f"{name}: others hold the plate all over it"
    return f"{name}: in contact on {min(100.0, 100.0 * value / whole):.3g} % of its {what}, {part} of {whole:.6g}{unit}"


def in_unit(unit: str) -> str:
    """Write a unit behind a title."""
    return f" [{unit}]" if unit else ""


def unit_of(length: str, power: int = 1) -> str:
    """Write a unit behind a number."""
    return f" {length}{'²' if power == 2 else ''}" if length else ""
