"""Class `Mesh`: nodes, 8-node quadrilaterals and 6-node triangles, named edges, location of points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import numpy.typing as npt

from signorini._core import map_points, nodal_forces, serendipity, shape_values, triangular
from signorini.base.remade import Brief, Remade
from signorini.errors import InputError
from signorini.mesh import checks as mesh_checks
from signorini.mesh import isoparametric as maps
from signorini.mesh.sides import Sides, edges_on_polyline, edges_on_ring, holes, sides_mostly_on
from signorini.shapes import Curve, Ring
from signorini.shapes.arrays import Bools, Floats, Ints
from signorini.shapes.boxes import BoxTree
from signorini.shapes.extent import Tolerances, diameter

if TYPE_CHECKING:
    import meshio  # type: ignore[import-untyped]


_ROOT = np.sqrt(0.6)
_GAUSS = np.array([[x, y] for x in (-_ROOT, 0.0, _ROOT) for y in (-_ROOT, 0.0, _ROOT)])
_GAUSS_WEIGHTS = np.outer([5.0, 8.0, 5.0], [5.0, 8.0, 5.0]).ravel() / 81.0
_TRIANGLE = np.array([[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]])
"""Quadrature points of the triangle, with equal weights: exact for quadratic functions, such as det J."""
_ON_EDGE = 1e-9
"""Largest distance from a side, in reference coordinates, at which a point counts as on the side."""
_RELATIVE_GAP = 0.1
"""Bound of the distance between a circle and the parabola of an element side, relative to the rise of the parabola over
its chord. It is twice the actual distance for sides of up to 90°."""
_PAST_CURVED_EDGE = 2e-2
"""Tolerance, in reference coordinates, within which points outside a curved boundary side count as inside; it may be
larger, see `Mesh.locate`.
"""


@dataclass(frozen=True, eq=False, repr=False)
class Location(Brief):
    """For each point the element (q,) that contains it, -1 outside the mesh, and reference coordinates (q, 2).

    Outside the mesh the reference coordinates are NaN.
    """

    elements: Ints
    xi: Floats

    @property
    def inside(self) -> Bools:
        """Mask (q,) of the points that are in the mesh."""
        return np.asarray(self.elements >= 0)


@dataclass(frozen=True, eq=False, repr=False)
class Mesh(Remade):
    """A mesh of isoparametric 8-node quadrilaterals and 6-node triangles, validated on construction.

    Parameters
    ----------
    points : (n, 2) float array
        Nodes.
    elements : (ne, 8) int array
        Corners counter-clockwise, then the midsides, the first between the first two corners. A triangle with the
        corners a, b, c repeats c: [a, b, c, c, ab, bc, c, ca]. A quadrilateral whose first side is collapsed to node c
        repeats it for the nodes of that side: [c, c, a, b, c, ca, ab, bc].
    edges : mapping from name to (k, 3) int array
        Named edges: corner, midside, corner, with the plate on the left. An interior line may have either direction.

    Raises
    ------
    InputError
        If an element is inverted or badly distorted; nodes hang, coincide or are unused; the mesh is disconnected or
        overlaps itself; or an edge does not consist of element sides.

    Examples
    --------
    >>> points = np.array([[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]], float)
    >>> mesh = Mesh(points, np.arange(8)[None], {"bottom": np.array([[0, 4, 1]])})
    >>> mesh.size, mesh.element_area
    (4.0, array([8.]))
    >>> where = mesh.locate(np.array([[3.0, 1.0], [5.0, 1.0]]))
    >>> where.elements, where.xi[0]
    (array([ 0, -1]), array([0.5, 0. ]))
    >>> points = np.array([[0, 0], [4, 0], [0, 2], [2, 0], [2, 1], [0, 1]], float)
    >>> Mesh(points, np.array([[0, 1, 2, 2, 3, 4, 2, 5]]), {}).element_area
    array([4.])
    """

    points: Floats
    elements: Ints
    edges: Mapping[str, Ints]
    layers: tuple[Mesh, ...] = ()
    """The meshes of several plates that `layered` combined in this mesh."""

    def __post_init__(self) -> None:
        """Copy the arrays, make them read-only and check the mesh."""
        points = np.array(self.points, dtype=np.float64)
        elements = np.array(self.elements, dtype=np.int64)
        edges = {name: np.array(triples, dtype=np.int64) for name, triples in self.edges.items()}
        self.__setstate__({"points": points, "elements": elements, "edges": edges})
        mesh_checks.check_numbers(points, elements)
        mesh_checks.check_jacobians(points, elements)
        mesh_checks.check_sides(points, elements)
        mesh_checks.check_boundary_nodes(points, self.boundary)
        mesh_checks.check_one_piece(points, elements)
        mesh_checks.check_overlap(points, self.boundary)
        for name, triples in edges.items():
            mesh_checks.check_edge(name, triples, self.sides.reshape(-1, 3))

    @classmethod
    def from_meshio(cls, data: meshio.Mesh) -> Self:
        """Convert a mesh of meshio.

        The mesh must have 8- or 9-node quadrilaterals or 6-node triangles in a plane z = const. Coincident nodes
        (within 1e-9 of the size) are merged, clockwise elements reversed, center nodes of 9-node quadrilaterals and
        unused nodes removed. The edge ``boundary`` is the whole outline. Other edges are named groups of 3-node lines,
        and named groups of nodes that contain whole sides of the outline.

        Examples
        --------
        >>> import meshio
        >>> points = [[0, 0], [4, 0], [4, 2], [0, 2], [2, 0], [4, 1], [2, 2], [0, 1]]
        >>> mesh = Mesh.from_meshio(meshio.Mesh(points, [("quad8", [range(8)])], point_sets={"left": [0, 3, 7]}))
        >>> mesh.edges["left"].tolist(), len(mesh.edges["boundary"])
        ([[3, 7, 0]], 4)
        """
        from signorini.mesh.cells import arrays_of

        return cls(*arrays_of(data))

    @classmethod
    def layered(cls, meshes: Sequence[Self]) -> Self:
        """Combine the meshes of several plates in one table of nodes and elements, without edges.

        The combined mesh cannot locate points, since a point may be in several plates.
        """
        nodes = np.cumsum([0, *(mesh.node_count for mesh in meshes)])
        elements = [mesh.elements + first for mesh, first in zip(meshes, nodes, strict=False)]
        combined = object.__new__(cls)
        points = np.concatenate([mesh.points for mesh in meshes])
        state = {"points": points, "elements": np.concatenate(elements), "edges": {}, "layers": tuple(meshes)}
        combined.__setstate__(state)
        return combined

    def __getstate__(self) -> dict[str, Any]:
        """Return the arrays and a copy of the edges, for pickle."""
        return super().__getstate__() | {"edges": dict(self.edges)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Set the arrays and make them read-only, for pickle."""
        for array in state["edges"].values():
            array.flags.writeable = False
        super().__setstate__(state | {"edges": MappingProxyType(state["edges"])})

    @property
    def node_count(self) -> int:
        """Number of nodes of the mesh."""
        return len(self.points)

    @cached_property
    def size(self) -> float:
        """Length of the longer side of the mesh's bounding box."""
        return float(np.ptp(self.points, axis=0).max())

    @cached_property
    def diameter(self) -> float:
        """Largest distance between two nodes; tolerances are relative to it, as rotation does not change it."""
        return diameter(self.points[np.unique(self.boundary)])

    @property
    def near(self) -> Tolerances:
        """Largest distances at which points count as equal, for the size of this mesh."""
        return Tolerances(self.diameter)

    @cached_property
    def middle(self) -> Floats:
        """Center (2,) of the bounding box of the mesh."""
        return np.asarray(0.5 * (self.points.min(axis=0) + self.points.max(axis=0)))

    @cached_property
    def nodes(self) -> Floats:
        """Positions (ne, 8, 2) of the nodes of every element."""
        return np.asarray(self.points[self.elements])

    @cached_property
    def triangles(self) -> Bools:
        """Mask (ne,) of the elements that are triangles."""
        return maps.are_triangles(self.elements)

    @cached_property
    def sides(self) -> Ints:
        """Node triples (ne, 4, 3) of the sides of each element, with the element on the left.

        A collapsed side, such as the third of a triangle, repeats its node three times.
        """
        return np.asarray(self.elements[:, np.array(maps.SIDES)])

    @cached_property
    def unique_sides(self) -> Ints:
        """Node triples (k, 3) of all sides; a side of two elements occurs once."""
        sides = self.sides[maps.real_sides(self.elements)]
        return np.asarray(sides[np.unique(sides[:, 1], return_index=True)[1]])

    @property
    def spanning(self) -> Bools:
        """Mask (ne,) of quadrilaterals with two opposite sides on the boundary, too coarse for bending across them."""
        outer = self.on_boundary
        return ~self.triangles & ((outer[:, 0] & outer[:, 2]) | (outer[:, 1] & outer[:, 3]))

    @cached_property
    def on_boundary(self) -> Bools:
        """Mask (ne, 4) of the element sides that are on the boundary."""
        return mesh_checks.on_boundary(self.elements)

    @cached_property
    def boundary(self) -> Ints:
        """Node triples (k, 3) of the boundary sides, with the plate on their left, one closed loop after the other."""
        return mesh_checks.loops(self.sides[self.on_boundary])

    @cached_property
    def holes(self) -> tuple[Floats, ...]:
        """Polygon (k, 2) that approximates the outline of each hole."""
        return holes(self.points, self.boundary)

    @cached_property
    def element_area(self) -> Floats:
        """Area (ne,) of each element."""
        area = np.empty(len(self.elements))
        area[~self.triangles] = maps.determinants(self.nodes[~self.triangles], _GAUSS) @ _GAUSS_WEIGHTS
        area[self.triangles] = 0.5 * maps.determinants(self.nodes[self.triangles], _TRIANGLE, True).mean(axis=1)
        return area

    def part(self, elements: Ints) -> Mesh:
        """Return the mesh of the elements with numbers (k,), with all nodes and without edges; it is not validated."""
        return self._with({"points": self.points, "elements": self.elements[elements], "edges": {}})

    def with_triangles(self) -> Mesh:
        """Return the mesh with triangles in place of quadrilaterals with a collapsed side; it is not validated."""
        degenerate = maps.are_degenerate(self.elements)
        if not degenerate.any():
            return self
        elements = np.where(degenerate[:, None], self.elements[:, [2, 3, 0, 0, 6, 7, 0, 5]], self.elements)
        return self._with({"points": self.points, "elements": elements, "edges": self.edges})

    def shape_functions(self, elements: Ints, xi: Floats) -> Floats:
        """Shape functions N (q, 8) of elements with numbers (q,) at reference points ξ (q, 2)."""
        return shape_values(self.elements, elements, xi)

    def corners_of_sides(self, elements: Ints, sides: Ints) -> tuple[Floats, Floats]:
        """Reference points (q, 2) of the start and of the end of side ``sides`` (q,) of element ``elements`` (q,)."""
        triangles = self.triangles[elements, None]
        begin, end = ((maps.TRIANGLE_CORNERS[at], maps.CORNERS[at]) for at in (sides, (sides + 1) % 4))
        return np.where(triangles, *begin), np.where(triangles, *end)

    def spread(self, elements: Ints, stations: Floats, part: float = 1.0) -> Floats:
        """Positions (k, s, 2) in elements (k,) of points (s, 2) of the square [−1, 1]².

        First the distances of the reference points from the element's center are multiplied by ``part``.
        """
        places = np.empty((len(elements), len(stations), 2))
        triangles = self.triangles[elements]
        places[~triangles] = serendipity(part * stations)[0] @ self.nodes[elements[~triangles]]
        within = maps.CENTROID + part * (maps.folded(stations) - maps.CENTROID)
        places[triangles] = triangular(within)[0] @ self.nodes[elements[triangles]]
        return places

    def inward(self, elements: Ints, xi: Floats, part: float) -> Floats:
        """Multiply the distances of reference points (q, 2) from the centers of elements (q,) by ``part``."""
        middle = self.triangles[elements, None] * maps.CENTROID
        return np.asarray(middle + part * (xi - middle))

    def map(self, elements: Ints, xi: Floats) -> Floats:
        """Positions x(ξ) (q, 2) of reference points ξ (q, 2) of elements (q,)."""
        return map_points(self.points, self.elements, elements, xi)

    def nodal_forces(self, elements: Ints, xi: Floats, forces: Floats) -> Floats:
        """Nodal forces Nᵀf (n,) equivalent to forces f (q,) at reference points (q, 2) of elements (q,)."""
        return nodal_forces(self.node_count, self.elements, elements, xi, forces)

    def jacobian(self, elements: Ints, xi: Floats) -> Floats:
        """Jacobian J = ∂x/∂ξ (q, 2, 2) of elements (q,) at reference points (q, 2); the first index is that of x."""
        return maps.jacobians(self.nodes[elements], xi)

    def invert(self, elements: Ints, points: Floats) -> Floats:
        """Reference points (q, 2) of positions (q, 2) that are in elements (q,) or just outside."""
        xi, converged = maps.invert(self.nodes[elements], points)
        if not converged.all():
            place = mesh_checks.name_element(self.points, self.elements, int(elements[np.argmin(converged)]))
            raise InputError(f"{place} is too distorted to map points in it; improve its shape.")
        return xi

    def locate(self, points: Floats) -> Location:
        """Find the elements that contain points (q, 2).

        A point on a side or node belongs to the element of lowest number there. A convex boundary side is a parabola;
        points of the circle that it approximates may lie outside. Such a point counts as inside within 2e-2 in
        reference coordinates, or within a tenth of the side's rise. Its reference coordinate remains beyond 1.
        """
        points = np.asarray(points, dtype=np.float64)
        point, held = self.holding(points)
        first = np.unique(point, return_index=True)[1]
        elements = np.full(len(points), -1, dtype=np.int64)
        reference = np.full((len(points), 2), np.nan)
        elements[point[first]] = held.elements[first]
        reference[point[first]] = held.xi[first]
        return Location(elements, reference)

    def nearest(self, points: Floats) -> Location:
        """Locate points (q, 2) as `locate` does; for a point outside, locate the nearest position on the boundary."""
        where = self.locate(points)
        off = np.flatnonzero(~where.inside)
        if not len(off):
            return where
        # This import takes as long as a small solve, and most models need it at no point.
        from scipy.spatial import KDTree

        sides = self.points[self.boundary]
        far = float(np.max(KDTree(sides[:, 1]).query(points[off])[0]))
        there = self.locate(Sides(sides, far).nearest(points[off])[0])
        elements, xi = where.elements.copy(), where.xi.copy()
        elements[off], xi[off] = there.elements, there.xi
        return Location(elements, xi)

    def holding(self, points: Floats) -> tuple[Ints, Location]:
        """Find all elements that contain each point (q, 2), see `locate`.

        Return the numbers of points (k,) and their locations (k,); a point on a side occurs for each element there.
        """
        point, element = self._tree.pairs(points)
        xi, result = maps.invert(self.nodes[element], points[point])
        past = self.past(element, xi)
        inside = result & (past <= self._reach[element]).all(axis=1)
        point, element, xi, past = point[inside], element[inside], xi[inside], past[inside]
        order = np.lexsort((element, np.maximum(past, 0.0).max(axis=1, initial=0.0), point))
        point, element, xi, past = point[order], element[order], xi[order], past[order]
        snap = past <= self._rounding[element, None]
        triangles = self.triangles[element]
        lower = np.where(snap[:, [3, 0]], np.where(triangles, 0.0, -1.0)[:, None], -np.inf)
        upper = np.where(snap[:, [1, 2]], 1.0, np.inf)
        xi = np.clip(xi, lower, upper)
        over = np.where(triangles & snap[:, 1], np.maximum(xi.sum(axis=1) - 1.0, 0.0), 0.0)
        return point, Location(element, xi - 0.5 * over[:, None])

    def onto_curved_sides(self, where: Location, reach: float) -> Floats:
        """Move points near curved sides onto them; return the reference points (q, 2) of all points.

        A point is moved if it is within ``reach`` of the side's circle, and at most by a tenth of the side's rise.
        """
        element, xi = where.elements, where.xi.copy()
        triangles, past = self.triangles[element], self.past(element, xi)
        near = self._curved[element] & (np.abs(past) <= _RELATIVE_GAP * np.abs(self.sagitta / self._depth)[element])
        query, side = np.nonzero(near)
        a, middle, b = np.moveaxis(self.points[self.sides[element[query], side]], 1, 0)
        inward = 0.5 * (a + b) - middle
        rise = np.hypot(*inward.T)
        radius = 0.5 * (0.25 * ((b - a) ** 2).sum(axis=1) / rise + rise)
        to_center = middle + inward * (radius / rise)[:, None] - self.map(element[query], xi[query])
        near[query, side] = np.abs(np.hypot(*to_center.T) - radius) <= reach
        xi[near[:, 3], 0] = np.where(triangles, 0.0, -1.0)[near[:, 3]]
        xi[near[:, 0], 1] = np.where(triangles, 0.0, -1.0)[near[:, 0]]
        xi[near[:, 1] & ~triangles, 0] = 1.0
        xi[near[:, 2] & ~triangles, 1] = 1.0
        over = np.where(triangles & near[:, 1], xi.sum(axis=1) - 1.0, 0.0)
        return np.asarray(xi - 0.5 * over[:, None])

    def past(self, element: Ints, xi: Floats) -> Floats:
        """Signed distances (q, 4) of reference points (q, 2) from the sides of elements (q,), positive outside.

        They are in reference coordinates. For the third side of a triangle, which is a node, the distance is -1.
        """
        past = np.column_stack([-xi[:, 1], xi[:, 0], xi[:, 1], -xi[:, 0]]) - 1.0
        r, s = xi.T
        of_triangles = np.column_stack([-s, r + s - 1.0, np.full(len(xi), -1.0), -r])
        return np.where(self.triangles[element, None], of_triangles, past)

    def nodes_at(self, points: npt.ArrayLike) -> Ints:
        """Numbers (q,) of the nodes at points (q, 2), within the tolerance `near.place`; -1 without a node there.

        Examples
        --------
        >>> from signorini.mesh.meshers import rectangle
        >>> rectangle((0.0, 0.0), (4.0, 2.0), (1, 1)).nodes_at([[4.0, 2.0], [1.0, 1.0]]).tolist()
        [7, -1]
        """
        positions = np.reshape(np.asarray(points, dtype=np.float64), (-1, 2))
        nodes = self.elements[self.locate(positions).elements]
        distance = np.linalg.norm(self.points[nodes] - positions[:, None], axis=2)
        nearest = np.arange(len(positions)), distance.argmin(axis=1)
        return np.where(distance[nearest] <= self.near.place, nodes[nearest], -1)

    def edges_along(self, curve: Curve) -> Ints | None:
        """Find the element sides that cover a curve; None if the mesh does not follow the curve.

        The node triples (k, 3) have the order and direction of the curve, for a ring counter-clockwise. The distance of
        all nodes from the curve is at most 1e-8 of the mesh's diameter. Parts of a ring outside the plate need not be
        covered.
        """
        triples, tolerance = self.unique_sides, self.near.place
        if not isinstance(curve, Ring):
            return edges_on_polyline(self.points, triples, curve.sides, tolerance)
        on_ring = edges_on_ring(self.points, triples, curve, tolerance)
        if on_ring is None or self.locate(on_ring.gaps).inside.any():
            return None
        return on_ring.triples

    def sides_on(self, curve: Curve) -> Ints:
        """Find the element sides (k, 3) of which at least half lies on a curve.

        The mesh may follow only a part of the curve; see `edges_along` for the whole curve.
        """
        triples, tolerance = self.unique_sides, self.near.place
        if not isinstance(curve, Ring):
            return sides_mostly_on(self.points, triples, curve.sides, tolerance)
        on_ring = edges_on_ring(self.points, triples, curve, tolerance)
        return np.zeros((0, 3), np.int64) if on_ring is None else on_ring.triples

    def boundary_beside(self, ring: Ring) -> Ints:
        """Find the curved boundary sides (k, 3) whose nodes are on a circle within the tolerances of `locate`."""
        element, side = np.nonzero(self.on_boundary & self._curved & (self.sagitta > 0.0))
        triples = self.sides[element, side]
        beyond = ring.radius - np.hypot(*np.moveaxis(self.points[triples] - ring.center, 2, 0))
        most = (self._reach * self._depth)[element, side]
        near = (beyond >= -_RELATIVE_GAP * self.sagitta[element, side, None]) & (beyond <= most[:, None])
        return np.asarray(triples[near.all(axis=1)])

    def find_sides(self, triples: Ints) -> tuple[Ints, Ints, Bools]:
        """Element (k,) and side number (k,) of node triples (k, 3); mask (k,) of triples with the element on the left.

        For a side of two elements, the element on the left is returned.
        """
        sides = self.sides.reshape(-1, 3)
        n = self.node_count
        keys = sides[:, 0] * n + sides[:, 2]
        order = np.argsort(keys, kind="stable")

        def find(wanted: Ints) -> tuple[Ints, Bools]:
            at = order[np.minimum(np.searchsorted(keys, wanted, sorter=order), len(keys) - 1)]
            return at, np.asarray(keys[at] == wanted)

        along, forward = find(triples[:, 0] * n + triples[:, 2])
        against, backward = find(triples[:, 2] * n + triples[:, 0])
        if not (forward | backward).all():
            lost = triples[np.argmin(forward | backward)]
            raise InputError(f"Nodes {', '.join(map(str, lost))} are not a side of any element of the mesh.")
        side = np.where(forward, along, against)
        return side // 4, side % 4, forward

    @cached_property
    def _rounding(self) -> Floats:
        """Largest distance (ne,) from a side, in reference coordinates, at which a point counts as on the side."""
        lower, upper = maps.bounds(np.moveaxis(self.nodes, 1, 0))
        extent = (upper - lower).min(axis=1)
        return np.asarray(_ON_EDGE + 32.0 * np.finfo(float).eps * np.abs(self.points).max() / extent)

    @cached_property
    def _chords(self) -> Floats:
        """Vectors (ne, 4, 2) from the start to the end of each side."""
        return np.asarray(self.points[self.sides[..., 2]] - self.points[self.sides[..., 0]])

    @cached_property
    def _lengths(self) -> Floats:
        """Lengths (ne, 4) of the chords of the sides; 1 for collapsed sides."""
        return np.where(maps.real_sides(self.elements), np.hypot(*np.moveaxis(self._chords, 2, 0)), 1.0)

    @cached_property
    def sagitta(self) -> Floats:
        """Rise (ne, 4) of each side, the distance of the midside node from the chord, positive outwards."""
        chord, offset = self._chords, self.points[self.sides[..., 1]] - self.points[self.sides[..., 0]]
        return np.asarray((chord[..., 1] * offset[..., 0] - chord[..., 0] * offset[..., 1]) / self._lengths)

    def round_outline_area(self, box: tuple[float, float, float, float]) -> float:
        """Upper bound of the area between curved boundary sides and their circles in a box xmin, ymin, xmax, ymax."""
        low, high = np.array(box[:2]), np.array(box[2:])
        boxes, areas = self._round_outline
        return float(areas[(boxes[:, :2] <= high).all(axis=1) & (boxes[:, 2:] >= low).all(axis=1)].sum())

    @cached_property
    def _round_outline(self) -> tuple[Floats, Floats]:
        """Boxes (k, 4) around each curved boundary side and its circle, and bounds (k,) of the areas between these."""
        curved = self.on_boundary & self._curved
        sides, rise, chord = self.points[self.sides[curved]], np.abs(self.sagitta[curved]), self._lengths[curved]
        # For the chord c and rise s the area between parabola and circle is less than 0.03 c s, for sides of up to 90°.
        return maps.side_boxes(sides) + rise[:, None] * np.array([-1.0, -1.0, 1.0, 1.0]), 0.03 * chord * rise

    @cached_property
    def _curved(self) -> Bools:
        return np.asarray(np.abs(self.sagitta) > 1e-9 * np.hypot(*np.moveaxis(self._chords, 2, 0)))

    @cached_property
    def _depth(self) -> Floats:
        """Extent (ne, 4) of each element normal to each side: the element's area over the chord's length."""
        return np.asarray(self.element_area[:, None] / self._lengths)

    @cached_property
    def _reach(self) -> Floats:
        """Largest distance (ne, 4) outside each side, in reference coordinates, of points that count as inside."""
        past = np.clip(_RELATIVE_GAP * self.sagitta / self._depth, _PAST_CURVED_EDGE, 0.3)
        curved = self.on_boundary & self._curved & (self.sagitta > 0.0)
        return np.where(curved, past, self._rounding[:, None])

    @cached_property
    def boxes(self) -> Floats:
        """Bounding boxes (ne, 4) xmin, ymin, xmax, ymax of the elements with their curved sides."""
        boxes = maps.side_boxes(self.points[self.sides].reshape(-1, 3, 2)).reshape(-1, 4, 4)
        corners = np.moveaxis(boxes.reshape(-1, 8, 2), 1, 0)
        return np.hstack(maps.bounds(corners))

    @cached_property
    def _tree(self) -> BoxTree:
        lower, upper = self.boxes[:, :2], self.boxes[:, 2:]
        margin = (upper - lower) * self._reach.max(axis=1)[:, None]
        return BoxTree(np.hstack([lower - margin, upper + margin]))
