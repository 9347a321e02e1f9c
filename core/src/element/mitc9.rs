//! MITC9 on the 8-node mesh (Bathe, Brezzi & Fortin 1989, Int. J. Num. Meth. Eng. 28, 1787–1801).
//!
//! The deflection has the eight serendipity functions, rotations the nine Lagrange functions. The covariant shear lies
//! in γξ ∈ span{1, ξ, η, ξη, η²} and γη ∈ span{1, ξ, η, ξη, ξ²}. Tied values of ∇w − θ determine the shear: its
//! tangential component at the two Gauss points of each edge, and its mean vector (x, y) over the quadrilateral of the
//! corners. Constant shear then does the exact work on every quadrilateral; with means of γξ, γη over the reference
//! square this would hold on parallelograms only. On curved sides, means over the true element have errors up to eight
//! times larger.

use super::quadrature::{GAUSS_3, square};
use super::shape::{Shape, lagrange, serendipity};
use std::sync::LazyLock;

use super::geometry::{Geometry, Jacobian};
use super::matrices::{ALL_DOFS, Centre, DOFS, PACKED, Stiffness, StrainMatrix, packed};
use super::number::Number;
use super::section::Section;

pub(super) const TIES: usize = 5;
pub(super) const GAUSS: f64 = 0.577_350_269_189_625_8;
pub(super) const CENTRE: usize = DOFS;

/// Reference coordinates of tying point `tie` (0 to 3) of the shear component γξ (`component` 0) or γη (1). The point
/// is on an edge: at ±1/√3 along the direction of the component and at ±1 across it.
fn tying_point(component: usize, tie: usize) -> (f64, f64) {
    let along = if tie % 2 == 0 { -GAUSS } else { GAUSS };
    let across = if tie < 2 { -1.0 } else { 1.0 };
    if component == 0 { (along, across) } else { (across, along) }
}

/// Weights of the four edge values and of the mean over the reference square in the interpolated γξ or γη. `along` is ξ
/// for γξ and η for γη; `across` is the other coordinate.
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

/// A reference point with its integration weight, and the shape functions of w (`shape`) and of θ (`rotation`) there.
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

/// The 3×3 Gauss points of a quadrilateral.
static GAUSS_POINTS: LazyLock<[Station; 9]> = LazyLock::new(|| {
    let mut points = square(GAUSS_3).map(|(xi, eta, weight)| Station::new(xi, eta, weight));
    std::array::from_fn(|_| points.next().expect("nine points"))
});

/// For γξ and for γη, the four points on edges at which the component is tied.
static TYING_POINTS: LazyLock<[[Station; 4]; 2]> = LazyLock::new(|| {
    std::array::from_fn(|component| {
        std::array::from_fn(|tie| {
            let (xi, eta) = tying_point(component, tie);
            Station::new(xi, eta, 1.0)
        })
    })
});

/// Adds to `row` the coefficients, over all dofs, of the component of ∇w − θ along a direction in reference
/// coordinates, at the point `at`.
#[inline(always)]
pub(super) fn add_shear_along<T: Number>(
    row: &mut [T; ALL_DOFS],
    geometry: &Geometry<T>,
    [along_xi, along_eta]: [T; 2],
    at: &Station,
) {
    let zero = along_xi.like(0.0);
    let (mut slopes, mut tangent) = ([zero; 8], [zero; 2]);
    for i in 0..8 {
        let [xi, eta] = at.shape.gradient[i];
        slopes[i] = along_xi * xi + along_eta * eta;
        tangent[0] += slopes[i] * geometry.at[i][0];
        tangent[1] += slopes[i] * geometry.at[i][1];
    }
    let [tx, ty] = tangent;
    for i in 0..8 {
        row[3 * i] += slopes[i];
        row[3 * i + 1] -= tx * at.rotation.value[i];
        row[3 * i + 2] -= ty * at.rotation.value[i];
    }
    row[CENTRE] -= tx * at.rotation.value[8];
    row[CENTRE + 1] -= ty * at.rotation.value[8];
}

/// Rows over all dofs that give the five parameters of γξ, and of γη: four tied values on the edges, and the parameter
/// that makes the mean exact.
#[inline(always)]
fn ties<T: Number>(geometry: &Geometry<T>) -> [[[T; ALL_DOFS]; TIES]; 2] {
    let number = |value: f64| geometry.at[0][0].like(value);
    let mut rows = [[[number(0.0); ALL_DOFS]; TIES]; 2];
    for component in 0..2 {
        for tie in 0..4 {
            let along = [[1.0, 0.0], [0.0, 1.0]][component].map(number);
            add_shear_along(&mut rows[component][tie], geometry, along, &TYING_POINTS[component][tie]);
        }
    }
    let skew = skew(geometry);
    for point in GAUSS_POINTS.iter() {
        let weight = 0.25 * point.weight;
        for component in 0..2 {
            let part = skew[component] * weight;
            let mut along = [part * point.xi, -part * point.eta];
            along[component] += number(weight);
            add_shear_along(&mut rows[component][4], geometry, along, point);
        }
    }
    let [xi, eta] = rows.each_mut();
    for dof in 0..ALL_DOFS {
        let change = |row: &[[T; ALL_DOFS]; TIES]| row[1][dof] - row[0][dof] + row[3][dof] - row[2][dof];
        // The mean shear is `skew` · `edges`, from the shears at the edges, plus the fifth parameter.
        let edges = (change(xi) - change(eta)) / number(12.0 * GAUSS);
        xi[4][dof] -= skew[0] * edges;
        eta[4][dof] -= skew[1] * edges;
    }
    rows
}

/// Skew ratios p = a × c / a × b and q = b × c / a × b of the quadrilateral of the corners. Both are zero for a
/// parallelogram.
///
/// The quadrilateral has the tangents a + cη along ξ and b + cξ along η. The scalar products of a and b with the
/// physical shear times det J are a × b times ((1 + pξ)γξ − pηγη, qξγξ + (1 − qη)γη).
#[inline(always)]
fn skew<T: Number>(geometry: &Geometry<T>) -> [T; 2] {
    let [r, s, t, u] = [0, 1, 2, 3].map(|i| geometry.at[i]);
    let vector = |signs: [f64; 3]| {
        [0, 1].map(|k| (s[k] - r[k]) * signs[0] + (t[k] - r[k]) * signs[1] + (u[k] - r[k]) * signs[2])
    };
    let (a, b, c) = (vector([1.0, 1.0, -1.0]), vector([-1.0, 1.0, 1.0]), vector([-1.0, 1.0, -1.0]));
    let cross = |[x, y]: [T; 2], [v, w]: [T; 2]| x * w - y * v;
    [cross(a, c), cross(b, c)].map(|part| part / cross(a, b))
}

/// Strain–displacement matrices at the points `at` (ξ, η): κ = sym ∇θ from the nine rotation functions, and the tied
/// shear γ in x and y.
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

/// Rows of κ from the gradients of the nine rotation functions in x and y; the rows of shear are zero.
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

/// Data of one integration point for the bending stiffness.
#[derive(Clone, Copy)]
pub(super) struct Point<T = f64> {
    /// Gradients of the nine rotation functions in x and y.
    pub(super) gradient: [[T; 2]; 9],
    /// Integration weight of the point times det J.
    pub(super) scale: T,
    pub(super) section: Section<T>,
}

impl<T: Number> Point<T> {
    #[inline(always)]
    pub(super) fn none(zero: T) -> Self {
        let section = Section { bending: [[zero; 3]; 3], shear: [[zero; 2]; 2] };
        Self { gradient: [[zero; 2]; 9], scale: zero, section }
    }

    #[inline(always)]
    pub(super) fn of(jacobian: &Jacobian<T>, at: &Station, scale: T, section: Section<T>) -> Self {
        let mut gradient = [[scale; 2]; 9];
        for i in 0..9 {
            gradient[i] = jacobian.physical(at.rotation.gradient[i]);
        }
        Self { gradient, scale, section }
    }
}

/// Bending and shear of an element, kept separate: bending at the integration points (`points`), shear as a quadratic
/// form in the tied values (`form`). `rows` give the tied values from all dofs.
pub(super) struct Apart<T = f64> {
    pub(super) points: [Point<T>; 9],
    pub(super) form: [[T; 2 * TIES]; 2 * TIES],
    pub(super) rows: [[T; ALL_DOFS]; 2 * TIES],
}

impl<T: Number> Apart<T> {
    /// Makes the data of a quadrilateral; `section(k)` is its section at Gauss point k of 3×3.
    #[inline(always)]
    pub(super) fn of(geometry: &Geometry<T>, section: impl Fn(usize) -> Section<T>) -> Self {
        let zero = geometry.at[0][0].like(0.0);
        let (mut form, mut points) = ([[zero; 2 * TIES]; 2 * TIES], [Point::none(zero); 9]);
        // Plain loops, since closures passed to array functions such as `map` would not be inlined here.
        for k in 0..9 {
            let station = &GAUSS_POINTS[k];
            let (xi, eta) = (station.xi, station.eta);
            let jacobian = geometry.jacobian_of(station.shape);
            points[k] = Point::of(&jacobian, station, jacobian.determinant * station.weight, section(k));
            let (inv, shear, scale) = (&jacobian.inverse, &points[k].section.shear, points[k].scale);
            let weights = [interpolation(xi, eta), interpolation(eta, xi)];
            for a in 0..2 {
                for b in 0..=a {
                    let x = shear[0][0] * inv[0][b] + shear[0][1] * inv[1][b];
                    let y = shear[1][0] * inv[0][b] + shear[1][1] * inv[1][b];
                    let g = scale * (inv[0][a] * x + inv[1][a] * y);
                    for s in 0..TIES {
                        for t in 0..TIES {
                            form[a * TIES + s][b * TIES + t] += g * weights[a][s] * weights[b][t];
                        }
                    }
                }
            }
        }
        for s in 0..TIES {
            for t in 0..TIES {
                form[s][TIES + t] = form[TIES + t][s];
            }
        }
        let [along, across] = ties(geometry);
        let mut rows = [[zero; ALL_DOFS]; 2 * TIES];
        rows[..TIES].copy_from_slice(&along);
        rows[TIES..].copy_from_slice(&across);
        Self { points, form, rows }
    }

    /// Lower triangle, over all dofs, of the bending stiffness of the element.
    #[inline(always)]
    pub(super) fn bending(&self) -> [[T; ALL_DOFS]; ALL_DOFS] {
        let mut full = [[self.points[0].scale.like(0.0); ALL_DOFS]; ALL_DOFS];
        for point in &self.points {
            add_bending(&mut full, point);
        }
        full
    }
}

/// Element stiffness: bending plus the quadratic form of shear, with the centre rotations condensed.
#[inline(always)]
pub(super) fn stiffness<T: Number>(apart: &Apart<T>) -> Stiffness<T> {
    let mut full = apart.bending();
    add_shear(&mut full, &apart.form, &apart.rows);
    condense(&full)
}

#[inline(always)]
fn add_bending<T: Number>(full: &mut [[T; ALL_DOFS]; ALL_DOFS], point: &Point<T>) {
    let (gradient, bending) = (&point.gradient, &point.section.bending);
    for i in 0..9 {
        let r = if i < 8 { 3 * i + 1 } else { CENTRE };
        let (x, y) = (point.scale * gradient[i][0], point.scale * gradient[i][1]);
        // Moments [mxx, myy, mxy], times weight, for a unit slope θx and for a unit slope θy of node i.
        let (mut first, mut second) = ([x; 3], [y; 3]);
        for a in 0..3 {
            first[a] = bending[a][0] * x + bending[a][2] * y;
            second[a] = bending[a][1] * y + bending[a][2] * x;
        }
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

/// Adds rowsᵀ · form · rows, the shear stiffness, to the lower triangle `full` of the stiffness over all dofs.
#[inline(always)]
pub(super) fn add_shear<T: Number>(
    full: &mut [[T; ALL_DOFS]; ALL_DOFS],
    form: &[[T; 2 * TIES]; 2 * TIES],
    rows: &[[T; ALL_DOFS]; 2 * TIES],
) {
    let mut product = [[form[0][0].like(0.0); ALL_DOFS]; 2 * TIES];
    for s in 0..2 * TIES {
        for dof in 0..ALL_DOFS {
            let mut sum = product[s][dof];
            for t in 0..2 * TIES {
                sum += form[s][t] * rows[t][dof];
            }
            product[s][dof] = sum;
        }
    }
    for i in 0..ALL_DOFS {
        for j in 0..=i {
            let mut sum = full[i][j];
            for s in 0..2 * TIES {
                sum += rows[s][i] * product[s][j];
            }
            full[i][j] = sum;
        }
    }
}

/// Eliminates the two centre rotations from the stiffness `full` over all dofs, of which the lower triangle is read.
#[inline(always)]
pub(super) fn condense<T: Number>(full: &[[T; ALL_DOFS]; ALL_DOFS]) -> Stiffness<T> {
    let [a, b, d] = [full[CENTRE][CENTRE], full[CENTRE + 1][CENTRE], full[CENTRE + 1][CENTRE + 1]];
    let determinant = a * d - b * b;
    let compliance = [[d / determinant, -b / determinant], [-b / determinant, a / determinant]];
    let mut coupling = [[a.like(0.0); DOFS]; 2];
    for j in 0..DOFS {
        let [p, q] = [full[CENTRE][j], full[CENTRE + 1][j]];
        coupling[0][j] = compliance[0][0] * p + compliance[0][1] * q;
        coupling[1][j] = compliance[1][0] * p + compliance[1][1] * q;
    }
    let mut lower = [a.like(0.0); PACKED];
    for i in 0..DOFS {
        for j in 0..=i {
            let inner = full[CENTRE][i] * coupling[0][j] + full[CENTRE + 1][i] * coupling[1][j];
            lower[packed(i, j)] = full[i][j] - inner;
        }
    }
    Stiffness { packed: lower, centre: Centre { coupling, compliance } }
}
