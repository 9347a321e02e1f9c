"""Rigid zones as bodies: the nodes of each follow one of them, their leader, which has the three dofs of the body."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from scipy.sparse import csr_array

from signorini.base.components import components
from signorini.discretise.meshing import to_follow
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.zones import Zones
from signorini.errors import InputError, Problems, point
from signorini.mesh import Mesh


@dataclass(frozen=True, eq=False)
class Bodies:
    """Which nodes move together.

    Parameters
    ----------
    points : (n, 2) array
    leaders : (n,) array
        The node that each follows; a node in no body follows itself.
    inside : (n,) bool array
        Nodes of a body, leaders included.
    rigid : (ne,) bool array
        Elements all of whose nodes are of one body.
    """

    points: Floats
    leaders: Ints
    inside: Bools
    rigid: Bools

    @classmethod
    def none(cls, mesh: Mesh) -> Self:
        """Let every node move by itself."""
        every = np.arange(mesh.node_count)
        return cls(mesh.points, every, np.zeros(len(every), np.bool_), np.zeros(len(mesh.elements), np.bool_))

    @classmethod
    def of(cls, mesh: Mesh, zones: Zones, problems: Problems) -> Self:
        """Join the nodes of rigid zones; zones that share a node are one body. Cut elements are among the problems.

        Examples
        --------
        >>> from signorini.mesh.meshers import rectangle
        >>> from signorini.model import Model
        >>> model = Model(
        ...     material={"E": 30e9, "nu": 0.2},
        ...     plate={"shape": "rectangle", "size": [4, 1], "thickness": 0.2},
        ...     zone=[{"area": {"rectangle": [2, 0, 4, 1]}, "rigid": True}],
        ...     load=[{"pressure": 1e3}],
        ... )
        >>> mesh = rectangle((0.0, 0.0), (4.0, 1.0), (4, 1))
        >>> bodies = Bodies.of(mesh, Zones.of(model, mesh, Problems()), Problems())
        >>> bodies.rigid.tolist(), np.flatnonzero(bodies.inside).tolist(), set(bodies.leaders[bodies.inside].tolist())
        ([False, False, True, True], [4, 5, 6, 7, 8, 11, 12, 13, 18, 19, 20, 21, 22], {4})
        """
        numbers = [number for number, zone in enumerate(zones.model.zone) if zone.rigid]
        if not numbers:
            return cls.none(mesh)
        for number in numbers:
            with problems.collected():
                _require_followed(mesh, zones, number)
        elements = mesh.elements[zones.inside[numbers].any(axis=0)]
        group = components(mesh.node_count, np.repeat(elements[:, 0], 7), elements[:, 1:].ravel())
        first = np.unique(group, return_index=True)[1]
        inside = np.zeros(mesh.node_count, np.bool_)
        inside[elements] = True
        leading = group[mesh.elements]
        rigid = (leading == leading[:, :1]).all(axis=1)
        return cls(mesh.points, first[group], inside, rigid)

    @cached_property
    def motion(self) -> csr_array:
        """Displacements of all nodes by those of the nodes that lead them (3n, 3n)."""
        n, dofs = len(self.points), 3 * self.leaders
        following = np.flatnonzero(self.leaders != np.arange(n))
        arms = self.points[following] - self.points[self.leaders[following]]
        rows = np.concatenate([np.arange(3 * n), np.repeat(3 * following, 2)])
        columns = np.concatenate(
            [(dofs[:, None] + np.arange(3)).ravel(), (dofs[following, None] + np.arange(1, 3)).ravel()]
        )
        return csr_array((np.append(np.ones(3 * n), arms.ravel()), (rows, columns)), shape=(3 * n, 3 * n))

    def onto_leaders(self, rows: csr_array) -> csr_array:
        """Rows (m, 3n) over all nodes as rows over those that lead them."""
        return csr_array(rows @ self.motion) if self.inside.any() else rows


def _require_followed(mesh: Mesh, zones: Zones, number: int) -> None:
    """Refuse a rigid zone whose outline cuts elements: a part of an element cannot be rigid."""
    cut = np.flatnonzero(zones.parted[number])
    if not len(cut) and zones.inside[number].any():
        return
    at = f" at {point(mesh.points[mesh.elements[cut[0], :4]].mean(axis=0), mesh.size)}" if len(cut) else ""
    raise InputError(
        f"The outline of this rigid zone cuts the element{at}, and elements are rigid as a whole. "
        f"{to_follow(zones.model, 'around it')}",
        place=("zone", number, "area"),
    )
