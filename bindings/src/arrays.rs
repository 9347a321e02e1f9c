//! Conversion between numpy arrays and Rust vectors.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use signorini_core::dense;
use signorini_core::element::DOFS;
use signorini_core::plate::Plate;
use signorini_core::rows::{Rows, Springs};
use std::collections::BTreeMap;

pub fn invalid(error: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(error.to_string())
}

/// An empty vector with reserved memory for `len` numbers. Raises MemoryError if there is not enough memory.
pub fn room(len: usize) -> PyResult<Vec<f64>> {
    dense::room(len).map_err(|_| PyMemoryError::new_err("not enough memory"))
}

pub fn vector<T: numpy::Element + Copy>(array: &PyReadonlyArray1<'_, T>) -> Vec<T> {
    array.as_array().to_vec()
}

/// The numpy array as a vector. Raises ValueError unless it has `length` entries.
pub fn sized<T: numpy::Element + Copy>(what: &str, array: &PyReadonlyArray1<'_, T>, length: usize) -> PyResult<Vec<T>> {
    if array.len() == length {
        Ok(array.as_array().to_vec())
    } else {
        Err(invalid(format!("{what} has length {}; expected {length}", array.len())))
    }
}

/// The rows of a numpy matrix with N columns. Raises ValueError if the matrix has another number of columns.
pub fn rows_of<const N: usize, T: numpy::Element + Copy + Default>(
    what: &str,
    array: &PyReadonlyArray2<'_, T>,
) -> PyResult<Vec<[T; N]>> {
    if array.shape()[1] != N {
        return Err(invalid(format!("{what} must have {N} columns, not {}", array.shape()[1])));
    }
    Ok(array
        .as_array()
        .rows()
        .into_iter()
        .map(|row| {
            let mut out = [T::default(); N];
            out.iter_mut().zip(row).for_each(|(o, v)| *o = *v);
            out
        })
        .collect())
}

/// The numpy array as a vector of indices. Raises ValueError if a number is negative or not less than `size`.
pub fn indices(what: &str, array: &PyReadonlyArray1<'_, i64>, size: usize) -> PyResult<Vec<usize>> {
    array
        .as_array()
        .iter()
        .map(|&i| match usize::try_from(i) {
            Ok(i) if i < size => Ok(i),
            _ => Err(invalid(format!("{what} holds {i}; allowed are 0 to {}", size.saturating_sub(1)))),
        })
        .collect()
}

/// The rows of a numpy matrix, each as a vector.
pub fn rows(matrix: &PyReadonlyArray2<'_, f64>) -> Vec<Vec<f64>> {
    matrix.as_array().rows().into_iter().map(|row| row.to_vec()).collect()
}

/// The table of m support rows over the elements of a plate. Entry i of `elements` (m + q,) is an element, entry i of
/// `rows` (m + q, 24) has the coefficients of its dofs. The last q entries continue the rows with the numbers `further`
/// (q,) in other elements.
pub fn element_rows(
    elements: &PyReadonlyArray1<'_, i64>,
    rows: &PyReadonlyArray2<'_, f64>,
    further: &PyReadonlyArray1<'_, i64>,
    plate: &Plate,
) -> PyResult<Rows> {
    let mut element = indices("the element of a row", elements, plate.elements().len())?;
    let mut coefficient = rows_of::<DOFS, f64>("a row", rows)?;
    if element.len() != coefficient.len() {
        return Err(invalid(format!("{} elements for {} rows", element.len(), coefficient.len())));
    }
    if coefficient.iter().flatten().any(|c| !c.is_finite()) {
        return Err(invalid("a coefficient of a row is not finite"));
    }
    let owners = further_rows(further, element.len())?;
    let own = element.len() - owners.len();
    let mut further: BTreeMap<usize, Vec<(usize, [f64; DOFS])>> = BTreeMap::new();
    for ((owner, e), c) in owners.into_iter().zip(element.split_off(own)).zip(coefficient.split_off(own)) {
        further.entry(owner).or_default().push((e, c));
    }
    Ok(Rows { element, coefficient, further }.onto_leaders(plate))
}

/// For each of the last q of `pieces` entries in a table of rows, the number of the row (q,) that it continues. Raises
/// ValueError unless these numbers are in ascending order.
pub fn further_rows(further: &PyReadonlyArray1<'_, i64>, pieces: usize) -> PyResult<Vec<usize>> {
    let Some(rows) = pieces.checked_sub(further.len()) else {
        return Err(invalid(format!("{pieces} elements, but {} entries in further", further.len())));
    };
    let owners = indices("further", further, rows)?;
    if owners.is_sorted() { Ok(owners) } else { Err(invalid("the row numbers in further must be in ascending order")) }
}

/// Linear springs as (elements, rows, further, stiffness, base); see `element_rows` for the first three.
pub type SpringArrays<'py> = (
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray1<'py, i64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
);

pub fn springs(arrays: &SpringArrays<'_>, plate: &Plate) -> PyResult<Springs> {
    let rows = element_rows(&arrays.0, &arrays.1, &arrays.2, plate)?;
    let stiffness = sized("the springs' stiffness", &arrays.3, rows.len())?;
    let base = sized("the springs' base", &arrays.4, rows.len())?;
    if stiffness.iter().any(|k| !(*k >= 0.0 && k.is_finite())) || base.iter().any(|b| !b.is_finite()) {
        return Err(invalid("a spring's stiffness must be finite and not negative, its base finite"));
    }
    Ok(Springs { rows, stiffness, base })
}

pub fn matrix<'py>(py: Python<'py>, values: Vec<f64>, columns: usize) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows = values.len() / columns.max(1);
    PyArray1::from_vec(py, values).reshape([rows, columns])
}
