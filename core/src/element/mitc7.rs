//! MITC7 on the 6-node triangle (Bathe, Brezzi & Fortin 1989, Int. J. Num. Meth. Eng. 28, 1787–1801).
//!
//! The deflection has the six quadratic functions. Rotations have these and the cubic bubble, whose two rotations are
//! condensed. The covariant shear lies in γr ∈ span{1, r, s} + s(a r + b s), γs ∈ span{1, r, s} − r(a r + b s), which
//! has eight parameters. Eight tied values of ∇w − θ determine the shear: its tangential component at two Gauss points
//! of each edge, and its two means over the reference triangle. With straight sides these means are those of the
//! physical shear.
//!
//! A triangle is stored as an element of eight nodes whose side from the third to the fourth node is collapsed: corners
//! a, b, c, c, then the midsides ab, bc, c, ca. The functions of the repeated c are zero.

use super::geometry::Geometry;
use super::matrices::{ALL_DOFS, StrainMatrix};
use super::mitc9::{Apart, GAUSS, Point, Station, TIES, add_shear_along, bending_rows};
use super::number::Number;
use super::quadrature::radon;
use super::section::Section;
use super::shape::{bubbled, triangular};
use std::sync::LazyLock;

/// Number of shear parameters of a triangle. Arrays have ten entries, as for a quadrilateral; the last two are unused.
const NUMBERS: usize = 8;

fn station(r: f64, s: f64, weight: f64) -> Station {
    Station { xi: r, eta: s, weight, shape: triangular(r, s), rotation: bubbled(r, s) }
}

static POINTS: LazyLock<[Station; 9]> = LazyLock::new(|| radon().map(|(r, s, weight)| station(r, s, weight)));

/// The six points on the edges at which the shear is tied, each with the direction of its edge in (r, s).
static TYING_POINTS: LazyLock<[(Station, [f64; 2]); 6]> = LazyLock::new(|| {
    std::array::from_fn(|tie| {
        let t = if tie % 2 == 0 { 0.5 * (1.0 - GAUSS) } else { 0.5 * (1.0 + GAUSS) };
        match tie / 2 {
            0 => (station(t, 0.0, 1.0), [1.0, 0.0]),
            1 => (station(1.0 - t, t, 1.0), [-1.0, 1.0]),
            _ => (station(0.0, 1.0 - t, 1.0), [0.0, -1.0]),
        }
    })
});

/// Values at (r, s) of the eight functions that span the covariant shear: a row for γr, a row for γs.
fn functions(r: f64, s: f64) -> [[f64; NUMBERS]; 2] {
    [[1.0, r, s, 0.0, 0.0, 0.0, r * s, s * s], [0.0, 0.0, 0.0, 1.0, r, s, -r * r, -r * s]]
}

/// Matrix that maps the eight tied values to the coefficients of the eight shear functions.
static FROM_TIES: LazyLock<[[f64; NUMBERS]; NUMBERS]> = LazyLock::new(|| {
    let mut rows = [[0.0; 2 * NUMBERS]; NUMBERS];
    let mut add = |row: usize, at: &Station, along: [f64; 2], weight: f64| {
        let [first, second] = functions(at.xi, at.eta);
        (0..NUMBERS).for_each(|k| rows[row][k] += weight * (along[0] * first[k] + along[1] * second[k]));
    };
    for (row, (at, along)) in TYING_POINTS.iter().enumerate() {
        add(row, at, *along, 1.0);
    }
    for at in POINTS.iter() {
        add(6, at, [1.0, 0.0], at.weight);
        add(7, at, [0.0, 1.0], at.weight);
    }
    (0..NUMBERS).for_each(|row| rows[row][NUMBERS + row] = 1.0);
    inverted(rows)
});

/// A⁻¹ by Gauss–Jordan elimination; `rows` has the rows of [A | I], with the unit matrix I.
fn inverted(mut rows: [[f64; 2 * NUMBERS]; NUMBERS]) -> [[f64; NUMBERS]; NUMBERS] {
    for k in 0..NUMBERS {
        let pivot = (k..NUMBERS).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs())).expect("rows are left");
        rows.swap(k, pivot);
        let row = rows[k].map(|value| value / rows[k][k]);
        for other in &mut rows {
            let factor = other[k];
            other.iter_mut().zip(row).for_each(|(value, part)| *value -= factor * part);
        }
        rows[k] = row;
    }
    rows.map(|row| std::array::from_fn(|k| row[NUMBERS + k]))
}

/// Matrix that maps the eight tied values to γr and γs at (r, s).
fn interpolation(r: f64, s: f64) -> [[f64; NUMBERS]; 2] {
    functions(r, s).map(|parts| {
        let mut sum = [0.0; NUMBERS];
        for (part, row) in parts.iter().zip(FROM_TIES.iter()) {
            sum.iter_mut().zip(row).for_each(|(sum, from)| *sum += part * from);
        }
        sum
    })
}

/// Rows over all dofs that give the eight tied values of the covariant shear: six values on the edges, then two means.
#[inline(always)]
fn ties<T: Number>(geometry: &Geometry<T>) -> [[T; ALL_DOFS]; NUMBERS] {
    let number = |value: f64| geometry.at[0][0].like(value);
    let mut rows = [[number(0.0); ALL_DOFS]; NUMBERS];
    for (row, (at, along)) in rows.iter_mut().zip(TYING_POINTS.iter()) {
        add_shear_along(row, geometry, along.map(number), at);
    }
    for at in POINTS.iter() {
        add_shear_along(&mut rows[6], geometry, [at.weight, 0.0].map(number), at);
        add_shear_along(&mut rows[7], geometry, [0.0, at.weight].map(number), at);
    }
    rows
}

/// Strain–displacement matrices at the points `at` (r, s): κ = sym ∇θ from the seven rotation functions, and the tied
/// shear γ in x and y.
pub fn strain_matrices<const N: usize>(geometry: &Geometry, at: [(f64, f64); N]) -> [StrainMatrix; N] {
    let rows = ties(geometry);
    at.map(|(r, s)| {
        let jacobian = geometry.jacobian(r, s);
        let mut strain = bending_rows(bubbled(r, s).gradient.map(|gradient| jacobian.physical(gradient)));
        let weights = interpolation(r, s);
        for dof in 0..ALL_DOFS {
            let covariant = [0, 1].map(|a| (0..NUMBERS).map(|t| weights[a][t] * rows[t][dof]).sum::<f64>());
            let [x, y] = jacobian.physical(covariant);
            strain[3][dof] = x;
            strain[4][dof] = y;
        }
        strain
    })
}

/// Rows over all dofs that give the mean over the element of the tied shear γ, in x and y.
///
/// If a triangle is larger than the thickness, only this mean of its shear is accurate.
pub fn mean_shear(geometry: &Geometry) -> [[f64; ALL_DOFS]; 2] {
    let points = radon();
    let mut mean = [[0.0; ALL_DOFS]; 2];
    let mut area = 0.0;
    for ((r, s, weight), strain) in points.into_iter().zip(strain_matrices(geometry, points.map(|(r, s, _)| (r, s)))) {
        let part = weight * geometry.jacobian(r, s).determinant;
        area += part;
        for a in 0..2 {
            mean[a].iter_mut().zip(strain[3 + a]).for_each(|(sum, row)| *sum += part * row);
        }
    }
    mean.map(|row| row.map(|value| value / area))
}

/// Data of a triangle with bending and shear separate: bending at the seven integration points, at which `section` is
/// evaluated, and shear as a quadratic form in the eight tied values.
#[inline(always)]
pub(super) fn apart<T: Number>(geometry: &Geometry<T>, section: impl Fn(usize) -> Section<T>) -> Apart<T> {
    let zero = geometry.at[0][0].like(0.0);
    let mut form = [[zero; 2 * TIES]; 2 * TIES];
    let mut points = [Point::none(zero); 9];
    // Plain loops, since closures passed to array functions such as `map` would not be inlined here.
    for (k, at) in POINTS.iter().enumerate() {
        let jacobian = geometry.jacobian_of(at.shape);
        points[k] = Point::of(&jacobian, at, jacobian.determinant * (0.5 * at.weight), section(k));
        let Point { scale, section, .. } = &points[k];
        let [along, across] = interpolation(at.xi, at.eta);
        let mut strains = [[zero; 2]; NUMBERS];
        for t in 0..NUMBERS {
            strains[t] = jacobian.physical([along[t], across[t]]);
        }
        for s in 0..NUMBERS {
            let [x, y] = strains[s];
            let force = [0, 1].map(|a| (section.shear[a][0] * x + section.shear[a][1] * y) * *scale);
            for t in 0..NUMBERS {
                form[s][t] += force[0] * strains[t][0] + force[1] * strains[t][1];
            }
        }
    }
    // The unused diagonal entries of the shear form are set to a positive value, so that the form has an inverse.
    (NUMBERS..2 * TIES).for_each(|t| form[t][t] = form[0][0]);
    let mut rows = [[zero; ALL_DOFS]; 2 * TIES];
    rows[..NUMBERS].copy_from_slice(&ties(geometry));
    Apart { points, form, rows }
}
