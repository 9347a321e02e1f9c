"""Where quadratic element sides cross straight segments and circles."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from signorini.discretise.quadrature.roots import roots
from signorini.shapes.outlines import Outline

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_ZERO = 1e-12


def quadratics(sides: Floats) -> Floats:
    """Write sides (k, 3, 2), given by corner, midside, corner, as polynomials (k, 2, 3) in t on [−1, 1].

    Examples
    --------
    >>> quadratics(np.array([[[0.0, 0.0], [1.0, 1.0], [2.0, 0.0]]]))
    array([[[ 1.,  1.,  0.],
            [ 1.,  0., -1.]]])
    """
    a, middle, b = np.moveaxis(sides, 1, 0)
    return np.stack([middle, 0.5 * (b - a), 0.5 * (a + b) - middle], axis=-1)


def evaluate(curves: Floats, t: Floats) -> Floats:
    """Compute positions (k, 2) on quadratics (k, 2, 3), one each."""
    return np.asarray(curves[..., 0] + t[:, None] * (curves[..., 1] + t[:, None] * curves[..., 2]))


def with_segments(curves: Floats, segments: Floats) -> tuple[Ints, Floats]:
    """Cross quadratics (k, 2, 3) with segments (k, 2, 2), pair by pair.

    Returns
    -------
    pair : (r,) int array
        Which pair each crossing belongs to; a crossing may be given twice.
    points : (r, 2) float array
        The crossings. Of a side that lies along a segment both ends are given.
    """
    a, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    length = np.hypot(*along.T)
    normal = np.column_stack([-along[:, 1], along[:, 0]]) / length[:, None]
    coefficients = np.einsum("kd,kdi->ki", normal, curves)
    coefficients[:, 0] = np.einsum("kd,kd->k", normal, curves[..., 0] - a)
    scale = np.abs(curves[..., 1:]).max(axis=(1, 2)) + np.abs(curves[..., 0] - a).max(axis=1)
    pair, t = roots(coefficients, _ZERO * scale)
    points = evaluate(curves[pair], t)
    station = np.einsum("rd,rd->r", points - a[pair], along[pair]) / length[pair] ** 2
    slack = _ZERO * scale[pair] / length[pair]
    on = (station >= -slack) & (station <= 1.0 + slack)
    return pair[on], points[on]


def with_circles(curves: Floats, circles: Floats) -> tuple[Ints, Floats]:
    """Cross quadratics (k, 2, 3) with circles (k, 3), pair by pair; see `with_segments`."""
    a, b, c = curves[..., 0] - circles[:, :2], curves[..., 1], curves[..., 2]
    radius = circles[:, 2]
    distance = np.hypot(*a.T)
    coefficients = np.column_stack(
        [
            (distance - radius) * (distance + radius),
            2.0 * (a * b).sum(axis=1),
            (b * b + 2.0 * a * c).sum(axis=1),
            2.0 * (b * c).sum(axis=1),
            (c * c).sum(axis=1),
        ]
    )
    pair, t = roots(coefficients, _ZERO * (distance + radius) ** 2)
    return pair, evaluate(curves[pair], t)


def touched(boxes: Floats, outline: Outline, margin: float) -> tuple[Ints, Ints, Ints, Ints]:
    """Find which boxes (n, 4) an outline passes through.

    Returns
    -------
    box, segment : (r,) int arrays
        Pairs of a box and a segment through it.
    box, circle : (s,) int arrays
        Pairs of a box and a circle through it.
    """
    centre, half = 0.5 * (boxes[:, :2] + boxes[:, 2:]), 0.5 * (boxes[:, 2:] - boxes[:, :2]) + margin
    by_segment = []
    for a, b in outline.segments:
        reach, offset = np.abs(0.5 * (b - a)), 0.5 * (a + b) - centre
        near = (np.abs(offset) <= half + reach).all(axis=1)
        direction = (b - a) / np.hypot(*(b - a))
        across = np.abs(offset[:, 0] * direction[1] - offset[:, 1] * direction[0])
        near &= across <= half[:, 0] * abs(direction[1]) + half[:, 1] * abs(direction[0])
        by_segment.append(np.flatnonzero(near))
    by_circle = []
    for x, y, radius in outline.whole_circles:
        offset = np.abs(centre - (x, y))
        nearest, farthest = np.hypot(*np.maximum(offset - half, 0.0).T), np.hypot(*(offset + half).T)
        by_circle.append(np.flatnonzero((nearest <= radius) & (farthest >= radius)))
    return (*_pairs(by_segment), *_pairs(by_circle))


def _pairs(boxes: list[Ints]) -> tuple[Ints, Ints]:
    what = np.repeat(np.arange(len(boxes)), [len(result) for result in boxes])
    return np.concatenate([np.empty(0, dtype=np.int64), *boxes]), what
