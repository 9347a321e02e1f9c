"""Load paths: every event between a load and more of another, exactly."""

from __future__ import annotations

import itertools
from dataclasses import fields, replace
from functools import partial

import numpy as np

from signorini import _core
from signorini.analysis.path_check import confirmed
from signorini.analysis.path_judge import PathJudge
from signorini.analysis.twins import Twins
from signorini.analysis.twins.paths import PathTwins
from signorini.base import arguments
from signorini.base.progress import Progress, Watcher
from signorini.contact.answer import Answer
from signorini.contact.certificate import Certificate
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.contact.refusal import uncertain
from signorini.contact.strategy import WORDS, methods_along
from signorini.discretise import CaseLoad, Discretisation, discretise
from signorini.discretise.rows import Ints
from signorini.equilibrium.imbalance import imbalance
from signorini.equilibrium.limits import CONTRADICTION, floats, largest_factor, supports_contradict
from signorini.equilibrium.words import explain
from signorini.errors import InputError, NoEquilibriumError, NotCertifiedError, unknown
from signorini.expression import LARGEST
from signorini.model import Model
from signorini.results.load_path import AT_LIMIT, Ending, LoadPath

_NAMED = 10_000
"""Combinations among which a message looks for one that was meant."""


def path(
    model: Model, start: str | None, add: str, until: float | None = None, progress: Watcher | None = None
) -> LoadPath:
    """Follow start + t add from t = 0: every t at which a contact point opens or closes, and where equilibrium ends.

    Parameters
    ----------
    model : Model
    start : str or None
        Name of a load case or combination; of two with one name the case is meant. None begins without load.
    add : str
        Name of the load that grows.
    until : float, optional
        The largest t wanted; by default to the end of equilibrium, or until there are no more events.
    progress : callable, optional
        Called with a `Progress` as meshing and factoring begin, at every event, by the solves between events, and by
        what confirms some of them. What it raises ends the path.

    Raises
    ------
    InputError
        If the model says something that cannot be, or has no such case or combination.
    NoEquilibriumError
        If the start has no equilibrium.
    NotCertifiedError
        If the answer at a stop fails its certificate, or the start was not solved.

    Examples
    --------
    A pressure grows on a clamped plate with a prop under its middle, which it meets at some t and then presses.

    >>> model = Model(
    ...     material={"E": 30e9, "nu": 0.2},
    ...     plate={"shape": "rectangle", "size": [4, 4], "thickness": 0.1},
    ...     mesh={"divisions": [4, 4]},
    ...     support=[
    ...         {"edge": ["left", "right", "bottom", "top"], "fix": "clamped"},
    ...         {"name": "prop", "at": [2, 2], "resists": "down", "gap": 0.001},
    ...     ],
    ...     load=[{"case": "Q", "pressure": 10e3}],
    ... )
    >>> found = path(model, start=None, add="Q")
    >>> (event,) = found.events
    >>> event.switched[0].support, event.switched[0].closes, found.ending
    ('prop', True, 'no_more_events')
    >>> round(found.at(event.t).supports[1].reaction, 6), round(found.at(event.t).probe([2, 2])[0].deflection, 12)
    (0.0, 0.001)
    """
    watcher = arguments.watching(progress, "progress")
    watcher(Progress(stage="mesh"))
    found = discretise(model)
    if add is None:
        raise InputError("found None; it must be the name of the load that grows.", place="add")
    loads = _load(found, start, "start"), _load(found, add, "add")
    until = None if until is None else arguments.number(until, "until")
    if until is not None and not 0 < until < np.inf:
        raise InputError(f"found {until:g}; it must be a finite number greater than 0.", place="until")
    if until is not None and until > LARGEST:
        raise InputError(f"found {until:g}; it must be at most {LARGEST:g}.", place="until")
    if not loads[1].nodal.any():
        raise InputError(f'the load "{add}" is zero; it must be one that grows. Name another.', place="add")
    watcher(Progress(stage="factor"))
    problem = contact_problem(found)
    traced = _followed(problem, watcher, start, add, until)
    following = partial(_followed, start=start, add=add, until=until)
    return replace(traced, estimator=PathTwins(Twins(found.model, found.mesh, watcher), following))


def _followed(problem: ContactProblem, watcher: Watcher, start: str | None, add: str, until: float | None) -> LoadPath:
    """Follow the path of a problem."""
    found = problem.discretisation
    loads = _load(found, start, "start"), _load(found, add, "add")
    message = explain(found, imbalance(found, problem.freedom, loads[0].weighing))
    if message:
        raise NoEquilibriumError(f"{start or 'without load'}: {message}")
    if floats(found, problem.freedom, loads[0].weighing, loads[1].weighing):
        raise InputError(
            f"nothing presses the plate on its supports: neither {start or 'the start, which is no load,'} nor {add} "
            "has a resultant, so it may rest anywhere. Add its weight.",
            place="add",
        )
    limit, reached = (
        largest_factor(found, problem.freedom, bearing, loads[0].weighing, loads[1].weighing)
        for bearing in (problem.freedom.outline, problem.freedom.on_mesh)
    )
    traced: LoadPath | None = None
    for other_problem in methods_along(problem):
        other = _trace(other_problem, problem, (start, add), loads, until, (limit, reached), watcher)
        traced = other if traced is None or (other is not None and other.end > traced.end) else traced
        if traced is not None and (traced.ending != "stopped" or traced.ends_with_the_mesh):
            break
    if traced is None and supports_contradict(found):
        raise NoEquilibriumError(CONTRADICTION)
    if traced is None:
        raise NotCertifiedError(
            f"The contact problem at t = 0 has no answer that could be certified. {uncertain(found)}"
        )
    return traced


def _load(found: Discretisation, name: str | None, argument: str) -> CaseLoad:
    """The load of a case or, if there is none of that name, of a combination."""
    if name is None:
        return 0.0 * next(iter(found.cases.values()))
    arguments.name(name, "load case or combination", argument)
    if name in found.cases:
        return found.cases[name]
    combinations = found.model.effective_combinations if found.model.combination else ()
    for combination in combinations:
        if combination.name == name:
            return found.load(combination)
    names = {*found.cases, *(combination.name for combination in itertools.islice(combinations, _NAMED))}
    raise InputError(unknown("load case or combination", name, names), place=argument)


def _trace(
    problem: ContactProblem,
    direct: ContactProblem,
    names: tuple[str | None, str],
    loads: tuple[CaseLoad, CaseLoad],
    until: float | None,
    limits: tuple[float, float],
    watcher: Watcher,
) -> LoadPath | None:
    """Follow the path by one method, as far as its answers are certified and confirmed; None if not at all.

    ``limits`` are those of the supports' outlines and of the contact points of the mesh.
    """
    found = problem.discretisation
    judge, at = PathJudge(problem, loads), list[float]()
    method = WORDS[problem.method]
    limit, asked = limits[0], np.inf if until is None else until
    end = min(*limits, asked)

    def visit(t: float, points: Ints, solution: _core.ContactSolution) -> None:
        judge.take(t, points, Answer.of(found, solution))
        at.append(t)
        whole = f" of {end:.6g}" if np.isfinite(end) else ""
        watcher(Progress(f"t = {t:.6g}{whole}, event {len(at)}"))

    def show(step: int, changing: int, residual: float) -> None:
        where = f"after t = {at[-1]:.6g}" if at else "t = 0"
        watcher(Progress(where, step, changing, residual, method=method))

    try:
        ended = problem.core.path(loads[0].nodal, loads[1].nodal, found.held.values, end, visit, show)
        judge.judge()
    except NotCertifiedError:
        ended = "unsolved"
    stops, certificates, doubts = judge.stops, judge.certificates, judge.doubts
    count = confirmed(direct, loads, stops, watcher)
    if count == 0 or judge.first is None:
        return None
    whole = count == len(stops)
    del stops[count:], certificates[count:]
    near_limit = stops[-1].t >= limit * (1 - AT_LIMIT)
    ending: Ending = "stopped"
    if whole and ended == "unbounded":
        ending = "no_more_events"
    elif whole and ended != "too_many" and near_limit:
        ending = "no_equilibrium"
    elif whole and ended == "reached" and end == asked:
        ending = "until"
    figures = [figure.name for figure in fields(Certificate)]
    worst = Certificate(**{name: max(getattr(one, name) for one in certificates) for name in figures})
    doubted = tuple(index for index in doubts if index < len(stops) - 1)
    return LoadPath(*names, problem, tuple(stops), ending, *limits, worst, loads, judge.first, doubted)
