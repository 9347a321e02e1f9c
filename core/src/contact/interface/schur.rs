//! The Schur complement S of K on the contact dofs, for rows of G that each select a single dof.

use super::forward_rows::ForwardRows;
use crate::dense::{self, OutOfMemory};
use faer::Mat;

pub(super) struct Schur {
    /// The Schur complement S (m, m); row i and column i belong to contact point i.
    pub(super) matrix: Mat<f64>,
    /// `leading` is the number of columns of the factor before the trailing block L. `rows` has, for each contact
    /// point, the column of its dof in L and its coefficient.
    leading: usize,
    trailing: Mat<f64>,
    rows: Vec<(usize, f64)>,
}

impl Schur {
    pub(super) fn of(
        columns: usize,
        trailing: Mat<f64>,
        rows: &[Vec<(usize, f64)>],
        regularization: &[f64],
    ) -> Result<Self, OutOfMemory> {
        let leading = columns - trailing.nrows();
        let rows: Vec<(usize, f64)> = rows.iter().map(|row| (row[0].0 - leading, row[0].1)).collect();
        let product = dense::product(trailing.as_ref(), trailing.transpose())?;
        let matrix = dense::matrix(rows.len(), rows.len(), |i, j| {
            let ((p, a), (q, b)) = (rows[i], rows[j]);
            let carried = if i == j { regularization[i] } else { 0.0 };
            0.5 * (product[(p, q)] + product[(q, p)]) / (a * b) - carried
        })?;
        Ok(Self { matrix, leading, trailing, rows })
    }

    /// Forces f̂ = Lz (m,) on the contact points, with z the part of a forward substituted right-hand side in the
    /// trailing block.
    pub(super) fn condensed_force(&self, forward: &[f64]) -> Vec<f64> {
        let last = &forward[self.leading..];
        let on_dof = |i: usize| (0..=i).map(|j| self.trailing[(i, j)] * last[j]).sum::<f64>();
        self.rows.iter().map(|&(dof, coefficient)| on_dof(dof) / coefficient).collect()
    }

    /// Reactions f̂ − S y (m,) of the points, with f̂ = `force` and the displacements y = `moved`.
    pub(super) fn holding_forces(&self, force: &[f64], moved: &[f64]) -> Vec<f64> {
        let of_motion = |i: usize| (0..moved.len()).map(|j| self.matrix[(i, j)] * moved[j]).sum::<f64>();
        force.iter().enumerate().map(|(i, f)| f - of_motion(i)).collect()
    }

    /// Prescribes the displacements `moved` (m,) of the points in a forward substituted load. Its part in the trailing
    /// block becomes z = Lᵀu, with u the displacements of the contact dofs.
    pub(super) fn prescribe(&self, moved: &[f64], forward: &mut [f64]) {
        let size = self.trailing.nrows();
        let mut on_dofs = vec![0.0; size];
        for ((dof, coefficient), y) in self.rows.iter().zip(moved) {
            on_dofs[*dof] = y / coefficient;
        }
        for (i, value) in forward[self.leading..].iter_mut().enumerate() {
            *value = (i..size).map(|j| self.trailing[(j, i)] * on_dofs[j]).sum();
        }
    }

    /// The rows of G after forward substitution with the trailing block.
    pub(super) fn forward_rows(&self) -> Result<ForwardRows, OutOfMemory> {
        let rows: Vec<_> =
            self.rows.iter().map(|&(dof, coefficient)| vec![(self.leading + dof, coefficient)]).collect();
        ForwardRows::narrow(self.leading, &self.trailing, &rows)
    }
}
