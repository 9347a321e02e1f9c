use numpy::PyArray1;
use pyo3::prelude::*;
use signorini_core::contact::{self, Outcome};
use std::sync::Arc;

/// Displacements (3n,) as two doubles, reactions, gaps and pieces (m,) of one load.
#[pyclass(frozen, module = "signorini._core")]
pub struct ContactSolution {
    pub inner: contact::ContactSolution,
    pub of: Arc<contact::ContactProblem>,
}

#[pymethods]
impl ContactSolution {
    /// "solved", "no_equilibrium" or "unsolved".
    #[getter]
    fn status(&self) -> &'static str {
        match self.inner.outcome {
            Outcome::Solved => "solved",
            Outcome::NoEquilibrium => "no_equilibrium",
            Outcome::Unsolved | Outcome::Interrupted => "unsolved",
        }
    }

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

    /// The piece (m,) of its law that every point is on.
    #[getter]
    fn piece<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        PyArray1::from_slice(py, &self.inner.piece)
    }

    /// Points that are not open: they hold, or yield.
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
