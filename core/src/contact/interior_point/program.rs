//! The contact problem as a quadratic program, and what proves that it has no solution.

use crate::assembly::{Assembly, HELD, Numbering};
use crate::contact::points::Constraints;
use crate::contact::scale::largest;
use crate::contact::tolerances;
use crate::displacement::Displacement;
use crate::plate::Plate;
use crate::residual::residual;
use crate::rows::Springs;
use clarabel::algebra::CscMatrix;

/// The quadratic program min ½xᵀPx + qᵀx, Ax + s = b, in units in which P has the diagonal 1 and every row of A the norm 1.
pub(super) struct Program {
    /// Upper triangle of P.
    pub(super) quadratic: CscMatrix<f64>,
    pub(super) linear: Vec<f64>,
    pub(super) rows: CscMatrix<f64>,
    pub(super) right: Vec<f64>,
    pub(super) equations: usize,
    /// Row of every contact point.
    pub(super) row_of: Vec<usize>,
    /// What a unit of x is in displacements, and a unit of a row's multiplier in force.
    pub(super) displacement_unit: Vec<f64>,
    pub(super) force_unit: Vec<f64>,
}

impl Program {
    /// In units of force and length that the load sets, or, without one, the gaps.
    pub(super) fn pose(
        plate: &Plate,
        springs: &Springs,
        numbering: &Numbering,
        constraints: &Constraints,
        load: &[f64],
        held: &Displacement,
    ) -> Self {
        let matrix = Assembly::new(plate, springs, &[], numbering).lower_triangle();
        let (n, m) = (numbering.len(), constraints.rows.len());
        let lower = || (0..n).flat_map(|j| (matrix.column_start[j]..matrix.column_start[j + 1]).map(move |at| (j, at)));
        let mut unit = vec![1.0; n];
        for (j, at) in lower().filter(|&(j, at)| matrix.row[at] == j && matrix.value[at] > 0.0) {
            unit[j] = 1.0 / matrix.value[at].sqrt();
        }
        let (mut p, mut a) = (Vec::new(), Vec::new());
        for (j, at) in lower() {
            let i = matrix.row[at];
            p.push((j, i, unit[i] * unit[j] * matrix.value[at]));
        }

        let equations = constraints.two_sided.iter().filter(|&&two| two).count();
        let (mut next_equation, mut next_inequality) = (0, equations);
        let mut columns = n;
        let mut row_of = Vec::with_capacity(m);
        let mut norms = vec![1.0; m];
        let mut right = vec![0.0; m];
        for i in 0..m {
            let next = if constraints.two_sided[i] { &mut next_equation } else { &mut next_inequality };
            let row = *next;
            *next += 1;
            row_of.push(row);
            let entries = || {
                let all = constraints.rows.entries(plate, i).map(|(dof, c)| (numbering.column[dof], c));
                all.filter(|&(column, _)| column != HELD).map(|(column, c)| (column, c * unit[column]))
            };
            let compliance = constraints.compliance[i];
            let square = entries().map(|(_, c)| c * c).sum::<f64>() + compliance;
            if square > 0.0 {
                norms[row] = square.sqrt();
            }
            entries().for_each(|(column, c)| a.push((row, column, c / norms[row])));
            if compliance > 0.0 {
                p.push((columns, columns, 1.0));
                a.push((row, columns, -compliance.sqrt() / norms[row]));
                columns += 1;
            }
            right[row] = -constraints.rows.beyond(plate, i, held, constraints.distance[i]) / norms[row];
        }

        let force = residual(plate, springs, load, held);
        let mut linear: Vec<f64> = (0..n).map(|j| -unit[j] * force[numbering.dof[j]]).collect();
        linear.resize(columns, 0.0);
        let size = [largest(&linear), largest(&right), 1.0].into_iter().find(|&size| size > 0.0).unwrap_or(1.0);
        linear.iter_mut().chain(&mut right).for_each(|value| *value /= size);
        Self {
            quadratic: compressed(columns, columns, &p),
            linear,
            rows: compressed(m, columns, &a),
            right,
            equations,
            row_of,
            displacement_unit: unit.into_iter().map(|unit| size * unit).collect(),
            force_unit: norms.into_iter().map(|norm| size / norm).collect(),
        }
    }

    /// Points with more reaction than gap, one relative to the largest force, the other to the largest displacement of a
    /// point or gap.
    pub(super) fn closed(&self, x: &[f64], multiplier: &[f64], slack: &[f64]) -> Vec<bool> {
        let force = largest(multiplier).max(largest(&self.linear));
        let moved = self.travel(&x[..self.displacement_unit.len()]);
        let length = largest(&moved).max(largest(slack)).max(largest(&self.right));
        let closes = |row: usize| row < self.equations || multiplier[row] * length > slack[row] * force;
        self.row_of.iter().map(|&row| closes(row)).collect()
    }

    /// Ax over the first columns.
    fn travel(&self, x: &[f64]) -> Vec<f64> {
        let mut travel = vec![0.0; self.right.len()];
        for (j, x) in x.iter().enumerate() {
            for at in self.rows.colptr[j]..self.rows.colptr[j + 1] {
                travel[self.rows.rowval[at]] += self.rows.nzval[at] * x;
            }
        }
        travel
    }

    /// Whether multipliers z, of the right sign, prove that no displacement meets the rows: Aᵀz = 0 and bᵀz < 0.
    pub(super) fn gaps_contradict(&self, z: &[f64]) -> bool {
        let (mut sum, mut size) = (vec![0.0; self.rows.n], 0.0_f64);
        for (column, sum) in sum.iter_mut().enumerate() {
            let mut terms = 0.0;
            for at in self.rows.colptr[column]..self.rows.colptr[column + 1] {
                let term = self.rows.nzval[at] * z[self.rows.rowval[at]];
                *sum += term;
                terms += term.abs();
            }
            size = size.max(terms);
        }
        largest(&sum) <= tolerances::interior_point::PROOF * size && is_negative(&self.right, z)
    }

    /// Whether x is a motion that neither the plate nor a row resists and on which the load works: Px = 0, Ax ≤ 0, qᵀx < 0.
    pub(super) fn moves_freely(&self, x: &[f64]) -> bool {
        let (mut force, mut force_size) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        for (j, start) in self.quadratic.colptr[..x.len()].iter().enumerate() {
            for at in *start..self.quadratic.colptr[j + 1] {
                let (i, value) = (self.quadratic.rowval[at], self.quadratic.nzval[at]);
                force[i] += value * x[j];
                force_size[i] += (value * x[j]).abs();
                if i != j {
                    force[j] += value * x[i];
                    force_size[j] += (value * x[i]).abs();
                }
            }
        }
        let against = |(row, &t): (usize, &f64)| if row < self.equations { t.abs() } else { t };
        let closing = self.travel(x).iter().enumerate().map(against).fold(0.0, f64::max);
        largest(&force) <= tolerances::interior_point::PROOF * largest(&force_size)
            && closing <= tolerances::interior_point::PROOF * largest(x)
            && is_negative(&self.linear, x)
    }
}

/// The sparse matrix of entries, each with its row and column, in any order.
fn compressed(rows: usize, columns: usize, entries: &[(usize, usize, f64)]) -> CscMatrix<f64> {
    let (row, column) = entries.iter().map(|entry| (entry.0, entry.1)).unzip();
    CscMatrix::new_from_triplets(rows, columns, row, column, entries.iter().map(|entry| entry.2).collect())
}

/// Whether a product of two vectors is negative, by more than residuals could undo.
fn is_negative(a: &[f64], b: &[f64]) -> bool {
    let terms = || a.iter().zip(b).map(|(a, b)| a * b);
    let scale: f64 = terms().map(f64::abs).sum();
    terms().sum::<f64>() < -tolerances::interior_point::MARGIN * scale
}
