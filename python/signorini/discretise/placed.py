"""Where every support is on the mesh, found once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signorini.discretise.places import Sampled, located, mesh_edges
from signorini.discretise.rows import Ints
from signorini.errors import Place, Problems
from signorini.mesh import Mesh
from signorini.model import Model, Support

_SAME_NODE = 1e-9
"""Part of the plate's size within which a point is a node."""


@dataclass(frozen=True, eq=False)
class Placed:
    """A support on the mesh.

    Parameters
    ----------
    place : path
        Where it stands in the model.
    support : Support
    points : Sampled or None
        Its points, if it is at points; ``nodes`` (q,) are those that they coincide with, −1 where there is none.
    sides : (k, 3) array or None
        Sides of elements along its edge, line or circle, if the mesh follows it.
    """

    place: Place
    support: Support
    points: Sampled | None
    nodes: Ints
    sides: Ints | None

    @property
    def index(self) -> int:
        """Which support of the model it is."""
        return int(self.place[1])


def placed(model: Model, mesh: Mesh, problems: Problems) -> list[Placed]:
    """Place every support; those that cannot be are among the problems."""
    found = []
    for index, support in enumerate(model.support):
        place = ("support", index)
        with problems.collected():
            points = None if support.at is None else located(mesh, support.at, (*place, "at"))
            nodes = np.zeros(0, np.int64) if points is None else _nodes_at(mesh, points)
            found.append(Placed(place, support, points, nodes, mesh_edges(mesh, support, place)))
    return found


def _nodes_at(mesh: Mesh, sampled: Sampled) -> Ints:
    nodes = mesh.elements[sampled.elements]
    offset = mesh.points[nodes] - sampled.positions[:, None]
    distance = np.hypot(offset[..., 0], offset[..., 1])
    picked = np.arange(len(nodes)), distance.argmin(axis=1)
    return np.where(distance[picked] <= _SAME_NODE * mesh.size, nodes[picked], -1)
