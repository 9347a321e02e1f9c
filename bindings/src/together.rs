use crate::arrays::{rows, vector};
use crate::combinations::stresses;
use crate::contact::{ContactProblem, failed};
use crate::plate::Plate;
use crate::solution::ContactSolution;
use crate::threads::told;
use numpy::{PyArray3, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// Solves many loads (k, 3n) together by the Newton method. The solves start from `start`, the solution of another
/// load, if it is not None. `progress()` is called repeatedly; an exception in it cancels all solves.
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
    if let Some(start) = &start {
        problem.require_own(&start.of, "The solution to begin with")?;
    }
    let (loads, held_value) = (rows(&loads), vector(&held_value));
    let start = start.as_ref().and_then(|start| start.solved());
    let tell = |py: Python<'_>, (): ()| match &progress {
        Some(progress) => progress.call0(py).map(|_| ()),
        None => py.check_signals(),
    };
    let solved = told(py, tell, |tell| problem.inner.solve_together(start, &loads, &held_value, &mut || tell(())))?;
    solved.map_err(failed)?.into_iter().map(|solved| problem.solution(solved)).collect()
}

/// Moments and shears [mx, my, mxy, qx, qy] at nodes (b, n, 5) of b solutions. If the plate has `stress_elements`, the
/// values are at their stress nodes.
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
