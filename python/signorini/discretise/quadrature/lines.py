"""Quadrature along curves and along sides of elements."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt

from signorini.discretise.quadrature.arcs import Arc, arcs_of
from signorini.discretise.quadrature.areas import Quadrature
from signorini.discretise.quadrature.breaks import divided
from signorini.discretise.quadrature.rules import gauss, lobatto
from signorini.discretise.quadrature.stepped import INSIDE, Levels
from signorini.mesh import Mesh
from signorini.mesh.sides import at_ends
from signorini.shapes import Curve, Ring

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class LineQuadrature(Quadrature):
    """Quadrature along lines, with the unit tangent (q, 2) at each point.

    ``within`` (q, 2) is a place beside each point that is inside its piece, where a formula has the piece's own value
    even if the point is where it jumps.
    """

    tangents: Floats
    within: Floats

    @property
    def normals(self) -> Floats:
        """Unit normals (q, 2) to the right of the tangents: outward where the plate is on the left."""
        return np.column_stack([self.tangents[:, 1], -self.tangents[:, 0]])


def curve_quadrature(mesh: Mesh, curve: Curve, order: int = 3, at_ends: int = 0, levels: Levels = ()) -> LineQuadrature:
    """Quadrature along the part of a curve that is on the plate.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    curve : Polyline or Ring
        The curve; tangents point along it, of a ring counter-clockwise.
    order : int
        Gauss points on each piece within one element.
    at_ends : int
        If not 0, the number of Lobatto's points on the pieces at the ends and corners of a polyline.
    levels : sequence of functions
        Pieces end where one of them changes its sign, see `signorini.discretise.quadrature.stepped`.

    Returns
    -------
    LineQuadrature
        In order along the curve. The weights sum to the length on the plate.

    Examples
    --------
    >>> from signorini.mesh.meshers import rectangle
    >>> from signorini.shapes import Polyline
    >>> mesh = rectangle((0.0, 0.0), (4.0, 4.0), (3, 3))
    >>> along = curve_quadrature(mesh, Polyline(((0.5, 1.0), (3.5, 5.0))))
    >>> print(f"{along.total:.12f}")
    3.750000000000
    """
    sides, parts, beside = mesh.unique_sides, [], np.zeros((0, 3), np.int64)
    if isinstance(curve, Ring):
        # Parabolas along it cross it at midside nodes too, into more pieces than their deflection has dofs.
        along = mesh.sides_on(curve)
        beside = mesh.boundary_beside(curve)
        beside = beside[~np.isin(beside[:, 1], along[:, 1])]
        sides = sides[~np.isin(sides[:, 1], np.concatenate([along, beside])[:, 1])]
    for arc in arcs_of(curve):
        breaks = arc.pieces(arc.breaks(mesh.points[sides], mesh.points[beside[:, [0, 2]].ravel()]))
        inside = mesh.locate(arc.at(0.5 * (breaks[1:] + breaks[:-1]))[0]).elements
        on = inside >= 0
        piece, begin, end = divided(breaks[:-1][on], breaks[1:][on], partial(_along, arc), levels)
        at_end = ((begin == breaks[0]) | (end == breaks[-1])) & (at_ends > 0 and not isinstance(curve, Ring))
        s, weights, part = _stations(begin, end, at_end, gauss(order), lobatto(max(at_ends - 1, 1)))
        points, tangents = arc.at(s)
        within, _ = arc.at(_inward(s, begin[part], end[part]))
        elements = inside[on][piece][part]
        xi = mesh.invert(elements, points)
        parts.append((elements, xi, weights, points, tangents, within))
    return LineQuadrature(*(np.concatenate(items) for items in zip(*parts, strict=True)))


def _along(arc: Arc, _: Ints, s: Floats) -> Floats:
    return arc.at(s)[0]


def edge_quadrature(
    mesh: Mesh, triples: Ints, order: int = 3, to_ends: bool = False, levels: Levels = ()
) -> LineQuadrature:
    """Quadrature along sides of elements, as curved as they are.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    triples : (k, 3) int array
        Corner, midside, corner of each side, such as ``mesh.edges["left"]``; tangents point from the first to the last.
    order : int
        Gauss points on each side.
    to_ends : bool
        Sides at ends and corners of the line have Lobatto's rule with a point more, as exact.
    levels : sequence of functions
        Sides are divided where one of them changes its sign, see `signorini.discretise.quadrature.stepped`.

    Returns
    -------
    LineQuadrature
        In the order of the triples; points are in the element on the left where there is one.

    Raises
    ------
    InputError
        If a triple is not a side of an element.

    Examples
    --------
    >>> from signorini.mesh.meshers import rectangle
    >>> mesh = rectangle((0.0, 0.0), (4.0, 2.0), (3, 3))
    >>> left = edge_quadrature(mesh, mesh.edges["left"])
    >>> round(left.total, 12), left.normals[0].tolist()
    (2.0, [-1.0, -0.0])
    """
    elements, sides, forward = mesh.find_sides(triples)
    a, b = mesh.corners_of_sides(elements, sides)
    begin, end = np.where(forward[:, None], a, b), np.where(forward[:, None], b, a)

    def at(side: Ints, t: Floats) -> Floats:
        return np.asarray(0.5 * (begin + end)[side] + 0.5 * t[:, None] * (end - begin)[side])

    def positions(side: Ints, t: Floats) -> Floats:
        return mesh.map(elements[side], at(side, t))

    ones = np.ones(len(triples))
    side, first, last = divided(-ones, ones, positions, levels)
    at_end = at_ends(mesh.points, triples)[side] & to_ends
    t, weights, part = _stations(first, last, at_end, gauss(order), lobatto(order))
    within = positions(side[part], _inward(t, first[part], last[part]))
    side = side[part]
    elements, xi = elements[side], at(side, t)
    tangents = np.einsum("qda,qa->qd", mesh.jacobian(elements, xi), 0.5 * (end - begin)[side])
    speed = np.hypot(*tangents.T)
    return LineQuadrature(elements, xi, weights * speed, mesh.map(elements, xi), tangents / speed[:, None], within)


def _inward(t: Floats, begin: Floats, end: Floats) -> Floats:
    middle = 0.5 * (begin + end)
    return np.asarray(middle + INSIDE * (t - middle))


def _stations(
    begin: Floats, end: Floats, at_end: Bools, rule: tuple[Floats, Floats], last: tuple[Floats, Floats]
) -> tuple[Floats, Floats, Ints]:
    """Points and weights (q,) of intervals (k,), and their intervals; those at ends by a rule of their own."""
    pick, parts = np.arange(len(begin)), []
    for which, (node, weight) in ((~at_end, rule), (at_end, last)):
        half = 0.5 * (end - begin)[which, None]
        t = 0.5 * (begin + end)[which, None] + half * node
        parts.append((t.ravel(), (half * weight).ravel(), np.repeat(pick[which], len(node))))
    t, weights, interval = (np.concatenate(items) for items in zip(*parts, strict=True))
    order = np.argsort(interval, kind="stable")
    return t[order], weights[order], interval[order]
