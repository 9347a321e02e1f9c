"""Which rows follow from others, judged on the rows themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from signorini.base.components import components
from signorini.discretise.rows import Bools, Floats, Ints

SAME = 1e-12
"""Part of a row below which what is left of it is rounding: rows are right to about 1e-15, and points a billionth of an
element apart are told apart all the same."""
_TELLS = 1e-10
"""Products of rows tell independent ones from others down to this pivot; below, the rows themselves are asked."""
_REFINED = 3
"""Corrections of a combination: by then it is right to the last digits."""


def within(rows: csr_array, dofs: Bools) -> csr_array:
    """Rows where they are not rounding, and only on some dofs."""
    rows = csr_array(rows, copy=True)
    rows.data[~dofs[rows.indices] | (np.abs(rows.data) <= SAME)] = 0.0
    rows.eliminate_zeros()
    return rows


def lengths(rows: csr_array) -> Floats:
    """Lengths (m,) of rows."""
    return np.asarray(np.sqrt(rows.multiply(rows).sum(axis=1)))


def times(rows: csr_array, factor: Floats) -> csr_array:
    """Rows times a number each (m,)."""
    out = csr_array(rows, copy=True)
    out.data *= np.repeat(factor, np.diff(out.indptr))
    return out


def parallel(rows: csr_array, length: Floats) -> tuple[Ints, Floats]:
    """Number the directions (m,) of rows (m, n), and give their lengths along these, of either sign."""
    # Two rows are parallel where they say the same of two fields that no row was made for.
    random = np.random.default_rng(0)
    fields = random.normal(size=(rows.shape[1], 2))
    said = (rows @ fields) / length[:, None]
    sign = np.where(said[:, 0] < 0, -1.0, 1.0)
    said *= sign[:, None]
    order = np.argsort(said[:, 0], kind="stable")
    new = np.append(True, (np.abs(np.diff(said[order], axis=0)) > SAME).any(axis=1))
    group = np.empty(len(length), np.int64)
    group[order] = np.cumsum(new) - 1 if len(order) else 0
    return group, sign * length


@dataclass(frozen=True, eq=False)
class Followers:
    """Rows (r,) that follow from others, each as a combination (r, g) of all rows but the followers."""

    rows: Ints
    combinations: csr_array


def followers(rows: csr_array) -> Followers:
    """Find rows (g, n), of length one, that follow from others: combinations of these leave only rounding of them.

    Examples
    --------
    >>> rows = np.array([[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.0, 1.0, 0.0]])
    >>> found = followers(csr_array(rows))
    >>> found.rows.tolist(), found.combinations.toarray().round(9).tolist()
    ([1], [[0.6, 0.0, 0.8]])

    Rows that nearly follow do not:

    >>> rows[1] = [0.6, 0.8, 1e-9]
    >>> followers(csr_array(rows)).rows.tolist()
    []
    """
    left = _entangled(rows)
    none = Followers(np.zeros(0, np.int64), csr_array((0, rows.shape[0])))
    if not len(left):
        return none
    here = rows[left]
    products = csr_array(here @ here.T)
    if len(left) <= len(np.unique(here.indices)) and _clearly_independent(products):
        return none
    near = products.tocoo()
    label = components(len(left), *(at.astype(np.int64) for at in near.coords))
    parts = [(none.rows, none.combinations)]
    for part in range(int(label.max()) + 1):
        mine = np.flatnonzero(label == part)
        stay, follow, combination = _of_connected(here[mine])
        of = csr_array(combination).tocoo()
        columns = left[mine[stay]][of.coords[1]]
        shape = len(follow), rows.shape[0]
        parts.append((left[mine[follow]], csr_array((of.data, (of.coords[0], columns)), shape=shape)))
    found, combinations = zip(*parts, strict=True)
    return Followers(np.concatenate(found), csr_array(vstack(combinations)))


def _of_connected(rows: csr_array) -> tuple[Ints, Ints, Floats]:
    """Rows that stay (k,), those that follow (r,), and these as combinations (r, k) of those."""
    # What follows needs scipy.linalg, which takes a while to read; most plates do not come here.
    from scipy.linalg import lapack, qr, solve_triangular

    rows = rows[:, np.unique(rows.indices)]
    factor, pivots, rank, _ = lapack.dpstrf((rows @ rows.T).toarray(), lower=1, tol=_TELLS)
    order = pivots.astype(np.int64) - 1
    stay, rest = order[:rank], order[rank:]
    lower = factor[:rank, :rank]
    # Dense beside sparse, and transposed: a column for each of the rest, a row for each dof that they touch.
    of_stay, wanted = rows[stay].T, rows[rest].T.toarray()
    combination, over = np.zeros((rank, len(rest))), wanted
    for _ in range(_REFINED):
        half = solve_triangular(lower, rows[stay] @ over, lower=True)
        combination += solve_triangular(lower, half, lower=True, trans="T")
        over = wanted - of_stay @ combination
    some = np.linalg.norm(over, axis=0) > SAME
    if some.any():
        # They nearly follow; whether they follow from each other as well shows in what is left of them.
        left_over, order = qr(over[:, some], mode="r", pivoting=True)
        more = int((np.abs(np.diagonal(left_over)) > SAME).sum())
        also, order = solve_triangular(left_over[:more, :more], left_over[:more, more:]), np.flatnonzero(some)[order]
        those = np.append(np.flatnonzero(~some), order[more:])
        of_more = np.column_stack([np.zeros((more, np.count_nonzero(~some))), also])
        combination = np.vstack([combination[:, those] - combination[:, order[:more]] @ of_more, of_more])
        stay, rest = np.append(stay, rest[order[:more]]), rest[those]
    combination[np.abs(combination) <= SAME] = 0.0
    return stay, rest, combination.T


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
