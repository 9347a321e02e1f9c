"""Which dofs supports hold at nodes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from signorini.discretise.bodies import Bodies
from signorini.discretise.frames import PARALLEL, Held, Holds
from signorini.discretise.placed import Placed
from signorini.discretise.places import edge_nodes, quadratic_tangents
from signorini.discretise.rows import Floats, Ints
from signorini.errors import Problems
from signorini.mesh import Mesh
from signorini.model import Support


def hold(mesh: Mesh, supports: Sequence[Placed], bodies: Bodies, problems: Problems) -> Held:
    """Dofs that supports hold at nodes: bilateral, rigid, and where the mesh has nodes for them."""
    holds = Holds(bodies)
    for placed in supports:
        with problems.collected():
            if placed.sides is not None:
                _hold_along(mesh, holds, placed, placed.sides)
            elif placed.points is not None:
                _hold_points(mesh, holds, placed)
    with problems.collected():
        return holds.settle()
    return Holds(bodies).settle()


def holds_deflection(support: Support) -> bool:
    """Whether a support holds the deflection both ways, rigidly and without a gap."""
    no_gap = support.gap.is_constant and support.gap.value == 0
    return support.stiffness is None and ("w" in support.fixed or (support.resists == "both" and no_gap))


def prescribed_rotations(placed: Placed, positions: Floats) -> Floats:
    """Slopes θx, θy (q, 2) at which a support holds those that it holds."""
    rotation = placed.support.rotation
    if rotation is None:
        return np.zeros((len(positions), 2))
    return np.column_stack([one(*positions.T, place=(*placed.place, "rotation")) for one in rotation])


def _hold_along(mesh: Mesh, holds: Holds, placed: Placed, sides: Ints) -> None:
    support, index = placed.support, placed.index
    if holds_deflection(support):
        nodes = edge_nodes(mesh, sides).nodes
        _hold_deflections(mesh, holds, placed, nodes, np.zeros_like(nodes))
    if not {"slope", "twist"} & set(support.fixed):
        return
    tangents = tangents_at_nodes(mesh, sides)
    rotations = prescribed_rotations(placed, mesh.points[list(tangents)])
    for (node, directions), rotation in zip(tangents.items(), rotations, strict=True):
        for tx, ty in directions:
            if "slope" in support.fixed:
                holds.slope(node, (ty, -tx), rotation, index)
            if "twist" in support.fixed:
                holds.slope(node, (tx, ty), rotation, index)


def _hold_points(mesh: Mesh, holds: Holds, placed: Placed) -> None:
    (numbers,) = np.nonzero(placed.nodes >= 0)
    nodes = placed.nodes[numbers]
    if holds_deflection(placed.support):
        _hold_deflections(mesh, holds, placed, nodes, numbers)
    if "slope" in placed.support.fixed:
        rotations = prescribed_rotations(placed, mesh.points[nodes])
        for node, rotation in zip(nodes.tolist(), rotations, strict=True):
            holds.slope(node, (1.0, 0.0), rotation, placed.index)
            holds.slope(node, (0.0, 1.0), rotation, placed.index)


def _hold_deflections(mesh: Mesh, holds: Holds, placed: Placed, nodes: Ints, numbers: Ints) -> None:
    settlement = placed.support.settlement(*mesh.points[nodes].T, place=(*placed.place, "settlement"))
    for node, value, number in zip(nodes.tolist(), settlement.tolist(), numbers.tolist(), strict=True):
        holds.deflection(node, value, placed.index, number)


def tangents_at_nodes(mesh: Mesh, triples: Ints) -> dict[int, list[tuple[float, float]]]:
    """Tangents at every node of mesh edges: one where they run on smoothly, two where they turn a corner."""
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
