use crate::arrays::{SpringArrays, further_rows, indices, invalid, matrix, rows_of, sized, springs};
use crate::threads::released;
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArray3,
    PyUntypedArrayMethods,
};
use pyo3::prelude::*;
use signorini_core::assembly::{Assembly, Bedding, Numbering};
use signorini_core::displacement::Displacement;
use signorini_core::element::{DOFS, Kind, Layered, Material, Materials, Section, Thickness};
use signorini_core::plate::{self, StressNodes};
use signorini_core::residual::{internal_magnitudes, nodal_force, openings, residual};
use signorini_core::stress;
use std::sync::Arc;

/// Displacements hi + lo, as two arrays (3n,) of doubles.
type HighAndLow<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// A discretised plate: nodes `points` (n, 2), 8-node `elements` (e, 8), thickness, material, and the `kind` of
/// elements.
///
/// A triangle of "mitc9" has the nodes [a, b, c, c, ab, bc, c, ca]. The kind "q8r" has quadrilaterals only, one side of
/// which may be collapsed: [c, c, a, b, c, ca, ab, bc].
///
/// `thickness` is one number, or the thickness (e, p) at the p `section_points` of each element. `layered` is a pair:
/// the elements (k,), in increasing order, inside which the thickness jumps, and their rigidities (k, p, 9). Nine
/// rigidities are the entries 11, 12, 13, 22, 23, 33 in bending and 11, 12, 22 in shear. `rigidities` (9,) are those of
/// the plate for thickness 1, and `young` is its largest Young's modulus. `others` describes m further materials: the
/// material (e,) of each element (0 is that of the plate), Young's moduli (m,) and rigidities (m, 9). `stress_elements`
/// (e, 8) has the stress nodes of each element; where moments and shears jump, a node has several stress nodes.
/// `frames` (n, 2) are cos and sin of the first rotation direction of each node. `leaders` (n,) is the node that each
/// node follows as a rigid body; a free node is its own leader.
#[pyclass(frozen, module = "signorini._core")]
pub struct Plate {
    pub inner: Arc<plate::Plate>,
}

type Pair<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);
type RowPair<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);
type Stresses<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray3<f64>>);
type Compressed<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<f64>>);

#[derive(FromPyObject)]
enum ThicknessArray<'py> {
    Constant(f64),
    Varying(PyReadonlyArray2<'py, f64>),
}

fn kind_of(name: &str) -> PyResult<Kind> {
    match name {
        "mitc9" => Ok(Kind::Mitc9),
        "q8r" => Ok(Kind::Q8r),
        other => Err(invalid(format!("unknown element kind '{other}'; there are mitc9 and q8r"))),
    }
}

fn thickness_of(
    kind: Kind,
    elements: usize,
    thickness: ThicknessArray<'_>,
    layered: Option<(PyReadonlyArray1<'_, i64>, PyReadonlyArray3<'_, f64>)>,
) -> PyResult<Thickness> {
    let points = kind.points().len();
    let at_points = match thickness {
        ThicknessArray::Constant(_) if layered.is_some() => return Err(invalid("layered needs thickness (e, p)")),
        ThicknessArray::Constant(thickness) => return Ok(Thickness::Constant(thickness)),
        ThicknessArray::Varying(thickness) if thickness.shape() == [elements, points] => thickness,
        ThicknessArray::Varying(other) => {
            return Err(invalid(format!("thickness has shape {:?}; expected {:?}", other.shape(), [elements, points])));
        }
    };
    let layered = layered.map_or(Ok(Layered::default()), |(which, rigidities)| {
        let element = indices("the elements of layered", &which, elements)?;
        if rigidities.shape() != [element.len(), points, 9] {
            return Err(invalid(format!("the rigidities of layered must have shape {:?}", [element.len(), points, 9])));
        }
        let values: Vec<f64> = rigidities.as_array().iter().copied().collect();
        Ok(Layered { element, section: values.chunks_exact(9).map(section).collect() })
    })?;
    Ok(Thickness::Varying { at_points: at_points.as_array().iter().copied().collect(), layered })
}

fn elements_of(given: &PyReadonlyArray2<'_, i64>) -> PyResult<Vec<[usize; 8]>> {
    let numbered = |nodes: [i64; 8]| {
        let mut out = [0; 8];
        for (o, n) in out.iter_mut().zip(nodes) {
            *o = usize::try_from(n).map_err(|_| invalid(format!("an element has the negative node number {n}")))?;
        }
        Ok(out)
    };
    rows_of::<8, i64>("elements", given)?.into_iter().map(numbered).collect()
}

fn section(values: &[f64]) -> Section {
    let v = values;
    let bending = [[v[0], v[1], v[2]], [v[1], v[3], v[4]], [v[2], v[4], v[5]]];
    Section { bending, shear: [[v[6], v[7]], [v[7], v[8]]] }
}

/// Reference points (p, 2) at which an element of a kind needs its thickness; a triangle has other points than a
/// quadrilateral. The integration points of the stiffness come first, then the four sampling points of moments and
/// shears. For q8r both are the same points.
#[pyfunction]
#[pyo3(signature = (kind, triangle=false))]
pub fn section_points<'py>(py: Python<'py>, kind: &str, triangle: bool) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let points = kind_of(kind)?.points_of(triangle);
    matrix(py, points.iter().flat_map(|&(xi, eta, _)| [xi, eta]).collect(), 2)
}

pub fn displacement(
    hi: &PyReadonlyArray1<'_, f64>,
    lo: &PyReadonlyArray1<'_, f64>,
    dofs: usize,
) -> PyResult<Displacement> {
    Ok(Displacement { hi: sized("the displacement", hi, dofs)?, lo: sized("the displacement's low part", lo, dofs)? })
}

#[pymethods]
impl Plate {
    #[new]
    #[pyo3(signature = (
        points, elements, thickness, young, rigidities, kind, frames=None, layered=None, others=None,
        stress_elements=None, leaders=None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        elements: PyReadonlyArray2<'_, i64>,
        thickness: ThicknessArray<'_>,
        young: f64,
        rigidities: [f64; 9],
        kind: &str,
        frames: Option<PyReadonlyArray2<'_, f64>>,
        layered: Option<(PyReadonlyArray1<'_, i64>, PyReadonlyArray3<'_, f64>)>,
        others: Option<(PyReadonlyArray1<'_, i64>, PyReadonlyArray1<'_, f64>, PyReadonlyArray2<'_, f64>)>,
        stress_elements: Option<PyReadonlyArray2<'_, i64>>,
        leaders: Option<PyReadonlyArray1<'_, i64>>,
    ) -> PyResult<Self> {
        let kind = kind_of(kind)?;
        let points = rows_of::<2, f64>("points", &points)?;
        let elements = elements_of(&elements)?;
        let thickness = thickness_of(kind, elements.len(), thickness, layered)?;
        let frames = frames.map(|f| rows_of::<2, f64>("frames", &f)).transpose()?;
        let mut all = vec![Material { young, unit: section(&rigidities) }];
        let mut of = Vec::new();
        if let Some((number, young, rigidities)) = others {
            let unit = rows_of::<9, f64>("rigidities", &rigidities)?;
            let young = sized("Young's moduli", &young, unit.len())?;
            all.extend(young.iter().zip(&unit).map(|(&young, unit)| Material { young, unit: section(unit) }));
            of = indices("the elements' materials", &number, all.len())?.into_iter().map(|i| i as u32).collect();
        }
        let stress_elements = stress_elements.map(|given| elements_of(&given)).transpose()?;
        let leaders = leaders.map(|given| indices("leaders", &given, points.len())).transpose()?;
        let made = || {
            let mut plate = plate::Plate::new(points, elements, thickness, Materials::several(all, of), kind, frames)?;
            if let Some(leaders) = leaders {
                plate = plate.with_bodies(&leaders)?;
            }
            match stress_elements {
                Some(elements) => {
                    let count = elements.iter().flatten().max().map_or(0, |last| last + 1);
                    plate.with_stress_nodes(StressNodes { elements, count })
                }
                None => Ok(plate),
            }
        };
        let inner = released(py, made)?.map_err(invalid)?;
        Ok(Self { inner: Arc::new(inner) })
    }

    /// Rows that give w, θx or θy (`field` 0, 1, 2) at reference points (q, 2) of elements (q,): coefficients (q, 24)
    /// of the nodal displacements in nodal frames, and coefficients (q, 2) of the centre rotations.
    fn interpolation_rows<'py>(
        &self,
        py: Python<'py>,
        elements: PyReadonlyArray1<'_, i64>,
        xi: PyReadonlyArray2<'_, f64>,
        field: usize,
    ) -> PyResult<RowPair<'py>> {
        let elements = indices("elements", &elements, self.inner.elements().len())?;
        let xi = rows_of::<2, f64>("reference points", &xi)?;
        if xi.len() != elements.len() || field > 2 {
            return Err(invalid("there must be one reference point for each element, and field must be 0, 1 or 2"));
        }
        let mut rows = Vec::with_capacity(24 * xi.len());
        let mut centre = Vec::with_capacity(2 * xi.len());
        for (&e, [x, y]) in elements.iter().zip(xi) {
            let (row, couples) = self.inner.interpolation_row(e, x, y, field);
            rows.extend_from_slice(&row);
            centre.extend_from_slice(&couples);
        }
        Ok((matrix(py, rows, 24)?, matrix(py, centre, 2)?))
    }

    /// Nodal forces (3n,) of the stress-free curvature [κxx, κyy, κxy], and its couples (2e,) on the centre rotations.
    fn curvature_load<'py>(&self, py: Python<'py>, curvature: [f64; 3]) -> PyResult<Pair<'py>> {
        let (load, centre) = released(py, || self.inner.curvature_load(curvature))?;
        Ok((PyArray1::from_vec(py, load), PyArray1::from_vec(py, centre)))
    }

    /// The residual f − Ku − spring forces at every dof (3n,), in double-double.
    fn residual<'py>(
        &self,
        py: Python<'py>,
        spring_arrays: SpringArrays<'_>,
        load: PyReadonlyArray1<'_, f64>,
        hi: PyReadonlyArray1<'_, f64>,
        lo: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let dofs = self.inner.dof_count();
        let springs = springs(&spring_arrays, &self.inner)?;
        let load = sized("the load", &load, dofs)?;
        let displacement = displacement(&hi, &lo, dofs)?;
        let out = released(py, || residual(&self.inner, &springs, &load, &displacement))?;
        Ok(PyArray1::from_vec(py, out))
    }

    /// The gaps distance − g·u (m,), summed in double-double. The rows g (m + q, 24) have coefficients over the dofs of
    /// elements (m + q,). The last q rows continue the rows with the numbers `further` (q,) in other elements.
    #[allow(clippy::too_many_arguments)]
    fn openings<'py>(
        &self,
        py: Python<'py>,
        elements: PyReadonlyArray1<'_, i64>,
        rows: PyReadonlyArray2<'_, f64>,
        further: PyReadonlyArray1<'_, i64>,
        distance: PyReadonlyArray1<'_, f64>,
        hi: PyReadonlyArray1<'_, f64>,
        lo: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let elements = indices("elements", &elements, self.inner.elements().len())?;
        let further = further_rows(&further, elements.len())?;
        let distance = sized("distance", &distance, elements.len() - further.len())?;
        if rows.shape() != [elements.len(), DOFS] {
            return Err(invalid(format!("rows must have shape ({}, {DOFS})", elements.len())));
        }
        let rows = rows.as_slice()?;
        let displacement = displacement(&hi, &lo, self.inner.dof_count())?;
        let out = released(py, || openings(&self.inner, &elements, rows, &further, &distance, &displacement))?;
        Ok(PyArray1::from_vec(py, out))
    }

    /// Displacements hi + lo (3n,) plus the rigid motion w + sx (x − x0) + sy (y − y0), summed in double-double.
    /// `center` is (x0, y0), `motion` is (w, sx, sy).
    fn moved<'py>(
        &self,
        py: Python<'py>,
        hi: PyReadonlyArray1<'_, f64>,
        lo: PyReadonlyArray1<'_, f64>,
        center: [f64; 2],
        motion: [f64; 3],
    ) -> PyResult<HighAndLow<'py>> {
        let mut out = displacement(&hi, &lo, self.inner.dof_count())?;
        let motions = vec![motion; self.inner.components().count()];
        released(py, || out.add_rigid(&self.inner, center, &motions))?;
        Ok((PyArray1::from_vec(py, out.hi), PyArray1::from_vec(py, out.lo)))
    }

    /// Largest Σ |element matrix| |displacement| over the dofs (3n,) that are not held. Rounding errors of the residual
    /// are relative to this number.
    fn internal_magnitude(
        &self,
        py: Python<'_>,
        held: PyReadonlyArray1<'_, bool>,
        hi: PyReadonlyArray1<'_, f64>,
        lo: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<f64> {
        let held = sized("held", &held, self.inner.dof_count())?;
        let displacement = displacement(&hi, &lo, self.inner.dof_count())?;
        released(py, || {
            let all = internal_magnitudes(&self.inner, &displacement);
            all.iter().zip(&held).filter(|(_, held)| !**held).fold(0.0, |worst, (value, _)| f64::max(worst, *value))
        })
    }

    /// Moments and shears [mx, my, mxy, qx, qy] at nodes (n, 5), and at the four sampling points of each element (e, 4,
    /// 5). If the plate has `stress_elements`, the values at nodes are at their stress nodes. The sampling points are
    /// the 2×2 Gauss points of a quadrilateral, or three points near the corners and the centroid of a triangle.
    fn stresses<'py>(
        &self,
        py: Python<'py>,
        hi: PyReadonlyArray1<'_, f64>,
        lo: PyReadonlyArray1<'_, f64>,
        curvature: [f64; 3],
        couples: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Stresses<'py>> {
        let count = self.inner.elements().len();
        let displacement = displacement(&hi, &lo, self.inner.dof_count())?;
        let couples = sized("couples", &couples, 2 * count)?;
        let (nodal, sampled) = released(py, || stress::smoothed(&self.inner, &displacement, curvature, &couples))?;
        let nodal = matrix(py, nodal.into_flattened(), 5)?;
        let sampled = sampled.into_flattened().into_flattened();
        Ok((nodal, PyArray1::from_vec(py, sampled).reshape([count, 4, 5])?))
    }

    /// Nodal forces K_e u − f_κ (k, 24) of elements (k,) in nodal frames, with f_κ the load of the stress-free
    /// curvature, and moments and shears [mx, my, mxy, qx, qy] (k, p, 5) at the p integration points of the stiffness.
    fn element_forces<'py>(
        &self,
        py: Python<'py>,
        elements: PyReadonlyArray1<'_, i64>,
        hi: PyReadonlyArray1<'_, f64>,
        lo: PyReadonlyArray1<'_, f64>,
        curvature: [f64; 3],
        couples: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<Stresses<'py>> {
        let plate = &self.inner;
        let elements = indices("elements", &elements, plate.elements().len())?;
        let displacement = displacement(&hi, &lo, plate.dof_count())?;
        let couples = sized("couples", &couples, 2 * plate.elements().len())?;
        let (forces, stress) = released(py, || {
            let of = stress::Strained { displacement: &displacement, curvature, couples: &couples };
            let (mut forces, mut stress) = (Vec::new(), Vec::new());
            for &e in &elements {
                let (free, _) = plate.curvature_load_on(e, curvature);
                forces.extend(nodal_force(plate, e, &displacement).iter().zip(free).map(|(force, free)| force - free));
                stress.extend(stress::at_integration_points(plate, e, &of).into_flattened());
            }
            (forces, stress)
        })?;
        let points = stress.len() / (5 * elements.len()).max(1);
        let stress = PyArray1::from_vec(py, stress).reshape([elements.len(), points, 5])?;
        Ok((matrix(py, forces, DOFS)?, stress))
    }

    /// Strain–displacement matrices of elements (k,) at their p integration points, (k, p, 120): 24 coefficients of the
    /// nodal displacements in nodal frames for each of κx, κy, 2κxy, γx, γy.
    fn strain_rows<'py>(
        &self,
        py: Python<'py>,
        elements: PyReadonlyArray1<'_, i64>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let elements = indices("elements", &elements, self.inner.elements().len())?;
        let rows = |&e: &usize| stress::strain_rows(&self.inner, e).into_flattened().into_flattened();
        let all: Vec<f64> = released(py, || elements.iter().flat_map(rows).collect())?;
        let points = all.len() / (5 * DOFS * elements.len()).max(1);
        PyArray1::from_vec(py, all).reshape([elements.len(), points, 5 * DOFS])
    }

    /// Lower triangle of K with springs, with dofs in the order of the mesh: column starts, rows, values.
    fn stiffness_matrix<'py>(&self, py: Python<'py>, spring_arrays: SpringArrays<'_>) -> PyResult<Compressed<'py>> {
        let springs = springs(&spring_arrays, &self.inner)?;
        let numbering = Numbering::natural(&self.inner);
        let lower =
            released(py, || Assembly::new(&self.inner, &springs, &Bedding::default(), &numbering).lower_triangle())?;
        let signed = |v: Vec<usize>| v.into_iter().map(|i| i as i64).collect::<Vec<_>>();
        Ok((
            PyArray1::from_vec(py, signed(lower.column_start)),
            PyArray1::from_vec(py, signed(lower.row)),
            PyArray1::from_vec(py, lower.value),
        ))
    }

    #[getter]
    fn dof_count(&self) -> usize {
        self.inner.dof_count()
    }

    /// Packed lower triangles (e, 300) of the element matrices, for rotations in x and y.
    fn element_stiffness<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let count = self.inner.elements().len();
        let all = (0..count).flat_map(|e| self.inner.element_stiffness(e)).copied().collect();
        matrix(py, all, signorini_core::element::PACKED)
    }
}
