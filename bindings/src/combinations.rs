use crate::arrays::{invalid, rows, rows_of, vector};
use crate::contact::{ContactProblem, failed};
use crate::plate::Plate;
use crate::threads::{interruptible, released};
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadwriteArray1,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use signorini_core::contact::{self, SolveError};
use signorini_core::displacement::Displacement;
use signorini_core::fields::{Bars, Formula};
use signorini_core::plate;
use signorini_core::stress::{Strained, smoothed_together};
use signorini_core::superposition::{self, Envelope, Fields, LeftOut};
use std::sync::Arc;

/// The response to one load case or to one contact point: displacements (3n,) as two doubles, reactions (m,) and
/// displacements (m,) of the contact points.
#[pyclass(frozen, module = "signorini._core")]
pub struct Response {
    inner: contact::Response,
    of: Arc<contact::ContactProblem>,
}

#[pymethods]
impl Response {
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

    /// A copy of this response without nodal displacements, which `combine` does not need.
    fn at_points(&self) -> Self {
        Self { inner: at_points(self), of: self.of.clone() }
    }

    #[getter]
    fn moved<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.moved)
    }
}

/// Condensed load cases, which all combinations of `combine` share.
#[pyclass(frozen, module = "signorini._core")]
pub struct CombinedCases {
    inner: contact::CombinedCases,
    of: Arc<contact::ContactProblem>,
}

type Combined<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray2<bool>>,
    Bound<'py, PyArray1<i64>>,
);

/// A copy of a response without nodal displacements, which `combine` does not need.
fn at_points(response: &Response) -> contact::Response {
    let r = &response.inner;
    contact::Response {
        displacement: Default::default(),
        reaction: r.reaction.clone(),
        moved: r.moved.clone(),
        work: r.work.clone(),
    }
}

/// The response without load: held dofs have the values `held_value` (3n,), and bases of springs their prescribed
/// displacements.
#[pyfunction]
pub fn rest_response(
    problem: &ContactProblem,
    py: Python<'_>,
    held_value: PyReadonlyArray1<'_, f64>,
) -> PyResult<Response> {
    let held_value = vector(&held_value);
    let inner = released(py, || problem.inner.rest_response(&held_value))?.map_err(failed)?;
    Ok(Response { inner, of: problem.inner.clone() })
}

/// The responses to nodal loads (k, 3n), with zero displacement at held dofs and at bases of springs.
#[pyfunction]
pub fn load_responses(
    problem: &ContactProblem,
    py: Python<'_>,
    loads: PyReadonlyArray2<'_, f64>,
) -> PyResult<Vec<Response>> {
    let loads = rows(&loads);
    let result = interruptible(py, |watch| problem.inner.load_responses(&loads, watch))?.map_err(failed)?;
    Ok(result.into_iter().map(|inner| Response { inner, of: problem.inner.clone() }).collect())
}

/// The responses to the contact points `first` to `end` − 1, each for a unit displacement of the point or for a unit
/// force at the point.
#[pyfunction]
pub fn point_responses(problem: &ContactProblem, py: Python<'_>, first: usize, end: usize) -> PyResult<Vec<Response>> {
    let result = interruptible(py, |watch| problem.inner.point_responses(first..end, watch))?.map_err(failed)?;
    Ok(result.into_iter().map(|inner| Response { inner, of: problem.inner.clone() }).collect())
}

/// Condenses load cases for `combine`, from the response without load (`rest`), the responses to the cases, and the
/// responses to all contact points.
#[pyfunction]
pub fn combined_cases(
    problem: &ContactProblem,
    py: Python<'_>,
    rest: PyRef<'_, Response>,
    cases: Vec<PyRef<'_, Response>>,
    points: Vec<PyRef<'_, Response>>,
) -> PyResult<CombinedCases> {
    for (what, responses) in [("the cases", &cases), ("the points", &points)] {
        for response in responses {
            problem.require_own(&response.of, &format!("a response of {what}"))?;
        }
    }
    problem.require_own(&rest.of, "the response at rest")?;
    let rest = at_points(&rest);
    let cases: Vec<_> = cases.iter().map(|case| at_points(case)).collect();
    let points: Vec<_> = points.iter().map(|point| at_points(point)).collect();
    let result = interruptible(py, |watch| problem.inner.combined_cases(rest, cases, &points, watch))?;
    Ok(CombinedCases { inner: result.map_err(failed)?, of: problem.inner.clone() })
}

/// Solves combinations in parallel. `factors` (k, c) has, for each combination, the factors of the load cases. No
/// result depends on another combination.
///
/// Returns verdicts (k,): 0 solved, 1 no equilibrium, 2 must be solved separately. Then follow the factors of the
/// responses to the points, the reactions and the gaps (k, m), whether each point has a force (k, m), and the number of
/// pivots (k,).
#[pyfunction]
pub fn combine<'py>(
    problem: &ContactProblem,
    py: Python<'py>,
    cases: PyRef<'_, CombinedCases>,
    factors: PyReadonlyArray2<'_, f64>,
) -> PyResult<Combined<'py>> {
    problem.require_own(&cases.of, "the condensed load cases")?;
    let factors = rows(&factors);
    let shared = &cases.inner;
    let result = interruptible(py, |watch| problem.inner.combine(shared, &factors, watch))?.map_err(failed)?;
    let count = problem.inner.points.len();
    let verdict = |combined: &Result<contact::Combined, SolveError>| match combined {
        Ok(_) => 0,
        Err(SolveError::NoEquilibrium) => 1,
        Err(_) => 2,
    };
    let table = |of: fn(&contact::Combined) -> &[f64]| {
        let mut values = vec![f64::NAN; result.len() * count];
        for (row, combined) in values.chunks_exact_mut(count.max(1)).zip(&result) {
            combined.iter().for_each(|combined| row.copy_from_slice(of(combined)));
        }
        PyArray1::from_vec(py, values).reshape([result.len(), count])
    };
    let none = vec![0; count];
    let pieces = |combined: &Result<contact::Combined, SolveError>| {
        problem.inner.points.acting(combined.as_ref().map_or(&none, |combined| &combined.piece))
    };
    let pivots = result.iter().map(|combined| combined.as_ref().map_or(0, |combined| combined.pivots as i64)).collect();
    Ok((
        PyArray1::from_vec(py, result.iter().map(verdict).collect()),
        table(|combined| &combined.factor)?,
        table(|combined| &combined.reaction)?,
        table(|combined| &combined.gap)?,
        PyArray1::from_vec(py, result.iter().flat_map(pieces).collect()).reshape([result.len(), count])?,
        PyArray1::from_vec(py, pivots),
    ))
}

/// Moments and shears [mx, my, mxy, qx, qy] at nodes (b, n, 5) for b displacements. Each displacement comes with the
/// plate that it belongs to.
pub fn stresses<'py>(
    py: Python<'py>,
    plate: &Plate,
    displacements: Vec<(&plate::Plate, &Displacement)>,
    curvatures: &PyReadonlyArray2<'_, f64>,
    couples: &PyReadonlyArray2<'_, f64>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let (number, nodes) = (displacements.len(), plate.inner.stress_nodes().1);
    if displacements.iter().any(|(of, _)| !std::ptr::eq(*of, &*plate.inner)) {
        return Err(invalid("a displacement belongs to another plate"));
    }
    let curvatures = rows_of::<3, f64>("curvatures", curvatures)?;
    if curvatures.len() != number || couples.shape() != [number, 2 * plate.inner.elements().len()] {
        return Err(invalid("curvatures (b, 3) and couples (b, 2e) must have a row for every displacement"));
    }
    let couples = rows(couples);
    let strained: Vec<Strained> = displacements
        .iter()
        .zip(curvatures)
        .zip(&couples)
        .map(|(((_, displacement), curvature), couples)| Strained { displacement, curvature, couples })
        .collect();
    let nodal = released(py, || smoothed_together(&plate.inner, &strained))?;
    let values = nodal.into_iter().flat_map(|stress| stress.into_flattened()).collect();
    PyArray1::from_vec(py, values).reshape([number, nodes, 5])
}

/// Product (k, n) of coefficients (k, b) and vectors (b, n). Each sum adds the vectors in their order.
#[pyfunction]
pub fn superpose<'py>(
    py: Python<'py>,
    coefficients: PyReadonlyArray2<'py, f64>,
    vectors: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (count, length) = (vectors.shape()[0], vectors.shape()[1]);
    if coefficients.shape()[1] != count {
        return Err(invalid(format!("{} coefficients for {count} vectors", coefficients.shape()[1])));
    }
    let number = coefficients.shape()[0];
    let (coefficients, vectors) = (coefficients.as_slice()?, vectors.as_slice()?);
    let mut out = released(py, || superposition::superpose(coefficients, vectors, count))?;
    out.resize(number * length, 0.0);
    PyArray1::from_vec(py, out).reshape([number, length])
}

type Peaks<'py> = (Bound<'py, PyArray3<f64>>, Bound<'py, PyArray3<i64>>);
/// The envelope of a field, four vectors (n,): largest values, their combinations, smallest values, their combinations.
type Bounds<'py> = (
    PyReadwriteArray1<'py, f64>,
    PyReadwriteArray1<'py, i64>,
    PyReadwriteArray1<'py, f64>,
    PyReadwriteArray1<'py, i64>,
);

/// Updates the envelopes (n,) of f fields in place with k combinations, whose numbers are `who` (k,).
///
/// Each field is a value of one of `formulas`, which are described at `evaluate`. Their inputs are sums of vectors: row
/// i of `coefficients` (k, b) multiplies the b vectors (b, n) of each of `inputs`. `wanted` (f,) are the indices of the
/// fields among the values of all formulas. Returns the largest and the smallest value (f, k, 2) of each field and
/// combination, and the indices of these values (f, k, 2). Entry i is excluded from them if `left_out` (k, c) is true
/// for the class `classes[i]`.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn envelop<'py>(
    py: Python<'py>,
    coefficients: PyReadonlyArray2<'py, f64>,
    inputs: Vec<PyReadonlyArray2<'py, f64>>,
    formulas: Vec<String>,
    wanted: Vec<usize>,
    thickness: PyReadonlyArray1<'py, f64>,
    bars: Vec<f64>,
    who: PyReadonlyArray1<'py, i64>,
    mut bounds: Vec<Bounds<'py>>,
    classes: PyReadonlyArray1<'py, i64>,
    left_out: PyReadonlyArray2<'py, bool>,
) -> PyResult<Peaks<'py>> {
    let (number, length, count) = (who.len(), classes.len(), coefficients.shape()[1]);
    let formulas = formulas.iter().map(|name| formula(name, &bars)).collect::<PyResult<Vec<Formula>>>()?;
    let values: usize = formulas.iter().map(|formula| formula.values()).sum();
    let sizes = |one: &Bounds<'_>| [one.0.len(), one.1.len(), one.2.len(), one.3.len()];
    if coefficients.shape()[0] != number
        || inputs.is_empty()
        || inputs.iter().any(|vectors| vectors.shape() != [count, length])
        || bounds.iter().flat_map(sizes).any(|size| size != length)
        || thickness.len() != length
    {
        return Err(invalid("coefficients (k, b), inputs (b, n), who (k,) and envelopes (n,) must agree"));
    }
    if formulas.iter().any(|formula| formula.inputs() != inputs.len())
        || wanted.len() != bounds.len()
        || wanted.iter().any(|&value| value >= values)
    {
        return Err(invalid("every formula must have as many inputs as given, every index in wanted an envelope"));
    }
    let (class, count_of) = (classes.as_slice()?, left_out.shape()[1]);
    if left_out.shape()[0] != number || class.iter().any(|&c| c < 0 || c as usize >= count_of) {
        return Err(invalid("classes (n,) must be from 0 to c - 1, and left_out must have shape (k, c)"));
    }
    let left_out = LeftOut { class, sums: left_out.as_slice()?, classes: count_of };
    let vectors = inputs.iter().map(|vectors| Ok(vectors.as_slice()?)).collect::<PyResult<Vec<&[f64]>>>()?;
    let (coefficients, who) = (coefficients.as_slice()?, who.as_slice()?);
    let fields = Fields { formulas: &formulas, wanted: &wanted, thickness: thickness.as_slice()? };
    let envelopes = bounds
        .iter_mut()
        .map(|(largest, largest_by, smallest, smallest_by)| {
            Ok(Envelope {
                largest: largest.as_slice_mut()?,
                largest_by: largest_by.as_slice_mut()?,
                smallest: smallest.as_slice_mut()?,
                smallest_by: smallest_by.as_slice_mut()?,
            })
        })
        .collect::<PyResult<Vec<Envelope<'_>>>>()?;
    let peaks = released(py, || superposition::envelop(coefficients, &vectors, &fields, who, envelopes, left_out))?;
    let each = || peaks.iter().flatten();
    let values = each().flat_map(|peak| [peak.largest, peak.smallest]).collect();
    let places = each().flat_map(|peak| [peak.largest_at as i64, peak.smallest_at as i64]).collect();
    let shape = [wanted.len(), number, 2];
    Ok((PyArray1::from_vec(py, values).reshape(shape)?, PyArray1::from_vec(py, places).reshape(shape)?))
}

/// The formula with the given name. `bars` are the fields of the Rust struct `Bars` in order; only the formula "steel"
/// needs them.
fn formula(name: &str, bars: &[f64]) -> PyResult<Formula> {
    Ok(match name {
        "sum" => Formula::Sum,
        "principal" => Formula::Principal,
        "angle" => Formula::Angle,
        "design" => Formula::Design,
        "face" => Formula::Face,
        "shear" => Formula::Shear,
        "steel" => match *bars {
            [a, b, c, d, block, yield_stress, deepest, least, most, plain] => {
                Formula::Steel(Bars { distance: [a, b, c, d], block, yield_stress, deepest, least, most, plain })
            }
            _ => return Err(invalid("the formula steel needs 10 numbers in bars")),
        },
        _ => return Err(invalid(format!("unknown formula {name}"))),
    })
}

/// Values (n, c) of a formula from its inputs (n, i), moments mx, my, mxy or shears qx, qy, and thickness (n,).
///
/// `signorini_core::fields::Formula` describes the formulas.
#[pyfunction]
pub fn evaluate<'py>(
    py: Python<'py>,
    name: &str,
    inputs: PyReadonlyArray2<'py, f64>,
    thickness: PyReadonlyArray1<'py, f64>,
    bars: Vec<f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let formula = formula(name, &bars)?;
    if inputs.shape() != [thickness.len(), formula.inputs()] {
        return Err(invalid(format!("{name} needs inputs (n, {}) and thickness (n,)", formula.inputs())));
    }
    let values = formula.of(inputs.as_slice()?, thickness.as_slice()?);
    PyArray1::from_vec(py, values).reshape([thickness.len(), formula.values()])
}
