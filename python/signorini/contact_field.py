"""Contact of an elastic area, from the deflection field rather than from its quadrature points."""

from __future__ import annotations

import numpy as np

from signorini import _core
from signorini.discretise.places import region
from signorini.discretise.rows import Bools, Floats, Ints
from signorini.mesh import Mesh
from signorini.model import Support

_CELLS = 12
"""Cells a direction into which an element with the edge of contact in it is cut; linear in each of their halves."""
_WHOLE = 1.0 - 1e-9


def largest_pressure(mesh: Mesh, support: Support, deflection: Floats) -> float:
    """Largest pressure of an elastic area at the nodes in it; 0 where it holds down only."""
    assert support.stiffness is not None
    if support.resists == "up":
        return 0.0
    within = region(support.area)
    nodes = np.ones(mesh.node_count, np.bool_) if within is None else within.contains(mesh.points)
    x, y = mesh.points[nodes].T
    pressure = support.stiffness(x, y) * (deflection[nodes] - support.settlement(x, y) - support.gap(x, y))
    return float(pressure.max(initial=0.0))


def contact_area(
    mesh: Mesh, support: Support, deflection: Floats, elements: Ints, weights: Floats, closed: Bools
) -> float:
    """Area in contact.

    Parameters
    ----------
    mesh : Mesh
    support : Support
        On an area, one-sided and elastic.
    deflection : (n,) array
    elements, weights, closed : (q,) arrays
        Quadrature points of the area: element, area they stand for, whether closed.

    Returns
    -------
    float
        Elements with every point closed count whole. In those that lie wholly in the support and have the edge of
        contact in them the area is measured on a grid finer than the points; elsewhere closed points are summed.
    """
    count = len(mesh.elements)
    covered = np.bincount(elements, weights, count)
    touching = np.bincount(elements, weights * closed, count)
    whole = (covered > 0) & (covered >= _WHOLE * mesh.element_area)
    mixed = np.flatnonzero(whole & _may_be_cut(mesh, support, deflection))
    return float(touching.sum() - touching[mixed].sum() + _measured(mesh, support, deflection, mixed).sum())


def _opening(support: Support, w: Floats, x: Floats, y: Floats) -> Floats:
    """Positive where the plate presses."""
    sign = -1.0 if support.resists == "up" else 1.0
    return np.asarray(sign * (w - support.settlement(x, y)) - support.gap(x, y))


def _may_be_cut(mesh: Mesh, support: Support, deflection: Floats) -> Bools:
    at_nodes = _opening(support, deflection, *mesh.points.T)[mesh.elements]
    return np.asarray((at_nodes.min(axis=1) < 0) & (at_nodes.max(axis=1) > 0))


def _measured(mesh: Mesh, support: Support, deflection: Floats, elements: Ints) -> Floats:
    """Area (k,) of contact in elements (k,): each cell's two triangles are cut by the linear field through corners."""
    line = np.linspace(-1.0, 1.0, _CELLS + 1)
    xi = np.stack(np.meshgrid(line, line, indexing="ij"), axis=-1).reshape(-1, 2)
    values, _ = _core.serendipity(xi)
    positions = np.einsum("qi,kid->kqd", values, mesh.nodes[elements])
    w = deflection[mesh.elements[elements]] @ values.T
    pressing = _opening(support, w, positions[..., 0], positions[..., 1])
    grid = np.arange((_CELLS + 1) ** 2).reshape(_CELLS + 1, _CELLS + 1)
    a, b, c, d = grid[:-1, :-1].ravel(), grid[1:, :-1].ravel(), grid[1:, 1:].ravel(), grid[:-1, 1:].ravel()
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    corner = positions[:, triangles]
    u, v = corner[:, :, 1] - corner[:, :, 0], corner[:, :, 2] - corner[:, :, 0]
    area = 0.5 * np.abs(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
    inside = (area * _positive_part(np.sort(pressing[:, triangles], axis=-1))).sum(axis=1)
    # The chords of curved sides leave out a little of the element; the whole of it is known.
    return np.asarray(inside * mesh.element_area[elements] / area.sum(axis=1))


def _positive_part(values: Floats) -> Floats:
    """Part of a triangle where the linear function through its sorted corner values (..., 3) is positive."""
    low, middle, high = np.moveaxis(values, -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        one_above = high**2 / ((high - low) * (high - middle))
        two_above = 1.0 - low**2 / ((high - low) * (middle - low))
    part = np.where(middle > 0, two_above, one_above)
    return np.asarray(np.where(low >= 0, 1.0, np.where(high <= 0, 0.0, part)))
