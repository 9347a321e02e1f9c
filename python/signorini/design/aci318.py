"""Two-normal shear by ACI 318-19 in its SI form, ACI 318M-19, 22.6 and 8.4.4. Units: MPa, mm, N."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from signorini.design.perimeters import Perimeter, Plan, Positions
from signorini.shapes.arrays import Floats

PHI = 0.75
"""φ of shear, Table 21.2.1(b)."""
WITHIN = 4.0
"""Largest distance of an opening that reduces bo, relative to the slab's thickness h, 22.6.4.3."""
CLAUSES = {
    "u0": "ACI 318-19, 22.6.4.1 (outline of the column)",
    "u1": "ACI 318-19, 22.6.4.1 and 22.6.4.3 (bo)",
    "beta": "ACI 318-19, 8.4.2.2.2 and 8.4.4.2 (largest stress over mean)",
    "v_ed": "ACI 318-19, 8.4.4.2.3 and R8.4.4.2.3 (vu)",
    "v_rd_c": "ACI 318-19, 22.6.5.2 (φ vc)",
    "v_rd_max": "ACI 318-19, 22.6.6.3 (φ 0.5 √f'c)",
    "asw": "ACI 318-19, 22.6.6.1 and 22.6.7.2 (Av/s)",
    "uout": "ACI 318-19, 22.6.6.1 (φ 0.17 λs λ √f'c)",
}
_LARGEST_ROOT = 8.3
"""Largest √f'c in MPa, 22.6.3.1."""
_LARGEST_FYT = 420.0
"""Largest fyt in MPa, 20.2.2.4(a)."""
_POSITION = {0: 40.0, 1: 30.0}
"""αs by the number of free edges, 22.6.5.3; 20 at corners."""


def size_factor(d: float) -> float:
    """λs = √(2/(1 + 0.004 d)) ≤ 1, 22.5.5.1.3.

    Examples
    --------
    >>> size_factor(250.0), round(size_factor(450.0), 4)
    (1.0, 0.8452)
    """
    return float(min(np.sqrt(2.0 / (1.0 + 0.004 * d)), 1.0))


def concrete_resistance(fc: float, d: float, bo: float, ratio: float, alpha_s: float, light: float = 1.0) -> float:
    """vc, the least of Table 22.6.5.2 (a), (b), (c); ``ratio`` is β, long side over short side of the column.

    Examples
    --------
    >>> round(concrete_resistance(25.0, 200.0, 2400.0, 1.0, 40.0), 3)
    1.65
    """
    parts = 0.33, 0.17 * (1.0 + 2.0 / ratio), 0.083 * (2.0 + alpha_s * d / bo)
    return min(parts) * size_factor(d) * light * min(float(np.sqrt(fc)), _LARGEST_ROOT)


def shear_part(b1: float, b2: float) -> float:
    """γv = 1 − γf with γf = 1/(1 + 2/3 √(b1/b2)), 8.4.2.2.2 and 8.4.4.2.2; b1 is along the eccentricity.

    Examples
    --------
    >>> round(shear_part(600.0, 600.0), 6)
    0.4
    """
    return 1.0 - 1.0 / (1.0 + 2.0 / 3.0 * float(np.sqrt(b1 / b2)))


@dataclass(frozen=True, eq=False)
class Punching:
    """Two-normal shear of one column; ``plan`` is in mm, ``fck`` is f'c and ``fyk`` is fyt in MPa.

    ``given`` multiplies the mean stress in place of the unbalanced moment, or is None.
    """

    plan: Plan
    d: tuple[float, float]
    fck: float
    fyk: float
    given: float | None = None
    clauses = CLAUSES

    @property
    def depth(self) -> float:
        """Mean effective depth."""
        return 0.5 * sum(self.d)

    @cached_property
    def perimeters(self) -> Sequence[Perimeter]:
        """The critical section, with square corners around a rectangular column, 22.6.4.1."""
        return [self.plan.perimeter(0.5 * self.depth, square=True)]

    @property
    def basic(self) -> Perimeter:
        """The critical section."""
        return self.perimeters[0]

    @cached_property
    def concrete(self) -> float:
        """Stress vc by 22.6.5.2."""
        column, axis = self.plan.column, self.plan.column.axis
        sides = column.size(axis), column.size(1j * axis)
        alpha_s = _POSITION.get(len(self.basic.normals), 20.0)
        return concrete_resistance(self.fck, self.depth, self.basic.pieces.length, max(sides) / min(sides), alpha_s)

    def stress(self, force: Floats, moment: Positions) -> Floats:
        """Stress vu (k,): mean stress plus γv M c/Jc about both axes of the critical section, R8.4.4.2.3."""
        pieces, normals, column = self.basic.pieces, self.basic.normals, self.plan.column
        mean = np.abs(force) / (pieces.length * self.depth)
        if self.given is not None:
            return np.asarray(self.given * mean)
        centroid = pieces.centroid
        about = moment * np.sign(force) - np.abs(force) * (centroid - column.centre)
        gradient = np.zeros(len(force), np.complex128)
        axis = normals[0] if normals else column.axis
        if len(column.corners) == 1 and not normals:
            axis = 1.0 + 0.0j
        for normal in (axis, 1j * axis):
            across, along = pieces.extent(1j * normal), pieces.extent(normal)
            share = shear_part(along[1] - along[0], across[1] - across[0])
            inertia = pieces.inertia(normal, (centroid * np.conj(normal)).real, self.depth)
            gradient += share * (about * np.conj(normal)).real / inertia * normal
        return np.asarray(mean + pieces.highest(gradient) - (np.conj(gradient) * centroid).real)

    def numbers(self, force: Floats, moment: Positions, inside: Floats) -> Mapping[str, Floats]:
        """Numbers (k,) of the check for column forces (k,), moments (k,) and what acts inside bo (k, 1).

        The utilisation is vu/(φ vc), without shear reinforcement.
        """
        bo, depth = self.basic.pieces.length, self.depth
        net = force - inside[:, 0]
        v_u, mean = self.stress(net, moment), np.abs(net) / (bo * depth)
        root = min(float(np.sqrt(self.fck)), _LARGEST_ROOT)
        reduced = PHI * 0.17 * size_factor(depth) * root
        v_c, most = PHI * self.concrete, PHI * 0.5 * root
        links = np.where(v_u > v_c, (v_u - reduced) * bo / (PHI * min(self.fyk, _LARGEST_FYT)), 0.0)
        face = self.plan.face(self.basic.normals).length
        every = np.ones(len(force))
        return {
            "u0": every * face,
            "u1": every * bo,
            "force": force,
            "inside": inside[:, 0],
            "beta": np.divide(v_u, mean, out=np.ones(len(force)), where=mean > 0.0),
            "v_ed": v_u,
            "v_ed_face": np.abs(force) / (face * depth),
            "v_rd_c": every * v_c,
            "v_rd_max": every * most,
            "utilisation": v_u / v_c,
            "asw": links,
            "uout": v_u * bo / reduced,
        }
