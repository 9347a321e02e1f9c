"""Couples per length that edges hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_SHAPES = np.column_stack([_POINTS * (_POINTS - 1) / 2, 1 - _POINTS**2, _POINTS * (_POINTS + 1) / 2])
_SLOPES = np.column_stack([_POINTS - 0.5, -2 * _POINTS, _POINTS + 0.5])
"""The quadratic functions of a side's three nodes, and their derivatives, at Gauss points."""
_AT_ENDS = np.array([[-1.5, 2.0, -0.5], [0.5, -2.0, 1.5]])
"""Their derivatives at both ends."""
_CORNER = np.cos(np.radians(15.0))
"""Where an edge turns by more it has a corner: sides of a circle, which are parabolas, turn by less than 1°."""


@dataclass(frozen=True, eq=False)
class EdgeCouples:
    """Mean couple per length with which a support holds every side of an element along its edges.

    Parameters
    ----------
    sides : (k, 2, 2) array
        Where each side begins and ends, the plate on its left. None is within a rigid zone or inside the plate.
    couples : (k,) array
        Across the edge, positive where the plate sags.
    """

    sides: Floats
    couples: Floats


def edge_couples(mesh: Mesh, edges: Sequence[str], nodal: Floats, held: Ints, rigid: Bools) -> EdgeCouples:
    """Spread nodal couples (n, 2) along edges: the quadratic moment per length that is worth as much at every node.

    This recovery of boundary fluxes is as accurate as the nodal forces (Hughes, Engel, Mazzei and Larson 2000). What
    holds a node where two ``held`` sides (h, 3) meet at a corner, or one of a rigid zone (n,), is not of one alone.
    There the moment is linear over the side in place of worth as much.

    Examples
    --------
    >>> from signorini.mesh.meshers import rectangle
    >>> mesh = rectangle((0.0, 0.0), (4.0, 2.0), (1, 2))
    >>> nodal = np.zeros((mesh.node_count, 2))
    >>> nodal[mesh.edges["right"].ravel(), 0] = [1 / 6, 4 / 6, 1 / 6, 1 / 6, 4 / 6, 1 / 6]
    >>> nodal[mesh.edges["right"][0, 2], 0] *= 2
    >>> none = np.zeros(mesh.node_count, np.bool_)
    >>> edge_couples(mesh, ["right"], nodal, mesh.edges["right"], none).couples.round(12).tolist()
    [1.0, 1.0]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    sides = np.concatenate([mesh.edges[name] for name in edges])
    sides = sides[np.sort(np.unique(sides[:, 1], return_index=True)[1])]
    outer = mesh.sides[mesh.on_boundary][:, 1]
    sides = sides[np.isin(sides[:, 1], outer) & ~rigid[sides].all(axis=1)]
    at = mesh.points[sides]
    if not len(sides):
        return EdgeCouples(at[:, [0, 2]], np.zeros(0))
    _, once = np.unique(held[:, 1], return_index=True)
    alone = (np.bincount(held[once][:, [0, 2]].ravel(), minlength=mesh.node_count) == 1) & ~rigid
    places, smooth = _unknowns(sides, np.einsum("ej,kjc->kec", _AT_ENDS, at), rigid)
    smooth |= alone[sides]
    x, y = np.moveaxis(at, -1, 0)
    tx, ty = x @ _SLOPES.T, y @ _SLOPES.T
    length = np.hypot(tx, ty) * _WEIGHTS
    mass = np.einsum("kg,gi,gj->kij", length, _SHAPES, _SHAPES)
    mass *= smooth[:, :, None]
    # Linear, or on a side between two corners constant.
    between = ~smooth[:, 0] & ~smooth[:, 2]
    for end, (linear, constant) in {0: ([1, -2, 1], [1, -1, 0]), 2: ([1, -2, 1], [0, -1, 1])}.items():
        free = ~smooth[:, end]
        mass[free, end] = np.where(between[free, None], constant, linear)
    row, column = np.broadcast_arrays(places[:, :, None], places[:, None, :])
    count = int(places.max()) + 1
    matrix = coo_array((mass.ravel(), (row.ravel(), column.ravel())), shape=(count, count)).tocsc()
    worth = np.zeros((count, 2))
    worth[places[smooth]] = nodal[sides[smooth]]
    moment = spsolve(matrix, worth)[places]
    across = np.stack([ty, -tx], axis=-1) * _WEIGHTS[:, None]
    couples = np.einsum("kgc,gi,kic->k", across, _SHAPES, moment) / length.sum(axis=1)
    return EdgeCouples(at[:, [0, 2]], couples)


def _unknowns(sides: Ints, tangents: Floats, rigid: Bools) -> tuple[Ints, Bools]:
    """Number the unknowns of sides (k, 3), and say which are at midsides or where a side goes on in another."""
    begins = {node: side for side, node in enumerate(sides[:, 0].tolist())}
    unit = tangents / np.linalg.norm(tangents, axis=2)[:, :, None]
    places = np.arange(sides.size).reshape(sides.shape)
    smooth = np.zeros(sides.shape, np.bool_)
    smooth[:, 1] = True
    for side, node in enumerate(sides[:, 2].tolist()):
        after = begins.get(node)
        if after is not None and not rigid[node] and unit[side, 1] @ unit[after, 0] > _CORNER:
            places[after, 0] = places[side, 2]
            smooth[side, 2] = smooth[after, 0] = True
    _, numbers = np.unique(places, return_inverse=True)
    return numbers.reshape(sides.shape), smooth
