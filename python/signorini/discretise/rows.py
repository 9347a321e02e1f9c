"""Rows of G over elements: a deflection, a slope or the mean over a footprint as a linear form in the dofs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, Self

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

from signorini.mesh import Mesh

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]
Pieces = npt.NDArray[np.uint8]
RANK = 1e-9
"""Rank tolerance for products of rows with rigid motions of unit deflection, relative to max(σ₁, 1).

σ₁ is the largest singular value.
"""


@dataclass(frozen=True, eq=False)
class Further:
    """Terms (q,) of rows in elements other than the row's first element.

    ``owners`` are the indices of the rows, ascending; ``coefficients`` (q, 24) belong to the dofs of ``elements`` (q,).
    """

    owners: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    elements: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    coefficients: Floats = field(default_factory=lambda: np.zeros((0, 24)))


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows of G: coefficients (m, 24) over the dofs of elements (m,), in nodal axes.

    ``further`` has the terms in other elements. A dof occurs in a row at most once.
    """

    elements: Ints
    coefficients: Floats
    further: Further = field(default_factory=Further)

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(self.elements)

    def __getitem__(self, which: npt.NDArray[np.generic]) -> Rows:
        """Select rows by a mask or by indices."""
        first_elements = self.elements[which], self.coefficients[which]
        further = self.further
        if not len(further.owners):
            return Rows(*first_elements)
        picked = np.arange(len(self))[which]
        first, last = (np.searchsorted(further.owners, picked, side) for side in ("left", "right"))
        count = last - first
        entries = np.repeat(first - np.cumsum(count) + count, count) + np.arange(count.sum())
        owners = np.repeat(np.arange(len(picked)), count)
        return Rows(*first_elements, Further(owners, further.elements[entries], further.coefficients[entries]))

    def __neg__(self) -> Rows:
        """Multiply the rows by −1."""
        further = self.further
        return Rows(self.elements, -self.coefficients, Further(further.owners, further.elements, -further.coefficients))

    def __add__(self, other: Rows) -> Rows:
        """Add rows with the same elements."""
        further = replace(self.further, coefficients=self.further.coefficients + other.further.coefficients)
        return Rows(self.elements, self.coefficients + other.coefficients, further)

    def slope_along(self, along: Floats, other: Rows) -> Rows:
        """Rows of the slope along unit directions (m, 2), from rows of θx (``self``) and of θy (``other``).

        The rows of θx and θy have the same elements.
        """
        further, beyond = self.further, along[self.further.owners]
        coefficients, further_coefficients = (
            axes[:, :1] * x + axes[:, 1:] * y
            for axes, x, y in (
                (along, self.coefficients, other.coefficients),
                (beyond, further.coefficients, other.further.coefficients),
            )
        )
        return Rows(self.elements, coefficients, Further(further.owners, further.elements, further_coefficients))

    @classmethod
    def summed(cls, owners: Ints, elements: Ints, values: Floats, nodes: Ints) -> Rows:
        """Sum terms with coefficients ``values`` (k, 24) over elements (k,) into rows ``owners`` (k,).

        Every row has at least one term. ``nodes`` (ne, 8) are the nodes of the mesh's elements.
        """
        pairs, which = np.unique(np.column_stack([owners, elements]), axis=0, return_inverse=True)
        owner, element = pairs.T
        sums = np.zeros((len(pairs), 24))
        np.add.at(sums, which.ravel(), values)
        # If a node occurs in several elements, its terms are summed in the first of them, so that each dof occurs once.
        rows_and_nodes = np.column_stack([np.repeat(owner, 8), nodes[element].ravel()])
        _, first, node = np.unique(rows_and_nodes, axis=0, return_index=True, return_inverse=True)
        gathered, parts = np.zeros((8 * len(pairs), 3)), sums.reshape(-1, 3)
        gathered[first] = np.column_stack([np.bincount(node.ravel(), part) for part in parts.T])
        coefficients = gathered.reshape(sums.shape)
        leads = np.diff(owner, prepend=-1) > 0
        return cls(element[leads], coefficients[leads], Further(owner[~leads], element[~leads], coefficients[~leads]))

    def extended(self, others: Rows, first: int) -> Rows:
        """Add the terms of ``others``, row by row; ``first`` is added to the element indices of ``others``."""
        of_first, further = self.further, others.further
        owners = np.concatenate([of_first.owners, np.arange(len(others)), further.owners])
        order = np.argsort(owners, kind="stable")
        elements = np.concatenate([of_first.elements, others.elements + first, further.elements + first])[order]
        coefficients = np.concatenate([of_first.coefficients, others.coefficients, further.coefficients])[order]
        return Rows(self.elements, self.coefficients, Further(owners[order], elements, coefficients))

    def split(self, first: int) -> tuple[Rows, Rows]:
        """Undo `extended`: return rows of the terms in elements below ``first``, and rows of the other terms."""
        further = self.further
        second = further.elements >= first
        of_first = Further(further.owners[~second], further.elements[~second], further.coefficients[~second])
        owners, elements = further.owners[second], further.elements[second] - first
        coefficients, leads = further.coefficients[second], np.diff(owners, prepend=-1) > 0
        rest = Further(owners[~leads], elements[~leads], coefficients[~leads])
        return Rows(self.elements, self.coefficients, of_first), Rows(elements[leads], coefficients[leads], rest)

    @property
    def arrays(self) -> tuple[Ints, Floats, Ints]:
        """Elements (m + q,), coefficients (m + q, 24), and rows (q,) of the last q terms, as `_core` takes them."""
        further = self.further
        if not len(further.owners):
            return self.elements, self.coefficients, further.owners
        return (
            np.concatenate([self.elements, further.elements]),
            np.concatenate([self.coefficients, further.coefficients]),
            further.owners,
        )

    def dofs(self, elements: Ints) -> Ints:
        """Dofs (m + q, 24) of the coefficients in `arrays`; ``elements`` (ne, 8) are the nodes of all elements."""
        nodes = elements[self.arrays[0]]
        return np.asarray((3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), 24))

    def dot(self, elements: Ints, vector: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return G u (m,) for a nodal vector u (3n,), computed in the precision of u."""
        products = (self.arrays[1].astype(vector.dtype) * vector[self.dofs(elements)]).sum(axis=1)
        np.add.at(products, self.further.owners, products[len(self) :])
        return np.asarray(products[: len(self)])

    def matrix(self, elements: Ints, size: int) -> csr_array:
        """G (m, size) as a sparse matrix without stored zeros."""
        matrix = _matrix(self.elements, self.coefficients, elements, size)
        further = self.further
        if not len(further.owners):
            return matrix
        further_rows = _matrix(further.elements, further.coefficients, elements, size)
        count = len(further.owners)
        owned = csr_array((np.ones(count), (further.owners, np.arange(count))), shape=(len(self), count))
        return csr_array(matrix + owned @ further_rows)

    @staticmethod
    def at_nodes(elements: Ints, nodes: Ints) -> Rows:
        """Rows of the deflection at the nodes ``nodes`` (k,); ``elements`` (ne, 8) are the nodes of all elements."""
        known, first = np.unique(elements, return_index=True)
        own, local = np.divmod(first[np.searchsorted(known, nodes)], 8)
        coefficients = np.zeros((len(nodes), 24))
        coefficients[np.arange(len(nodes)), 3 * local] = 1.0
        return Rows(own, coefficients)

    @staticmethod
    def join(parts: Sequence[Rows]) -> Rows:
        """Concatenate rows, and their terms in further elements."""
        starts = np.cumsum([0, *(len(part) for part in parts)])
        further = [part.further for part in parts]
        return Rows(
            np.concatenate([np.zeros(0, np.int64), *(part.elements for part in parts)]),
            np.concatenate([np.zeros((0, 24)), *(part.coefficients for part in parts)]),
            Further(
                np.concatenate([np.zeros(0, np.int64), *map(np.add, starts, (terms.owners for terms in further))]),
                np.concatenate([np.zeros(0, np.int64), *(terms.elements for terms in further)]),
                np.concatenate([np.zeros((0, 24)), *(terms.coefficients for terms in further)]),
            ),
        )


def _matrix(owners: Ints, coefficients: Floats, elements: Ints, size: int) -> csr_array:
    # Zero columns of coefficients are left out; in rows of a deflection, two of three columns are zero.
    columns = np.flatnonzero(coefficients.any(axis=0))
    dofs: npt.NDArray[Any] = 3 * elements.take(columns // 3, axis=1) + columns % 3
    starts: npt.NDArray[Any] = len(columns) * np.arange(len(owners) + 1)
    if max(size, starts[-1]) <= np.iinfo(np.int32).max:
        # 32-bit indices take half the memory.
        dofs, starts = dofs.astype(np.int32), starts.astype(np.int32)
    values = coefficients.take(columns, axis=1)
    matrix = csr_array((values.ravel(), dofs.take(owners, axis=0).ravel(), starts), shape=(len(owners), size))
    matrix.eliminate_zeros()
    return matrix


def interpolated(mesh: Mesh, frames: Floats | None, elements: Ints, xi: Floats, field: int) -> Rows:
    """Rows of w, θx or θy (``field`` 0, 1, 2) at reference points (q, 2) of elements (q,).

    Nodal values are interpolated by the element's shape functions, as in results.
    """
    nodes, shapes = mesh.elements[elements], mesh.shape_functions(elements, xi)
    values = np.zeros((len(nodes), 8, 3))
    if field == 0 or frames is None:
        values[..., field] = shapes
    else:
        # θx = c θ1 − s θ2, θy = s θ1 + c θ2 in nodal axes.
        c, s = np.moveaxis(frames[nodes], -1, 0)
        values[..., 1], values[..., 2] = (c * shapes, -s * shapes) if field == 1 else (s * shapes, c * shapes)
    return Rows(elements, values.reshape(len(nodes), 24))


@dataclass(frozen=True, eq=False)
class Table:
    """Base class of tables: fields that are arrays or `Rows` are columns of equal length.

    Other fields apply to the whole table.
    """

    def __len__(self) -> int:
        """Return the number of rows of the table."""
        return len(getattr(self, fields(self)[0].name))

    def pick(self, which: Bools | Ints) -> Self:
        """Select rows of the table; no copy is made if a mask selects all rows."""
        if which.dtype == np.bool_ and which.all():
            return self
        return replace(self, **{name: getattr(self, name)[which] for name in self._columns()})

    @classmethod
    def join(cls, parts: Sequence[Self]) -> Self:
        """Concatenate tables; no copy is made if only one table has rows."""
        filled = [part for part in parts if len(part)]
        if len(filled) == 1:
            return filled[0]
        joined: dict[str, Any] = {}
        for name in parts[0]._columns():
            each: list[Any] = [getattr(part, name) for part in parts]
            joined[name] = Rows.join(each) if isinstance(each[0], Rows) else np.concatenate(each)
        return replace(parts[0], **joined)

    def _columns(self) -> list[str]:
        return [column.name for column in fields(self) if isinstance(getattr(self, column.name), np.ndarray | Rows)]


def null_space(rows: Floats, rounding: float = RANK) -> Floats:
    """Basis (n, k) of the null space of rows (m, n), whose rank tolerance ``rounding`` is relative to max(σ₁, 1)."""
    if not len(rows):
        return np.eye(rows.shape[1])
    # R of the QR factorization has the same singular values as the rows, but is small.
    _, values, basis = np.linalg.svd(np.linalg.qr(rows, mode="r"))
    return np.asarray(basis[int((values > rounding * values.max(initial=1.0)).sum()) :].T)
