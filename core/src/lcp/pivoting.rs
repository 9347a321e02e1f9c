//! What a complementary basis determines: the principal pivotal transform and the basic solution.
use faer::Mat;
use faer::linalg::solvers::Solve;
use rayon::prelude::*;

use super::scaling::CoveredLcp;
use super::tableau::{PARALLEL_ORDER, Tableau};
use crate::double_double::DoubleDouble;

/// A basis is infeasible if one of its variables is below minus this, relative to the largest z for a z, and to
/// |q_i| + Σ_j |M_ij z_j| for w_i. What is above, but negative, is rounding and becomes zero.
pub(super) const FEASIBILITY_TOLERANCE: f64 = 1e-11;

impl CoveredLcp {
    /// The problem as it reads with z_i and w_i exchanged wherever `basis` is true, with covering vector e; None if the
    /// principal submatrix of M there is singular (Cottle, Pang & Stone 1992, section 2.3).
    pub(super) fn principal_transform(&self, basis: &[bool]) -> Option<Self> {
        let exchanged = indices(basis);
        let mut tableau = Tableau::new(self);
        if !tableau.exchange_block(&exchanged, &exchanged) {
            return None;
        }
        let (matrix, q) = tableau.into_matrix_and_values();
        Some(Self { matrix, q, covering: vec![1.0; self.order()] })
    }

    /// z and w at a complementary basis, from an LU factorization and a step of iterative refinement whose residual is
    /// summed in double-double; None if the basis is singular or infeasible.
    pub(super) fn basic_solution(&self, basis: &[bool]) -> Option<(Vec<f64>, Vec<f64>)> {
        let order = self.order();
        let basic = indices(basis);
        let count = basic.len();
        let block = Mat::from_fn(count, count, |i, j| self.matrix[basic[i] * order + basic[j]]);
        let factors = block.partial_piv_lu();
        let mut z = vec![0.0; order];
        let mut correction = Mat::from_fn(count, 1, |i, _| -self.q[basic[i]]);
        for step in 0..2 {
            if step > 0 {
                let slack = self.slacks(&basic, &z, &basic);
                correction = Mat::from_fn(count, 1, |i, _| -slack[i].0);
            }
            factors.solve_in_place(&mut correction);
            basic.iter().enumerate().for_each(|(i, &at)| z[at] += correction[(i, 0)]);
        }
        let largest = z.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        if !largest.is_finite() || z.iter().any(|&x| x < -FEASIBILITY_TOLERANCE * largest || x.is_nan()) {
            return None;
        }
        z.iter_mut().for_each(|x| *x = x.max(0.0));

        let others: Vec<usize> = (0..order).filter(|&i| !basis[i]).collect();
        let mut w = vec![0.0; order];
        for (&i, (slack, size)) in others.iter().zip(self.slacks(&others, &z, &basic)) {
            if slack < -FEASIBILITY_TOLERANCE * size {
                return None;
            }
            w[i] = slack.max(0.0);
        }
        Some((z, w))
    }

    /// (q_i + Σ_j M_ij z_j, |q_i| + Σ_j |M_ij z_j|) for i in `rows`, summed over j in `columns`.
    fn slacks(&self, rows: &[usize], z: &[f64], columns: &[usize]) -> Vec<(f64, f64)> {
        let slack = |&i: &usize| {
            let row = &self.matrix[i * self.order()..];
            let mut sum = DoubleDouble::from(self.q[i]);
            let mut size = self.q[i].abs();
            for &j in columns {
                sum = sum + DoubleDouble::from(row[j]).times(z[j]);
                size += (row[j] * z[j]).abs();
            }
            (sum.value(), size)
        };
        if self.order() < PARALLEL_ORDER {
            rows.iter().map(slack).collect()
        } else {
            rows.par_iter().map(slack).collect()
        }
    }
}

fn indices(basis: &[bool]) -> Vec<usize> {
    (0..basis.len()).filter(|&i| basis[i]).collect()
}
