//! The condensed tableau of Lemke's algorithm: m × (m + 1) entries of the nonbasic columns, and the m values of the
//! basic variables.
//!
//! The tableau is the dictionary `basic = value + T · nonbasic`. An exchange of the basic variable in row r and the
//! nonbasic variable in column s sets row r and column s of T to zero and subtracts a rank-one term. The terms are
//! collected, T = base − U V, and subtracted from the base in blocks, by one matrix product. Until then only the
//! columns of T that pivots need are computed. Each row of V is a row of the base minus the earlier terms, so V = L⁻¹ ×
//! rows of the base. L is unit lower triangular and contains the entries of U in the exchanged rows.
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::solve_unit_lower_triangular_in_place;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use super::kernels::{LANES, subtract_multiples};
use super::scaling::CoveredLcp;
use super::tolerances;
use crate::dense::{Lu, OutOfMemory, PARALLEL_ORDER, matrix, parallelism, room, zeros};
use crate::vectorized::vectorized;

/// T = base − U V is updated when m/8 rank-one terms are collected, but at least `LEAST` and at most `MOST` terms. With
/// fewer terms, memory access to the base limits the speed of the product U V. With more terms, computing single
/// columns of T takes longer than the product.
const LEAST: usize = 40;
const MOST: usize = 128;

/// Number of columns of the tableau that a thread updates together.
const TOGETHER: usize = 128;

/// A rank-one term: row and column of an exchange after the last update of the base.
struct Term {
    row: usize,
    column: usize,
    /// Whether this is the first collected term with this row. For later terms with this row, the row of the base
    /// counts as zero.
    first: bool,
}

/// The tableau T = base − U V. Variables are numbered: slack i has the number i, its complement m + i, the artificial
/// variable 2m.
pub(super) struct Tableau<'a> {
    problem: &'a CoveredLcp<'a>,
    order: usize,
    /// Length of a column of the tableau, padded with zeros.
    stride: usize,
    block: usize,
    /// The base of T = base − U V, column-major. The list is empty as long as the base equals M′ and the covering
    /// vector.
    base: Vec<f64>,
    terms: Vec<Term>,
    /// The matrix U of T = base − U V, column-major. Each column of U is zero in the rows of later terms.
    left: Vec<f64>,
    /// The matrix L of V = L⁻¹ × rows of the base, column-major, with columns of length `block`.
    lower: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// Column of T that belongs to the entering variable.
    pub(super) column: Vec<f64>,
    pub(super) row_variable: Vec<usize>,
    column_variable: Vec<usize>,
    /// Position of each variable: i if it is basic in row i, m + j if it is nonbasic in column j.
    place: Vec<usize>,
    /// Number of single exchanges since the tableau was last computed from the problem by a factorization.
    pub(super) age: usize,
}

impl<'a> Tableau<'a> {
    /// Makes the tableau of the slack basis, w = q + Mz + d z₀, in which the artificial variable enters next.
    pub(super) fn new(problem: &'a CoveredLcp) -> Result<Self, OutOfMemory> {
        let order = problem.order();
        // The column length is an odd number of cache lines. Otherwise the entries of a row would be mapped to a few
        // cache sets.
        let stride = (order.div_ceil(LANES) | 1) * LANES;
        let block = (order / 8).clamp(LEAST, MOST);
        let padded = |entries: &[f64]| {
            let mut vector = Vec::with_capacity(stride);
            vector.extend_from_slice(entries);
            vector.resize(stride, 0.0);
            vector
        };
        Ok(Self {
            problem,
            order,
            stride,
            block,
            base: Vec::new(),
            terms: Vec::with_capacity(block),
            left: room(block * stride)?,
            lower: vec![0.0; block * block],
            values: padded(&problem.q),
            column: padded(&problem.covering),
            row_variable: (0..order).collect(),
            column_variable: (order..=2 * order).collect(),
            place: (0..=2 * order).collect(),
            age: 0,
        })
    }

    /// The tableau of the current basis, recomputed by a factorization; `None` if the basis is singular.
    pub(super) fn recomputed(&self) -> Result<Option<Self>, OutOfMemory> {
        let order = self.order;
        let leaving: Vec<usize> = (0..order).filter(|&i| !self.is_basic(i)).collect();
        let entering: Vec<usize> = (order..=2 * order).filter(|&v| self.is_basic(v)).map(|v| v - order).collect();
        let mut fresh = Self::new(self.problem)?;
        Ok(fresh.exchange_block(&leaving, &entering)?.then_some(fresh))
    }

    pub(super) fn order(&self) -> usize {
        self.order
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

    /// The row in which a variable is basic; `None` if the variable is nonbasic.
    pub(super) fn row_of(&self, variable: usize) -> Option<usize> {
        Some(self.place[variable]).filter(|&place| place < self.order)
    }

    /// The column of the tableau that belongs to a nonbasic variable.
    fn column_of(&self, variable: usize) -> usize {
        self.place[variable] - self.order
    }

    /// Entry (i, j) of the base, which is T without the collected rank-one terms.
    fn base_entry(&self, i: usize, j: usize) -> f64 {
        match self.base.get(j * self.stride + i) {
            Some(&entry) => entry,
            None if j < self.order => self.problem.entry(i, j),
            None => self.problem.covering[i],
        }
    }

    /// Column j of V in T = base − U V, and whether a term has replaced column j of the base. `rows` has the entries of
    /// column j of the base in the rows of the terms.
    fn factors(&self, j: usize, rows: impl Iterator<Item = f64>) -> ([f64; MOST], bool) {
        let mut factors = [0.0; MOST];
        let count = self.terms.len();
        let last = self.terms.iter().rposition(|term| term.column == j);
        match last {
            Some(last) => factors[last] = -1.0,
            None => factors.iter_mut().zip(rows).for_each(|(factor, row)| *factor = row),
        }
        vectorized(
            #[inline(always)]
            || {
                for (k, lower) in self.lower.chunks_exact(self.block).take(count).enumerate() {
                    let (known, rest) = factors[..count].split_at_mut(k + 1);
                    rest.iter_mut().zip(&lower[k + 1..]).for_each(|(rest, l)| *rest -= l * known[k]);
                }
            },
        );
        (factors, last.is_some())
    }

    /// Entries of T in the rows `rows` of the column that belongs to a nonbasic variable.
    pub(super) fn entries(&self, rows: &[usize], nonbasic: usize) -> Vec<f64> {
        let j = self.column_of(nonbasic);
        let of_terms = self.terms.iter().map(|term| if term.first { self.base_entry(term.row, j) } else { 0.0 });
        let (factors, cleared) = self.factors(j, of_terms);
        let entry = |&i: &usize| {
            let terms = self.left.chunks_exact(self.stride).zip(&factors).map(|(left, factor)| left[i] * factor);
            let zero = cleared || self.terms.iter().any(|term| term.row == i);
            let base = if zero { 0.0 } else { self.base_entry(i, j) };
            base - terms.sum::<f64>()
        };
        rows.iter().map(entry).collect()
    }

    /// Sets the nonbasic variable that enters the basis next, and computes its column of T.
    pub(super) fn choose(&mut self, entering: usize) {
        let j = self.column_of(entering);
        let mut column = std::mem::take(&mut self.column);
        match self.base.get(j * self.stride..(j + 1) * self.stride) {
            Some(base) => column.copy_from_slice(base),
            None => self.problem.copy_column(j, &mut column),
        }
        let (factors, cleared) = self.factors(j, self.terms.iter().map(|term| std::mem::take(&mut column[term.row])));
        if cleared {
            column.fill(0.0);
        }
        subtract_multiples(&mut column, &factors, &self.left);
        self.column = column;
    }

    /// Makes `entering` basic in row `r`; `self.column` must be its column. Returns the variable that leaves the basis.
    pub(super) fn exchange(&mut self, r: usize, entering: usize) -> Result<usize, OutOfMemory> {
        if self.terms.len() == self.block {
            self.flush()?;
        }
        let (s, k, reciprocal) = (self.column_of(entering), self.terms.len(), self.column[r].recip());
        // Row r of T, row r of U, and column s of T are zero from now on, since the new term contains their entries.
        for (l, column) in self.left.chunks_exact_mut(self.stride).enumerate() {
            self.lower[l * self.block + k] = std::mem::take(&mut column[r]);
        }
        self.terms.push(Term { row: r, column: s, first: self.terms.iter().all(|term| term.row != r) });

        let step = -self.values[r] * reciprocal;
        subtract_multiples(&mut self.values, &[-step], &self.column);
        self.values[r] = step;
        self.column[r] = 1.0;
        self.left.extend_from_slice(&self.column);
        self.left[k * self.stride..].iter_mut().for_each(|a| *a *= reciprocal);
        self.swap_variables(r, s);
        self.age += 1;
        Ok(self.column_variable[s])
    }

    /// Derivatives (2m,) of all variables except the artificial variable with respect to `entering`, the variable of
    /// `self.column`.
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

    /// Subtracts the collected rank-one terms from the base, base ← base − U V, and clears them.
    fn flush(&mut self) -> Result<(), OutOfMemory> {
        let (order, stride, count) = (self.order, self.stride, self.terms.len());
        self.fill_base()?;
        let mut right = zeros(count * (order + 1))?;
        for (column, rows) in self.base.chunks_exact_mut(stride).zip(right.chunks_exact_mut(count)) {
            rows.iter_mut().zip(&self.terms).for_each(|(entry, term)| *entry = std::mem::take(&mut column[term.row]));
        }
        for (k, &Term { column: j, .. }) in self.terms.iter().enumerate() {
            self.base[j * stride..][..stride].fill(0.0);
            right[j * count..][..count].fill(0.0);
            right[j * count + k] = -1.0;
        }
        let lower = MatRef::from_column_major_slice_with_stride(&self.lower, count, count, self.block);
        let left = MatRef::from_column_major_slice_with_stride(&self.left, order, count, stride);
        let update = |(base, right): (&mut [f64], &mut [f64])| {
            let columns = base.len() / stride;
            let base = MatMut::from_column_major_slice_with_stride_mut(base, order, columns, stride);
            let mut right = MatMut::from_column_major_slice_mut(right, count, columns);
            solve_unit_lower_triangular_in_place(lower, right.as_mut(), Par::Seq);
            matmul(base, Accum::Add, left, right, -1.0, Par::Seq);
        };
        if order < PARALLEL_ORDER {
            update((&mut self.base, &mut right));
        } else {
            self.base.par_chunks_mut(TOGETHER * stride).zip(right.par_chunks_mut(TOGETHER * count)).for_each(update);
        }
        self.terms.clear();
        self.left.clear();
        Ok(())
    }

    /// Fills the base with M′ and the covering vector if the base is empty.
    fn fill_base(&mut self) -> Result<(), OutOfMemory> {
        let (problem, order, stride) = (self.problem, self.order, self.stride);
        if !self.base.is_empty() || order == 0 {
            return Ok(());
        }
        self.base = zeros((order + 1).checked_mul(stride).ok_or(OutOfMemory)?)?;
        // Fills together as many columns as a cache line of M has entries.
        let fill = |(block, columns): (usize, &mut [f64])| {
            let first = block * LANES;
            for (i, row) in problem.matrix.chunks_exact(order).enumerate() {
                let entries = row[first..].iter().zip(&problem.units[first..]);
                for (column, (entry, unit)) in columns.chunks_exact_mut(stride).zip(entries) {
                    column[i] = entry * problem.units[i] * unit;
                }
            }
            if let Some(column) = columns.chunks_exact_mut(stride).nth(order - first) {
                column[..order].copy_from_slice(&problem.covering);
            }
        };
        if order < PARALLEL_ORDER {
            self.base.chunks_mut(LANES * stride).enumerate().for_each(fill);
        } else {
            self.base.par_chunks_mut(LANES * stride).enumerate().for_each(fill);
        }
        Ok(())
    }

    /// Makes the variables in the columns `entering` basic in the rows `leaving`, pair by pair, by one LU
    /// factorization. Returns false, with an unusable tableau, if the block of T in these rows and columns is singular.
    /// The tableau must have no pending terms.
    pub(super) fn exchange_block(&mut self, leaving: &[usize], entering: &[usize]) -> Result<bool, OutOfMemory> {
        let (order, columns, stride) = (self.order, self.order + 1, self.stride);
        let count = leaving.len();
        self.fill_base()?;
        if count == 0 {
            return Ok(true);
        }
        let block = matrix(count, count, |i, j| self.base_entry(leaving[i], entering[j]))?;
        // New rows of the tableau: block⁻¹ [I in the entering columns, −T in the other columns | −values].
        let mut rows = matrix(count, columns + 1, |i, j| {
            -if j == columns { self.values[leaving[i]] } else { self.base_entry(leaving[i], j) }
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

        let multipliers = matrix(order, count, |i, k| self.base_entry(i, entering[k]))?;
        entering.iter().for_each(|&s| self.base[s * stride..][..stride].fill(0.0));
        matmul(
            MatMut::from_column_major_slice_with_stride_mut(&mut self.base, order, columns, stride),
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
                self.base[j * stride + r] = rows[(k, j)];
            }
            self.values[r] = rows[(k, columns)];
            self.swap_variables(r, s);
        }
        Ok(true)
    }

    /// For each pair (m,), true if its slack is nonbasic.
    pub(super) fn complementary_basis(&self) -> Vec<bool> {
        (0..self.order).map(|slack| !self.is_basic(slack)).collect()
    }

    /// The problem transformed to the current basis: T without the artificial variable's column (row-major), the
    /// artificial variable's column as covering vector, and the values as q. The call must directly follow
    /// [`Self::exchange_block`].
    pub(super) fn into_parts(mut self) -> Result<Parts, OutOfMemory> {
        let (order, stride) = (self.order, self.stride);
        self.values.truncate(order);
        let mut matrix = zeros(order * order)?;
        for (block, rows) in matrix.chunks_mut((LANES * order).max(1)).enumerate() {
            for (j, column) in self.base.chunks_exact(stride).take(order).enumerate() {
                for (row, entry) in rows.chunks_exact_mut(order).zip(&column[block * LANES..]) {
                    row[j] = *entry;
                }
            }
        }
        let covering = self.base[order * stride..][..order].to_vec();
        Ok(Parts { matrix, covering, q: self.values })
    }

    fn swap_variables(&mut self, r: usize, s: usize) {
        std::mem::swap(&mut self.row_variable[r], &mut self.column_variable[s]);
        self.place[self.row_variable[r]] = r;
        self.place[self.column_variable[s]] = self.order + s;
    }
}

/// Matrix (row-major), covering vector and q of a problem transformed to another basis.
pub(super) struct Parts {
    pub(super) matrix: Vec<f64>,
    pub(super) covering: Vec<f64>,
    pub(super) q: Vec<f64>,
}
