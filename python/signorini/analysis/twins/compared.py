"""Half-widths of numbers by their paths, of one result or of many at once."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from signorini.analysis.twins.half_width import FASTEST, FASTEST_OF_POINTS, SLOWEST, half_widths, unsettled
from signorini.analysis.twins.layers import KINDS as TOUCHED
from signorini.analysis.twins.layers import unseen_at_edges, unseen_layer
from signorini.analysis.twins.leaves import Path, acts_at_points, beside, kind_of, may_grow, sizes_of
from signorini.analysis.twins.meshes import side
from signorini.discretise.rows import Bools, Floats
from signorini.mesh import Mesh
from signorini.model import Model
from signorini.singularities.singularity import Singularity

_FEWEST = 2
_MOVED = 1e-8
"""Part of its field by which a number changes that is not the same on every mesh."""


@dataclass(frozen=True)
class Meshes:
    """Meshes of one plate, the finest first; ``own`` is the one that half-widths are for. One may have failed."""

    every: tuple[Mesh, ...]
    own: int
    failed: bool = False

    @classmethod
    def of(cls, own: Mesh, others: Sequence[Mesh], failed: bool = False) -> Meshes:
        """Order meshes."""
        every = sorted([own, *others], key=lambda mesh: -len(mesh.elements))
        return cls(tuple(every), every.index(own), failed)

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

    def fastest(self, at_points: Bools | bool) -> Floats:
        """Order of convergence that changes are trusted to show at most, of results that are made at points or not."""
        if self.failed and len(self.every) == _FEWEST:
            # Two meshes show no order, and the one that failed is missed.
            return np.full(np.shape(at_points), SLOWEST)
        return np.where(at_points, FASTEST_OF_POINTS, FASTEST)


def compared(
    found: Sequence[Mapping[Path, Floats]],
    meshes: Meshes,
    model: Model,
    figures: Mapping[str, Any],
    named: Sequence[tuple[Sequence[Singularity], Bools]],
) -> tuple[Floats, Bools]:
    """Give the half-widths of every number of k results, and which have no limit, each (n, k).

    The same rule for results by themselves, rows of a table and envelopes: none of a number depends on which it is in.

    Parameters
    ----------
    found : sequence of mapping
        In the order of the meshes, by its path every number of the results (k,).
    meshes : Meshes
    model : Model
    figures : mapping
        Names the supports and places the probes, as results.json does.
    named : sequence of (singularities, (k,) array)
        Those under some load, or under none, and in which of the results. Only what a singularity is named for may
        have no limit.
    """
    own = found[meshes.own]
    paths = list(own)
    count = len(named[0][1])
    nothing = np.full(count, np.nan)
    values = np.array([[of.get(path, nothing) for path in paths] for of in found]).reshape(len(found), -1, count)
    sizes = sizes_of(own, model, meshes.every[meshes.own])
    largest = np.array([sizes[kind_of(path)] for path in paths]).reshape(-1, count)
    at_points, limited = np.full(count, acts_at_points(model)), np.ones((len(paths), count), np.bool_)
    for singular, where in named:
        at_points |= where & any(one.limited for one in singular)
        limited &= ~(may_grow(paths, figures, singular, meshes.reach)[:, None] & where)
    fastest = meshes.fastest(at_points)
    changes = beside(paths, np.abs(values[0] - values[1]))
    layer = unseen_layer(model, meshes.every[meshes.own], meshes.sizes)
    touched = np.array([kind_of(path) in TOUCHED for path in paths], np.bool_)[:, None] & (changes > _MOVED * largest)
    fringe = ~limited & np.array([path[0] == "fields" for path in paths], np.bool_)[:, None]
    widths, growing = half_widths(values, meshes.sizes, meshes.own, fastest, changes, largest, limited, fringe)
    # Peaks under the outline of a rigid area have none, but need not grow steadily on elements that hardly know it.
    rigid = {one.source for singular, _ in named for one in singular if one.line and "pressure" in one.numbers}
    names = [support["name"] for support in figures["supports"]]
    peaks = np.array(
        [path[-1] in ("max_pressure", "max_tension") and names[int(path[1])] in rigid for path in paths], np.bool_
    )
    growing |= peaks[:, None] & unsettled(values, largest)
    widths = np.where(touched, np.maximum(widths, layer * largest), widths)
    numbers, finer = dict(zip(paths, values[0], strict=True)), meshes.sizes[0] / meshes.sizes[meshes.own]
    at_edges = unseen_at_edges(numbers, sizes["moment"], figures["probes"], model, meshes.every[meshes.own], finer)
    for row, path in enumerate(paths):
        if path in at_edges:
            widths[row] = np.maximum(widths[row], np.abs(values[meshes.own, row] - values[0, row]) + at_edges[path])
    _widen_absent(widths, {path: row for row, path in enumerate(paths)}, values[meshes.own])
    return _rounded(np.where(growing, np.nan, widths)), growing


def _widen_absent(widths: Floats, rows: Mapping[Path, int], values: Floats) -> None:
    """Design moments that are 0 on every mesh: by how far the half-widths of the moments reach beyond what is left."""
    for path, row in rows.items():
        if "design_moment" not in path or (*path[:2], "moment", 2) not in rows:
            continue
        of, sign = int(path[4]), 1.0 if path[3] == "bottom" else -1.0
        direct, twist = rows[(*path[:2], "moment", of)], rows[(*path[:2], "moment", 2)]
        reach = sign * values[direct] + np.abs(values[twist]) + widths[direct] + widths[twist]
        widths[row] = np.where(values[row] == 0.0, np.fmax(widths[row], reach), widths[row])


def rounded(width: float) -> float | None:
    """Round a half-width to three digits; None of NaN."""
    return None if math.isnan(width) else float(f"{width:.3g}")


def _rounded(widths: Floats) -> Floats:
    known = widths > 0
    power = np.floor(np.log10(widths, where=known, out=np.zeros_like(widths))) - 2
    # Powers of ten up to 22 are exact, so that what is written has no more digits.
    up, down = 10.0 ** np.maximum(power, 0), 10.0 ** np.maximum(-power, 0)
    return np.where(known, np.rint(widths * down / up) / down * up, widths)
