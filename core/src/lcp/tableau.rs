//! The condensed tableau of Lemke's algorithm: nonbasic columns only, m × (m + 1) and the values.
//!
//! It is kept as the dictionary `basic = value + T · nonbasic`. An exchange of basic variable r and nonbasic variable s
//! zeroes row r and column s of T and then subtracts one rank-one term. The terms are collected, T = base − U V, and
//! subtracted from the base BLOCK at a time as one matrix product, so that the base is read and written once a block
//! instead of once a pivot; in between, only the columns and rows that a pivot asks for are formed.
use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef};
use rayon::prelude::*;

use super::kernels::{LANES, subtract_multiples};
use super::scaling::CoveredLcp;
use super::tolerances;
use crate::dense::{Lu, OutOfMemory, PARALLEL_ORDER, matrix, parallelism, room, row_major, zeros};

/// Rank-one terms that are collected before the base is touched.
const BLOCK: usize = 32;

/// Variables are numbered: slack i is i, its complement is m + i, the artificial variable is 2m.
pub(super) struct Tableau {
    order: usize,
    /// Columns of the base, and the distance from one row to the next, to which all its vectors are padded.
    columns: usize,
    stride: usize,
    base: Vec<f64>,
    /// U by columns and V by rows, one term after the other.
    left: Vec<f64>,
    right: Vec<f64>,
    /// Columns of the base that count as zero until the pending terms are subtracted, one a term.
    cleared: Vec<usize>,
    pub(super) values: Vec<f64>,
    /// T's column of the variable that enters next.
    pub(super) column: Vec<f64>,
    pub(super) row_variable: Vec<usize>,
    column_variable: Vec<usize>,
    /// Row i as i, column j as m + j.
    place: Vec<usize>,
    /// Exchanges made one by one since the tableau was last computed from the problem itself.
    pub(super) age: usize,
}

impl Tableau {
    /// The tableau whose basis is the slacks: w = q + Mz + d z₀. The artificial variable enters next.
    pub(super) fn new(problem: &CoveredLcp) -> Result<Self, OutOfMemory> {
        let order = problem.order();
        let columns = order + 1;
        // An odd number of cache lines, so that a column's entries do not fall into a few cache sets.
        let stride = (columns.div_ceil(LANES) | 1) * LANES;
        let mut base = zeros(order.checked_mul(stride).ok_or(OutOfMemory)?)?;
        let fill = |(i, row): (usize, &mut [f64])| {
            problem.copy_row(i, &mut row[..order]);
            row[order] = problem.covering[i];
        };
        if order < PARALLEL_ORDER {
            base.chunks_exact_mut(stride).enumerate().for_each(fill);
        } else {
            base.par_chunks_exact_mut(stride).enumerate().for_each(fill);
        }
        let padded = |entries: &[f64]| {
            let mut vector = Vec::with_capacity(stride);
            vector.extend_from_slice(entries);
            vector.resize(stride, 0.0);
            vector
        };
        Ok(Self {
            order,
            columns,
            stride,
            base,
            left: room(BLOCK * stride)?,
            right: room(BLOCK * stride)?,
            cleared: Vec::with_capacity(BLOCK),
            values: padded(&problem.q),
            column: padded(&problem.covering),
            row_variable: (0..order).collect(),
            column_variable: (order..=2 * order).collect(),
            place: (0..=2 * order).collect(),
            age: 0,
        })
    }

    /// The tableau of `problem` at the basis of `self`, computed by a fresh factorization; None if that is singular.
    pub(super) fn recomputed(&self, problem: &CoveredLcp) -> Result<Option<Self>, OutOfMemory> {
        let order = self.order;
        let leaving: Vec<usize> = (0..order).filter(|&i| !self.is_basic(i)).collect();
        let entering: Vec<usize> = (order..=2 * order).filter(|&v| self.is_basic(v)).map(|v| v - order).collect();
        let mut fresh = Self::new(problem)?;
        Ok(fresh.exchange_block(&leaving, &entering)?.then_some(fresh))
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
        let terms = (0..self.cleared.len()).map(|k| self.left[k * self.stride + i] * self.right[k * self.stride + j]);
        let base = if self.cleared.contains(&j) { 0.0 } else { self.base[i * self.stride + j] };
        base - terms.sum::<f64>()
    }

    /// Chooses the nonbasic variable that enters next.
    pub(super) fn choose(&mut self, entering: usize) {
        let j = self.column_of(entering);
        if self.cleared.contains(&j) {
            self.column.fill(0.0);
        } else {
            for (x, row) in self.column.iter_mut().zip(self.base.chunks_exact(self.stride)) {
                *x = row[j];
            }
        }
        let mut factors = [0.0; BLOCK];
        for (factor, row) in factors.iter_mut().zip(self.right.chunks_exact(self.stride)) {
            *factor = row[j];
        }
        subtract_multiples(&mut self.column, &factors, &self.left);
    }

    /// Makes `entering`, the variable of `column`, basic in row `r`, and returns the variable that leaves.
    pub(super) fn exchange(&mut self, r: usize, entering: usize) -> usize {
        if self.cleared.len() == BLOCK {
            self.flush();
        }
        let s = self.column_of(entering);
        let (stride, reciprocal) = (self.stride, self.column[r].recip());
        // Row r, the terms' own row r and column s are zero from now on; the new term restores them.
        let mut factors = [0.0; BLOCK];
        for (factor, column) in factors.iter_mut().zip(self.left.chunks_exact_mut(stride)) {
            *factor = std::mem::take(&mut column[r]);
        }
        let base_row = &mut self.base[r * stride..(r + 1) * stride];
        let from = self.right.len();
        self.right.extend_from_slice(base_row);
        base_row.fill(0.0);
        let (used, row) = self.right.split_at_mut(from);
        self.cleared.iter().for_each(|&j| row[j] = 0.0);
        subtract_multiples(row, &factors, used);
        used.chunks_exact_mut(stride).for_each(|used| used[s] = 0.0);
        row.iter_mut().for_each(|x| *x *= reciprocal);
        row[s] = -reciprocal;
        self.cleared.push(s);

        let step = -self.values[r] * reciprocal;
        subtract_multiples(&mut self.values, &[-step], &self.column);
        self.values[r] = step;
        self.column[r] = 1.0;
        self.left.extend_from_slice(&self.column);
        self.swap_variables(r, s);
        self.age += 1;
        self.column_variable[s]
    }

    /// The direction of all variables but the artificial one as `entering`, the variable of `column`, grows.
    pub(super) fn direction(&self, entering: usize) -> Vec<f64> {
        let least = tolerances::PIVOT * self.column.iter().fold(1.0_f64, |a, x| a.max(x.abs()));
        let mut direction = vec![0.0; 2 * self.order + 1];
        direction[entering] = 1.0;
        for (&variable, &a) in self.row_variable.iter().zip(&self.column) {
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
        matmul(
            row_major_mut(&mut self.base, order, columns, stride),
            Accum::Add,
            MatRef::from_column_major_slice_with_stride(&self.left, order, self.cleared.len(), stride),
            MatRef::from_row_major_slice_with_stride(&self.right, self.cleared.len(), columns, stride),
            -1.0,
            parallelism(order),
        );
        self.cleared.clear();
        self.left.clear();
        self.right.clear();
    }

    /// Makes column variables `entering` basic in rows `leaving`, pairwise and all at once, by one LU factorization.
    /// False, with the tableau spoilt, if their block of T is singular. Meant for a tableau with no exchange pending.
    pub(super) fn exchange_block(&mut self, leaving: &[usize], entering: &[usize]) -> Result<bool, OutOfMemory> {
        let (order, columns, stride) = (self.order, self.columns, self.stride);
        let count = leaving.len();
        if count == 0 {
            return Ok(true);
        }
        let block = matrix(count, count, |i, j| self.base[leaving[i] * stride + entering[j]])?;
        // The new rows: block⁻¹ [I on the entering columns, −T on the others | −values].
        let mut rows = matrix(count, columns + 1, |i, j| {
            -if j == columns { self.values[leaving[i]] } else { self.base[leaving[i] * stride + j] }
        })?;
        for (k, &s) in entering.iter().enumerate() {
            rows.col_mut(s).fill(0.0);
            rows[(k, s)] = 1.0;
        }
        let factors = Lu::of(block)?;
        if !factors.has_pivots_above(tolerances::PIVOT) {
            return Ok(false);
        }
        factors.solve_in_place(rows.as_mut())?;
        if (0..=columns).any(|j| rows.col(j).iter().any(|x| !x.is_finite())) {
            return Ok(false);
        }

        let multipliers = matrix(order, count, |i, k| self.base[i * stride + entering[k]])?;
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
        Ok(true)
    }

    /// True where slack and complement have changed places.
    pub(super) fn complementary_basis(&self) -> Vec<bool> {
        (0..self.order).map(|slack| !self.is_basic(slack)).collect()
    }

    /// T without the artificial variable's column, row-major, that column, and the values; meant for a tableau with no
    /// exchange pending.
    pub(super) fn into_parts(mut self) -> Result<Parts, OutOfMemory> {
        self.values.truncate(self.order);
        let entry = |i: usize, j: usize| self.base[i * self.stride + j];
        let matrix = row_major(self.order, self.order, entry)?;
        let covering = (0..self.order).map(|i| entry(i, self.order)).collect();
        Ok(Parts { matrix, covering, q: self.values })
    }

    fn swap_variables(&mut self, r: usize, s: usize) {
        std::mem::swap(&mut self.row_variable[r], &mut self.column_variable[s]);
        self.place[self.row_variable[r]] = r;
        self.place[self.column_variable[s]] = self.order + s;
    }
}

/// A problem as its tableau reads it.
pub(super) struct Parts {
    pub(super) matrix: Vec<f64>,
    pub(super) covering: Vec<f64>,
    pub(super) q: Vec<f64>,
}

/// faer 0.24.4's own `from_row_major_slice_with_stride_mut` takes its stride for that of the columns.
fn row_major_mut(entries: &mut [f64], rows: usize, columns: usize, stride: usize) -> MatMut<'_, f64> {
    MatMut::from_column_major_slice_with_stride_mut(entries, columns, rows, stride).transpose_mut()
}
