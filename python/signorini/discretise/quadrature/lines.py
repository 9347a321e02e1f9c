"""Quadrature along curves and along sides of elements."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np

from signorini.discretise.quadrature.crossings import quadratics, touched, with_circles, with_segments
from signorini.discretise.quadrature.rules import GAUSS, LineQuadrature, gauss, lobatto
from signorini.discretise.quadrature.stepped import INSIDE, Levels
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import side_boxes
from signorini.mesh.sides import at_ends
from signorini.shapes import Curve, Ring
from signorini.shapes.outlines import Outline, Side, arc_through

_SAME = 1e-13
"""Relative rounding errors of coordinates, and of the angles of thirds of a circle."""
_TOUCHED = 1e-6
"""Least length of a piece of an arc, relative to the arc: points of tangency are accurate to half of the digits."""
_STRAIGHT = 1e-9
"""Largest distance of a side from the line on which it lies, relative to the length of the side."""
_NONE = np.zeros((0, 2))
"""Array of positions without entries."""
_INSIDE = 1e-6
"""Distance from the ends of an interval within which a jump counts as at the end, relative to its length."""
_SEEN = 17
"""Number of points at which a level is sampled in an interval; two changes of sign between neighbours are missed."""
_BISECTIONS = 50
"""Number of bisections with which a jump is located in an interval, to rounding."""


@dataclass(frozen=True, eq=False)
class Segment:
    """A straight piece of a curve between two points (2,)."""

    begin: Floats
    end: Floats

    @property
    def length(self) -> float:
        """Length of the segment."""
        return float(np.hypot(*(self.end - self.begin)))

    def at(self, s: Floats) -> tuple[Floats, Floats]:
        """Positions (q, 2) and unit tangents (q, 2) at arc lengths s (q,)."""
        along = (self.end - self.begin) / self.length
        return self.begin + s[:, None] * along, np.tile(along, (len(s), 1))

    def crossings(self, sides: Floats) -> Floats:
        """Arc lengths (r,) at which sides (k, 3, 2) meet the segment, in any order; values may occur twice."""
        segment = np.stack([self.begin, self.end])[None]
        near, _, _, _ = touched(side_boxes(sides), Outline(segments=segment), _margin(sides))
        sides = sides[near]
        # If a side lies on the line, their crossing is undefined, and the ends of the side are taken.
        along = self._holds(sides)
        _, points = with_segments(quadratics(sides[~along]), np.repeat(segment, int((~along).sum()), axis=0))
        return self.nearest(np.concatenate([points, sides[along][:, [0, 2]].reshape(-1, 2)]))

    def _holds(self, sides: Floats) -> Bools:
        """Mask of sides (k, 3, 2) that lie on the line through the segment's ends."""
        x, y = (self.end - self.begin) / self.length
        off = np.abs((sides - self.begin) @ np.array([-y, x])).max(axis=1, initial=0.0)
        return np.asarray(off <= _STRAIGHT * np.hypot(*(sides[:, 2] - sides[:, 0]).T) + _margin(sides))

    def nearest(self, points: Floats) -> Floats:
        """Arc lengths (q,) of the points nearest to ``points`` (q, 2) on the infinite line."""
        return np.asarray((points - self.begin) @ (self.end - self.begin) / self.length)


@dataclass(frozen=True, eq=False)
class PartOfCircle:
    """Arc of a circle from the angle ``start`` through ``sweep``, in radians, counter-clockwise if positive."""

    center: Floats
    radius: float
    start: float
    sweep: float

    @property
    def length(self) -> float:
        """Length of the arc."""
        return self.radius * abs(self.sweep)

    def at(self, s: Floats) -> tuple[Floats, Floats]:
        """Positions (q, 2) and unit tangents (q, 2) at arc lengths s (q,)."""
        sign = np.copysign(1.0, self.sweep)
        angle = self.start + sign * s / self.radius
        outward = np.column_stack([np.cos(angle), np.sin(angle)])
        return self.center + self.radius * outward, sign * np.column_stack([-outward[:, 1], outward[:, 0]])

    def crossings(self, sides: Floats) -> Floats:
        """Arc lengths (r,) at which sides (k, 3, 2) meet the full circle, in any order; values may occur twice."""
        circle = np.array([[*self.center, self.radius]])
        _, _, near, _ = touched(side_boxes(sides), Outline(circles=circle), _margin(sides))
        _, points = with_circles(quadratics(sides[near]), np.repeat(circle, len(near), axis=0))
        return self.nearest(points)

    def nearest(self, points: Floats) -> Floats:
        """Arc lengths (q,) of the points nearest to ``points`` (q, 2) on the full circle, perhaps beyond the arc."""
        angle = np.arctan2(points[:, 1] - self.center[1], points[:, 0] - self.center[0])
        # Angles are taken within half a turn of the arc's middle.
        turned = np.copysign(1.0, self.sweep) * (angle - self.start) - 0.5 * abs(self.sweep) + np.pi
        return np.asarray((np.mod(turned, 2.0 * np.pi) - np.pi + 0.5 * abs(self.sweep)) * self.radius)

    @property
    def closed(self) -> bool:
        """Whether the arc is a full circle."""
        return abs(self.sweep) == 2.0 * np.pi


Arc: TypeAlias = Segment | PartOfCircle
"""A smooth piece of a curve, parametrised by arc length."""


def breaks(arc: Arc, sides: Floats, beside: Floats = _NONE) -> Floats:
    """Increasing arc lengths at which an arc is divided: its ends, and its crossings with sides (k, 3, 2).

    The points of the arc nearest to ``beside`` (q, 2) are included. A full circle begins and ends at its first
    division.
    """
    s, least = np.sort(np.concatenate([arc.crossings(sides), arc.nearest(beside)])), _TOUCHED * arc.length
    if isinstance(arc, PartOfCircle) and arc.closed:
        s = s[np.append(True, np.diff(s) > least)[: len(s)]]
        if len(s) > 1 and s[0] + arc.length - s[-1] <= least:
            s = s[:-1]
        return np.append(s, s[0] + arc.length) if len(s) else np.array([0.0, arc.length])
    s = np.concatenate([[0.0], s[(s > least) & (s < arc.length - least)], [arc.length]])
    return np.asarray(s[np.append(np.diff(s) > least, True)])


def _in_thirds(arc: Arc, breaks: Floats) -> Floats:
    """Divide pieces into parts of at most a third of a circle: on three thirds, Gauss points prefer no direction."""
    if isinstance(arc, Segment):
        return breaks
    turns = 3.0 * np.diff(breaks) / (2.0 * np.pi * arc.radius)
    parts = np.maximum(np.ceil(turns - _SAME), 1.0).astype(np.int64)
    ends = zip(breaks[:-1], breaks[1:], parts, strict=True)
    return np.append(np.concatenate([np.linspace(a, b, n, endpoint=False) for a, b, n in ends]), breaks[-1])


def arcs_of(outline: Outline) -> list[Arc]:
    """Smooth pieces of an outline: segments, then arcs, then circles.

    Circles run counter-clockwise from their rightmost points.
    """
    segments: list[Arc] = [Segment(a, b) for a, b in outline.segments]
    arcs = [arc_of((tuple(a), tuple(m), tuple(b))) for a, m, b in outline.arcs.tolist()]
    circles = [PartOfCircle(np.array([x, y]), r, 0.0, 2.0 * np.pi) for x, y, r in outline.circles.tolist()]
    return [*segments, *arcs, *circles]


def arc_of(side: Side) -> Arc:
    """Convert a straight or circular side of an outline to a piece parametrised by arc length."""
    begin, through, end = side
    result = None if through is None else arc_through(begin, through, end)
    return Segment(np.array(begin), np.array(end)) if result is None else PartOfCircle(*result)


def _margin(sides: Floats) -> float:
    return _SAME * float(np.abs(sides).max(initial=0.0))


def divided(
    begin: Floats, end: Floats, positions: Callable[[Ints, Floats], Floats], levels: Levels
) -> tuple[Ints, Floats, Floats]:
    """Divide intervals (k,) of a parameter where one of the level functions ``levels`` changes sign.

    ``positions`` maps intervals (q,) and parameters (q,) to positions (q, 2). Return interval, begin and end of each
    part (m,), in order.
    """
    if not (len(begin) and len(levels)):
        return np.arange(len(begin)), begin, end
    stations = np.linspace(_INSIDE, 1.0 - _INSIDE, _SEEN)
    samples = begin[:, None] + (end - begin)[:, None] * stations
    interval = np.repeat(np.arange(len(begin)), _SEEN)
    owners, breaks = [np.arange(len(begin))], [begin]
    for level in levels:
        above = (level(positions(interval, samples.ravel())) > 0.0).reshape(samples.shape)
        which, gap = np.nonzero(above[:, 1:] != above[:, :-1])
        low, high, first = samples[which, gap], samples[which, gap + 1], above[which, gap]
        for _ in range(_BISECTIONS if len(which) else 0):
            middle = 0.5 * (low + high)
            same = (level(positions(which, middle)) > 0.0) == first
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        owners.append(which)
        breaks.append(0.5 * (low + high))
    owner, s = np.concatenate(owners), np.concatenate(breaks)
    order = np.lexsort((s, owner))
    owner, s = owner[order], s[order]
    keep = np.append(True, (np.diff(owner) > 0) | (np.diff(s) > _INSIDE * (end - begin)[owner[1:]]))
    owner, s = owner[keep], s[keep]
    last = np.append(np.diff(owner) > 0, True)
    return owner, s, np.where(last, end[owner], np.append(s[1:], 0.0))


def curve_pieces(mesh: Mesh, curve: Curve) -> Iterator[tuple[Arc, Floats, Ints]]:
    """Divide a curve into pieces within one element.

    Yield each arc of the curve with the arc lengths (k + 1,) of the ends of its pieces, and the element (k,) of each
    piece, −1 off the plate.
    """
    sides, beside = mesh.unique_sides, np.zeros((0, 3), np.int64)
    if isinstance(curve, Ring):
        # Sides along the circle do not divide it: pieces between their nodes would outnumber the free deflections.
        along = mesh.sides_on(curve)
        beside = mesh.boundary_beside(curve)
        beside = beside[~np.isin(beside[:, 1], along[:, 1])]
        sides = sides[~np.isin(sides[:, 1], np.concatenate([along, beside])[:, 1])]
    for arc in arcs_of(curve.outline):
        stops = _in_thirds(arc, breaks(arc, mesh.points[sides], mesh.points[beside[:, [0, 2]].ravel()]))
        yield arc, stops, mesh.locate(arc.at(0.5 * (stops[1:] + stops[:-1]))[0]).elements


def curve_quadrature(
    mesh: Mesh, curve: Curve, order: int = GAUSS, at_ends: int = 0, levels: Levels = ()
) -> LineQuadrature:
    """Quadrature along the part of a curve that is on the plate, in order; pieces end where ``levels`` change sign.

    Tangents point along the curve, counter-clockwise on a ring. Pieces within one element have ``order`` Gauss points.
    Pieces at ends and corners of a polyline have ``at_ends`` points of Lobatto's rule, unless it is 0.
    """
    parts = []
    for arc, stops, elements in curve_pieces(mesh, curve):
        on_plate = elements >= 0
        piece, begin, end = divided(stops[:-1][on_plate], stops[1:][on_plate], partial(_along, arc), levels)
        at_end = ((begin == stops[0]) | (end == stops[-1])) & (at_ends > 0 and not isinstance(curve, Ring))
        s, weights, part = _stations(begin, end, at_end, gauss(order), lobatto(max(at_ends - 1, 1)))
        points, tangents = arc.at(s)
        within, _ = arc.at(_inward(s, begin[part], end[part]))
        elements = elements[on_plate][piece][part]
        xi = mesh.invert(elements, points)
        parts.append((elements, xi, weights, points, tangents, within))
    return LineQuadrature(*(np.concatenate(items) for items in zip(*parts, strict=True)))


def _along(arc: Arc, _: Ints, s: Floats) -> Floats:
    return arc.at(s)[0]


def edge_quadrature(
    mesh: Mesh, triples: Ints, order: int = GAUSS, to_ends: bool = False, levels: Levels = ()
) -> LineQuadrature:
    """Quadrature along curved element sides (k, 3), divided where ``levels`` change sign.

    Tangents point from the first node to the last; points belong to the element on the left if there is one. Sides have
    ``order`` Gauss points; with ``to_ends``, sides at ends and corners have Lobatto's rule of the same accuracy.
    """
    elements, sides, forward = mesh.find_sides(triples)
    a, b = mesh.corners_of_sides(elements, sides)
    begin, end = np.where(forward[:, None], a, b), np.where(forward[:, None], b, a)

    def reference(side: Ints, t: Floats) -> Floats:
        return np.asarray(0.5 * (begin + end)[side] + 0.5 * t[:, None] * (end - begin)[side])

    def positions(side: Ints, t: Floats) -> Floats:
        return mesh.map(elements[side], reference(side, t))

    ones = np.ones(len(triples))
    side, first, last = divided(-ones, ones, positions, levels)
    at_end = at_ends(mesh.points, triples)[side] & to_ends
    t, weights, part = _stations(first, last, at_end, gauss(order), lobatto(order))
    within = positions(side[part], _inward(t, first[part], last[part]))
    side = side[part]
    elements, xi = elements[side], reference(side, t)
    tangents = np.einsum("qda,qa->qd", mesh.jacobian(elements, xi), 0.5 * (end - begin)[side])
    speed = np.hypot(*tangents.T)
    return LineQuadrature(elements, xi, weights * speed, mesh.map(elements, xi), tangents / speed[:, None], within)


def _inward(t: Floats, begin: Floats, end: Floats) -> Floats:
    middle = 0.5 * (begin + end)
    return np.asarray(middle + INSIDE * (t - middle))


def _stations(
    begin: Floats, end: Floats, at_end: Bools, rule: tuple[Floats, Floats], last: tuple[Floats, Floats]
) -> tuple[Floats, Floats, Ints]:
    """Points, weights and interval (q,) of each point, of a rule on intervals (k,).

    Intervals marked in ``at_end`` have the rule ``last``.
    """
    pick, parts = np.arange(len(begin)), []
    for which, (node, weight) in ((~at_end, rule), (at_end, last)):
        half = 0.5 * (end - begin)[which, None]
        t = 0.5 * (begin + end)[which, None] + half * node
        parts.append((t.ravel(), (half * weight).ravel(), np.repeat(pick[which], len(node))))
    t, weights, interval = (np.concatenate(items) for items in zip(*parts, strict=True))
    order = np.argsort(interval, kind="stable")
    return t[order], weights[order], interval[order]
