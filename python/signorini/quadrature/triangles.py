"""Triangles of the reference square, cut along lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]

_EMPTY = 1e-14
"""Area, over that of its square, below which a triangle is left out."""


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles with the square (t,) each is a part of, corners (t, 3, 2), and the half side of the squares."""

    square: Ints
    corners: Floats
    half: float

    @classmethod
    def of_squares(cls, square: Ints, middle: Floats, half: float) -> Triangles:
        """Halve squares (k,) along a diagonal."""
        signs = np.array([[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]], [[-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]])
        corners = middle[:, None, None] + half * signs
        return cls(np.repeat(square, 2), corners.reshape(-1, 3, 2), half)

    @property
    def area(self) -> Floats:
        """Areas (t,)."""
        (ax, ay), (bx, by) = ((self.corners[:, i] - self.corners[:, 0]).T for i in (1, 2))
        return np.asarray(0.5 * np.abs(ax * by - ay * bx))


def split(
    triangles: Triangles, middle: Floats, planes: Floats, changes: Bools
) -> tuple[Triangles, tuple[Ints, Floats]]:
    """Cut triangles along the zeros of their squares' planes.

    Parameters
    ----------
    triangles : Triangles
        What is to be cut.
    middle, planes, changes : (c, 2), (c, 3), (c,) arrays
        Middles of all squares, value and slopes there of a function, and whether it cuts the square at all.

    Returns
    -------
    Triangles
        Those that were not cut, and the parts of the others.
    tuple
        Squares (f,) and ends (f, 2, 2) of the cuts.
    """
    own = triangles.square
    value = planes[own, :1] + np.einsum("tij,tj->ti", triangles.corners - middle[own, None], planes[own, 1:])
    above = value > 0.0
    count = above.sum(axis=1)
    cut = changes[own] & (count > 0) & (count < 3)
    if not cut.any():
        return triangles, (np.zeros(0, dtype=np.int64), np.zeros((0, 2, 2)))
    alone = (above[cut] == (count[cut] == 1)[:, None]).argmax(axis=1)
    turn = (alone[:, None] + np.arange(3)) % 3
    rows = np.arange(len(turn))[:, None]
    corners, heights = triangles.corners[cut][rows, turn], value[cut][rows, turn]
    share = (heights[:, :1] / (heights[:, :1] - heights[:, 1:]))[..., None]
    ends = corners[:, :1] + share * (corners[:, 1:] - corners[:, :1])
    p, q, r, a, b = corners[:, 0], corners[:, 1], corners[:, 2], ends[:, 0], ends[:, 1]
    parts = np.concatenate([np.stack(part, axis=1) for part in ((p, a, b), (a, q, r), (a, r, b))])
    made = Triangles(
        np.concatenate([own[~cut], np.tile(own[cut], 3)]),
        np.concatenate([triangles.corners[~cut], parts]),
        triangles.half,
    )
    there = made.area > _EMPTY * made.half**2
    return Triangles(made.square[there], made.corners[there], made.half), (own[cut], ends)


def gauss_on(triangles: Triangles, order: int) -> tuple[Ints, Floats, Floats]:
    """Squares (q,), points (q, 2) and weights (q,) of Gauss rules collapsed to the triangles."""
    node, weight = np.polynomial.legendre.leggauss(order)
    u, v = (a.ravel() for a in np.meshgrid(0.5 + 0.5 * node, 0.5 + 0.5 * node, indexing="ij"))
    shape = np.column_stack([1.0 - u, u * (1.0 - v), u * v])
    weights = 2.0 * u * 0.25 * np.outer(weight, weight).ravel()
    points = np.einsum("sk,tkd->tsd", shape, triangles.corners).reshape(-1, 2)
    return np.repeat(triangles.square, order**2), points, (triangles.area[:, None] * weights).ravel()
