"""Dofs that supports hold at nodes, axes of nodes at which one oblique slope is held, and rigid zones as bodies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Self

import numpy as np
from scipy.sparse import csr_array

from signorini.base.components import components
from signorini.base.remade import Brief
from signorini.discretise.laws import Graphs, can_let_go, partition, settlement_at, slopes_at
from signorini.discretise.meshing import room_beside, sharp_corner, to_follow
from signorini.discretise.placed import Placed
from signorini.discretise.places import edge_nodes, quadratic_tangents
from signorini.discretise.points import ContactPoints
from signorini.discretise.rows import Bools, Floats, Ints, Rows
from signorini.discretise.zones import Zones
from signorini.errors import InputError, Problems, format_place, point
from signorini.mesh import Mesh
from signorini.model import Model

PARALLEL = np.sin(np.radians(10.0))
"""Sine of the largest angle (10°) between directions that count as parallel.

The sides of a curved edge are parabolas, whose tangents are not exactly normal to the radius.
"""
CONSISTENT = 1e-9
"""Relative tolerance for equal settlements, gaps or rotations at one point, since formulas are rounded."""


@dataclass(frozen=True, eq=False)
class Bodies:
    """Rigid bodies of nodes.

    ``leaders`` (n,) is the leader of each node at ``points`` (n, 2); a node in no body is the leader of itself.
    ``inside`` (n,) marks nodes of bodies, leaders included; ``rigid`` (ne,) marks elements whose nodes all belong to
    one body.
    """

    points: Floats
    leaders: Ints
    inside: Bools
    rigid: Bools

    @classmethod
    def of(cls, mesh: Mesh, zones: Zones, problems: Problems) -> Self:
        """Make a body of the nodes of each rigid zone; zones that share a node are one body.

        Elements that are only partly in a rigid zone are reported as problems.
        """
        numbers = [number for number, zone in enumerate(zones.model.zone) if zone.rigid]
        for number in numbers:
            with problems.collected():
                _require_followed(mesh, zones, number)
        elements = mesh.elements[zones.inside[numbers].any(axis=0)]
        if not len(elements):
            none = np.zeros(mesh.node_count, np.bool_), np.zeros(len(mesh.elements), np.bool_)
            return cls(mesh.points, np.arange(mesh.node_count), *none)
        group = components(mesh.node_count, np.repeat(elements[:, 0], 7), elements[:, 1:].ravel())
        first = np.unique(group, return_index=True)[1]
        inside = np.zeros(mesh.node_count, np.bool_)
        inside[elements] = True
        leading = group[mesh.elements]
        rigid = (leading == leading[:, :1]).all(axis=1)
        return cls(mesh.points, first[group], inside, rigid)

    @cached_property
    def motion(self) -> csr_array:
        """B (3n, 3n) of u = B u_leaders: displacements of all nodes from the displacements of their leaders."""
        n, dofs = len(self.points), 3 * self.leaders
        following = np.flatnonzero(self.leaders != np.arange(n))
        arms = self.points[following] - self.points[self.leaders[following]]
        rows = np.concatenate([np.arange(3 * n), np.repeat(3 * following, 2)])
        columns = np.concatenate(
            [(dofs[:, None] + np.arange(3)).ravel(), (dofs[following, None] + np.arange(1, 3)).ravel()]
        )
        return csr_array((np.append(np.ones(3 * n), arms.ravel()), (rows, columns)), shape=(3 * n, 3 * n))

    def onto_leaders(self, rows: csr_array) -> csr_array:
        """G B (m, 3n): rows G over all nodes, expressed by the dofs of their leaders."""
        return csr_array(rows @ self.motion) if self.inside.any() else rows


def _require_followed(mesh: Mesh, zones: Zones, number: int) -> None:
    """Refuse a rigid zone whose outline cuts elements: a part of an element cannot be rigid."""
    cut = np.flatnonzero(zones.parted[number])
    if not len(cut) and zones.inside[number].any():
        return
    where = f" at {point(mesh.points[mesh.elements[cut[0], :4]].mean(axis=0), mesh.size)}" if len(cut) else ""
    region = zones.model.zone[number].region
    advice = to_follow(zones.model, "around it", room_beside(zones.model, region))
    if (sharp := sharp_corner(region)) is not None:
        advice = f"Its corner at {point(sharp, mesh.size)} is sharper than 24°, which meshes cannot follow. Blunt it."
    raise InputError(
        f"The outline of this rigid zone cuts the element{where}, and elements are rigid as a whole. {advice}",
        place=("zone", number, "area"),
    )


@dataclass(frozen=True, eq=False)
class _Slope:
    """Constraint of a support at a node: the slope along ``direction`` (2,) is the product direction · ``rotation``."""

    direction: Floats
    rotation: Floats
    support: int


_Slopes = dict[int, list[_Slope]]
"""Map from nodes to the slope constraints of supports at each node."""


def _settle(mesh: Mesh, bodies: Bodies, deflections: Sequence[Floats], slopes: _Slopes) -> Held:
    """Return the held dofs with their values and frames; refuse nodes at which supports prescribe different values.

    ``deflections`` are tables (k, 4) of node, support, number of the support's point, and deflection.
    """
    points, size = mesh.points, float(np.ptp(mesh.points, axis=0).max())
    held, value = np.zeros((len(points), 3), np.bool_), np.zeros((len(points), 3))
    support = np.full((len(points), 3), -1, dtype=np.int64)
    frames = np.tile([1.0, 0.0], (len(points), 1))
    table = np.concatenate([np.zeros((0, 4)), *deflections])
    pairs, first = np.unique(table[:, :2].astype(np.int64), axis=0, return_index=True)
    (nodes, holders), numbers, values = pairs.T, table[first, 2].astype(np.int64), table[first, 3]
    at_nodes, lead, group = np.unique(nodes, return_index=True, return_inverse=True)
    apart = np.abs(values - values[lead][group])
    if (wrong := apart > rounding_of(float(np.abs(values).max(initial=0.0)), points)).any():
        which = int(np.argmax(wrong))
        raise contradiction(points[nodes[which]], size, holders[lead][group[which]], holders[which], apart[which])
    held[at_nodes, 0], value[at_nodes, 0], support[at_nodes, 0] = True, values[lead], holders[lead]
    for node, own in slopes.items():
        begin = own[0]
        support[node, 1:] = begin.support
        angles = [abs(_cross(begin.direction, other.direction)) for other in own]
        basis = [begin, own[int(np.argmax(angles))]] if max(angles) > PARALLEL else [begin]
        _require_one_rotation(basis, own, points[node])
        x, y = begin.direction
        if len(basis) == 2:
            held[node, 1:] = True
            value[node, 1:] = _rotation_of(basis)
        elif abs(y) < 1e-9 or abs(x) < 1e-9:
            dof = 1 if abs(y) < 1e-9 else 2
            held[node, dof], value[node, dof] = True, begin.rotation[dof - 1]
        else:
            held[node, 1] = True
            frames[node] = begin.direction / np.hypot(x, y)
            value[node, 1] = frames[node] @ begin.rotation
    nowhere, framing = np.full((len(nodes), 4), -1), frames if (frames[:, 1] != 0).any() else None
    where = np.zeros(len(nodes), np.bool_), points[nodes], np.ones(len(nodes)), holders, nowhere, numbers
    of_nodes = ContactPoints.of(Graphs.rigid(values), Rows.at_nodes(mesh.elements, nodes), *where)
    return Held(held.ravel(), value.ravel(), support.ravel(), nodes, of_nodes, framing, bodies)


def rounding_of(largest: float, points: Floats) -> float:
    """Tolerance for equal deflections of at most ``largest``.

    The deflections follow from formulas in the coordinates of points (n, 2), which are rounded.
    """
    size = float(np.ptp(points, axis=0).max())
    return max(CONSISTENT * min(largest, size), float(np.finfo(float).eps * np.abs(points).max()))


def contradiction(position: Floats, size: float, first: int, second: int, difference: float) -> InputError:
    """Error about two supports, given by index, that prescribe different deflections at a position."""
    return InputError(
        f"Supports contradict each other at {point(position, size)}: the deflections that "
        f"{format_place(('support', int(first)))} and {format_place(('support', int(second)))} prescribe there "
        f"differ by {difference:.3g}. Correct a gap or a settlement, or give a stiffness.",
        place=("support", int(second)),
    )


def _cross(a: Floats, b: Floats) -> float:
    return float(a[0] * b[1] - a[1] * b[0])


def _rotation_of(basis: list[_Slope]) -> Floats:
    """The rotation (2,) that has the prescribed slopes along the two directions of ``basis``."""
    directions = np.array([slope.direction for slope in basis])
    slopes = np.array([slope.direction @ slope.rotation for slope in basis])
    return np.asarray(np.linalg.solve(directions, slopes)) if slopes.any() else np.zeros(2)


def _require_one_rotation(basis: list[_Slope], slopes: list[_Slope], position: Floats) -> None:
    """Refuse ``slopes`` that contradict the rotation prescribed by ``basis``; directions within 10° are parallel."""
    largest = max(float(np.abs(slope.rotation).max()) for slope in slopes)
    if largest == 0.0:
        return
    for slope in slopes:
        parallel = next(
            (basis_slope for basis_slope in basis if abs(_cross(basis_slope.direction, slope.direction)) <= PARALLEL),
            None,
        )
        along = slope.direction if parallel is None else parallel.direction
        prescribed = _rotation_of(basis) if parallel is None else parallel.rotation
        if abs(along @ (slope.rotation - prescribed)) > CONSISTENT * largest:
            raise InputError(
                f"found the slopes {point(slope.rotation)} at {point(position)}, where support[{basis[0].support + 1}] "
                f"prescribes {point(prescribed)}. Prescribe the same, or let one of them not hold the slope.",
                place=("support", slope.support, "rotation"),
            )


@dataclass(frozen=True, eq=False, repr=False)
class Held(Brief):
    """Held dofs ``dofs`` (3n,), their ``values`` (3n,), and the nodes' axes.

    ``support`` (3n,) is the index of the first support that holds the dof, −1 if free. ``points`` (k,) are the points
    of all supports that hold a deflection, at ``nodes`` (k,), sorted by node. ``frames`` (n, 2) are the cosine and sine
    of the angle of each node's first axis; None if all axes are x and y. Nodes of ``bodies`` have no held dofs: contact
    points hold them.
    """

    dofs: Bools
    values: Floats
    support: Ints
    nodes: Ints
    points: ContactPoints
    frames: Floats | None
    bodies: Bodies

    def to_global(self, rotations: Floats) -> Floats:
        """Transform rotations (n, 2) from nodal axes to x and y."""
        if self.frames is None:
            return rotations
        c, s = self.frames.T
        first, second = rotations.T
        return np.column_stack([c * first - s * second, s * first + c * second])

    def from_global(self, covector: Floats) -> Floats:
        """Transform nodal couples (n, 2) from x and y to nodal axes."""
        if self.frames is None:
            return covector
        c, s = self.frames.T
        x, y = covector.T
        return np.column_stack([c * x + s * y, c * y - s * x])

    def rigid_motions(self, points: Floats, middle: Floats) -> Floats:
        """Rigid-body modes R (3n, 3) of nodes at points (n, 2): w = 1, x − x0, y − y0, with ``middle`` (x0, y0)."""
        motions = np.zeros((len(points), 3, 3))
        motions[:, 0, 0] = 1.0
        motions[:, 0, 1:] = points - middle
        for i in (0, 1):
            slope = np.zeros((len(points), 2))
            slope[:, i] = 1.0
            motions[:, 1:, 1 + i] = self.from_global(slope)
        return motions.reshape(-1, 3)


def hold(mesh: Mesh, supports: Sequence[Placed], bodies: Bodies, problems: Problems) -> Held:
    """Return the dofs that rigid two-sided supports hold at nodes of the mesh."""
    deflections, slopes = list[Floats](), _Slopes()
    for placed in supports:
        with problems.collected():
            deflections += _collect(mesh, bodies, placed, slopes)
    with problems.collected():
        return _settle(mesh, bodies, deflections, slopes)
    return _settle(mesh, bodies, [], {})


def sides_that_hold_turns(model: Model, mesh: Mesh) -> Ints:
    """Element sides (k, 3) of the edges along which supports hold a slope or a twist, in the order of the supports."""
    held = [mesh.edges[name] for support in model.support if support.holds_rotation for name in support.edge or ()]
    return np.concatenate([np.zeros((0, 3), np.int64), *held])


def held_at(placed: Placed, nodes: Ints, bodies: Bodies) -> Bools:
    """Mask (k,) of a support's points that are held dofs.

    ``nodes`` (k,) are the nodes of the points, −1 for points between nodes. Slave nodes have no dofs of their own.
    """
    support = placed.support
    at_dofs = (nodes >= 0) & ~bodies.inside[nodes] & (support.between is None)
    straight, compliant, tightened = np.array([not can_let_go(support), support.is_elastic, support.is_bolt])
    return partition(straight, compliant, at_dofs, tightened)[0]


def _collect(mesh: Mesh, bodies: Bodies, placed: Placed, slopes: _Slopes) -> Iterator[Floats]:
    """Yield tables (k, 4) of a support's held deflections, see `_settle`; add its held slopes to ``slopes``."""
    support, tangents = placed.support, dict[int, list[tuple[float, float]]]()
    nodes = placed.nodes if placed.sides is None else edge_nodes(mesh, placed.sides)[0]
    (numbers,) = np.nonzero(held_at(placed, nodes, bodies))
    if not len(numbers):
        return
    nodes = nodes[numbers]
    if placed.sides is None and "slope" in support.fixed:
        # A support at points holds the slopes along x and y, which are the normals of these two tangents.
        tangents = {node: [(0.0, 1.0), (-1.0, 0.0)] for node in nodes.tolist()}
    elif placed.sides is not None and support.holds_rotation:
        along, at = tangents_at_nodes(mesh, placed.sides), set(nodes.tolist())
        tangents = {node: directions for node, directions in along.items() if node in at}
    if support.holds_w:
        settlement = settlement_at(support, mesh.points[nodes], placed.place)
        numbers = numbers if placed.sides is None else np.zeros_like(numbers)
        yield np.column_stack([nodes, np.full(len(nodes), placed.index), numbers, settlement])
    rotations = slopes_at(support, mesh.points[list(tangents)], placed.place)
    for (node, directions), rotation in zip(tangents.items(), rotations, strict=True):
        for tx, ty in directions:
            held = [(ty, -tx)] * ("slope" in support.fixed) + [(tx, ty)] * ("twist" in support.fixed)
            slopes.setdefault(node, []).extend(_Slope(np.array(each), rotation, placed.index) for each in held)


def tangents_at_nodes(mesh: Mesh, triples: Ints) -> dict[int, list[tuple[float, float]]]:
    """Map each node of mesh edges to its unit tangents: one tangent if the edge is smooth there, two at a corner."""
    result: dict[int, list[tuple[float, float]]] = {}
    for nodes, units in zip(triples.tolist(), quadratic_tangents(mesh, triples).tolist(), strict=True):
        for node, (tx, ty) in zip(nodes, units, strict=True):
            result.setdefault(node, []).append((tx, ty))
    for node, tangents in result.items():
        if len(tangents) == 2:
            (ax, ay), (bx, by) = tangents
            if abs(ax * by - ay * bx) < PARALLEL:
                sign = 1.0 if ax * bx + ay * by > 0 else -1.0
                x, y = ax + sign * bx, ay + sign * by
                result[node] = [(x / np.hypot(x, y), y / np.hypot(x, y))]
    return result
