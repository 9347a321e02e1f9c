use crate::arrays::{invalid, matrix, room};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use signorini_core::element::shape;

type Shapes<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray3<f64>>);

/// Values (q, 8) and reference gradients (q, 8, 2) of the serendipity functions at the reference points `xi` (q, 2).
#[pyfunction]
pub fn serendipity<'py>(py: Python<'py>, xi: PyReadonlyArray2<'py, f64>) -> PyResult<Shapes<'py>> {
    evaluated(py, &xi, shape::serendipity)
}

/// Values (q, 8) and reference gradients (q, 8, 2) of the quadratic functions on triangles [a, b, c, c, ab, bc, c, ca]
/// at the reference points `xi` (q, 2). The functions of the repeated c are zero.
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
    let (mut values, mut gradients) = (room(8 * count)?, room(16 * count)?);
    for row in xi.as_array().rows() {
        let at = functions(row[0], row[1]);
        values.extend_from_slice(&at.value);
        gradients.extend(at.gradient.iter().flatten());
    }
    Ok((PyArray1::from_vec(py, values).reshape([count, 8])?, PyArray1::from_vec(py, gradients).reshape([count, 8, 2])?))
}

/// Values (q, 8) of the shape functions at reference points (q, 2). `of` (q,) is the element of each point, as an index
/// into the elements (ne, 8) of the mesh.
#[pyfunction]
pub fn shape_values<'py>(
    py: Python<'py>,
    elements: PyReadonlyArray2<'py, i64>,
    of: PyReadonlyArray1<'py, i64>,
    xi: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut result = room(8 * of.len())?;
    each_point(&elements, &of, &xi, usize::MAX, |_, values| result.extend_from_slice(&values))?;
    matrix(py, result, 8)
}

/// Positions (q, 2) of the reference points (q, 2) in the elements `of` (q,), whose nodes are at `points` (n, 2).
#[pyfunction]
pub fn map_points<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    elements: PyReadonlyArray2<'py, i64>,
    of: PyReadonlyArray1<'py, i64>,
    xi: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut result = room(2 * of.len())?;
    let points = points.as_array();
    each_point(&elements, &of, &xi, points.nrows(), |nodes, values| {
        let along = |axis: usize| nodes.iter().zip(values).map(|(&node, value)| value * points[[node, axis]]).sum();
        result.extend::<[f64; 2]>([along(0), along(1)]);
    })?;
    matrix(py, result, 2)
}

/// Work-equivalent nodal forces (n,) of the forces `forces` (q,) at reference points (q, 2) in the elements `of` (q,).
#[pyfunction]
pub fn nodal_forces<'py>(
    py: Python<'py>,
    node_count: usize,
    elements: PyReadonlyArray2<'py, i64>,
    of: PyReadonlyArray1<'py, i64>,
    xi: PyReadonlyArray2<'py, f64>,
    forces: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    if forces.len() != of.len() {
        return Err(invalid(format!("{} forces at {} points", forces.len(), of.len())));
    }
    let mut nodal = vec![0.0; node_count];
    let mut forces = forces.as_array().into_iter();
    each_point(&elements, &of, &xi, node_count, |nodes, values| {
        let force = forces.next().unwrap_or(&0.0);
        nodes.iter().zip(values).for_each(|(&node, value)| nodal[node] += force * value);
    })?;
    Ok(PyArray1::from_vec(py, nodal))
}

/// For each point in turn, calls `take` with the nodes of its element and the shape functions at the point.
fn each_point(
    elements: &PyReadonlyArray2<'_, i64>,
    of: &PyReadonlyArray1<'_, i64>,
    xi: &PyReadonlyArray2<'_, f64>,
    node_count: usize,
    mut take: impl FnMut([usize; 8], [f64; 8]),
) -> PyResult<()> {
    if elements.shape()[1] != 8 || xi.shape() != [of.len(), 2] {
        return Err(invalid(
            "elements must have shape (ne, 8), and reference points (q, 2), one for each entry of `of` (q,)",
        ));
    }
    let (elements, of, xi) = (elements.as_array(), of.as_array(), xi.as_array());
    for (&element, at) in of.iter().zip(xi.rows()) {
        let Some(e) = usize::try_from(element).ok().filter(|&e| e < elements.nrows()) else {
            return Err(invalid(format!("a point is in element {element}; there are {} elements", elements.nrows())));
        };
        let mut nodes = [0; 8];
        for (own, &node) in nodes.iter_mut().zip(elements.row(e)) {
            *own = usize::try_from(node).unwrap_or(usize::MAX);
            if *own >= node_count {
                return Err(invalid(format!("element {e} has node {node}, but there are {node_count} nodes")));
            }
        }
        let functions = if nodes[2] == nodes[3] { shape::triangular } else { shape::serendipity };
        take(nodes, shape::gathered(&nodes, functions(at[0], at[1]).value));
    }
    Ok(())
}
