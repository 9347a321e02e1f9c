"""A singularity: what has no limit as the mesh is refined, where; and which nodes are part of its peak."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from signorini.discretise.rows import Bools, Floats
from signorini.mesh import Mesh

_AS_FAR = 1e-9
"""Part of the mesh's size within which a node is as far away as it has to be: rounding must not tell."""


@dataclass(frozen=True)
class Singularity:
    """Numbers that have no limit as the mesh is refined.

    ``where`` are points (x, y) or, if ``line``, the vertices of a line all along which it is so; ``what`` says what it
    is. ``numbers`` are those that have no limit there: "deflection", "rotation", "moment", "shear", "pressure" (per
    area, or along a line per length) or "reaction" (of a support at points). ``source`` is the support's name, the load
    case, or "plate". What is ``limited`` has a limit, of which elements of this size know nothing: a footprint smaller
    than they are. Numbers ``within`` a distance are taken for its peak: the thickness there, of a zone's border the
    thinner side's; 0 of nodes of cut elements. Of several plates ``plate`` is the one that it is in.
    """

    where: tuple[tuple[float, float], ...]
    what: str
    numbers: tuple[str, ...]
    advice: str
    source: str
    line: bool = False
    limited: bool = False
    within: float = 0.0
    plate: str = ""

    def excludes(self, number: str) -> bool:
        """Whether extremes of "moment", "shear" or another number leave out the nodes around it."""
        return number in self.numbers and not (self.line or self.limited)

    def __str__(self) -> str:
        """Say it in a sentence."""
        have, are = ("have", "are") if len(self.numbers) > 1 else ("has", "is")
        if self.limited:
            said = f"{_listed(self.numbers)} at it {are} too small."
            return f"{self.what} acts as a point on this mesh: {said} {self.advice}"
        return f"{self.what}: {_listed(self.numbers)} {have} no limit as the mesh is refined. {self.advice}"


def away_from(mesh: Mesh, named: Iterable[Singularity], number: str) -> Bools:
    """Which nodes (n,) are no part of a peak of "moment", "shear" or another number without a limit.

    They are farther than ``within`` from where it has none, however fine the mesh. Nodes of larger elements there stay,
    although their values are partly of what is there: to leave them out would leave out more of the plate the coarser
    its mesh is. Where no node is left, all are.
    """
    away = ~at_peaks(mesh, named, number)
    return away if away.any() else np.ones_like(away)


def at_peaks(mesh: Mesh, named: Iterable[Singularity], number: str) -> Bools:
    """Which nodes (n,) are part of the peak of a number without a limit."""
    result = np.zeros(mesh.node_count, np.bool_)
    peaks = [one for one in named if one.excludes(number)]
    if not peaks:
        return result
    order = np.argsort(mesh.points[:, 0])
    x, y = mesh.points[order].T
    for one in peaks:
        reach = one.within + _AS_FAR * mesh.size
        for at in one.where:
            # Only nodes of a strip about it may be so near.
            near = slice(np.searchsorted(x, at[0] - reach), np.searchsorted(x, at[0] + reach, side="right"))
            result[order[near]] |= np.hypot(x[near] - at[0], y[near] - at[1]) <= reach
    return result


def _listed(words: tuple[str, ...]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else list(words))


def as_places(points: Floats) -> tuple[tuple[float, float], ...]:
    """Points (k, 2) as a singularity has them."""
    return tuple((float(x), float(y)) for x, y in points)
