"""Progress reports of a solve."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

_MINUTES, _HOURS = 120.0, 7200.0
"""Smallest number of seconds that is written in minutes and hours."""


@dataclass(frozen=True)
class Progress:
    """A moment of a solve.

    Parameters
    ----------
    combination : str
        The combination being solved; empty before the first.
    step : int
        Newton steps of the active set, or pivots of Lemke's algorithm (reported every 64) so far; 0 as a combination
        begins, and all there is where few points do with less.
    changing : int
        Contact points that opened or closed since the one before.
    residual : float
        Largest nodal force out of balance over the largest there is, or what a method takes for that; 1 before the
        first step.
    stage : {"mesh", "factor", "contact", "refined"}
        What begins: meshing, assembling and factoring, once each, and then the contact problem of every combination.
        "refined" comes where an accuracy is asked for, at the end of every mesh.
    other_mesh : str
        The other mesh that is being solved, such as "twice its size", to see how far this one is from the plate.
    mesh, meshes : int
        Which mesh is being solved, of how many: 1 of 1 but where other meshes are.
    left : float
        About how many seconds the other meshes still take; NaN where nothing tells.
    reached : str
        Where an accuracy is asked for, how far the mesh before this one came: "mesh 3, ± 0.12 on 400 elements"; before
        the second mesh empty. At the end of a mesh how far it came itself, of which number, and about how many elements
        and how much memory reaching the accuracy would take.
    method : str
        What is at work, such as "the active set"; empty before the first step. Where one way to an answer takes over
        from another, the step is 0 once more.

    Examples
    --------
    >>> str(Progress("ULS", 3, 120, 2.5e-4, method="the active set")), str(Progress(stage="mesh"))
    ('ULS by the active set: step 3, 120 contact points changing, imbalance 2.5e-04', 'meshing')
    """

    combination: str = ""
    step: int = 0
    changing: int = 0
    residual: float = 1.0
    stage: Literal["mesh", "factor", "contact", "refined"] = "contact"
    other_mesh: str = ""
    mesh: int = 1
    meshes: int = 1
    left: float = math.nan
    reached: str = ""
    method: str = ""

    def __str__(self) -> str:
        """Say it in a line."""
        if self.stage == "refined":
            return self.reached
        said = self._said
        if self.other_mesh:
            said += f", on a mesh of {self.other_mesh}"
            said += f" (mesh {self.mesh} of {self.meshes}{_left(self.left)})" if self.meshes > 1 else ""
        return f"{self.reached}: {said}" if self.reached else said

    @property
    def _said(self) -> str:
        if self.stage != "contact":
            return {"mesh": "meshing", "factor": "assembling and factoring"}[self.stage]
        by = f" by {self.method}" if self.method else ""
        if self.step == 0:
            return f"{self.combination}: solving{by}"
        points = f"{self.changing} contact point{'s' if self.changing != 1 else ''} changing"
        return f"{self.combination}{by}: step {self.step}, {points}, imbalance {self.residual:.1e}"


def _left(seconds: float) -> str:
    """Say how long something takes.

    Examples
    --------
    >>> _left(0.2), _left(42.3), _left(200.0), _left(8000.0), _left(math.nan)
    ('', ', about 42 s left', ', about 3 min left', ', about 2.2 h left', '')
    """
    if not seconds >= 1.0:
        return ""
    said = f"{seconds:.0f} s" if seconds < _MINUTES else f"{seconds / 60:.0f} min"
    return f", about {said if seconds < _HOURS else f'{seconds / 3600:.1f} h'} left"


Watcher: TypeAlias = Callable[[Progress], object]
"""Called at every step; an exception in it ends the solve."""


def steps_of(what: str, watcher: Watcher) -> Callable[[str, int, int, float], None]:
    """Tell a watcher of the steps of whatever method solves something."""

    def steps(method: str, step: int, changing: int, residual: float) -> None:
        watcher(Progress(what, step, changing, residual, method=method))

    return steps
