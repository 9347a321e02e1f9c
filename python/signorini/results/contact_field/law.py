"""The law of an elastic area: from deflection to pressure, and to how far the plate is from it."""

from __future__ import annotations

import numpy as np

from signorini.discretise.rows import Floats
from signorini.errors import InputError
from signorini.expression import Expression
from signorini.model import Support


def bounds(support: Support) -> tuple[float, float]:
    """Least and greatest pressure that the support can exert, positive up."""
    return {"down": (0.0, np.inf), "up": (-np.inf, 0.0)}.get(support.resists or "both", (-np.inf, np.inf))


def pressing(support: Support, deflection: Floats, positions: Floats) -> Floats:
    """Pressure (q,) of an elastic area for deflections (q,) at positions (q, 2), positive up, one-sided or not.

    A one-sided support exerts the part of it within its `bounds`. The rest says how far the plate is from the support,
    so the edge of contact is where this is zero. NaN where the input's expressions have no value.

    Examples
    --------
    >>> soil = Support(area="all", resists="down", stiffness=1e3, gap=0.25)
    >>> pressing(soil, np.array([1.0, 0.0]), np.zeros((2, 2)))
    array([ 750., -250.])
    """
    assert support.stiffness is not None
    down, up = _beyond_gap(deflection, free_travel(support, positions))
    both = np.maximum(down, 0.0) - np.maximum(up, 0.0)
    travel = {"down": down, "up": -up}.get(support.resists or "both", both)
    return np.asarray(_values(support.stiffness, positions) * travel)


def free_travel(support: Support, positions: Floats) -> tuple[Floats, Floats]:
    """Settlement and gap (q,) of an elastic area at positions (q, 2); NaN where an expression has no value."""
    return _values(support.settlement, positions), _values(support.gap, positions)


def overlap(support: Support, deflection: Floats, travel: tuple[Floats, Floats]) -> Floats:
    """How far (..., q) the plate is pressed into the support, given its free travel; where negative, the gap."""
    down, up = _beyond_gap(deflection, travel)
    return {"down": down, "up": up}.get(support.resists or "both", np.maximum(down, up))


def _beyond_gap(deflection: Floats, travel: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    """How far the plate has gone beyond the free travel, down and up."""
    settlement, gap = travel
    moved = deflection - settlement
    return moved - gap, -moved - gap


def _values(expression: Expression, positions: Floats) -> Floats:
    """Values (q,) of an expression, NaN where it has none: it need have one only where the support acts."""
    try:
        return expression(*positions.T)
    except InputError:
        if len(positions) == 1:
            return np.array([np.nan])
        half = len(positions) // 2
        return np.concatenate([_values(expression, positions[:half]), _values(expression, positions[half:])])
