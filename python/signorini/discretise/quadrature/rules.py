"""Rules on −1 ≤ t ≤ 1: Gauss's, and Lobatto's, which has points at both ends."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Rule: TypeAlias = Callable[[int], tuple[Floats, Floats]]
"""Points and weights, given how many."""


@cache
def gauss(count: int) -> tuple[Floats, Floats]:
    """Gauss's rule (count,), exact to the degree 2·count − 1.

    Examples
    --------
    >>> gauss(2)[0].round(6)
    array([-0.57735,  0.57735])
    """
    points, weights = np.polynomial.legendre.leggauss(count)
    return np.asarray(points), np.asarray(weights)


@cache
def lobatto(count: int) -> tuple[Floats, Floats]:
    """Lobatto's rule with one point more, and so as exact: to the degree 2·count − 1.

    Examples
    --------
    >>> lobatto(3)[0].round(6), lobatto(3)[1].round(6)
    (array([-1.      , -0.447214,  0.447214,  1.      ]), array([0.166667, 0.833333, 0.833333, 0.166667]))
    """
    last = np.polynomial.legendre.Legendre.basis(count)
    inner = np.sort(np.real(last.deriv().roots()))
    points = np.concatenate([[-1.0], 0.5 * (inner - inner[::-1]), [1.0]])
    return points, np.asarray(2.0 / (count * (count + 1) * last(points) ** 2))
