"""Punching by EN 1992-1-1:2004, 6.4, with corrigenda and the amendment A1:2014. Units: MPa, mm, N.

Recommended values: γC = 1.5, αcc = 1, CRd,c = 0.18/γC, k1 and σcp not used, vRd,max = 0.4 ν fcd (A1:2014).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from signorini.design.perimeters import Perimeter, Pieces, Plan, Positions
from signorini.shapes.arrays import Floats

GAMMA_C, GAMMA_S, ALPHA_CC = 1.5, 1.15, 1.0
"""Partial factors of concrete and steel, 2.4.2.4, and αcc, 3.1.6(1): recommended values."""
WITHIN = 6.0
"""Largest distance of an opening that reduces the perimeter, relative to d, 6.4.2(3)."""
CLAUSES = {
    "u0": "EN 1992-1-1, 6.4.5(3)",
    "u1": "EN 1992-1-1, 6.4.2",
    "beta": "EN 1992-1-1, 6.4.3(3)-(5)",
    "v_ed": "EN 1992-1-1, 6.4.3, Eq. (6.38)",
    "v_rd_c": "EN 1992-1-1, 6.4.4(1), Eq. (6.47)",
    "v_rd_max": "EN 1992-1-1, 6.4.5(3), A1:2014",
    "asw": "EN 1992-1-1, 6.4.5(1), Eq. (6.52)",
    "uout": "EN 1992-1-1, 6.4.5(4), Eq. (6.54)",
}
ON_RAFTS = {
    "u1": "EN 1992-1-1, 6.4.4(2), a ≤ 2d",
    "v_ed": "EN 1992-1-1, 6.4.4(2), Eq. (6.51)",
    "v_rd_c": "EN 1992-1-1, 6.4.4(2), Eq. (6.50)",
}
"""Clauses of columns on foundations, in place of those in `CLAUSES`."""
_DISTANCES = np.arange(4, 17) / 8.0
"""Distances of perimeters around a column on a foundation, relative to d: 6.4.2(2) and 6.4.4(2), a ≤ 2d."""
_RATIOS, _PARTS = (0.5, 1.0, 2.0, 3.0), (0.45, 0.60, 0.70, 0.80)


def moment_part(ratio: float) -> float:
    """Factor k of Table 6.1 for c1/c2, linear between its values.

    Examples
    --------
    >>> moment_part(1.0), moment_part(0.1), round(moment_part(1.5), 3)
    (0.6, 0.45, 0.65)
    """
    return float(np.interp(ratio, _RATIOS, _PARTS))


def concrete_resistance(fck: float, d: float, rho: float, gamma_c: float = GAMMA_C) -> float:
    """vRd,c by 6.4.4(1), Eq. (6.47), with vmin by Eq. (6.3N).

    Examples
    --------
    >>> round(concrete_resistance(30.0, 345.0, np.sqrt(754 / 350e3 * 754 / 340e3)), 5)
    0.44814
    """
    k = min(1.0 + np.sqrt(200.0 / d), 2.0)
    own = 0.18 / gamma_c * k * np.cbrt(100.0 * min(rho, 0.02) * fck)
    return float(max(own, 0.035 * k**1.5 * np.sqrt(fck)))


def largest_resistance(fck: float, gamma_c: float = GAMMA_C, alpha_cc: float = ALPHA_CC) -> float:
    """vRd,max = 0.4 ν fcd at the column's face, 6.4.5(3) as amended by A1:2014, ν = 0.6 (1 − fck/250), Eq. (6.6N).

    Examples
    --------
    >>> round(largest_resistance(30.0), 3)
    4.224
    """
    return 0.4 * 0.6 * (1.0 - fck / 250.0) * alpha_cc * fck / gamma_c


def reinforcement(v_ed: Floats, v_rd_c: Floats | float, u1: Floats | float, d: float, fyk: float) -> Floats:
    """Asw/sr of vertical links around the column, 6.4.5(1), Eq. (6.52); 0 where vEd ≤ vRd,c."""
    effective = min(250.0 + 0.25 * d, fyk / GAMMA_S)
    needed = (v_ed - 0.75 * v_rd_c) * u1 / (1.5 * effective)
    return np.asarray(np.where(v_ed > v_rd_c, needed, 0.0))


@dataclass(frozen=True, eq=False)
class Punching:
    """Punching of one column: a slab on it or, ``on_foundation``, a foundation under it.

    ``plan`` is in mm, ``fck`` and ``fyk`` in MPa. ``given`` is β, or None to compute it from moments.
    """

    plan: Plan
    d: tuple[float, float]
    rho: tuple[float, float]
    fck: float
    fyk: float
    given: float | None = None
    on_foundation: bool = False

    @property
    def depth(self) -> float:
        """d_eff = (dy + dz)/2, 6.4.2(1), Eq. (6.32)."""
        return 0.5 * sum(self.d)

    @cached_property
    def perimeters(self) -> Sequence[Perimeter]:
        """Control perimeters (p,): that at 2d, 6.4.2(1); on a foundation several at a ≤ 2d, 6.4.4(2).

        A perimeter to a free edge encloses more of the pressure under a foundation. So the longer perimeter, which does
        not run straight to edges, is checked as well.
        """
        distances = (_DISTANCES * self.depth).tolist() if self.on_foundation else [2.0 * self.depth]
        to_edges = [self.plan.perimeter(distance) for distance in distances]
        around = [self.plan.perimeter(shortest.distance, to_edges=False) for shortest in to_edges if shortest.normals]
        return [*to_edges, *(around if self.on_foundation else [])]

    @cached_property
    def basic(self) -> Perimeter:
        """The basic control perimeter at 2d."""
        return self.plan.perimeter(2.0 * self.depth)

    @cached_property
    def face_length(self) -> float:
        """u0 by 6.4.5(3): the column's outline, at an edge at most c2 + 3d, at a corner at most 3d."""
        normals, column = self._edges(self.basic), self.plan.column
        length = self.plan.face(normals).length
        if len(normals) == 1:
            return min(length, column.size(1j * normals[0]) + 3.0 * self.depth)
        return min(length, 3.0 * self.depth) if len(normals) == 2 else length

    @cached_property
    def concrete(self) -> float:
        """vRd,c with ρl = √(ρy ρz)."""
        return concrete_resistance(self.fck, self.depth, float(np.sqrt(self.rho[0] * self.rho[1])))

    @property
    def clauses(self) -> Mapping[str, str]:
        """Clause of each number."""
        return CLAUSES | (ON_RAFTS if self.on_foundation else {})

    def beta(self, perimeter: Perimeter, force: Floats, moment: Positions) -> Floats:
        """β (k,) by 6.4.3(3)-(5) for the net force (k,) and the moment (k,): force times eccentricity of the column.

        Contributions of both axes are added; those of a circular column, as vectors. At a free edge, Eq. (6.44) and
        (6.46) with u1* hold for an eccentricity inward; outward, the larger one of these and of Eq. (6.39) is taken.
        """
        if self.given is not None:
            return np.full(len(force), self.given)
        pieces, normals, column = perimeter.pieces, self._edges(perimeter), self.plan.column
        axis = perimeter.normals[0] if perimeter.normals else column.axis
        along, size = 1j * axis, np.where(np.abs(force) > 0.0, np.abs(force), np.inf)
        ratio = column.size(axis) / column.size(along)
        across, beside = (self._part(pieces, *part, size, moment) for part in ((axis, ratio), (along, 1.0 / ratio)))
        round_column = len(column.corners) == 1 and not perimeter.normals
        result = 1.0 + (np.hypot(across, beside) if round_column else across + beside)
        if normals:
            inward = np.all([(moment * np.sign(force) * np.conj(way)).real <= 0.0 for way in normals], axis=0)
            uniform = np.full(len(force), pieces.length / self._reduced(pieces, normals).length)
            if len(normals) == 1:
                uniform += self._part(pieces, along, 0.5 * ratio, size, moment)
            result = np.where(inward, uniform, np.maximum(uniform, result))
        return np.asarray(result)

    def _part(self, pieces: Pieces, axis: complex, ratio: float, force: Floats, moment: Positions) -> Floats:
        """Contribution k M u1/(V W1) of the eccentricity along an axis, Eq. (6.39), with k for a ratio c1/c2."""
        modulus = pieces.modulus(axis, (pieces.centroid * np.conj(axis)).real)
        return np.asarray(
            moment_part(ratio) * np.abs((moment * np.conj(axis)).real) * pieces.length / (force * modulus)
        )

    def _edges(self, perimeter: Perimeter) -> tuple[complex, ...]:
        """Normals of the free edge or corner that the column stands at: at most d away, 6.4.2(5)."""
        near = tuple(normal for normal in perimeter.normals if self.plan.gap(normal) <= self.depth)
        opposite = len(near) == 2 and abs(np.angle(near[0] / near[1])) > 0.75 * np.pi
        return () if opposite or len(near) > 2 else near

    def _reduced(self, pieces: Pieces, normals: Sequence[complex]) -> Pieces:
        """u1* of Figure 6.20: at most 1.5 d and half of the column's side are left beside its inner face."""
        for normal in normals:
            low, high = self.plan.column.extent(-normal)
            pieces = pieces.beyond(-normal, high - min(1.5 * self.depth, 0.5 * (high - low)))
        return pieces

    def numbers(self, force: Floats, moment: Positions, inside: Floats) -> Mapping[str, Floats]:
        """Numbers (k,) of the check for column forces (k,), moments (k,) and what acts inside the perimeters (k, p).

        On a foundation they are those of the perimeter with the largest utilisation. The utilisation is that without
        shear reinforcement: the larger one of vEd/vRd,c and of vEd/vRd,max at u0.
        """
        depth, every = self.depth, []
        for perimeter, taken in zip(self.perimeters, inside.T, strict=True):
            net, u1 = force - taken, perimeter.pieces.length
            beta = self.beta(perimeter, net, moment)
            v_ed = beta * np.abs(net) / (u1 * depth)
            v_rd_c = np.full(len(force), self.concrete * 2.0 * depth / perimeter.distance)
            every.append([v_ed / v_rd_c, v_ed, v_rd_c, beta, taken, np.full(len(force), u1)])
        governing = np.argmax([values[0] for values in every], axis=0)
        ratio, v_ed, v_rd_c, beta, taken, u1 = np.array(every)[governing, :, np.arange(len(force))].T
        at_face = beta * np.abs(force) / (self.face_length * depth)
        most = largest_resistance(self.fck)
        return {
            "u0": np.full(len(force), self.face_length),
            "u1": u1,
            "force": force,
            "inside": taken,
            "beta": beta,
            "v_ed": v_ed,
            "v_ed_face": at_face,
            "v_rd_c": v_rd_c,
            "v_rd_max": np.full(len(force), most),
            "utilisation": np.maximum(ratio, at_face / most),
            "asw": reinforcement(v_ed, v_rd_c, u1, depth, self.fyk),
            "uout": v_ed * u1 / v_rd_c,
        }
