"""Rows over single elements: how a point of the plate hangs on the dofs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.sparse import csr_array

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Bools = npt.NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Rows:
    """Rows (m, 24) over the dofs of elements (m,), in the nodes' frames."""

    elements: Ints
    coefficients: Floats

    def __len__(self) -> int:
        """Count the rows."""
        return len(self.elements)

    def __getitem__(self, which: npt.NDArray[np.generic]) -> Rows:
        """Pick rows."""
        return Rows(self.elements[which], self.coefficients[which])

    def __neg__(self) -> Rows:
        """Turn the rows round."""
        return Rows(self.elements, -self.coefficients)

    def dofs(self, elements: Ints) -> Ints:
        """Dofs (m, 24) of the coefficients, given the mesh's elements (ne, 8)."""
        nodes = elements[self.elements]
        return np.asarray((3 * nodes[:, :, None] + np.arange(3)).reshape(len(self), 24))

    def matrix(self, elements: Ints, size: int) -> csr_array:
        """Rows over all dofs as a sparse matrix (m, size), without zeros."""
        # Rows of a deflection have no more than a third of the columns.
        columns = np.flatnonzero(self.coefficients.any(axis=0))
        dofs = 3 * elements[:, columns // 3] + columns % 3
        starts = len(columns) * np.arange(len(self) + 1)
        values = np.ascontiguousarray(self.coefficients[:, columns])
        matrix = csr_array((values.ravel(), dofs[self.elements].ravel(), starts), shape=(len(self), size))
        matrix.eliminate_zeros()
        return matrix

    @staticmethod
    def join(parts: Sequence[Rows]) -> Rows:
        """Put rows behind one another."""
        return Rows(
            np.concatenate([np.zeros(0, np.int64), *(part.elements for part in parts)]),
            np.concatenate([np.zeros((0, 24)), *(part.coefficients for part in parts)]),
        )
