use crate::arrays::{invalid, matrix, rows_of};
use crate::threads::released;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use signorini_mesher::{Line, Loop, MeshOptions, Refinement, mesh};

/// A loop of the outline or of a hole: corners (k, 2); for each side a point (k, 2) on its arc, NaN for a straight
/// side; names (k,) of the sides. Side i begins at corner i.
type LoopArrays<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>, Vec<String>);
type MeshArrays<'py> =
    (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<i64>>, Bound<'py, PyArray2<i64>>, Bound<'py, PyArray2<i64>>);

/// Meshes a plate within its outline and outside its holes. Returns nodes (n, 2), elements (e, 8), the element sides on
/// the outline (k, 3), and for each of these sides the loop and the side of this loop (k, 2). A triangle is [a, b, c,
/// c, ab, bc, c, ca].
///
/// Each of `refinements` (r, 5) is a straight line from x, y to x, y, and the largest element size along this line.
/// Each of `lines` (l, 8) is a line from x, y to x, y through x, y (NaN if straight), a rank, and whether it may be
/// followed in part. Sides of elements follow `lines`, and `points` (p, 2) become nodes, where there is enough
/// distance. `most` is approximately the largest number of elements. The plate is meshed along `axes` (2, 2). A bad
/// outline raises ValueError(message, loop, side) or ValueError(message).
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "each array is one of Python's")]
pub fn mesh_outline<'py>(
    py: Python<'py>,
    loops: Vec<LoopArrays<'py>>,
    size: f64,
    refinements: PyReadonlyArray2<'py, f64>,
    lines: PyReadonlyArray2<'py, f64>,
    points: PyReadonlyArray2<'py, f64>,
    most: usize,
    axes: [[f64; 2]; 2],
) -> PyResult<MeshArrays<'py>> {
    let loops = loops.iter().map(loop_of).collect::<PyResult<Vec<Loop>>>()?;
    let refinements = rows_of::<5, f64>("refinements", &refinements)?
        .into_iter()
        .map(|[x0, y0, x1, y1, size]| Refinement { from: [x0, y0], to: [x1, y1], size })
        .collect();
    let line = |[x0, y0, x1, y1, x, y, rank, in_part]: [f64; 8]| Line {
        ends: [[x0, y0], [x1, y1]],
        through: x.is_finite().then_some([x, y]),
        rank: rank as usize,
        in_part: in_part != 0.0,
    };
    let lines = rows_of::<8, f64>("lines", &lines)?.into_iter().map(line).collect();
    let points = rows_of::<2, f64>("points", &points)?;
    let options = MeshOptions { size, refinements, lines, points, most: Some(most), axes };
    let made = released(py, || mesh(&loops, &options))?.map_err(|fault| match fault.side {
        Some((ring, side)) => PyValueError::new_err((fault.message, ring, side)),
        None => invalid(fault),
    })?;
    Ok((
        matrix(py, made.points.as_flattened().to_vec(), 2)?,
        integers(py, &made.elements)?,
        integers(py, &made.sides)?,
        integers(py, &made.side_of)?,
    ))
}

fn loop_of((corners, through, names): &LoopArrays<'_>) -> PyResult<Loop> {
    let corners = rows_of::<2, f64>("the corners", corners)?;
    let through = rows_of::<2, f64>("the points of arcs", through)?;
    if corners.len() < 2 || through.len() != corners.len() || names.len() != corners.len() {
        return Err(invalid("a loop needs at least two corners, and a point of an arc and a name for each corner"));
    }
    if corners.iter().flatten().any(|x| !x.is_finite()) {
        return Err(invalid("a corner is not finite"));
    }
    let through = through.into_iter().map(|p| p.iter().all(|x| x.is_finite()).then_some(p)).collect();
    Ok(Loop { corners, through, names: names.clone() })
}

fn integers<'py, const N: usize>(py: Python<'py>, rows: &[[usize; N]]) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let flat: Vec<i64> = rows.iter().flatten().map(|&i| i as i64).collect();
    PyArray1::from_vec(py, flat).reshape([rows.len(), N])
}
