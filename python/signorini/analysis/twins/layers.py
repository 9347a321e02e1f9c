"""The boundary layer of thin plates, of which meshes coarser than the thickness know nothing, however many agree."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from signorini.analysis.twins.half_width import FASTEST
from signorini.discretise.rows import Floats
from signorini.mesh import Mesh
from signorini.mesh.mesh import OUTLINE
from signorini.model import Model

KINDS = frozenset(("deflection", "rotation", "moment", "reaction", "pressure", "max_pressure", "max_tension"))
_SOFTER = 1.3
"""By how many h/L edges soften a plate of thickness h and L = 4A/P: a square on simple edges by 0.86 in its deflection,
a free strip by 1.26 in torsion (0.63 h over its width)."""
_SEEN = 2.65
"""Thickness over the element's side, times this, is the part of the layer that large elements know; measured on simple
squares of h/a = 0.01 and 0.001, where `_left` is right to 0.03 for elements of 0.6 to 100 thicknesses."""


def unseen_layer(model: Model, mesh: Mesh, sizes: Sequence[float]) -> float:
    """What part of a field the layer along edges at which the plate may twist changes, and no mesh shows.

    ``sizes`` are the sides of elements on the finest meshes. What the layer changes between these is told by them, and
    so is what it is then expected to change on finer ones; the rest is not.

    Examples
    --------
    >>> from signorini.discretise import discretise
    >>> def square(fix, thickness):
    ...     return Model(
    ...         material={"E": 30e9, "nu": 0.2},
    ...         plate={"shape": "rectangle", "size": [4, 4], "thickness": thickness},
    ...         support=[{"edge": ["left", "right", "bottom", "top"], "fix": fix}],
    ...         load=[{"pressure": 5e3}],
    ...     )
    >>> for fix, thickness in (("simple", 0.004), ("simple", 0.1), ("clamped", 0.004)):
    ...     mesh = discretise(square(fix, thickness)).mesh
    ...     print(f"{unseen_layer(square(fix, thickness), mesh, (0.1, 0.2)):.1e}")
    1.1e-03
    0.0e+00
    0.0e+00
    """
    none, names = np.zeros((0, 3), np.int64), [OUTLINE] if OUTLINE in mesh.edges else list(mesh.edges)
    held = [name for one in model.support if {"slope", "twist"} & set(one.fixed) for name in one.edge or ()]
    outline, still = (np.concatenate([none, *(mesh.edges[name] for name in which)]) for which in (names, held))
    # Sides of a hole are those of the hole too.
    outline = outline[np.unique(outline[:, 1], return_index=True)[1]]
    ends = mesh.points[outline[~np.isin(outline[:, 1], still[:, 1])][:, [0, 2]]]
    free = float(np.hypot(*(ends[:, 1] - ends[:, 0]).T).sum())
    thickness = float(thickness_at(model, mesh.points).mean())
    left, before = (_left(thickness, size) for size in sizes[:2])
    shown = (before - left) / ((sizes[1] / sizes[0]) ** FASTEST - 1.0)
    return float(_SOFTER * thickness * free / (4.0 * mesh.element_area.sum()) * max(0.0, left - shown))


def _left(thickness: float, size: float) -> float:
    """The part of the layer that elements of a size do not know."""
    seen = _SEEN * thickness / size
    return 1.0 - seen * math.tanh(1.0 / seen)


def thickness_at(model: Model, points: Floats) -> Floats:
    """The plate's thickness (n,) at points, or a zone's; the plate's own need not be one where zones have another."""
    found = np.full(len(points), np.nan)
    for zone in (*reversed(model.zone), None):
        left = np.isnan(found)
        inside = left if zone is None else left & zone.region.contains(points)
        formula = model.plate.thickness if zone is None else zone.thickness
        if formula is not None and inside.any():
            found[inside] = np.abs(formula(*points[inside].T))
    return found
