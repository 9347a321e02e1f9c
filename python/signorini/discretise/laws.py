"""Laws of contact points (force over travel) and of supports; only this module reads the keys of a support's law."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from signorini.discretise.rows import Bools, Floats, Ints
from signorini.errors import InputError, Place
from signorini.expression import Expression, Field
from signorini.expression.levels import Level
from signorini.model import Support
from signorini.model.field import PointFieldScalar

_ROUNDING = 1e-12
"""Relative tolerance for equal slopes of neighbouring pieces of a law, since points of a polyline are rounded."""


@dataclass(frozen=True)
class Law:
    """Nondecreasing polyline of force over travel, a monotone graph (Moreau 1965; Rockafellar 1970, section 24).

    Parameters
    ----------
    vertices : tuple of (travel, force)
        At least one; travels and forces do not decrease.
    ends : (float, float)
        Slopes before the first and after the last vertex; infinite where the law is vertical.
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
        """Slope (p,) of every piece of the law in the order of travel; a straight law has one piece."""
        steps = np.diff(np.reshape(self.vertices, (-1, 2)), axis=0)
        with np.errstate(divide="ignore"):
            inner = steps[:, 1] / steps[:, 0]
        return np.array(self.ends[:1] if self.straight else [self.ends[0], *inner, self.ends[1]])

    @cached_property
    def at_ends(self) -> Bools:
        """Mask (p,) of the first and the last piece."""
        number = np.arange(len(self.slopes))
        return np.asarray((number == 0) | (number == number[-1]))

    @cached_property
    def corners(self) -> Floats:
        """Vertex (travel, force) at which each piece begins (p, 2); for the first piece, the vertex at its end."""
        return np.array(self.vertices[:1] if self.straight else [self.vertices[0], *self.vertices])

    @cached_property
    def anchors(self) -> Floats:
        """Travel and force (p, 2) of a reference point on each piece: where the force is 0, else its `corners`.

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
            # The core finds the zero of the force by the same operations: Python and core agree to the last bit.
            terms = travel, force / slope
            if inner[piece] and np.isfinite(slope):
                beyond, above = self.vertices[piece]
                terms = travel * (above / (above - force)), beyond * (force / (above - force))
            zero = terms[0] - terms[1]
            result[piece] = (0.0 if abs(zero) <= _ROUNDING * abs(terms[0]) else zero), 0.0
        return result

    @cached_property
    def ranges(self) -> Floats:
        """Least and largest force (p, 2) on every piece of the law.

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
        """Whether the law is one straight line, so that the point neither opens nor yields."""
        return len(self.vertices) == 1 and self.ends[0] == self.ends[1]

    @property
    def only_pushes(self) -> bool:
        """Whether the law is λ = k max(s, 0), s the travel: no tension, one slope, no limit."""
        return len(self.vertices) == 1 and self.ends[0] == 0.0

    @property
    def pushing(self) -> Law:
        """The law λ = k max(s, 0), s the travel, where k is the largest slope of this law."""
        return Law(ends=(0.0, float(self.slopes.max())))

    @cached_property
    def forces(self) -> tuple[float, float]:
        """Least and largest force of the law; infinite if unlimited."""
        (first, last), (before, beyond) = (self.vertices[0][1], self.vertices[-1][1]), self.ends
        return -np.inf if before > 0.0 else first, np.inf if beyond > 0.0 else last

    @cached_property
    def at_rest(self) -> tuple[float, float]:
        """Least and largest force of the law at zero travel; different if the law is vertical there."""
        forces = [force for travel, force in self.vertices if travel == 0.0] or [float(self.force_at(0.0))]
        before, beyond = self.ends
        return -np.inf if before == np.inf else min(forces), np.inf if beyond == np.inf else max(forces)

    def force_at(self, travel: ArrayLike) -> Floats:
        """Force at each travel; a law without tension is continued linearly before its first vertex.

        Examples
        --------
        >>> Law.drawn([(0.0, 0.0), (0.5, 2.0), (1.0, 2.0)], both=False).force_at([-0.5, 0.25, 3.0]).tolist()
        [-2.0, 1.0, 2.0]
        """
        travels, vertex_travels = np.asarray(travel, dtype=np.float64), [vertex[0] for vertex in self.vertices]
        first = int(self.forces[0] == 0.0)
        piece = np.minimum(np.maximum(np.searchsorted(vertex_travels, travels, "right"), first), len(self.slopes) - 1)
        return np.asarray(self.anchors[piece, 1] + self.slopes[piece] * (travels - self.anchors[piece, 0]))

    def pieces_at(self, force: Floats, tolerance: Floats, flat: bool = True) -> Ints:
        """Index (..., k) of the piece that contains each force (..., k) within a tolerance (..., k).

        If several pieces do, a piece with slope 0 is chosen if ``flat``, else one with another slope.
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
        """Constant force at each travel that is on a piece with slope 0; ∞ at travels on other pieces.

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
        """Least and largest travel at each force within the law's range; infinite on an unbounded piece with slope 0.

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
            # Several pieces may have this force. Side "left" gives the one with the least travel, "right" the largest.
            piece = np.minimum(np.searchsorted(forces, at_force, side), len(self.slopes) - 1)
            slope, flat = self.slopes[piece], self.slopes[piece] == 0.0
            along = (at_force - self.anchors[piece, 1]) / np.where(flat, 1.0, slope)
            result.append(np.where(flat, endless, self.anchors[piece, 0] + along))
        return result[0], result[1]


LAWS = tuple(Law(ends=(0.0, slope)) for slope in (1.0, np.inf))
LAWS += tuple(Law(ends=(slope, slope)) for slope in (1.0, np.inf))
LAWS += tuple(Law(((0.0, 0.0), (travel, 1.0)), (0.0, 0.0)) for travel in (1.0, 0.0))
LAWS += tuple(Law(((-travel, -1.0), (travel, 1.0)), (0.0, 0.0)) for travel in (1.0, 0.0))
"""Laws for unit force: one-sided, two-sided, one-sided with limit 1, two-sided with limit 1.

Each of the four is listed with slope 1, then rigid.
"""


def acts_both_ways(support: Support) -> bool:
    """Whether a support resists motion downwards and upwards, without a gap.

    Examples
    --------
    >>> acts_both_ways(Support(area="all", resists="both", law=[[0, 0], [1e-3, 1e4]]))
    True
    >>> acts_both_ways(Support(area="all", resists="down", stiffness=1e7))
    False
    """
    return support.direction == "both" and not support.has_gap


def can_let_go(support: Support) -> bool:
    """Whether the law of a support is not straight: the support lets go, yields, or changes its stiffness.

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


def partition(straight: Bools, compliant: Bools, at_dofs: Bools, tightened: Bools) -> tuple[Bools, Bools, Bools]:
    """Divide points (m,) into held dofs, springs and contact points: three masks.

    A straight law makes a spring where it is compliant, C > 0, and a held dof where it is rigid at a dof of the plate.
    All other points are contact points, and so are those of ``tightened`` bolts, whose ``distance`` changes.
    """
    linear = straight & ~tightened
    held, springs = linear & ~compliant & at_dofs, linear & compliant
    return held, springs, ~held & ~springs


def is_unyielding(support: Support) -> bool:
    """Whether a support holds the deflection rigidly, without a limit on its force."""
    return support.is_rigid and not support.can_yield


def constant_limit(support: Support) -> float | None:
    """Largest force per length or pressure of a support; None without a limit, or if the limit varies."""
    limit = support.limit
    return limit.value if isinstance(limit, Expression) and limit.is_constant else None


def field_of(support: Support) -> Field | None:
    """Table of the stiffness of a support, which may be 0 in part of the support; None without a table."""
    return support.stiffness if isinstance(support.stiffness, Field) else None


def on_soil(support: Support, positions: Floats, place: Place = ()) -> Bools:
    """Mask (q,) of positions (q, 2) on a support at which its stiffness is not 0; only tables give stiffness 0."""
    field = field_of(support)
    if field is None:
        return np.ones(len(positions), np.bool_)
    return np.asarray(field(*positions.T, place=stiffness_place(support, place)) > 0.0)


def stiffness_place(support: Support, place: Place) -> Place:
    """Path in the model of the key that gives the stiffness of the support with path ``place``."""
    if support.law is not None:
        return *place, "law"
    field = field_of(support)
    return (*place, "stiffness", "file") if field is not None and field.file else (*place, "stiffness")


def constant_stiffness(support: Support) -> float | None:
    """Stiffness of a support if the stiffness is constant; None if it varies, or if a law gives it."""
    stiffness = support.stiffness
    return stiffness.value if isinstance(stiffness, Expression) and stiffness.is_constant else None


def orders_at(support: Support, numbers: Ints) -> Ints | None:
    """Order (k,) in which the bolts with the given numbers are tightened; None if the support has no preload."""
    return None if support.preload is None else np.broadcast_to(support.order or 1, support.point_count)[numbers]


def written_at(support: Support, positions: Floats) -> Iterator[tuple[str, str, Floats]]:
    """Yield key, kind of unit and values (k,) for gap, preload and order at the points (k, 2) of a support."""
    for key, kind, formula in (("gap", "length", support.gap), ("preload", "force", support.preload)):
        if formula is not None:
            yield key, kind, formula(*positions.T)
    if support.order is not None:
        yield "order", "", np.broadcast_to(np.array(support.order, np.float64), len(positions))


def has_constant_base(support: Support) -> bool:
    """Whether both the settlement and the gap of a support are constant."""
    return support.settlement.is_constant and support.gap.is_constant


def base_jumps(support: Support) -> bool:
    """Whether the settlement or the gap of a support jumps somewhere."""
    return bool(_jumps(support.settlement, support.gap))


def _jumps(*formulas: PointFieldScalar | None) -> list[Level]:
    """Level functions whose sign changes where one of the formulas jumps."""
    return [level for formula in formulas if formula is not None for level in formula.levels if level.jumps]


def formulas_of(support: Support) -> tuple[PointFieldScalar, ...]:
    """Formulas that vary along a support: those of stiffness, limit, gap and settlement that the support has."""
    formulas = support.modulus, support.limit, support.gap, support.settlement
    return tuple(formula for formula in formulas if formula is not None)


def jumps_of(support: Support) -> list[Level]:
    """Level functions whose zeros are jumps of an elastic support's stiffness, limit, gap or settlement.

    The list is empty for a rigid support.
    """
    return _jumps(*formulas_of(support)) if support.is_elastic else []


def steps_of(support: Support) -> list[Level]:
    """Level functions at whose zeros the quadrature over a support is divided, since its law jumps there.

    If the support has a limit, kinks of limit and stiffness count too, so that the limit load is accurate.
    """
    if support.modulus is None or support.limit is None:
        return jumps_of(support)
    kinks = [level for formula in (support.modulus, support.limit) for level in formula.levels if not level.jumps]
    return jumps_of(support) + kinks


def modulus_at(support: Support, positions: Floats, place: Place) -> Floats | None:
    """Stiffness (q,) of a support at positions (q, 2), per point, length or area; None for a rigid support."""
    if support.modulus is None:
        return None
    return support.modulus(*positions.T, above=0.0, place=(*place, "stiffness"))


def levels_of(support: Support, positions: Floats, place: Place) -> tuple[Floats, Floats]:
    """Deflections (q,) at which a support begins to push the plate up, and to hold it down, at positions (q, 2)."""
    gap = support.gap(*positions.T, at_least=0.0, place=(*place, "gap"))
    settlement = settlement_at(support, positions, place)
    return settlement + gap, settlement - gap


class Graphs(NamedTuple):
    """Laws of m points that push the plate up (``direction`` 1) or hold it down (−1): columns as in `ContactPoints`."""

    direction: float
    distance: Floats
    settlement: Floats
    law: Ints
    scale: Floats
    unit: Floats
    laws: tuple[Law, ...]

    @classmethod
    def linear(cls, stiffness: Floats, base: Floats) -> Graphs:
        """Laws of springs with the force ``stiffness`` (row·u − ``base``)."""
        law, unit = np.zeros(len(base), np.int64), np.ones(len(base))
        return cls(1.0, 0.0 + base, base, law, stiffness, unit, LAWS[2:3])

    @classmethod
    def rigid(cls, base: Floats) -> Graphs:
        """Laws of the constraints row·u = ``base``."""
        law, ones = np.zeros(len(base), np.int64), np.ones(len(base))
        return cls(1.0, base, base, law, ones, ones, LAWS[3:4])


def graphs_of(
    support: Support, positions: Floats, weights: Floats, stiffest: Floats, slopes: Floats, place: Place
) -> list[Graphs]:
    """Laws of a support's points at positions (m, 2): one entry, or two if the support has a gap in both directions.

    ``weights`` (m,) are 1, lengths or areas, ``stiffest`` (m,) bounds the stiffness of springs. ``slopes`` (m,) are
    prescribed slopes, NaN for points whose row is the deflection.
    """
    on_deflection = bool(np.isnan(slopes).all())
    settlement = settlement_at(support, positions, place) if on_deflection else slopes
    gap = support.gap(*positions.T, at_least=0.0, place=(*place, "gap"))
    both = support.direction == "both" and not gap.any()
    elastic, stiffness = np.zeros(len(weights), np.bool_), np.ones(len(weights))
    if (modulus := modulus_at(support, positions, place)) is not None:
        stiffness = weights * modulus
        if support.law is not None and (stiffness >= stiffest).any():
            raise InputError(
                f"found a piece with the slope {float(modulus[0]):.4g}, which acts as rigid. Give this piece no "
                "travel, or a smaller slope.",
                place=(*place, "law"),
            )
        elastic = stiffness < stiffest
        if both and support.limit is None:
            # A straight law with C > 0 makes a spring, whose stiffness is at most ``stiffest``.
            elastic, stiffness = np.ones(len(weights), np.bool_), np.minimum(stiffness, stiffest)
    if support.law is not None:
        laws: tuple[Law, ...] = (Law.drawn(support.law, both=both),)
        law, scale, unit = np.zeros(len(weights), np.int64), weights, np.ones(len(weights))
    elif support.limit is not None:
        laws, law = LAWS, np.where(elastic, 4, 5) + 2 * both
        scale = weights * support.limit(*positions.T, above=0.0, place=(*place, "limit"))
        unit = np.where(elastic, scale / stiffness, 1.0)
    else:
        laws, law = LAWS, np.where(elastic, 0, 1) + 2 * both
        scale, unit = np.where(elastic, stiffness, 1.0), np.ones(len(weights))
    directions = [1.0] * (both or support.direction != "up") + [-1.0] * (not both and support.direction != "down")
    return [
        Graphs(direction, gap + direction * settlement, direction * settlement, law, scale, unit, laws)
        for direction in directions
    ]


def settlement_at(support: Support, positions: Floats, place: Place = ()) -> Floats:
    """Settlement (q,) of a support at positions (q, 2)."""
    return support.settlement(*positions.T, place=(*place, "settlement"))


def slopes_at(support: Support, positions: Floats, place: Place = ()) -> Floats:
    """Slopes θx, θy (q, 2) that a support prescribes at positions (q, 2)."""
    formulas = support.rotation or (Expression(0.0),) * 2
    return np.column_stack([formula(*positions.T, place=(*place, "rotation")) for formula in formulas])


def known_values(formula: Callable[..., Floats], positions: Floats) -> Floats:
    """Values (q,) of a formula at positions (q, 2); NaN where the formula cannot be evaluated."""
    try:
        return formula(*positions.T)
    except InputError:
        if len(positions) == 1:
            return np.array([np.nan])
        half = len(positions) // 2
        return np.concatenate([known_values(formula, positions[:half]), known_values(formula, positions[half:])])


@dataclass(frozen=True)
class SupportLaw:
    """Law of an area support for fields of deflections; the pressure is positive up, NaN where a formula has no value.

    The free travel ends where the support begins to act or, with ``to_limit``, where it yields.
    """

    support: Support
    to_limit: bool = False

    @property
    def bounds(self) -> tuple[float, float]:
        """Least and largest pressure that the direction of the support allows, regardless of the limit."""
        return {"down": (0.0, np.inf), "up": (-np.inf, 0.0), "both": (-np.inf, np.inf)}[self.support.direction]

    @property
    def has_curve_of_yielding(self) -> bool:
        """Whether the yielding region of the support ends at a continuous curve: limit and stiffness do not jump."""
        law, jumps = self.support.law, _jumps(self.support.limit, self.support.modulus)
        return self.support.is_elastic and not jumps and (law is None or law[0][0] >= 0.0)

    def travel(self, positions: Floats) -> tuple[Floats, Floats]:
        """Settlement (q,) and free travel (q,) of the support at positions (q, 2)."""
        settlement, gap = (known_values(formula, positions) for formula in (self.support.settlement, self.support.gap))
        return settlement, gap + self._travel_at_limit(positions) if self.to_limit else gap

    def overlap(self, deflection: Floats, travel: tuple[Floats, Floats]) -> Floats:
        """Travel (..., q) beyond the end of the free travel; a negative value is minus the remaining gap."""
        down, up = _beyond(deflection, travel)
        return {"down": down, "up": up}.get(self.support.direction, np.maximum(down, up))

    def pressure(self, deflection: Floats, positions: Floats) -> Floats:
        """Pressure (..., q) of an elastic area for deflections (..., q) at positions (q, 2), within its limit.

        The pressure continues beyond ``bounds``, as if the area acted in both directions. It is 0 at the edge of
        contact.

        Examples
        --------
        >>> soil = SupportLaw(Support(area="all", resists="down", stiffness=1e3, gap=0.25))
        >>> soil.pressure(np.array([1.0, 0.0]), np.zeros((2, 2)))
        array([ 750., -250.])
        """
        support, (down, up) = self.support, _beyond(deflection, self.travel(positions))
        both = np.maximum(down, 0.0) - np.maximum(up, 0.0)
        travel = {"down": down, "up": -up}.get(support.direction, both)
        if support.law is not None:
            sign, law = 1.0 - 2.0 * (support.direction == "up"), Law.drawn(support.law, support.direction == "both")
            return sign * law.force_at(sign * travel)
        assert support.stiffness is not None
        result = known_values(support.stiffness, positions) * travel
        if support.limit is None:
            return np.asarray(result)
        most = known_values(support.limit, positions)
        return np.asarray(np.clip(result, -most, most))

    def _travel_at_limit(self, positions: Floats) -> Floats | float:
        support = self.support
        if support.law is not None:
            return next(travel for travel, force in support.law if force == support.law[-1][1])
        assert support.limit is not None and support.stiffness is not None
        limit, stiffness = (known_values(formula, positions) for formula in (support.limit, support.stiffness))
        return np.divide(limit, stiffness, out=np.zeros_like(limit), where=~(stiffness <= 0.0))


def _beyond(deflection: Floats, travel: tuple[Floats, Floats]) -> tuple[Floats, Floats]:
    """Travels (..., q) beyond the free travel g and the settlement s: w − s − g downwards, s − w − g upwards."""
    settlement, gap = travel
    moved = deflection - settlement
    return moved - gap, -moved - gap
