use crate::arrays::{invalid, rows, sized};
use crate::combinations::stresses;
use crate::contact::{ContactProblem, failed};
use crate::plate::Plate;
use crate::solution::ContactSolution;
use crate::threads::told;
use numpy::{PyArray3, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

/// Solves many loads (k, 3n) together by the Newton method, from the solution of another load if given. `progress()` is
/// called at intervals; an exception in it cancels all.
#[pyfunction]
#[pyo3(signature = (problem, start, loads, held_value, progress=None))]
pub fn solve_together(
    py: Python<'_>,
    problem: &ContactProblem,
    start: Option<PyRef<'_, ContactSolution>>,
    loads: PyReadonlyArray2<'_, f64>,
    held_value: PyReadonlyArray1<'_, f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<ContactSolution>> {
    let dofs = problem.inner.plate.dof_count();
    let held_value = sized("held_value", &held_value, dofs)?;
    if loads.shape()[1] != dofs {
        return Err(invalid(format!("loads must have {dofs} columns")));
    }
    if problem.inner.is_condensed() {
        return Err(invalid("there is no active set"));
    }
    if let Some(start) = &start {
        problem.require_own(&start.of, "The solution to begin with")?;
    }
    let (loads, start) = (rows(&loads), start.as_ref().map(|start| &start.inner));
    let tell = |py: Python<'_>, (): ()| match &progress {
        Some(progress) => progress.call0(py).map(|_| ()),
        None => py.check_signals(),
    };
    let solved = told(py, tell, |tell| problem.inner.solve_together(start, &loads, &held_value, &mut || tell(())))?;
    Ok(solved.map_err(failed)?.into_iter().map(|inner| problem.solution(inner)).collect())
}

/// As `response_stresses`, of solutions.
#[pyfunction]
pub fn solution_stresses<'py>(
    py: Python<'py>,
    plate: &Plate,
    solutions: Vec<PyRef<'_, ContactSolution>>,
    curvatures: PyReadonlyArray2<'_, f64>,
    couples: PyReadonlyArray2<'_, f64>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let result = solutions.iter().map(|s| (&*s.of.plate, &s.inner.displacement)).collect();
    stresses(py, plate, result, &curvatures, &couples)
}
