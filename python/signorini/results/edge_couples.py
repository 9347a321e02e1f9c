"""Couples per length that edges hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from signorini.discretise.places import quadratic_tangents, side_lengths
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh

_CORNER = np.cos(np.radians(15.0))
"""Where an edge turns by more it has a corner: sides of a circle, which are parabolas, turn by less than 1°."""


@dataclass(frozen=True, eq=False)
class EdgeCouples:
    """Mean couple per length (k,) with which a support holds sides of elements (k, 2, 2) along its edges.

    Each side has the plate on its left. None is within a rigid zone or inside the plate. A couple acts across the edge,
    positive where the plate sags.
    """

    sides: Floats
    couples: Floats

    @classmethod
    def of(cls, mesh: Mesh, edges: Sequence[str], nodal: Floats, held: Ints, rigid: Bools) -> Self:
        """Spread couples (n, 2) that hold nodes over the lengths that these stand for, as consistent nodal forces do.

        What holds a node at a corner of two ``held`` sides (h, 3), or one of a rigid zone (n,), is not of one side
        alone: there the other nodes of the side tell its mean.

        Examples
        --------
        >>> from signorini.mesh.meshers import rectangle
        >>> mesh = rectangle((0.0, 0.0), (4.0, 2.0), (1, 2))
        >>> nodal, none = np.zeros((mesh.node_count, 2)), np.zeros(mesh.node_count, np.bool_)
        >>> nodal[mesh.edges["right"].ravel(), 0] = [1 / 6, 4 / 6, 1 / 6, 1 / 6, 4 / 6, 1 / 6]
        >>> nodal[mesh.edges["right"][0, 2], 0] *= 2
        >>> EdgeCouples.of(mesh, ["right"], nodal, mesh.edges["right"], none).couples.round(12).tolist()
        [1.0, 1.0]
        """
        sides = np.concatenate([mesh.edges[name] for name in edges])
        sides = sides[np.sort(np.unique(sides[:, 1], return_index=True)[1])]
        outer = mesh.sides[mesh.on_boundary][:, 1]
        sides = sides[np.isin(sides[:, 1], outer) & ~rigid[sides].all(axis=1)]
        length = side_lengths(mesh, sides)
        whole = np.bincount(sides.ravel(), length.ravel(), mesh.node_count)
        tangents = quadratic_tangents(mesh, sides)
        across = tangents[..., 1] * nodal[sides, 0] - tangents[..., 0] * nodal[sides, 1]
        own = np.where(_of_the_edge_alone(sides, tangents, held, rigid), length, 0.0)
        couples = (own * across / whole[sides]).sum(axis=1) / own.sum(axis=1)
        return cls(mesh.points[sides[:, [0, 2]]], couples)


def _of_the_edge_alone(sides: Ints, tangents: Floats, held: Ints, rigid: Bools) -> Bools:
    """Whether no other held side meets sides (k, 3) at their nodes, but for one in which they go on."""
    _, once = np.unique(held[:, 1], return_index=True)
    meeting = np.bincount(held[once][:, [0, 2]].ravel(), minlength=len(rigid))
    begin, end = (np.zeros((len(rigid), 2)) for _ in range(2))
    begin[sides[:, 0]], end[sides[:, 2]] = tangents[:, 0], tangents[:, 2]
    goes_on = (begin * end).sum(axis=1) > _CORNER
    result = ((meeting < 2) | ((meeting == 2) & goes_on)) & ~rigid
    result[sides[:, 1]] = True
    return np.asarray(result[sides])
