//! What a complementary basis determines: the principal pivotal transform and the basic solution.
use faer::{Mat, MatMut};

use super::factors::Factors;
use super::kernels::vectorized;
use super::scaling::CoveredLcp;
use super::tableau::Tableau;
use super::tolerances;
use crate::double_double::DoubleDouble;

impl CoveredLcp<'_> {
    /// The problem as it reads with z_i and w_i exchanged wherever `basis` is true, with covering vector e; None if the
    /// principal submatrix of M there is singular (Cottle, Pang & Stone 1992, section 2.3).
    pub(super) fn principal_transform(&self, basis: &[bool]) -> Option<CoveredLcp<'static>> {
        let pivoted = self.pivoted(basis)?;
        Some(CoveredLcp { covering: vec![1.0; self.order()], ..pivoted })
    }

    /// As [`Self::principal_transform`], with the covering vector that the pivots make of its own.
    pub(super) fn pivoted(&self, basis: &[bool]) -> Option<CoveredLcp<'static>> {
        let exchanged = indices(basis);
        let mut tableau = Tableau::new(self);
        if !tableau.exchange_block(&exchanged, &exchanged) {
            return None;
        }
        let (matrix, covering, q) = tableau.into_parts();
        Some(CoveredLcp { matrix: matrix.into(), units: vec![1.0; self.order()].into(), q, covering })
    }

    /// z and w at a complementary basis, from an LU factorization and a step of iterative refinement whose residual is
    /// summed in double-double; None if the basis is singular or infeasible.
    pub(super) fn basic_solution(&self, basis: &[bool]) -> Option<(Vec<f64>, Vec<f64>)> {
        let order = self.order();
        let basic = indices(basis);
        let count = basic.len();
        let block = self.principal_block(&basic);
        let factors = Factors::of(&block)?;
        let right: Vec<f64> = basic.iter().map(|&i| -self.q[i]).collect();
        let mut solution = right.clone();
        factors.solve_in_place(MatMut::from_column_major_slice_mut(&mut solution, count, 1));
        let mut correction = residual(&block, &solution, &right);
        factors.solve_in_place(MatMut::from_column_major_slice_mut(&mut correction, count, 1));
        solution.iter_mut().zip(&correction).for_each(|(x, c)| *x += c);
        let mut z = vec![0.0; order];
        basic.iter().zip(&solution).for_each(|(&i, x)| z[i] = *x);
        let largest = z.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        if !largest.is_finite() || z.iter().any(|&x| x < -tolerances::FEASIBILITY * largest || x.is_nan()) {
            return None;
        }
        z.iter_mut().for_each(|x| *x = x.max(0.0));

        let work: f64 = basic.iter().map(|&j| self.q[j].abs() * z[j]).sum();
        let scaled: Vec<f64> = basic.iter().map(|&j| z[j] * self.units[j]).collect();
        let mut w = vec![0.0; order];
        for i in (0..order).filter(|&i| !basis[i]) {
            let row = &self.matrix[i * order..(i + 1) * order];
            let (mut product, mut size) = (0.0, 0.0);
            for (&j, x) in basic.iter().zip(&scaled) {
                let term = row[j] * x;
                product += term;
                size += term.abs();
            }
            let slack = self.q[i] + product * self.units[i];
            let size = self.q[i].abs() + size * self.units[i] + (self.entry(i, i).abs() * work).sqrt();
            if slack < -tolerances::FEASIBILITY * size || slack.is_nan() {
                return None;
            }
            w[i] = slack.max(0.0);
        }
        Some((z, w))
    }

    /// M′_αα for the indices α; by eight rows at a time, because M lies by rows and the block by columns.
    fn principal_block(&self, indices: &[usize]) -> Mat<f64> {
        let order = self.order();
        let units: Vec<f64> = indices.iter().map(|&i| self.units[i]).collect();
        let mut block = Mat::zeros(indices.len(), indices.len());
        for (tile, (rows, row_units)) in indices.chunks(8).zip(units.chunks(8)).enumerate() {
            for (j, (&column, unit)) in indices.iter().zip(&units).enumerate() {
                let target = &mut block.col_as_slice_mut(j)[8 * tile..];
                for ((a, row), row_unit) in target.iter_mut().zip(rows).zip(row_units) {
                    *a = self.matrix[row * order + column] * row_unit * unit;
                }
            }
        }
        block
    }
}

/// right − block · x, summed in double-double, column by column so that no sum waits for itself.
fn residual(block: &Mat<f64>, x: &[f64], right: &[f64]) -> Vec<f64> {
    let (mut high, mut low) = (right.to_vec(), vec![0.0; right.len()]);
    vectorized(
        #[inline(always)]
        || {
            for (j, x) in x.iter().enumerate() {
                for ((hi, lo), a) in high.iter_mut().zip(&mut low).zip(block.col_as_slice(j)) {
                    let mut sum = DoubleDouble { hi: *hi, lo: *lo };
                    sum.add_product(-a, *x);
                    (*hi, *lo) = (sum.hi, sum.lo);
                }
            }
        },
    );
    high.iter().zip(&low).map(|(hi, lo)| hi + lo).collect()
}

fn indices(basis: &[bool]) -> Vec<usize> {
    (0..basis.len()).filter(|&i| basis[i]).collect()
}
