"""The two loads of a path, and how far reactions can balance their sum."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from signorini.base import arguments
from signorini.contact.problem import ContactProblem
from signorini.discretise import CaseLoad, Discretisation
from signorini.equilibrium.imbalance import explain, floats, imbalance, largest_factor
from signorini.errors import InputError, NoEquilibriumError, unknown

_NAMED = 10_000
"""Combinations among which a message looks for one that was meant."""


@dataclass(frozen=True, eq=False)
class PathLoads:
    """Start + t add on one mesh.

    Parameters
    ----------
    names, loads : pairs
        Of the load at t = 0, and of what grows.
    limits : tuple of float
        The largest t at which reactions on the supports' outlines balance the load, and at the points of the mesh.
    """

    names: tuple[str | None, str]
    loads: tuple[CaseLoad, CaseLoad]
    limits: tuple[float, float]

    @classmethod
    def of(cls, problem: ContactProblem, start: str | None, add: str) -> PathLoads:
        """Look for the loads, and refuse what has no equilibrium to begin with."""
        discretisation = problem.discretisation
        loads = load_named(discretisation, start, "start"), load_named(discretisation, add, "add")
        message = explain(discretisation, imbalance(discretisation, problem.freedom, loads[0].weighing))
        if message:
            raise NoEquilibriumError(f"{start or 'without load'}: {message}")
        if floats(discretisation, problem.freedom, loads[0].weighing, loads[1].weighing):
            raise InputError(
                f"nothing presses the plate on its supports: neither {start or 'the start, which is no load,'} nor "
                f"{add} has a resultant, so it may rest anywhere. Add its weight.",
                place="add",
            )
        outline, mesh = (
            largest_factor(discretisation, problem.freedom, bearing, loads[0].weighing, loads[1].weighing)
            for bearing in (problem.freedom.outline, problem.freedom.on_mesh)
        )
        return cls((start, add), loads, (outline, mesh))

    @property
    def end(self) -> float:
        """The smaller limit."""
        return float(np.fmin(*self.limits))

    def at(self, t: float) -> CaseLoad:
        """The load at some t."""
        return self.loads[0] + t * self.loads[1]


def load_named(discretisation: Discretisation, name: str | None, argument: str) -> CaseLoad:
    """The load of a case or, if there is none of that name, of a combination."""
    if name is None:
        return 0.0 * next(iter(discretisation.cases.values()))
    arguments.name(name, "load case or combination", argument)
    if name in discretisation.cases:
        return discretisation.cases[name]
    combinations = discretisation.model.effective_combinations if discretisation.model.combination else ()
    for combination in combinations:
        if combination.name == name:
            return discretisation.load(combination)
    names = {*discretisation.cases, *(combination.name for combination in itertools.islice(combinations, _NAMED))}
    raise InputError(unknown("load case or combination", name, names), place=argument)
