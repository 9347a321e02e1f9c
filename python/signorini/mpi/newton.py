"""Semismooth Newton method (primal-dual active set) over the ranks, with a factor of the contact set's matrix.

Rigid and nearly rigid points are handled by the method of multipliers; the penalty grows from stage to stage, as in the
core. A line search on the convex energy follows each direction, so that the iteration cannot cycle. Each step begins
with the residual f − Ku in double-double, so that the last steps refine u = hi + lo.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_array, diags_array

from signorini import _core
from signorini.discretise.rows import Bools, Floats
from signorini.mpi.linear import Equations
from signorini.mpi.parts import Part

_STEPS = 200
"""Largest number of Newton steps."""
_SETTLED = 4e-15
"""Largest correction of deflections at convergence, relative to the largest deflection."""
_NEAR = 1e-9
"""Relative correction below which corrections that hardly shrink are rounding errors, and the iteration ends."""
_SHRINKS = 0.5
"""Largest ratio of a correction to the one before at which corrections count as shrinking."""
_GROWTH = 100.0
"""Ratio of the penalties of two consecutive stages; the penalty of the last stage is `Part.penalty`."""
_FLAT = 1e-3
"""Largest slope of the energy at the end of a line search, relative to the slope at its start."""
_SEARCHES = 60
"""Largest number of iterations of a line search; each tries a secant and a bisection."""
_FREE = 1e-9
"""Lower bound of the smallest eigenvalue of RᵀGᵀGR, with rigid motions R and the rows G of a contact set, held dofs and
springs, at which these restrain the plate; relative to the largest eigenvalue with the rows of all contact points.
"""
_SOFT = 1e-3
"""Stiffness of open points in the factored matrix, relative to closed points, if these do not restrain the plate."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Solution on one part: u = hi + lo (3n,), reactions, gaps and states (m,) of its contact points."""

    hi: Floats
    lo: Floats
    reaction: Floats
    gap: Floats
    closed: Bools
    steps: int
    factorizations: int


class Problem:
    """One rank's part of a contact problem. Sums and maxima are over all ranks."""

    def __init__(self, part: Part, communicator: Any) -> None:
        self.part, self.communicator = part, communicator
        self.plate = _core.Plate(*part.plate)
        size = self.plate.dof_count
        self.rows = part.contacts.rows.matrix(part.elements, size)
        self.owned = np.zeros(size, np.bool_)
        self.owned[3 * part.owned.start : 3 * part.owned.stop] = True
        self.mine = part.mine[part.contacts.rows.elements]
        self._at_rest = (*part.springs.arrays[:4], np.zeros(len(part.springs)))
        self.free = self.owned & ~part.held

    def sum(self, values: Floats) -> Floats:
        """Sum of the arrays ``values`` of all ranks."""
        result = np.empty_like(values)
        self.communicator.Allreduce(np.ascontiguousarray(values), result)
        return result

    def largest(self, values: Floats) -> float:
        """Largest magnitude of the values of all ranks; NaN if one is NaN."""
        return float(np.max(self.communicator.allgather(float(np.abs(values).max(initial=0.0)))))

    def residual(self, hi: Floats, lo: Floats) -> Floats:
        """Residual F − Ku (3n,) of plate and springs; it is complete at the nodes that the rank owns."""
        return self.plate.residual(self.part.springs.arrays, self.part.nodal, hi, lo)

    def travel(self, hi: Floats, lo: Floats) -> Floats:
        """Travels Gu − g (m,) of the contact points."""
        contacts = self.part.contacts
        return -self.plate.openings(*contacts.rows.arrays, contacts.distance, hi, lo)

    def times(self, u: Floats) -> Floats:
        """Product K u (3n,) at displacements u, with K of plate and springs."""
        return -self.plate.residual(self._at_rest, np.zeros_like(u), u, np.zeros_like(u))

    def supports(self, stiffness: Floats) -> csr_array:
        """GᵀkG (3n, 3n) of contact points with stiffness k (m,); held dofs have an equation u = 0 of their own."""
        rows = self.rows.copy()
        rows.data = np.where(self.part.held[rows.indices], 0.0, rows.data)
        return csr_array(rows.T @ diags_array(stiffness) @ rows + diags_array(self.part.held * self.part.shear))

    def restrained_by(self, closed: Bools) -> bool:
        """Whether held dofs, springs and closed points restrain the rigid motions of the plate."""
        part, motions = self.part, self.part.motions
        points = self.rows @ motions
        springs = part.springs.rows.matrix(part.elements, len(motions)) @ motions
        springs = springs[part.mine[part.springs.rows.elements]]
        held = motions[part.held & self.owned]
        fixed = springs.T @ springs + held.T @ held
        some, every = (points[self.mine & which] for which in (closed, np.ones_like(closed)))
        set_, all_ = self.sum(np.stack([fixed + some.T @ some, fixed + every.T @ every]))
        return bool(np.linalg.eigvalsh(set_)[0] > _FREE * np.linalg.eigvalsh(all_)[-1])


def solved(problem: Problem, watch: Callable[[int, int, float], object]) -> Solution:
    """Solve the contact problem; ``watch`` is called with step, number of changed points, and relative correction."""
    equations = Equations(problem.part, problem.communicator)
    try:
        return _Newton(problem, equations, watch).solution()
    finally:
        equations.destroy()


class _Newton:
    """The iterate: displacements hi + lo (3n,), multipliers and contact set (m,), penalty of the stage."""

    def __init__(self, problem: Problem, equations: Equations, watch: Callable[[int, int, float], object]) -> None:
        self.problem, self.equations, self.watch = problem, equations, watch
        part, contacts = problem.part, problem.part.contacts
        self.hi = np.where(part.held, part.held_values, 0.0)
        self.lo = np.zeros_like(self.hi)
        self.multiplier = np.zeros(len(contacts))
        self.straight, self.compliance = contacts.two_sided, contacts.compliance
        rigid = problem.largest(np.isfinite(part.penalty)) > 0.0
        self.penalty = part.first_penalty if rigid and part.first_penalty < 1.0 else 1.0
        self.factored: tuple[Bools, float] | None = None
        self.steps = self.factorizations = 0

    def solution(self) -> Solution:
        """Iterate up to the largest penalty, and until the corrections are rounding errors."""
        converged, last = False, np.inf
        while self.steps < _STEPS and not converged:
            self.steps += 1
            correction, changes = self._step()
            self.watch(self.steps, changes, correction)
            if self.penalty < 1.0:
                if not changes:
                    self.penalty = min(1.0, _GROWTH * self.penalty)
                continue
            slow = correction <= _NEAR and correction > _SHRINKS * last
            converged = correction <= _SETTLED or slow
            last = correction
        travel = self.problem.travel(self.hi, self.lo)
        at_points = self._augmented(travel)
        closed = self.straight | (at_points >= 0.0)
        reaction = np.where(closed, self._stiffness * at_points, 0.0)
        gap = np.where(closed, 0.0, -travel)
        return Solution(self.hi, self.lo, reaction, gap, closed, self.steps, self.factorizations)

    @property
    def _series(self) -> Floats:
        """Augmentation compliance σ = 1/penalty (m,) in series with rigid or nearly rigid points; 0 at others."""
        return 1.0 / (self.penalty * self.problem.part.penalty)

    @property
    def _stiffness(self) -> Floats:
        return 1.0 / (self.compliance + self._series)

    def _augmented(self, travel: Floats) -> Floats:
        """Augmented travels τ + σλ (m,), ≥ 0 at closed points, where the reaction is `_stiffness` times these."""
        return travel + self._series * self.multiplier

    def _forces(self, at_points: Floats) -> Floats:
        return np.where(self.straight, at_points, np.maximum(at_points, 0.0)) * self._stiffness

    def _step(self) -> tuple[float, int]:
        """One Newton step: relative correction and number of points that changed their state."""
        problem = self.problem
        at_points = self._augmented(problem.travel(self.hi, self.lo))
        closed = self.straight | (at_points >= 0.0)
        smooth = problem.residual(self.hi, self.lo)
        residual = smooth - problem.rows.T @ self._forces(at_points)
        self._factor(closed)
        direction = self.equations.solve(residual)
        moved = problem.rows @ direction
        changed = (self.straight | (at_points + moved >= 0.0)) != closed
        changes = int(problem.sum(np.array([float(changed[problem.mine].sum())]))[0])
        length = self._searched(smooth, direction, at_points, moved) if changes else 1.0
        high = self.hi + length * direction
        part = high - self.hi
        self.lo = self.lo + ((self.hi - (high - part)) + (length * direction - part))
        self.hi = high
        if not changes:
            self.multiplier = self._forces(self._augmented(problem.travel(self.hi, self.lo)))
        size = problem.largest(self.hi[::3])
        correction = problem.largest(length * direction[::3])
        return (correction / size if size else correction), changes

    def _factor(self, closed: Bools) -> None:
        if self.factored is not None:
            before, penalty = self.factored
            same = float((before != closed).any())
            if penalty == self.penalty and not self.problem.largest(np.array([same])):
                return
        stiffness = self._stiffness
        soft = 0.0 if self.problem.restrained_by(closed) else _SOFT
        supports = self.problem.supports(np.where(closed, stiffness, soft * stiffness))
        self.equations.fill(self.problem.plate.stiffness_matrix(self.problem.part.springs.arrays), supports)
        del supports, stiffness
        self.equations.factor()
        self.factored, self.factorizations = (closed, self.penalty), self.factorizations + 1

    def _searched(self, smooth: Floats, direction: Floats, at_points: Floats, moved: Floats) -> float:
        """Length of the step at which the slope of the energy along the direction is almost zero."""
        problem, mine = self.problem, self.problem.mine
        along, stretched = direction[problem.free], problem.times(direction)[problem.free]
        linear = problem.sum(np.array([-along @ smooth[problem.free], along @ stretched]))

        def slope(length: float) -> float:
            forces = self._forces(at_points + length * moved)
            return float(linear @ [1.0, length] + problem.sum(np.array([moved[mine] @ forces[mine]]))[0])

        low, high = (0.0, slope(0.0)), (1.0, slope(1.0))
        if high[1] <= _FLAT * abs(low[1]):
            return 1.0
        length = 1.0
        for _ in range(_SEARCHES):
            # The energy is convex, so its slope increases along the step; secant and bisection alternate.
            length = low[0] - low[1] * (high[0] - low[0]) / (high[1] - low[1])
            for tried in (length, 0.5 * (low[0] + high[0])):
                value = slope(tried)
                if abs(value) <= _FLAT * abs(linear[0]) or not low[0] < tried < high[0]:
                    return tried
                low, high = ((tried, value), high) if value < 0.0 else (low, (tried, value))
        return length
