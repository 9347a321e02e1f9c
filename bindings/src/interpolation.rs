use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use signorini_core::element::shape;

type Shapes<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray3<f64>>);

/// Values (q, 8) and reference gradients (q, 8, 2) of the serendipity functions at reference points (q, 2).
#[pyfunction]
pub fn serendipity<'py>(py: Python<'py>, xi: PyReadonlyArray2<'py, f64>) -> PyResult<Shapes<'py>> {
    evaluated(py, &xi, shape::serendipity)
}

/// The same of the quadratic functions on triangles [a, b, c, c, ab, bc, c, ca], zero where c is repeated.
#[pyfunction]
pub fn triangular<'py>(py: Python<'py>, xi: PyReadonlyArray2<'py, f64>) -> PyResult<Shapes<'py>> {
    evaluated(py, &xi, shape::triangular)
}

fn evaluated<'py>(
    py: Python<'py>,
    xi: &PyReadonlyArray2<'py, f64>,
    functions: impl Fn(f64, f64) -> shape::Shape<8>,
) -> PyResult<Shapes<'py>> {
    if xi.shape()[1] != 2 {
        return Err(PyValueError::new_err("reference points must have shape (q, 2)"));
    }
    let count = xi.shape()[0];
    let mut values = Vec::with_capacity(8 * count);
    let mut gradients = Vec::with_capacity(16 * count);
    for row in xi.as_array().rows() {
        let at = functions(row[0], row[1]);
        values.extend_from_slice(&at.value);
        gradients.extend(at.gradient.iter().flatten());
    }
    Ok((PyArray1::from_vec(py, values).reshape([count, 8])?, PyArray1::from_vec(py, gradients).reshape([count, 8, 2])?))
}
