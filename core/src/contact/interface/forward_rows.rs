//! Rows of G after forward substitution with the factor of K̃ = K + Gᵀ diag(δ) G. Their scalar products are the entries
//! of P̃ = GK̃⁻¹Gᵀ.
//!
//! Narrow rows have dofs of one element only; these dofs are the last columns of the factor. Wide rows connect two
//! plates or average over a footprint; their dofs would be hundreds of last columns. A wide row is therefore forward
//! substituted through the whole factor, and has entries only at the ancestors of its dofs in the elimination tree. The
//! factor is L S Lᵀ with sign −1 at multiplier columns; a row g is stored as SL⁻¹gᵀ.

use crate::cholesky::{Factor, FactorError, LANES};
use crate::contact::scale::dot;
use crate::dense::{self, OutOfMemory};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::{Mat, Par};
use rayon::prelude::*;
use std::collections::HashSet;

pub(super) struct ForwardRows {
    /// Number of columns of the factor before its trailing block.
    first: usize,
    /// Entries of each row in the trailing block; column i belongs to row i of G.
    last: Mat<f64>,
    /// Nonzero entries of wide rows in the columns before the trailing block.
    wide: Vec<Wide>,
}

struct Wide {
    row: usize,
    /// Each entry is (column of the factor, value, sign of the column times value).
    entries: Vec<(usize, f64, f64)>,
}

impl ForwardRows {
    /// Forward substitutes `rows` of G, which are indexed by column of the factor. `trailing` is the trailing block of
    /// the factor.
    pub(super) fn of(
        factor: &Factor,
        trailing: &Mat<f64>,
        rows: &[Vec<(usize, f64)>],
        multiplier_rows: &HashSet<usize>,
    ) -> Result<Self, FactorError> {
        let first = factor.len() - trailing.nrows();
        let is_wide = |row: &[(usize, f64)]| row.iter().any(|&(column, _)| column < first);
        let narrow: Vec<_> = rows.iter().map(|row| if is_wide(row) { Vec::new() } else { row.clone() }).collect();
        let mut all = Self::narrow(first, trailing, &narrow)?;
        let wide: Vec<usize> = (0..rows.len()).filter(|&row| is_wide(&rows[row])).collect();
        for some in wide.chunks(LANES) {
            let mut block = dense::zeros(some.len() * factor.len())?;
            for (&row, vector) in some.iter().zip(block.chunks_exact_mut(factor.len())) {
                rows[row].iter().for_each(|&(column, value)| vector[column] += value);
            }
            factor.forward(&mut block)?;
            for (&row, vector) in some.iter().zip(block.chunks_exact(factor.len())) {
                let (before, last) = vector.split_at(first);
                last.iter().enumerate().for_each(|(at, &value)| all.last[(at, row)] = value);
                let signed = |(at, &value): (usize, &f64)| {
                    (at, value, if multiplier_rows.contains(&at) { -value } else { value })
                };
                let entries = before.iter().enumerate().filter(|(_, value)| **value != 0.0).map(signed).collect();
                all.wide.push(Wide { row, entries });
            }
        }
        Ok(all)
    }

    /// Forward substitutes rows of G that have entries only in the trailing block. `first` is the number of columns
    /// before this block.
    pub(super) fn narrow(first: usize, trailing: &Mat<f64>, rows: &[Vec<(usize, f64)>]) -> Result<Self, OutOfMemory> {
        let mut last = dense::matrix(trailing.nrows(), rows.len(), |_, _| 0.0)?;
        for (row, entries) in rows.iter().enumerate() {
            entries.iter().for_each(|&(column, value)| last[(column - first, row)] += value);
        }
        solve_lower_triangular_in_place(trailing.as_ref(), last.as_mut(), Par::rayon(0));
        Ok(Self { first, last, wide: Vec::new() })
    }

    /// Products (m,) of the rows with a forward substituted load: the displacements of the contact points under this
    /// load.
    pub(super) fn dot(&self, forward: &[f64]) -> Vec<f64> {
        let (before, last) = forward.split_at(self.first);
        let mut out: Vec<f64> = (0..self.last.ncols()).map(|row| dot(self.of_last(row), last)).collect();
        for Wide { row, entries } in &self.wide {
            out[*row] += entries.iter().map(|&(column, _, signed)| signed * before[column]).sum::<f64>();
        }
        out
    }

    /// Adds the effect of the forces `force` (m,) on the contact points to a forward substituted load.
    pub(super) fn add(&self, force: &[f64], forward: &mut [f64]) {
        let (before, last) = forward.split_at_mut(self.first);
        for (row, &force) in force.iter().enumerate().filter(|(_, force)| **force != 0.0) {
            last.iter_mut().zip(self.of_last(row)).for_each(|(total, value)| *total += force * value);
        }
        for Wide { row, entries } in &self.wide {
            entries.iter().for_each(|&(column, value, _)| before[column] += force[*row] * value);
        }
    }

    /// Scalar products (m, k) of these m rows with the k rows of `others`.
    pub(super) fn products(&self, others: &Self) -> Result<Mat<f64>, OutOfMemory> {
        let mut products = dense::product(self.last.transpose(), others.last.as_ref())?;
        let of_wide = |other: &Wide| -> Vec<f64> {
            let mut spread = vec![0.0; self.first];
            other.entries.iter().for_each(|&(column, value, _)| spread[column] = value);
            let own = |own: &Wide| own.entries.iter().map(|&(column, _, signed)| signed * spread[column]).sum();
            self.wide.iter().map(own).collect()
        };
        let made: Vec<Vec<f64>> = others.wide.par_iter().map(of_wide).collect();
        for (other, made) in others.wide.iter().zip(made) {
            self.wide.iter().zip(made).for_each(|(own, value)| products[(own.row, other.row)] += value);
        }
        Ok(products)
    }

    fn of_last(&self, row: usize) -> &[f64] {
        self.last.col(row).try_as_col_major().expect("each column is contiguous").as_slice()
    }
}
