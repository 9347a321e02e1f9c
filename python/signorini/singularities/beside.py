"""Means of moments and shears at singular points, for design.

At a point p with radius r (`Singularity.within`), the mean moment is m̄ = 1/(2r) ∫ m ds along each of two lines of
length 2r with the midpoint p: x = p_x for m_x, y = p_y for m_y. A strip of width 2r has this moment per width at p. The
mean shear is taken along each side, of length 2r, of the square centred on p: x = p_x ± r for q_x, y = p_y ± r for q_y.
At a point support with reaction R the integrals along the four sides sum to R minus the load inside, so that each mean
is about R/(8r). Only the part of a line on the plate counts. All means are linear in the solution.
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
"""Each row is (midpoint − p)/r and direction of a line: two lines through p, then the four sides of the square."""
_PARTS = 12
"""Number of parts of a line, with two Gauss points each. It is even: moments have a kink at p, which is then between
two parts.
"""
_ON_RADIUS = 1e-9
"""Relative tolerance for positions on the circle around a column."""
PEAKS = ("moment", "shear")
"""Results that have means, in the order of the columns of `Beside.numbers`."""


@dataclass(frozen=True, eq=False)
class Beside:
    """The k points of a plate with singular moments or shears.

    ``places`` (k, 2) are sorted by x, then y; ``within`` (k,) are their radii r. ``numbers`` (k, 2) marks whether the
    moment and whether the shear is singular. ``case`` (k,) is the load case of a singular load, "" at supports and
    corners. ``thickness`` (k, 6) is the mean thickness along each line of each point. ``columns`` (k,) marks points of
    supports with singular moments.
    """

    places: Floats
    within: Floats
    numbers: Bools
    case: tuple[str, ...]
    thickness: Floats
    columns: Bools

    def __len__(self) -> int:
        """Number k of the singular points."""
        return len(self.places)

    def width_at(self, place: Sequence[float]) -> float:
        """Width 2r over which means are taken at a singular point; 0 at any other position."""
        return 2.0 * float(self.within[(self.places == place).all(axis=1)].max(initial=0.0))

    def under(self, cases: Collection[str]) -> Bools:
        """Mask (k,) of the points that are singular if the load cases ``cases`` act."""
        return np.array([not case or case in cases for case in self.case], np.bool_)


def beside_of(discretisation: Discretisation) -> Beside:
    """Every point of one plate with singular moments or shears under any load case; empty for several plates."""
    return _lines_of(discretisation)[0]


def means_of(discretisation: Discretisation, moment: Floats, shear: Floats) -> Floats:
    """Means (k, 10): mx, my, mxy along both lines through p, then qx, qx, qy, qy on the sides of the square.

    ``moment`` (s, 3) and ``shear`` (s, 2) are values at stress nodes. A mean along a line off the plate is NaN.
    """
    _, rows = _lines_of(discretisation)
    of_moment = (rows @ moment).reshape(-1, len(_LINES), 3)
    of_shear = (rows @ shear).reshape(-1, len(_LINES), 2)
    return np.concatenate([of_moment[:, :2].reshape(-1, 6), of_shear[:, 2:4, 0], of_shear[:, 4:, 1]], axis=1)


def at_faces(moment: Floats, means: Floats, beside: Beside, points: Floats) -> Floats:
    """Moments (..., s, 3) at positions (s, 2), with means in place of moments within the radius of a column.

    ``means`` (..., k, 10) are as in `means_of`. Where the lines of a column are off the plate, moments stay.
    """
    result = moment.copy()
    for column in np.flatnonzero(beside.columns):
        own = means[..., column, :]
        mean = np.stack([own[..., 0], own[..., 4], 0.5 * (own[..., 2] + own[..., 5])], axis=-1)
        near = np.hypot(*(points - beside.places[column]).T) <= beside.within[column] * (1.0 + _ON_RADIUS)
        if not np.isnan(mean).any():
            result[..., near, :] = mean[..., None, :]
    return result


@kept
def _lines_of(discretisation: Discretisation) -> tuple[Beside, csr_array]:
    """The k singular points, and the matrix (6k, s) from values at stress nodes to means along their six lines."""
    places_found: dict[tuple[tuple[float, float], str], tuple[float, Bools]] = {}
    for case in () if discretisation.plates else (None, *discretisation.cases):
        for singularity in singularities_of(discretisation, case):
            numbers = np.array([singularity.excludes(number) for number in PEAKS], np.bool_)
            for place in singularity.where if singularity.within and numbers.any() else ():
                radius, flags = places_found.get((place, case or ""), (0.0, np.zeros(2, np.bool_)))
                places_found[place, case or ""] = max(radius, singularity.within), flags | numbers
    keys = sorted(places_found)
    places = np.array([place for place, _ in keys], np.float64).reshape(-1, 2)
    within = np.array([places_found[key][0] for key in keys], np.float64)
    numbers = np.array([places_found[key][1] for key in keys], np.bool_).reshape(-1, len(PEAKS))
    rows = _rows(discretisation.stress_nodes, places, within)
    thickness = (rows @ discretisation.node_thickness).reshape(-1, len(_LINES))
    held = {at for support in discretisation.model.support for at in support.at or ()}
    columns = np.array([not case and place in held for place, case in keys], np.bool_) & numbers[:, 0]
    return Beside(places, within, numbers, tuple(case for _, case in keys), thickness, columns), rows


def _rows(nodes: StressNodes, places: Floats, within: Floats) -> csr_array:
    """Matrix (6k, s) from values at stress nodes to means along lines; at a jump values of both sides count half."""
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
