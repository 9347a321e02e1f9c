"""The elements that the edge of contact may cross, cut finely: how far the plate is pressed in, and where."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.model import Support
from signorini.results.contact_field.cells import divisions
from signorini.results.contact_field.law import free_travel, overlap
from signorini.shapes.tessellation import Tessellation, tessellate


@dataclass(frozen=True, eq=False)
class Fine:
    """Elements (k,) cut into triangles.

    Parameters
    ----------
    elements : (k,) array
    cut : Tessellation
        Of these elements, in their order.
    positions : (v, 2) array
    overlap : (v,) array
        How far the plate is pressed into the support; negative in a gap, 0 where it touches, NaN where not known.
    """

    elements: Ints
    cut: Tessellation
    positions: Floats
    overlap: Floats

    @classmethod
    def of(cls, mesh: Mesh, elements: Ints, support: Support, deflection: Floats, touching: float) -> Self:
        """Cut elements of an elastic area; what is within ``touching`` of zero is zero."""
        cut = tessellate(mesh.elements[elements], divisions(len(elements)))
        positions = cut.interpolate(mesh.points)
        values = overlap(support, cut.interpolate(deflection), free_travel(support, positions))
        values[np.abs(values) <= touching] = 0.0
        return cls(elements, cut, positions, values)

    @property
    def known(self) -> Ints:
        """Triangles (t, 3) at whose corners the overlap is known."""
        return self.cut.triangles[~np.isnan(self.overlap[self.cut.triangles]).any(axis=1)]

    @property
    def in_contact(self) -> Bools:
        """Vertices (v,) at which the plate presses, or touches beside one at which it presses."""
        pressed = self.overlap > 0
        beside = np.zeros_like(pressed)
        beside[self.cut.triangles[pressed[self.cut.triangles].any(axis=1)]] = True
        return np.asarray(pressed | (beside & (self.overlap == 0)))
