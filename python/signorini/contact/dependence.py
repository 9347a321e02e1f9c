"""Which rigid points say the same of the deflection, so that their forces can be shared in more ways than one."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from scipy.sparse import csr_array

from signorini.base.components import components
from signorini.discretise import Discretisation
from signorini.discretise.rows import Bools, Floats, Ints

_SAME = 1e-12
"""Part of a row below which what is left of it is rounding: rows are right to about 1e-15, and points a billionth of an
element apart are told apart all the same."""
_TOUCHING = 1e-9
"""Part of the largest travel by which stops at one place may differ and still perhaps be met together."""
_TELLS = 1e-10
"""Products of rows tell independent ones from others down to this pivot; below, the rows themselves are asked."""


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
        What their forces count by: 1 at a point, else length or area over the plate's size, to its power.
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
    whole = points.rows[rigid].matrix(found.mesh.elements, found.dof_count)
    free = _within(whole, ~found.held.dofs)
    length = np.sqrt(np.asarray(free.multiply(free).sum(axis=1)).ravel())
    group, scale = _parallel(free, length)
    level = (points.distance[rigid] - whole @ found.held.values) / scale
    meets = _can_meet(level, np.where(points.two_sided[rigid], 0.0, np.sign(scale)), group)
    rigid, whole, free, scale, group = rigid[meets], whole[meets], free[meets], scale[meets], group[meets]
    _, first, group, count = np.unique(group, return_index=True, return_inverse=True, return_counts=True)
    units = _times(free[first], 1.0 / scale[first])
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
    unit = _times(rows, 1.0 / scale)
    _, lead = np.unique(group, return_index=True)
    apart = np.asarray(abs(unit - unit[lead][group]).max(axis=1).todense()).ravel() if len(lead) else np.zeros(0)
    even = np.ones(len(lead), np.bool_)
    even[group[apart > _SAME]] = False
    return Dependence(
        rigid[mine],
        rows,
        group,
        scale,
        ties[kept],
        points.weights[rigid[mine]] / found.mesh.size**power,
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
    free = _within(contacts.rows[rigid].matrix(found.mesh.elements, found.dof_count), ~found.held.dofs)
    length = np.sqrt(np.asarray(free.multiply(free).sum(axis=1)).ravel())
    group, _ = _parallel(free, length)
    return len(set(group.tolist())) < len(group) or bool(_ties(_times(free, 1.0 / length)).shape[1])


def _within(rows: csr_array, dofs: Bools) -> csr_array:
    """Rows where they are not rounding, and only on some dofs."""
    rows = csr_array(rows, copy=True)
    rows.data[~dofs[rows.indices] | (np.abs(rows.data) <= _SAME)] = 0.0
    rows.eliminate_zeros()
    return rows


def _times(rows: csr_array, factor: Floats) -> csr_array:
    out = csr_array(rows, copy=True)
    out.data *= np.repeat(factor, np.diff(out.indptr))
    return out


def _parallel(rows: csr_array, length: Floats) -> tuple[Ints, Floats]:
    """Number the directions (p,) of rows, and their lengths (p,) along these, of either sign."""
    # Two rows are parallel where they say the same of two fields that no row was made for.
    random = np.random.default_rng(0)
    fields = random.normal(size=(rows.shape[1], 2))
    said = (rows @ fields) / length[:, None]
    sign = np.where(said[:, 0] < 0, -1.0, 1.0)
    said *= sign[:, None]
    order = np.argsort(said[:, 0], kind="stable")
    new = np.append(True, (np.abs(np.diff(said[order], axis=0)) > _SAME).any(axis=1))
    group = np.empty(len(length), np.int64)
    group[order] = np.cumsum(new) - 1 if len(order) else 0
    return group, sign * length


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
    left = _entangled(rows)
    if not len(left):
        return np.zeros((rows.shape[0], 0))
    rows_left = rows[left]
    products = rows_left @ rows_left.T
    if _clearly_independent(products):
        return np.zeros((rows.shape[0], 0))
    # What follows needs scipy.linalg, which takes a while to read; most plates do not come here.
    from scipy.linalg import lapack, solve_triangular

    parts, near = [], products.tocoo()
    label = components(len(left), *near.coords)
    for part in range(int(label.max()) + 1):
        mine = np.flatnonzero(label == part)
        own = rows_left[mine]
        own = own[:, np.unique(own.indices)]
        factor, pivots, rank, _ = lapack.dpstrf((own @ own.T).toarray(), lower=1, tol=_TELLS)
        if rank == len(mine):
            continue
        order = pivots.astype(np.int64) - 1
        kept, rest = order[:rank], order[rank:]
        lower = factor[:rank, :rank]
        # Dense beside sparse, and transposed: a column for each of the rest, a row for each dof that they touch.
        of_kept, wanted = own[kept].T, own[rest].T.toarray()
        combination, over = np.zeros((rank, len(rest))), wanted
        for _ in range(3):
            half = solve_triangular(lower, own[kept] @ over, lower=True)
            combination += solve_triangular(lower, half, lower=True, trans="T")
            over = wanted - of_kept @ combination
        length = np.linalg.norm(over, axis=0)
        of_rest = np.eye(len(rest))[:, length <= _SAME]
        some = np.flatnonzero(length > _SAME)
        if len(some) > 1:
            # They nearly follow; whether they follow from each other as well shows in what is left of them.
            left_over = np.asarray(np.linalg.qr(over[:, some], mode="r"))
            basis, values, _ = np.linalg.svd(left_over.T)
            values = np.append(values, np.zeros(len(some)))[: len(some)]
            of_rest = np.column_stack([of_rest, np.eye(len(rest))[:, some] @ basis[:, values <= _SAME]])
        tie = np.zeros((rows.shape[0], of_rest.shape[1]))
        tie[left[mine[rest]]] = of_rest
        tie[left[mine[kept]]] = -combination @ of_rest
        tie[np.abs(tie) <= _SAME] = 0.0
        parts.append(tie)
    return np.concatenate([np.zeros((rows.shape[0], 0)), *parts], axis=1)


def _entangled(rows: csr_array) -> Ints:
    """Rows that are left when those go, again and again, that have a dof to themselves."""
    pattern = csr_array((np.ones(rows.nnz), rows.indices, rows.indptr), shape=rows.shape)
    left = np.arange(rows.shape[0])
    while len(left):
        here = pattern[left]
        alone = np.bincount(here.indices, minlength=rows.shape[1]) == 1
        stay = (here @ alone.astype(np.float64)) == 0
        if stay.all():
            break
        left = left[stay]
    return left


def _clearly_independent(products: csr_array) -> bool:
    """Whether no pivot of the rows' products is so small that rounding may have made it."""
    from scipy.sparse.linalg import splu

    try:
        factor = splu(
            products.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError:
        return False
    return bool((factor.U.diagonal() > _TELLS).all())


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
