"""How long the methods that take over may take for a load, in operations: the same on every machine."""

from __future__ import annotations

import math

from signorini.contact.factoring import Method
from signorini.contact.problem import Steps

_MOST = 1e11
"""Operations of all methods that take over together: one or two minutes. The random plate that took longest to be
certified, of 3285 points, had used 5e10."""

_A_FACTOR, _FILL = 6000.0, 1.2
"""Of a factor, times this power of the dofs: 3.4 s on 58,563, 0.5 s on 14,883."""
_A_SOLVE, _FACTORED = 1000.0, 0.125
"""Of a step of an active set, a dof: it reads a factor a few times. And the part of the steps that need a new one: 6 of
69, 22 of 150 and, of the longest, 197 of 732."""
_PIVOTS = 64
"""From one call of whoever watches Lemke's algorithm to the next; each goes through a tableau once."""


class BudgetSpent(Exception):
    """Raised out of a method that takes over where nothing is left."""


class Budget:
    """What is left for the methods that take over, on a plate of so many dofs and contact points.

    Examples
    --------
    >>> budget = Budget(58_563, 1600)
    >>> budget.allows("lemke"), Budget(58_563, 30_000).allows("lemke")
    (True, False)
    """

    def __init__(self, dofs: int, points: int) -> None:
        self._left = _MOST
        self._dofs, self._points = float(dofs), float(points)

    def allows(self, method: Method) -> bool:
        """Whether the first step of a method can still be made."""
        return self._a_step(method) <= self._left

    def watching(self, method: Method, progress: Steps | None) -> Steps:
        """Watch a method: count its steps, hand them on to whoever watches it, and raise `BudgetSpent` at the end."""
        a_step = self._a_step(method)

        def watch(step: int, changing: int, residual: float) -> None:
            self._left -= a_step
            if self._left < 0.0:
                raise BudgetSpent
            if progress is not None:
                progress(step, changing, residual)

        return watch

    def _a_step(self, method: Method) -> float:
        pivots = 2.0 * _PIVOTS * self._points**2
        factor = _A_FACTOR * math.pow(self._dofs, _FILL)
        newton = _A_SOLVE * self._dofs + _FACTORED * factor
        saddle = _A_FACTOR * math.pow(self._dofs + self._points, _FILL)
        return {"lemke": pivots, "active_set": newton, "saddle": saddle, "interior_point": factor}[method]
