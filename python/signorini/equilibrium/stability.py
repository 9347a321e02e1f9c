"""Load factors at which equilibrium ends when some load cases of combinations grow."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.rows import Floats
from signorini.equilibrium.balance import RigidFreedom, allowed_motions, load_size, rigid_freedom, work_of
from signorini.equilibrium.imbalance import WORK, largest_factor
from signorini.model import Combination

_BLOCK = 1 << 20
"""Largest number of work values (extreme rays times combinations) in memory at once."""


@kept
def _freedom(discretisation: Discretisation) -> tuple[RigidFreedom, Floats | None]:
    """Free rigid motions of the plate, and the extreme rays (r, d) of the cone of motions that the supports allow."""
    freedom = rigid_freedom(discretisation)
    return freedom, allowed_motions(freedom.outline)


@kept
def _work(discretisation: Discretisation, case: str) -> tuple[Floats, float]:
    """Work (d,) of a load case on the free motions, and the size of the load."""
    weighing = discretisation.cases[case].weighing
    return work_of(discretisation, _freedom(discretisation)[0], weighing), load_size(discretisation, weighing)


def load_factors(discretisation: Discretisation, combinations: Sequence[Combination], grows: Collection[str]) -> Floats:
    """Largest factors λ (k,) of the load cases ``grows`` with equilibrium in each of k combinations; infinite if none.

    The other cases of a combination keep their factors. A moving load grows at all its positions. λ is 0 if no λ ≥ 0,
    or only a λ > 1, gives equilibrium.

    The plate is a rigid body. A load is balanced if it does no positive work a + λ b in any extreme ray of the allowed
    motions (`allowed_motions`), so that λ = min −a/b over the rays with b > 0: the resultant reaches the edge of the
    hull of the supports. Where supports have limits, a linear program finds λ for each combination.
    """
    positions = discretisation.model.positions
    growing = {position for case in grows for position in positions.get(case, (case,))}
    freedom, rays = _freedom(discretisation)
    if rays is None:
        return np.array([_by_program(discretisation, freedom, one, growing) for one in combinations])
    works, sizes = np.zeros((2, len(combinations), freedom.count)), np.zeros(len(combinations))
    for row, combination in enumerate(combinations):
        for case, factor in (combination.factors or {}).items():
            work, size = _work(discretisation, case)
            works[int(case in growing), row] += factor * work
            sizes[row] += abs(factor) * size
    result = np.full(len(combinations), np.inf)
    for first in range(0, len(combinations), step := max(1, _BLOCK // max(1, len(rays)))):
        some = slice(first, first + step)
        still, added = (part[some] @ rays.T for part in works)
        tolerance = WORK * sizes[some, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            most = np.where(added > tolerance, -still / added, np.inf).min(axis=1, initial=np.inf)
            least = np.where(added < -tolerance, -still / added, 0.0).max(axis=1, initial=0.0)
        never = ((np.abs(added) <= tolerance) & (still > tolerance)).any(axis=1)
        result[some] = np.where(never | (least > np.fmin(most, 1.0 + WORK)), 0.0, np.maximum(most, 0.0))
    return result


def _by_program(
    discretisation: Discretisation, freedom: RigidFreedom, combination: Combination, growing: Collection[str]
) -> float:
    """λ of one combination by a linear program over the reactions."""
    nothing = np.zeros(discretisation.dof_count)
    parts = [nothing, nothing]
    for case, factor in (combination.factors or {}).items():
        parts[case in growing] = parts[case in growing] + factor * discretisation.cases[case].weighing
    return float(np.nan_to_num(largest_factor(discretisation, freedom, freedom.outline, *parts), posinf=np.inf))
