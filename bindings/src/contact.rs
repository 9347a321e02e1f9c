use crate::arrays::{SpringArrays, element_rows, flags, invalid, matrix, sized, springs};
use crate::plate::Plate;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;
use signorini_core::cholesky::FactorError;
use signorini_core::contact::{self, Constraints, Form, Outcome};

/// A plate on its supports, factored once.
///
/// `held` (3n,) marks dofs with a prescribed value; `springs` is (elements, rows, stiffness, base); `constraints` is
/// (elements, rows, distance, compliance, two_sided, regularization), one entry a contact point:
/// row·u + gap − compliance·reaction = distance. `free_motions` (d, 3n) are the rigid motions that held dofs, springs and
/// two-sided points leave free; none if absent. `soft` (m,) marks elastic points that the active set handles, none if
/// absent: the factor carries their stiffness.
#[pyclass(frozen, module = "signorini._core")]
pub struct ContactProblem {
    pub inner: contact::ContactProblem,
}

type ConstraintArrays<'py> = (
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, bool>,
    PyReadonlyArray1<'py, f64>,
);

type PosedLcp<'py> =
    (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

fn rows_of(matrix: &PyReadonlyArray2<'_, f64>) -> Vec<Vec<f64>> {
    matrix.as_array().rows().into_iter().map(|row| row.to_vec()).collect()
}

pub fn failed(error: FactorError) -> PyErr {
    match error {
        FactorError::OutOfMemory => PyMemoryError::new_err(error.to_string()),
        FactorError::NotPositiveDefinite { .. } => PyRuntimeError::new_err(error.to_string()),
    }
}

fn form_of(name: &str) -> PyResult<Form> {
    match name {
        "dual" => Ok(Form::Dual),
        "stiffness" => Ok(Form::Stiffness),
        other => Err(invalid(format!("unknown form '{other}'; there are dual and stiffness"))),
    }
}

#[pymethods]
impl ContactProblem {
    #[new]
    #[pyo3(signature = (plate, held, spring_arrays, constraint_arrays, free_motions=None, soft=None))]
    fn new(
        py: Python<'_>,
        plate: &Plate,
        held: PyReadonlyArray1<'_, bool>,
        spring_arrays: SpringArrays<'_>,
        constraint_arrays: ConstraintArrays<'_>,
        free_motions: Option<PyReadonlyArray2<'_, f64>>,
        soft: Option<PyReadonlyArray1<'_, bool>>,
    ) -> PyResult<Self> {
        let count = plate.inner.elements().len();
        let held = flags("held", &held, plate.inner.dof_count())?;
        let springs = springs(&spring_arrays, count)?;
        let (elements, rows, distance, compliance, two_sided, regularization) = &constraint_arrays;
        let rows = element_rows(elements, rows, count)?;
        let m = rows.len();
        let soft = soft.map_or(Ok(Vec::new()), |soft| flags("soft", &soft, m))?;
        let constraints = Constraints {
            rows,
            distance: sized("distance", distance, m)?,
            compliance: sized("compliance", compliance, m)?,
            two_sided: flags("two_sided", two_sided, m)?,
            regularization: sized("regularization", regularization, m)?,
            free_motions: free_motions.map_or(Vec::new(), |motions| rows_of(&motions)),
        };
        if constraints.free_motions.iter().any(|motion| motion.len() != held.len()) {
            return Err(invalid(format!("free_motions must have {} columns", held.len())));
        }
        let not_negative = |v: &[f64]| v.iter().all(|x| *x >= 0.0 && x.is_finite());
        if !not_negative(&constraints.compliance)
            || !not_negative(&constraints.regularization)
            || constraints.distance.iter().any(|d| !d.is_finite())
        {
            return Err(invalid("compliance and regularization must be finite and not negative, distances finite"));
        }
        let shared = plate.inner.clone();
        let inner =
            py.detach(|| contact::ContactProblem::new(shared, springs, held, constraints, &soft)).map_err(failed)?;
        Ok(Self { inner })
    }

    /// Solves one load; `form` is "dual", "stiffness", or None for the better conditioned of them.
    #[pyo3(signature = (load, held_value, form=None, max_pivots=None))]
    fn solve(
        &self,
        py: Python<'_>,
        load: PyReadonlyArray1<'_, f64>,
        held_value: PyReadonlyArray1<'_, f64>,
        form: Option<&str>,
        max_pivots: Option<usize>,
    ) -> PyResult<ContactSolution> {
        let dofs = self.inner.plate.dof_count();
        let load = sized("the load", &load, dofs)?;
        let held_value = sized("held_value", &held_value, dofs)?;
        let form = form.map(form_of).transpose()?;
        let inner = py.detach(|| self.inner.solve(&load, &held_value, form, max_pivots)).map_err(failed)?;
        Ok(ContactSolution { inner })
    }

    #[pyo3(signature = (load, held_value, form=None))]
    /// The LCP of one load: M (k, k), q (k,), the contact point of each row, and whether its unknown is the gap.
    fn lcp<'py>(
        &self,
        py: Python<'py>,
        load: PyReadonlyArray1<'_, f64>,
        held_value: PyReadonlyArray1<'_, f64>,
        form: Option<&str>,
    ) -> PyResult<PosedLcp<'py>> {
        let dofs = self.inner.plate.dof_count();
        let load = sized("the load", &load, dofs)?;
        let held_value = sized("held_value", &held_value, dofs)?;
        let form = form.map(form_of).transpose()?;
        let posed = py.detach(|| self.inner.lcp(&load, &held_value, form)).map_err(failed)?;
        let size = posed.q.len();
        Ok((
            matrix(py, posed.matrix, size)?,
            PyArray1::from_vec(py, posed.q),
            PyArray1::from_vec(py, posed.point.into_iter().map(|i| i as i64).collect()),
            PyArray1::from_vec(py, posed.gap_is_z),
        ))
    }

    /// K⁻¹ (with the regularization on top of K) times a nodal load (3n,).
    fn apply_inverse<'py>(
        &self,
        py: Python<'py>,
        load: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let load = sized("the load", &load, self.inner.plate.dof_count())?;
        let out = py.detach(|| self.inner.apply_inverse(&load)).map_err(failed)?;
        Ok(PyArray1::from_vec(py, out))
    }

    /// Seconds spent to order, assemble, factor and condense.
    #[getter]
    fn seconds(&self) -> (f64, f64, f64, f64) {
        let s = self.inner.seconds;
        (s.order, s.assemble, s.factor, s.condense)
    }

    /// Numbers stored for the factor.
    #[getter]
    fn factor_entries(&self) -> usize {
        self.inner.factor.entries()
    }
}

/// Displacements (3n,) as two doubles, reactions, gaps and states (m,) of one load.
#[pyclass(frozen, module = "signorini._core")]
pub struct ContactSolution {
    inner: contact::ContactSolution,
}

#[pymethods]
impl ContactSolution {
    /// "solved", "no_equilibrium" or "unsolved".
    #[getter]
    fn status(&self) -> &'static str {
        match self.inner.outcome {
            Outcome::Solved => "solved",
            Outcome::NoEquilibrium => "no_equilibrium",
            Outcome::Unsolved => "unsolved",
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

    #[getter]
    fn closed<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_slice(py, &self.inner.closed)
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
    fn corrections(&self) -> usize {
        self.inner.corrections
    }
}
