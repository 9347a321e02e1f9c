"""Springs and contact points as tables, and which of them are each support's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from signorini.base.remade import Brief
from signorini.discretise.held import Held
from signorini.discretise.laws import LAWS, Law
from signorini.discretise.rows import Bools, Floats, Ints, Pieces, Rows, Table


@dataclass(frozen=True, eq=False, repr=False)
class Springs(Table, Brief):
    """Linear springs: stiffness and base (m,); position (m, 2), weight and support of each, ``numbers`` as below.

    ``slope`` marks those that act on a slope, with a couple.
    """

    rows: Rows
    stiffness: Floats
    base: Floats
    positions: Floats
    weights: Floats
    support: Ints
    numbers: Ints
    slope: Bools

    @property
    def direction(self) -> Floats:
        """Which way (m,) each pushes the plate that presses it: up."""
        return np.ones(len(self))

    @property
    def averaged(self) -> Bools:
        """Which (m,) act on means of elements: none."""
        return np.zeros(len(self), np.bool_)

    @property
    def arrays(self) -> tuple[Ints, Floats, Ints, Floats, Floats]:
        """Springs the way the core takes them."""
        return *self.rows.arrays, self.stiffness, self.base


@dataclass(frozen=True, eq=False, repr=False)
class ContactPoints(Table, Brief):
    """Contact points: each reacts with ``scale`` times the force of its law at (row·u − distance) / ``unit``.

    ``law`` (m,) numbers the `laws`. Of ``distance`` the part ``settlement`` is that of the base in the row's direction;
    the rest is free travel.
    ``tightened_to`` (m,) is the reaction to which bolts were last tightened, ``preload`` (m,) that of all points when
    all bolts are tightened and before other loads act; 0 where no bolt is tightened.
    ``direction`` is +1 where the support pushes the plate up and −1 where it holds it down (its row is turned round).
    ``slope`` marks two-sided points that hold a slope instead of the deflection. ``shared`` (m, 4) names the elements
    of which points of an averaged area stand for part, by their areas; −1 where there is none. ``numbers`` (m,) say
    which of its support's points each is, as the input lists them from 0; 0 along lines and on areas.
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
        """No point."""
        none, who = np.zeros(0), np.zeros(0, np.int64)
        flags, place = np.zeros(0, np.bool_), np.zeros((0, 2))
        shared = np.zeros((0, 4), np.int64)
        columns = none, none, none, none, who, none, none, none, flags, place, none, who, shared, who
        return cls(Rows.join([]), *columns, LAWS)

    @classmethod
    def join(cls, parts: Sequence[Self]) -> Self:
        """Put tables behind one another; equal laws have one number."""
        laws = tuple(dict.fromkeys(law for part in parts for law in part.laws))
        numbers = [np.array([laws.index(law) for law in part.laws], np.int64)[part.law] for part in parts]
        return super().join([replace(part, law=law, laws=laws) for part, law in zip(parts, numbers, strict=True)])

    @cached_property
    def compliance(self) -> Floats:
        """Travel over force (m,) where the law is steepest; 0 where it is rigid."""
        slope: Floats = np.array([law.slopes.max() for law in self.laws])[self.law]
        return np.asarray(self.unit / (self.scale * slope))

    @cached_property
    def stiffness(self) -> Floats:
        """Force over travel (m,) where the law is steepest; infinite where it is rigid."""
        slope: Floats = np.array([law.slopes.max() for law in self.laws])[self.law]
        return np.asarray(self.scale * slope / self.unit)

    @cached_property
    def limits(self) -> tuple[Floats, Floats]:
        """Least and largest force (m,) that points can give; infinite where there is no end to it."""
        least, most = np.array([law.forces for law in self.laws])[self.law].T
        return self.scale * least, self.scale * most

    @cached_property
    def limits_at_rest(self) -> tuple[Floats, Floats]:
        """The same without travel: what rigid points can share among themselves."""
        least, most = np.array([law.at_rest for law in self.laws])[self.law].T
        return self.scale * least, self.scale * most

    def yield_on(self, pieces: Ints | Pieces) -> Bools:
        """Whether points (..., m) give all they can on these pieces of their laws."""
        slopes, forces, ends, _ = self._pieces
        return np.asarray(((slopes == 0.0) & (forces != 0.0) & ends)[self.law, pieces])

    def open_on(self, pieces: Ints | Pieces) -> Bools:
        """Whether points (..., m) do not react on these pieces of their laws, whatever their travel."""
        slopes, forces, _, _ = self._pieces
        return np.asarray(((slopes == 0.0) & (forces == 0.0))[self.law, pieces])

    def flat_on(self, pieces: Ints | Pieces) -> Bools:
        """Whether the force of points (..., m) does not depend on their travel on these pieces of their laws."""
        return np.asarray((self._pieces[0] == 0.0)[self.law, pieces])

    def forces_on(self, pieces: Ints | Pieces) -> Floats:
        """Forces (..., m) that points have on these pieces of their laws, where they do not depend on the travel."""
        return np.asarray(self.scale * self._pieces[1][self.law, pieces])

    def range_on(self, pieces: Ints | Pieces) -> tuple[Floats, Floats]:
        """Least and largest force (..., m) of points on these pieces of their laws."""
        ranges = self._pieces[3][self.law, pieces]
        return self.scale * ranges[..., 0], self.scale * ranges[..., 1]

    @cached_property
    def _pieces(self) -> tuple[Floats, Floats, Bools, Floats]:
        """Slopes and forces (laws, p) of all pieces of the laws, whether they are ends, and ranges (laws, p, 2)."""
        shape = len(self.laws), max(len(law.slopes) for law in self.laws)
        slopes, forces, ends = np.full(shape, np.nan), np.zeros(shape), np.zeros(shape, np.bool_)
        ranges = np.zeros((*shape, 2))
        for number, law in enumerate(self.laws):
            own = number, slice(len(law.slopes))
            slopes[own], forces[own], ends[own] = law.slopes, law.corners[:, 1], law.at_ends
            ranges[own] = law.ranges
        return slopes, forces, ends, ranges

    @cached_property
    def by_law(self) -> tuple[tuple[Law, Ints | slice], ...]:
        """The laws that points have, and which points (k,) have each."""
        if (self.law[:1] == self.law).all():
            return ((self.laws[self.law[0]], slice(None)),) if len(self) else ()
        return tuple((self.laws[number], np.flatnonzero(self.law == number)) for number in np.unique(self.law))

    def room(self, travel: Floats, reaction: Floats) -> tuple[Floats, Floats]:
        """How far points (m,) can travel back and on, from this travel, with the same reaction."""
        back, on = np.zeros(len(self)), np.zeros(len(self))
        for law, at in self.by_law:
            low, high = law.travels(np.clip(reaction[at] / self.scale[at], *law.forces))
            back[at], on[at] = travel[at] - self.unit[at] * low, self.unit[at] * high - travel[at]
        return back, on

    def pieces_at(self, reaction: Floats, nothing: Floats | float, flat: bool = True) -> Pieces:
        """Pieces (..., m) of the laws on which points have these reactions (..., m), but for ``nothing``.

        Where several are, a flat one, or else one that is not.
        """
        result = np.zeros(reaction.shape, np.uint8)
        force, least = reaction / self.scale, nothing / self.scale
        for law, at in self.by_law:
            result[..., at] = law.pieces_at(force[..., at], least[..., at], flat)
        return result

    @cached_property
    def two_sided(self) -> Bools:
        """Points (m,) with a straight law, Gu − Cλ = g: they neither let go nor yield."""
        return np.array([law.straight for law in self.laws], np.bool_)[self.law]

    @cached_property
    def equations(self) -> Bools:
        """Points (m,) with a straight law of zero compliance, Gu = g: constraints that may depend on each other."""
        return np.asarray(self.two_sided & (self.compliance == 0.0))

    @cached_property
    def holds_both_ways(self) -> Bools:
        """Points (m,) that hold the plate both ways without a limit, so that it is not free to move there."""
        return np.asarray((self.limits[0] == -np.inf) & (self.limits[1] == np.inf))

    @cached_property
    def unyielding(self) -> Bools:
        """Points (m,) that no force makes travel."""
        return np.isinf([law.ends[1] for law in self.laws])[self.law]

    @cached_property
    def rigid_ways(self) -> tuple[Bools, Bools]:
        """Points (m,) that no force moves down, and points that no force moves up: vertical ends of their laws."""
        before, beyond = np.isinf([law.ends for law in self.laws])[self.law].T
        pushes_up = self.direction > 0.0
        return np.where(pushes_up, beyond, before), np.where(pushes_up, before, beyond)

    @property
    def averaged(self) -> Bools:
        """Which (m,) are of areas that act on means of elements, and at points on their outline."""
        return self.shared[:, 0] >= 0


def partition(points: ContactPoints, tightened: Ints) -> tuple[Springs, ContactPoints]:
    """Split points into springs, with a straight law of compliance C > 0, and contact points, all others.

    Tightening moves the laws of the supports ``tightened`` (t,), by number. Their points stay contact points, except
    slopes.
    """
    linear = points.two_sided & ~points.equations & (points.slope | ~np.isin(points.support, tightened))
    of = points.pick(np.flatnonzero(linear))
    springs = Springs(of.rows, of.stiffness, of.distance, of.positions, of.weights, of.support, of.numbers, of.slope)
    return springs, points.pick(~linear)


@dataclass(frozen=True, eq=False)
class Parts:
    """What is one support's, by number: nodes (h,) whose deflection it holds, and springs (s,).

    ``rows`` (ways, c) are its contact points that hold no slope; a point with travel both ways has two, the first
    pushing the plate up. ``order`` (h + s + c,) leads from nodes, springs and contact points, one behind the other, to
    the order of the input.
    """

    nodes: Ints
    springs: Ints
    rows: Ints
    order: Ints


def parts_of(count: int, held: Held, springs: Springs, points: ContactPoints) -> tuple[Parts, ...]:
    """Part what acts among so many supports."""
    columns = zip(
        _grouped(held.holders[:, 1], count),
        _grouped(np.where(springs.slope, count, springs.support), count),
        _grouped(np.where(points.slope, count, points.support), count),
        strict=True,
    )
    result = []
    for holding, own, mine in columns:
        up = points.direction[mine] > 0
        both = up.any() and not up.all()
        rows = np.stack([mine[up], mine[~up]]) if both else mine.reshape(1, -1)
        given = np.concatenate([held.numbers[holding], springs.numbers[own], points.numbers[rows[0]]])
        result.append(Parts(held.holders[holding, 0], own, rows, np.argsort(given, kind="stable")))
    return tuple(result)


def _grouped(owner: Ints, count: int) -> list[Ints]:
    """Numbers of the entries of each of so many owners, in order; of any others none."""
    order = np.argsort(owner, kind="stable")
    return np.split(order, np.searchsorted(owner[order], np.arange(1, count + 1)))[:count]
