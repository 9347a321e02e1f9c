"""Which dofs supports hold at nodes."""

from __future__ import annotations

import numpy as np

from signorini.discretise.frames import PARALLEL, Held, Holds
from signorini.discretise.places import Sampled, edge_nodes, located, mesh_edges, quadratic_tangents
from signorini.discretise.rows import Floats, Ints
from signorini.mesh import Mesh
from signorini.model import Model, Support

_SAME_NODE = 1e-9


def hold(model: Model, mesh: Mesh) -> Held:
    """Dofs that supports hold at nodes: bilateral, rigid, and where the mesh has nodes for them."""
    holds = Holds(mesh.node_count)
    for index, support in enumerate(model.support):
        if support.place in ("edge", "line", "circle"):
            _hold_along(mesh, holds, index, support)
        elif support.place == "at":
            _hold_points(mesh, holds, index, support)
    return holds.settle(mesh.points)


def holds_deflection(support: Support) -> bool:
    """Whether a support holds the deflection both ways, rigidly and without a gap."""
    no_gap = support.gap.is_constant and support.gap.value == 0
    return support.stiffness is None and ("w" in support.fixed or (support.resists == "both" and no_gap))


def prescribed_rotations(support: Support, positions: Floats, place: str) -> Floats:
    """Slopes θx, θy (q, 2) at which a support holds those that it holds."""
    if support.rotation is None:
        return np.zeros((len(positions), 2))
    return np.column_stack([one(*positions.T, place=f"{place}.rotation") for one in support.rotation])


def nodes_at(mesh: Mesh, sampled: Sampled) -> Ints:
    """Node (q,) that each point coincides with, −1 where there is none."""
    nodes = mesh.elements[sampled.elements]
    offset = mesh.points[nodes] - sampled.positions[:, None]
    distance = np.hypot(offset[..., 0], offset[..., 1])
    picked = np.arange(len(nodes)), distance.argmin(axis=1)
    return np.where(distance[picked] <= _SAME_NODE * mesh.size, nodes[picked], -1)


def _hold_along(mesh: Mesh, holds: Holds, index: int, support: Support) -> None:
    triples = mesh_edges(mesh, support, f"support[{index + 1}]")
    if triples is None:
        return
    if holds_deflection(support):
        _hold_deflections(mesh, holds, index, support, edge_nodes(mesh, triples).nodes)
    if not {"slope", "twist"} & set(support.fixed):
        return
    tangents = _tangents(mesh, triples)
    rotations = prescribed_rotations(support, mesh.points[list(tangents)], f"support[{index + 1}]")
    for (node, directions), rotation in zip(tangents.items(), rotations, strict=True):
        for tx, ty in directions:
            if "slope" in support.fixed:
                holds.slope(node, (ty, -tx), rotation, index)
            if "twist" in support.fixed:
                holds.slope(node, (tx, ty), rotation, index)


def _hold_points(mesh: Mesh, holds: Holds, index: int, support: Support) -> None:
    assert support.at is not None
    sampled = located(mesh, support.at, f"support[{index + 1}]")
    nodes = nodes_at(mesh, sampled)
    nodes = nodes[nodes >= 0]
    if holds_deflection(support):
        _hold_deflections(mesh, holds, index, support, nodes)
    if "slope" in support.fixed:
        rotations = prescribed_rotations(support, mesh.points[nodes], f"support[{index + 1}]")
        for node, rotation in zip(nodes.tolist(), rotations, strict=True):
            holds.slope(node, (1.0, 0.0), rotation, index)
            holds.slope(node, (0.0, 1.0), rotation, index)


def _hold_deflections(mesh: Mesh, holds: Holds, index: int, support: Support, nodes: Ints) -> None:
    settlement = support.settlement(*mesh.points[nodes].T, place=f"support[{index + 1}].settlement")
    for node, value in zip(nodes.tolist(), settlement.tolist(), strict=True):
        holds.deflection(node, value, index)


def _tangents(mesh: Mesh, triples: Ints) -> dict[int, list[tuple[float, float]]]:
    """Tangents at every node of mesh edges: one where they run on smoothly, two where they turn a corner."""
    found: dict[int, list[tuple[float, float]]] = {}
    for nodes, units in zip(triples.tolist(), quadratic_tangents(mesh, triples).tolist(), strict=True):
        for node, (tx, ty) in zip(nodes, units, strict=True):
            found.setdefault(node, []).append((tx, ty))
    for node, tangents in found.items():
        if len(tangents) == 2:
            (ax, ay), (bx, by) = tangents
            if abs(ax * by - ay * bx) < PARALLEL:
                sign = 1.0 if ax * bx + ay * by > 0 else -1.0
                x, y = ax + sign * bx, ay + sign * by
                found[node] = [(x / np.hypot(x, y), y / np.hypot(x, y))]
    return found
