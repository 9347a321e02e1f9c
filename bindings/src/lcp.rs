use crate::arrays::invalid;
use crate::threads::{interruptible, interruptible_alone};
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use signorini_core::dense;
use signorini_core::lcp::{self, Lcp, LcpError, LcpStatus, LemkeOptions};
use std::borrow::Cow;

/// Solution of a linear complementarity problem: z, w and the basis, each (m,), and how the solver ended.
#[pyclass(frozen, module = "signorini._core")]
pub struct LcpSolution {
    inner: lcp::LcpSolution,
}

/// Solves w = Mz + q, w ≥ 0, z ≥ 0, zᵀw = 0 by Lemke's algorithm with the lexicographic ratio test.
///
/// `matrix` is M (m, m); `q` has shape (m,). `covering` (m,) > 0 is the covering vector; None means a vector of ones.
/// `start` (m,) is true where z is basic in the solution of a similar problem; the path then starts at this basis.
#[pyfunction]
#[pyo3(signature = (matrix, q, covering=None, max_pivots=None, start=None))]
pub fn lemke(
    py: Python<'_>,
    matrix: PyReadonlyArray2<'_, f64>,
    q: PyReadonlyArray1<'_, f64>,
    covering: Option<PyReadonlyArray1<'_, f64>>,
    max_pivots: Option<usize>,
    start: Option<PyReadonlyArray1<'_, bool>>,
) -> PyResult<LcpSolution> {
    let (rows, columns) = (matrix.shape()[0], matrix.shape()[1]);
    if rows != columns || rows != q.len() {
        return Err(invalid(format!(
            "M is {rows} x {columns} and q has {} entries; M must be square, with a row for every entry of q",
            q.len()
        )));
    }
    let out_of_memory = || PyMemoryError::new_err(LcpError::OutOfMemory.to_string());
    let view = matrix.as_array();
    let matrix = match view.as_slice() {
        Some(entries) => Cow::Borrowed(entries),
        None => Cow::Owned(dense::row_major(rows, rows, |i, j| view[(i, j)]).map_err(|_| out_of_memory())?),
    };
    let q = q.as_array().to_vec();
    let covering = covering.map(|d| d.as_array().to_vec());
    let start = start.map(|basis| basis.as_array().to_vec());
    let solve = |watch: &mut dyn FnMut() -> bool| {
        let options = LemkeOptions { covering: covering.as_deref(), max_pivots };
        lcp::lemke_watched(&Lcp::new(&matrix, &q)?, &options, start.as_deref(), &mut |_, _| watch())
    };
    let result = if rows < dense::PARALLEL_ORDER { interruptible_alone(py, solve) } else { interruptible(py, solve) }?;
    let failed = |error| match error {
        LcpError::OutOfMemory => out_of_memory(),
        _ => invalid(error),
    };
    Ok(LcpSolution { inner: result.map_err(failed)? })
}

#[pymethods]
impl LcpSolution {
    /// The complementary variables z (m,); NaN unless the problem is solved.
    #[getter]
    fn z<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.z)
    }

    /// The slacks w = Mz + q (m,); NaN unless the problem is solved.
    #[getter]
    fn w<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.w)
    }

    /// For each pair (m,), True if z is basic. All entries are False unless the problem is solved.
    #[getter]
    fn basis<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_slice(py, &self.inner.basis)
    }

    /// How the solver ended: "solved", "ray" or "pivot_limit".
    #[getter]
    fn status(&self) -> &'static str {
        match self.inner.status {
            LcpStatus::Solved => "solved",
            LcpStatus::Ray => "ray",
            LcpStatus::PivotLimit => "pivot_limit",
            LcpStatus::Interrupted => "interrupted",
        }
    }

    /// The meaning of `status`, as a sentence.
    #[getter]
    fn message(&self) -> &'static str {
        self.inner.status.sentence()
    }

    /// Number of pivots, including the pivot by which the artificial variable enters.
    #[getter]
    fn pivots(&self) -> usize {
        self.inner.pivots
    }

    /// Direction v ≥ 0 (m,) of z on the ray, scaled to max v = 1; None unless the status is "ray". If Mᵀv ≤ 0 and qᵀv <
    /// 0, the problem is infeasible.
    #[getter]
    fn ray<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.inner.ray.as_ref().map(|ray| PyArray1::from_slice(py, ray))
    }

    fn __repr__(&self) -> String {
        format!("LcpSolution(order={}, status='{}', pivots={})", self.inner.z.len(), self.status(), self.inner.pivots)
    }
}
