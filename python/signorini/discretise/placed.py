"""Where every support is on the mesh, found once."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from signorini.discretise.footprints import Footprints
from signorini.discretise.places import Sampled, located, mesh_edges
from signorini.discretise.quadrature import Quadrature
from signorini.discretise.rows import Floats, Ints
from signorini.errors import Place, Problems
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import BoxTree
from signorini.model import Model, Support


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
    footprints : list of Quadrature
        What each of its points is spread over, if it is; such points coincide with no node.
    """

    place: Place
    support: Support
    points: Sampled | None
    nodes: Ints
    sides: Ints | None
    footprints: list[Quadrature]

    @property
    def index(self) -> int:
        """Which support of the model it is."""
        return int(self.place[1])


def placed(model: Model, mesh: Mesh, problems: Problems) -> list[Placed]:
    """Place every support; those that cannot be are among the problems."""
    result = []
    on_mesh = Footprints(mesh, model.support)
    taken, both = np.zeros((0, 2)), np.zeros(0, np.bool_)
    for index, support in enumerate(model.support):
        place = ("support", index)
        with problems.collected():
            points, nodes = None, np.zeros(0, np.int64)
            footprints = on_mesh.of(support, place)
            if support.at is not None:
                points, nodes = located(mesh, support.at, (*place, "at")), np.full(len(support.at), -1)
            if points is not None and not footprints:
                holds = support.fix is not None or support.resists in (None, "both")
                points, nodes = _at_one_place(mesh, points, taken if holds else taken[both])
                taken = np.concatenate([taken, points.positions])
                both = np.append(both, np.full(len(points.positions), holds))
            result.append(
                Placed(place, support, points, nodes, mesh_edges(mesh, model.plate, support, place), footprints)
            )
    return result


def _at_one_place(mesh: Mesh, sampled: Sampled, taken: Floats) -> tuple[Sampled, Ints]:
    """Put points that are all but at a node, or at a point (k, 2) that is taken, at just that; return the nodes too.

    Where one of two points holds both ways, what they say of the plate is then the same, and not nearly the same, which
    rounding would take for two things. Of two that only press one may always let go.
    """
    nodes = _nodes_at(mesh, sampled)
    positions = np.where((nodes >= 0)[:, None], mesh.points[nodes], sampled.positions)
    if len(taken):
        reach = mesh.near.place * np.array([-1.0, -1.0, 1.0, 1.0])
        mine, others = BoxTree.build(np.tile(taken, 2) + reach).pairs(positions)
        # Of several the first, which others are at too.
        for point, other in sorted(zip(mine.tolist(), others.tolist(), strict=True), reverse=True):
            positions[point] = positions[point] if nodes[point] >= 0 else taken[other]
    if (positions == sampled.positions).all():
        return sampled, nodes
    where = mesh.locate(positions)
    return replace(sampled, elements=where.elements, xi=where.xi), nodes


def _nodes_at(mesh: Mesh, sampled: Sampled) -> Ints:
    nodes = mesh.elements[sampled.elements]
    offset = mesh.points[nodes] - sampled.positions[:, None]
    distance = np.hypot(offset[..., 0], offset[..., 1])
    picked = np.arange(len(nodes)), distance.argmin(axis=1)
    return np.where(distance[picked] <= mesh.near.place, nodes[picked], -1)
