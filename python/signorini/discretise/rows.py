"""Rows over elements: how a point of the plate, or the mean of a footprint, hangs on the dofs."""

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


@dataclass(frozen=True, eq=False)
class Further:
    """What rows, by number (q,) in ascending order, have in further elements (q,): coefficients (q, 24)."""

    owners: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    elements: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    coefficients: Floats = field(default_factory=lambda: np.zeros((0, 24)))


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows (m, 24) over the dofs of elements (m,), in the nodes' frames; those of footprints go on in further elements.

    No dof stands in a row twice.
    """

    elements: Ints
    coefficients: Floats
    further: Further = field(default_factory=Further)

    def __len__(self) -> int:
        """Count the rows."""
        return len(self.elements)

    def __getitem__(self, which: npt.NDArray[np.generic]) -> Rows:
        """Pick rows."""
        own = self.elements[which], self.coefficients[which]
        further = self.further
        if not len(further.owners):
            return Rows(*own)
        picked = np.arange(len(self))[which]
        first, last = (np.searchsorted(further.owners, picked, side) for side in ("left", "right"))
        count = last - first
        at = np.repeat(first - np.cumsum(count) + count, count) + np.arange(count.sum())
        owners = np.repeat(np.arange(len(picked)), count)
        return Rows(*own, Further(owners, further.elements[at], further.coefficients[at]))

    def __neg__(self) -> Rows:
        """Turn the rows round."""
        further = self.further
        return Rows(self.elements, -self.coefficients, Further(further.owners, further.elements, -further.coefficients))

    def turned(self, along: Floats, other: Rows) -> Rows:
        """Rows of the slope along directions (m, 2), of these of θx and others of θy in the same elements."""
        further, beyond = self.further, along[self.further.owners]
        own, behind = (
            axes[:, :1] * x + axes[:, 1:] * y
            for axes, x, y in (
                (along, self.coefficients, other.coefficients),
                (beyond, further.coefficients, other.further.coefficients),
            )
        )
        return Rows(self.elements, own, Further(further.owners, further.elements, behind))

    @classmethod
    def over(cls, owners: Ints, elements: Ints, values: Floats, nodes: Ints) -> Rows:
        """Rows of which each has values (k, 24) for the dofs of several elements, given these' nodes (ne, 8).

        ``owners`` (k,) are the rows' numbers, each there; the values of one row and element are summed.
        """
        pairs, which = np.unique(np.column_stack([owners, elements]), axis=0, return_inverse=True)
        owner, element = pairs.T
        sums = np.zeros((len(pairs), 24))
        np.add.at(sums, which.ravel(), values)
        # A node of several elements has all of it in the first one, so that no dof stands twice.
        own = np.column_stack([np.repeat(owner, 8), nodes[element].ravel()])
        _, first, node = np.unique(own, axis=0, return_index=True, return_inverse=True)
        gathered, parts = np.zeros((8 * len(pairs), 3)), sums.reshape(-1, 3)
        gathered[first] = np.column_stack([np.bincount(node.ravel(), part) for part in parts.T])
        coefficients = gathered.reshape(sums.shape)
        leads = np.diff(owner, prepend=-1) > 0
        return cls(element[leads], coefficients[leads], Further(owner[~leads], element[~leads], coefficients[~leads]))

    def beside(self, others: Rows, first: int) -> Rows:
        """These rows, and behind each what one of as many others is over, their elements numbered from the first on."""
        own, further = self.further, others.further
        owners = np.concatenate([own.owners, np.arange(len(others)), further.owners])
        order = np.argsort(owners, kind="stable")
        elements = np.concatenate([own.elements, others.elements + first, further.elements + first])[order]
        coefficients = np.concatenate([own.coefficients, others.coefficients, further.coefficients])[order]
        return Rows(self.elements, self.coefficients, Further(owners[order], elements, coefficients))

    def parted(self, first: int) -> tuple[Rows, Rows]:
        """What `beside` put together."""
        further = self.further
        behind = further.elements >= first
        own = Further(further.owners[~behind], further.elements[~behind], further.coefficients[~behind])
        owners, elements = further.owners[behind], further.elements[behind] - first
        coefficients, leads = further.coefficients[behind], np.diff(owners, prepend=-1) > 0
        rest = Further(owners[~leads], elements[~leads], coefficients[~leads])
        return Rows(self.elements, self.coefficients, own), Rows(elements[leads], coefficients[leads], rest)

    @property
    def arrays(self) -> tuple[Ints, Floats, Ints]:
        """Rows the way the core takes them: elements and coefficients (m + q,), and which rows the last q are of."""
        further = self.further
        if not len(further.owners):
            return self.elements, self.coefficients, further.owners
        return (
            np.concatenate([self.elements, further.elements]),
            np.concatenate([self.coefficients, further.coefficients]),
            further.owners,
        )

    def dofs(self, elements: Ints) -> Ints:
        """Dofs (m + q, 24) of the coefficients, those of further elements behind, given the mesh's elements (ne, 8)."""
        nodes = elements[self.arrays[0]]
        return np.asarray((3 * nodes[:, :, None] + np.arange(3)).reshape(len(nodes), 24))

    def dot(self, elements: Ints, vector: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """Return G u (m,), the rows times a nodal vector u (3n,), in the precision of u."""
        products = (self.arrays[1].astype(vector.dtype) * vector[self.dofs(elements)]).sum(axis=1)
        np.add.at(products, self.further.owners, products[len(self) :])
        return np.asarray(products[: len(self)])

    def matrix(self, elements: Ints, size: int) -> csr_array:
        """Rows over all dofs as a sparse matrix (m, size), without zeros."""
        matrix = _matrix(self.elements, self.coefficients, elements, size)
        further = self.further
        if not len(further.owners):
            return matrix
        behind = _matrix(further.elements, further.coefficients, elements, size)
        count = len(further.owners)
        owned = csr_array((np.ones(count), (further.owners, np.arange(count))), shape=(len(self), count))
        return csr_array(matrix + owned @ behind)

    @staticmethod
    def join(parts: Sequence[Rows]) -> Rows:
        """Put rows behind one another."""
        starts = np.cumsum([0, *(len(part) for part in parts)])
        further = [part.further for part in parts]
        return Rows(
            np.concatenate([np.zeros(0, np.int64), *(part.elements for part in parts)]),
            np.concatenate([np.zeros((0, 24)), *(part.coefficients for part in parts)]),
            Further(
                np.concatenate([np.zeros(0, np.int64), *map(np.add, starts, (one.owners for one in further))]),
                np.concatenate([np.zeros(0, np.int64), *(one.elements for one in further)]),
                np.concatenate([np.zeros((0, 24)), *(one.coefficients for one in further)]),
            ),
        )


def _matrix(owners: Ints, coefficients: Floats, elements: Ints, size: int) -> csr_array:
    # Rows of a deflection have no more than a third of the columns.
    columns = np.flatnonzero(coefficients.any(axis=0))
    dofs: npt.NDArray[Any] = 3 * elements.take(columns // 3, axis=1) + columns % 3
    starts: npt.NDArray[Any] = len(columns) * np.arange(len(owners) + 1)
    if max(size, starts[-1]) <= np.iinfo(np.int32).max:
        # They take half of the memory.
        dofs, starts = dofs.astype(np.int32), starts.astype(np.int32)
    values = coefficients.take(columns, axis=1)
    matrix = csr_array((values.ravel(), dofs.take(owners, axis=0).ravel(), starts), shape=(len(owners), size))
    matrix.eliminate_zeros()
    return matrix


def interpolated(mesh: Mesh, frames: Floats | None, elements: Ints, xi: Floats, field: int) -> Rows:
    """Rows of w, θx or θy (field 0, 1, 2) at reference points (q, 2) of elements (q,).

    Each interpolates the nodal values by the element's shape functions, as results do.
    """
    nodes, shapes = mesh.elements[elements], mesh.shape_functions(elements, xi)
    values = np.zeros((len(nodes), 8, 3))
    if field == 0 or frames is None:
        values[..., field] = shapes
    else:
        # θx = c θ1 − s θ2, θy = s θ1 + c θ2 in a node's frame.
        c, s = np.moveaxis(frames[nodes], -1, 0)
        values[..., 1], values[..., 2] = (c * shapes, -s * shapes) if field == 1 else (s * shapes, c * shapes)
    return Rows(elements, values.reshape(len(nodes), 24))


@dataclass(frozen=True, eq=False)
class Table:
    """Arrays, or rows, of equal length, one entry a row, and what holds for all of them."""

    def __len__(self) -> int:
        """Count the rows."""
        return len(getattr(self, fields(self)[0].name))

    def pick(self, which: Bools | Ints) -> Self:
        """Keep the rows marked; where that is every one, no copy is made."""
        if which.dtype == np.bool_ and which.all():
            return self
        return replace(self, **{name: getattr(self, name)[which] for name in self._columns()})

    @classmethod
    def join(cls, parts: Sequence[Self]) -> Self:
        """Put tables behind one another; of one that is not empty no copy is made."""
        filled = [part for part in parts if len(part)]
        if len(filled) == 1:
            return filled[0]
        joined: dict[str, Any] = {}
        for name in parts[0]._columns():
            each: list[Any] = [getattr(part, name) for part in parts]
            joined[name] = Rows.join(each) if isinstance(each[0], Rows) else np.concatenate(each)
        return replace(parts[0], **joined)

    def _columns(self) -> list[str]:
        return [one.name for one in fields(self) if isinstance(getattr(self, one.name), np.ndarray | Rows)]


def null_space(rows: Floats, rounding: float) -> Floats:
    """Basis (n, k) of what rows (m, n) take to less than this part of their largest singular value, or of one."""
    if not len(rows):
        return np.eye(rows.shape[1])
    # The triangle has the rows' products, few of them, and keeps small singular values.
    _, values, basis = np.linalg.svd(np.linalg.qr(rows, mode="r"))
    return np.asarray(basis[int((values > rounding * values.max(initial=1.0)).sum()) :].T)
