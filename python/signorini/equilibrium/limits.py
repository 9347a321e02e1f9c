"""How near a combination is to the end of its equilibrium, and what would bring it there or back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from signorini.base.linear_program import minimise
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.equilibrium.balance import Bearing, RigidFreedom, load_size, work_of
from signorini.equilibrium.imbalance import Imbalance, imbalance
from signorini.model import Combination

_MOST = 1e6
"""Times a case's factor beyond which it counts as without limit."""
_ALIKE = 1e-9
"""Ratio of limits, less one, that is rounding."""
_OVERLAP = 1e-7
"""Part of the largest travel by which rigid supports must overlap to contradict each other."""
_BRINK = 1e-9
"""Part of the load that must be to spare at every support for the plate not to be on the brink."""
CONTRADICTION = (
    "The rigid supports contradict each other: no deflection of the plate agrees with all their gaps and settlements. "
    "Reactions that balance the load exist. Correct a gap or a settlement, or give a stiffness."
)
"""What there is to say where `supports_contradict`."""


def imbalance_of(discretisation: Discretisation, freedom: RigidFreedom, combination: Combination) -> Imbalance | None:
    """Find out why no reactions balance a combination, with the case that would let it stand; None where they do."""
    why = imbalance(discretisation, freedom, discretisation.load(combination).weighing)
    return None if why is None else replace(why, limit=nearest_limit(discretisation, freedom, combination))


def nearest_limit(
    discretisation: Discretisation, freedom: RigidFreedom, combination: Combination
) -> tuple[str, float] | None:
    """Find the case, and the factor on top of its own, by which the combination comes to the limit of equilibrium.

    All other cases stay as they are. Of several the nearest to 1 in ratio, of equally near ones the case that the
    combination names last. Reactions of one-sided supports make a cone, so a load alone has no limit: where it can be
    balanced, any multiple of it can. None where no case on its own has a limit, or where the combination is out of
    balance and none brings it back.
    """
    acting = {case: factor for case, factor in (combination.factors or {}).items() if factor != 0.0}
    nodal = {case: factor * discretisation.cases[case].weighing for case, factor in acting.items()}
    whole = discretisation.load(combination).weighing
    if len(acting) < 2 or not freedom.count or not whole.any():
        return None
    limits = [
        (case, limit)
        for case in acting
        for limit in _limits(discretisation, freedom, freedom.outline, whole - nodal[case], nodal[case])
        if 1 / _MOST < limit < _MOST
    ]
    # Two cases have each other's limit upside down, and rounding must not choose between them.
    return min(reversed(limits), key=lambda pair: round(abs(np.log(pair[1])) / _ALIKE), default=None)


def on_the_brink(discretisation: Discretisation, freedom: RigidFreedom, nodal: Floats) -> bool:
    """Whether a load that can be balanced no longer could be if it moved, however little, some way."""
    total = load_size(discretisation, nodal)
    if not freedom.count or total == 0:
        return False
    one_sided = freedom.outline.moves
    # Reactions with as much as can be to spare at all of them: the first unknown.
    cost = np.append(-1.0, np.zeros(len(one_sided)))
    spare = np.column_stack([np.ones(len(one_sided)), -np.eye(len(one_sided))])
    balance = np.column_stack([np.zeros(freedom.count), one_sided.T])
    wanted = work_of(discretisation, freedom, nodal) / total
    none, beyond = np.zeros(len(one_sided)), np.full(len(one_sided), np.inf)
    bound = np.concatenate([-beyond, wanted]), np.concatenate([none, wanted])
    most = minimise(cost, np.vstack([spare, balance]), bound, (0.0, np.append(1.0, beyond)))
    return most is not None and bool(most[0] <= _BRINK)


def floats(discretisation: Discretisation, freedom: RigidFreedom, *loads: Floats) -> bool:
    """Whether no nodal load (3n,) of these, be it none, does work in a motion that one-sided supports alone hold."""
    sizes = [
        (np.abs(work_of(discretisation, freedom, nodal)).max(initial=0.0), load_size(discretisation, nodal))
        for nodal in loads
    ]
    return freedom.count > 0 and all(work <= _BRINK * size for work, size in sizes)


def supports_contradict(discretisation: Discretisation) -> bool:
    """Whether no deflection of the plate agrees with all rigid supports: a linear program for the least overlap."""
    from scipy.sparse import csr_array, hstack, vstack

    contacts, held = discretisation.contacts, discretisation.held
    rigid = contacts.compliance == 0
    rows = csr_array(discretisation.contact_rows[np.flatnonzero(rigid)])
    distance = contacts.distance[rigid] - rows @ held.values
    size = float(np.abs(distance).max(initial=0.0))
    if size == 0.0:
        return False
    moving = np.unique(rows.indices)
    rows = rows[:, moving[~held.dofs[moving]]]
    rows = vstack([rows, -rows[np.flatnonzero(contacts.two_sided[rigid])]])
    distance = np.append(distance, -distance[contacts.two_sided[rigid]])
    overlap = csr_array(-np.ones((len(distance), 1)))
    cost = np.append(np.zeros(rows.shape[1]), 1.0)
    lower = np.append(np.full(rows.shape[1], -np.inf), 0.0)
    facing: Any = hstack([rows, overlap])
    least = minimise(cost, facing, (-np.inf, distance / size), (lower, np.inf))
    return least is not None and bool(least[-1] > _OVERLAP)


def largest_factor(
    discretisation: Discretisation, freedom: RigidFreedom, bearing: Bearing, rest: Floats, case: Floats
) -> float:
    """Find the largest factor of a nodal load (3n,) with which a bearing's reactions balance it beside the rest.

    Infinite if there is none; NaN if no factor from 0 on has such reactions.
    """
    size = load_size(discretisation, case)
    if not freedom.count or size == 0:
        return np.inf
    unit = (load_size(discretisation, rest) or size) / size
    limits = _limits(discretisation, freedom, bearing, rest, unit * case)
    if not limits:
        return np.nan
    most = limits[-1]
    return np.inf if most >= _MOST else 0.0 if most <= _BRINK else unit * most


def _limits(
    discretisation: Discretisation, freedom: RigidFreedom, bearing: Bearing, rest: Floats, case: Floats
) -> list[float]:
    """Least and largest factor of a case beside the rest of the load for which reactions balance both."""
    total = load_size(discretisation, rest) + load_size(discretisation, case)
    one_sided = bearing.moves
    balance = np.column_stack([-work_of(discretisation, freedom, case) / total, one_sided.T])
    wanted = work_of(discretisation, freedom, rest) / total
    bounds = 0.0, np.append(_MOST, np.full(len(one_sided), np.inf))
    found_limits = []
    for sign in (1.0, -1.0):
        cost = np.append(sign, np.zeros(len(one_sided)))
        end = minimise(cost, balance, (wanted, wanted), bounds)
        found_limits += [] if end is None else [float(end[0])]
    return found_limits
