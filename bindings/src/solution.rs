use crate::contact::failed;
use numpy::PyArray1;
use pyo3::prelude::*;
use signorini_core::contact::{self, SolveError};
use std::sync::Arc;

/// Displacements (3n,) as two doubles, reactions, gaps and pieces of the laws (m,) under one load. Without a solution
/// all numbers are NaN, and all pieces 0.
#[pyclass(frozen, module = "signorini._core")]
pub struct ContactSolution {
    pub inner: contact::ContactSolution,
    pub of: Arc<contact::ContactProblem>,
    /// How the solve ended: "solved", "no_equilibrium" or "unsolved".
    #[pyo3(get)]
    status: &'static str,
}

impl ContactSolution {
    /// Converts the result of a solve. Without a solution it has the status, NaN for all numbers and 0 for all pieces.
    /// Other errors are raised.
    pub fn of(
        problem: &Arc<contact::ContactProblem>,
        solved: Result<contact::ContactSolution, SolveError>,
    ) -> PyResult<Self> {
        let of = problem.clone();
        let status = match solved {
            Ok(inner) => return Ok(Self { inner, of, status: "solved" }),
            Err(SolveError::NoEquilibrium) => "no_equilibrium",
            Err(SolveError::Unsolved) => "unsolved",
            Err(error) => return Err(failed(error)),
        };
        let nan = |length: usize| vec![f64::NAN; length];
        let (dofs, points) = (of.plate.dof_count(), of.points.len());
        let mut inner = contact::ContactSolution::default();
        (inner.displacement.hi, inner.displacement.lo) = (nan(dofs), nan(dofs));
        (inner.reaction, inner.gap, inner.piece) = (nan(points), nan(points), vec![0; points]);
        Ok(Self { inner, of, status })
    }

    /// The solution of the core; `None` unless the status is "solved".
    pub fn solved(&self) -> Option<&contact::ContactSolution> {
        (self.status == "solved").then_some(&self.inner)
    }
}

#[pymethods]
impl ContactSolution {
    #[getter]
    fn hi<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.displacement.hi)
    }

    #[getter]
    fn lo<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.displacement.lo)
    }

    #[getter]
    fn reaction<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.reaction)
    }

    #[getter]
    fn gap<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.gap)
    }

    /// For each point (m,), the number of the piece of its law on which the point is.
    #[getter]
    fn piece<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        PyArray1::from_slice(py, &self.inner.piece)
    }

    /// For each point (m,), whether it is in contact or yields; open points are False.
    #[getter]
    fn closed<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_vec(py, self.of.points.acting(&self.inner.piece))
    }

    #[getter]
    fn pivots(&self) -> usize {
        self.inner.pivots
    }

    #[getter]
    fn iterations(&self) -> usize {
        self.inner.iterations
    }

    #[getter]
    fn gradients(&self) -> usize {
        self.inner.gradients
    }

    #[getter]
    fn factorizations(&self) -> usize {
        self.inner.factorizations
    }

    #[getter]
    fn corrections(&self) -> usize {
        self.inner.corrections
    }
}
