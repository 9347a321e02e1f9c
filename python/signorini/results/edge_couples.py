"""Couples per length that edges hold."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from signorini.discretise.rows import Floats
from signorini.mesh import Mesh

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_SHAPES = np.column_stack([_POINTS * (_POINTS - 1) / 2, 1 - _POINTS**2, _POINTS * (_POINTS + 1) / 2])
_SLOPES = np.column_stack([_POINTS - 0.5, -2 * _POINTS, _POINTS + 0.5])
"""The quadratic functions of a side's three nodes, and their derivatives, at Gauss points."""


@dataclass(frozen=True, eq=False)
class EdgeCouples:
    """Mean couple per length on every side of an element along edges that hold the slope.

    Parameters
    ----------
    sides : (k, 2, 2) array
        Where each side begins and ends, the plate on its left.
    couples : (k,) array
        The plate's moment across the edge, positive where it sags.
    """

    sides: Floats
    couples: Floats


def edge_couples(mesh: Mesh, edges: Sequence[str], nodal: Floats) -> EdgeCouples:
    """Spread nodal couples (n, 2) along edges: the quadratic moment per length that is worth as much at every node.

    This recovery of boundary fluxes is as accurate as the nodal forces (Hughes, Engel, Mazzei and Larson 2000).

    Examples
    --------
    >>> from signorini.mesh.meshers import rectangle
    >>> mesh = rectangle((0.0, 0.0), (4.0, 2.0), (1, 1))
    >>> nodal = np.zeros((8, 2))
    >>> nodal[mesh.edges["right"][0], 0] = 2.0 * np.array([1, 4, 1]) / 6
    >>> edge_couples(mesh, ["right"], nodal).couples.round(12).tolist()
    [1.0]
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    triples = np.concatenate([mesh.edges[name] for name in edges])
    nodes, local = np.unique(triples, return_inverse=True)
    local = local.reshape(triples.shape)
    x, y = np.moveaxis(mesh.points[triples], -1, 0)
    tx, ty = x @ _SLOPES.T, y @ _SLOPES.T
    length = np.hypot(tx, ty) * _WEIGHTS
    mass = np.einsum("kg,gi,gj->kij", length, _SHAPES, _SHAPES)
    row, column = np.broadcast_arrays(local[:, :, None], local[:, None, :])
    matrix = coo_array((mass.ravel(), (row.ravel(), column.ravel())), shape=(len(nodes),) * 2).tocsc()
    moment = spsolve(matrix, nodal[nodes])[local]
    across = np.stack([ty, -tx], axis=-1) * _WEIGHTS[:, None]
    couples = np.einsum("kgc,gi,kic->k", across, _SHAPES, moment) / length.sum(axis=1)
    return EdgeCouples(mesh.points[triples[:, [0, 2]]], couples)
