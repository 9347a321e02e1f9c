"""Kern of an area: the positions of a resultant for which a linear distribution of pressure has no tension."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.places import outline
from signorini.discretise.quadrature import area_quadrature
from signorini.discretise.rows import Floats


@dataclass(frozen=True, eq=False)
class Kern:
    """Centroid x₀ (2,) of an area, and −J⁻¹ (xᵢ − x₀) (h, 2) of the corners xᵢ of its hull, J = ∫ (x−x₀)(x−x₀)ᵀ dA / A.

    A linear pressure with the resultant R at the eccentricity e is R/A (1 + eᵀJ⁻¹(x − x₀)). There is no tension if max
    eᵀ(−J⁻¹(xᵢ − x₀)) ≤ 1; for a rectangle, if 6 (|ex|/bx + |ey|/by) ≤ 1.
    """

    centroid: Floats
    corners: Floats


@kept
def kern_of(discretisation: Discretisation, index: int) -> Kern:
    """Kern of the area of support number ``index``, computed once."""
    mesh, support = discretisation.mesh, discretisation.model.support[index]
    points = area_quadrature(mesh, support.where.region)
    centroid = points.weights @ points.positions / points.total
    away = points.positions - centroid
    inertia = away.T @ (points.weights[:, None] * away) / points.total
    hull = outline(mesh, discretisation.model.plate, support.where)
    return Kern(centroid, np.asarray(np.linalg.solve(inertia, (centroid - hull).T).T, np.float64))
