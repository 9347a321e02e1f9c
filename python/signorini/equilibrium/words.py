"""Why no reactions balance a load, in words."""

from __future__ import annotations

from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.equilibrium.imbalance import Imbalance
from signorini.errors import length, point

_MOST_HINGES = 4
"""Points of a support that a plate tips about."""


def explain(discretisation: Discretisation, why: Imbalance | None) -> str:
    """Say why no reactions balance a load, what would, or nothing where they exist."""
    if why is None:
        return ""
    force = discretisation.model.units.force
    unit = f" {force}" if force else ""
    text = _lifting(why, unit) if why.axis is None else _tipping(discretisation, why, unit)
    if why.holding is not None:
        at = point(why.holding.at, discretisation.mesh.size)
        text += f" An extra {why.holding.force:.6g}{unit} {why.holding.way} at {at} would just hold it."
    if why.limit is not None:
        case, factor = why.limit
        text += f' With the case "{case}" at {factor:.4g} times its factor it would just stand.'
    return text


def _lifting(why: Imbalance, unit: str) -> str:
    verb = "lifts off" if why.way == "up" else "drops away from"
    return (
        f"The plate {verb} its supports: the load's resultant is {abs(why.resultant):.6g}{unit} {why.way}, and no "
        "support resists that way."
    )


def _tipping(discretisation: Discretisation, why: Imbalance, unit: str) -> str:
    assert why.axis is not None
    size, owners = discretisation.mesh.size, dict[str, dict[str, None]]()
    for at, support in zip(why.hinges, why.supports, strict=True):
        owners.setdefault(point(at, size), {})[discretisation.model.support[support].name] = None
    alike: dict[str, list[str]] = {}
    for spot, names in owners.items():
        alike.setdefault(" and ".join(names), []).append(spot)
    through = ", ".join(
        f"{', '.join(spots[:_MOST_HINGES])}{', ...' if len(spots) > _MOST_HINGES else ''} of {names}"
        for names, spots in alike.items()
    )
    hinges = f" through {through}" if through else ""
    moment_unit = f"{unit} {discretisation.model.units.length}".rstrip() if unit else ""
    line = line_in_words(why.axis.normal, why.axis.offset, size)
    return f"The plate tips about the line {line}{hinges}, short by a moment of {why.moment:.6g}{moment_unit}."


def line_in_words(normal: Floats, offset: float, size: float) -> str:
    """Equation of the line normal · x + offset = 0 on a plate of some size, the larger of its coefficients one.

    Examples
    --------
    >>> import numpy as np
    >>> line_in_words(np.array([-0.6, -0.8]), 1.6, 4.0)
    '0.75 x + y = 2'
    >>> line_in_words(np.array([1.0, 1e-17]), 1e-16, 4.0)
    'x = 0'
    """
    leading = int(abs(normal[1]) > abs(normal[0]) * (1 + 1e-9))
    a, b = (round(float(part / normal[leading]), 9) for part in normal)
    equals = length(-offset / normal[leading], size)
    if a == 0.0 or b == 0.0:
        return f"{'xy'[leading]} = {equals}"
    first = "x" if a == 1.0 else f"{a:.6g} x"
    second = "y" if abs(b) == 1.0 else f"{abs(b):.6g} y"
    return f"{first} {'+' if b > 0 else '-'} {second} = {equals}"
