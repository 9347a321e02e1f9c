"""Real roots of polynomials on [−1, 1], many at once."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

_BISECTIONS = 54


def roots(coefficients: Floats, tolerance: Floats) -> tuple[Ints, Floats]:
    """Find the roots on [−1, 1]: between neighbouring extrema, which are roots of the derivative, there is at most one.

    Parameters
    ----------
    coefficients : (k, d + 1) float array
        Polynomials, constant terms first. Leading coefficients may vanish.
    tolerance : (k,) float array
        Values this small count as zero, so that double roots are found too.

    Returns
    -------
    polynomial : (r,) int array
        Which polynomial each root belongs to.
    root : (r,) float array
        The roots; a root may be given twice.

    Examples
    --------
    >>> roots(np.array([[-0.25, 0.0, 1.0], [1.0, 0.0, 1.0]]), np.array([1e-12, 1e-12]))
    (array([0, 0]), array([-0.5,  0.5]))
    """
    if not len(coefficients):
        return np.zeros(0, np.int64), np.zeros(0)
    # Straight sides that straight outlines cut are by far the most.
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
    which, at = np.nonzero(np.abs(_value(coefficients, knots)) <= tolerance[:, None])
    return which, np.asarray(knots[which, at])


def _value(coefficients: Floats, t: Floats) -> Floats:
    total = np.zeros_like(t)
    for i in range(coefficients.shape[1] - 1, -1, -1):
        total = total * t + coefficients[:, i, None]
    return total


def _bisect(coefficients: Floats, lower: Floats, upper: Floats) -> Floats:
    """Halve to the change of sign; without one it is the end where the value is smaller."""
    start, stop = _value(coefficients, lower), _value(coefficients, upper)
    result = np.where(np.abs(stop) > np.abs(start), lower, upper)
    which, at = np.nonzero((start < 0.0) != (stop < 0.0))
    low, high, own = lower[which, at][:, None], upper[which, at][:, None], coefficients[which]
    rising = (stop > start)[which, at][:, None]
    for _ in range(_BISECTIONS if len(which) else 0):
        middle = 0.5 * (low + high)
        right = (_value(own, middle) < 0.0) == rising
        low, high = np.where(right, middle, low), np.where(right, high, middle)
    result[which, at] = 0.5 * (low + high)[:, 0]
    return result
