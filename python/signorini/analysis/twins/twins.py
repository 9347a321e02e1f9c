"""The plate on other meshes: half-widths for results, solved when they are first asked for."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from functools import partial
from types import MappingProxyType
from typing import TypeVar

import numpy as np

from signorini.analysis.single import solve_one
from signorini.analysis.twins.compared import Meshes, compared, rounded
from signorini.analysis.twins.leaves import leaves, named, with_numbers
from signorini.analysis.twins.meshes import Twin, coarser_of, twins_of
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

_T = TypeVar("_T")
_OTHERS = 2
"""Meshes beside a plate's own that show how a number converges."""
_OTHER = 0.5
"""Base 2 logarithm of the ratio of elements from which on meshes are compared; at twice the size it is 2."""


class _SameMeshError(SignoriniError):
    """What the outline or refined places say of the size of elements leaves hardly another mesh."""


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

        def solved(problem: ContactProblem, watch: Watcher) -> Result:
            watch(Progress(combination.name))
            found = solve_one(problem, combination, watch)
            if found.status != "solved":
                raise SignoriniError(found.message)
            return found

        found, warning = self.others(solved)
        return compare(result, found, warning) if found else Estimate(None, (), (warning,))

    def others(self, solved: Callable[[ContactProblem, Watcher], _T], several: bool = False) -> tuple[list[_T], str]:
        """Solve something on one or two other meshes, and say why where one fails; of several loads on coarser."""
        return self._first(twins_of(self.model, self.mesh, several), solved, "a finer mesh would take too long.")

    def coarser(self, solved: Callable[[ContactProblem, Watcher], _T]) -> tuple[list[_T], str]:
        """Solve something on one or two coarser meshes, and say why where one fails."""
        pairs = [pair] if (pair := coarser_of(self.model, self.mesh)) else []
        return self._first(pairs, solved, "this mesh cannot be coarsened.")

    def _first(
        self, pairs: Iterable[tuple[Twin, ...]], solved: Callable[[ContactProblem, Watcher], _T], none: str
    ) -> tuple[list[_T], str]:
        """Solve something on the first meshes of which one can be solved."""
        whys: list[str] = []
        failed: list[str] = []
        for pair in pairs:
            found: list[_T] = []
            for twin in pair:
                try:
                    found.append(self._on(twin, solved))
                except (SignoriniError, MemoryError) as error:
                    whys.append(f"on a mesh of {twin.words}: {str(error) or 'not enough memory.'}")
                    if not isinstance(error, _SameMeshError):
                        failed.append(whys[-1])
                        if not found:
                            break
                if len(found) == _OTHERS:
                    break
            if found:
                return found, without(len(found), " ".join(dict.fromkeys(failed))) if failed else ""
        return [], without(0, " ".join(dict.fromkeys(whys)) or none)

    def _require_another(self, mesh: Mesh) -> None:
        """Refuse a mesh that is none of another size."""
        count, own = len(mesh.elements), len(self.mesh.elements)
        if not abs(math.log2(count / own)) > _OTHER:
            raise _SameMeshError(f"it has {count} elements, hardly other ones than the {own} of this mesh.")

    def _on(self, twin: Twin, solved: Callable[[ContactProblem, Watcher], _T]) -> _T:
        def watch(now: Progress) -> None:
            self.watcher(replace(now, twin=twin.words))

        if twin.words not in self._problems:
            watch(Progress(stage="mesh"))
            # The method that was asked for may be slow on a finer mesh; every certified answer is the same.
            solver = twin.model.solver.model_copy(update={"method": "auto"})
            discretised = discretise(twin.model.model_copy(update={"solver": solver}), twin.mesh)
            self._require_another(discretised.mesh)
            watch(Progress(stage="factor"))
            self._problems[twin.words] = contact_problem(discretised)
        return solved(self._problems[twin.words], watch)


def without(count: int, why: str) -> str:
    """Say that half-widths come from less than the meshes that were to be compared, and why."""
    what = (
        "No half-width (±) says how far the mesh is from the plate",
        "Half-widths (±) are widened, they come from one other mesh alone",
        "Half-widths (±) come from other meshes than the first that were tried",
    )
    return f"{what[count]}; {why}"


def compare(result: Result, others: list[Result], warning: str = "") -> Estimate:
    """Compare a result with those on one or two other meshes; a warning says why there are not more."""
    meshes = Meshes.of(result.mesh, [one.mesh for one in others], bool(warning))
    every = [next(one for one in (result, *others) if one.mesh is mesh) for mesh in meshes.every]
    trees = [figures(one) for one in every]
    found = [{path: np.array([value]) for path, value in leaves(tree).items()} for tree in trees]
    own = trees[meshes.own]
    widths, grow = compared(found, meshes, result.model, own, [(result.singular, np.ones(1, np.bool_))])
    paths = list(found[meshes.own])
    growing = [path for path, (grows,) in zip(paths, grow.tolist(), strict=True) if grows]
    numbers = {path: rounded(width) for path, (width,) in zip(paths, widths.tolist(), strict=True)}
    numbers |= boundary_widths(result, every[1] if meshes.own == 0 else every[0])
    numbers |= places_of_extremes(result, numbers)
    warnings = [warning] if warning else []
    # Of extremes that are still beside a singularity these are named, with what to do.
    told = [path for path in growing if path[0] != "fields"]
    if told:
        warnings.append(
            f"As the mesh is refined these grow and show no limit: {named(told, own)}. The "
            "singularities that are named say why, and what to do."
        )
    return Estimate(with_numbers(own, numbers), meshes.elements, tuple(warnings))
