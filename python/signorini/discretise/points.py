"""The table of points of supports, and the grouping of these points by support."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from signorini.base.remade import Brief
from signorini.discretise.laws import LAWS, Graphs, Law
from signorini.discretise.rows import Bools, Floats, Ints, Pieces, Rows, Table


@dataclass(frozen=True, eq=False, repr=False)
class ContactPoints(Table, Brief):
    """Points of supports: the reaction is λ = ``scale`` · law((row·u − ``distance``) / ``unit``).

    ``rows`` G (m, 3n), ``distance`` g (m,). The part ``settlement`` (m,) of the distance is the settlement of the base
    in the row's direction; the rest is the gap. ``law`` (m,) is the index of each point's law in ``laws``.

    ``tightened_to`` (m,) is the reaction to which bolts were last tightened. ``preload`` (m,) is the reaction of every
    point when all bolts are tightened and no other load acts. Both are 0 where no bolt is tightened.

    ``direction`` (m,) is +1 where the support pushes the plate up; −1 where the support holds the plate down, and the
    row has the opposite sign. ``slope`` (m,) marks two-sided points that hold a slope. ``positions`` (m, 2) and
    ``weights`` (m,) (1, length or area) are those of the quadrature points. ``support`` (m,) is the index of the
    support, ``numbers`` (m,) the point's number among its support's points, from 0; 0 along lines and on areas.
    ``shared`` (m, 4) are the elements whose area a point that acts on element means represents in part; unused entries
    are −1.
    """

    rows: Rows
    distance: Floats
    settlement: Floats
    tightened_to: Floats
    preload: Floats
    law: Ints
    scale: Floats
    unit: Floats
    direction: Floats
    slope: Bools
    positions: Floats
    weights: Floats
    support: Ints
    shared: Ints
    numbers: Ints
    laws: tuple[Law, ...]

    @classmethod
    def none(cls) -> Self:
        """The table without points."""
        zeros, ids = np.zeros(0), np.zeros(0, np.int64)
        flags, place = np.zeros(0, np.bool_), np.zeros((0, 2))
        shared = np.zeros((0, 4), np.int64)
        columns = zeros, zeros, zeros, zeros, ids, zeros, zeros, zeros, flags, place, zeros, ids, shared, ids
        return cls(Rows.join([]), *columns, LAWS)

    @classmethod
    def of(
        cls,
        graphs: Graphs,
        rows: Rows,
        slope: Bools,
        positions: Floats,
        weights: Floats,
        support: Ints,
        shared: Ints,
        numbers: Ints,
    ) -> Self:
        """Table of points with the laws ``graphs``; no point is a tightened bolt."""
        direction, distance, settlement, law, scale, unit, laws = graphs
        none, ways = np.zeros(len(rows)), np.full(len(rows), direction)
        of_law = distance, settlement, none, none, law, scale, unit, ways
        return cls(rows if direction > 0 else -rows, *of_law, slope, positions, weights, support, shared, numbers, laws)

    @classmethod
    def join(cls, parts: Sequence[Self]) -> Self:
        """Concatenate tables; laws that occur in several tables share one index."""
        laws = tuple(dict.fromkeys(law for part in parts for law in part.laws))
        numbers = [np.array([laws.index(law) for law in part.laws], np.int64)[part.law] for part in parts]
        return super().join([replace(part, law=law, laws=laws) for part, law in zip(parts, numbers, strict=True)])

    @cached_property
    def compliance(self) -> Floats:
        """Compliance C (m,), travel over force, on the stiffest piece of each point's law; 0 if this piece is rigid."""
        slope: Floats = np.array([law.slopes.max() for law in self.laws])[self.law]
        return np.asarray(self.unit / (self.scale * slope))

    @cached_property
    def stiffness(self) -> Floats:
        """Stiffness 1/C (m,), force over travel, on the stiffest piece of each point's law; infinite if it is rigid."""
        slope: Floats = np.array([law.slopes.max() for law in self.laws])[self.law]
        return np.asarray(self.scale * slope / self.unit)

    @property
    def arrays(self) -> tuple[Ints, Floats, Ints, Floats, Floats]:
        """Elements, coefficients and row indices of rows, then stiffness and distance, as `_core` takes springs."""
        return *self.rows.arrays, self.stiffness, self.distance

    @cached_property
    def limits(self) -> tuple[Floats, Floats]:
        """Least and largest reaction (m,) of the points; infinite if unlimited."""
        least, most = np.array([law.forces for law in self.laws])[self.law].T
        return self.scale * least, self.scale * most

    @cached_property
    def limits_at_rest(self) -> tuple[Floats, Floats]:
        """Least and largest reaction (m,) at zero travel: the range within which rigid points can share a load."""
        least, most = np.array([law.at_rest for law in self.laws])[self.law].T
        return self.scale * least, self.scale * most

    def yield_on(self, pieces: Ints | Pieces) -> Bools:
        """Whether points (..., m) yield: the piece of the law is the first or the last, with slope 0 and a force.

        The piece decides, not the force, which may reach the limit without yield travel. Redundant points have no
        piece: `results.support_points.SupportPoints.yielded` decides by force.
        """
        slopes, forces, ends, _ = self._pieces
        return np.asarray(((slopes == 0.0) & (forces != 0.0) & ends)[self.law, pieces])

    def open_on(self, pieces: Ints | Pieces) -> Bools:
        """Whether points (..., m) are open: the given piece of the law has slope 0 and zero force."""
        slopes, forces, _, _ = self._pieces
        return np.asarray(((slopes == 0.0) & (forces == 0.0))[self.law, pieces])

    def flat_on(self, pieces: Ints | Pieces) -> Bools:
        """Whether the given pieces (..., m) of the points' laws have slope 0."""
        return np.asarray((self._pieces[0] == 0.0)[self.law, pieces])

    def forces_on(self, pieces: Ints | Pieces) -> Floats:
        """Forces (..., m) of points on the given pieces of their laws, which have slope 0."""
        return np.asarray(self.scale * self._pieces[1][self.law, pieces])

    def range_on(self, pieces: Ints | Pieces) -> tuple[Floats, Floats]:
        """Least and largest force (..., m) on the given pieces of the points' laws."""
        ranges = self._pieces[3][self.law, pieces]
        return self.scale * ranges[..., 0], self.scale * ranges[..., 1]

    @cached_property
    def _pieces(self) -> tuple[Floats, Floats, Bools, Floats]:
        """Tables (laws, p) of all pieces: slope, force at its vertex, mask of end pieces; force ranges (laws, p, 2)."""
        shape = len(self.laws), max(len(law.slopes) for law in self.laws)
        slopes, forces, ends = np.full(shape, np.nan), np.zeros(shape), np.zeros(shape, np.bool_)
        ranges = np.zeros((*shape, 2))
        for number, law in enumerate(self.laws):
            entries = number, slice(len(law.slopes))
            slopes[entries], forces[entries], ends[entries] = law.slopes, law.corners[:, 1], law.at_ends
            ranges[entries] = law.ranges
        return slopes, forces, ends, ranges

    @cached_property
    def by_law(self) -> tuple[tuple[Law, Ints | slice], ...]:
        """Each law that occurs, with the indices (k,) of the points that have this law."""
        if (self.law[:1] == self.law).all():
            return ((self.laws[self.law[0]], slice(None)),) if len(self) else ()
        return tuple((self.laws[number], np.flatnonzero(self.law == number)) for number in np.unique(self.law))

    def room(self, travel: Floats, reaction: Floats) -> tuple[Floats, Floats]:
        """Distances (m,) by which each point can travel backward, and forward, without a change of its reaction.

        The point starts at ``travel``, on the piece of its law that contains ``reaction``.
        """
        backward, forward = np.zeros(len(self)), np.zeros(len(self))
        for law, points in self.by_law:
            low, high = law.travels(np.clip(reaction[points] / self.scale[points], *law.forces))
            backward[points] = travel[points] - self.unit[points] * low
            forward[points] = self.unit[points] * high - travel[points]
        return backward, forward

    def pieces_at(self, reaction: Floats, tolerance: Floats | float, flat: bool = True) -> Pieces:
        """Index (..., m) of the law's piece that contains each reaction (..., m) within a tolerance.

        If several pieces do, a piece with slope 0 is chosen if ``flat``, else one with another slope.
        """
        result = np.zeros(reaction.shape, np.uint8)
        force, law_tolerance = reaction / self.scale, tolerance / self.scale
        for law, points in self.by_law:
            result[..., points] = law.pieces_at(force[..., points], law_tolerance[..., points], flat)
        return result

    @cached_property
    def two_sided(self) -> Bools:
        """Whether each point (m,) has a straight law, Gu − Cλ = g, and so neither lets go nor yields."""
        return np.array([law.straight for law in self.laws], np.bool_)[self.law]

    @cached_property
    def equations(self) -> Bools:
        """Whether each point (m,) is a constraint Gu = g: a straight law with C = 0.

        The rows of these points may be linearly dependent.
        """
        return np.asarray(self.two_sided & (self.compliance == 0.0))

    @cached_property
    def holds_both_ways(self) -> Bools:
        """Whether points (m,) have forces in both directions without a limit."""
        return np.asarray((self.limits[0] == -np.inf) & (self.limits[1] == np.inf))

    @cached_property
    def unyielding(self) -> Bools:
        """Whether the last piece of each point's law (m,) is rigid, with infinite slope."""
        return np.isinf([law.ends[1] for law in self.laws])[self.law]

    @cached_property
    def rigid_ways(self) -> tuple[Bools, Bools]:
        """Masks (m,) of points that rigidly resist motion down, and motion up: the law has a rigid end piece there."""
        before, beyond = np.isinf([law.ends for law in self.laws])[self.law].T
        pushes_up = self.direction > 0.0
        return np.where(pushes_up, beyond, before), np.where(pushes_up, before, beyond)

    @property
    def averaged(self) -> Bools:
        """Mask (m,) of contact points of areas that act on element means; their points on outlines are included."""
        return self.shared[:, 0] >= 0


@dataclass(frozen=True, eq=False)
class Parts:
    """Indices of one support's nodes, springs and contact points.

    ``nodes`` (h,) are the nodes at which the support holds the deflection, ``springs`` (s,) its springs, except springs
    on slopes. ``rows`` (1, c) or (2, c) are its contact points, except points on slopes; with a gap in both directions,
    row 0 has the points that push up, row 1 the points that hold down. ``order`` (h + s + c,) sorts nodes, springs and
    contact points as in the input.
    """

    nodes: Ints
    springs: Ints
    rows: Ints
    order: Ints


def parts_of(
    count: int, nodes: Ints, held: ContactPoints, springs: ContactPoints, points: ContactPoints
) -> tuple[Parts, ...]:
    """The `Parts` of each of ``count`` supports: ``held`` points (k,) at ``nodes`` (k,), springs, contact points."""
    columns = zip(
        _grouped(held.support, count),
        _grouped(np.where(springs.slope, count, springs.support), count),
        _grouped(np.where(points.slope, count, points.support), count),
        strict=True,
    )
    result = []
    for holding, spring_indices, point_indices in columns:
        up = points.direction[point_indices] > 0
        both = up.any() and not up.all()
        rows = np.stack([point_indices[up], point_indices[~up]]) if both else point_indices.reshape(1, -1)
        numbers = np.concatenate([held.numbers[holding], springs.numbers[spring_indices], points.numbers[rows[0]]])
        result.append(Parts(nodes[holding], spring_indices, rows, np.argsort(numbers, kind="stable")))
    return tuple(result)


def _grouped(owner: Ints, count: int) -> list[Ints]:
    """For each number below ``count``, the indices of the entries of ``owner`` that are equal to it."""
    order = np.argsort(owner, kind="stable")
    return np.split(order, np.searchsorted(owner[order], np.arange(1, count + 1)))[:count]
