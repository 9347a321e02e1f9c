"""Load paths: states of a plate while one load is added to another."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from signorini.analysis.exact_path import exact_path
from signorini.analysis.sampled_path import sampled_path
from signorini.analysis.sampler import PathLoads, load_named
from signorini.analysis.tightening import tightened_by
from signorini.base import arguments
from signorini.base.arguments import checked
from signorini.base.progress import Progress, Watcher
from signorini.contact.problem import contact_problem
from signorini.discretise import discretise
from signorini.errors import InputError
from signorini.expression import LARGEST
from signorini.model import Model
from signorini.results.load_path import LoadPath, factors_named
from signorini.results.path_events import thresholds

STEPS = 50
_MOST_STEPS = 100_000


@checked
def path(
    model: Model,
    start: str | None,
    add: str,
    until: float | None = None,
    progress: Watcher | None = None,
    *,
    steps: int | None = None,
    at: Sequence[float] | None = None,
    when: Sequence[str] = (),
    events: Literal["named", "all"] = "named",
) -> LoadPath:
    """Follow the load start + t·add from t = 0: states at samples of t, events between them, the end of equilibrium.

    Between samples the t of every named event is found. A point of a support opens or closes. A line or area begins to
    open, has 75, 50 or 25 % of its length or area in contact, or is fully open; the same in reverse as it closes. An
    event that is undone before the next sample is not found.

    Parameters
    ----------
    model : Model
    start : str or None
        Load at t = 0: name of a load case or, without such a case, of a combination; None for no load.
    add : str
        Load that grows: name of a load case or combination.
    until : float, optional
        Largest t; by default the largest in ``at`` or the end of equilibrium. If equilibrium does not end, the default
        is the power of 2 after the last named event.
    progress : callable, optional
        Called with a `Progress` before meshing and factoring and in every solve. An exception in it ends the path and
        reaches the caller; but after t = 0 a KeyboardInterrupt returns the path up to there.
    steps : int, optional
        Number of evenly spaced t > 0 that are solved; by default 50.
    at : sequence of float, optional
        The t to solve, in place of ``steps``.
    when : sequence of str
        Thresholds to find: a named result of a stop and its value, such as ``"bolts[1].reaction = -203e3"``.
    events : {"named", "all"}
        "all" follows every contact point exactly from event to event, in place of samples; it gives no half-widths.

    Returns
    -------
    LoadPath
        The states and events; an `ExactPath` if ``events`` is "all".

    Raises
    ------
    InputError
        If the model is contradictory, or has no such case, combination or quantity.
    NoEquilibriumError
        If the start has no equilibrium.
    NotCertifiedError
        If no method solves the start.

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
    >>> result = path(model, start=None, add="Q", until=2.0, when=["prop[1].reaction = 20e3"])
    >>> [(event.support, event.change) for event in result.support_events], result.ending, len(result.stops)
    ([('prop', 'closes')], 'until', 53)
    >>> t = result.support_events[0].t
    >>> round(result.at(t).supports[1].reaction, 3), round(result.at(t).probe([2, 2])[0].deflection, 9)
    (0.0, 0.001)
    >>> round(result.at(result.thresholds[0].t).reactions["prop"])
    20000
    """
    watcher = arguments.watching(progress, "progress")
    arguments.known(events, ("named", "all"), "choice", "events", "It")
    samples = _samples(steps, at, events)
    watcher(Progress(stage="mesh"))
    discretisation = discretise(model)
    if add is None:
        raise InputError("found None; it must be the name of the load that grows.", place="add")
    growing = load_named(discretisation, add, "add")
    load_named(discretisation, start, "start")
    if until is not None:
        until = _factor(until, "until")
    if changed := [case for case in model.preload_cases if factors_named(discretisation, add).get(case)]:
        raise InputError(
            f'"{add}" changes the preload "{changed[0]}", but preloads are constant along a path. Name a growing load '
            "without preload; preloads belong to a combination at the start.",
            place="add",
        )
    if not growing.nodal.any():
        raise InputError(f'the load "{add}" is zero, so that it cannot grow. Name another load.', place="add")
    asked = thresholds(discretisation, when)
    watcher(Progress(stage="factor"))
    problem = tightened_by(contact_problem(discretisation), factors_named(discretisation, start), watcher)
    loads = PathLoads.of(problem, start, add)
    times = None if isinstance(samples, int) else samples
    options = {
        "from": start,
        "add": add,
        "until": until,
        "steps": steps,
        "at": times,
        "when": [*when],
        "events": events,
    }
    if events == "all":
        return replace(exact_path(problem, loads, until, asked, watcher), options=options)
    return replace(sampled_path(problem, loads, until, samples, asked, watcher), options=options)


def _samples(steps: int | None, at: Sequence[float] | None, events: str) -> int | list[float]:
    """Number of samples, or the t to be solved in rising order."""
    if events == "all" and (steps is not None or at is not None):
        raise InputError('events="all" stops at every event; leave out steps and at.', place="events")
    if at is None:
        count = STEPS if steps is None else steps
        if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= _MOST_STEPS:
            raise InputError(f"found {count!r}; it must be a whole number from 1 to {_MOST_STEPS}.", place="steps")
        return count
    if steps is not None:
        raise InputError("both steps and at are given; give one of them.", place="at")
    if isinstance(at, str) or not isinstance(at, Iterable):
        raise InputError(f"found {at!r}; it must be a list of numbers greater than 0.", place="at")
    # t = 0 is always solved, so it is not listed.
    result = sorted({_factor(t, "at") for t in at if t != 0})
    if not 1 <= len(result) <= _MOST_STEPS:
        raise InputError(f"found {len(result)} numbers other than 0; give 1 to {_MOST_STEPS} numbers.", place="at")
    return result


def _factor(value: object, place: str) -> float:
    """Return a t as a number; raise `InputError` unless it is finite and greater than 0."""
    t = arguments.number(value, place)
    if not 0 < t < np.inf:
        raise InputError(f"found {t:g}; it must be a finite number greater than 0.", place=place)
    if t > LARGEST:
        raise InputError(f"found {t:g}; it must be at most {LARGEST:g}.", place=place)
    return t
