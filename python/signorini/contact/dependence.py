"""Which rigid points say the same of the deflection, so that their forces can be shared in more ways than one."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from scipy.sparse import csr_array

from signorini.base.components import components
from signorini.discretise import Discretisation
from signorini.discretise.rank import SAME, followers, lengths, parallel, times, within
from signorini.discretise.rows import Bools, Floats, Ints

_TOUCHING = 1e-9
"""Part of the largest travel by which stops at one place may differ and still perhaps be met together."""


@dataclass(frozen=True, eq=False)
class Dependence:
    """Rigid points whose rows, where no dof is held, are parallel or otherwise dependent.

    Parameters
    ----------
    points : (p,) array
        Positions among all points, repeated ones included.
    rows : (p, 3n) array
        Their rows, held dofs included.
    group, scale : (p,) arrays
        Points whose rows are parallel have one group; its row of length one times the scale is the point's.
    ties : (g, k) array
        Independent combinations of the groups' rows that are zero.
    weights : (p,) array
        What their forces count by: 1 at a point, else length over the root of the plate's area, or area over that.
    even : (g,) array
        Whether rows of a group are parallel where dofs are held, too.
    held_together : tuple of frozenset
        Supports that hold the same nodes, but lines that only meet there.
    """

    points: Ints
    rows: csr_array
    group: Ints
    scale: Floats
    ties: Floats
    weights: Floats
    even: Bools
    held_together: tuple[frozenset[int], ...]

    @classmethod
    def of(cls, found: Discretisation) -> Dependence:
        """Find them, once."""
        if found not in _KNOWN:
            _KNOWN[found] = _dependence(found)
        return _KNOWN[found]


_KNOWN: WeakKeyDictionary[Discretisation, Dependence] = WeakKeyDictionary()


def _dependence(found: Discretisation) -> Dependence:
    points = found.points
    rigid = np.flatnonzero((points.compliance == 0) & ~points.slope)
    whole = found.over_dofs(points.rows[rigid])
    free = within(whole, ~found.held.dofs)
    length = lengths(free)
    group, scale = parallel(free, length)
    level = (points.distance[rigid] - whole @ found.held.values) / scale
    meets = _can_meet(level, np.where(points.one_way[rigid], np.sign(scale), 0.0), group)
    rigid, whole, free, scale, group = rigid[meets], whole[meets], free[meets], scale[meets], group[meets]
    _, first, group, count = np.unique(group, return_index=True, return_inverse=True, return_counts=True)
    units = times(free[first], 1.0 / scale[first])
    ties = _ties(units)

    who, at_points = points.support[rigid], np.array([s.at is not None for s in found.model.support], np.bool_)
    # Forces that move within one line or area are nothing that results tell.
    told = np.zeros(len(first), np.bool_)
    told[group[at_points[who]]] = True
    lowest, highest = np.full(len(first), len(at_points)), np.full(len(first), -1)
    np.minimum.at(lowest, group, who)
    np.maximum.at(highest, group, who)
    ties = ties[:, _tell(ties, told, lowest, highest)]
    mine = ((count > 1) & (told | (lowest < highest)) | ties.any(axis=1))[group]
    kept, group = np.unique(group[mine], return_inverse=True)
    rows, scale = whole[np.flatnonzero(mine)], scale[mine]
    dimension = {"at": 0, "edge": 1, "line": 1, "circle": 1, "area": 2}
    power = np.array([dimension[support.place] for support in found.model.support], np.int64)[who[mine]]
    # Rows of a group over their scales are one row, unless they differ at dofs that are held.
    unit = times(rows, 1.0 / scale)
    _, lead = np.unique(group, return_index=True)
    apart = np.asarray(abs(unit - unit[lead][group]).max(axis=1).todense()).ravel() if len(lead) else np.zeros(0)
    even = np.ones(len(lead), np.bool_)
    even[group[apart > SAME]] = False
    return Dependence(
        rigid[mine],
        rows,
        group,
        scale,
        ties[kept],
        points.weights[rigid[mine]] / np.sqrt(found.mesh.element_area.sum()) ** power,
        even,
        _held_together(found),
    )


def _held_together(found: Discretisation) -> tuple[frozenset[int], ...]:
    # Where two lines meet, each has half of the corner's force: a way to count, no more. A pin there does more.
    nodes, holders = found.held.holders.T
    _, first, count = np.unique(nodes, return_index=True, return_counts=True)
    middles = np.zeros(found.mesh.node_count, np.bool_)
    middles[found.mesh.unique_sides[:, 1]] = True
    sets = set()
    for begin, many in zip(first[count > 1], count[count > 1], strict=True):
        those = holders[begin : begin + many].tolist()
        if middles[nodes[begin]] or any(found.model.support[index].at is not None for index in those):
            sets.add(frozenset(those))
    return tuple(sets)


def repeats_itself(found: Discretisation) -> bool:
    """Whether rows of rigid contact points depend on each other, so that their gaps cannot be chosen freely."""
    contacts = found.contacts
    rigid = np.flatnonzero((contacts.compliance == 0) & ~contacts.slope)
    free = within(found.over_dofs(contacts.rows[rigid]), ~found.held.dofs)
    length = lengths(free)
    group, _ = parallel(free, length)
    return len(set(group.tolist())) < len(group) or bool(_ties(times(free, 1.0 / length)).shape[1])


def _can_meet(level: Floats, side: Floats, group: Ints) -> Bools:
    """Whether a stop is not behind another; ``side`` is +1 where deflections end at its level, −1 where they begin."""
    size = float(np.abs(level).max(initial=0.0))
    count = int(group.max(initial=-1)) + 1
    most, least = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(most, group[side >= 0], level[side >= 0])
    np.maximum.at(least, group[side <= 0], level[side <= 0])
    slack = _TOUCHING * size
    return np.asarray(((side < 0) | (level <= most[group] + slack)) & ((side > 0) | (level >= least[group] - slack)))


def _ties(rows: csr_array) -> Floats:
    """Combinations (g, k) of rows of length one that are zero; each is of few rows where that can be."""
    found = followers(rows)
    ties = -found.combinations.T.toarray()
    ties[found.rows, np.arange(len(found.rows))] = 1.0
    return np.asarray(ties)


def _tell(ties: Floats, told: Bools, lowest: Ints, highest: Ints) -> Bools:
    """Whether a tie, with those that share rows with it, moves forces that results tell."""
    if not ties.shape[1]:
        return np.zeros(0, np.bool_)
    # Ties and rows are the two sides of one graph.
    row, tie = np.nonzero(ties)
    _, label = np.unique(components(sum(ties.shape), row, len(ties) + tie)[len(ties) :], return_inverse=True)
    tells = np.zeros(ties.shape[1], np.bool_)
    for part in range(int(label.max()) + 1):
        rows = (ties[:, label == part] != 0.0).any(axis=1)
        tells[label == part] = told[rows].any() or lowest[rows].min() < highest[rows].max()
    return tells
