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
from typing import Self

import numpy as np
from scipy.sparse import csr_array

from signorini.base.on_demand import kept
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats
from signorini.discretise.stressnodes import StressNodes
from signorini.shapes import Circle, Region
from signorini.shapes.distances import depth
from signorini.singularities.named import singularities_of

_LINES = np.array([[0, 0, 0, 1], [0, 0, 1, 0], [-1, 0, 0, 1], [1, 0, 0, 1], [0, -1, 1, 0], [0, 1, 1, 0]])
"""Lines along which means are taken, as rows (midpoint − p)/r and direction: two through p, four sides of a square."""
_PARTS = 12
"""Number of parts of a line along which a mean is taken; each has two Gauss points. An even number puts the singular
point p between two parts: moments have a kink at p.
"""
_ON_FACE = 1e-9
"""Largest distance of a point outside a column that still counts as in the column, relative to the column's size."""
_BEYOND = 1.0 + 1e-6
"""Distance of the line along a face from the middle of the column, relative to the half width. Above 1, so that the
face of a column flush with the plate's edge is off the plate."""
PEAKS = ("moment", "shear")
"""Results whose means are taken at singular points, in the order of the columns of `Beside.numbers`."""


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


@dataclass(frozen=True, eq=False)
class Face:
    """A column, with the moments for which bars within its outline are designed.

    ``rows`` are matrices (l, s) from moments at stress nodes to means along lines: those for mx, and those for my.
    """

    outline: Region
    rows: tuple[csr_array, csr_array]

    @classmethod
    def of(cls, nodes: StressNodes, outline: Region, distance: float) -> Self:
        """Take means along two lines along y for mx, and two along x for my, or one each if ``distance`` is 0.

        ``distance`` of the lines from the middle is relative to the outline's half width. Lines off the plate do not
        count.
        """
        low, high = np.array(outline.bounds).reshape(2, 2)
        rows, sides = [], np.array([[-1.0], [1.0]]) if distance else np.zeros((1, 1))
        for axis in np.eye(2):
            half = 0.5 * (high - low)
            middles = 0.5 * (low + high) + distance * sides * half * axis
            every = _rows(nodes, middles, np.tile(half - half * axis, sides.shape))
            rows.append(every[np.flatnonzero(~np.isnan(every @ np.ones(nodes.count)))])
        return cls(outline, (rows[0], rows[1]))

    def moment(self, moment: Floats, values: Floats) -> Floats:
        """Moments (q, 3) in the column: means of ``moment`` (s, 3) along its lines; ``values`` if it has no line."""
        x, y = (of @ moment for of in self.rows)
        result = values.copy()
        for axis, of in enumerate((x[:, 0], y[:, 1], np.concatenate([x, y])[:, 2])):
            result[:, axis] = of.mean() if len(of) else values[:, axis]
        return result


@kept
def faces_of(discretisation: Discretisation) -> tuple[Face, ...]:
    """Columns of one plate, see `Reinforcement.face`: footprints of supports, and circles around singular points.

    Moments are averaged along the faces of a footprint, and along two diameters of a circle.
    """
    nodes, beside, model = discretisation.stress_nodes, beside_of(discretisation), discretisation.model
    singular = [(x, y) for x, y in beside.places[beside.columns].tolist()]
    circles = [Circle(at, r) for at, r in zip(singular, beside.within[beside.columns].tolist(), strict=True)]
    around = [region for at, region in model.footprints if at not in singular]
    return (*(Face.of(nodes, one, 0.0) for one in circles), *(Face.of(nodes, one, _BEYOND) for one in around))


def at_faces(faces: Sequence[Face], moment: Floats, values: Floats, points: Floats) -> Floats:
    """Moments (q, 3) for the design of bars at points (q, 2): ``values`` (q, 3) outside columns, means within.

    The means within a column are computed from ``moment`` (s, 3) at stress nodes.
    """
    result = values.copy()
    for face in faces:
        low, high = np.array(face.outline.bounds).reshape(2, 2)
        near = np.flatnonzero(((points >= low - _ON_FACE) & (points <= high + _ON_FACE)).all(axis=1))
        on = near[depth(face.outline, points[near]) >= -_ON_FACE * float((high - low).max())] if len(near) else near
        if len(on):
            result[on] = face.moment(moment, result[on])
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
    offsets = within[:, None, None] * _LINES
    lines = (places[:, None] + offsets[..., :2]).reshape(-1, 2), offsets[..., 2:].reshape(-1, 2)
    rows = _rows(discretisation.stress_nodes, *lines)
    thickness = (rows @ discretisation.node_thickness).reshape(-1, len(_LINES))
    held = {at for support in discretisation.model.support for at in support.at or ()}
    columns = np.array([not case and place in held for place, case in keys], np.bool_) & numbers[:, 0]
    return Beside(places, within, numbers, tuple(case for _, case in keys), thickness, columns), rows


def _rows(nodes: StressNodes, middles: Floats, halves: Floats) -> csr_array:
    """Matrix (l, s) from values at stress nodes to means along lines; at a jump values of both sides count half.

    ``middles`` (l, 2) are the lines' midpoints, ``halves`` (l, 2) their halves as vectors. Rows of lines off the plate
    are NaN.
    """
    gauss, _ = np.polynomial.legendre.leggauss(2)
    station = ((2.0 * np.arange(_PARTS) + 1.0)[:, None] / _PARTS - 1.0 + gauss / _PARTS).ravel()
    points = middles[:, None] + station[:, None] * halves[:, None]
    point, where = nodes.mesh.holding(points.reshape(-1, 2))
    line, lines = point // len(station), len(middles)
    share = 1.0 / np.bincount(point, minlength=points.size // 2)[point]
    total = np.bincount(line, share, lines)
    values = (share / total[line])[:, None] * nodes.mesh.shape_functions(where.elements, where.xi)
    off = np.flatnonzero(total == 0.0)
    entries = np.concatenate([values.ravel(), np.full(len(off), np.nan)])
    row = np.concatenate([np.repeat(line, 8), off])
    column = np.concatenate([nodes.elements[where.elements].ravel(), np.zeros(len(off), np.int64)])
    return csr_array((entries, (row, column)), shape=(lines, nodes.count))
