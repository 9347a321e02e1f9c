use crate::arrays::{SpringArrays, element_rows, invalid, matrix, rows, sized, springs};
use crate::plate::Plate;
use crate::solution::ContactSolution;
use crate::threads::{released, told};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;
use signorini_core::cholesky::FactorError;
use signorini_core::contact::{self, Form, Graph, Method, PathEnd, PathLoad, Points, Progress, Stop, Supported};
use signorini_core::rows::Rows;
use std::cell::RefCell;
use std::sync::Arc;

/// A plate on its supports, factored once.
///
/// `held` (3n,) marks dofs with a prescribed value; `springs` is (elements, rows, further, stiffness, base);
/// `constraints` is (elements, rows, further, distance, law, scale, unit, regularization), one entry a contact point, whose
/// row may go on in further elements, at the end of `elements` and `rows`: its reaction is scale times the force of its law
/// at the travel (row·u − distance) / unit. `laws` are (vertices, slopes at both ends). `regularization` is the stiffness that the
/// factor carries of points that are condensed. `free_motions` (d, 3n) are the rigid motions that held dofs, springs and two-sided points leave free; none
/// if absent. `method` is "lemke", "active_set" or "saddle".
#[pyclass(frozen, module = "signorini._core")]
pub struct ContactProblem {
    pub inner: Arc<contact::ContactProblem>,
}

type ConstraintArrays<'py> = (
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
);

/// Vertices [travel, force], and slopes before the first and beyond the last.
type Law = (Vec<[f64; 2]>, [f64; 2]);

type PosedLcp<'py> =
    (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

pub fn failed(error: FactorError) -> PyErr {
    match error {
        FactorError::OutOfMemory | FactorError::TooLarge { .. } => PyMemoryError::new_err(error.to_string()),
        FactorError::NotPositiveDefinite { .. } => PyRuntimeError::new_err(error.to_string()),
    }
}

fn method_of(name: &str) -> PyResult<Method> {
    match name {
        "lemke" => Ok(Method::Lemke),
        "active_set" => Ok(Method::ActiveSet),
        "saddle" => Ok(Method::Saddle),
        other => Err(invalid(format!("unknown method '{other}'; there are lemke, active_set and saddle"))),
    }
}

/// Points with laws, which are numbered.
fn points_of(
    plate: &signorini_core::plate::Plate,
    rows: &Rows,
    distance: &[f64],
    laws: Vec<Law>,
    law: &[i64],
    scale: &[f64],
) -> PyResult<Points> {
    let mut points = Points::with_capacity(rows.len());
    let mut numbers = Vec::with_capacity(laws.len());
    for (vertices, ends) in laws {
        let is_straight = vertices.len() == 1 && ends[0] == ends[1];
        let graph = if is_straight { Ok(Graph::two_sided(ends[0])) } else { Graph::new(vertices, ends) };
        numbers.push(points.add_graph(graph.map_err(|error| invalid(error.to_string()))?));
    }
    for i in 0..rows.len() {
        let number = usize::try_from(law[i]).ok().and_then(|law| numbers.get(law));
        let &number = number.ok_or_else(|| invalid(format!("there is no law {}", law[i])))?;
        points.push_row(plate, rows, i, number, distance[i], scale[i]);
    }
    Ok(points)
}

fn form_of(name: &str) -> PyResult<Form> {
    match name {
        "dual" => Ok(Form::Dual),
        "stiffness" => Ok(Form::Stiffness),
        other => Err(invalid(format!("unknown form '{other}'; there are dual and stiffness"))),
    }
}

impl ContactProblem {
    /// A nodal load (3n,) and the prescribed values (3n,).
    fn load_and_held(
        &self,
        load: &PyReadonlyArray1<'_, f64>,
        held_value: &PyReadonlyArray1<'_, f64>,
    ) -> PyResult<(Vec<f64>, Vec<f64>)> {
        let dofs = self.inner.plate.dof_count();
        Ok((sized("the load", load, dofs)?, sized("held_value", held_value, dofs)?))
    }

    /// Refuses requests that need condensed points.
    fn require_condensed(&self) -> PyResult<()> {
        let condensed = self.inner.is_condensed();
        if condensed { Ok(()) } else { Err(invalid("points of an active set are not condensed")) }
    }

    /// Refuses objects made by another problem, which equal sizes would hide.
    pub fn require_own(&self, of: &Arc<contact::ContactProblem>, what: &str) -> PyResult<()> {
        if Arc::ptr_eq(of, &self.inner) { Ok(()) } else { Err(invalid(format!("{what} is of another problem"))) }
    }

    pub fn solution(&self, inner: contact::ContactSolution) -> ContactSolution {
        ContactSolution { inner, of: self.inner.clone() }
    }
}

/// Tells `progress` of a step, or looks for signals.
fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, now: Progress) -> PyResult<()> {
    match progress {
        Some(progress) => progress.call1(py, (now.step, now.changing, now.residual)).map(|_| ()),
        None => py.check_signals(),
    }
}

/// Runs a solve with the interpreter released; an exception in `progress`, or a signal, ends it.
fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    solve: impl Send + FnOnce(&mut dyn FnMut(Progress) -> bool) -> Result<T, FactorError>,
) -> PyResult<T> {
    told(py, |py, now| tell(py, progress.as_ref(), now), solve)?.map_err(failed)
}

/// Messages of a path.
enum News {
    Stop(f64, Vec<i64>, contact::ContactSolution),
    Progress(Progress),
}

#[pymethods]
impl ContactProblem {
    #[new]
    #[pyo3(signature = (plate, held, spring_arrays, constraint_arrays, laws, free_motions=None, method="lemke", room=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        plate: &Plate,
        held: PyReadonlyArray1<'_, bool>,
        spring_arrays: SpringArrays<'_>,
        constraint_arrays: ConstraintArrays<'_>,
        laws: Vec<Law>,
        free_motions: Option<PyReadonlyArray2<'_, f64>>,
        method: &str,
        room: Option<usize>,
    ) -> PyResult<Self> {
        let room = room.unwrap_or(usize::MAX);
        let held = sized("held", &held, plate.inner.dof_count())?;
        let springs = springs(&spring_arrays, &plate.inner)?;
        let (elements, coefficients, further, distance, law, scale, unit, regularization) = &constraint_arrays;
        let own = element_rows(elements, coefficients, further, &plate.inner)?;
        let m = own.len();
        let distance = sized("distance", distance, m)?;
        let law = sized("law", law, m)?;
        let scale = sized("scale", scale, m)?;
        let unit = sized("unit", unit, m)?;
        let delta = sized("regularization", regularization, m)?;
        let free_motions = free_motions.map_or(Vec::new(), |motions| rows(&motions));
        if free_motions.iter().any(|motion| motion.len() != held.len()) {
            return Err(invalid(format!("free_motions must have {} columns", held.len())));
        }
        let are_sizes = |v: &[f64]| v.iter().all(|x| *x >= 0.0 && x.is_finite());
        let are_lengths = unit.iter().all(|unit| *unit > 0.0 && unit.is_finite());
        if !are_sizes(&scale) || !are_lengths || !are_sizes(&delta) || distance.iter().any(|d| !d.is_finite()) {
            return Err(invalid(
                "scale and regularization must be finite and not negative, units positive, distances finite",
            ));
        }
        let method = method_of(method)?;
        let mut points = points_of(&plate.inner, &own, &distance, laws, &law, &scale)?;
        points.unit = unit;
        // Frees the arrays, which the points have copied: a million rows take considerable memory.
        drop(own);
        let on = Supported { springs, held, points, delta, free_motions };
        let shared = plate.inner.clone();
        let inner = released(py, || contact::ContactProblem::new(shared, on, method, room))?.map_err(failed)?;
        Ok(Self { inner: Arc::new(inner) })
    }

    /// The same problem with other distances (m,). It shares the factor.
    fn with_distance(&self, distance: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        let distance = sized("distance", &distance, self.inner.points.len())?;
        if distance.iter().any(|d| !d.is_finite()) {
            return Err(invalid("distances must be finite"));
        }
        Ok(Self { inner: Arc::new(self.inner.with_shift(distance)) })
    }

    /// Solves one load; `form` is "dual", "stiffness", or None for the better conditioned form. It starts from `start`,
    /// the solution of another load on the same problem, if given.
    ///
    /// `progress(step, changing, residual)` is called after every Newton step, with the number of points that changed
    /// their piece and the residual over the largest nodal force. An exception in it ends the solve.
    #[pyo3(signature = (load, held_value, form=None, start=None, progress=None))]
    fn solve(
        &self,
        py: Python<'_>,
        load: PyReadonlyArray1<'_, f64>,
        held_value: PyReadonlyArray1<'_, f64>,
        form: Option<&str>,
        start: Option<PyRef<'_, ContactSolution>>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<ContactSolution> {
        let (load, held_value) = self.load_and_held(&load, &held_value)?;
        let form = form.map(form_of).transpose()?;
        if let Some(start) = &start {
            self.require_own(&start.of, "The solution to begin with")?;
        }
        let start = start.as_ref().map(|start| &start.inner);
        let inner = watched(py, progress, |watch| self.inner.solve(&load, &held_value, form, start, watch))?;
        Ok(self.solution(inner))
    }

    /// Solves one load and factors its contact set, for others to begin with; None without an active set or a solution.
    /// `progress` as for `solve`.
    #[pyo3(signature = (load, held_value, progress=None))]
    fn solve_and_factor(
        &self,
        py: Python<'_>,
        load: PyReadonlyArray1<'_, f64>,
        held_value: PyReadonlyArray1<'_, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Option<ContactSolution>> {
        let (load, held_value) = self.load_and_held(&load, &held_value)?;
        let result = watched(py, progress, |watch| self.inner.solve_and_factor(&load, &held_value, watch))?;
        Ok(result.map(|inner| self.solution(inner)))
    }

    /// Displacements, reactions and gaps under one load on pieces (m,) that are given, beyond whose ends points may be.
    fn solve_on(
        &self,
        py: Python<'_>,
        load: PyReadonlyArray1<'_, f64>,
        held_value: PyReadonlyArray1<'_, f64>,
        pieces: PyReadonlyArray1<'_, u8>,
    ) -> PyResult<ContactSolution> {
        let (load, held_value) = self.load_and_held(&load, &held_value)?;
        let pieces = sized("pieces", &pieces, self.inner.points.len())?;
        let points = &self.inner.points;
        if (0..points.len()).any(|i| usize::from(pieces[i]) >= points.graph(i).pieces()) {
            return Err(invalid("pieces must be of the points' laws"));
        }
        let inner = released(py, || self.inner.solve_on(&load, &held_value, &pieces))?.map_err(failed)?;
        Ok(self.solution(inner))
    }

    /// Traces the load start + t add from t = 0 to `end`, and returns its end: "reached", "unbounded" (no more events),
    /// "no_equilibrium", "too_many" or "unsolved".
    ///
    /// `visit(t, switched, solution)` is called at the start, at every event and at the end, with the points that
    /// change their piece and the contact state from there on. An exception in it ends the path. `progress` is called
    /// between events, by steps of the solves.
    #[pyo3(signature = (start, add, held_value, end, visit, progress=None))]
    #[expect(clippy::too_many_arguments, reason = "Python's keyword arguments")]
    fn path(
        &self,
        py: Python<'_>,
        start: PyReadonlyArray1<'_, f64>,
        add: PyReadonlyArray1<'_, f64>,
        held_value: PyReadonlyArray1<'_, f64>,
        end: f64,
        visit: Py<PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<&'static str> {
        let dofs = self.inner.plate.dof_count();
        let start = sized("the load", &start, dofs)?;
        let add = sized("the load to be added", &add, dofs)?;
        let held_value = sized("held_value", &held_value, dofs)?;
        let load = PathLoad { start: &start, add: &add, held_value: &held_value, end };
        let hear = |py: Python<'_>, news: News| match news {
            News::Stop(t, switched, inner) => {
                visit.call1(py, (t, PyArray1::from_vec(py, switched), self.solution(inner))).map(|_| ())
            }
            News::Progress(now) => tell(py, progress.as_ref(), now),
        };
        let ended = told(py, hear, |show| {
            let show = RefCell::new(show);
            let mut visit = |stop: Stop| {
                let switched = stop.switched.iter().map(|&i| i as i64).collect();
                show.borrow_mut()(News::Stop(stop.t, switched, stop.solution.clone()))
            };
            self.inner.path(&load, &mut visit, &mut |now| show.borrow_mut()(News::Progress(now)))
        })?;
        Ok(match ended.map_err(failed)? {
            PathEnd::Reached => "reached",
            PathEnd::Unbounded => "unbounded",
            PathEnd::NoEquilibrium => "no_equilibrium",
            PathEnd::TooMany => "too_many",
            PathEnd::Unsolved | PathEnd::Interrupted => "unsolved",
        })
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
        let (load, held_value) = self.load_and_held(&load, &held_value)?;
        let form = form.map(form_of).transpose()?;
        self.require_condensed()?;
        let posed = released(py, || self.inner.lcp(&load, &held_value, form))?.map_err(failed)?;
        let size = posed.q.len();
        Ok((
            matrix(py, posed.matrix, size)?,
            PyArray1::from_vec(py, posed.q),
            PyArray1::from_vec(py, posed.rows.iter().map(|row| row.point as i64).collect()),
            PyArray1::from_vec(py, posed.rows.iter().map(|row| row.w_is_a_force(&self.inner.points)).collect()),
        ))
    }

    /// K⁻¹ (with the regularization on top of K) times a nodal load (3n,).
    fn apply_inverse<'py>(
        &self,
        py: Python<'py>,
        load: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let load = sized("the load", &load, self.inner.plate.dof_count())?;
        let out = released(py, || self.inner.apply_inverse(&load))?.map_err(failed)?;
        Ok(PyArray1::from_vec(py, out))
    }

    /// Seconds spent to order, factor and condense.
    #[getter]
    fn seconds(&self) -> (f64, f64, f64) {
        let s = self.inner.seconds;
        (s.order, s.factor, s.condense)
    }

    /// Numbers stored for the factor.
    #[getter]
    fn factor_entries(&self) -> usize {
        self.inner.factor_size().0
    }

    /// Multiplications and additions that the factorization takes.
    #[getter]
    fn factor_flops(&self) -> f64 {
        self.inner.factor_size().1
    }
}
