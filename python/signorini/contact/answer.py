"""An answer to a contact problem, and what of it is a choice among equal ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Literal, Self

import numpy as np

from signorini import _core
from signorini.base.remade import Remade
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats

_AGAINST_EACH_OTHER = 1e6
"""Times the least reactions that others may be: ten of sixteen digits are left for their sum."""


@dataclass(frozen=True)
class NotUnique:
    """What the load and the supports leave open, so that the answer shown is the least of many.

    Parameters
    ----------
    what : str
        "reactions": rigid supports that repeat each other may share their forces in more ways than one. "deflection":
        the plate may move as a rigid body between its supports.
    supports : tuple of str
        Supports that share the forces; none of a deflection.
    motion : str
        How the plate may move, in words; empty of reactions.
    """

    what: Literal["reactions", "deflection"]
    supports: tuple[str, ...] = ()
    motion: str = ""

    @property
    def otherwise(self) -> str:
        """What else would be as right."""
        if self.what == "reactions":
            return f"reactions of {', '.join(self.supports)} could be shared otherwise"
        return f"the plate could rest elsewhere, {self.motion}"

    def __str__(self) -> str:
        """Say it in a line."""
        shown = "the least are shown" if self.what == "reactions" else "the least deflection is shown"
        return f"{self.otherwise}; {shown}"


@dataclass(frozen=True, eq=False, repr=False)
class Answer(Remade):
    """Displacements, reactions, gaps and states of one load; numbers are NaN unless solved.

    Displacements ``hi + lo`` (3n,) are the sum of two doubles. ``reaction``, ``gap`` and ``closed`` (m,) are those of
    every contact point; reactions of two-sided points are those of all that repeat them, too. ``shared`` (m + r,) has
    the reaction of every contact point and, behind these, of every repeated one, each with its own share.
    ``not_unique`` is empty where this is the only answer; ``somehow`` is what the solver came to, where this was chosen
    instead. ``solution`` is the solver's own, for other loads of the same problem to begin with; not pickled.
    """

    status: Literal["solved", "no_equilibrium", "unsolved"]
    hi: Floats
    lo: Floats
    reaction: Floats
    gap: Floats
    closed: Bools
    shared: Floats
    pivots: int
    iterations: int
    gradients: int
    factorizations: int
    corrections: int
    not_unique: tuple[NotUnique, ...] = ()
    somehow: Self | None = None
    solution: _core.ContactSolution | None = None

    _made = MappingProxyType({"solution": lambda answer: None})

    @property
    def in_turn(self) -> tuple[Self, ...]:
        """The answer itself, then what stands where arithmetic does not carry the choice: what the solver came to.

        Not where supports there push against each other so hard that their sum has lost the load's digits.
        """
        if self.somehow is None:
            return (self,)
        most = [float(np.abs(one.reaction).max(initial=0.0)) for one in (self, self.somehow)]
        if most[1] > _AGAINST_EACH_OTHER * most[0]:
            return (self,)
        return (self, replace(self.somehow, not_unique=self.not_unique))

    @classmethod
    def of(cls, discretisation: Discretisation, solution: _core.ContactSolution) -> Self:
        """Take a solution as it comes."""
        reaction = solution.reaction
        return cls(
            solution.status,
            solution.hi,
            solution.lo,
            reaction,
            solution.gap,
            solution.closed,
            np.concatenate([reaction, np.zeros(len(discretisation.repeated))]),
            solution.pivots,
            solution.iterations,
            solution.gradients,
            solution.factorizations,
            solution.corrections,
            solution=solution,
        )
