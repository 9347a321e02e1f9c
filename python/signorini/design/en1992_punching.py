"""Punching by EN 1992-1-1:2004, 6.4, with corrigenda and the amendment A1:2014. Units: MPa, mm, N.

Recommended values: γC = 1.5, αcc = 1, CRd,c = 0.18/γC, and vRd,max = 0.4 ν fcd of A1:2014 in place of 0.5 ν fcd of the
edition of 2004. The normal stress σcp is taken as 0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from signorini.design.perimeters import Edge, Perimeter, Pieces, Plan, Positions, numbered
from signorini.errors import InputError
from signorini.shapes.arrays import Bools, Floats

GAMMA_C, GAMMA_S = 1.5, 1.15
"""Partial factors of concrete and steel, 2.4.2.4."""
WITHIN = 6.0
"""Largest distance between column and opening at which the opening reduces the perimeter, over d, 6.4.2(3)."""
CLAUSES = {
    "u0": "EN 1992-1-1, 6.4.5(3)",
    "u1": "EN 1992-1-1, 6.4.2",
    "beta": "EN 1992-1-1, 6.4.3(3)-(5)",
    "v_ed": "EN 1992-1-1, 6.4.3, Eq. (6.38)",
    "v_rd_c": "EN 1992-1-1, 6.4.4(1), Eq. (6.47)",
    "v_rd_max": "EN 1992-1-1, 6.4.5(3), A1:2014",
    "with_links": "EN 1992-1-1, 6.4.5(1), A1:2014 (1.5 vRd,c)",
    "asw": "EN 1992-1-1, 6.4.5(1), Eq. (6.52)",
    "uout": "EN 1992-1-1, 6.4.5(4), Eq. (6.54)",
}
ON_RAFTS = {
    "u1": "EN 1992-1-1, 6.4.4(2), a ≤ 2d",
    "v_ed": "EN 1992-1-1, 6.4.4(2), Eq. (6.51)",
    "v_rd_c": "EN 1992-1-1, 6.4.4(2), Eq. (6.50)",
}
"""Clauses for columns on foundations; they replace the clauses of the same numbers in `CLAUSES`."""
MOST_WITH_LINKS = 1.5
"""Largest resistance with links vRd,cs, relative to vRd,c without links: kmax of 6.4.5(1), A1:2014."""
_DISTANCES = (np.arange(1, 17) / 8.0).tolist()
"""Distances a ≤ 2d of the perimeters checked around a column on a foundation, relative to d, 6.4.4(2)."""


def moment_part(ratio: float) -> float:
    """Factor k of Table 6.1 for ``ratio`` = c1/c2, interpolated linearly."""
    return float(np.interp(ratio, (0.5, 1.0, 2.0, 3.0), (0.45, 0.60, 0.70, 0.80)))


def concrete_resistance(fck: float, d: float, rho: float, gamma_c: float = GAMMA_C) -> float:
    """vRd,c by 6.4.4(1), Eq. (6.47), with vmin by Eq. (6.3N)."""
    k = min(1.0 + np.sqrt(200.0 / d), 2.0)
    own = 0.18 / gamma_c * k * np.cbrt(100.0 * min(rho, 0.02) * fck)
    return float(max(own, 0.035 * k**1.5 * np.sqrt(fck)))


def largest_resistance(fck: float, gamma_c: float = GAMMA_C) -> float:
    """vRd,max = 0.4 ν fcd at the column's face, 6.4.5(3) as amended by A1:2014, ν = 0.6 (1 − fck/250), Eq. (6.6N)."""
    return 0.4 * 0.6 * (1.0 - fck / 250.0) * fck / gamma_c


def reinforcement(v_ed: Floats, v_rd_c: Floats | float, u1: Floats | float, d: float, fyk: float) -> Floats:
    """Asw/sr of vertical links around the column, 6.4.5(1), Eq. (6.52); 0 where vEd ≤ vRd,c."""
    effective = min(250.0 + 0.25 * d, fyk / GAMMA_S)
    return np.where(v_ed > v_rd_c, (v_ed - 0.75 * v_rd_c) * u1 / (1.5 * effective), 0.0)


class _Shapes(NamedTuple):
    """Dimensions of control perimeters (p,) for β; ``axis`` is normal to the free edge or along the column's side."""

    length: Floats
    distance: Floats
    axis: Positions
    across: Floats  # k u1/W1 for an eccentricity along ``axis``
    along: Floats  # k u1/W1 for an eccentricity normal to ``axis``
    round: Bools  # round column without free edge: both eccentricities add as a vector
    uniform: Floats  # u1/u1*
    beside: Floats  # k u1/W1 of Eq. (6.44) for an eccentricity along the free edge, 0 at a corner
    normals: Positions  # (p, 2): outward normals of free edges at most d away, 0 if absent
    outward: Floats  # (p, 2): k u1/W1 for an eccentricity towards each of ``normals``


@dataclass(frozen=True, eq=False)
class Punching:
    """Punching check of one column: of a slab on it or, if ``on_foundation``, of a foundation under it.

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
        """d_eff = (dy + dz)/2, Eq. (6.32)."""
        return 0.5 * sum(self.d)

    @property
    def clauses(self) -> Mapping[str, str]:
        """Clause of EN 1992-1-1 for each number of the check."""
        return CLAUSES | (ON_RAFTS if self.on_foundation else {})

    @cached_property
    def perimeters(self) -> Sequence[Perimeter]:
        """Control perimeters (p,): those at 2d, 6.4.2(1); on a foundation those at several a ≤ 2d, 6.4.4(2).

        A perimeter that ends at a free edge is shorter than a closed one, but encloses more load or soil pressure, so
        all valid perimeters are checked. On a pad that is too small for a perimeter, only the stress at the column's
        face is checked.
        """
        distances = [ratio * self.depth for ratio in (_DISTANCES if self.on_foundation else [2.0])]
        every = [found for distance in distances for found in self.plan.perimeters(distance)]
        if not every and not self.on_foundation:
            raise InputError("Free edges leave no control perimeter around the column. Check one-way shear there.")
        return every or [self.plan.perimeter(0.0, ())._replace(pieces=self.plan.face(()))]

    @property
    def basic(self) -> Perimeter:
        """The shortest control perimeter at the largest distance, 2d except on small pads."""
        largest = self.perimeters[-1].distance
        return min((one for one in self.perimeters if one.distance == largest), key=lambda one: one.pieces.length)

    @cached_property
    def face_length(self) -> float:
        """u0 by 6.4.5(3): the column's outline, at an edge at most c2 + 3d, at a corner at most 3d."""
        lengths = []
        for edges in map(self._edges, self.perimeters):
            most = [np.inf, self.plan.column.size(1j * edges[0].normal) if edges else 0.0, 0.0][len(edges)]
            lengths.append(min(self.plan.face(edges).length, most + 3.0 * self.depth))
        return min(lengths)

    def mean_times_beta(self, force: Floats, moment: Positions) -> Floats:
        """β |V| (k, p) by 6.4.3(3)-(5) for net forces V (k, p) and moments (k,) = column force times eccentricity.

        The terms of both axes are added; at a round column as components of a vector. At a free edge |V| u1/u1* of Eq.
        (6.44) and (6.46) is for an eccentricity away from the edge. For an eccentricity towards the edge β |V| of Eq.
        (6.39) is taken if it is larger. The term of an eccentricity along the edge is added in both cases.
        """
        size = np.abs(force)
        if self.given is not None:
            return self.given * size
        of, about = self.shapes, moment[:, None]
        across, along = np.abs((about * of.axis.conj()).real), np.abs((about * of.axis.conj()).imag)
        both = of.across * across, of.along * along
        result = size + np.where(of.round, np.hypot(*both), sum(both))
        towards = (about[..., None] * of.normals.conj()).real
        outward = np.where(
            force[..., None] == 0.0, np.abs(towards), np.maximum(towards * np.sign(force)[..., None], 0.0)
        )
        at_edge = np.maximum(size * of.uniform, size + (of.outward * outward).sum(axis=-1)) + of.beside * along
        return np.where((of.normals != 0.0).any(axis=-1), at_edge, result)

    @cached_property
    def shapes(self) -> _Shapes:
        """Dimensions of every control perimeter that β depends on."""
        column, every = self.plan.column, []
        for found in self.perimeters:
            pieces, near = found.pieces, [edge.normal for edge in self._edges(found)]
            is_round = len(column.corners) == 1 and not found.normals
            axis = (*near, *found.normals, pieces.principal if is_round else column.axis)[0]

            def part(direction: complex, own: Pieces = pieces) -> float:
                ratio = column.size(direction) / column.size(1j * direction)
                return moment_part(ratio) * own.length / own.modulus(direction)

            ratio = column.size(axis) / column.size(1j * axis)
            uniform = pieces.length / self._reduced(pieces, near).length
            beside = moment_part(0.5 * ratio) * pieces.length / pieces.modulus(1j * axis) if len(near) == 1 else 0.0
            edges = [*near, 0.0, 0.0][:2], [*map(part, near), 0.0, 0.0][:2]
            shape = pieces.length, found.distance, axis, part(axis), part(1j * axis), is_round, uniform, beside
            every.append((*shape, *edges))
        return _Shapes(*map(np.array, zip(*every, strict=True)))

    def _edges(self, perimeter: Perimeter) -> tuple[Edge, ...]:
        """Free edges of a perimeter at most d from the column, which is then an edge or corner column, 6.4.2(5).

        An edge does not count if the opposite edge is at most d away, too, as on a small pad.
        """
        near = (edge for edge in perimeter.edges if edge.gap <= self.depth)
        return tuple(edge for edge in near if self.plan.gap(-edge.normal) > self.depth)

    def _reduced(self, pieces: Pieces, normals: Sequence[complex]) -> Pieces:
        """Reduced perimeter u1* of Figure 6.20: it ends at min(1.5 d, c1/2) from the column's inner face."""
        for normal in normals:
            low, high = self.plan.column.extent(-normal)
            pieces = pieces.beyond(-normal, high - min(1.5 * self.depth, 0.5 * (high - low)))
        if not pieces.length > 0.0:
            raise InputError("Openings beside the column leave no perimeter u1*. Move the column or the openings.")
        return pieces

    def numbers(self, force: Floats, moment: Positions, inside: Floats) -> Mapping[str, Floats]:
        """Numbers (k,) of the check from column forces (k,), moments (k,) and forces inside the p perimeters (k, p).

        They belong to the perimeter with the largest vEd/vRd,c. The utilisation is without shear reinforcement: the
        larger of vEd/vRd,c and of vEd/vRd,max at u0. With links vEd may reach 1.5 vRd,c. Where links are required, vEd
        at uout is vRd,c of Eq. (6.47); on a foundation the soil pressure inside uout is not subtracted from the force.
        """
        own = concrete_resistance(self.fck, self.depth, float(np.sqrt(self.rho[0] * self.rho[1])))
        of, net, most = self.shapes, force[:, None] - inside, largest_resistance(self.fck)
        by_net = self.mean_times_beta(net, moment)
        stress = by_net / (of.length * self.depth)
        resistance = own * 2.0 * self.depth / np.where(of.distance > 0.0, of.distance, np.nan)
        rows, worst = np.arange(len(force)), np.argmax(np.nan_to_num(stress / resistance), axis=1)
        v_ed, v_rd_c, u1, beyond = stress[rows, worst], resistance[worst], of.length[worst], np.abs(net[rows, worst])
        largest = of.distance == of.distance.max()
        by_force = self.mean_times_beta(np.broadcast_to(force[:, None], net.shape), moment)
        at_face = by_force[:, largest].max(axis=1) / (self.face_length * self.depth)
        beta = by_net[rows, worst] / np.where(beyond > 0.0, beyond, np.nan)
        links = reinforcement(v_ed, v_rd_c, u1, self.depth, self.fyk)
        most_with, most_at_face = v_ed / (MOST_WITH_LINKS * v_rd_c), at_face / most
        ratios = np.fmax(v_ed / v_rd_c, most_at_face), np.fmax(most_with, most_at_face)
        outer = by_force[rows, worst] / (own * self.depth) if self.on_foundation else v_ed * u1 / own
        lengths, forces = (self.face_length, u1, np.where(links > 0.0, outer, np.nan)), (force, inside[rows, worst])
        return numbered(*lengths, *forces, beta, v_ed, at_face, v_rd_c, most, *ratios, links)
