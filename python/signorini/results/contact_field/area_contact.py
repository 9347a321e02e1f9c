"""Contact of area supports, computed from the deflection field: pressure, contact area, edge of contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType

import numpy as np
from scipy.sparse import csr_array

from signorini.base.remade import Remade
from signorini.discretise.laws import SupportLaw, can_let_go, on_soil
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.mesh.isoparametric import real_sides
from signorini.model import Support
from signorini.results.contact_field.cells import Cells, edge_of_contact
from signorini.results.contact_field.lines import Segments, chained, clipped, thinned
from signorini.results.extremes import peak
from signorini.shapes.distances import depth
from signorini.shapes.tessellation import Tessellation

_WHOLE = 1.0 - 1e-9
"""Smallest ratio of an element's area on the support to its whole area at which all of the element counts as on it."""
_TOUCHING = 1e-9
"""Largest overlap of plate and support that counts as zero, relative to the largest overlap or gap at the nodes."""
_ON_OUTLINE = 1e-9
"""Largest distance from the support's outline at which a point counts as on the outline, relative to the plate's size.
"""
_STRAIGHT = 1e-3
"""Largest distance of a removed point of the edge of contact from its neighbours' chord, relative to element size."""
_ALONG_SIDE = np.linspace(-1.0, 1.0, 9)


def ground_of(mesh: Mesh, elements: Ints) -> Mesh:
    """Mesh that consists of the listed elements (q,) of a mesh, each once, in rising order of their numbers."""
    some = np.unique(elements)
    return mesh if len(some) == len(mesh.elements) else mesh.part(some)


@dataclass(frozen=True, eq=False, repr=False)
class AreaContact(Remade):
    """Contact of one area support in one solution: pressures, contact area, edge of contact."""

    mesh: Mesh
    support: Support  # the area support
    deflection: Floats  # (n,): deflection of the nodes
    positions: Floats  # (q, 2): points of the area; one for each element if ``on_means``
    elements: Ints  # (q,): number of the element that contains each point
    weights: Floats  # (q,): area that each point represents
    closed: Bools  # (q,): whether each point is in contact
    reactions: Floats  # (q,): upward force of each point
    on_means: bool  # whether the support acts on mean deflections of elements, as rigid and practically rigid areas do
    stiff: Bools
    """Mask (ne,) of elements in which the support is stiffer than the plate. In these elements the pressure between
    points is not computed from the deflection."""
    ground: Mesh  # mesh of the elements that are partly on the support, from `ground_of`

    _made = MappingProxyType({"ground": lambda area: ground_of(area.mesh, area.elements)})

    @property
    def bounds(self) -> tuple[float, float]:
        """Smallest and largest pressure that the support's direction allows, regardless of its limit: 0 or infinite."""
        return self._law.bounds

    @property
    def _law(self) -> SupportLaw:
        return SupportLaw(self.support)

    def _exerted(self, deflection: Floats, positions: Floats) -> Floats:
        """Pressures (..., q) that an elastic area exerts for deflections (..., q) at positions (q, 2)."""
        return np.asarray(np.clip(self._law.pressure(deflection, positions), *self.bounds))

    @cached_property
    def covered(self) -> Floats:
        """Area (ne,) of the part of each element that is on the support."""
        return np.bincount(self.elements, self.weights, len(self.mesh.elements)).astype(np.float64)

    @cached_property
    def element_pressure(self) -> Floats:
        """Mean pressure (ne,) over the part of each element on the support, positive up; 0 off the support."""
        force = np.bincount(self.elements, self.reactions, len(self.covered))
        return np.asarray(force / np.where(self.covered > 0, self.covered, 1.0))

    @cached_property
    def on_nodes(self) -> Bools:
        """Mask (n,) of the nodes on the support."""
        on = np.zeros(self.mesh.node_count, np.bool_)
        on[self.mesh.elements[self._whole].ravel()] = True
        near = np.unique(self.mesh.elements[(self.covered > 0) & ~self._whole])
        on[near] |= self.depth(self.mesh.points[near]) >= 0
        return on

    def nodal(self, nodes: Ints, deflection: Floats, forces: Floats) -> Floats:
        """Pressure (..., k) of an elastic area at nodes (k,), positive up; 0 at nodes outside the area.

        ``deflection`` (..., k) are the deflections of these nodes, ``forces`` (..., q) the forces of the area's points.
        At nodes of stiff elements the pressure is the mean of the adjacent elements.
        """
        result = np.zeros(deflection.shape)
        on = self.on_nodes[nodes]
        if not self.on_means:
            result[..., on] = self._exerted(deflection[..., on], self.mesh.points[nodes[on]])
        if self.stiff.any():
            elements = np.flatnonzero(self.covered > 0)
            around = np.zeros((len(self.covered), 8))
            around[elements] = 1.0
            count, e = len(self.on_nodes), np.repeat(np.arange(len(self.covered)), 8)
            at_elements = csr_array((around.ravel(), (self.mesh.elements.ravel(), e)), shape=(count, len(self.covered)))
            stiff = on & np.isin(nodes, self.mesh.elements[self.stiff & (self.covered > 0)])
            of_nodes = at_elements[nodes[stiff]]
            result[..., stiff] = (of_nodes[:, self.elements] @ forces.T).T / (of_nodes @ self.covered)
        return result

    @cached_property
    def largest(self) -> tuple[float, Floats]:
        """Largest pressure over `pressure_places`, and its position (2,); the pressure is 0 if the area only pulls."""
        known, places = np.nan_to_num(self._measured, nan=-np.inf), self.pressure_places
        return max(float(known.max()), 0.0), places[peak(known, places)]

    @property
    def range(self) -> tuple[float, float]:
        """Range of the pressure for a colour scale: extremes over `pressure_places`; the range includes 0."""
        return float(np.fmin.reduce(self._measured, initial=0.0)), self.largest[0]

    @cached_property
    def _measured(self) -> Floats:
        return self.measured(self.deflection[self.on_nodes], self.reactions)

    @cached_property
    def pressure_places(self) -> Floats:
        """Positions (p, 2) at which the pressure is computed: the area's points and, on an elastic area, its nodes."""
        if not self.support.is_elastic:
            return self.positions
        return np.concatenate([self.positions, self.mesh.points[self.on_nodes]])

    def measured(self, deflection: Floats, forces: Floats) -> Floats:
        """Pressures (..., p) at `pressure_places`, from deflections (..., k) of nodes and forces (..., q) of points."""
        own = forces / self.weights
        if not self.support.is_elastic:
            return np.asarray(own)
        return np.concatenate([own, self.nodal(np.flatnonzero(self.on_nodes), deflection, forces)], axis=-1)

    def pressure(self, positions: Floats) -> Floats:
        """Pressure (q,) at positions (q, 2) on the plate, positive up; NaN outside the support.

        A position on the support's outline counts as on the support, whichever element contains the position.
        """
        covered = np.unique(self.elements)
        where = self.ground.locate(positions)
        on = (where.inside & self._whole[covered[where.elements]]) | (self.depth(positions) >= 0)
        result = np.full(len(positions), np.nan)
        where = self.ground.nearest(positions[on])
        elements = covered[where.elements]
        nodal = self.deflection[self.mesh.elements[elements]]
        deflection = np.einsum("qi,qi->q", self.mesh.shape_functions(elements, where.xi), nodal)
        soft = np.zeros(len(elements)) if self.on_means else self._exerted(deflection, positions[on])
        result[on] = np.where(self.stiff[elements], self.element_pressure[elements], soft)
        return result

    def pressing(self, cut: Tessellation) -> Floats:
        """Pressure (v,) of an elastic area at the vertices of triangles, as if it pushed and pulled; 0 in place of NaN.

        The pressure that the area really exerts is this pressure limited to `bounds`. Without this limitation the
        pressure is smooth, and its zero line is the edge of contact.
        """
        at = cut.interpolate(self.mesh.points)
        return np.nan_to_num(self._law.pressure(cut.interpolate(self.deflection), at))

    @property
    def nodal_pressing(self) -> Floats:
        """Pressure (n,) of an elastic area at the nodes, as if it pushed and pulled; 0 in place of NaN."""
        return np.nan_to_num(self._law.pressure(self.deflection, self.mesh.points))

    @cached_property
    def contact_area(self) -> float:
        """Area of the support that is in contact."""
        return float(self._areas(self.closed[None], *self._crossed_here[:3])[0])

    def contact_areas(self, deflection: Floats, closed: Bools) -> Floats:
        """Contact areas (k,) in k solutions, from deflections (k, n) and the mask (k, q) of closed points.

        An element with every point closed counts with its whole area on the support. In elements that the edge of
        contact may cross, the area is computed on a grid finer than the support's points. In an element wholly in
        contact, the area is exactly that of the support in the element.
        """
        return self._areas(closed, *self._crossed(deflection, closed, self._law)[:3])

    def yielding(self, yielded: Bools) -> float | None:
        """Area in which the limit is reached, given the mask (q,) of points at the limit; None if there is no limit."""
        if not self.support.can_yield:
            return None
        law = SupportLaw(self.support, to_limit=True)
        if not law.has_curve_of_yielding:
            return float(self.weights[yielded].sum())
        crossed = self._crossed(self.deflection[None], yielded[None], law)
        return float(self._areas(yielded[None], *crossed[:3])[0])

    def _areas(self, closed: Bools, own: Ints, elements: Ints, parts: Floats) -> Floats:
        touching = (self.per_element @ (self.weights[:, None] * closed.T)).T
        measured = ~np.isnan(parts)
        own, elements = own[measured], elements[measured]
        more = self.covered[elements] * parts[measured] - touching[own, elements]
        return np.asarray(touching.sum(axis=1) + np.bincount(own, more, len(touching)))

    @cached_property
    def contact_boundary(self) -> tuple[Floats, ...]:
        """Edge of contact: polylines (k, 2) with the contact on their left; closed ones end with their first point.

        Open polylines end at the border of the support or the plate. On an elastic area the deflection field closes the
        gap along these lines. On a rigid area the lines are sides between closed and open elements.
        """
        if self.on_means:
            segments, near = self._sides_between(), self.elements
        else:
            _, near, _, (rounding,) = self._crossed_here
            if not len(near):
                return ()
            segments = edge_of_contact(self.mesh, self._law, np.sort(near), self.deflection, float(rounding))
        segments = clipped(segments, self.depth(segments.points))
        tolerance = _STRAIGHT * float(np.sqrt(self.mesh.element_area[near].min(initial=np.inf)))
        return tuple(thinned(line, tolerance) for line in chained(segments))

    def depth(self, positions: Floats) -> Floats:
        """Depth (q,) of positions (q, 2) inside the support; < 0 outside its outline and where its stiffness is 0."""
        region, size = self.support.where.region, self.mesh.size
        deep = np.full(len(positions), size) if region is None else depth(region, positions) + _ON_OUTLINE * size
        return np.where(on_soil(self.support, positions), deep, -size)

    @cached_property
    def _whole(self) -> Bools:
        return np.asarray((self.covered > 0) & (self.covered >= _WHOLE * self.mesh.element_area))

    @cached_property
    def per_element(self) -> csr_array:
        """Matrix (ne, q) that sums values at points over each element: entry 1 if the element contains the point."""
        points = np.arange(len(self.elements))
        return csr_array((np.ones(len(points)), (self.elements, points)), shape=(len(self.covered), len(points)))

    @cached_property
    def _crossed_here(self) -> tuple[Ints, Ints, Floats, Floats]:
        return self._crossed(self.deflection[None], self.closed[None], self._law)

    def _crossed(self, deflection: Floats, closed: Bools, law: SupportLaw) -> tuple[Ints, Ints, Floats, Floats]:
        """Compute the fraction in contact of each element that the edge of contact may cross, in k solutions.

        Returns, for p pairs of a solution and an element, their numbers (p,), (p,) and the fractions (p,); and for each
        solution the penetration (k,) up to which a point counts as just touching.
        """
        if self.on_means or not can_let_go(self.support):
            nothing = np.zeros(0, np.int64)
            return nothing, nothing, np.zeros(0), np.zeros(len(deflection))
        covered = self.covered > 0
        nodes, inverse = np.unique(self.mesh.elements[covered], return_inverse=True)
        at_nodes = law.overlap(deflection[:, nodes], law.travel(self.mesh.points[nodes]))
        rounding = _TOUCHING * np.fmax.reduce(np.abs(at_nodes), axis=1, initial=0.0)
        pressed = (self.per_element @ closed.T.astype(np.float64)).T > 0
        parted = (self.per_element @ (1.0 - closed.T)).T > 0
        of_elements = inverse.reshape(-1, 8)
        pressed[:, covered] |= (at_nodes >= -rounding[:, None])[:, of_elements].any(axis=2)
        parted[:, covered] |= (at_nodes <= rounding[:, None])[:, of_elements].any(axis=2)
        cells = Cells(self.mesh, law, covered, self.depth)
        return *cells.parts(deflection, pressed & parted, rounding), rounding

    def _sides_between(self) -> Segments:
        """Find the sides between closed and open elements of a rigid area; the closed elements are on their left."""
        elements, sides = self.mesh.elements, self.mesh.sides
        closed, opened = np.unique(self.elements[self.closed]), np.unique(self.elements[~self.closed])
        triples = sides[closed][np.isin(sides[closed][..., 1], elements[opened, 4:]) & real_sides(elements[closed])]
        s = _ALONG_SIDE[1:-1]
        shape = np.stack([0.5 * s * (s - 1), 1 - s * s, 0.5 * s * (s + 1)])
        between = np.einsum("is,kid->ksd", shape, self.mesh.points[triples])
        count = self.mesh.node_count
        inner = count + np.arange(between.shape[0] * len(s)).reshape(-1, len(s))
        chain = np.hstack([triples[:, :1], inner, triples[:, 2:]])
        pairs = np.stack([chain[:, :-1], chain[:, 1:]], axis=-1).reshape(-1, 2)
        return Segments(np.concatenate([self.mesh.points, between.reshape(-1, 2)]), pairs)


_STEP = 1e-6
"""Length of the step from a point on a common border of areas into one of them, relative to the plate's size; it is
longer than the tolerance of outlines.
"""
_WAYS = np.array([(np.cos(turn), np.sin(turn)) for turn in np.pi / 8 * (2 * np.arange(8) - 6.6)])
"""Directions of the steps from a common border into an area, as unit vectors; usual outlines are parallel to none."""


def without_shared_borders(areas: Sequence[AreaContact], positions: Floats, on: Bools) -> Bools:
    """Mask (a, q) of the areas that act at positions (q, 2), given the mask ``on`` of areas that contain the positions.

    ``on`` includes borders. From a position on a common border of areas, steps are taken in a fixed order of
    directions. The first step that ends inside an area decides: the areas that contain the end of the step act. So only
    one area acts on the border where two areas touch, and both areas act where they overlap.
    """
    several = np.flatnonzero(on.sum(axis=0) > 1)
    if not len(several):
        return on
    result, places = on.copy(), positions[several]
    step = _STEP * areas[0].mesh.size
    border = on[:, several] & np.array([area.depth(places) < 0.5 * step for area in areas])
    left = border.sum(axis=0) > 1
    for way in _WAYS:
        if not left.any():
            break
        beside = np.zeros_like(border)
        beside[:, left] = border[:, left] & np.array([area.depth(places[left] + step * way) >= 0 for area in areas])
        settled = beside.any(axis=0)
        result[:, several[settled]] &= beside[:, settled] | ~border[:, settled]
        left &= ~settled
    return result


_ALONG = 24
"""Number of sample points along each direction of an element that overlapping rigid areas cover in part."""


@dataclass(frozen=True, eq=False)
class Pressures:
    """Pressures of several areas in any number of solutions (...,), from deflections of nodes and forces of points.

    Where areas overlap, their pressures add. On a border where areas only touch, one of the areas counts.
    """

    areas: Sequence[AreaContact]

    @cached_property
    def nodes(self) -> Ints:
        """Nodes (k,) of the plate that are on at least one elastic area."""
        return np.flatnonzero(np.any([area.on_nodes for area in self._elastic], axis=0))

    @cached_property
    def elements(self) -> Ints:
        """Elements (k,) of which a part is on at least one rigid area."""
        return np.flatnonzero(np.any([area.covered > 0 for area in self._rigid], axis=0))

    def at_nodes(self, deflections: Sequence[Floats], forces: Sequence[Floats]) -> Floats:
        """Pressure (..., k) at `nodes`, from each area's deflections (..., k) there and forces (..., p) of points."""
        total = np.zeros(deflections[0].shape)
        for area, on in zip(self._elastic, self._acting, strict=True):
            own = self.areas.index(area)
            total += on * area.nodal(self.nodes, deflections[own], forces[own])
        return total

    def on_elements(self, forces: Sequence[Floats]) -> Floats:
        """Mean pressure (..., k) over the part of each of `elements` on rigid areas, from forces of areas' points."""
        total = np.zeros((*forces[0].shape[:-1], len(self.elements)))
        for area in self._rigid:
            total += (area.per_element[self.elements] @ forces[self.areas.index(area)].T).T
        return total / self._part

    @property
    def _elastic(self) -> list[AreaContact]:
        return [area for area in self.areas if area.support.is_elastic]

    @property
    def _rigid(self) -> list[AreaContact]:
        return [area for area in self.areas if not area.support.is_elastic]

    @cached_property
    def _acting(self) -> Bools:
        on = np.array([area.on_nodes[self.nodes] for area in self._elastic])
        return without_shared_borders(self._elastic, self._elastic[0].mesh.points[self.nodes], on)

    @cached_property
    def _part(self) -> Floats:
        """Area (k,) of the part of each of `elements` that is on at least one rigid area."""
        parts = np.array([area.covered[self.elements] for area in self._rigid])
        most, least = parts.sum(axis=0), parts.max(axis=0)
        several = np.flatnonzero(most > least)
        if len(several):
            mesh, along = self._rigid[0].mesh, (np.arange(_ALONG) + 0.5) / _ALONG * 2 - 1
            stations = np.stack(np.meshgrid(along, along), axis=-1).reshape(-1, 2)
            at = np.repeat(self.elements[several], len(stations))
            places = mesh.spread(self.elements[several], stations).reshape(-1, 2)
            within = np.any([(area.covered[at] > 0) & (area.depth(places) >= 0) for area in self._rigid], axis=0)
            part = within.reshape(len(several), -1).mean(axis=1) * mesh.element_area[self.elements[several]]
            most[several] = np.clip(part, least[several], most[several])
        return np.asarray(most)
