"""Progress reports of a solve."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, TypeAlias

_MINUTES, _HOURS = 120.0, 7200.0
"""Durations from 120 s on are written in minutes, from 7200 s on in hours."""


@dataclass(frozen=True)
class Progress:
    """The state of a running solve, with which the user's progress function is called.

    Parameters
    ----------
    combination : str
        Name of the combination that is being solved; empty before the first combination.
    step : int
        Number of Newton steps of the active set, or of pivots of Lemke's algorithm (reported after every 64 pivots); 0
        at the start of a combination.
    changing : int
        Number of contact points that opened or closed in this step.
    residual : float
        Largest residual force, relative to the largest nodal force, or another measure of convergence of the method; 1
        before the first step.
    stage : {"mesh", "factor", "contact", "refined", "sensitivity"}
        The stage that begins: "mesh" is meshing, "factor" assembly and factorization, "contact" the contact problem of
        a combination. "refined" is the end of the solution on each mesh with ``mesh.accuracy``. "sensitivity" is the
        derivative of a number with respect to a parameter.
    other_mesh : str
        Description of the other mesh that is being solved for ±, such as "twice its size"; empty for the mesh itself.
    mesh, meshes : int
        Number of the mesh that is being solved, counted from 1, and number of all meshes.
    left : float
        Estimated time for the remaining meshes in seconds; NaN without an estimate.
    reached : str
        With ``mesh.accuracy``, the accuracy of the previous mesh: "mesh 3, ± 0.12 on 400 elements"; empty for the first
        mesh. At the end of a mesh: the accuracy on this mesh, with the elements and memory that the required accuracy
        would take. In the stage "sensitivity": the number and the parameter.
    method : str
        Name of the method, such as "the active set"; empty before the first step. A new method begins at step 0.

    Examples
    --------
    >>> str(Progress("ULS", 3, 120, 2.5e-4, method="the active set")), str(Progress(stage="mesh"))
    ('ULS by the active set: step 3, 120 contact points changing, imbalance 2.5e-04', 'meshing')
    """

    combination: str = ""
    step: int = 0
    changing: int = 0
    residual: float = 1.0
    stage: Literal["mesh", "factor", "contact", "refined", "sensitivity"] = "contact"
    other_mesh: str = ""
    mesh: int = 1
    meshes: int = 1
    left: float = math.nan
    reached: str = ""
    method: str = ""

    def __str__(self) -> str:
        """Write the state of the solve as one line of text."""
        if self.stage == "refined":
            return self.reached
        if self.stage == "sensitivity":
            return f"sensitivity of {self.reached}"
        text = self._text
        if self.other_mesh:
            text += f", on a mesh of {self.other_mesh}"
            text += f" (mesh {self.mesh} of {self.meshes}{_left(self.left)})" if self.meshes > 1 else ""
        return f"{self.reached}: {text}" if self.reached else text

    @property
    def _text(self) -> str:
        if self.stage != "contact":
            return {"mesh": "meshing", "factor": "assembling and factoring"}[self.stage]
        by = f" by {self.method}" if self.method else ""
        if self.step == 0:
            return f"{self.combination}: solving{by}"
        points = f"{self.changing} contact point{'s' if self.changing != 1 else ''} changing"
        return f"{self.combination}{by}: step {self.step}, {points}, imbalance {self.residual:.1e}"


def _left(seconds: float) -> str:
    """Write a remaining time in seconds, minutes or hours.

    Examples
    --------
    >>> _left(0.2), _left(42.3), _left(200.0), _left(8000.0), _left(math.nan)
    ('', ', about 42 s left', ', about 3 min left', ', about 2.2 h left', '')
    """
    if not seconds >= 1.0:
        return ""
    short = f"{seconds:.0f} s" if seconds < _MINUTES else f"{seconds / 60:.0f} min"
    return f", about {short if seconds < _HOURS else f'{seconds / 3600:.1f} h'} left"


Watcher: TypeAlias = Callable[[Progress], object]
"""Type of the user's progress function: called with the state at every step; an exception in it ends the solve."""


def steps_of(combination: str, watcher: Watcher) -> Callable[[str, int, int, float], None]:
    """Return a callback that a solution method calls at each step, and that calls the watcher with a `Progress`."""

    def steps(method: str, step: int, changing: int, residual: float) -> None:
        watcher(Progress(combination, step, changing, residual, method=method))

    return steps
