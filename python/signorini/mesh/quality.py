"""How well the elements of a mesh are shaped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from signorini.mesh.isoparametric import are_degenerate
from signorini.mesh.mesh import Mesh


@dataclass(frozen=True)
class Quality:
    """The smallest angle at a corner of an element, its corner, and the share of the area in quadrilaterals."""

    angle: float
    corner: tuple[float, float]
    quadrilaterals: float

    @classmethod
    def of(cls, mesh: Mesh) -> Self:
        """Measure a mesh, by the straight lines between corners; angles in degrees."""
        at = mesh.nodes[:, :4]
        onward, back = np.roll(at, -1, axis=1) - at, np.roll(at, 1, axis=1) - at
        # A triangle has its third corner twice, a degenerate quadrilateral its first; each has a side without length.
        third, first = mesh.triangles, are_degenerate(mesh.elements)
        onward[third, 2], back[third, 3] = onward[third, 3], back[third, 2]
        onward[first, 0], back[first, 1] = onward[first, 1], back[first, 0]
        area = onward[..., 0] * back[..., 1] - onward[..., 1] * back[..., 0]
        angle = np.degrees(np.arctan2(area, (onward * back).sum(axis=-1))) % 360.0
        # Rounding must not choose among right angles.
        element, corner = np.unravel_index(np.argmin(angle.round(9)), angle.shape)
        x, y = at[element, corner].tolist()
        share = float(mesh.element_area[~third].sum() / mesh.element_area.sum())
        return cls(float(angle.round(9)[element, corner]), (x, y), share)
