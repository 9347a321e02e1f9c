//! Thin elements mitc9 and mitc7, with bending and shear kept separate.
//!
//! If both were added in one matrix, bending would be lost: shear is (ℓ/h)² times stiffer (element size ℓ, thickness
//! h), and the rounding of its entries acts as a spurious bending stiffness. Here strains are formed first, in
//! double-double, and forces are computed from the strains. Rounding errors are then relative to the true moments and
//! shears.

use super::geometry::Geometry;
use super::matrices::{ALL_DOFS, Centre, DOFS, PACKED};
use super::mitc7;
use super::mitc9::{Apart, CENTRE, TIES, add_shear, condense};
use super::section::{Material, Sections};
use crate::double_double::DoubleDouble;
use faer::{Mat, Side};

/// Number of tied values of the shear in an element.
pub const SHEARS: usize = 2 * TIES;

/// Number of iterative corrections of the condensed centre rotations. Each removes the rounding error of the one
/// before.
const CENTRE_CORRECTIONS: usize = 2;

/// If the ratio of shear to bending stiffness exceeds this value, an element's matrix keeps fewer than eight digits of
/// bending.
const BENDING_LOST: f64 = 1e8;

/// Ratio of shear stiffness to bending stiffness across the shorter side, in the reduced matrix of a very thin element.
/// The ratio is large enough to constrain shear modes and small enough to keep the digits of bending.
const SOFT_SHEAR: f64 = 1.0;

fn apart(geometry: &Geometry, material: &Material, sections: Sections) -> Apart {
    let section = |point| sections.at(point, material);
    if geometry.triangle { mitc7::apart(geometry, section) } else { Apart::of(geometry, section) }
}

/// Lengths of an element along ξ and η at its centre. For a triangle: its longest side, and 4/√3 times its area divided
/// by this side. Both are equal if the triangle is equilateral.
fn lengths(geometry: &Geometry) -> [f64; 2] {
    if geometry.triangle {
        let [a, b, c] = [0, 1, 2].map(|i| geometry.at[i]);
        let longest =
            [(a, b), (b, c), (c, a)].iter().fold(0.0, |most: f64, (p, q)| most.max((p[0] - q[0]).hypot(p[1] - q[1])));
        let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        return [longest, 4.0 / 3.0_f64.sqrt() * area / longest];
    }
    geometry.jacobian(0.0, 0.0).tangent.map(|[x, y]| 2.0 * x.hypot(y))
}

/// Aspect ratio of an element: the longer of its two [`lengths`] divided by the shorter.
fn aspect(geometry: &Geometry) -> f64 {
    let [a, b] = lengths(geometry);
    a.max(b) / a.min(b)
}

/// Slenderness L/h of the plate times the aspect ratio of the element, with L = `size`, h = `thinnest`. Rounding errors
/// of forces from the element's matrix grow with the square of this number.
pub fn slenderness(geometry: &Geometry, thinnest: f64, size: f64) -> f64 {
    aspect(geometry) * size / thinnest
}

/// Compliance s that is put in series with each tied shear; `None` if the matrix with the full shear keeps enough
/// digits of bending.
fn series(geometry: &Geometry, material: &Material, thinnest: f64) -> Option<f64> {
    let ([a, b], aspect) = (lengths(geometry), aspect(geometry));
    let rigidity = material.bending_rigidity(thinnest);
    let ratio = material.shear_rigidity(thinnest) * a.max(b).powi(2) / rigidity;
    let across = rigidity * a * b / a.min(b).powi(4);
    (ratio * aspect * aspect > BENDING_LOST).then(|| 1.0 / (SOFT_SHEAR * across))
}

/// Packed matrix of an element with reduced shear, for the factorization. `None` if the matrix with the full shear
/// keeps enough digits of bending. [`shear_springs`] returns the rest of the shear stiffness.
pub fn factored_stiffness(
    geometry: &Geometry,
    material: &Material,
    sections: Sections,
    thinnest: f64,
) -> Option<[f64; PACKED]> {
    let series = series(geometry, material, thinnest)?;
    let apart = apart(geometry, material, sections);
    let mut sum = inverse(&apart.form);
    (0..SHEARS).for_each(|t| sum[t][t] += series);
    let mut full = apart.bending();
    add_shear(&mut full, &inverse(&sum), &apart.rows);
    Some(condense(&full).packed)
}

/// The shear stiffness that [`factored_stiffness`] leaves out, as springs: for each, its row over the nodal dofs and
/// its compliance. The forces of these springs are unknowns of the system.
///
/// The shear stiffness is C⁻¹, where C includes the condensed centre rotations, and s is the compliance in series. The
/// matrix has the part (C + s)⁻¹, the springs have C⁻¹ − (C + s)⁻¹ = (C + C²/s)⁻¹. Neither part loses bending in
/// rounding; only their sum would.
pub fn shear_springs(
    geometry: &Geometry,
    material: &Material,
    sections: Sections,
    thinnest: f64,
) -> Option<Vec<([f64; DOFS], f64)>> {
    let series = series(geometry, material, thinnest)?;
    let apart = apart(geometry, material, sections);
    let Centre { coupling, compliance } = condense(&apart.bending()).centre;
    let at_centre = apart.rows.map(|row| [row[CENTRE], row[CENTRE + 1]]);
    let alone = inverse(&apart.form);
    let sheared = Mat::from_fn(SHEARS, SHEARS, |t, s| {
        let turned =
            (0..2).map(|a| at_centre[t][a] * (compliance[a][0] * at_centre[s][0] + compliance[a][1] * at_centre[s][1]));
        alone[t][s] + turned.sum::<f64>()
    });
    let eigen = sheared.self_adjoint_eigen(Side::Lower).ok()?;
    // Eigenvalues of the shear compliance C below this value are rounding errors of the condensed centre rotations.
    let least = f64::EPSILON * eigen.S()[SHEARS - 1];
    let row =
        |t: usize, j: usize| apart.rows[t][j] - at_centre[t][0] * coupling[0][j] - at_centre[t][1] * coupling[1][j];
    let spring = |k: usize| {
        let own = eigen.S()[k].max(least);
        let along = std::array::from_fn(|j| (0..SHEARS).map(|t| eigen.U()[(t, k)] * row(t, j)).sum());
        (along, own + own * own / series)
    };
    Some((0..SHEARS).map(spring).collect())
}

/// Inverse of a symmetric positive definite matrix, scaled to a unit diagonal and factored by Cholesky's method.
fn inverse(form: &[[f64; SHEARS]; SHEARS]) -> [[f64; SHEARS]; SHEARS] {
    let unit: [f64; SHEARS] = std::array::from_fn(|t| 1.0 / form[t][t].sqrt());
    let mut lower = [[0.0; SHEARS]; SHEARS];
    for i in 0..SHEARS {
        for j in 0..=i {
            let inner: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let left = form[i][j] * unit[i] * unit[j] - inner;
            lower[i][j] = if i == j { left.sqrt() } else { left / lower[j][j] };
        }
    }
    let mut out = [[0.0; SHEARS]; SHEARS];
    for column in 0..SHEARS {
        let mut x = [0.0; SHEARS];
        for i in 0..SHEARS {
            let inner: f64 = (0..i).map(|k| lower[i][k] * x[k]).sum();
            x[i] = (f64::from(u8::from(i == column)) - inner) / lower[i][i];
        }
        for i in (0..SHEARS).rev() {
            let inner: f64 = (i + 1..SHEARS).map(|k| lower[k][i] * x[k]).sum();
            x[i] = (x[i] - inner) / lower[i][i];
        }
        (0..SHEARS).for_each(|i| out[i][column] = x[i] * unit[i] * unit[column]);
    }
    // The inverse is made symmetric to the last bit.
    std::array::from_fn(|i| std::array::from_fn(|j| out[i.max(j)][i.min(j)]))
}

/// Strains of a thin element, and the moments and shear forces that follow from them.
pub struct Strains<'a> {
    apart: Apart,
    centre: &'a Centre,
    /// `curvature` is [κxx, κyy, 2κxy] at the integration points; `moment` has the moments there, times integration
    /// weight and det J.
    curvature: [[f64; 3]; 9],
    moment: [[f64; 3]; 9],
    /// `shear` has the tied values of the shear strain; `force` has the forces that are work-conjugate to them.
    shear: [f64; SHEARS],
    force: [f64; SHEARS],
}

impl<'a> Strains<'a> {
    /// Strains from nodal displacements without the rigid motion of the element's first node.
    pub fn of(
        geometry: &Geometry,
        material: &Material,
        sections: Sections,
        centre: &'a Centre,
        displacement: &[DoubleDouble; DOFS],
    ) -> Self {
        let apart = apart(geometry, material, sections);
        let mut all = [DoubleDouble::default(); ALL_DOFS];
        all[..DOFS].copy_from_slice(displacement);
        for (a, coupling) in centre.coupling.iter().enumerate() {
            let sum: f64 = coupling.iter().zip(displacement).map(|(c, u)| c * u.value()).sum();
            all[CENTRE + a] = DoubleDouble::from(-sum);
        }
        let mut curvature = [[DoubleDouble::default(); 3]; 9];
        for (curvature, point) in curvature.iter_mut().zip(&apart.points) {
            for (i, &gradient) in point.gradient.iter().enumerate() {
                let first = if i < 8 { 3 * i + 1 } else { CENTRE };
                add_curvature(curvature, gradient, [all[first], all[first + 1]]);
            }
        }
        let mut shear = apart.rows.map(|row| {
            let mut sum = DoubleDouble::default();
            row.iter().zip(all).filter(|(c, _)| **c != 0.0).for_each(|(c, u)| add_product(&mut sum, *c, u));
            sum
        });
        let none = ([[0.0; 3]; 9], [0.0; SHEARS]);
        let mut strains = Self { apart, centre, curvature: none.0, moment: none.0, shear: none.1, force: none.1 };
        strains.take(&curvature, &shear);
        for _ in 0..CENTRE_CORRECTIONS {
            let couple = strains.centre_couple();
            let turn: [f64; 2] =
                std::array::from_fn(|a| -(centre.compliance[a][0] * couple[0] + centre.compliance[a][1] * couple[1]));
            for (curvature, point) in curvature.iter_mut().zip(&strains.apart.points) {
                add_curvature(curvature, point.gradient[8], turn.map(DoubleDouble::from));
            }
            for (shear, row) in shear.iter_mut().zip(&strains.apart.rows) {
                shear.add_product(row[CENTRE], turn[0]);
                shear.add_product(row[CENTRE + 1], turn[1]);
            }
            strains.take(&curvature, &shear);
        }
        strains
    }

    fn take(&mut self, curvature: &[[DoubleDouble; 3]; 9], shear: &[DoubleDouble; SHEARS]) {
        self.curvature = curvature.map(|all| all.map(DoubleDouble::value));
        self.shear = shear.map(DoubleDouble::value);
        for ((moment, curvature), point) in self.moment.iter_mut().zip(&self.curvature).zip(&self.apart.points) {
            *moment = point.section.moment(*curvature).map(|m| point.scale * m);
        }
        self.force = self.apart.form.map(|row| row.iter().zip(&self.shear).map(|(f, g)| f * g).sum());
    }

    /// Couples on the two centre rotations from moments and shears. They are zero if the centre rotations are exact.
    fn centre_couple(&self) -> [f64; 2] {
        let mut couple = [0.0; 2];
        for (row, force) in self.apart.rows.iter().zip(&self.force) {
            couple[0] += row[CENTRE] * force;
            couple[1] += row[CENTRE + 1] * force;
        }
        for (point, [xx, yy, xy]) in self.apart.points.iter().zip(&self.moment) {
            let [x, y] = point.gradient[8];
            couple[0] += x * xx + y * xy;
            couple[1] += y * yy + x * xy;
        }
        couple
    }

    /// Nodal forces of the element, over its 24 nodal dofs.
    pub fn nodal(&self) -> [f64; DOFS] {
        let mut out = [0.0; DOFS];
        for (row, force) in self.apart.rows.iter().zip(&self.force) {
            out.iter_mut().zip(row).for_each(|(out, c)| *out += c * force);
        }
        for (point, [xx, yy, xy]) in self.apart.points.iter().zip(&self.moment) {
            for (i, [x, y]) in point.gradient[..8].iter().enumerate() {
                out[3 * i + 1] += x * xx + y * xy;
                out[3 * i + 2] += y * yy + x * xy;
            }
        }
        // The couples on the centre rotations are small, but not zero; they are condensed to the nodes.
        let couple = self.centre_couple();
        for (j, out) in out.iter_mut().enumerate() {
            *out -= self.centre.coupling[0][j] * couple[0] + self.centre.coupling[1][j] * couple[1];
        }
        out
    }

    /// For each nodal dof, the sum of the magnitudes of the terms that [`Strains::nodal`] adds to a nodal force.
    pub fn magnitude(&self) -> [f64; DOFS] {
        let mut out = [0.0; DOFS];
        for (row, form) in self.apart.rows.iter().zip(&self.apart.form) {
            let force: f64 = form.iter().zip(&self.shear).map(|(f, g)| (f * g).abs()).sum();
            out.iter_mut().zip(row).for_each(|(out, c)| *out += (c * force).abs());
        }
        for (point, moment) in self.apart.points.iter().zip(&self.moment) {
            let [xx, yy, xy] = moment.map(f64::abs);
            for (i, gradient) in point.gradient[..8].iter().enumerate() {
                let [x, y] = gradient.map(f64::abs);
                out[3 * i + 1] += x * xx + y * xy;
                out[3 * i + 2] += y * yy + x * xy;
            }
        }
        out
    }

    /// Twice the strain energy of the element.
    pub fn twice_the_energy(&self) -> f64 {
        let bending =
            self.moment.iter().flatten().zip(self.curvature.iter().flatten()).map(|(m, k)| m * k).sum::<f64>();
        bending + self.force.iter().zip(&self.shear).map(|(q, g)| q * g).sum::<f64>()
    }
}

/// Adds coefficient · u to `sum`, in double-double.
fn add_product(sum: &mut DoubleDouble, coefficient: f64, u: DoubleDouble) {
    sum.add_product(coefficient, u.hi);
    sum.lo += coefficient * u.lo;
}

/// Adds the curvature from one node's slopes to `[κxx, κyy, 2κxy]`. `[x, y]` is the gradient of the rotation function
/// of this node.
fn add_curvature([xx, yy, xy]: &mut [DoubleDouble; 3], [x, y]: [f64; 2], [along_x, along_y]: [DoubleDouble; 2]) {
    add_product(xx, x, along_x);
    add_product(yy, y, along_y);
    add_product(xy, y, along_x);
    add_product(xy, x, along_y);
}
