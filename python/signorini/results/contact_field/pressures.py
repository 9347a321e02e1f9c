"""Contact pressures of all areas together: at the nodes of elastic ones, on the elements of rigid ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from signorini.discretise.rows import Bools, Floats, Ints
from signorini.results.contact_field.area_contact import AreaContact
from signorini.results.contact_field.shared_borders import without_shared_borders

_ALONG = 24
"""Places a side at which one looks how much of an element several rigid areas have together."""


@dataclass(frozen=True, eq=False)
class Pressures:
    """Pressures of areas, of any number of solutions (...,), from deflections and from the forces of their points.

    Where areas overlap their pressures add; on a border where they only touch one counts.
    """

    areas: Sequence[AreaContact]

    @cached_property
    def nodes(self) -> Ints:
        """Nodes (k,) on elastic areas."""
        return np.flatnonzero(np.any([area.on_nodes for area in self._elastic], axis=0))

    @cached_property
    def elements(self) -> Ints:
        """Elements (k,) with a part of a rigid area."""
        return np.flatnonzero(np.any([area.covered > 0 for area in self._rigid], axis=0))

    def at_nodes(self, deflection: Floats, forces: Sequence[Floats]) -> Floats:
        """Pressure (..., k) at ``nodes``, from deflections (..., k) there and every area's forces (..., p)."""
        total = np.zeros(deflection.shape)
        for area, on in zip(self._elastic, self._acting, strict=True):
            total += on * area.nodal(self.nodes, deflection, forces[self.areas.index(area)])
        return total

    def on_elements(self, forces: Sequence[Floats]) -> Floats:
        """Mean pressure (..., k) over the part of ``elements`` that is on rigid areas, from every area's forces."""
        total = np.zeros((*forces[0].shape[:-1], len(self.elements)))
        for area in self._rigid:
            into = csr_array(
                (
                    np.ones(len(area.elements)),
                    (np.searchsorted(self.elements, area.elements), range(len(area.elements))),
                ),
                shape=(len(self.elements), len(area.elements)),
            )
            total += (into @ forces[self.areas.index(area)].T).T
        return total / self._part

    @property
    def _elastic(self) -> list[AreaContact]:
        return [area for area in self.areas if area.support.stiffness is not None]

    @property
    def _rigid(self) -> list[AreaContact]:
        return [area for area in self.areas if area.support.stiffness is None]

    @cached_property
    def _acting(self) -> Bools:
        on = np.array([area.on_nodes[self.nodes] for area in self._elastic])
        return without_shared_borders(self._elastic, self._elastic[0].mesh.points[self.nodes], on)

    @cached_property
    def _part(self) -> Floats:
        """Area (k,) of ``elements`` that is on any rigid area."""
        parts = np.array([area.covered[self.elements] for area in self._rigid])
        most, least = parts.sum(axis=0), parts.max(axis=0)
        several = np.flatnonzero(most > least)
        if len(several):
            mesh, along = self._rigid[0].mesh, (np.arange(_ALONG) + 0.5) / _ALONG * 2 - 1
            stations = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
            at = np.repeat(self.elements[several], len(stations))
            places = mesh.spread(self.elements[several], stations).reshape(-1, 2)
            within = np.any([(area.covered[at] > 0) & (area.depth(places) >= 0) for area in self._rigid], axis=0)
            part = within.reshape(len(several), -1).mean(axis=1) * mesh.element_area[self.elements[several]]
            most[several] = np.clip(part, least[several], most[several])
        return np.asarray(most)
