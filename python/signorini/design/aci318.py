"""Two-way shear by ACI 318-19 in its SI form, ACI 318M-19, 22.6 and 8.4.4. Units: MPa, mm, N."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from signorini.design.perimeters import Perimeter, Plan, Positions, numbered
from signorini.errors import InputError
from signorini.shapes.arrays import Floats

PHI = 0.75
"""Strength reduction factor φ of shear, Table 21.2.1(b)."""
WITHIN = 4.0
"""Largest distance between column and opening at which the opening reduces bo, over the slab thickness h, 22.6.4.3."""
CLAUSES = {
    "u0": "ACI 318-19, 22.6.4.1 (outline of the column)",
    "u1": "ACI 318-19, 22.6.4.1 and 22.6.4.3 (bo)",
    "beta": "ACI 318-19, 8.4.2.2.2 and 8.4.4.2 (largest stress over mean)",
    "v_ed": "ACI 318-19, 8.4.4.2.3 and R8.4.4.2.3 (vu)",
    "v_rd_c": "ACI 318-19, 22.6.5.2 (φ vc)",
    "v_rd_max": "ACI 318-19, 22.6.6.3 (φ 0.5 √f'c)",
    "with_links": "ACI 318-19, 22.6.6.3",
    "asw": "ACI 318-19, 22.6.6.1 and 22.6.7.2 (Av/s)",
    "uout": "ACI 318-19, 22.6.6.1 (φ 0.17 λs λ √f'c)",
}
ALPHA_S = (40.0, 30.0, 20.0)
"""Factor αs of interior, edge and corner columns, indexed by the number of free edges (0, 1, 2), 22.6.5.3."""
_LARGEST_FYT = 420.0
"""Largest yield strength fyt of shear reinforcement in MPa, 20.2.2.4(a)."""


def root_of(fc: float) -> float:
    """√f'c in MPa, at most 8.3, 22.6.3.1."""
    return min(float(np.sqrt(fc)), 8.3)


def size_factor(d: float) -> float:
    """Size effect factor λs = √(2/(1 + 0.004 d)) ≤ 1, 22.5.5.1.3."""
    return float(min(np.sqrt(2.0 / (1.0 + 0.004 * d)), 1.0))


def concrete_resistance(fc: float, d: float, bo: float, ratio: float, alpha_s: float) -> float:
    """Shear strength vc of normalweight concrete, least of Table 22.6.5.2; ``ratio``: column's long over short side."""
    parts = 0.33, 0.17 * (1.0 + 2.0 / ratio), 0.083 * (2.0 + alpha_s * d / bo)
    return min(parts) * size_factor(d) * root_of(fc)


def shear_part(b1: float, b2: float) -> float:
    """Fraction γv of a moment carried by shear, 8.4.4.2.2; critical section b1 along the eccentricity, b2 across."""
    return 1.0 - 1.0 / (1.0 + 2.0 / 3.0 * float(np.sqrt(b1 / b2)))


@dataclass(frozen=True, eq=False)
class Punching:
    """Two-way shear of one column; ``plan`` is in mm, ``fck`` is f'c and ``fyk`` is fyt in MPa.

    If ``given`` is not None, vu is ``given`` times the mean stress, whatever the moments are.
    """

    plan: Plan
    d: tuple[float, float]
    fck: float
    fyk: float
    given: float | None = None
    clauses = CLAUSES

    @property
    def depth(self) -> float:
        """Mean effective depth d of the two bar directions."""
        return 0.5 * sum(self.d)

    @cached_property
    def perimeters(self) -> Sequence[Perimeter]:
        """Critical sections (p,) at d/2 from the column, with square corners at a rectangular column, 22.6.4.1."""
        if not (every := self.plan.perimeters(0.5 * self.depth, square=True)):
            raise InputError("Free edges leave no critical section around the column. Check one-way shear there.")
        return every

    @property
    def basic(self) -> Perimeter:
        """The shortest critical section."""
        return min(self.perimeters, key=lambda one: one.pieces.length)

    def axis(self, bo: Perimeter) -> complex:
        """Direction of an axis of a critical section: normal to its free edge, if any, else along the column's side.

        Without a free edge, the axis at a round column is a principal axis of the critical section.
        """
        column = self.plan.column
        return (*bo.normals, bo.pieces.principal if len(column.corners) == 1 else column.axis)[0]

    def stress(self, bo: Perimeter, force: Floats, moment: Positions) -> Floats:
        """Largest stress vu (k,) = |V/(bo d) ± Σ γv M c/Jc| on a critical section, summed over two axes, R8.4.4.2.3."""
        pieces, column = bo.pieces, self.plan.column
        mean, centroid = force / (pieces.length * self.depth), pieces.centroid
        if self.given is not None:
            return np.asarray(self.given * np.abs(mean))
        about = moment - force * (centroid - column.centre)
        gradient, axis = np.zeros(len(force), np.complex128), self.axis(bo)
        for direction in (axis, 1j * axis):
            b1, b2 = (pieces.highest(np.array([side, -side])).sum() for side in (direction, 1j * direction))
            share = shear_part(b1, b2) / pieces.inertia(direction, self.depth)
            gradient += share * (about * np.conj(direction)).real * direction
        middle = mean - (np.conj(gradient) * centroid).real
        return np.asarray(np.maximum(pieces.highest(gradient) + middle, pieces.highest(-gradient) - middle))

    def numbers(self, force: Floats, moment: Positions, inside: Floats) -> Mapping[str, Floats]:
        """Numbers (k,) of the check from column forces (k,), moments (k,) and forces inside p critical sections (k, p).

        They belong to the critical section with the largest vu/(φ vc), the utilisation without shear reinforcement. αs
        is 40 at interior, 30 at edge and 20 at corner columns, 22.6.5.3.
        """
        column, depth, net = self.plan.column, self.depth, force[:, None] - inside
        sides = sorted(column.size(axis) for axis in (column.axis, 1j * column.axis))
        lengths = np.array([one.pieces.length for one in self.perimeters])
        resistance = np.array(
            [
                PHI * concrete_resistance(self.fck, depth, bo, sides[1] / sides[0], ALPHA_S[len(one.normals)])
                for one, bo in zip(self.perimeters, lengths, strict=True)
            ]
        )
        stress = np.column_stack([self.stress(one, net[:, i], moment) for i, one in enumerate(self.perimeters)])
        rows, worst = np.arange(len(force)), np.argmax(stress / resistance, axis=1)
        v_u, v_c, bo, mean = stress[rows, worst], resistance[worst], lengths[worst], np.abs(net[rows, worst])
        reduced = PHI * 0.17 * size_factor(depth) * root_of(self.fck)
        face = min(self.plan.face(one.edges).length for one in self.perimeters)
        links = np.where(v_u > v_c, (v_u - reduced) * bo / (PHI * min(self.fyk, _LARGEST_FYT)), 0.0)
        beta = v_u * bo * depth / np.where(mean > 0.0, mean, np.nan)
        at_face, most = np.abs(force) / (face * depth), PHI * 0.5 * root_of(self.fck)
        outer, forces = np.where(links > 0.0, v_u * bo / reduced, np.nan), (force, inside[rows, worst])
        return numbered(face, bo, outer, *forces, beta, v_u, at_face, v_c, most, v_u / v_c, v_u / most, links)
