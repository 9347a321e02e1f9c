"""Quadrature rules on −1 ≤ t ≤ 1 (Gauss, Lobatto) and on triangles; tables of quadrature points on a mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Self, TypeAlias

import numpy as np

from signorini._core import section_points
from signorini.discretise.rows import Floats, Ints, Table

GAUSS = 3
"""Number of Gauss points in each direction for polynomials; the rule is exact to the degree 5."""
Rule: TypeAlias = Callable[[int], tuple[Floats, Floats]]
"""Function from the number of points to points and weights of a rule on −1 ≤ t ≤ 1."""


@dataclass(frozen=True, eq=False)
class Quadrature(Table):
    """Points and weights of an integral over the plate or part of it.

    ``xi`` (q, 2) are reference points in ``elements`` (q,), ``positions`` (q, 2) their positions in the plane.
    ``weights`` (q,) are positive and sum to the area or length, the Jacobian included.
    """

    elements: Ints
    xi: Floats
    weights: Floats
    positions: Floats

    def times(self, values: Floats | float) -> Self:
        """Multiply the weights by values (q,)."""
        return replace(self, weights=self.weights * values)

    @property
    def total(self) -> float:
        """Sum of the weights: the area or length of the domain on the plate."""
        return float(self.weights.sum())

    @property
    def centroid(self) -> Floats:
        """Centroid (2,) of the domain on the plate."""
        return np.asarray(self.weights @ self.positions / self.total)


@dataclass(frozen=True, eq=False)
class LineQuadrature(Quadrature):
    """Quadrature along lines, with the unit tangent (q, 2) at each point.

    ``within`` (q, 2) is a position beside each point and inside the point's piece: there a formula has the value on
    this piece, even if the formula jumps at the point.
    """

    tangents: Floats
    within: Floats

    @property
    def normals(self) -> Floats:
        """Unit normals (q, 2) to the right of the tangents: outward where the plate is on the left."""
        return np.column_stack([self.tangents[:, 1], -self.tangents[:, 0]])


@cache
def gauss(count: int) -> tuple[Floats, Floats]:
    """Points and weights (count,) of Gauss's rule, exact to the degree 2·count − 1."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return np.asarray(points), np.asarray(weights)


@cache
def lobatto(count: int) -> tuple[Floats, Floats]:
    """Lobatto's rule with count + 1 points; exact to the degree 2·count − 1, as is Gauss's rule with count points."""
    last = np.polynomial.legendre.Legendre.basis(count)
    inner = np.sort(np.real(last.deriv().roots()))
    points = np.concatenate([[-1.0], 0.5 * (inner - inner[::-1]), [1.0]])
    return points, np.asarray(2.0 / (count * (count + 1) * last(points) ** 2))


@cache
def radon() -> tuple[Floats, Floats]:
    """Radon's seven points on the triangle (0, 0), (1, 0), (0, 1), exact to the fifth degree, and their weights.

    Examples
    --------
    >>> points, weights = radon()
    >>> round(float(weights.sum()), 12), round(float(weights @ points[:, 0] ** 5), 12) == round(1 / 42, 12)
    (0.5, True)
    """
    # The stiffness matrix of triangles uses the same points.
    points = section_points("mitc9", True)[:7]
    root = np.sqrt(15.0)
    light, heavy = (155.0 - root) / 2400.0, (155.0 + root) / 2400.0
    return points, np.array([0.1125, light, light, light, heavy, heavy, heavy])


def collapsed(corners: Floats, along: tuple[Floats, Floats], across: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    """Points and weights on a triangle (3, 2), by a rule ``along`` lines from its first corner and a rule ``across``.

    With rules exact to the degree n the result is exact to the degree n − 1. Points of weight 0 are left out.

    Examples
    --------
    >>> points, weights = collapsed(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), gauss(2), gauss(2))
    >>> round(float(weights @ points[:, 0] ** 2), 12) == round(1 / 12, 12)
    True
    """
    u, v = (a.ravel() for a in np.meshgrid(0.5 + 0.5 * along[0], 0.5 + 0.5 * across[0], indexing="ij"))
    apex, first, second = corners
    (ax, ay), (bx, by) = first - apex, second - apex
    weights = 0.25 * abs(ax * by - ay * bx) * u * np.outer(along[1], across[1]).ravel()
    points = apex + u[:, None] * ((1.0 - v)[:, None] * (first - apex) + v[:, None] * (second - apex))
    return points[u > 0.0], weights[u > 0.0]
