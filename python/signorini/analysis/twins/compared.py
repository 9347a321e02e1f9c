"""Half-widths of numbers that stand in trees of one structure, one of each mesh."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from signorini.analysis.twins.half_width import FASTEST, FASTEST_OF_POINTS, half_widths, unsettled
from signorini.analysis.twins.leaves import Path, acts_at_points, beside, leaves, may_grow
from signorini.analysis.twins.meshes import side
from signorini.mesh import Mesh
from signorini.model import Model
from signorini.singularities.named import Singularity


@dataclass(frozen=True)
class Meshes:
    """Meshes of one plate, the finest first; ``own`` is the one that half-widths are for."""

    every: tuple[Mesh, ...]
    own: int

    @classmethod
    def of(cls, own: Mesh, others: Sequence[Mesh]) -> Meshes:
        """Order meshes."""
        every = sorted([own, *others], key=lambda mesh: -len(mesh.elements))
        return cls(tuple(every), every.index(own))

    @property
    def sizes(self) -> list[float]:
        """Mean sides of their elements."""
        return [side(mesh) for mesh in self.every]

    @property
    def elements(self) -> tuple[int, ...]:
        """How many elements they have."""
        return tuple(len(mesh.elements) for mesh in self.every)

    @property
    def reach(self) -> float:
        """How far what acts at a point makes fields as steep as at it: two elements of the coarsest mesh."""
        return 2.0 * self.sizes[-1]


def compared(
    trees: Sequence[Mapping[str, Any]],
    meshes: Meshes,
    model: Model,
    singular: Sequence[Singularity],
    largest: Callable[[Path, float], float],
) -> tuple[dict[Path, float | None], list[Path]]:
    """Give half-widths by the path of every number, and the paths of those without a limit.

    ``trees`` are in the order of the meshes; only what a singularity is named for may have no limit.
    """
    found = [leaves(tree) for tree in trees]
    own = found[meshes.own]
    paths = list(own)
    values = np.array([[of.get(path, np.nan) for path in paths] for of in found]).reshape(len(found), -1)
    sizes = np.array([largest(path, value) for path, value in own.items()])
    widths, growing = half_widths(
        values,
        meshes.sizes,
        meshes.own,
        FASTEST_OF_POINTS if acts_at_points(model) or any(one.limited for one in singular) else FASTEST,
        beside(paths, np.abs(values[0] - values[1])),
        sizes,
        np.array([not may_grow(path, trees[meshes.own], singular, meshes.reach) for path in paths], np.bool_),
    )
    # Peaks under the outline of a rigid area have none, but need not grow steadily on elements that hardly know it.
    rigid = {one.source for one in singular if one.line and "pressure" in one.numbers}
    supports = trees[meshes.own]["supports"]
    peaks = np.array([path[-1] == "max_pressure" and supports[path[1]]["name"] in rigid for path in paths], np.bool_)
    growing |= peaks & unsettled(values, sizes)
    widths = np.where(growing, np.nan, widths)
    numbers = {path: rounded(width) for path, width in zip(paths, widths.tolist(), strict=True)}
    return numbers, [path for path, grows in zip(paths, growing.tolist(), strict=True) if grows]


def rounded(width: float) -> float | None:
    """Round a half-width to three digits; None of NaN."""
    return None if np.isnan(width) else float(f"{width:.3g}")
