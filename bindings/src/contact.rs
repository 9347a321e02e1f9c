use crate::arrays::{SpringArrays, element_rows, indices, invalid, matrix, rows, springs, vector};
use crate::plate::Plate;
use crate::solution::ContactSolution;
use crate::threads::{released, told};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyMemoryError, PyRuntimeError};
use pyo3::prelude::*;
use signorini_core::cholesky::FactorError;
use signorini_core::contact::{
    self, Form, Graph, Load, Method, PathEnd, PathLoad, PointLaws, Points, Progress, Settings, SolveError, Stop,
    Supported,
};
use std::cell::RefCell;
use std::sync::Arc;

/// Plates on their supports, factored once for all loads.
///
/// `held` (3n,) is true for dofs with a prescribed value. `springs` is (elements, rows, further, stiffness, base):
/// spring i has the force stiffness_i (g_i·u − base_i). The last q entries of `elements` and `rows` continue the rows
/// with the numbers `further` (q,) in other elements. `points` is a dict of arrays, the fields of `ContactPoints`. Each
/// of `laws` is (vertices [travel, force], slopes before the first and after the last vertex). `free_motions` (d, 3n)
/// are the rigid motions that held dofs, springs and two-sided points leave free; None means d = 0. `method` is
/// "lemke", "active_set" or "saddle". With `like`, a problem of the same plate, the new problem shares ordering, factor
/// and condensation if they would be equal.
#[pyclass(frozen, module = "signorini._core")]
pub struct ContactProblem {
    pub inner: Arc<contact::ContactProblem>,
}

/// Arrays of m contact points. The reaction of a point is `scale` times the force of its law at the travel (row·u −
/// `distance`) / `unit`.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct ContactPoints<'py> {
    elements: PyReadonlyArray1<'py, i64>,
    rows: PyReadonlyArray2<'py, f64>,
    /// Row number (q,) of each of the last q entries of `elements` and `rows`. These have m + q entries, since a row that
    /// acts on several elements has one entry for each element.
    further: PyReadonlyArray1<'py, i64>,
    distance: PyReadonlyArray1<'py, f64>,
    law: PyReadonlyArray1<'py, i64>,
    scale: PyReadonlyArray1<'py, f64>,
    unit: PyReadonlyArray1<'py, f64>,
    /// Stiffness δ (m,), force/length, that the factor includes at condensed points.
    regularization: PyReadonlyArray1<'py, f64>,
}

/// A law: vertices [travel, force], and the slopes before the first and after the last vertex.
type Law = (Vec<[f64; 2]>, [f64; 2]);

type PosedLcp<'py> =
    (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<bool>>);

pub fn failed(error: SolveError) -> PyErr {
    match error {
        SolveError::Factor(FactorError::OutOfMemory | FactorError::TooLarge { .. }) => {
            PyMemoryError::new_err(error.to_string())
        }
        SolveError::Length { .. } | SolveError::Value { .. } | SolveError::NotCondensed | SolveError::Condensed => {
            invalid(error)
        }
        _ => PyRuntimeError::new_err(error.to_string()),
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

fn graph_of((vertices, ends): Law) -> PyResult<Graph> {
    let is_straight = vertices.len() == 1 && ends[0] == ends[1];
    if is_straight { Ok(Graph::two_sided(ends[0])) } else { Graph::new(vertices, ends).map_err(invalid) }
}

fn settings_of(form: Option<&str>) -> PyResult<Settings> {
    Ok(Settings { form: form.map(form_of).transpose()? })
}

fn form_of(name: &str) -> PyResult<Form> {
    match name {
        "dual" => Ok(Form::Dual),
        "stiffness" => Ok(Form::Stiffness),
        other => Err(invalid(format!("unknown form '{other}'; there are dual and stiffness"))),
    }
}

impl ContactProblem {
    /// Raises an error if an object belongs to another contact problem. If both problems have the same sizes, the
    /// mistake would otherwise go unnoticed.
    pub fn require_own(&self, of: &Arc<contact::ContactProblem>, what: &str) -> PyResult<()> {
        if Arc::ptr_eq(of, &self.inner) { Ok(()) } else { Err(invalid(format!("{what} is of another problem"))) }
    }

    pub fn solution(&self, solved: Result<contact::ContactSolution, SolveError>) -> PyResult<ContactSolution> {
        ContactSolution::of(&self.inner, solved)
    }
}

/// Calls `progress` with the step number, the number of changing points and the residual. Without `progress`, checks
/// for signals.
fn tell(py: Python<'_>, progress: Option<&Py<PyAny>>, now: Progress) -> PyResult<()> {
    match progress {
        Some(progress) => progress.call1(py, (now.step, now.changing, now.residual)).map(|_| ()),
        None => py.check_signals(),
    }
}

/// Runs a solve without Python's interpreter lock. An exception in `progress`, or a signal, ends the solve.
fn watched<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    solve: impl Send + FnOnce(&mut dyn FnMut(Progress) -> bool) -> Result<T, SolveError>,
) -> PyResult<Result<T, SolveError>> {
    told(py, |py, now| tell(py, progress.as_ref(), now), solve)
}

/// Messages from the path tracer to the thread of the Python interpreter.
enum News {
    Stop(f64, Vec<i64>, contact::ContactSolution),
    Progress(Progress),
}

#[pymethods]
impl ContactProblem {
    #[new]
    #[pyo3(signature = (plate, held, spring_arrays, points, laws, free_motions=None, method="lemke", room=None, like=None))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        plate: &Plate,
        held: PyReadonlyArray1<'_, bool>,
        spring_arrays: SpringArrays<'_>,
        points: ContactPoints<'_>,
        laws: Vec<Law>,
        free_motions: Option<PyReadonlyArray2<'_, f64>>,
        method: &str,
        room: Option<usize>,
        like: Option<PyRef<'_, ContactProblem>>,
    ) -> PyResult<Self> {
        let room = room.unwrap_or(usize::MAX);
        let springs = springs(&spring_arrays, &plate.inner)?;
        let table = element_rows(&points.elements, &points.rows, &points.further, &plate.inner)?;
        let graph = indices("the law of a point", &points.law, laws.len())?;
        let laws = PointLaws {
            graphs: laws.into_iter().map(graph_of).collect::<PyResult<_>>()?,
            graph,
            shift: vector(&points.distance),
            weight: vector(&points.scale),
            unit: vector(&points.unit),
        };
        let on = Supported {
            springs,
            held: vector(&held),
            points: Points::on_rows(&plate.inner, &table, laws).map_err(failed)?,
            delta: vector(&points.regularization),
            free_motions: free_motions.map_or(Vec::new(), |motions| rows(&motions)),
        };
        // `Points` has a copy of the table of rows. The table is freed, since a million rows take considerable memory.
        drop(table);
        let method = method_of(method)?;
        let shared = plate.inner.clone();
        let like = like.map(|like| like.inner.clone()).filter(|like| like.method() == method);
        let inner = released(py, || match like.filter(|like| Arc::ptr_eq(&like.plate, &shared)) {
            Some(like) => like.on_other_supports(on, room),
            None => contact::ContactProblem::new(shared, on, method, room),
        })?
        .map_err(failed)?;
        Ok(Self { inner: Arc::new(inner) })
    }

    /// The same problem with other gaps `distance` (m,) of the contact points. Both problems share the factor.
    fn with_distance(&self, distance: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        Ok(Self { inner: Arc::new(self.inner.with_shift(vector(&distance)).map_err(failed)?) })
    }

    /// Solves one load. `form` is "dual", "stiffness", or None for the better conditioned form of the LCP. The solve
    /// starts from `start`, the solution of another load on the same problem.
    ///
    /// `progress(step, changing, residual)` is called after Newton steps or pivots. `changing` is the number of points
    /// that changed their piece of the law, `residual` is relative to the largest nodal force. An exception in
    /// `progress` ends the solve.
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
        let (nodal, held_value) = (vector(&load), vector(&held_value));
        let (load, settings) = (Load { nodal: &nodal, held_value: &held_value }, settings_of(form)?);
        if let Some(start) = &start {
            self.require_own(&start.of, "The solution to begin with")?;
        }
        let start = start.as_ref().and_then(|start| start.solved());
        self.solution(watched(py, progress, |watch| self.inner.solve(&load, &settings, start, watch))?)
    }

    /// Solves one load and factors K with the springs of its contact state, for warm starts of other loads. None if the
    /// points are condensed, or if there is no solution. `progress` is called as in `solve`.
    #[pyo3(signature = (load, held_value, progress=None))]
    fn solve_and_factor(
        &self,
        py: Python<'_>,
        load: PyReadonlyArray1<'_, f64>,
        held_value: PyReadonlyArray1<'_, f64>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Option<ContactSolution>> {
        let (nodal, held_value) = (vector(&load), vector(&held_value));
        let load = Load { nodal: &nodal, held_value: &held_value };
        match watched(py, progress, |watch| self.inner.solve_and_factor(&load, watch))? {
            Ok(Some(solution)) => self.solution(Ok(solution)).map(Some),
            Ok(None) | Err(SolveError::NoEquilibrium | SolveError::Unsolved | SolveError::Condensed) => Ok(None),
            Err(error) => Err(failed(error)),
        }
    }

    /// Displacements, reactions and gaps under one load on the contact state `pieces` (m,). Points may be beyond the
    /// ends of their pieces of the laws.
    fn solve_on(
        &self,
        py: Python<'_>,
        load: PyReadonlyArray1<'_, f64>,
        held_value: PyReadonlyArray1<'_, f64>,
        pieces: PyReadonlyArray1<'_, u8>,
    ) -> PyResult<ContactSolution> {
        let (nodal, held_value) = (vector(&load), vector(&held_value));
        let (load, pieces) = (Load { nodal: &nodal, held_value: &held_value }, vector(&pieces));
        self.solution(released(py, || self.inner.solve_on(&load, &pieces))?)
    }

    /// Traces the path of solutions under the load `start` + t `add` from t = 0 to t = `end`. Returns how the path
    /// ended: "reached", "unbounded" (no more events), "no_equilibrium", "too_many" (events) or "unsolved".
    ///
    /// `visit(t, switched, solution)` is called at the start, at every event and at the end. `switched` are the points
    /// that change their piece of the law; `solution.piece` is the contact state after the event. An exception in
    /// `visit` ends the path. `progress` is called between events, at every step of the solves.
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
        let (start, add, held_value) = (vector(&start), vector(&add), vector(&held_value));
        let load = PathLoad { start: &start, add: &add, held_value: &held_value, end };
        let hear = |py: Python<'_>, news: News| match news {
            News::Stop(t, switched, inner) => {
                visit.call1(py, (t, PyArray1::from_vec(py, switched), self.solution(Ok(inner))?)).map(|_| ())
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
    /// The LCP w = Mz + q of the contact points under one load: M (k, k), q (k,), the contact point of each row, and
    /// whether w of each row is a force.
    fn lcp<'py>(
        &self,
        py: Python<'py>,
        load: PyReadonlyArray1<'_, f64>,
        held_value: PyReadonlyArray1<'_, f64>,
        form: Option<&str>,
    ) -> PyResult<PosedLcp<'py>> {
        let (nodal, held_value) = (vector(&load), vector(&held_value));
        let (load, settings) = (Load { nodal: &nodal, held_value: &held_value }, settings_of(form)?);
        let (template, q) = released(py, || self.inner.lcp(&load, &settings))?.map_err(failed)?;
        let rows = &template.vertices.rows;
        Ok((
            matrix(py, template.matrix.clone(), q.len())?,
            PyArray1::from_vec(py, q),
            PyArray1::from_vec(py, rows.iter().map(|row| row.point as i64).collect()),
            PyArray1::from_vec(py, rows.iter().map(|row| row.w_is_a_force(&self.inner.points)).collect()),
        ))
    }

    /// Displacements K̃⁻¹f (3n,) under a nodal load f, where K̃ = K + Gᵀ diag(δ) G includes the springs δ =
    /// `regularization` at the contact points.
    fn apply_inverse<'py>(
        &self,
        py: Python<'py>,
        load: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let load = vector(&load);
        let out = released(py, || self.inner.apply_inverse(&load))?.map_err(failed)?;
        Ok(PyArray1::from_vec(py, out))
    }

    /// Seconds that ordering, factorization and condensation took.
    #[getter]
    fn seconds(&self) -> (f64, f64, f64) {
        let s = self.inner.seconds;
        (s.order, s.factor, s.condense)
    }

    /// Number of stored entries of the factored matrix.
    #[getter]
    fn factor_entries(&self) -> usize {
        self.inner.factor_size().0
    }

    /// Number of multiplications and additions of the factorization.
    #[getter]
    fn factor_flops(&self) -> f64 {
        self.inner.factor_size().1
    }
}
