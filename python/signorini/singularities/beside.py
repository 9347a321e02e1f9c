"""Means of moments and shears at places where they have no limit: the numbers to design with there.

At a place p with radius r (`Singularity.within`), of moments

    m̄ = 1/(2r) ∫ m ds

along each of the two lines of length 2r whose middle is p: x = p_x for m_x, y = p_y for m_y. A strip of width 2r has
this moment per width at p. For shears it is the mean along each side, 2r long, of the square about p: x = p_x ± r for
q_x, y = p_y ± r for q_y. About a support at a point with reaction R they add up to R less the load inside, so that each
is about R/(8r). Lines count as far as they are on the plate. All means are linear in the solution.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.singularities.named import singularities_of

_LINES = np.array([[0, 0, 0, 1], [0, 0, 1, 0], [-1, 0, 0, 1], [1, 0, 0, 1], [0, -1, 1, 0], [0, 1, 1, 0]])
"""Middle less p, and direction, over r: two lines through p, then the sides of the square."""
_PARTS = 12
"""Parts of a line with two Gauss points each: p is between two of them, where moments have a kink."""
PEAKS = ("moment", "shear")


@dataclass(frozen=True, eq=False)
class Beside:
    """The k places of a plate at which moments or shears have no limit.

    ``places`` (k, 2), by x and then y, have the radii ``within`` (k,). ``numbers`` (k, 2) tells which of moment and
    shear have no limit. ``case`` (k,) is the load case that acts there, "" at supports and corners. ``thickness``
    (k, 6) is the mean of the solid plate's along each line.
    """

    places: Floats
    within: Floats
    numbers: Bools
    case: tuple[str, ...]
    thickness: Floats

    def __len__(self) -> int:
        """Count the places."""
        return len(self.places)

    def width_at(self, place: Sequence[float]) -> float:
        """The width 2r of the means at a place."""
        return 2.0 * float(self.within[(self.places == place).all(axis=1)].max(initial=0.0))

    def under(self, cases: Collection[str]) -> Bools:
        """Which places (k,) have no limit where load cases act."""
        return np.array([not case or case in cases for case in self.case], np.bool_)


def beside_of(discretisation: Discretisation) -> Beside:
    """Every place of one plate at which moments or shears have no limit under any load case; none of several plates."""
    return _lines_of(discretisation)[0]


def means_of(discretisation: Discretisation, moment: Floats, shear: Floats) -> Floats:
    """Give means (k, 10): mx, my, mxy along both lines through p, then qx and qx, qy and qy on the square's sides.

    ``moment`` (s, 3) and ``shear`` (s, 2) are at the nodes of stresses. NaN along a line off the plate.
    """
    _, rows = _lines_of(discretisation)
    of_moment = (rows @ moment).reshape(-1, len(_LINES), 3)
    of_shear = (rows @ shear).reshape(-1, len(_LINES), 2)
    return np.concatenate([of_moment[:, :2].reshape(-1, 6), of_shear[:, 2:4, 0], of_shear[:, 4:, 1]], axis=1)


@kept
def _lines_of(discretisation: Discretisation) -> tuple[Beside, csr_array]:
    """The places, and rows (6k, s): the mean along each line of values at the nodes of stresses."""
    found: dict[tuple[tuple[float, float], str], tuple[float, Bools]] = {}
    for case in () if discretisation.plates else (None, *discretisation.cases):
        for one in singularities_of(discretisation, case):
            numbers = np.array([one.excludes(number) for number in PEAKS], np.bool_)
            for place in one.where if one.within and numbers.any() else ():
                radius, before = found.get((place, case or ""), (0.0, np.zeros(2, np.bool_)))
                found[place, case or ""] = max(radius, one.within), before | numbers
    keys = sorted(found)
    places = np.array([place for place, _ in keys], np.float64).reshape(-1, 2)
    within = np.array([found[key][0] for key in keys], np.float64)
    numbers = np.array([found[key][1] for key in keys], np.bool_).reshape(-1, len(PEAKS))
    rows = _rows(discretisation.stress_nodes, places, within)
    thickness = (rows @ discretisation.node_thickness).reshape(-1, len(_LINES))
    return Beside(places, within, numbers, tuple(case for _, case in keys), thickness), rows


def _rows(nodes: StressNodes, places: Floats, within: Floats) -> csr_array:
    """Rows (6k, s) of means along the lines; where the mesh follows a line each side counts half."""
    gauss, _ = np.polynomial.legendre.leggauss(2)
    station = ((2.0 * np.arange(_PARTS) + 1.0)[:, None] / _PARTS - 1.0 + gauss / _PARTS).ravel()
    offset, along = _LINES[:, None, :2], _LINES[:, None, 2:] * station[:, None]
    points = places[:, None, None] + within[:, None, None, None] * (offset + along)
    point, where = nodes.mesh.holding(points.reshape(-1, 2))
    line, lines = point // len(station), len(places) * len(_LINES)
    share = 1.0 / np.bincount(point, minlength=points.size // 2)[point]
    total = np.bincount(line, share, lines)
    values = (share / total[line])[:, None] * nodes.mesh.shape_functions(where.elements, where.xi)
    off = np.flatnonzero(total == 0.0)
    entries = np.concatenate([values.ravel(), np.full(len(off), np.nan)])
    row = np.concatenate([np.repeat(line, 8), off])
    column = np.concatenate([nodes.elements[where.elements].ravel(), np.zeros(len(off), np.int64)])
    return csr_array((entries, (row, column)), shape=(lines, nodes.count))
