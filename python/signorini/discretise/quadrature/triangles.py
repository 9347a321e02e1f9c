"""Boxes and triangles of the reference square, the triangles cut along lines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from signorini.discretise.quadrature.rules import collapsed, gauss
from signorini.mesh.isoparametric import TRIANGLE_CORNERS

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]

_EMPTY = 1e-14
"""Area, over that of the box it is part of, below which a triangle is left out."""


@dataclass(frozen=True, eq=False)
class Triangles:
    """Triangles with the box (t,) each is a part of, corners (t, 3, 2), and the area (t,) of the box."""

    box: Ints
    corners: Floats
    of: Floats

    @classmethod
    def of_boxes(cls, which: Ints, boxes: Floats) -> Triangles:
        """Halve boxes (k, 4), their lower and upper corners, along a diagonal; ``which`` (k,) are their numbers."""
        x0, y0, x1, y1 = boxes.T
        a, b, c, d = (np.column_stack(corner) for corner in ((x0, y0), (x1, y0), (x1, y1), (x0, y1)))
        corners = np.stack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)], axis=1)
        return cls(np.repeat(which, 2), corners.reshape(-1, 3, 2), np.repeat((x1 - x0) * (y1 - y0), 2))

    def take(self, which: Bools) -> Triangles:
        """Select some."""
        return Triangles(self.box[which], self.corners[which], self.of[which])

    @property
    def area(self) -> Floats:
        """Areas (t,)."""
        (ax, ay), (bx, by) = ((self.corners[:, i] - self.corners[:, 0]).T for i in (1, 2))
        return np.asarray(0.5 * np.abs(ax * by - ay * bx))


def split(triangles: Triangles, planes: Floats, changes: Bools) -> tuple[Triangles, Ints, Floats]:
    """Cut triangles along the zeros of their boxes' planes.

    Parameters
    ----------
    triangles : Triangles
        What is to be cut.
    planes, changes : (c, 3), (c,) arrays
        For every box a function p0 + p1 x + p2 y, and whether it cuts the box at all.

    Returns
    -------
    Triangles
        Those that were not cut, and the parts of the others.
    (f,) int array, (f, 2, 2) array
        Boxes and ends of the cuts.
    """
    own = triangles.box
    value = planes[own, :1] + np.einsum("tij,tj->ti", triangles.corners, planes[own, 1:])
    above = value > 0.0
    count = above.sum(axis=1)
    cut = changes[own] & (count > 0) & (count < 3)
    if not cut.any():
        return triangles, np.zeros(0, dtype=np.int64), np.zeros((0, 2, 2))
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
        np.concatenate([triangles.of[~cut], np.tile(triangles.of[cut], 3)]),
    )
    there = made.area > _EMPTY * made.of
    return Triangles(made.box[there], made.corners[there], made.of[there]), own[cut], ends


def gauss_on_triangles(triangles: Triangles, order: int) -> tuple[Ints, Floats, Floats]:
    """Boxes (q,), points (q, 2) and weights (q,) of Gauss rules collapsed to the triangles."""
    unit, weights = collapsed(TRIANGLE_CORNERS[:3], gauss(order), gauss(order))
    shape, weights = np.column_stack([1.0 - unit.sum(axis=1), unit]), 2.0 * weights
    points = np.einsum("sk,tkd->tsd", shape, triangles.corners).reshape(-1, 2)
    return np.repeat(triangles.box, order**2), points, (triangles.area[:, None] * weights).ravel()


def gauss_on_boxes(boxes: Floats, order: int) -> tuple[Ints, Floats, Floats]:
    """Boxes (q,), points (q, 2) and weights (q,) of Gauss rules on boxes (k, 4)."""
    node, weight = np.polynomial.legendre.leggauss(order)
    station = np.stack(np.meshgrid(node, node, indexing="ij"), axis=-1).reshape(-1, 2)
    middle, half = 0.5 * (boxes[:, :2] + boxes[:, 2:]), 0.5 * (boxes[:, 2:] - boxes[:, :2])
    points = middle[:, None] + half[:, None] * station
    weights = half.prod(axis=1)[:, None] * np.outer(weight, weight).ravel()
    return np.repeat(np.arange(len(boxes)), order**2), points.reshape(-1, 2), weights.ravel()
