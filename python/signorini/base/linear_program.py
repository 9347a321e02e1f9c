"""Linear programs, by HiGHS (Huangfu & Hall 2018, *Math. Prog. Comp.* 10).

HiGHS is also part of `scipy.optimize`, but the import of highspy takes only a tenth of the time.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_Floats = NDArray[np.float64]
_PRIMAL = 4
"""Value of HiGHS's option ``simplex_strategy`` for the primal simplex method."""
_FEASIBLE = 1e-7
"""Default absolute tolerance for violated rows and bounds of a linear program; also the default of HiGHS."""


def minimise(
    cost: _Floats,
    rows: Any,
    row_bounds: tuple[_Floats | float, _Floats | float],
    bounds: tuple[_Floats | float, _Floats | float],
    tolerance: float = _FEASIBLE,
) -> _Floats | None:
    """Minimise c·x subject to l ≤ A x ≤ u and bounds on x; None if the program is infeasible or unbounded.

    Lower and upper bounds are arrays, or single numbers for all entries; ±inf means no bound. Rows and bounds are
    satisfied within the absolute ``tolerance``. A failure of the solver raises a RuntimeError.

    Examples
    --------
    >>> import numpy as np
    >>> minimise(np.array([-1.0, -2.0]), np.array([[1.0, 1.0]]), (-np.inf, 4.0), (0.0, 3.0))
    array([1., 3.])
    >>> minimise(np.ones(1), np.ones((1, 1)), (2.0, np.inf), (0.0, 1.0)) is None
    True
    """
    solution = minimise_with_prices(cost, rows, row_bounds, bounds, tolerance)
    return None if solution is None else solution[0]


def minimise_with_prices(
    cost: _Floats,
    rows: Any,
    row_bounds: tuple[_Floats | float, _Floats | float],
    bounds: tuple[_Floats | float, _Floats | float],
    tolerance: float = _FEASIBLE,
) -> tuple[_Floats, _Floats] | None:
    """Return the x of `minimise`, and the dual values (m,): derivatives of the minimal cost by the row bounds."""
    import highspy

    class Quiet(highspy.Highs):
        """HiGHS without banner: the constructor of HiGHS ≥ 1.16 calls ``enableCallbacks``, which disables output."""

        def enableCallbacks(self) -> None:
            self.setOptionValue("output_flag", False)
            super().enableCallbacks()  # type: ignore[no-untyped-call]

    program = highspy.HighsLp()
    program.num_row_, program.num_col_ = rows.shape
    program.col_cost_ = np.asarray(cost, dtype=np.float64)
    program.col_lower_, program.col_upper_ = (np.broadcast_to(x, rows.shape[1]).astype(np.float64) for x in bounds)
    program.row_lower_, program.row_upper_ = (np.broadcast_to(x, rows.shape[0]).astype(np.float64) for x in row_bounds)
    start, index, value = _by_rows(rows)
    program.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    program.a_matrix_.start_, program.a_matrix_.index_, program.a_matrix_.value_ = start, index, value
    solver: Any = Quiet()  # type: ignore[no-untyped-call]  # The type stubs of highspy are incomplete.
    solver.setOptionValue("output_flag", False)
    solver.setOptionValue("primal_feasibility_tolerance", tolerance)
    solver.setOptionValue("dual_feasibility_tolerance", tolerance)
    # More threads do not speed up linear programs of this size, and could exceed the user's limit on threads.
    solver.setOptionValue("threads", 1)
    if isinstance(rows, np.ndarray):
        # A dense linear program has only three rows or columns for each plate: presolve takes longer than the solve.
        solver.setOptionValue("presolve", "off")
    solver.passModel(program)
    if solver.run() == highspy.HighsStatus.kError:
        # The process has one HiGHS thread pool, which other code may have made larger: accept its number of threads.
        solver.setOptionValue("threads", 0)
        solver.run()
    ends = highspy.HighsModelStatus
    if solver.getModelStatus() not in _conclusive(ends):
        # Restart with the primal simplex method, which terminates where the dual simplex method cycles.
        solver.clearSolver()
        solver.setOptionValue("simplex_strategy", _PRIMAL)
        solver.run()
    status = solver.getModelStatus()
    if status not in _conclusive(ends):
        raise RuntimeError(f"HiGHS {solver.version()} ended a linear program with {status.name}.")
    if status != ends.kOptimal:
        return None
    solution = solver.getSolution()
    return np.array(solution.col_value), np.array(solution.row_dual)


def _conclusive(ends: Any) -> tuple[object, ...]:
    """Return the HiGHS statuses that decide whether the linear program has a solution."""
    return ends.kOptimal, ends.kInfeasible, ends.kUnbounded, ends.kUnboundedOrInfeasible


def _by_rows(matrix: Any) -> tuple[NDArray[np.int32], NDArray[np.int32], _Floats]:
    """Return row starts, column indices and values of a matrix's nonzero entries: compressed sparse row storage."""
    if hasattr(matrix, "tocsr"):
        sparse = matrix.tocsr()
        return sparse.indptr.astype(np.int32), sparse.indices.astype(np.int32), sparse.data
    row, column = np.nonzero(matrix)
    start = np.append(0, np.cumsum(np.bincount(row, minlength=len(matrix))))
    return start.astype(np.int32), column.astype(np.int32), np.asarray(matrix[row, column], dtype=np.float64)
