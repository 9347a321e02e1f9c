"""Linear equations over the ranks: the matrix in PETSc, factored by MUMPS."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import csr_array

from signorini.discretise.rows import Floats, Ints
from signorini.errors import SignoriniError
from signorini.mpi.parts import Part

_WORKSPACE_SHORT = (-8, -9, -14, -15, -17, -20)
"""Error codes of MUMPS, INFOG(1), for a workspace that is smaller than needed."""
_MEMORY = (*_WORKSPACE_SHORT, -11, -12, -13)
"""Error codes of MUMPS, INFOG(1), for lack of memory."""
_WORKSPACE, _MOST_WORKSPACE = 30, 2000
"""Workspace of the first attempt, and one that is not enlarged: percent above the estimate of MUMPS, ICNTL(14)."""


class Equations:
    """One rank's rows of the matrix, its factor, and vectors with the values of all nodes of the rank's part.

    PETSc stores the upper triangle of the symmetric matrix (SBAIJ). The nodes of a part are in the order of PETSc, so
    the upper triangle of a part's matrix is that of PETSc, for the rows of the nodes that the rank owns.
    """

    def __init__(self, part: Part, communicator: Any) -> None:
        from petsc4py import PETSc

        self._petsc = PETSc
        self._dofs = (3 * part.places[:, None] + np.arange(3)).ravel().astype(np.int32)
        self._owned = slice(3 * part.owned.start, 3 * part.owned.stop)
        self._held, self._communicator = part.held, communicator
        count = self._owned.stop - self._owned.start
        self._sizes = ((count, 3 * part.total), (count, 3 * part.total))
        self._matrix: Any = None
        self._workspace = _WORKSPACE
        self._solver = PETSc.PC().create(communicator)
        self._right = PETSc.Vec().createMPI(self._sizes[0], comm=communicator)
        self._solution = self._right.duplicate()
        self._local = PETSc.Vec().createSeq(len(self._dofs), comm=PETSc.COMM_SELF)
        places = PETSc.IS().createGeneral(self._dofs, comm=PETSc.COMM_SELF)
        self._scatter = PETSc.Scatter().create(self._solution, places, self._local, None)

    def fill(self, stiffness: tuple[Ints, Ints, Floats], supports: csr_array) -> None:
        """Set the matrix to K + ``supports`` (3n, 3n), with K as `_core.Plate.stiffness_matrix` gives it.

        Rows and columns of held dofs in K are set to 0; ``supports`` has a positive diagonal there.
        """
        start, column, value = stiffness
        if self._held.any():
            value[self._held[column] | np.repeat(self._held, np.diff(start))] = 0.0
        first, last = start[self._owned.start], start[self._owned.stop]
        rows = (start[self._owned.start : self._owned.stop + 1] - first).astype(np.int32)
        added = supports[self._owned]
        row = np.repeat(np.arange(self._owned.start, self._owned.stop), np.diff(added.indptr))
        upper = added.indices >= row
        added_rows = np.concatenate([[0], np.cumsum(upper)])[added.indptr].astype(np.int32)
        triangle = rows, self._dofs[column[first:last]], value[first:last]
        if self._matrix is None:
            # K gives the sparsity pattern: it contains that of GᵀkG, since each row of G has dofs of one element only.
            inner = np.concatenate([[0], np.cumsum(triangle[1] <= self._dofs[self._owned.stop - 1])])[rows]
            counts = np.diff(inner).astype(np.int32), (np.diff(rows) - np.diff(inner)).astype(np.int32)
            self._matrix = self._petsc.Mat().createSBAIJ(self._sizes, 1, nnz=counts, comm=self._communicator)
            self._matrix.setOption(self._petsc.Mat.Option.SPD, True)
        self._matrix.zeroEntries()
        self._matrix.setValuesCSR(*triangle, addv=True)
        self._matrix.setValuesCSR(added_rows, self._dofs[added.indices[upper]], added.data[upper], addv=True)
        self._matrix.assemble()

    def factor(self) -> None:
        """Factor the matrix; to save memory the caller has released the arrays from which the matrix was filled."""
        code = self._factored()
        while code in _WORKSPACE_SHORT and self._workspace < _MOST_WORKSPACE:
            self._workspace *= 4
            self._solver.reset()
            self._solver.setType("none")
            code = self._factored()
        if code in _MEMORY:
            raise SignoriniError("Not enough memory for the factor. Take more ranks or machines, or a coarser mesh.")
        if code < 0:
            raise SignoriniError(f"The stiffness matrix cannot be factored: error {code} of MUMPS.")

    def _factored(self) -> int:
        """Factor the matrix, the first time after ordering it; return INFOG(1) of MUMPS, negative after an error."""
        if self._solver.getType() != "cholesky":
            self._solver.setOperators(self._matrix)
            self._solver.setType("cholesky")
            self._solver.setFactorSolverType("mumps")
            self._solver.setFactorSetUpSolverType()
            self._solver.getFactorMatrix().setMumpsIcntl(14, self._workspace)
        try:
            self._solver.setUp()
        except self._petsc.Error as error:
            raise SignoriniError(f"The stiffness matrix cannot be factored: {error}") from None
        return int(self._solver.getFactorMatrix().getMumpsInfog(1))

    def solve(self, right: Floats) -> Floats:
        """Solve for a right-hand side (3n,), used at the rank's own nodes; return the values of all nodes (3n,)."""
        self._right.setArray(np.where(self._held, 0.0, right)[self._owned])
        self._solver.apply(self._right, self._solution)
        self._scatter.scatter(self._solution, self._local, addv=False, mode=False)
        return np.array(self._local.getArray())

    def destroy(self) -> None:
        """Free the matrix and the factor."""
        for made in (self._solver, self._matrix, self._scatter, self._right, self._solution, self._local):
            if made is not None:
                made.destroy()
