//! The condensed tableau of Lemke's algorithm: nonbasic columns only, m × (m + 1) and the values.
//!
//! It is kept as the dictionary `basic = value + T · nonbasic`. An exchange of basic variable r and nonbasic variable s
//! zeroes row r and column s of T and then subtracts one rank-one term. The terms are collected, T = base − U V, and
//! subtracted from the base BLOCK at a time as one matrix product, so that the base is read and written once a block
//! instead of once a pivot; in between, only the columns and rows that a pivot asks for are formed.
use faer::linalg::matmul::matmul;
use faer::{Accum, ColMut, Mat, MatMut, MatRef, Par, RowMut};
use rayon::prelude::*;

use super::factors::{Factors, PARALLEL_ORDER, parallelism};
use super::ratio_test::PIVOT_TOLERANCE;
use super::scaling::CoveredLcp;

/// Rank-one terms that are collected before the base is touched.
const BLOCK: usize = 32;

/// Variables are numbered: slack i is i, its complement is m + i, the artificial variable is 2m.
pub(super) struct Tableau {
    order: usize,
    /// Columns of the base, and the distance from one row to the next.
    columns: usize,
    stride: usize,
    base: Vec<f64>,
    /// U by columns and V by rows, `pending` of each in use.
    left: Vec<f64>,
    right: Vec<f64>,
    pending: usize,
    /// Columns of the base that count as zero until the pending terms are subtracted.
    cleared: Vec<usize>,
    pub(super) values: Vec<f64>,
    pub(super) row_variable: Vec<usize>,
    column_variable: Vec<usize>,
    /// Row i as i, column j as m + j.
    place: Vec<usize>,
    /// Exchanges made one by one since the tableau was last computed from the problem itself.
    pub(super) age: usize,
}

impl Tableau {
    /// The tableau whose basis is the slacks: w = q + Mz + d z₀.
    pub(super) fn new(problem: &CoveredLcp) -> Self {
        let order = problem.order();
        let columns = order + 1;
        // An odd number of cache lines, so that a column's entries do not fall into a few cache sets.
        let stride = (columns.div_ceil(8) | 1) * 8;
        let mut base = vec![0.0; order * stride];
        let fill = |(i, row): (usize, &mut [f64])| {
            problem.copy_row(i, &mut row[..order]);
            row[order] = problem.covering[i];
        };
        if order < PARALLEL_ORDER {
            base.chunks_exact_mut(stride).enumerate().for_each(fill);
        } else {
            base.par_chunks_exact_mut(stride).enumerate().for_each(fill);
        }
        Self {
            order,
            columns,
            stride,
            base,
            left: vec![0.0; BLOCK * order],
            right: vec![0.0; BLOCK * stride],
            pending: 0,
            cleared: Vec::with_capacity(BLOCK),
            values: problem.q.clone(),
            row_variable: (0..order).collect(),
            column_variable: (order..=2 * order).collect(),
            place: (0..=2 * order).collect(),
            age: 0,
        }
    }

    /// The tableau of `problem` at the basis of `self`, computed by a fresh factorization; None if that is singular.
    pub(super) fn recomputed(&self, problem: &CoveredLcp) -> Option<Self> {
        let order = self.order;
        let leaving: Vec<usize> = (0..order).filter(|&i| !self.is_basic(i)).collect();
        let entering: Vec<usize> = (order..=2 * order).filter(|&v| self.is_basic(v)).map(|v| v - order).collect();
        let mut fresh = Self::new(problem);
        fresh.exchange_block(&leaving, &entering).then_some(fresh)
    }

    pub(super) fn artificial(&self) -> usize {
        2 * self.order
    }

    pub(super) fn complement(&self, variable: usize) -> usize {
        if variable < self.order { variable + self.order } else { variable - self.order }
    }

    pub(super) fn is_basic(&self, variable: usize) -> bool {
        self.row_of(variable).is_some()
    }

    /// The row of a basic variable.
    pub(super) fn row_of(&self, variable: usize) -> Option<usize> {
        Some(self.place[variable]).filter(|&place| place < self.order)
    }

    /// The column of a nonbasic variable.
    fn column_of(&self, variable: usize) -> usize {
        self.place[variable] - self.order
    }

    /// T's entry in row i and the column of a nonbasic variable.
    pub(super) fn entry(&self, i: usize, nonbasic: usize) -> f64 {
        let j = self.column_of(nonbasic);
        let terms = (0..self.pending).map(|k| self.left[k * self.order + i] * self.right[k * self.stride + j]);
        let base = if self.cleared.contains(&j) { 0.0 } else { self.base[i * self.stride + j] };
        base - terms.sum::<f64>()
    }

    /// T's column of a nonbasic variable.
    pub(super) fn column(&self, nonbasic: usize, column: &mut [f64]) {
        let j = self.column_of(nonbasic);
        if self.cleared.contains(&j) {
            column.fill(0.0);
        } else {
            for (x, row) in column.iter_mut().zip(self.base.chunks_exact(self.stride)) {
                *x = row[j];
            }
        }
        let left = MatRef::from_column_major_slice(&self.left[..self.pending * self.order], self.order, self.pending);
        let right = MatRef::from_row_major_slice(&self.right[..self.pending * self.stride], self.pending, self.stride);
        let column = ColMut::from_slice_mut(column).as_mat_mut();
        matmul(column, Accum::Add, left, right.get(.., j..j + 1), -1.0, Par::Seq);
    }

    /// Makes `entering`, whose column of T is `column`, basic in row `r`, and returns the variable that leaves.
    pub(super) fn exchange(&mut self, r: usize, entering: usize, column: &[f64]) -> usize {
        let s = self.column_of(entering);
        let (order, stride, pending) = (self.order, self.stride, self.pending);
        let pivot = column[r];
        let (used, free) = self.right.split_at_mut(pending * stride);
        let row = &mut free[..stride];
        let base_row = &mut self.base[r * stride..(r + 1) * stride];
        row.copy_from_slice(base_row);
        base_row.fill(0.0);
        self.cleared.iter().for_each(|&j| row[j] = 0.0);
        let left = MatRef::from_column_major_slice(&self.left[..pending * order], order, pending).get(r..r + 1, ..);
        let right = MatRef::from_row_major_slice(used, pending, stride);
        matmul(RowMut::from_slice_mut(row).as_mat_mut(), Accum::Add, left, right, -1.0, Par::Seq);
        let reciprocal = pivot.recip();
        row.iter_mut().for_each(|x| *x *= reciprocal);
        row[s] = -reciprocal;

        self.cleared.push(s);
        for k in 0..pending {
            self.left[k * order + r] = 0.0;
            self.right[k * stride + s] = 0.0;
        }
        self.left[pending * order..(pending + 1) * order].copy_from_slice(column);
        self.left[pending * order + r] = 1.0;
        self.pending += 1;

        let step = -self.values[r] / pivot;
        subtract_multiples(&mut self.values, std::iter::once((-step, column)));
        self.values[r] = step;
        self.swap_variables(r, s);
        self.age += 1;
        if self.pending == BLOCK {
            self.flush();
        }
        self.column_variable[s]
    }

    /// The direction of all variables but the artificial one as `entering`, whose column is `column`, grows.
    pub(super) fn direction(&self, entering: usize, column: &[f64]) -> Vec<f64> {
        let least = PIVOT_TOLERANCE * column.iter().fold(1.0_f64, |a, x| a.max(x.abs()));
        let mut direction = vec![0.0; 2 * self.order + 1];
        direction[entering] = 1.0;
        for (&variable, &a) in self.row_variable.iter().zip(column) {
            direction[variable] = if a > least { a } else { 0.0 };
        }
        direction.pop();
        direction
    }

    /// base ← base − U V.
    fn flush(&mut self) {
        let (order, columns, stride) = (self.order, self.columns, self.stride);
        for row in self.base.chunks_exact_mut(stride) {
            self.cleared.iter().for_each(|&j| row[j] = 0.0);
        }
        self.cleared.clear();
        matmul(
            row_major_mut(&mut self.base, order, columns, stride),
            Accum::Add,
            MatRef::from_column_major_slice(&self.left[..self.pending * order], order, self.pending),
            MatRef::from_row_major_slice_with_stride(&self.right, self.pending, columns, stride),
            -1.0,
            parallelism(order),
        );
        self.pending = 0;
    }

    /// Makes column variables `entering` basic in rows `leaving`, pairwise and all at once, by one LU factorization.
    /// False, with the tableau spoilt, if their block of T is singular. Meant for a tableau with no exchange pending.
    pub(super) fn exchange_block(&mut self, leaving: &[usize], entering: &[usize]) -> bool {
        let (order, columns, stride) = (self.order, self.columns, self.stride);
        let count = leaving.len();
        if count == 0 {
            return true;
        }
        let block = Mat::from_fn(count, count, |i, j| self.base[leaving[i] * stride + entering[j]]);
        // The new rows: block⁻¹ [I on the entering columns, −T on the others | −values].
        let mut rows = Mat::from_fn(count, columns + 1, |i, j| {
            -if j == columns { self.values[leaving[i]] } else { self.base[leaving[i] * stride + j] }
        });
        for (k, &s) in entering.iter().enumerate() {
            rows.col_mut(s).fill(0.0);
            rows[(k, s)] = 1.0;
        }
        let Some(factors) = Factors::of(&block) else {
            return false;
        };
        factors.solve_in_place(rows.as_mut());
        if (0..=columns).any(|j| rows.col(j).iter().any(|x| !x.is_finite())) {
            return false;
        }

        let multipliers = Mat::from_fn(order, count, |i, k| self.base[i * stride + entering[k]]);
        for base_row in self.base.chunks_exact_mut(stride) {
            entering.iter().for_each(|&s| base_row[s] = 0.0);
        }
        matmul(
            row_major_mut(&mut self.base, order, columns, stride),
            Accum::Add,
            &multipliers,
            rows.get(.., ..columns),
            1.0,
            parallelism(order),
        );
        for i in 0..order {
            self.values[i] += (0..count).map(|k| multipliers[(i, k)] * rows[(k, columns)]).sum::<f64>();
        }
        for (k, (&r, &s)) in leaving.iter().zip(entering).enumerate() {
            for j in 0..columns {
                self.base[r * stride + j] = rows[(k, j)];
            }
            self.values[r] = rows[(k, columns)];
            self.swap_variables(r, s);
        }
        true
    }

    /// T without the artificial variable's column, row-major; meant for a tableau with no exchange pending.
    pub(super) fn into_matrix_and_values(self) -> (Vec<f64>, Vec<f64>) {
        let rows = self.base.chunks_exact(self.stride);
        (rows.flat_map(|row| &row[..self.order]).copied().collect(), self.values)
    }

    fn swap_variables(&mut self, r: usize, s: usize) {
        std::mem::swap(&mut self.row_variable[r], &mut self.column_variable[s]);
        self.place[self.row_variable[r]] = r;
        self.place[self.column_variable[s]] = self.order + s;
    }
}

/// faer 0.24.4's own `from_row_major_slice_with_stride_mut` takes its stride for that of the columns.
fn row_major_mut(entries: &mut [f64], rows: usize, columns: usize, stride: usize) -> MatMut<'_, f64> {
    MatMut::from_column_major_slice_with_stride_mut(entries, columns, rows, stride).transpose_mut()
}

/// target ← target − Σ factor · source.
fn subtract_multiples<'a>(target: &mut [f64], terms: impl Iterator<Item = (f64, &'a [f64])>) {
    for (factor, source) in terms {
        target.iter_mut().zip(source).for_each(|(t, s)| *t -= factor * s);
    }
}
