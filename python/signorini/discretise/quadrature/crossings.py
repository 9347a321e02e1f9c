"""Intersections of quadratic element sides with straight segments and circles."""

from __future__ import annotations

import numpy as np

from signorini.discretise.rows import Floats, Ints
from signorini.shapes.outlines import Outline

_BISECTIONS = 54
"""Number of bisections of an interval, after which its length is the rounding of its ends."""
_ZERO = 1e-12
"""Tolerance for a zero value of a polynomial, relative to the largest magnitude of its terms."""


def roots(coefficients: Floats, tolerance: Floats) -> tuple[Ints, Floats]:
    """Find roots (r,) on [−1, 1] of polynomials (k, d + 1), constant terms first.

    Return the index (r,) of each root's polynomial, and the roots. Between neighbouring roots of the derivative there
    is at most one root. Leading coefficients may vanish. Values up to the tolerance (k,) count as zero, so that double
    roots are found; a root may occur twice.
    """
    if not len(coefficients):
        return np.zeros(0, np.int64), np.zeros(0)
    # Leading coefficients that are all 0 are left out: for straight sides and outlines, polynomials are linear.
    degree = max(np.flatnonzero(coefficients.any(axis=0)), default=0)
    coefficients = coefficients[:, : max(degree, 1) + 1]
    derivatives = [coefficients]
    while derivatives[-1].shape[1] > 2:
        last = derivatives[-1]
        derivatives.append(last[:, 1:] * np.arange(1.0, last.shape[1]))
    ends = np.ones((len(coefficients), 1))
    knots = np.hstack([-ends, ends])
    for polynomial in reversed(derivatives):
        between = _bisect(polynomial, knots[:, :-1], knots[:, 1:])
        knots = np.hstack([-ends, between, ends])
    which, knot = np.nonzero(np.abs(_value(coefficients, knots)) <= tolerance[:, None])
    return which, np.asarray(knots[which, knot])


def _value(coefficients: Floats, t: Floats) -> Floats:
    return np.asarray(np.polynomial.polynomial.polyval(t, coefficients.T[..., None], tensor=False))


def _bisect(coefficients: Floats, lower: Floats, upper: Floats) -> Floats:
    """Bisect each interval to a change of sign; without a change, return the end where the magnitude is smaller."""
    start, stop = _value(coefficients, lower), _value(coefficients, upper)
    result = np.where(np.abs(stop) > np.abs(start), lower, upper)
    which, interval = np.nonzero((start < 0.0) != (stop < 0.0))
    low, high, polynomials = lower[which, interval][:, None], upper[which, interval][:, None], coefficients[which]
    rising = (stop > start)[which, interval][:, None]
    for _ in range(_BISECTIONS if len(which) else 0):
        middle = 0.5 * (low + high)
        right = (_value(polynomials, middle) < 0.0) == rising
        low, high = np.where(right, middle, low), np.where(right, high, middle)
    result[which, interval] = 0.5 * (low + high)[:, 0]
    return result


def quadratics(sides: Floats) -> Floats:
    """Polynomials (k, 2, 3) in t on [−1, 1] of sides (k, 3, 2), each given by corner, midside node, corner."""
    a, middle, b = np.moveaxis(sides, 1, 0)
    return np.stack([middle, 0.5 * (b - a), 0.5 * (a + b) - middle], axis=-1)


def evaluate(curves: Floats, t: Floats) -> Floats:
    """Positions (k, 2) on quadratic curves (k, 2, 3) at parameters t (k,)."""
    return np.asarray(curves[..., 0] + t[:, None] * (curves[..., 1] + t[:, None] * curves[..., 2]))


def with_segments(curves: Floats, segments: Floats) -> tuple[Ints, Floats]:
    """Intersect quadratic curves (k, 2, 3) with segments (k, 2, 2), pair by pair.

    Return the index (r,) of each crossing's pair, and positions (r, 2). A crossing may occur twice. For a side along a
    segment, both ends of the side are returned.
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
    inside = (station >= -slack) & (station <= 1.0 + slack)
    return pair[inside], points[inside]


def with_circles(curves: Floats, circles: Floats) -> tuple[Ints, Floats]:
    """Intersect quadratic curves (k, 2, 3) with circles (k, 3), pair by pair; the result is as for `with_segments`."""
    a, b, c = curves[..., 0] - circles[:, :2], curves[..., 1], curves[..., 2]
    radius = circles[:, 2]
    distance = np.hypot(*a.T)
    products = 2.0 * a * b, b * b + 2.0 * a * c, 2.0 * b * c, c * c
    constant = (distance - radius) * (distance + radius)
    coefficients = np.column_stack([constant, *(product.sum(axis=1) for product in products)])
    pair, t = roots(coefficients, _ZERO * (distance + radius) ** 2)
    return pair, evaluate(curves[pair], t)


def between_circles(circles: Floats, others: Floats) -> tuple[Ints, Floats]:
    """Intersect circles (k, 3) with circles ``others`` (k, 3), pair by pair; the result is as for `with_segments`."""
    apart = others[:, :2] - circles[:, :2]
    distance, radius = np.hypot(*apart.T), circles[:, 2]
    with np.errstate(divide="ignore", invalid="ignore"):
        unit = apart / distance[:, None]
        along = 0.5 * (distance + (radius - others[:, 2]) * (radius + others[:, 2]) / distance)
        square = (radius - along) * (radius + along)
    (pair,) = np.nonzero(square >= -_ZERO * radius**2)
    middle = circles[pair, :2] + along[pair, None] * unit[pair]
    across = np.sqrt(np.maximum(square[pair], 0.0))[:, None] * np.column_stack([-unit[pair, 1], unit[pair, 0]])
    return np.tile(pair, 2), np.concatenate([middle - across, middle + across])


def together(owner: Ints, others: Ints) -> tuple[Ints, Ints]:
    """Indices (p,) into ``owner``, and indices (p,) into ``others``, of all pairs of equal entries."""
    order = np.argsort(others, kind="stable")
    first, stop = (np.searchsorted(others[order], owner, side) for side in ("left", "right"))
    count = stop - first
    first_entries = np.repeat(np.arange(len(owner)), count)
    return first_entries, order[np.arange(len(first_entries)) + np.repeat(first - np.cumsum(count) + count, count)]


def touched(boxes: Floats, outline: Outline, margin: float) -> tuple[Ints, Ints, Ints, Ints]:
    """Indices of all pairs (box, segment) that meet, and of all pairs (box, circle) that meet.

    Boxes (n, 4) are enlarged by ``margin``; segments and circles are those of an outline.
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
    numbers = np.repeat(np.arange(len(boxes)), [len(result) for result in boxes])
    return np.concatenate([np.empty(0, dtype=np.int64), *boxes]), numbers
