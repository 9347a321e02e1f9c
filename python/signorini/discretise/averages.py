"""Areas that the plate does not yield to: the mean of every element, and points on the outline.

Points within an element would outnumber the deflections that answer them. The means alone end half an element short of
the outline, where a plate that tips rests. The corners of elements there carry it instead: they leave the midsides
between them to answer the means, so that pressures are answered as well as by the means alone (docs/theory.md,
section 5).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from signorini.discretise.outlines import outline
from signorini.discretise.places import region
from signorini.discretise.quadrature.arcs import arcs_of
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.zones import Zones
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import BoxTree
from signorini.model import Plate, Support
from signorini.shapes import Circle, Curve, Hollow, Polyline, Region, Ring, Rounded
from signorini.shapes.distances import distances

STRIP = 1e-2
"""Part of an element's area that each point on the outline stands for: enough to act where a bed is a little stiff."""
MOST = 0.25
"""Part that all on it stand for at most, however many corners an outline has there."""
_ON_OUTLINE = 1e-4
"""Distance, over the plate's diameter, within which a point is on the hull; that of a circle is a polygon."""
_APART = 0.25
"""Distance, over an element's size, below which one of two points is enough: sides may cross an outline in a corner."""
_FOUR = 4
"""Points on the hull, whether of a circle or a rectangle, that hold both slopes and prefer no direction."""
_NUDGE = 1e-4
"""Distance, over an element's size, at which to look for the elements around a point."""
_ROUND = np.radians(22.5 + 45.0 * np.arange(8))


@dataclass(frozen=True, eq=False)
class PlateStiffness:
    """How stiff the plate is by element (ne,): per area, against waves two elements long, and per point, in shear."""

    in_waves: Floats
    in_shear: Floats

    @classmethod
    def of(cls, mesh: Mesh, zones: Zones, thickness: Floats) -> Self:
        """Take the thickness (ne, p) at the points of the elements' integrals, or (1, 1)."""
        h = np.broadcast_to(thickness.mean(axis=1), len(mesh.elements))
        number = zones.of_elements.rigidity
        unit = np.array([[rigidity.in_waves, rigidity.in_shear] for rigidity in zones.rigidities])[number]
        bending, shear = unit[:, 0] * h**3, unit[:, 1] * h
        # sin(πx/a) sin(πy/a), with a² the element's area.
        wave = 2.0 * np.pi**2 / mesh.element_area
        return cls(1.0 / (1.0 / (bending * wave**2) + 1.0 / (shear * wave)), shear)


@dataclass(frozen=True, eq=False)
class OutlinePoints:
    """Points on the hull of an area: positions (v, 2), and up to four elements (v, 4) that share each; else −1."""

    positions: Floats
    shared: Ints


def outline_points(mesh: Mesh, plate: Plate, support: Support, covered: Bools) -> OutlinePoints:
    """Corners of an area, and of elements on its outline, as far as they are on its hull.

    Parameters
    ----------
    mesh : Mesh
    plate : Plate
    support : Support
        On an area.
    covered : (ne,) bool array
        Elements of which it has a part.
    """
    size = float(np.sqrt(mesh.element_area[covered].mean()))
    corners, all_of_them = outline(mesh, plate, support), _candidates(mesh, support)
    candidates = _spread(all_of_them, _APART * size)
    if len(candidates) < _FOUR:
        # Within an element or two: a mean and fewer points may hold one of two slopes, by which corner comes first.
        candidates = _spread(all_of_them, _APART * float(np.ptp(corners, axis=0).min()))
    return _around(mesh, candidates[_off_hull(corners, candidates) <= _ON_OUTLINE * mesh.diameter], size, covered)


def missing_corners(mesh: Mesh, plate: Plate, support: Support, covered: Bools, reached: Floats) -> OutlinePoints:
    """Corners of an area's hull at which none of its points (q, 2) is: tips, where a quadrature has no weight."""
    shape = region(support.area)
    corners = np.zeros((0, 2)) if shape is None else _corners(shape)
    corners = corners[_off_hull(outline(mesh, plate, support), corners) <= _ON_OUTLINE * mesh.diameter]
    near = mesh.near.place
    along = np.sort(corners[:, 0])
    beside = np.searchsorted(along, reached[:, 0] - near) < np.searchsorted(along, reached[:, 0] + near, "right")
    if beside.any():
        there, _ = BoxTree.build(np.hstack([reached[beside] - near, reached[beside] + near])).pairs(corners)
        corners = np.delete(corners, there, axis=0)
    if not len(corners):
        return OutlinePoints(corners, np.zeros((0, 4), np.int64))
    return _around(mesh, corners, float(np.sqrt(mesh.element_area[covered].min())), covered)


def _around(mesh: Mesh, points: Floats, size: float, covered: Bools) -> OutlinePoints:
    """Points with the covered elements around them."""
    around = np.concatenate([np.zeros((1, 2)), _NUDGE * size * np.column_stack([np.cos(_ROUND), np.sin(_ROUND)])])
    near = mesh.locate((points[:, None] + around).reshape(-1, 2)).elements.reshape(len(points), len(around))
    near = np.sort(np.where((near >= 0) & covered[near], near, -1), axis=1)[:, ::-1]
    near[:, 1:][near[:, 1:] == near[:, :-1]] = -1
    shared = np.sort(near, axis=1)[:, :-5:-1]
    some = shared[:, 0] >= 0
    return OutlinePoints(points[some], shared[some])


def _candidates(mesh: Mesh, support: Support) -> Floats:
    """Corners (v, 2) of the area, then those of elements on its outline and where sides of elements cross it."""
    shape = region(support.area)
    if shape is None:
        return np.asarray(mesh.points[np.unique(mesh.boundary[:, [0, 2]])])
    along = _rim(shape)
    corners = _corners(shape)
    triples = mesh.edges_along(along)
    if triples is not None:
        return np.concatenate([corners, mesh.points[np.unique(triples[:, [0, 2]])]])
    arcs = arcs_of(along)
    return np.concatenate([corners, *(arc.at(arc.breaks(mesh.points[mesh.unique_sides]))[0] for arc in arcs)])


def _corners(shape: Region) -> Floats:
    """Corners of a region (c, 2), and of its arcs the points farthest along x and y."""
    if isinstance(shape, Hollow):
        return _corners(shape.around)
    if isinstance(shape, Circle):
        return np.asarray(shape.center + shape.radius * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]]))
    return shape.tips if isinstance(shape, Rounded) else shape.drawn


def _rim(shape: Region) -> Curve:
    if isinstance(shape, Hollow):
        return _rim(shape.around)
    if isinstance(shape, Circle):
        return Ring(shape.center, shape.radius)
    points = shape.drawn.tolist()
    return Polyline(tuple((x, y) for x, y in [*points, points[0]]))


def _spread(points: Floats, apart: float) -> Floats:
    """Leave out points (v, 2) that are too near to one before them."""
    from scipy.spatial import cKDTree

    keep = np.ones(len(points), np.bool_)
    for i, j in sorted(cKDTree(points).query_pairs(apart)):
        keep[j] &= not keep[i]
    return np.asarray(points[keep])


def _off_hull(corners: Floats, points: Floats) -> Floats:
    """Distance (v,) of points from the sides between corners (k, 2) of a hull, in order."""
    return np.asarray(distances(points, corners, np.roll(corners, -1, axis=0)).min(axis=1))
