"""Laws of contact points: force over travel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from signorini.discretise.rows import Bools, Floats, Ints
from signorini.model import Support

_ROUNDING = 1e-12
"""Relative tolerance for equal slopes of neighbouring pieces: points of a polyline are rounded."""


@dataclass(frozen=True)
class Law:
    """Nondecreasing polyline of force over travel, a monotone graph (Moreau 1965; Rockafellar 1970, section 24).

    Parameters
    ----------
    vertices : tuple of (travel, force)
        At least one; travels and forces do not decrease.
    ends : (float, float)
        Slopes before the first vertex and after the last; infinite where the point is rigid.
    """

    vertices: tuple[tuple[float, float], ...] = ((0.0, 0.0),)
    ends: tuple[float, float] = (0.0, 1.0)

    @classmethod
    def drawn(cls, points: Sequence[tuple[float, float]], both: bool) -> Law:
        """Return the law through points (travel, force); the last slope continues.

        If not ``both``, the force is zero before the first point. If ``both``, the law is odd where the first travel
        is 0, else the first slope continues too. Points at which the slope does not change are omitted.

        Examples
        --------
        >>> Law.drawn([(0.0, 0.0), (0.5, 2.0), (1.0, 2.0)], both=True)
        Law(vertices=((-0.5, -2.0), (0.5, 2.0)), ends=(0.0, 0.0))
        """
        odd = both and points[0][0] == 0.0
        vertices = (*((-t, -f) for t, f in reversed(points[1:])), *points) if odd else tuple(points)
        inner = cls(vertices).slopes[1:-1]
        slopes = np.array([inner[0] if both else 0.0, *inner, inner[-1]])
        turns = ~np.isclose(slopes[:-1], slopes[1:], rtol=_ROUNDING, atol=0.0)
        kept = [vertex for vertex, turn in zip(vertices, turns, strict=True) if turn]
        return cls(tuple(kept) or ((0.0, 0.0),), (float(slopes[0]), float(slopes[-1])))

    @cached_property
    def slopes(self) -> Floats:
        """Slope (p,) of every piece in the order of travel; a straight law has one piece."""
        steps = np.diff(np.reshape(self.vertices, (-1, 2)), axis=0)
        with np.errstate(divide="ignore"):
            inner = steps[:, 1] / steps[:, 0]
        return np.array(self.ends[:1] if self.straight else [self.ends[0], *inner, self.ends[1]])

    @cached_property
    def at_ends(self) -> Bools:
        """Whether each piece (p,) is the first or the last one."""
        number = np.arange(len(self.slopes))
        return np.asarray((number == 0) | (number == number[-1]))

    @cached_property
    def corners(self) -> Floats:
        """First vertex (p, 2) of every piece; for the first piece, its last vertex."""
        return np.array(self.vertices[:1] if self.straight else [self.vertices[0], *self.vertices])

    @cached_property
    def anchors(self) -> Floats:
        """Travel and force (p, 2) of a reference point on each piece: its zero of force if it has one, else `corners`.

        Forces near zero keep their digits even if the vertex is distant.

        Examples
        --------
        >>> Law(((-1e7, -1e15), (1e7, 1e15)), (0.0, 0.0)).anchors.tolist()
        [[-10000000.0, -1000000000000000.0], [0.0, 0.0], [10000000.0, 1000000000000000.0]]
        """
        result = self.corners.copy()
        least, most = self.ranges.T
        inner = np.zeros(len(result), np.bool_) if self.straight else ~self.at_ends
        for piece in np.flatnonzero((self.slopes > 0.0) & (least <= 0.0) & (most >= 0.0)):
            (travel, force), slope = result[piece], self.slopes[piece]
            # The core forms the same differences, so that both round alike.
            terms = travel, force / slope
            if inner[piece] and np.isfinite(slope):
                beyond, above = self.vertices[piece]
                terms = travel * (above / (above - force)), beyond * (force / (above - force))
            zero = terms[0] - terms[1]
            result[piece] = (0.0 if abs(zero) <= _ROUNDING * abs(terms[0]) else zero), 0.0
        return result

    @cached_property
    def ranges(self) -> Floats:
        """Least and largest force (p, 2) on every piece.

        Examples
        --------
        >>> Law(((0.0, 0.0), (0.01, 5.0)), (0.0, 0.0)).ranges.tolist()
        [[0.0, 0.0], [0.0, 5.0], [5.0, 5.0]]
        """
        inner = [] if self.straight else [force for _, force in self.vertices]
        ends = [self.forces[0], *inner, self.forces[1]]
        return np.column_stack([ends[:-1], ends[1:]])

    @cached_property
    def straight(self) -> bool:
        """Whether the law is one line: the point neither lets go nor yields."""
        return len(self.vertices) == 1 and self.ends[0] == self.ends[1]

    @property
    def only_pushes(self) -> bool:
        """Whether the law is λ = k max(s, 0): no tension, one slope, no limit."""
        return len(self.vertices) == 1 and self.ends[0] == 0.0

    @property
    def pushing(self) -> Law:
        """The law λ = k max(s, 0) with the largest slope k of this law."""
        return Law(ends=(0.0, float(self.slopes.max())))

    @cached_property
    def forces(self) -> tuple[float, float]:
        """Least and largest force; infinite if unlimited."""
        (first, last), (before, beyond) = (self.vertices[0][1], self.vertices[-1][1]), self.ends
        return -np.inf if before > 0.0 else first, np.inf if beyond > 0.0 else last

    @cached_property
    def at_rest(self) -> tuple[float, float]:
        """Least and largest force at zero travel."""
        forces = [force for travel, force in self.vertices if travel == 0.0] or [float(self.force_at(0.0))]
        before, beyond = self.ends
        return -np.inf if before == np.inf else min(forces), np.inf if beyond == np.inf else max(forces)

    def force_at(self, travel: ArrayLike) -> Floats:
        """Force at travels; a law without tension is continued linearly before its first vertex.

        Examples
        --------
        >>> Law.drawn([(0.0, 0.0), (0.5, 2.0), (1.0, 2.0)], both=False).force_at([-0.5, 0.25, 3.0]).tolist()
        [-2.0, 1.0, 2.0]
        """
        travels, vertex_travels = np.asarray(travel, dtype=np.float64), [vertex[0] for vertex in self.vertices]
        first = int(self.ends[0] == 0.0)
        piece = np.minimum(np.maximum(np.searchsorted(vertex_travels, travels, "right"), first), len(self.slopes) - 1)
        return np.asarray(self.anchors[piece, 1] + self.slopes[piece] * (travels - self.anchors[piece, 0]))

    def pieces_at(self, force: Floats, tolerance: Floats, flat: bool = True) -> Ints:
        """Pieces (..., k) that contain forces (..., k) within a tolerance (..., k).

        Where several pieces do, choose one with slope 0 if ``flat``, else one with a slope.
        """
        if self.straight:
            return np.zeros(force.shape, np.int64)
        vertex_forces = self.corners[1:, 1]
        first = np.searchsorted(vertex_forces, force - tolerance, "left")
        last = np.searchsorted(vertex_forces, force + tolerance, "right")
        candidates = np.flatnonzero((self.slopes == 0.0) == flat)
        candidate = np.append(candidates, len(self.slopes))[np.searchsorted(candidates, first)]
        return np.where(candidate <= last, candidate, first)

    def flat_force(self, travel: ArrayLike) -> Floats:
        """Force of the piece with slope 0 that contains each travel; infinite where the piece there has a slope.

        Examples
        --------
        >>> Law(((0.0, 0.0), (0.01, 5.0)), (0.0, 0.0)).flat_force([-1.0, 0.0, 0.005, 0.02]).tolist()
        [0.0, 0.0, inf, 5.0]
        """
        travels = np.asarray(travel, dtype=np.float64)
        ends = [-np.inf, *(vertex[0] for vertex in self.vertices), np.inf]
        result = np.full_like(travels, np.inf)
        for piece, (slope, (_, force)) in enumerate(zip(self.slopes, self.corners, strict=True)):
            if slope == 0.0:
                result[(ends[piece] <= travels) & (travels <= ends[piece + 1])] = force
        return result

    def travels(self, force: ArrayLike) -> tuple[Floats, Floats]:
        """Least and largest travel at forces within the law's range; infinite on an unbounded piece with slope 0.

        Examples
        --------
        >>> soil = Law(((0.0, 0.0), (0.01, 5.0)), (0.0, 0.0))
        >>> [ends.tolist() for ends in soil.travels([0.0, 2.0, 5.0])]
        [[-inf, 0.004, 0.01], [0.0, 0.004, inf]]
        """
        at_force, forces = np.asarray(force, dtype=np.float64), [vertex[1] for vertex in self.vertices]
        result = []
        sides: tuple[tuple[Literal["left", "right"], float], ...] = (("left", -np.inf), ("right", np.inf))
        for side, endless in sides:
            # The number of vertices below the force (not above it, for the largest travel) is the piece's index.
            piece = np.minimum(np.searchsorted(forces, at_force, side), len(self.slopes) - 1)
            slope, flat = self.slopes[piece], self.slopes[piece] == 0.0
            along = (at_force - self.anchors[piece, 1]) / np.where(flat, 1.0, slope)
            result.append(np.where(flat, endless, self.anchors[piece, 0] + along))
        return result[0], result[1]


LAWS = tuple(Law(ends=(0.0, slope)) for slope in (1.0, np.inf))
LAWS += tuple(Law(ends=(slope, slope)) for slope in (1.0, np.inf))
LAWS += tuple(Law(((0.0, 0.0), (travel, 1.0)), (0.0, 0.0)) for travel in (1.0, 0.0))
LAWS += tuple(Law(((-travel, -1.0), (travel, 1.0)), (0.0, 0.0)) for travel in (1.0, 0.0))
"""Unit laws, each with slope 1 and rigid: one-sided, two-sided, one-sided with limit 1, two-sided with limit 1."""


def acts_both_ways(support: Support) -> bool:
    """Whether a support resists motion both downwards and upwards, without a gap.

    Examples
    --------
    >>> acts_both_ways(Support(area="all", resists="both", law=[[0, 0], [1e-3, 1e4]]))
    True
    >>> acts_both_ways(Support(area="all", resists="down", stiffness=1e7))
    False
    """
    both = support.fix is not None or support.resists == "both"
    return both and support.gap.is_constant and support.gap.value == 0.0


def can_let_go(support: Support) -> bool:
    """Whether the law of a support has a kink: it lets go, yields, or changes its slope.

    Examples
    --------
    >>> can_let_go(Support(area="all", resists="both", law=[[0, 0], [1e-3, 1e4]]))
    False
    >>> can_let_go(Support(area="all", resists="both", stiffness=1e7, limit=1e4))
    True
    """
    if support.limit is not None or not acts_both_ways(support):
        return True
    return support.law is not None and not Law.drawn(support.law, both=True).straight


def laws_of(both: bool, limited: bool) -> tuple[Law, Law]:
    """Return the unit laws of `LAWS` with slope 1 and rigid."""
    first = 4 * limited + 2 * both
    return LAWS[first], LAWS[first + 1]
