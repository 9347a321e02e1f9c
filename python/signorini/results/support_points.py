"""Points of each support (held nodes, springs, contact points), and the closed part of a line."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import csr_array

from signorini.base.on_demand import kept
from signorini.contact.selection import Answer
from signorini.discretise import Discretisation
from signorini.discretise.places import STRIP
from signorini.discretise.rows import Bools, Floats, Ints, Pieces


@dataclass(frozen=True, eq=False)
class SupportPoints:
    """Points (p,) of one support.

    If an area acts on mean deflections of elements, each point stands for an element and has all forces in it.
    """

    nodes: Ints
    """Nodes (h,) at which the support holds the deflection. Held nodes and springs are "fixed" points, always closed.
    """
    springs: Ints  # (s,): numbers of the support's springs
    # (h,): the support's share of the reaction at each held node, 1/j if j supports hold the node
    share: Floats
    rows: Ints
    """Numbers (r, c) of the c contact points, including repeated points; r = 2 if each has a row up and a row down."""
    direction: Floats  # (r, c): +1 if a row pushes the plate up, −1 if a row holds the plate down
    order: Ints  # (h + s + c,): permutation of held nodes, springs and contact points to the order of the input
    positions: Floats  # (p, 2): positions of the points in the order of the input
    weights: Floats  # (p,): length or area that each point represents; 1 for supports at points
    elements: Ints  # (p,): element that contains each point; −1 for held nodes
    # (c', c): for an area that acts on element means, the share of each of its c' elements in the contact points
    shares: csr_array | None
    # (p, 2): numbers of each point's springs on θx and θy; empty without a rotational stiffness
    turning: Ints

    @staticmethod
    @kept
    def of(discretisation: Discretisation, index: int) -> SupportPoints:
        """Points of support number ``index`` of the model, computed once."""
        contacts, parts = discretisation.points, discretisation.parts[index]
        nodes, springs, rows = parts.nodes, parts.springs, parts.rows
        share = 1.0 / np.bincount(discretisation.held.nodes, minlength=discretisation.mesh.node_count)[nodes]
        # If all contact points belong to this support, a slice avoids a copy of the arrays.
        first = slice(None) if len(rows[0]) == len(contacts) else rows[0]
        elements, places, weight = contacts.rows.elements[first], contacts.positions[first], contacts.weights[first]
        shared, shares = contacts.shared[first], None
        if (shared >= 0).any():
            elements, shares = _shares(shared, weight)
            # The first contact point of an element holds its mean deflection; the element has this position.
            places = places[shares.indices[shares.indptr[:-1]]]
            weight = shares @ weight
        positions = np.concatenate(
            [discretisation.mesh.points[nodes], discretisation.springs.positions[springs], places]
        )
        weights = np.concatenate([np.ones(len(nodes)), discretisation.springs.weights[springs], weight])
        of_springs = discretisation.springs.rows.elements[springs]
        elements = np.concatenate([np.full(len(nodes), -1), of_springs, elements])
        order = parts.order if shares is None else np.arange(len(positions))
        direction, weights = contacts.direction[rows], weights[order]
        located = positions[order], weights, elements[order]
        of_slopes = np.flatnonzero(discretisation.springs.slope & (discretisation.springs.support == index))
        # The springs on θy are stored before those on θx; here their order is reversed.
        at_points = discretisation.model.support[index].place == "at"
        turning = of_slopes.reshape(2, -1)[::-1].T if at_points else np.zeros((0, 2), np.int64)
        return SupportPoints(nodes, springs, share, rows, direction, order, *located, shares, turning)

    @property
    def fixed(self) -> int:
        """Number of "fixed" points: held nodes and springs."""
        return len(self.nodes) + len(self.springs)

    def forces(self, fixed: Floats, reaction: Floats) -> Floats:
        """Upward force (..., p) of every point of the support.

        ``fixed`` (..., h + s) are the forces of held nodes and springs, ``reaction`` (..., m + r) those of all contact
        points and repeated points.
        """
        acting = (self.direction * reaction[..., self.rows]).sum(axis=-2)
        fixed = fixed * np.concatenate([self.share, np.ones(len(self.springs))])
        if self.shares is not None:
            leading = acting.shape[:-1]
            together = acting.reshape(math.prod(leading), acting.shape[-1])
            acting = (self.shares @ together.T).T.reshape(*leading, self.shares.shape[0])
        return np.asarray(np.concatenate([fixed, acting], axis=-1)[..., self.order])

    def preloads(self, discretisation: Discretisation) -> Floats:
        """Upward force (p,) of every point when all bolts are tightened, before other loads act."""
        return self.forces(np.zeros(self.fixed), discretisation.points.preload)

    def tightened_to(self, discretisation: Discretisation) -> Floats:
        """Upward force (p,) to which every point was last tightened; 0 at points that were not tightened."""
        return self.forces(np.zeros(self.fixed), discretisation.points.tightened_to)

    def moments(self, pull: Floats) -> Floats:
        """Couples (..., p, 2) on θx and θy that points exert on the plate, from forces (..., s) of all springs."""
        return np.asarray(-pull[..., self.turning])

    def centres(self, discretisation: Discretisation, reaction: Floats) -> Floats:
        """Position (p, 2) of every point's force, given contact forces (m,): in an element the centroid of forces."""
        if self.shares is None:
            return self.positions
        pushing = np.abs(reaction[self.rows]).sum(axis=0)
        force = self.shares @ pushing
        moment = self.shares @ (pushing[:, None] * discretisation.points.positions[self.rows[0]])
        own = self.positions[np.argsort(self.order)][self.fixed :]
        acting = np.where(force[:, None] > 0, moment / np.where(force > 0, force, 1.0)[:, None], own)
        inward = own - acting
        way = np.hypot(*inward.T)[:, None]
        acting += inward * np.minimum(1.0, _INWARD * discretisation.mesh.size / np.where(way > 0, way, 1.0))
        return np.asarray(np.concatenate([self.positions[np.argsort(self.order)][: self.fixed], acting])[self.order])

    def gaps(self, gap: Floats) -> Floats:
        """Remaining free travel (..., p) of the support's points, given the gaps (..., m) of contact points."""
        gap = _with(np.maximum(gap, 0.0), self.rows, 0.0)
        travel = gap[..., self.rows].min(axis=-2)
        if self.shares is not None:
            travel = np.minimum.reduceat(travel[..., self.shares.indices], self.shares.indptr[:-1], axis=-1)
        closed = np.zeros((*travel.shape[:-1], self.fixed))
        return np.asarray(np.concatenate([closed, travel], axis=-1)[..., self.order])

    def rest(self, discretisation: Discretisation) -> Floats:
        """Free travel (p,) of every point at w = 0; infinite if the support has a gap there.

        Without a gap the travel is the settlement of the support away from the plate. If a point has more free travel
        than this in a solution, the plate has lifted off it.
        """
        contacts = discretisation.contacts
        apart = contacts.distance > contacts.settlement
        return self.gaps(np.where(apart, np.inf, contacts.settlement))

    def closed(self, closed: Bools) -> Bools:
        """Mask (..., p) of the support's closed points, given the mask (..., m) of all closed contact points."""
        closed = _with(closed, self.rows, True)
        touching = np.asarray(closed[..., self.rows].any(axis=-2))
        if self.shares is not None:
            touching = np.logical_or.reduceat(touching[..., self.shares.indices], self.shares.indptr[:-1], axis=-1)
        always = np.ones((*touching.shape[:-1], self.fixed), np.bool_)
        return np.asarray(np.concatenate([always, touching], axis=-1)[..., self.order])

    def pieces(self, discretisation: Discretisation, pieces: Pieces) -> Ints:
        """Piece (p,) of its law on which each of the support's points is, given the pieces (m,) of all contact points.

        If a support has travel in both directions, the pieces are numbered in the order of downward travel.
        """
        contacts, own = discretisation.points, _with(pieces, self.rows, 0)[self.rows].astype(np.int64)
        if len(own) == 2:
            last = np.array([len(law.slopes) - 1 for law in contacts.laws])[contacts.law[self.rows[1]]]
            own = own[:1] + last - own[1:]
        return np.concatenate([np.zeros(self.fixed, np.int64), own[0]])[self.order]

    def yielded(self, discretisation: Discretisation, reaction: Floats) -> Bools:
        """Mask (p,) of the points whose reaction reaches its limit, given the reactions (m + r,) of all points.

        Forces are compared with limits. The pieces of `ContactPoints.yield_on` cannot be used, since repeated points
        have a share of the force, but no piece.
        """
        least, most = discretisation.points.limits
        at_end = ((least < 0.0) & (reaction <= least * _ALL)) | (reaction >= most * _ALL)
        which = np.asarray(at_end[self.rows].any(axis=0))
        if self.shares is not None:
            which = np.logical_or.reduceat(which[self.shares.indices], self.shares.indptr[:-1])
        return np.concatenate([np.zeros(self.fixed, np.bool_), which])[self.order]


def _with(values: Floats | Bools | Pieces, rows: Ints, repeated: float) -> Any:
    """Extend values (..., m) of contact points by the value ``repeated`` for each repeated point in ``rows``."""
    more = max(0, int(rows.max(initial=-1)) + 1 - values.shape[-1])
    behind = np.full((*values.shape[:-1], more), repeated, values.dtype)
    return np.concatenate([values, behind], axis=-1) if more else values


def _shares(shared: Ints, weights: Floats) -> tuple[Ints, csr_array]:
    """Elements (e,) of an area, and the shares (e, c) of elements in contact points that up to four elements share.

    ``shared`` (c, 4) are the elements of each point.

    Shares are proportional to area, so that a point on the outline causes the same pressure in a small part of an
    element as in the adjacent element.
    """
    point, place = np.nonzero(shared >= 0)
    elements, element = np.unique(shared[point, place], return_inverse=True)
    several = np.bincount(element, minlength=len(elements)) - 1
    # An element's first point has the element's area, less a part `STRIP` for each other point of the element.
    mean = np.full(len(elements), len(shared))
    np.minimum.at(mean, element, point)
    area = weights[mean] / (1.0 - STRIP * several)
    share = area[element] / np.bincount(point, area[element], len(shared))[point]
    order = np.lexsort((point, element))
    start = np.searchsorted(element[order], np.arange(len(elements) + 1))
    return elements, csr_array((share[order], point[order], start), shape=(len(elements), len(shared)))


_ALL = 1.0 - 1e-9
"""Smallest ratio of a force to its limit with which the force counts as at the limit, to allow for rounding."""
_INWARD = 3e-10
"""Distance by which an element's point is moved inward, relative to the plate's size. At the element's corner the
point would belong to several elements.
"""


@dataclass(frozen=True)
class Scales:
    """Reference force and length, which divide forces and gaps so that closed and open points are comparable."""

    force: float
    length: float

    @classmethod
    def of(cls, answer: Answer) -> Scales:
        """Reference values of an answer: its largest reaction, and its largest gap or deflection."""
        force = float(np.abs(answer.shared).max(initial=0.0))
        length = max(float(np.abs(one).max(initial=0.0)) for one in (answer.gap, answer.hi[::3]))
        return cls(force or 1.0, length or 1.0)


def closed_part(discretisation: Discretisation, points: SupportPoints, answer: Answer) -> float:
    """Closed part of a line, 0 to 1, by length: the root of the margin by parts of the line (`margin_by_part`)."""
    own = closed_by_point(discretisation, points, answer, Scales.of(answer))
    parts, values = margin_by_part(own, points.weights)
    if values[0] < 0 or values[-1] >= 0:
        return float(values[0] >= 0)
    last = int(np.flatnonzero(values >= 0)[-1])
    share = values[last] / (values[last] - values[last + 1])
    return float(parts[last] + share * (parts[last + 1] - parts[last]))


def closed_by_point(discretisation: Discretisation, points: SupportPoints, answer: Answer, scales: Scales) -> Floats:
    """Scaled margin (p,) of each point, ≥ 0 if closed: compression if elastic, reaction if rigid; −gap if open."""
    contacts = discretisation.contacts
    soft = contacts.compliance > 0
    pressing = np.where(soft, contacts.compliance * answer.reaction / scales.length, answer.reaction / scales.force)
    rows = np.where(answer.closed, np.maximum(pressing, 0.0), np.minimum(-answer.gap / scales.length, -1e-300))
    rows = np.where(contacts.two_sided, 1.0, rows)
    rows = np.append(rows, np.ones(max(0, int(points.rows.max(initial=-1)) + 1 - len(rows))))
    own = rows[points.rows].max(axis=0, initial=-np.inf)
    if points.shares is not None:
        own = np.maximum.reduceat(own[points.shares.indices], points.shares.indptr[:-1])
    return np.asarray(np.concatenate([np.ones(points.fixed), own])[points.order])


def margin_by_part(own: Floats, weights: Floats) -> tuple[Floats, Floats]:
    """Sort the margins (p,) of points in falling order; return parts (p + 1,) of the weight, and the margin at each.

    Between two points the margin is the mean of theirs. So the order of points with equal margins changes no value.
    """
    order = np.argsort(-own, kind="stable")
    values, reached = own[order], np.cumsum(weights[order])
    between = 0.5 * (values[1:] + values[:-1])
    return np.append(0.0, reached / reached[-1]), np.concatenate([values[:1], between, values[-1:]])
