"""The elements that the edge of contact may cross, cut finely: how far the plate is pressed in, and where."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Self

import numpy as np

from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.results.contact_field.parts import both_positive_part
from signorini.shapes.tessellation import Tessellation, tessellate

_FINEST = 12
_MOST_CELLS = 1_000_000


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
    def around(
        cls,
        mesh: Mesh,
        elements: Ints,
        others: Bools,
        deflection: Floats,
        overlap: Callable[[Floats, Floats], Floats],
        touching: float,
    ) -> Self:
        """Cut elements, and those ``others`` (ne,) of the mesh into which the edge of contact leaves them.

        ``overlap`` is a function of deflections and positions; what is within ``touching`` of zero is zero.
        """
        while True:
            wanted = 2 * round(np.sqrt(_MOST_CELLS / max(len(elements), 1)) / 2)
            cut = tessellate(mesh.elements[elements], int(np.clip(wanted, 2, _FINEST)))
            positions = cut.interpolate(mesh.points)
            values = overlap(cut.interpolate(deflection), positions)
            values[np.abs(values) <= touching] = 0.0
            on_sides = values[cut.edges]
            left = cut.outer & (on_sides > 0).any(axis=1) & (on_sides < 0).any(axis=1)
            more = others & np.isin(mesh.elements[:, 4:], cut.midsides[left]).any(axis=1)
            more[elements] = False
            if not more.any():
                return cls(elements, cut, positions, values)
            elements = np.union1d(elements, np.flatnonzero(more))

    @property
    def known(self) -> Ints:
        """Triangles (t, 3) at whose corners the overlap is known."""
        return self.cut.triangles[self._known]

    @property
    def _known(self) -> Bools:
        return np.asarray(~np.isnan(self.overlap[self.cut.triangles]).any(axis=1))

    @property
    def in_contact(self) -> Bools:
        """Vertices (v,) at which the plate presses, or touches beside one at which it presses."""
        pressed = self.overlap > 0
        beside = np.zeros_like(pressed)
        beside[self.cut.triangles[pressed[self.cut.triangles].any(axis=1)]] = True
        return np.asarray(pressed | (beside & (self.overlap == 0)))

    def parts(self, depths: Floats) -> Floats:
        """Part (k,) in contact of what each element has where ``depths`` (v,) are positive; NaN where that is nothing.

        Overlap and depths are taken as linear on the triangles.
        """
        triangles, count = self.known, len(self.elements)
        owner = self.cut.parents[self._known]
        corners = self.positions[triangles]
        (ux, uy), (vx, vy) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
        area, inside, overlap = 0.5 * (ux * vy - uy * vx), depths[triangles], self.overlap[triangles]
        # A triangle that only touches everywhere is in contact if those beside it are.
        part = both_positive_part(inside, overlap) * self.in_contact[triangles].any(axis=1)
        pressed = np.bincount(owner, area * part, count)
        whole = np.bincount(owner, area * both_positive_part(inside, np.ones_like(inside)), count)
        return np.where(whole > 0, pressed / np.where(whole > 0, whole, 1.0), np.nan)
