"""Division of a discretisation into parts, one for each rank.

A rank has the elements of its part and, around them, every element that shares a node with these. So all rows of K, all
nodal forces Gᵀλ and all residuals f − Ku of the rank's nodes are computed on the rank, as on the whole plate.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from signorini.discretise import CaseLoad, ContactPoints, Discretisation
from signorini.discretise.discretisation import ElementsForCore, elements_for_core
from signorini.discretise.rows import Bools, Floats, Ints, Rows

_PENALTY = 1e4
"""Largest penalty of a rigid point, relative to the shear stiffness of its element; as in the core."""
_FIRST = 0.01
"""First penalty of a rigid point, relative to the shear stiffness times (h/element size)²; as in the core."""


@dataclass(frozen=True, eq=False)
class Division:
    """Division of a mesh of n nodes and ne elements among ranks.

    ``owner`` (ne,) is the rank of each element. ``order`` (n,) are the mesh's nodes in the order of PETSc, rank after
    rank, and ``place`` (n,) the number of each node in this order. ``firsts`` (ranks + 1,) are the
    numbers of the first node of each rank, then n.
    """

    owner: Ints
    order: Ints
    place: Ints
    firsts: Ints

    @classmethod
    def of(cls, discretisation: Discretisation, ranks: int) -> Division:
        """Divide by recursive bisection of the element centroids; a node belongs to the lowest rank of its elements."""
        mesh = discretisation.mesh
        owner = bisected(mesh.points[mesh.elements[:, :4]].mean(axis=1), ranks)
        at_nodes = np.full(mesh.node_count, ranks, np.int64)
        np.minimum.at(at_nodes, mesh.elements.ravel(), np.repeat(owner, 8))
        order = np.argsort(at_nodes, kind="stable")
        place = np.empty_like(order)
        place[order] = np.arange(len(order))
        return cls(owner, order, place, np.searchsorted(at_nodes[order], np.arange(ranks + 1)))


def bisected(points: Floats, ranks: int) -> Ints:
    """Rank (k,) of points (k, 2): sets of points are divided across their longer extent until each rank has one set.

    Examples
    --------
    >>> bisected(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]), 3).tolist()
    [0, 1, 2]
    """
    result = np.zeros(len(points), np.int64)
    if ranks == 1:
        return result
    few = ranks // 2
    order = np.argsort(points[:, int(np.ptp(points, axis=0).argmax())], kind="stable")
    sides = np.split(order, [len(order) * few // ranks])
    for first, count, side in zip((0, few), (few, ranks - few), sides, strict=True):
        result[side] = first + bisected(points[side], count)
    return result


@dataclass(frozen=True, eq=False)
class Part:
    """The arrays of one rank: its n nodes in the order of PETSc, its elements, supports and loads.

    ``places`` (n,) are the nodes' numbers in PETSc, ``owned`` the slice of the nodes that the rank owns. ``mine`` (e,)
    are the elements of the rank; points belong to the rank of their element, and ``points`` (m,) are their numbers in
    the table of all points. ``plate`` are the arguments of `_core.Plate`. ``penalty`` (m,) is the last penalty of rigid
    or nearly rigid contact points, infinite at others; ``first_penalty`` is the first penalty relative to it.
    ``motions`` (3n, 3) are the scaled rigid motions. Lengths and sizes are those of the whole plate.
    """

    places: Ints
    owned: slice
    mine: Bools
    plate: ElementsForCore
    elements: Ints
    held: Bools
    held_values: Floats
    springs: ContactPoints
    contacts: ContactPoints
    points: Ints
    penalty: Floats
    first_penalty: float
    nodal: Floats
    motions: Floats
    size: float
    element_size: float
    bending: tuple[float, float]
    """E h³/12 with the least and the largest thickness h."""
    shear: float
    """E h with the largest thickness h."""
    total: int
    """Number of nodes of the whole mesh."""


def parts_of(discretisation: Discretisation, division: Division, load: CaseLoad) -> Iterator[Part]:
    """Yield the part of each rank, one after another to save memory."""
    mesh, held = discretisation.mesh, discretisation.held
    thickness, young = discretisation.thickness, discretisation.model.young
    for rank in range(len(division.firsts) - 1):
        own = division.owner == rank
        at = np.zeros(mesh.node_count, np.bool_)
        at[mesh.elements[own]] = True
        chosen = np.flatnonzero(at[mesh.elements].any(axis=1))
        places = np.unique(division.place[mesh.elements[chosen]])
        nodes = division.order[places]
        first, last = np.searchsorted(places, division.firsts[rank : rank + 2])
        elements = np.searchsorted(places, division.place[mesh.elements[chosen]])
        number = np.full(len(mesh.elements), -1, np.int64)
        number[chosen] = np.arange(len(chosen))
        springs, _ = _within(discretisation.springs, number)
        contacts, points = _within(discretisation.contacts, number)
        dofs = (3 * nodes[:, None] + np.arange(3)).ravel()
        shear = discretisation.plate_stiffness.in_shear[chosen]
        area = mesh.element_area[chosen]
        stiffness = shear[contacts.rows.elements] * np.where(contacts.slope, area[contacts.rows.elements], 1.0)
        with np.errstate(divide="ignore"):
            penalty = np.where(contacts.compliance * stiffness < 1.0, _PENALTY * stiffness, np.inf)
        yield Part(
            places,
            slice(int(first), int(last)),
            own[chosen],
            _plate(discretisation, nodes, elements, chosen, number),
            elements,
            held.dofs[dofs],
            held.values[dofs],
            springs,
            contacts,
            points,
            penalty,
            _FIRST * float(thickness.min() ** 2 / mesh.element_area.mean()) / _PENALTY,
            load.nodal[dofs],
            discretisation.scaled_motions[dofs],
            mesh.size,
            float(np.sqrt(mesh.element_area.mean())),
            (young * thickness.min() ** 3 / 12, young * thickness.max() ** 3 / 12),
            young * thickness.max(),
            mesh.node_count,
        )


def _within(table: ContactPoints, number: Ints) -> tuple[ContactPoints, Ints]:
    """Points in elements of a part, and their indices (m,) in ``table``; ``number`` is -1 for other elements."""
    which = number[table.rows.elements] >= 0
    kept = table.pick(which)
    rows = Rows(number[kept.rows.elements], kept.rows.coefficients)
    return replace(kept, rows=rows), np.flatnonzero(which)


def _plate(discretisation: Discretisation, nodes: Ints, elements: Ints, chosen: Ints, number: Ints) -> ElementsForCore:
    """Arguments of `_core.Plate` for the ``chosen`` elements, whose nodes in the part are ``elements``."""
    whole = elements_for_core(discretisation.mesh, discretisation.zones, discretisation.thickness, discretisation.held)
    part = whole._replace(points=whole.points[nodes], elements=elements)
    if not isinstance(whole.thickness, float):
        part = part._replace(thickness=whole.thickness[chosen])
    if whole.frames is not None:
        part = part._replace(frames=whole.frames[nodes])
    if whole.layered is not None:
        there = number[whole.layered[0]] >= 0
        part = part._replace(layered=(number[whole.layered[0][there]], whole.layered[1][there]))
    if whole.others is not None:
        part = part._replace(others=(whole.others[0][chosen], *whole.others[1:]))
    return part
