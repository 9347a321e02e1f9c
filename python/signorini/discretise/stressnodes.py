"""Nodes of moments and shears: where they jump, one for each side."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from signorini.base.components import components
from signorini.base.remade import Remade
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.discretise.zones import Zones
from signorini.mesh import Location, Mesh
from signorini.mesh.isoparametric import SIDES, real_sides
from signorini.shapes import Region

_BESIDE = 1e-3
"""How far beside a side of an element its thickness is looked up, and at twice that, of the way to its middle."""
_INSIDE = 1e-6
"""How far from a node, towards the middle of the element, thickness is looked up: beyond rounding, near for a taper."""
_SAME = 1e-6
"""Part of the thickness below which it does not jump: of a smooth one that is less than what its curvature makes."""
_ASIDE = 0.05
"""Distance beside a side, relative to that of the element's middle, at which a point is in an area or not."""
_STATIONS = np.array([0.25, 0.75])
"""Stations of a side at which both elements are compared; an outline that crosses the side differs at one alone."""
_ALIKE = 1e-9
"""Part of a number by which that of another side differs in size by rounding, which picks another on every mesh."""


@dataclass(frozen=True, eq=False)
class Sides:
    """Points in each element that they are on: the points' numbers (k,), in order, and where."""

    point: Ints
    where: Location

    def larger(self, values: Floats) -> Floats:
        """Of numbers (..., k, f) of every side the largest in size of each point: (..., q, f).

        Of two that are alike in size, but for rounding, it is the positive one.
        """
        first = np.flatnonzero(np.diff(self.point, prepend=-1))
        if len(first) == len(self.point):
            return values
        high, low = (extreme.reduceat(values, first, axis=-2) for extreme in (np.maximum, np.minimum))
        return np.where(high >= -(1.0 - _ALIKE) * low, high, low)

    def alike(self, values: Floats) -> Floats:
        """Of a thickness (k,) of every side that of each point (q,), NaN where it jumps."""
        first = np.flatnonzero(np.diff(self.point, prepend=-1))
        high, low = (extreme.reduceat(values, first) for extreme in (np.maximum, np.minimum))
        return np.where(high - low <= _SAME * high, low, np.nan)


@dataclass(frozen=True, eq=False, repr=False)
class StressNodes(Remade):
    """Nodes of moments and shears: the mesh's (n,), and behind them further ones (d,) on jumps.

    ``further`` (d,) is the mesh's node that each further one is at: for every node on a jump there is one for each
    further side. ``around`` (k,) are elements that have any of them, ``rows`` (k, 8) the nodes of these. Elements (ne,)
    that are ``left_out`` count in no extreme and no scale of colours: rigid ones, and of zones that say so.
    """

    mesh: Mesh
    further: Ints
    around: Ints
    rows: Ints
    left_out: Bools

    @classmethod
    def of_mesh(cls, mesh: Mesh) -> Self:
        """The nodes of a mesh, where nothing jumps."""
        none = np.zeros(0, np.int64)
        return cls(mesh, none, none, np.zeros((0, 8), np.int64), np.zeros(len(mesh.elements), np.bool_))

    def counting(self, count: int) -> Bools:
        """Which of the mesh's nodes (n,), or of these nodes (s,), are of an element that is not left out; else all."""
        elements = self.elements if count == self.count else self.mesh.elements
        result = np.zeros(count, np.bool_)
        result[elements[~self.left_out]] = True
        return result if result.any() else ~result

    @cached_property
    def nodes(self) -> Ints:
        """The mesh's node (n + d,) that each is at."""
        return np.concatenate([np.arange(self.mesh.node_count), self.further])

    @cached_property
    def points(self) -> Floats:
        """Their positions (n + d, 2)."""
        return np.asarray(self.mesh.points[self.nodes])

    @cached_property
    def elements(self) -> Ints:
        """The elements (ne, 8) by these nodes."""
        elements = self.mesh.elements
        if len(self.further):
            elements = elements.copy()
            elements[self.around] = self.rows
        return elements

    @property
    def count(self) -> int:
        """Number of nodes, n + d."""
        return self.mesh.node_count + len(self.further)

    def spread(self, values: Floats) -> Floats:
        """Give nodal values (n, ...), or those at these nodes (s, ...), at these nodes."""
        return values if len(values) == self.count else np.asarray(values[self.nodes])

    def at(self, sides: Sides, values: Floats) -> Floats:
        """Interpolate values (s, ...) at nodes of stresses to points on every side of a jump: (k, ...)."""
        shapes = self.mesh.shape_functions(sides.where.elements, sides.where.xi)
        return np.asarray(np.einsum("qi,qi...->q...", shapes, values[self.elements[sides.where.elements]]))

    def sides(self, positions: Floats, where: Location) -> Sides:
        """Find points (q, 2) of the mesh, whose first elements are known, on every side of a jump."""
        if not len(self.further):
            return Sides(np.arange(len(positions)), where)
        return Sides(*self.mesh.holding(positions))


def stress_nodes_of(
    mesh: Mesh, zones: Zones, along: Iterable[Ints], areas: Sequence[Region], rigid: Bools
) -> StressNodes:
    """Part nodes on jumps: elements around a node that meet in sides without a jump have it in common.

    Moments and shears jump with the section, and at rigid elements (ne,). Shears jump along sides (k, 3) that carry a
    line force, and along the outlines of rigid areas, which do too. Moments jump where such a support holds a slope.
    """
    own = replace(StressNodes.of_mesh(mesh), left_out=rigid | zones.without_extremes)
    on_lines = np.concatenate([np.zeros(0, np.int64), *(sides[:, 1] for sides in along)])
    uniform = not zones.model.zone and not any(level.jumps for level in zones.formulas[0].levels)
    if uniform and not len(on_lines) and not areas:
        return own
    sides = np.flatnonzero(real_sides(mesh.elements).ravel())
    triples = mesh.sides.reshape(-1, 3)
    order = sides[np.argsort(triples[sides, 1], kind="stable")]
    second = np.flatnonzero(triples[order[1:], 1] == triples[order[:-1], 1])
    pairs = np.column_stack([order[second], order[second + 1]])
    jumps = _jumps(mesh, zones, pairs) | np.isin(triples[pairs[:, 0], 1], on_lines)
    jumps |= rigid[pairs[:, 0] // 4] != rigid[pairs[:, 1] // 4]
    for area in areas:
        jumps |= _on_outline(mesh, area, pairs)
    if not jumps.any():
        return own
    return _parted(own, pairs[~jumps], np.unique(triples[pairs[jumps, 0]]))


def solid_thickness(nodes: StressNodes, zones: Zones) -> Floats:
    """Thickness (s,) at nodes of stresses, NaN where a section is given by its stiffness: it has no stresses."""
    mesh = nodes.mesh
    if not zones.model.zone and zones.formulas[0].is_constant:
        solid = zones.model.plate.stiffness is None
        return np.full(nodes.count, zones.formulas[0].value if solid else np.nan)
    elements, sides = np.nonzero(real_sides(mesh.elements))
    begin, end = mesh.corners_of_sides(elements, sides)
    xi = np.stack([begin, 0.5 * (begin + end), end], axis=1).reshape(-1, 2)
    of_element, of_node = np.repeat(elements, 3), nodes.elements[elements[:, None], np.array(SIDES)[sides]].ravel()
    beside = zones.solid(of_element, mesh.map(of_element, mesh.inward(of_element, xi, 1.0 - _INSIDE)))
    return np.asarray(np.bincount(of_node, beside, nodes.count) / np.bincount(of_node, minlength=nodes.count))


def _jumps(mesh: Mesh, zones: Zones, pairs: Ints) -> Bools:
    """Whether what the plate is made of jumps between elements, at sides (k, 2) that are in two of them."""
    begin, end = mesh.corners_of_sides(pairs.ravel() // 4, pairs.ravel() % 4)
    elements, middle = pairs.ravel() // 4, 0.5 * (begin + end)
    near, far = (
        _made(mesh, zones, elements, mesh.inward(elements, middle, 1.0 - part)) for part in (_BESIDE, 2.0 * _BESIDE)
    )
    # At the side itself, but for what curvature makes: of a taper nothing.
    thickness = (2.0 * near[0] - far[0]).reshape(-1, 2)
    differs = np.abs(np.diff(thickness, axis=1)[:, 0]) > _SAME * thickness.max(axis=1)
    return np.asarray(differs | (np.diff(near[1].reshape(-1, 2), axis=1)[:, 0] != 0))


def _on_outline(mesh: Mesh, area: Region, pairs: Ints) -> Bools:
    """Whether an area covers the element on one side alone, at sides (k, 2) that are in two of them."""
    elements = np.repeat(pairs.ravel() // 4, 2)
    begin, end = (np.repeat(ends, 2, axis=0) for ends in mesh.corners_of_sides(pairs.ravel() // 4, pairs.ravel() % 4))
    # The second element runs along the side the other way.
    station = np.stack([_STATIONS, _STATIONS[::-1]])[np.arange(pairs.size) % 2].ravel()[:, None]
    beside = mesh.inward(elements, begin + station * (end - begin), 1.0 - _ASIDE)
    covered = area.contains(mesh.map(elements, beside)).reshape(-1, 2, 2)
    return np.asarray((covered[:, 0] != covered[:, 1]).all(axis=1))


def _made(mesh: Mesh, zones: Zones, elements: Ints, xi: Floats) -> tuple[Floats, Ints]:
    points = mesh.map(elements, xi)
    made = zones.at(elements, points)
    return zones.thickness(made, points), made.rigidity


def _parted(own: StressNodes, joined: Ints, nodes: Ints) -> StressNodes:
    """Part nodes (j,) between elements that no sides (k, 2) without a jump join there."""
    mesh = own.mesh
    count = mesh.node_count
    on_jump = np.zeros(count, np.bool_)
    on_jump[nodes] = True
    # Of every element the nodes on jumps, once: a triangle repeats one.
    element, local = np.nonzero(on_jump[mesh.elements])
    keys, place = np.unique(mesh.elements[element, local] + count * element, return_inverse=True)
    triples = mesh.sides.reshape(-1, 3)[joined[:, 0]]
    side, which = np.nonzero(on_jump[triples])
    one, other = (np.searchsorted(keys, triples[side, which] + count * (joined[side, i] // 4)) for i in range(2))
    group = components(len(keys), one, other)
    # Of a node's groups that of the first element keeps the node's number.
    node = keys % count
    first = np.full(group.max() + 1, len(keys))
    np.minimum.at(first, group, np.arange(len(keys)))
    by_node = np.lexsort((first, node[first]))
    further = np.append(False, np.diff(node[first][by_node]) == 0)
    number = np.empty(len(first), np.int64)
    number[by_node] = np.where(further, count - 1 + np.cumsum(further), node[first][by_node])
    around, row = np.unique(element, return_inverse=True)
    rows = mesh.elements[around]
    rows[row, local] = number[group[place]]
    return replace(own, further=node[first][by_node][further], around=around, rows=rows)
