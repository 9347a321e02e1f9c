"""The maps of the 8-node quadrilateral and of the 6-node triangle from reference points to the plate, and back.

A triangle has the eight nodes [a, b, c, c, ab, bc, c, ca] and reference points (r, s), 0 ≤ r, s and r + s ≤ 1. A
degenerate quadrilateral, whose first side is the node c, has the nodes [c, c, a, b, c, ca, ab, bc] and keeps the
reference points and the map of a quadrilateral.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
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
"""Relative tolerance for a zero singular value of a Jacobian: one is zero at a collapsed side."""
_AT_A_TIME = 1024
"""Elements whose Jacobians stay in the cache while they are worked on."""
_SAMPLES = np.stack(np.meshgrid(*2 * [np.linspace(-1.0, 1.0, 5)], indexing="ij"), axis=-1).reshape(-1, 2)


def are_triangles(elements: Ints) -> Bools:
    """Tell which elements (ne, 8) are triangles (ne,): their third corner comes twice."""
    return np.asarray(elements[:, 2] == elements[:, 3])


def are_degenerate(elements: Ints) -> Bools:
    """Tell which elements (ne, 8) are degenerate quadrilaterals (ne,): their first corner comes twice."""
    return np.asarray(elements[:, 0] == elements[:, 1])


def real_sides(elements: Ints) -> Bools:
    """Tell which sides (ne, 4) have a length: all but the third of triangles and the first of degenerate elements."""
    sides = np.arange(4)
    none = are_triangles(elements)[:, None] & (sides == 2) | are_degenerate(elements)[:, None] & (sides == 0)
    return np.asarray(~none)


def shape_functions(triangles: Bools, xi: Floats) -> tuple[Floats, Floats]:
    """Values (q, 8) and reference gradients (q, 8, 2) at reference points (q, 2) of triangles or quadrilaterals."""
    if not triangles.any():
        return serendipity(xi)
    if triangles.all():
        return triangular(xi)
    values, gradients = serendipity(xi)
    values[triangles], gradients[triangles] = triangular(xi[triangles])
    return values, gradients


def folded(xi: Floats) -> Floats:
    """Take points (s, 2) spread over the reference square to points spread as evenly over the triangle."""
    part = 0.5 * (xi + 1.0)
    return np.asarray(np.where(part.sum(axis=1, keepdims=True) > 1.0, 1.0 - part, part))


def _collapsed(nodes: Floats, side: int = 2) -> Bools:
    return np.asarray((nodes[:, side] == nodes[:, side + 1]).all(axis=1))


def jacobians(nodes: Floats, xi: Floats) -> Floats:
    """Differentiate the position (first index of 2, 2) by the reference coordinates (second index) at points (q, 2)."""
    return np.asarray(np.einsum("qnd,qna->qda", nodes, shape_functions(_collapsed(nodes), xi)[1]))


def determinants(nodes: Floats, xi: Floats, triangles: bool = False) -> Floats:
    """Jacobian determinants (ne, r) of elements (ne, 8, 2), all triangles or none, at the same points (r, 2)."""
    gradients = (triangular if triangles else serendipity)(xi)[1].transpose(0, 2, 1).reshape(-1, 8)
    result = np.empty((len(nodes), len(xi)))
    for first in range(0, len(nodes), _AT_A_TIME):
        some = slice(first, first + _AT_A_TIME)
        j = (gradients @ nodes[some]).reshape(-1, len(xi), 2, 2)
        result[some] = j[..., 0, 0] * j[..., 1, 1] - j[..., 0, 1] * j[..., 1, 0]
    return result


def invert(nodes: Floats, points: Floats) -> tuple[Floats, Bools]:
    """Find the reference points of positions, by Newton's method.

    Each point (q, 2) is looked for in the element with its nodes (q, 8, 2). Reference coordinates within 1e-10 of −1, 0
    or 1, of triangles of 0, ½ or 1, are these numbers, so that shape functions at nodes are exactly 0 and 1. A
    collapsed side is reached in its middle. The second array says which points were reached: none farther out than 1.5
    in reference coordinates.
    """
    origin = nodes.mean(axis=1)
    local, target = nodes - origin[:, None], points - origin
    triangles = _collapsed(nodes)
    xi, result = _newton(local, target, triangles[:, None] * CENTROID)
    lost = np.flatnonzero(~result)
    if len(lost):
        for kind, starts in ((False, _SAMPLES), (True, folded(_SAMPLES))):
            some = lost[triangles[lost] == kind]
            samples = np.einsum("sn,qnd->qsd", (triangular if kind else serendipity)(starts)[0], local[some])
            nearest = np.argmin(((samples - target[some, None]) ** 2).sum(axis=2), axis=1)
            xi[some], result[some] = _newton(local[some], target[some], starts[nearest])
    for special, where in ((-1.0, ~triangles), (0.0, slice(None)), (0.5, triangles), (1.0, slice(None))):
        xi[where] = np.where(np.abs(xi[where] - special) < 1e-10, special, xi[where])
    xi[_collapsed(nodes, 0) & (xi[:, 1] == -1.0), 0] = 0.0
    return xi, result


def side_boxes(sides: Floats) -> Floats:
    """Bound quadratic sides (k, 3, 2) given by corner, midside, corner: (k, 4) xmin, ymin, xmax, ymax."""
    begin, middle, end = np.moveaxis(sides, 1, 0)
    return np.hstack(bounds((begin, 2.0 * middle - 0.5 * (begin + end), end)))


def bounds(points: Iterable[Floats]) -> tuple[Floats, Floats]:
    """Least and largest coordinates (k, 2) of some points (k, 2) each; NumPy is slow along so short an axis."""
    some = list(points)
    return reduce(np.minimum, some), reduce(np.maximum, some)


def _newton(nodes: Floats, target: Floats, start: Floats) -> tuple[Floats, Bools]:
    xi = start.copy()
    triangles, degenerate = _collapsed(nodes), _collapsed(nodes, 0)
    result = np.zeros(len(xi), dtype=bool)
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
        if (of := degenerate[active]).any():
            # A collapsed side is one point: the least of the possible steps is taken.
            step[of] = np.einsum("qab,qb->qa", np.linalg.pinv(j[of], rcond=_SINGULAR), miss[of])
        step = np.clip(step, -REACH, REACH)
        moved = np.clip(xi[active] + step, -REACH, REACH)
        settled = (np.abs(step).max(axis=1) < 1e-13) & (np.abs(moved).max(axis=1) < REACH)
        # Rounding may keep the last steps above the tolerance on elements far from the origin.
        xi[active], result[active] = moved, settled
        active = active[~settled]
    if len(active):
        values, _ = shape_functions(triangles[active], xi[active])
        miss = np.abs(target[active] - np.einsum("qn,qnd->qd", values, nodes[active])).max(axis=1)
        result[active] = (miss < 1e-12 * np.ptp(nodes[active], axis=1).max(axis=1)) & (
            np.abs(xi[active]).max(axis=1) < REACH
        )
    return xi, result


_FANOUT = 4


@dataclass(frozen=True, eq=False)
class BoxTree:
    """Boxes packed four to a parent along a Morton curve (Guttman 1984; Kamel and Faloutsos 1993).

    ``order`` (n,) are the boxes in the order of the leaves; ``levels`` (n_i, 4) those of each level, leaves first, as
    xmin, ymin, xmax, ymax.
    """

    order: Ints
    levels: tuple[Floats, ...]

    @classmethod
    def build(cls, boxes: Floats) -> BoxTree:
        """Build the tree of boxes (n, 4), n ≥ 1, given as xmin, ymin, xmax, ymax."""
        order = np.argsort(_morton(0.5 * (boxes[:, :2] + boxes[:, 2:])), kind="stable")
        levels = [boxes[order]]
        while len(levels[-1]) > _FANOUT:
            below = levels[-1]
            starts = np.arange(0, len(below), _FANOUT)
            lower = np.minimum.reduceat(below[:, :2], starts)
            upper = np.maximum.reduceat(below[:, 2:], starts)
            levels.append(np.hstack([lower, upper]))
        return cls(order, tuple(levels))

    def pairs(self, points: Floats) -> tuple[Ints, Ints]:
        """Find indices of points (q, 2) and of the boxes that contain them, by point and then box."""
        top = len(self.levels[-1])
        point = np.repeat(np.arange(len(points)), top)
        box = np.tile(np.arange(top), len(points))
        for i in range(len(self.levels) - 1, -1, -1):
            p, b = points[point], self.levels[i][box]
            inside = (p[:, 0] >= b[:, 0]) & (p[:, 1] >= b[:, 1]) & (p[:, 0] <= b[:, 2]) & (p[:, 1] <= b[:, 3])
            point, box = point[inside], box[inside]
            if i:
                point = np.repeat(point, _FANOUT)
                box = (box[:, None] * _FANOUT + np.arange(_FANOUT)).ravel()
                present = box < len(self.levels[i - 1])
                point, box = point[present], box[present]
        box = self.order[box]
        by_point = np.lexsort((box, point))
        return point[by_point], box[by_point]


def _morton(centres: Floats) -> Ints:
    """Morton codes of the ranks of the coordinates, so that graded meshes are packed as well as even ones."""
    bits = 16
    code = np.zeros(len(centres), dtype=np.int64)
    for axis in range(2):
        rank = np.empty(len(centres), dtype=np.int64)
        rank[np.argsort(centres[:, axis], kind="stable")] = np.arange(len(centres))
        cell = rank * (1 << bits) // len(centres)
        for bit in range(bits):
            code |= ((cell >> bit) & 1) << (2 * bit + axis)
    return code
