"""Preloaded bolts, tightened and locked before other loads act: a settlement of each, found by solving.

While bolts of one order are tightened they are forces on the plate, those of later orders are not there yet, and those
of earlier ones hold by their graphs. Then the graphs of the bolts are moved, so that each has its preload at the travel
that it has. Nothing else knows of preloads: loads act on the moved graphs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from signorini.base.arguments import checked, known, made_by
from signorini.base.on_demand import kept
from signorini.base.progress import Watcher, steps_of
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.contact.strategy import answered, refusal, uncertain
from signorini.discretise import CaseLoad, ContactPoints, Discretisation
from signorini.discretise.rows import Bools, Floats
from signorini.equilibrium.balance import rigid_freedom
from signorini.equilibrium.imbalance import CONTRADICTION, explain, imbalance
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError


@checked
def tightened(problem: ContactProblem, combination: str) -> ContactProblem:
    """Tighten the bolts of a combination: the problem that its load is then solved on.

    It shares the factor, and differs in its `gaps` alone. Without preloads it is the same problem.

    Parameters
    ----------
    problem : ContactProblem
    combination : str
        Whose factors the preloads have.

    Raises
    ------
    InputError
        If there is none of that name.
    NoEquilibriumError
        If no reactions balance the bolts while they are tightened.
    NotCertifiedError
        If an answer on the way fails its certificate.

    Examples
    --------
    A bolt at the tip of a strip that lies on a bed.

    >>> from signorini import Model, contact_problem
    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 1], "thickness": 0.2},
    ...     mesh={"divisions": [4, 1]},
    ...     support=[
    ...         {"area": "all", "resists": "down", "stiffness": 1e7},
    ...         {"at": [4, 0.5], "resists": "up", "stiffness": 1e6, "preload": 50e3},
    ...     ],
    ...     load=[{"pressure": 5e3}],
    ... )
    >>> problem = contact_problem(model)
    >>> moved = tightened(problem, "all").gaps - problem.gaps
    >>> bool(moved[-1] < -50e3 / 1e6), bool(moved[:-1].any())
    (True, False)
    """
    made_by(problem, ContactProblem, "Make one with signorini.contact_problem(model).", "problem")
    by_name = {one.name: one for one in problem.discretisation.model.effective_combinations}
    named = by_name[known(combination, by_name, "combination", "combination")]
    return tightened_by(problem, named.factors or {}, lambda now: None)


def tightened_by(problem: ContactProblem, factors: Mapping[str, float], watcher: Watcher) -> ContactProblem:
    """Tighten the bolts by factors of cases; the same bolts by the same factors once on a mesh."""
    wanted = problem.discretisation.model.tightening(factors)
    if wanted == problem.discretisation.tightening:
        return problem
    base = problem if problem.unmoved is None else problem.unmoved
    if not wanted:
        return base.by(problem.method)
    done = _done(base.discretisation)
    if wanted not in done:
        if message := loosened(base.discretisation, wanted):
            raise NoEquilibriumError(message)
        done[wanted] = _tighten(base.discretisation, wanted, watcher)
    return base.by(problem.method).moved(done[wanted])


@kept
def _done(discretisation: Discretisation) -> dict[tuple[float, ...], Discretisation]:
    """Discretisations with their bolts tightened, by the factors."""
    return {}


@kept
def loosened(discretisation: Discretisation, tightening: tuple[float, ...]) -> str:
    """Why no reactions balance the bolts as they are tightened; empty where they do."""
    for stage in _stages(discretisation, tightening):
        result, load = stage.posed(discretisation, discretisation.contacts.distance)
        try:
            freedom = rigid_freedom(result)
        except InputError as error:
            raise InputError(stage.said(error.message), error.place) from None
        if message := explain(result, imbalance(result, freedom, load.weighing)):
            return stage.said(message)
    return ""


@dataclass(frozen=True, eq=False)
class _Stage:
    """Bolts that are tightened together: ``force`` (m,) are their reactions, ``there`` (m,) marks other points."""

    names: tuple[str, ...]
    force: Floats
    there: Bools

    def posed(self, base: Discretisation, distance: Floats) -> tuple[Discretisation, CaseLoad]:
        """The plate without these bolts and later ones, its points at distances (m,); and their force on it."""
        there = np.flatnonzero(self.there)
        contacts = replace(base.contacts, distance=distance).pick(there)
        repeated = replace(base.repeated, follows=base.repeated.follows[:, there])
        nodal = -(base.contact_rows.T @ self.force)
        nothing = CaseLoad.none(base.mesh.node_count, len(base.mesh.elements))
        return replace(base, contacts=contacts, repeated=repeated), replace(nothing, nodal=nodal, weighing=nodal)

    def said(self, message: str) -> str:
        """Say what happens while they are tightened."""
        return f"While {self.what}: {message[0].lower()}{message[1:]}"

    @property
    def what(self) -> str:
        """What is done, in words."""
        return f"tightening {' and '.join(self.names)}"


def _stages(base: Discretisation, tightening: tuple[float, ...]) -> Iterator[_Stage]:
    """The stages of tightening, in their order."""
    contacts, supports = base.contacts, base.model.support
    order = np.array([support.stage for support in supports])[contacts.support]
    factors = np.array(tightening or [0.0] * len(supports))
    tight = factors[contacts.support] != 0.0
    for now in np.unique(order[tight]).tolist():
        force, names = np.zeros(len(contacts)), []
        for index, (support, factor) in enumerate(zip(supports, factors.tolist(), strict=True)):
            if factor and support.preload is not None and support.stage == now:
                (own,) = np.nonzero(contacts.support == index)
                force[own] = -contacts.direction[own] * factor * support.preload(*contacts.positions[own].T)
                names.append(support.name)
        yield _Stage(tuple(names), force, ~tight | (order < now))


def _tighten(base: Discretisation, tightening: tuple[float, ...], watcher: Watcher) -> Discretisation:
    contacts = base.contacts
    distance, preload, movement = contacts.distance, np.zeros(len(contacts)), np.zeros(len(contacts))
    for stage in _stages(base, tightening):
        result, load = stage.posed(base, distance)
        tried = answered(contact_problem(result), load, steps_of(stage.what, watcher))
        if tried.contradiction:
            raise NoEquilibriumError(stage.said(CONTRADICTION))
        if tried.certificate is None:
            raise NotCertifiedError(stage.said(f"there is no answer that could be certified. {uncertain(result)}"))
        if not tried.passed:
            raise NotCertifiedError(refusal(stage.what, result, load, tried.answer, tried.certificate))
        now = np.flatnonzero(stage.force)
        points, force = contacts.pick(now), stage.force[now]
        preload[stage.there], preload[now] = tried.answer.reaction, force
        travel = -base.plate.openings(*points.rows.arrays, np.zeros(len(now)), tried.answer.hi, tried.answer.lo)
        movement[now] = travel - _first_travel(points, force)
        distance = np.where(stage.force != 0.0, movement, distance)
    placed = replace(
        contacts,
        distance=contacts.distance + movement,
        settlement=contacts.settlement + movement,
        preload=preload,
    )
    return base.tightened(placed, tightening)


def _first_travel(points: ContactPoints, force: Floats) -> Floats:
    """The travel (k,) at which points first have a force (k,)."""
    result = np.zeros(len(points))
    for law, at in points.by_law:
        low, high = law.travels(force[at] / points.scale[at])
        result[at] = points.unit[at] * np.where(force[at] > 0.0, low, high)
    return result
