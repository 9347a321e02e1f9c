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
    found: Any = widths
    for part in path:
        found = found[part]
    return estimated(value, found, largest, digits)


def of_whole(part: str, value: float, whole: float, unit: str) -> str:
    """Write a part of a length or area, beside it what it is of.

    Examples
    --------
    >>> of_whole("209.021 ± 0.026", 209.021, 216.0, " m²")
    '209.021 ± 0.026 of 216 m² (96.8 %)'

    Where others hold the plate all over a support, it has no points of its own:

    >>> of_whole("0", 0.0, 0.0, " m²")
    '0 of 0 m²'
    """
    share = f" ({min(100.0, 100.0 * value / whole):.3g} %)" if whole else ""
    return f"{part} of {whole:.6g}{unit}{share}"


def in_unit(unit: str) -> str:
    """Write a unit behind a title."""
    return f" [{unit}]" if unit else ""


def unit_of(length: str, power: int = 1) -> str:
    """Write a unit behind a number."""
    return f" {length}{'²' if power == 2 else ''}" if length else ""
