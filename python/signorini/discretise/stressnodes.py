"""Stress nodes, at which moments and shears are given; a mesh node on a jump has one stress node for each side."""

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
"""Distance from an element side at which the thickness beside the side is evaluated.

It is relative to the distance of the element's middle.
"""
_INSIDE = 1e-6
"""Distance from a node at which the thickness at the node is evaluated, relative to that of the element's middle."""
_SAME = 1e-6
"""Smallest jump of the thickness that counts as a step, relative to the thickness.

Extrapolation of a smooth thickness has a smaller error.
"""
_ASIDE = 0.05
"""Distance from an element side of points that are tested against an area.

It is relative to the distance of the element's middle from the side.
"""
_STATIONS = np.array([0.25, 0.75])
"""Positions along a side, from 0 to 1, beside which both elements are tested against an area.

An outline along the side separates the two elements at both positions, an outline across the side at one.
"""
_ALIKE = 1e-9
"""Relative tolerance for equal magnitudes on two sides of a jump.

Without a tolerance, rounding would choose the side.
"""


@dataclass(frozen=True, eq=False)
class Sides:
    """Pairs (k,) of a point and an element that contains the point: index of the point, ascending, and location."""

    point: Ints
    where: Location

    def larger(self, values: Floats) -> Floats:
        """For each point, the value of largest magnitude (..., q, f) among the values (..., k, f) of its pairs.

        If two magnitudes are equal up to rounding, the positive value is taken.
        """
        first = np.flatnonzero(np.diff(self.point, prepend=-1))
        if len(first) == len(self.point):
            return values
        high, low = (extreme.reduceat(values, first, axis=-2) for extreme in (np.maximum, np.minimum))
        return np.where(high >= -(1.0 - _ALIKE) * low, high, low)

    def alike(self, values: Floats) -> Floats:
        """Thickness (q,) at each point, from the thickness (k,) in its pairs; NaN where the thickness jumps."""
        first = np.flatnonzero(np.diff(self.point, prepend=-1))
        high, low = (extreme.reduceat(values, first) for extreme in (np.maximum, np.minimum))
        return np.where(high - low <= _SAME * high, low, np.nan)


@dataclass(frozen=True, eq=False, repr=False)
class StressNodes(Remade):
    """Nodes of moments and shears: the n nodes of the mesh, followed by d further nodes on jumps, s = n + d.

    A mesh node on a jump has one stress node for each side; ``further`` (d,) is the mesh node of each further node.
    ``around`` (k,) are the elements with further nodes, ``rows`` (k, 8) the stress nodes of these elements. Elements
    marked in ``left_out`` (ne,) are excluded from extremes and colour scales: rigid elements, and elements of zones
    with ``extremes = false``.
    """

    mesh: Mesh
    further: Ints
    around: Ints
    rows: Ints
    left_out: Bools

    @classmethod
    def of_mesh(cls, mesh: Mesh) -> Self:
        """Stress nodes of a mesh without jumps, equal to the mesh nodes."""
        none = np.zeros(0, np.int64)
        return cls(mesh, none, none, np.zeros((0, 8), np.int64), np.zeros(len(mesh.elements), np.bool_))

    def counting(self, count: int) -> Bools:
        """Mask of mesh nodes (n,) or stress nodes (s,) that count in extremes; all if every element is left out."""
        elements = self.elements if count == self.count else self.mesh.elements
        result = np.zeros(count, np.bool_)
        result[elements[~self.left_out]] = True
        return result if result.any() else ~result

    @cached_property
    def nodes(self) -> Ints:
        """Mesh node (s,) of each stress node."""
        return np.concatenate([np.arange(self.mesh.node_count), self.further])

    @cached_property
    def points(self) -> Floats:
        """Positions (s, 2) of the stress nodes."""
        return np.asarray(self.mesh.points[self.nodes])

    @cached_property
    def elements(self) -> Ints:
        """Stress nodes (ne, 8) of each element."""
        elements = self.mesh.elements
        if len(self.further):
            elements = elements.copy()
            elements[self.around] = self.rows
        return elements

    @property
    def count(self) -> int:
        """Number of stress nodes, s = n + d."""
        return self.mesh.node_count + len(self.further)

    def spread(self, values: Floats) -> Floats:
        """Values (s, ...) at stress nodes; the given values are at mesh nodes (n, ...) or at stress nodes (s, ...)."""
        return values if len(values) == self.count else np.asarray(values[self.nodes])

    def at(self, sides: Sides, values: Floats) -> Floats:
        """Values (k, ...) at k pairs of a point and an element, interpolated from values (s, ...) at stress nodes."""
        shapes = self.mesh.shape_functions(sides.where.elements, sides.where.xi)
        return np.asarray(np.einsum("qi,qi...->q...", shapes, values[self.elements[sides.where.elements]]))

    def sides(self, positions: Floats, where: Location) -> Sides:
        """Locate points (q, 2) in every element that contains them; ``where`` locates each point in one element."""
        if not len(self.further):
            return Sides(np.arange(len(positions)), where)
        return Sides(*self.mesh.holding(positions))


def stress_nodes_of(
    mesh: Mesh, zones: Zones, along: Iterable[Ints], areas: Sequence[Region], rigid: Bools
) -> StressNodes:
    """Split mesh nodes on jumps: elements around a node share a stress node if sides without a jump connect them.

    Moments and shears jump with the section, and at rigid elements (ne,). Shears jump along sides (k, 3) with a line
    force, and along the outlines of rigid areas. Moments jump along a line on which a support holds the slope.
    """
    nodes = replace(StressNodes.of_mesh(mesh), left_out=rigid | zones.without_extremes)
    on_lines = np.concatenate([np.zeros(0, np.int64), *(sides[:, 1] for sides in along)])
    uniform = not zones.model.zone and not any(level.jumps for level in zones.formulas[0].levels)
    if uniform and not len(on_lines) and not areas:
        return nodes
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
        return nodes
    return _parted(nodes, pairs[~jumps], np.unique(triples[pairs[jumps, 0]]))


def solid_thickness(nodes: StressNodes, zones: Zones) -> Floats:
    """Thickness (s,) at stress nodes; NaN where a section is given by its stiffness, so that it has no stresses."""
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
    """Mask (k,) of sides at which the section jumps; ``pairs`` (k, 2) are 4·element + side in both elements."""
    begin, end = mesh.corners_of_sides(pairs.ravel() // 4, pairs.ravel() % 4)
    elements, middle = pairs.ravel() // 4, 0.5 * (begin + end)
    nearer, farther = (
        _made(mesh, zones, elements, mesh.inward(elements, middle, 1.0 - part)) for part in (_BESIDE, 2.0 * _BESIDE)
    )
    # Linear extrapolation to the side is exact for a linear thickness.
    thickness = (2.0 * nearer[0] - farther[0]).reshape(-1, 2)
    differs = np.abs(np.diff(thickness, axis=1)[:, 0]) > _SAME * thickness.max(axis=1)
    return np.asarray(differs | (np.diff(nearer[1].reshape(-1, 2), axis=1)[:, 0] != 0))


def _on_outline(mesh: Mesh, area: Region, pairs: Ints) -> Bools:
    """Mask (k,) of sides of which an area covers only one of both elements; ``pairs`` are as in `_jumps`."""
    elements = np.repeat(pairs.ravel() // 4, 2)
    begin, end = (np.repeat(ends, 2, axis=0) for ends in mesh.corners_of_sides(pairs.ravel() // 4, pairs.ravel() % 4))
    # The second of the two elements at a side traverses this side in the opposite direction.
    station = np.stack([_STATIONS, _STATIONS[::-1]])[np.arange(pairs.size) % 2].ravel()[:, None]
    beside = mesh.inward(elements, begin + station * (end - begin), 1.0 - _ASIDE)
    covered = area.contains(mesh.map(elements, beside)).reshape(-1, 2, 2)
    return np.asarray((covered[:, 0] != covered[:, 1]).all(axis=1))


def _made(mesh: Mesh, zones: Zones, elements: Ints, xi: Floats) -> tuple[Floats, Ints]:
    points = mesh.map(elements, xi)
    section = zones.at(elements, points)
    return zones.thickness(section, points), section.rigidity


def _parted(stress_nodes: StressNodes, joined: Ints, nodes: Ints) -> StressNodes:
    """Split nodes (j,): one stress node for each group of elements around the node that ``joined`` sides connect.

    ``joined`` are pairs of sides without a jump.
    """
    mesh = stress_nodes.mesh
    count = mesh.node_count
    on_jump = np.zeros(count, np.bool_)
    on_jump[nodes] = True
    # Pairs (element, node on a jump), each once: a triangle repeats a node.
    element, local = np.nonzero(on_jump[mesh.elements])
    keys, place = np.unique(mesh.elements[element, local] + count * element, return_inverse=True)
    triples = mesh.sides.reshape(-1, 3)[joined[:, 0]]
    side, which = np.nonzero(on_jump[triples])
    first_entry, second_entry = (
        np.searchsorted(keys, triples[side, which] + count * (joined[side, i] // 4)) for i in range(2)
    )
    group = components(len(keys), first_entry, second_entry)
    # At each node, the group with the first element keeps the mesh node's index.
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
    return replace(stress_nodes, further=node[first][by_node][further], around=around, rows=rows)
