"""Quadrature over regions, curves and edges of a mesh, whether or not the mesh follows them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from signorini._core import serendipity
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import CORNERS, determinants
from signorini.quadrature.arcs import arcs_of
from signorini.quadrature.cutcells import cut
from signorini.quadrature.rules import gauss, lobatto
from signorini.regions import Curve, Polyline, Region, Ring

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]

_ON_PLATE = 1e-9
_KINK = 0.1
"""Angle from which a line has a corner."""


@dataclass(frozen=True, eq=False)
class Quadrature:
    """Points and weights of an integral over the plate or part of it.

    Parameters
    ----------
    elements : (q,) int array
        Element of each point.
    xi : (q, 2) float array
        Reference point in the element.
    weights : (q,) float array
        Positive; they sum to the area or length, the Jacobian included.
    positions : (q, 2) float array
        Positions in the plane.
    """

    elements: Ints
    xi: Floats
    weights: Floats
    positions: Floats

    @property
    def total(self) -> float:
        """Area or length that was found on the plate."""
        return float(self.weights.sum())


@dataclass(frozen=True, eq=False)
class LineQuadrature(Quadrature):
    """Quadrature along lines, with the unit tangent (q, 2) at each point."""

    tangents: Floats

    @property
    def normals(self) -> Floats:
        """Unit normals (q, 2) to the right of the tangents: outward where the plate is on the left."""
        return np.column_stack([self.tangents[:, 1], -self.tangents[:, 0]])


def area_quadrature(
    mesh: Mesh, region: Region | None = None, order: int = 3, to_outline: Bools | None = None
) -> Quadrature:
    """Quadrature over the part of a region that is on the plate.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    region : Rectangle, Circle, Polygon or None
        None: the whole plate.
    order : int
        Gauss points in each direction of a whole element. Elements that the outline cuts get more, see
        `signorini.quadrature.cutcells`.
    to_outline : (ne,) bool array, optional
        Where these elements have sides on the outline, Lobatto's rule with a point more, as exact, across those sides,
        so that points are on them; so in all that the outline cuts, if any element is marked.

    Returns
    -------
    Quadrature
        By element. Area and first moments of the region on the plate are exact to about 1e-12.

    Examples
    --------
    >>> from signorini.mesh.meshers import rectangle
    >>> from signorini.regions import Circle
    >>> mesh = rectangle((0.0, 0.0), (4.0, 4.0), (3, 3))
    >>> over = area_quadrature(mesh, Circle((2.1, 1.9), 1.0))
    >>> print(f"{over.total:.12f}")
    3.141592653590
    """
    marked = np.zeros(len(mesh.elements), np.bool_) if to_outline is None else to_outline
    if region is None:
        return _by_element(_whole(mesh, np.arange(len(mesh.elements)), order, mesh.on_boundary & marked[:, None]))
    found = cut(mesh, region, order, lobatto if marked.any() else gauss)
    xi = mesh.invert(found.elements, found.positions)
    covered = np.union1d(found.whole, found.elements)
    times = np.bincount(mesh.elements[covered, 4:].ravel(), minlength=mesh.node_count)
    outer = (times[mesh.elements[found.whole, 4:]] == 1) & marked[found.whole, None]
    whole = _whole(mesh, found.whole, order, outer)
    return _by_element([*whole, Quadrature(found.elements, xi, found.weights, found.positions)])


def _by_element(parts: list[Quadrature]) -> Quadrature:
    filled = [part for part in parts if len(part.elements)] or parts[:1]
    if len(filled) == 1:
        return filled[0]
    order = np.argsort(np.concatenate([part.elements for part in filled]), kind="stable")
    names = ("elements", "xi", "weights", "positions")
    return Quadrature(*(np.concatenate([getattr(part, name) for part in filled])[order] for name in names))


def _whole(mesh: Mesh, elements: Ints, order: int, outer: Bools) -> list[Quadrature]:
    """Whole elements (k,), by Lobatto's rule across sides (k, 4) on the outline, else by Gauss's."""
    across = np.column_stack([outer[:, 1] | outer[:, 3], outer[:, 0] | outer[:, 2]])
    rules = (gauss(order), lobatto(order))
    parts = []
    for x, y in ((0, 0), (0, 1), (1, 0), (1, 1)):
        some = elements[(across == (x, y)).all(axis=1)]
        station = np.stack(np.meshgrid(rules[x][0], rules[y][0], indexing="ij"), axis=-1).reshape(-1, 2)
        nodes = mesh.nodes[some]
        weights = determinants(nodes, station) * np.outer(rules[x][1], rules[y][1]).ravel()
        positions = (serendipity(station)[0] @ nodes).reshape(-1, 2)
        xi = np.tile(station, (len(some), 1))
        parts.append(Quadrature(np.repeat(some, len(station)), xi, weights.ravel(), positions))
    return parts


def curve_quadrature(mesh: Mesh, curve: Curve, order: int = 3, at_ends: int = 0) -> LineQuadrature:
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

    Returns
    -------
    LineQuadrature
        In order along the curve. The weights sum to the length on the plate.

    Examples
    --------
    >>> from signorini.mesh.meshers import rectangle
    >>> from signorini.regions import Polyline
    >>> mesh = rectangle((0.0, 0.0), (4.0, 4.0), (3, 3))
    >>> along = curve_quadrature(mesh, Polyline(((0.5, 1.0), (3.5, 5.0))))
    >>> print(f"{along.total:.12f}")
    3.750000000000
    """
    parts = []
    for arc in arcs_of(curve):
        breaks = arc.breaks(mesh.points[mesh.unique_sides])
        inside = mesh.locate(arc.at(0.5 * (breaks[1:] + breaks[:-1]))[0]).elements
        at_end = np.zeros(len(inside), np.bool_)
        at_end[[0, -1]] = at_ends > 0 and not isinstance(curve, Ring)
        s, weights, piece = _stations(breaks[:-1], breaks[1:], at_end, gauss(order), lobatto(max(at_ends - 1, 1)))
        on = inside[piece] >= 0
        points, tangents = arc.at(s[on])
        elements = inside[piece[on]]
        parts.append((elements, mesh.invert(elements, points), weights[on], points, tangents))
    return LineQuadrature(*(np.concatenate(items) for items in zip(*parts, strict=True)))


def edge_quadrature(mesh: Mesh, triples: Ints, order: int = 3, to_ends: bool = False) -> LineQuadrature:
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
    count = len(triples)
    at_end = _at_ends(mesh, triples) if to_ends else np.zeros(count, np.bool_)
    t, weights, side = _stations(np.full(count, -1.0), np.ones(count), at_end, gauss(order), lobatto(order))
    a, b = CORNERS[sides], CORNERS[(sides + 1) % 4]
    begin, end = np.where(forward[:, None], a, b)[side], np.where(forward[:, None], b, a)[side]
    elements = elements[side]
    xi = 0.5 * (begin + end) + 0.5 * t[:, None] * (end - begin)
    tangents = np.einsum("qda,qa->qd", mesh.jacobian(elements, xi), 0.5 * (end - begin))
    speed = np.hypot(*tangents.T)
    return LineQuadrature(elements, xi, weights * speed, mesh.map(elements, xi), tangents / speed[:, None])


def _at_ends(mesh: Mesh, triples: Ints) -> Bools:
    """Which sides (k,) end where no other goes on in nearly their direction."""
    a, m, b = (mesh.points[triples[:, i]] for i in range(3))
    leaving = np.concatenate([4 * m - 3 * a - b, 4 * m - a - 3 * b])
    leaving /= np.hypot(*leaving.T)[:, None]
    node = np.concatenate([triples[:, 0], triples[:, 2]])
    # Unit vectors of two sides that are one line cancel.
    total = np.column_stack([np.bincount(node, part) for part in leaving.T])
    return np.asarray((np.hypot(*total.T)[node] > _KINK).reshape(2, -1).any(axis=0))


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


def off_plate(mesh: Mesh, where: Region | Curve, quadrature: Quadrature) -> float:
    """Measure how much of a region's area or a curve's length is off the plate.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    where : region or curve
        The whole of it.
    quadrature : Quadrature
        What `area_quadrature` or `curve_quadrature` found of it.

    Returns
    -------
    float
        Zero where only rounding is missing, or of a region what lies between the plate's round outline and the
        parabolas that the elements have for it.

    Examples
    --------
    >>> from signorini.mesh.meshers import rectangle
    >>> from signorini.regions import Rectangle
    >>> mesh, patch = rectangle((0.0, 0.0), (4.0, 2.0), (3, 3)), Rectangle(3.0, 1.0, 5.0, 2.0)
    >>> round(off_plate(mesh, patch, area_quadrature(mesh, patch)), 12)
    1.0
    """
    if isinstance(where, Ring | Polyline):
        measure, slack = where.length, 0.0
    else:
        measure, slack = where.area, mesh.round_outline_area
    missing = measure - quadrature.total
    return missing if missing > _ON_PLATE * measure + slack else 0.0
