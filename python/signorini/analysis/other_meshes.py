"""The plate on other meshes, each factored once."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import TypeVar

from signorini.accuracy.meshes import OtherMesh, coarser_of, meshes_beside
from signorini.base.progress import Progress, Watcher
from signorini.contact.problem import ContactProblem, contact_problem
from signorini.discretise import discretise
from signorini.errors import SignoriniError
from signorini.mesh import Mesh
from signorini.model import Model

_T = TypeVar("_T")
_OTHERS = 2
"""Meshes beside a plate's own that show how a number converges."""
_OTHER = 0.5
"""Base 2 logarithm of the ratio of elements from which on meshes are compared; at twice the size it is 2."""


class _SameMeshError(SignoriniError):
    """What the outline or refined places say of the size of elements leaves hardly another mesh."""


@dataclass(eq=False)
class OtherMeshes:
    """The same model on other meshes.

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

    def solved(self, solve: Callable[[ContactProblem, Watcher], _T]) -> tuple[list[_T], str]:
        """Solve something on one or two other meshes, and say why where one fails."""
        return self._first(meshes_beside(self.model, self.mesh), solve, "a finer mesh would take too long.")

    def solved_on_coarser(self, solve: Callable[[ContactProblem, Watcher], _T]) -> tuple[list[_T], str]:
        """Solve something on one or two coarser meshes, and say why where one fails."""
        pairs = [pair] if (pair := coarser_of(self.model, self.mesh)) else []
        return self._first(pairs, solve, "this mesh cannot be coarsened.")

    def _first(
        self, pairs: Iterable[tuple[OtherMesh, ...]], solve: Callable[[ContactProblem, Watcher], _T], none: str
    ) -> tuple[list[_T], str]:
        """Solve something on the first meshes of which one can be solved."""
        whys: list[str] = []
        failed: list[str] = []
        for pair in pairs:
            result: list[_T] = []
            for other in pair:
                try:
                    result.append(self._on(other, solve))
                except (SignoriniError, MemoryError) as error:
                    whys.append(f"on a mesh of {other.words}: {str(error) or 'not enough memory.'}")
                    if not isinstance(error, _SameMeshError):
                        failed.append(whys[-1])
                        if not result:
                            break
                if len(result) == _OTHERS:
                    break
            if result:
                return result, without(len(result), " ".join(dict.fromkeys(failed))) if failed else ""
        return [], without(0, " ".join(dict.fromkeys(whys)) or none)

    def _on(self, other: OtherMesh, solve: Callable[[ContactProblem, Watcher], _T]) -> _T:
        def watch(now: Progress) -> None:
            self.watcher(replace(now, other_mesh=other.words))

        if other.words not in self._problems:
            watch(Progress(stage="mesh"))
            # The method that was asked for may be slow on a finer mesh; every certified answer is the same.
            solver = other.model.solver.model_copy(update={"method": "auto"})
            discretisation = discretise(other.model.model_copy(update={"solver": solver}), other.mesh)
            count, own = len(discretisation.mesh.elements), len(self.mesh.elements)
            if not abs(math.log2(count / own)) > _OTHER:
                raise _SameMeshError(f"it has {count} elements, hardly other ones than the {own} of this mesh.")
            watch(Progress(stage="factor"))
            self._problems[other.words] = contact_problem(discretisation)
        return solve(self._problems[other.words], watch)


def without(count: int, why: str) -> str:
    """Say that half-widths come from less than the meshes that were to be compared, and why."""
    what = (
        "No half-width (±) says how far the mesh is from the plate",
        "Half-widths (±) are widened, they come from one other mesh alone",
        "Half-widths (±) come from other meshes than the first that were tried",
    )
    return f"{what[count]}; {why}"
