"""A singularity: a place where results diverge as the mesh is refined, and the nodes of its peak."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from signorini.discretise.rows import Bools, Floats
from signorini.mesh import Mesh

_AS_FAR = 1e-9
"""Largest distance of a node from a singular point that counts as zero, relative to the mesh's size."""


@dataclass(frozen=True)
class Singularity:
    """Results that diverge at a place as the mesh is refined.

    ``where`` are points (x, y) or, if ``line``, the vertices of a singular line. ``what`` describes the cause.
    ``numbers`` are the singular results: "deflection", "rotation", "moment", "shear", "pressure" (per area, or per
    length along a line) or "reaction" (of a support at points). ``source`` is the support's name, the load case, or
    "plate". If ``limited``, the results converge, but not on elements of this size, since a footprint is smaller than
    its element. Nodes up to the distance ``within`` belong to the peak: the least thickness around the place, or 0 if
    ``where`` are the nodes of cut elements. ``plate`` is the name of the plate if there are several plates.
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
        """Whether nodes around this singularity are excluded from extremes of a result, such as "moment" or "shear"."""
        return number in self.numbers and not (self.line or self.limited)

    def __str__(self) -> str:
        """Describe the cause, the singular results and the advice."""
        have, are = ("have", "are") if len(self.numbers) > 1 else ("has", "is")
        if self.limited:
            sentence = f"{_listed(self.numbers)} at it {are} too small."
            return f"{self.what} acts as a point on this mesh: {sentence} {self.advice}"
        return f"{self.what}: {_listed(self.numbers)} {have} no limit as the mesh is refined. {self.advice}"


def away_from(mesh: Mesh, named: Iterable[Singularity], number: str) -> Bools:
    """Mask (n,) of nodes outside the peaks of a singular result, such as "moment" or "shear".

    These nodes are farther than ``within`` from the singular points, on every mesh. Other nodes of elements at the
    points are kept: otherwise a coarser mesh would exclude more of the plate. All nodes are kept if none would remain.
    """
    away = ~at_peaks(mesh, named, number)
    return away if away.any() else np.ones_like(away)


def at_peaks(mesh: Mesh, named: Iterable[Singularity], number: str) -> Bools:
    """Mask (n,) of nodes within ``within`` of points at which a result, such as "moment" or "shear", is singular."""
    result = np.zeros(mesh.node_count, np.bool_)
    peaks = [singularity for singularity in named if singularity.excludes(number)]
    if not peaks:
        return result
    order = np.argsort(mesh.points[:, 0])
    x, y = mesh.points[order].T
    for singularity in peaks:
        reach = singularity.within + _AS_FAR * mesh.size
        for point in singularity.where:
            # Nodes are sorted by x: only nodes with x within ``reach`` of the point's x can be near the point.
            near = slice(np.searchsorted(x, point[0] - reach), np.searchsorted(x, point[0] + reach, side="right"))
            result[order[near]] |= np.hypot(x[near] - point[0], y[near] - point[1]) <= reach
    return result


def _listed(words: tuple[str, ...]) -> str:
    return " and ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else list(words))


def as_places(points: Floats) -> tuple[tuple[float, float], ...]:
    """Convert points (k, 2) to tuples, as in ``Singularity.where``."""
    return tuple((float(x), float(y)) for x, y in points)
