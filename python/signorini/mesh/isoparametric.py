"""The map of the 8-node quadrilateral from the reference square to the plate, and back."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from signorini._core import serendipity

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]

REACH: Final = 1.5
ITERATIONS: Final = 20
SIDES: Final = ((0, 4, 1), (1, 5, 2), (2, 6, 3), (3, 7, 0))
CORNERS: Final = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
_SAMPLES = np.stack(np.meshgrid(*2 * [np.linspace(-1.0, 1.0, 5)], indexing="ij"), axis=-1).reshape(-1, 2)


def positions(nodes: Floats, xi: Floats) -> Floats:
    """Positions (q, 2) of reference points.

    Parameters
    ----------
    nodes : (q, 8, 2) float array
        Nodes of the element each point is in.
    xi : (q, 2) float array
        Reference points.

    Examples
    --------
    >>> square = np.array([[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]], float)
    >>> positions(square[None], np.array([[0.5, 0.0]]))
    array([[3., 1.]])
    """
    return np.asarray(np.einsum("qn,qnd->qd", serendipity(xi)[0], nodes))


def jacobians(nodes: Floats, xi: Floats) -> Floats:
    """Differentiate the position (first index of 2, 2) by the reference coordinates (second index) at points (q, 2).

    Examples
    --------
    >>> square = np.array([[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]], float)
    >>> jacobians(square[None], np.array([[0.5, 0.0]]))[0]
    array([[2., 0.],
           [0., 1.]])
    """
    return np.asarray(np.einsum("qnd,qna->qda", nodes, serendipity(xi)[1]))


def determinants(nodes: Floats, xi: Floats) -> Floats:
    """Jacobian determinants (ne, r) of every element (ne, 8, 2) at the same reference points (r, 2)."""
    gradients = serendipity(xi)[1].transpose(0, 2, 1).reshape(-1, 8)
    j = (gradients @ nodes).reshape(len(nodes), len(xi), 2, 2)
    return np.asarray(j[..., 0, 0] * j[..., 1, 1] - j[..., 0, 1] * j[..., 1, 0])


def invert(nodes: Floats, points: Floats) -> tuple[Floats, Bools]:
    """Find the reference points of positions, by Newton's method.

    Parameters
    ----------
    nodes : (q, 8, 2) float array
        Nodes of the element each point is looked for in.
    points : (q, 2) float array
        Positions.

    Returns
    -------
    xi : (q, 2) float array
        Reference points; coordinates within 1e-10 of −1, 0 or 1 are these numbers, so that shape functions at nodes are
        exactly 0 and 1.
    found : (q,) bool array
        Whether the point was reached. Points farther out than 1.5 in reference coordinates are not.

    Examples
    --------
    >>> square = np.array([[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]], float)
    >>> xi, found = invert(square[None], np.array([[3.0, 2.0]]))
    >>> xi, found
    (array([[0.5, 1. ]]), array([ True]))
    """
    origin = nodes.mean(axis=1)
    local, target = nodes - origin[:, None], points - origin
    xi, found = _newton(local, target, np.zeros_like(target))
    lost = np.flatnonzero(~found)
    if len(lost):
        samples = np.einsum("sn,qnd->qsd", serendipity(_SAMPLES)[0], local[lost])
        nearest = np.argmin(((samples - target[lost, None]) ** 2).sum(axis=2), axis=1)
        xi[lost], found[lost] = _newton(local[lost], target[lost], _SAMPLES[nearest])
    for special in (-1.0, 0.0, 1.0):
        xi[np.abs(xi - special) < 1e-10] = special
    return xi, found


def side_boxes(sides: Floats) -> Floats:
    """Bound quadratic sides (k, 3, 2) given by corner, midside, corner: (k, 4) xmin, ymin, xmax, ymax."""
    control = sides.copy()
    control[:, 1] = 2.0 * sides[:, 1] - 0.5 * (sides[:, 0] + sides[:, 2])
    return np.hstack([control.min(axis=1), control.max(axis=1)])


def _newton(nodes: Floats, target: Floats, start: Floats) -> tuple[Floats, Bools]:
    xi = start.copy()
    found = np.zeros(len(xi), dtype=bool)
    active = np.arange(len(xi))
    for _ in range(ITERATIONS):
        if not len(active):
            break
        values, gradients = serendipity(xi[active])
        miss = target[active] - np.einsum("qn,qnd->qd", values, nodes[active])
        j = np.einsum("qnd,qna->qda", nodes[active], gradients)
        det = j[:, 0, 0] * j[:, 1, 1] - j[:, 0, 1] * j[:, 1, 0]
        det[det == 0.0] = np.finfo(float).tiny
        with np.errstate(over="ignore", invalid="ignore"):
            step = np.column_stack(
                [j[:, 1, 1] * miss[:, 0] - j[:, 0, 1] * miss[:, 1], j[:, 0, 0] * miss[:, 1] - j[:, 1, 0] * miss[:, 0]]
            )
            step = np.clip(np.nan_to_num(step / det[:, None]), -REACH, REACH)
        moved = np.clip(xi[active] + step, -REACH, REACH)
        settled = (np.abs(step).max(axis=1) < 1e-13) & (np.abs(moved).max(axis=1) < REACH)
        # Rounding may keep the last steps above the tolerance on elements far from the origin.
        xi[active], found[active] = moved, settled
        active = active[~settled]
    if len(active):
        values, _ = serendipity(xi[active])
        miss = np.abs(target[active] - np.einsum("qn,qnd->qd", values, nodes[active])).max(axis=1)
        found[active] = (miss < 1e-12 * np.ptp(nodes[active], axis=1).max(axis=1)) & (
            np.abs(xi[active]).max(axis=1) < REACH
        )
    return xi, found
