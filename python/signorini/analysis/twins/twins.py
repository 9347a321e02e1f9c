"""The plate on other meshes: half-widths for results, solved when they are first asked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from types import MappingProxyType
from typing import Any

import numpy as np

from signorini.analysis.single import solve_one
from signorini.analysis.twins.half_width import FASTEST, FASTEST_OF_POINTS, half_widths
from signorini.analysis.twins.leaves import (
    Path,
    acts_at_points,
    beside,
    kind_of,
    largest_of,
    leaves,
    may_grow,
    named,
    with_numbers,
)
from signorini.analysis.twins.meshes import Twin, side, twins_of
from signorini.analysis.twins.places import boundary_widths, places_of_extremes
from signorini.base.arguments import watching
from signorini.base.progress import Progress, Watcher
from signorini.base.remade import Remade
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.discretise import discretise
from signorini.errors import SignoriniError
from signorini.mesh import Mesh
from signorini.model import Combination, Model
from signorini.results.estimate import NONE, Estimate
from signorini.results.figures import figures
from signorini.results.result import Result


@dataclass(frozen=True, eq=False, repr=False)
class Twins(Remade):
    """The same model on other meshes, each factored once.

    Parameters
    ----------
    model : Model
    mesh : Mesh
        The mesh that others are compared with.
    watcher : callable
        Called with a `Progress`; what it raises ends what is being solved and reaches the caller.
    """

    model: Model
    mesh: Mesh
    watcher: Watcher
    _problems: dict[str, ContactProblem] = field(default_factory=dict)

    _made = MappingProxyType({"watcher": lambda twins: watching(None, ""), "_problems": lambda twins: {}})

    def follow(self, result: Result, combination: Combination) -> Result:
        """Give a result of a combination this as its estimator."""
        return replace(result, estimator=partial(self.estimate, combination))

    def estimate(self, combination: Combination, result: Result) -> Estimate:
        """Compare a result of a combination with those on other meshes."""
        if result.status != "solved":
            return NONE
        whys: list[str] = []
        for pair in twins_of(self.model, self.mesh):
            found: list[Result] = []
            for twin in pair:
                try:
                    found.append(self._solved(twin, combination))
                except (SignoriniError, MemoryError) as error:
                    whys.append(f"on a mesh of {twin.words}: {error or 'not enough memory.'}")
                    break
            if found:
                return _estimate(result, found)
        why = " ".join(whys) or "a finer mesh would take too long."
        return Estimate(None, (), (f"No half-width (±) says how far the mesh is from the plate; {why}",))

    def _solved(self, twin: Twin, combination: Combination) -> Result:
        def watch(now: Progress) -> None:
            self.watcher(replace(now, twin=twin.words))

        if twin.words not in self._problems:
            watch(Progress(stage="mesh"))
            discretised = discretise(twin.model, twin.mesh)
            watch(Progress(stage="factor"))
            self._problems[twin.words] = contact_problem(discretised)
        watch(Progress(combination.name))
        result = solve_one(self._problems[twin.words], combination, watch)
        if result.status != "solved":
            raise SignoriniError(result.message)
        return result


def _estimate(result: Result, others: list[Result]) -> Estimate:
    """Compare a result with those on one or two other meshes."""
    every = sorted([result, *others], key=lambda one: -len(one.mesh.elements))
    sizes = [side(one.mesh) for one in every]
    trees = [figures(one) for one in every]
    found = [leaves(tree) for tree in trees]
    own = every.index(result)
    paths = list(found[own])
    values = np.array([[of.get(path, np.nan) for path in paths] for of in found]).reshape(len(every), -1)
    kinds = largest_of(result)
    # Over two elements of the coarsest mesh the fields beside a point are as steep as at it.
    reach = 2.0 * sizes[-1]
    widths, growing = half_widths(
        values,
        sizes,
        own,
        FASTEST_OF_POINTS if acts_at_points(result.model) else FASTEST,
        beside(paths, np.abs(values[0] - values[1])),
        np.array([kinds[kind_of(path)] for path in paths]),
        np.array([not may_grow(path, result, reach) for path in paths], np.bool_),
    )
    numbers: dict[Path, float | None] = {
        path: None if np.isnan(width) else float(f"{width:.3g}") for path, width in zip(paths, widths, strict=True)
    }
    nearest = every[1] if own == 0 else every[0]
    numbers |= boundary_widths(result, nearest)
    numbers |= places_of_extremes(result, numbers)
    warnings = []
    if growing.any():
        what = named([path for path, grows in zip(paths, growing, strict=True) if grows], trees[own])
        warnings.append(
            f"As the mesh is refined these grow and show no limit: {what}. What acts at a point or ends in a corner "
            "is infinite there; spread it over the area it has, or read the number beside it."
        )
    plus_minus: Mapping[str, Any] = with_numbers(trees[own], numbers)
    return Estimate(plus_minus, tuple(len(one.mesh.elements) for one in every), tuple(warnings))
