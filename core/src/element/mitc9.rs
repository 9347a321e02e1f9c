//! MITC9 on the 8-node mesh (Bathe, Brezzi & Fortin 1989, Int. J. Num. Meth. Eng. 28, 1787–1801).
//!
//! Deflection on the eight serendipity functions, rotations on the nine of Lagrange. The covariant shear lies in
//! γξ ∈ span{1, ξ, η, ξη, η²} and γη ∈ span{1, ξ, η, ξη, ξ²}; it equals ∇w − θ at the two Gauss points of every edge
//! (tangential part) and, as a vector in x and y, in its mean over the quadrilateral of the corners. So constant shear and
//! the moments that grow with it do the work they should whatever the quadrilateral; means of components over the
//! reference square would do so on parallelograms. On curved sides means over the true element are up to eight times
//! worse.

use super::quadrature::{GAUSS_3, square};
use super::shape::{Shape, lagrange, serendipity};
use pulp::{Arch, Simd, WithSimd};
use std::sync::LazyLock;

use super::geometry::Geometry;
use super::matrices::{ALL_DOFS, Centre, DOFS, PACKED, Stiffness, StrainMatrix, packed};
use super::section::{Material, Section, Sections};

pub(super) const TIES: usize = 5;
pub(super) const GAUSS: f64 = 0.577_350_269_189_625_8;
pub(super) const CENTRE: usize = DOFS;

/// Where component `a` (0: γξ, 1: γη) is tied on the edges: along its own direction at ±1/√3, across at ±1.
fn tying_point(component: usize, tie: usize) -> (f64, f64) {
    let along = if tie % 2 == 0 { -GAUSS } else { GAUSS };
    let across = if tie < 2 { -1.0 } else { 1.0 };
    if component == 0 { (along, across) } else { (across, along) }
}

/// Interpolation of one component from its four edge values and its mean over the reference square; `along` is ξ for γξ and η for γη.
#[inline(always)]
fn interpolation(along: f64, across: f64) -> [f64; TIES] {
    let bubble = 0.75 * (across * across - 1.0);
    let low = 0.5 * (0.5 * (1.0 - across) + bubble);
    let high = 0.5 * (0.5 * (1.0 + across) + bubble);
    let slope = along / (4.0 * GAUSS);
    [
        low - slope * (1.0 - across),
        low + slope * (1.0 - across),
        high - slope * (1.0 + across),
        high + slope * (1.0 + across),
        -2.0 * bubble,
    ]
}

/// Both families of shape functions at one reference point, and its weight.
pub(super) struct Station {
    pub(super) xi: f64,
    pub(super) eta: f64,
    pub(super) weight: f64,
    pub(super) shape: Shape<8>,
    pub(super) rotation: Shape<9>,
}

impl Station {
    fn new(xi: f64, eta: f64, weight: f64) -> Self {
        Self { xi, eta, weight, shape: serendipity(xi, eta), rotation: lagrange(xi, eta) }
    }
}

/// The 3×3 Gauss points.
static GAUSS_POINTS: LazyLock<[Station; 9]> = LazyLock::new(|| {
    let mut points = square(GAUSS_3).map(|(xi, eta, weight)| Station::new(xi, eta, weight));
    std::array::from_fn(|_| points.next().expect("nine points"))
});

/// The four tying points of each component.
static TYING_POINTS: LazyLock<[[Station; 4]; 2]> = LazyLock::new(|| {
    std::array::from_fn(|component| {
        std::array::from_fn(|tie| {
            let (xi, eta) = tying_point(component, tie);
            Station::new(xi, eta, 1.0)
        })
    })
});

/// Adds the part of ∇w − θ along a direction in reference coordinates, at one point.
#[inline(always)]
pub(super) fn add_shear_along(
    row: &mut [f64; ALL_DOFS],
    geometry: &Geometry,
    [along_xi, along_eta]: [f64; 2],
    at: &Station,
) {
    let slopes = at.shape.gradient.map(|[xi, eta]| along_xi * xi + along_eta * eta);
    let mut tangent = [0.0; 2];
    for i in 0..8 {
        tangent[0] += slopes[i] * geometry.at[i][0];
        tangent[1] += slopes[i] * geometry.at[i][1];
    }
    let [tx, ty] = tangent;
    for i in 0..8 {
        row[3 * i] += slopes[i];
        row[3 * i + 1] -= at.rotation.value[i] * tx;
        row[3 * i + 2] -= at.rotation.value[i] * ty;
    }
    row[CENTRE] -= at.rotation.value[8] * tx;
    row[CENTRE + 1] -= at.rotation.value[8] * ty;
}

/// The five numbers of each covariant component as rows over all dofs: tied on the edges, then those with which the
/// mean is right.
#[inline(always)]
fn ties(geometry: &Geometry) -> [[[f64; ALL_DOFS]; TIES]; 2] {
    let mut rows = [[[0.0; ALL_DOFS]; TIES]; 2];
    for component in 0..2 {
        for tie in 0..4 {
            let along = [[1.0, 0.0], [0.0, 1.0]][component];
            add_shear_along(&mut rows[component][tie], geometry, along, &TYING_POINTS[component][tie]);
        }
    }
    let skew = skew(geometry);
    for point in GAUSS_POINTS.iter() {
        let weight = 0.25 * point.weight;
        for component in 0..2 {
            let part = weight * skew[component];
            let mut along = [part * point.xi, -part * point.eta];
            along[component] += weight;
            add_shear_along(&mut rows[component][4], geometry, along, point);
        }
    }
    let [xi, eta] = rows.each_mut();
    for dof in 0..ALL_DOFS {
        let change = |row: &[[f64; ALL_DOFS]; TIES]| row[1][dof] - row[0][dof] + row[3][dof] - row[2][dof];
        // What the edges' numbers add to the mean.
        let edges = (change(xi) - change(eta)) / (12.0 * GAUSS);
        xi[4][dof] -= skew[0] * edges;
        eta[4][dof] -= skew[1] * edges;
    }
    rows
}

/// How the tangents turn over the element with straight sides between its corners; zeros for a parallelogram.
///
/// With its tangents a + cη and b + cξ the physical shear times the area is, in parts along a and b,
/// a × b times ((1 + pξ)γξ − pηγη, qξγξ + (1 − qη)γη), where p = a × c / a × b and q = b × c / a × b.
fn skew(geometry: &Geometry) -> [f64; 2] {
    let [r, s, t, u] = [0, 1, 2, 3].map(|i| geometry.at[i]);
    let vector = |signs: [f64; 3]| {
        [0, 1].map(|k| signs[0] * (s[k] - r[k]) + signs[1] * (t[k] - r[k]) + signs[2] * (u[k] - r[k]))
    };
    let (a, b, c) = (vector([1.0, 1.0, -1.0]), vector([-1.0, 1.0, 1.0]), vector([-1.0, 1.0, -1.0]));
    let cross = |[x, y]: [f64; 2], [v, w]: [f64; 2]| x * w - y * v;
    [cross(a, c), cross(b, c)].map(|part| part / cross(a, b))
}

/// κ = sym ∇θ on nine nodes and the tied shear, both in x and y, at each of the points.
pub fn strain_matrices<const N: usize>(geometry: &Geometry, at: [(f64, f64); N]) -> [StrainMatrix; N] {
    let rows = ties(geometry);
    at.map(|(xi, eta)| strain_matrix(geometry, &rows, xi, eta))
}

fn strain_matrix(geometry: &Geometry, rows: &[[[f64; ALL_DOFS]; TIES]; 2], xi: f64, eta: f64) -> StrainMatrix {
    let jacobian = geometry.jacobian(xi, eta);
    let mut strain = bending_rows(lagrange(xi, eta).gradient.map(|gradient| jacobian.physical(gradient)));
    let weights = [interpolation(xi, eta), interpolation(eta, xi)];
    for dof in 0..ALL_DOFS {
        let covariant = [0, 1].map(|a| (0..TIES).map(|t| weights[a][t] * rows[a][t][dof]).sum::<f64>());
        let [x, y] = jacobian.physical(covariant);
        strain[3][dof] = x;
        strain[4][dof] = y;
    }
    strain
}

/// Rows of κ from the gradients of the nine rotation functions; those of the shear are zero.
pub(super) fn bending_rows(gradient: [[f64; 2]; 9]) -> StrainMatrix {
    let mut strain = [[0.0; ALL_DOFS]; 5];
    for (i, [x, y]) in gradient.into_iter().enumerate() {
        let first = if i < 8 { 3 * i + 1 } else { CENTRE };
        strain[0][first] = x;
        strain[1][first + 1] = y;
        strain[2][first] = y;
        strain[2][first + 1] = x;
    }
    strain
}

/// One of the 3×3 points: what bending there is made of.
pub(super) struct Point {
    /// Gradients of the nine rotation functions in x and y.
    pub(super) gradient: [[f64; 2]; 9],
    /// Weight times the area that the point stands for.
    pub(super) scale: f64,
    pub(super) section: Section,
}

/// An element with bending and shear apart: bending at the 3×3 points, shear as a form in the ten tied values.
pub(super) struct Apart {
    pub(super) points: [Point; 9],
    pub(super) form: [[f64; 2 * TIES]; 2 * TIES],
    pub(super) rows: [[f64; ALL_DOFS]; 2 * TIES],
}

impl Apart {
    /// Of a quadrilateral.
    #[inline(always)]
    pub(super) fn of(geometry: &Geometry, material: &Material, sections: Sections) -> Self {
        let mut form = [[0.0; 2 * TIES]; 2 * TIES];
        let points = std::array::from_fn(|k| {
            let station = &GAUSS_POINTS[k];
            let (xi, eta) = (station.xi, station.eta);
            let jacobian = geometry.jacobian_of(station.shape);
            let scale = station.weight * jacobian.determinant;
            let section = sections.at(k, material);
            let inv = &jacobian.inverse;
            let metric = |a: usize, b: usize| {
                let [x, y] = section.shear_force([inv[0][b], inv[1][b]]);
                scale * (inv[0][a] * x + inv[1][a] * y)
            };
            let weights = [interpolation(xi, eta), interpolation(eta, xi)];
            for a in 0..2 {
                for b in 0..=a {
                    let g = metric(a, b);
                    for s in 0..TIES {
                        for t in 0..TIES {
                            form[a * TIES + s][b * TIES + t] += g * weights[a][s] * weights[b][t];
                        }
                    }
                }
            }
            let gradient = station.rotation.gradient.map(|gradient| jacobian.physical(gradient));
            Point { gradient, scale, section }
        });
        for s in 0..TIES {
            for t in 0..TIES {
                form[s][TIES + t] = form[TIES + t][s];
            }
        }
        let [along, across] = ties(geometry);
        let rows = std::array::from_fn(|t| if t < TIES { along[t] } else { across[t - TIES] });
        Self { points, form, rows }
    }

    /// Bending alone over all dofs, lower triangle.
    #[inline(always)]
    pub(super) fn bending(&self) -> [[f64; ALL_DOFS]; ALL_DOFS] {
        let mut full = [[0.0; ALL_DOFS]; ALL_DOFS];
        for point in &self.points {
            add_bending(&mut full, point);
        }
        full
    }
}

/// Bending by 3×3 points on the rotations; shear as a 10×10 form in the tied values; then the centre is condensed.
pub fn stiffness(geometry: &Geometry, material: &Material, sections: Sections) -> Stiffness {
    Arch::new().dispatch(Element { geometry, material, sections })
}

struct Element<'a> {
    geometry: &'a Geometry,
    material: &'a Material,
    sections: Sections<'a>,
}

impl WithSimd for Element<'_> {
    type Output = Stiffness;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Stiffness {
        let apart = Apart::of(self.geometry, self.material, self.sections);
        let mut full = apart.bending();
        add_shear(&mut full, &apart.form, &apart.rows);
        condense(&full)
    }
}

#[inline(always)]
fn add_bending(full: &mut [[f64; ALL_DOFS]; ALL_DOFS], point: &Point) {
    let gradient = &point.gradient;
    for i in 0..9 {
        let r = if i < 8 { 3 * i + 1 } else { CENTRE };
        let [x, y] = gradient[i].map(|g| point.scale * g);
        // Moments of either slope of the node.
        let (first, second) = (point.section.moment([x, 0.0, y]), point.section.moment([0.0, y, x]));
        for j in 0..=i {
            let c = if j < 8 { 3 * j + 1 } else { CENTRE };
            let [x, y] = gradient[j];
            full[r][c] += first[0] * x + first[2] * y;
            full[r][c + 1] += first[1] * y + first[2] * x;
            full[r + 1][c] += second[0] * x + second[2] * y;
            full[r + 1][c + 1] += second[1] * y + second[2] * x;
        }
    }
}

#[inline(always)]
pub(super) fn add_shear(
    full: &mut [[f64; ALL_DOFS]; ALL_DOFS],
    form: &[[f64; 2 * TIES]; 2 * TIES],
    rows: &[[f64; ALL_DOFS]; 2 * TIES],
) {
    let mut product = [[0.0; ALL_DOFS]; 2 * TIES];
    for s in 0..2 * TIES {
        for t in 0..2 * TIES {
            let f = form[s][t];
            for dof in 0..ALL_DOFS {
                product[s][dof] += f * rows[t][dof];
            }
        }
    }
    for i in 0..ALL_DOFS {
        let mut sum = full[i];
        for s in 0..2 * TIES {
            for j in 0..ALL_DOFS {
                sum[j] += rows[s][i] * product[s][j];
            }
        }
        full[i] = sum;
    }
}

/// Eliminates the two centre rotations; only the lower triangle of `full` is read.
#[inline(always)]
pub(super) fn condense(full: &[[f64; ALL_DOFS]; ALL_DOFS]) -> Stiffness {
    let [a, b, d] = [full[CENTRE][CENTRE], full[CENTRE + 1][CENTRE], full[CENTRE + 1][CENTRE + 1]];
    let determinant = a * d - b * b;
    let compliance = [[d / determinant, -b / determinant], [-b / determinant, a / determinant]];
    let mut coupling = [[0.0; DOFS]; 2];
    for j in 0..DOFS {
        let [p, q] = [full[CENTRE][j], full[CENTRE + 1][j]];
        coupling[0][j] = compliance[0][0] * p + compliance[0][1] * q;
        coupling[1][j] = compliance[1][0] * p + compliance[1][1] * q;
    }
    let mut lower = [0.0; PACKED];
    for i in 0..DOFS {
        for j in 0..=i {
            let inner = full[CENTRE][i] * coupling[0][j] + full[CENTRE + 1][i] * coupling[1][j];
            lower[packed(i, j)] = full[i][j] - inner;
        }
    }
    Stiffness { packed: lower, centre: Centre { coupling, compliance } }
}
