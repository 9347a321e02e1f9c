"""The isoparametric maps of the 8-node quadrilateral and the 6-node triangle, and their inverses.

A triangle has the eight nodes [a, b, c, c, ab, bc, c, ca] and reference points (r, s), 0 ≤ r, s and r + s ≤ 1. A
degenerate quadrilateral, whose first side is the node c, has the nodes [c, c, a, b, c, ca, ab, bc] and keeps the
reference points and the map of a quadrilateral.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce
from typing import Final

import numpy as np

from signorini._core import serendipity, triangular
from signorini.shapes.arrays import Bools, Floats, Ints

REACH: Final = 1.5
ITERATIONS: Final = 20
SIDES: Final = ((0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0))
CORNERS: Final = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
TRIANGLE_CORNERS: Final = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0]])
CENTROID: Final = np.array([1.0, 1.0]) / 3.0
_SINGULAR: Final = 1e-12
"""Largest singular value of J that counts as zero, relative to the larger one; at a collapsed side one is zero."""
_AT_A_TIME = 1024
"""Number of elements whose Jacobians are computed at once, so that they fit in the cache."""
_SAMPLES = np.stack(np.meshgrid(*2 * [np.linspace(-1.0, 1.0, 5)], indexing="ij"), axis=-1).reshape(-1, 2)


def are_triangles(elements: Ints) -> Bools:
    """Mask (ne,) of the triangles among elements (ne, 8): their third and fourth corners are equal."""
    return np.asarray(elements[:, 2] == elements[:, 3])


def are_degenerate(elements: Ints) -> Bools:
    """Mask (ne,) of the degenerate quadrilaterals among elements (ne, 8): their first two corners are equal."""
    return np.asarray(elements[:, 0] == elements[:, 1])


def real_sides(elements: Ints) -> Bools:
    """Mask (ne, 4) of the sides that are not collapsed to a node.

    Collapsed are the third side of triangles and the first side of degenerate quadrilaterals.
    """
    sides = np.arange(4)
    collapsed = are_triangles(elements)[:, None] & (sides == 2) | are_degenerate(elements)[:, None] & (sides == 0)
    return np.asarray(~collapsed)


def shape_functions(triangles: Bools, xi: Floats) -> tuple[Floats, Floats]:
    """Shape functions (q, 8) and their gradients ∂N/∂ξ (q, 8, 2) at reference points (q, 2).

    ``triangles`` (q,) is the mask of points in triangles; the others are in quadrilaterals.
    """
    if not triangles.any():
        return serendipity(xi)
    if triangles.all():
        return triangular(xi)
    values, gradients = serendipity(xi)
    values[triangles], gradients[triangles] = triangular(xi[triangles])
    return values, gradients


def folded(xi: Floats) -> Floats:
    """Map points (s, 2) of the reference square to the reference triangle, with uniform density, by folding."""
    part = 0.5 * (xi + 1.0)
    return np.asarray(np.where(part.sum(axis=1, keepdims=True) > 1.0, 1.0 - part, part))


def _collapsed(nodes: Floats, side: int = 2) -> Bools:
    return np.asarray((nodes[:, side] == nodes[:, side + 1]).all(axis=1))


def jacobians(nodes: Floats, xi: Floats) -> Floats:
    """Jacobians J = ∂x/∂ξ (q, 2, 2) at reference points (q, 2); the first index is the component of x."""
    return np.asarray(np.einsum("qnd,qna->qda", nodes, shape_functions(_collapsed(nodes), xi)[1]))


def determinants(nodes: Floats, xi: Floats, triangles: bool = False) -> Floats:
    """Determinants of J (ne, r) of elements (ne, 8, 2), all triangles or all quadrilaterals, at points ξ (r, 2)."""
    gradients = (triangular if triangles else serendipity)(xi)[1].transpose(0, 2, 1).reshape(-1, 8)
    det = np.empty((len(nodes), len(xi)))
    for first in range(0, len(nodes), _AT_A_TIME):
        block = slice(first, first + _AT_A_TIME)
        j = (gradients @ nodes[block]).reshape(-1, len(xi), 2, 2)
        det[block] = j[..., 0, 0] * j[..., 1, 1] - j[..., 0, 1] * j[..., 1, 0]
    return det


def invert(nodes: Floats, points: Floats) -> tuple[Floats, Bools]:
    """Solve x(ξ) = x for the reference points ξ (q, 2) by Newton's method; also return a mask of convergence.

    ``nodes`` (q, 8, 2) belong to the element of each point (q, 2). Reference coordinates within 1e-10 of −1, 0 or 1
    (triangles: 0, ½ or 1) are rounded to them, so that shape functions at nodes are exactly 0 and 1. A point on a
    collapsed side gets the middle of the side. Points beyond ±1.5 do not converge.
    """
    origin = nodes.mean(axis=1)
    local, target = nodes - origin[:, None], points - origin
    triangles = _collapsed(nodes)
    xi, converged = _newton(local, target, triangles[:, None] * CENTROID)
    failed = np.flatnonzero(~converged)
    if len(failed):
        for kind, starts in ((False, _SAMPLES), (True, folded(_SAMPLES))):
            retry = failed[triangles[failed] == kind]
            samples = np.einsum("sn,qnd->qsd", (triangular if kind else serendipity)(starts)[0], local[retry])
            nearest = np.argmin(((samples - target[retry, None]) ** 2).sum(axis=2), axis=1)
            xi[retry], converged[retry] = _newton(local[retry], target[retry], starts[nearest])
    for special, where in ((-1.0, ~triangles), (0.0, slice(None)), (0.5, triangles), (1.0, slice(None))):
        xi[where] = np.where(np.abs(xi[where] - special) < 1e-10, special, xi[where])
    xi[_collapsed(nodes, 0) & (xi[:, 1] == -1.0), 0] = 0.0
    return xi, converged


def side_boxes(sides: Floats) -> Floats:
    """Bounding boxes (k, 4) xmin, ymin, xmax, ymax of quadratic sides (k, 3, 2), corner, midside, corner."""
    begin, middle, end = np.moveaxis(sides, 1, 0)
    return np.hstack(bounds((begin, 2.0 * middle - 0.5 * (begin + end), end)))


def bounds(points: Iterable[Floats]) -> tuple[Floats, Floats]:
    """Componentwise minimum and maximum (k, 2) of several arrays (k, 2); faster than NumPy along a short axis."""
    arrays = list(points)
    return reduce(np.minimum, arrays), reduce(np.maximum, arrays)


def _newton(nodes: Floats, target: Floats, start: Floats) -> tuple[Floats, Bools]:
    xi = start.copy()
    triangles, degenerate = _collapsed(nodes), _collapsed(nodes, 0)
    converged = np.zeros(len(xi), dtype=bool)
    active = np.arange(len(xi))
    for _ in range(ITERATIONS):
        if not len(active):
            break
        values, gradients = shape_functions(triangles[active], xi[active])
        miss = target[active] - np.einsum("qn,qnd->qd", values, nodes[active])
        j = np.einsum("qnd,qna->qda", nodes[active], gradients)
        det = j[:, 0, 0] * j[:, 1, 1] - j[:, 0, 1] * j[:, 1, 0]
        det[det == 0.0] = np.finfo(float).tiny
        with np.errstate(over="ignore", invalid="ignore"):
            step = np.column_stack(
                [j[:, 1, 1] * miss[:, 0] - j[:, 0, 1] * miss[:, 1], j[:, 0, 0] * miss[:, 1] - j[:, 1, 0] * miss[:, 0]]
            )
            step = np.nan_to_num(step / det[:, None])
        if (singular := degenerate[active]).any():
            # At a collapsed side J is singular, so the least-norm step is taken.
            step[singular] = np.einsum("qab,qb->qa", np.linalg.pinv(j[singular], rcond=_SINGULAR), miss[singular])
        step = np.clip(step, -REACH, REACH)
        moved = np.clip(xi[active] + step, -REACH, REACH)
        done = (np.abs(step).max(axis=1) < 1e-13) & (np.abs(moved).max(axis=1) < REACH)
        # Far from the origin, rounding may keep steps above the tolerance; after the loop the residual then decides.
        xi[active], converged[active] = moved, done
        active = active[~done]
    if len(active):
        values, _ = shape_functions(triangles[active], xi[active])
        miss = np.abs(target[active] - np.einsum("qn,qnd->qd", values, nodes[active])).max(axis=1)
        converged[active] = (miss < 1e-12 * np.ptp(nodes[active], axis=1).max(axis=1)) & (
            np.abs(xi[active]).max(axis=1) < REACH
        )
    return xi, converged
