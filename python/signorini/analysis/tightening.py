"""Bolts that are preloaded before other loads act: each preload becomes a settlement of the bolt.

Bolts are tightened in stages, each with a group of bolts. In its stage a group exerts its preload forces on the plate.
Bolts tightened earlier follow their laws; later bolts have no force. After the stage the laws of the group are shifted
in travel, so that each bolt has its preload at its present travel. Other modules see only the shifted laws.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from signorini.base.arguments import checked, known, made_by
from signorini.base.on_demand import kept
from signorini.base.progress import Watcher, steps_of
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.contact.strategy import answered, refusal, uncertain
from signorini.discretise import CaseLoad, ContactPoints, Discretisation
from signorini.discretise.preloads import bolt_groups
from signorini.discretise.rows import Bools, Floats
from signorini.equilibrium.balance import rigid_freedom
from signorini.equilibrium.imbalance import CONTRADICTION, explain, imbalance
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError


@checked
def tightened(problem: ContactProblem, combination: str) -> ContactProblem:
    """Tighten the bolts of a combination; return the problem on which the load of the combination is solved.

    The returned problem shares the factor and has other `gaps`. Without preloads it is the same problem.

    Parameters
    ----------
    problem : ContactProblem
    combination : str
        Name of the combination whose factors multiply the preloads.

    Raises
    ------
    InputError
        If there is no combination of that name.
    NoEquilibriumError
        If no reactions balance the bolts while they are tightened.
    NotCertifiedError
        If the answer of a stage fails its certificate.

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
    """Tighten the bolts, with preloads multiplied by factors of load cases.

    For the same factors on the same mesh, the result is computed once.
    """
    wanted = problem.discretisation.model.round_factors(factors)
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
    """Cache of discretisations with tightened bolts; the keys are the factors of the preloads."""
    return {}


@kept
def loosened(discretisation: Discretisation, tightening: tuple[float, ...]) -> str:
    """Message if no reactions balance the preload forces of some stage; empty if reactions exist in all stages."""
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
    """Bolts tightened together: ``force`` (m,) are the forces that they exert, 0 at other points.

    ``there`` (m,) marks the points of other supports and of the bolts tightened earlier.
    """

    names: tuple[str, ...]
    force: Floats
    there: Bools

    def posed(self, base: Discretisation, distance: Floats) -> tuple[Discretisation, CaseLoad]:
        """Discretisation with the points ``there`` and gaps ``distance`` (m,); the bolts' preload forces as a load."""
        there = np.flatnonzero(self.there)
        contacts = replace(base.contacts, distance=distance).pick(there)
        repeated = replace(base.repeated, follows=base.repeated.follows[:, there])
        nodal = -(base.contact_rows.T @ self.force)
        nothing = CaseLoad.none(base.mesh.node_count, len(base.mesh.elements))
        return replace(base, contacts=contacts, repeated=repeated), replace(nothing, nodal=nodal, weighing=nodal)

    def said(self, message: str) -> str:
        """Return a message that begins with the text of this stage."""
        return f"While {self.what}: {message}"

    @property
    def what(self) -> str:
        """Text for the stage in messages: "tightening" and the names of the supports or bolts."""
        return f"tightening {' and '.join(self.names)}"


def _stages(base: Discretisation, tightening: tuple[float, ...]) -> list[_Stage]:
    """Return the stages in order: preloads of supports in their order, then the groups of each table `tightening`."""
    contacts, model, count = base.contacts, base.model, len(base.contacts)
    force = defaultdict[tuple[int, int], Floats](lambda: np.zeros(count))
    names = defaultdict[tuple[int, int], list[str]](list)
    tables = len(model.rounds) - len(model.tightening)
    acting = [number for number, factor in enumerate(tightening) if factor]
    for number in acting:
        name, groups = model.rounds[number].support, bolt_groups(model, contacts, model.rounds[number])
        for turn, points, values in groups:
            key = max(0, number - tables + 1), turn
            force[key][points] = -contacts.direction[points] * tightening[number] * values
            each = [f"{name}[{at + 1}]" for at in contacts.numbers[points].tolist()]
            names[key] += [name] if number < tables or len(groups) == 1 else each
    bolts = {model.rounds[number].support for number in acting}
    absent = np.array([support.name in bolts for support in model.support], np.bool_)[contacts.support]
    result = []
    for key in sorted(force):
        absent = absent & (force[key] == 0.0)
        result.append(_Stage(tuple(names[key]), force[key], ~absent & (force[key] == 0.0)))
    return result


def _tighten(base: Discretisation, tightening: tuple[float, ...], watcher: Watcher) -> Discretisation:
    contacts, stages = base.contacts, _stages(base, tightening)
    distance, movement = contacts.distance, np.zeros(len(contacts))
    tightened_to, preload = np.zeros((2, len(contacts)))
    factored: dict[bytes, ContactProblem] = {}
    for number, stage in enumerate(stages, start=1):
        result, load = stage.posed(base, distance)
        present = stage.there.tobytes()
        problem = factored.pop(present).moved(result) if present in factored else contact_problem(result)
        tried = answered(problem, load, steps_of(stage.what, watcher))
        if tried.contradiction:
            raise NoEquilibriumError(stage.said(CONTRADICTION))
        if tried.certificate is None:
            raise NotCertifiedError(stage.said(f"there is no answer that could be certified. {uncertain(result)}"))
        if not tried.passed:
            raise NotCertifiedError(refusal(stage.what, result, load, tried.answer, tried.certificate))
        if any(later.there.tobytes() == present for later in stages[number:]):
            factored[present] = problem
        # After the last stage, bolts without a preload get a law that starts at their present travel.
        now = np.flatnonzero(~stage.there if number == len(stages) else stage.force)
        points, force = contacts.pick(now), stage.force[now]
        preload[stage.there], preload[now] = tried.answer.reaction, force
        tightened_to = np.where(stage.force != 0.0, stage.force, tightened_to)
        travel = -base.plate.openings(*points.rows.arrays, np.zeros(len(now)), tried.answer.hi, tried.answer.lo)
        movement[now] = travel - _first_travel(points, force)
        distance = np.where(stage.force != 0.0, movement, distance)
    placed = replace(
        contacts,
        distance=contacts.distance + movement,
        settlement=contacts.settlement + movement,
        tightened_to=tightened_to,
        preload=preload,
    )
    return base.tightened(placed, tightening)


def _first_travel(points: ContactPoints, force: Floats) -> Floats:
    """Travel (k,) of least magnitude at which each point's law has the given force (k,)."""
    result = np.zeros(len(points))
    for law, at in points.by_law:
        low, high = law.travels(force[at] / points.scale[at])
        result[at] = points.unit[at] * np.where(force[at] > 0.0, low, high)
    return result
