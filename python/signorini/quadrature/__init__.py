"""Quadrature over regions, curves and edges of a mesh, whether or not the mesh follows them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
import numpy.typing as npt

from signorini._core import serendipity
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import CORNERS, determinants
from signorini.quadrature.arcs import Arc, arcs_of
from signorini.quadrature.breaks import divided
from signorini.quadrature.cutcells import cut
from signorini.quadrature.stepped import OFF, Levels, crossed, cut_by, sides_of
from signorini.regions import Curve, Polyline, Region, Ring

Floats = npt.NDArray[np.float64]
Bools = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]

_ON_PLATE = 1e-9


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
    mesh: Mesh, region: Region | None = None, order: int = 3, levels: Levels = (), off: float = OFF
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
    levels : sequence of functions
        What is to be integrated jumps where one of them changes its sign; see `signorini.quadrature.stepped`.
    off : float
        How far a cut may lie from a curved jump, over the side of the element.

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
    smooth = _area_quadrature(mesh, region, order)
    elements = np.unique(smooth.elements)
    across = crossed(mesh, elements, levels)
    if not across.any():
        return smooth
    elements, levels = elements[across.any(axis=0)], _those(across, levels)
    if region is not None:
        outline = sides_of(region)
        levels += _those(crossed(mesh, elements, outline), outline)
    found = cut_by(mesh, elements, levels, order, off)
    inside = np.ones(len(found.weights), dtype=bool) if region is None else region.contains(found.positions)
    # On curved outlines the cuts are not exact; the area of the part on the region is known.
    count = len(mesh.elements)
    area = np.bincount(smooth.elements, smooth.weights, count)
    cut_area = np.bincount(found.elements[inside], found.weights[inside], count)
    done = np.isin(np.arange(count), elements) & (cut_area > 0.0)
    keep, inside = ~done[smooth.elements], inside & done[found.elements]
    elements = np.concatenate([smooth.elements[keep], found.elements[inside]])
    by_element = np.argsort(elements, kind="stable")
    weights = found.weights * (area / np.where(done, cut_area, 1.0))[found.elements]
    return Quadrature(
        elements[by_element],
        np.vstack([smooth.xi[keep], found.xi[inside]])[by_element],
        np.concatenate([smooth.weights[keep], weights[inside]])[by_element],
        np.vstack([smooth.positions[keep], found.positions[inside]])[by_element],
    )


def _those(across: Bools, levels: Levels) -> list[Callable[[Floats], Floats]]:
    """Levels that cross any element."""
    return [level for level, by_element in zip(levels, across, strict=True) if by_element.any()]


def _area_quadrature(mesh: Mesh, region: Region | None, order: int) -> Quadrature:
    if region is None:
        return _whole(mesh, np.arange(len(mesh.elements)), order)
    parts = cut(mesh, region, order)
    whole = _whole(mesh, parts.whole, order)
    elements = np.concatenate([whole.elements, parts.elements])
    by_element = np.argsort(elements, kind="stable")
    return Quadrature(
        elements[by_element],
        np.vstack([whole.xi, mesh.invert(parts.elements, parts.positions)])[by_element],
        np.concatenate([whole.weights, parts.weights])[by_element],
        np.vstack([whole.positions, parts.positions])[by_element],
    )


def _whole(mesh: Mesh, elements: Ints, order: int) -> Quadrature:
    node, weight = np.polynomial.legendre.leggauss(order)
    station = np.stack(np.meshgrid(node, node, indexing="ij"), axis=-1).reshape(-1, 2)
    owner = np.repeat(elements, order * order)
    xi = np.tile(station, (len(elements), 1))
    nodes = mesh.nodes[elements]
    weights = determinants(nodes, station) * np.outer(weight, weight).ravel()
    positions = serendipity(station)[0] @ nodes
    return Quadrature(owner, xi, weights.ravel(), positions.reshape(-1, 2))


def curve_quadrature(mesh: Mesh, curve: Curve, order: int = 3, levels: Levels = ()) -> LineQuadrature:
    """Quadrature along the part of a curve that is on the plate.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    curve : Polyline or Ring
        The curve; tangents point along it, of a ring counter-clockwise.
    order : int
        Gauss points on each piece within one element.
    levels : sequence of functions
        Pieces end where one of them changes its sign, see `signorini.quadrature.stepped`.

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
        on = inside >= 0
        piece, begin, end = divided(breaks[:-1][on], breaks[1:][on], partial(_along, arc), levels)
        s, weights = _stations(begin, end, order)
        points, tangents = arc.at(s)
        elements = np.repeat(inside[on][piece], order)
        parts.append((elements, mesh.invert(elements, points), weights, points, tangents))
    return LineQuadrature(*(np.concatenate(items) for items in zip(*parts, strict=True)))


def _along(arc: Arc, _: Ints, s: Floats) -> Floats:
    return arc.at(s)[0]


def edge_quadrature(mesh: Mesh, triples: Ints, order: int = 3, levels: Levels = ()) -> LineQuadrature:
    """Quadrature along sides of elements, as curved as they are.

    Parameters
    ----------
    mesh : Mesh
        The mesh.
    triples : (k, 3) int array
        Corner, midside, corner of each side, such as ``mesh.edges["left"]``; tangents point from the first to the last.
    order : int
        Gauss points on each side.
    levels : sequence of functions
        Sides are divided where one of them changes its sign, see `signorini.quadrature.stepped`.

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
    a, b = CORNERS[sides], CORNERS[(sides + 1) % 4]
    begin, end = np.where(forward[:, None], a, b), np.where(forward[:, None], b, a)

    def at(side: Ints, t: Floats) -> Floats:
        return np.asarray(0.5 * (begin + end)[side] + 0.5 * t[:, None] * (end - begin)[side])

    def positions(side: Ints, t: Floats) -> Floats:
        return mesh.map(elements[side], at(side, t))

    ones = np.ones(len(triples))
    side, first, last = divided(-ones, ones, positions, levels)
    t, weights = _stations(first, last, order)
    side = np.repeat(side, order)
    elements, xi = elements[side], at(side, t)
    tangents = np.einsum("qda,qa->qd", mesh.jacobian(elements, xi), 0.5 * (end - begin)[side])
    speed = np.hypot(*tangents.T)
    return LineQuadrature(elements, xi, weights * speed, mesh.map(elements, xi), tangents / speed[:, None])


def _stations(begin: Floats, end: Floats, order: int) -> tuple[Floats, Floats]:
    """Gauss points and weights (k * order,) of intervals (k,)."""
    node, weight = np.polynomial.legendre.leggauss(order)
    half = 0.5 * (end - begin)[:, None]
    return (0.5 * (begin + end)[:, None] + half * node).ravel(), (half * weight).ravel()


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
