"""Rows that follow from others: of supports that say the same of the plate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, vstack

from signorini.base.components import components
from signorini.discretise.rows import Bools, Floats, Ints

SAME = 1e-12
"""Part of a row of length one below which it is rounding: rows are right to about 1e-15, and points a billionth of an
element from each other are two all the same."""
_CLEAR = 1e-10
"""Pivots of products of rows down to which these are independent beyond rounding."""


@dataclass(frozen=True, eq=False)
class Followers:
    """Rows (r,) that follow from others, each as a combination (r, g) of all rows but these."""

    rows: Ints
    combinations: csr_array

    @property
    def ties(self) -> csr_array:
        """Independent combinations (r, g) of rows that are zero."""
        count = len(self.rows)
        own = csr_array((np.ones(count), (np.arange(count), self.rows)), shape=self.combinations.shape)
        return csr_array(own - self.combinations)


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


def parallel(rows: csr_array) -> tuple[Ints, Floats]:
    """Number the directions (m,) of rows (m, n), and give their lengths along these, of either sign."""
    # Two rows are parallel where they say the same of two fields that no row was made for.
    fields = np.random.default_rng(0).normal(size=(rows.shape[1], 2))
    length = lengths(rows)
    said = (rows @ fields) / length[:, None]
    sign = np.where(said[:, 0] < 0, -1.0, 1.0)
    said *= sign[:, None]
    order = np.argsort(said[:, 0], kind="stable")
    new = np.append(True, (np.abs(np.diff(said[order], axis=0)) > SAME).any(axis=1))
    group = np.empty(len(length), np.int64)
    group[order] = np.cumsum(new)[: len(order)] - 1
    return group, sign * length


def followers(rows: csr_array) -> Followers:
    """Find rows (g, n), of length one, that follow from others: combinations of these leave only rounding of them.

    Examples
    --------
    >>> rows = np.array([[1.0, 0.0, 0.0], [0.6, 0.8, 0.0], [0.0, 1.0, 0.0]])
    >>> result = followers(csr_array(rows))
    >>> result.rows.tolist(), result.combinations.toarray().round(9).tolist()
    ([1], [[0.6, 0.0, 0.8]])

    Rows that nearly follow do not:

    >>> rows[1] = [0.6, 0.8, 1e-9]
    >>> followers(csr_array(rows)).rows.tolist()
    []
    """
    some = _entangled(rows)
    parts = [Followers(np.zeros(0, np.int64), csr_array((0, rows.shape[0])))]
    here = rows[some]
    products = csr_array(here @ here.T)
    if len(some) and not _clearly_independent(products):
        # What follows takes a while to be imported; most plates do not come here.
        from scipy.linalg import qr, solve_triangular

        near = products.tocoo()
        label = components(len(some), *(at.astype(np.int64) for at in near.coords))
        for part in range(int(label.max()) + 1):
            mine = some[label == part]
            dense = rows[mine][:, np.unique(rows[mine].indices)].toarray()
            r, order = qr(dense.T, mode="r", pivoting=True)
            rank = int((np.abs(np.diagonal(r)) > SAME).sum())
            combination = solve_triangular(r[:rank, :rank], r[:rank, rank:]).T
            combination[np.abs(combination) <= SAME] = 0.0
            of = csr_array(combination).tocoo()
            at = of.coords[0], mine[order[:rank]][of.coords[1]]
            shape = len(order) - rank, rows.shape[0]
            parts.append(Followers(mine[order[rank:]], csr_array((of.data, at), shape=shape)))
    return Followers(
        np.concatenate([part.rows for part in parts]), csr_array(vstack([part.combinations for part in parts]))
    )


def _entangled(rows: csr_array) -> Ints:
    """Rows that remain when those go, again and again, that have a dof to themselves."""
    pattern = csr_array((np.ones(rows.nnz), rows.indices, rows.indptr), shape=rows.shape)
    some = np.arange(rows.shape[0])
    while len(some):
        here = pattern[some]
        alone = np.bincount(here.indices, minlength=rows.shape[1]) == 1
        stay = (here @ alone.astype(np.float64)) == 0
        if stay.all():
            break
        some = some[stay]
    return some


def _clearly_independent(products: csr_array) -> bool:
    """Whether no pivot of the rows' products is so small that rounding may have made it."""
    from scipy.sparse.linalg import splu

    try:
        factor = splu(
            products.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )
    except RuntimeError:
        return False
    return bool((factor.U.diagonal() > _CLEAR).all())
