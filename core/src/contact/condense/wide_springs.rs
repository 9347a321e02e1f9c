//! Springs over several elements, added to the matrix after it is factored: K̃ = LLᵀ + Rᵀ D R (Woodbury 1950).
//!
//! Summed into K each would couple all dofs of its row with one another. Without them the plate may be free: then pins,
//! springs at single dofs, hold it for the factor, and have D < 0 here.

use super::forward_rows::ForwardRows;
use crate::assembly::{HELD, Numbering};
use crate::cholesky::{Factor, FactorError};
use crate::contact::rigid::rigid_motions;
use crate::contact::scale::Scale;
use crate::contact::tolerances;
use crate::dense::{self, Cholesky, OutOfMemory};
use crate::plate::Plate;
use crate::rows::Springs;
use faer::{Mat, MatMut};

pub(crate) struct WideSprings {
    rows: ForwardRows,
    /// E = D⁻¹ + RL⁻ᵀL⁻¹Rᵀ of the springs, and E⁻¹ times what couples the pins to them.
    springs: Cholesky,
    across: Mat<f64>,
    /// What is left of the pins' part of E with the springs eliminated, with its sign turned: it is negative.
    pins: Cholesky,
}

impl WideSprings {
    /// Of rows, each given by columns of the factor, which ends with the block `trailing`: springs, then pins with negative
    /// stiffness. [`FactorError::NotPositiveDefinite`] where the springs hold the plate less firmly than elimination rounds.
    pub(crate) fn of(
        factor: &Factor,
        trailing: &Mat<f64>,
        rows: &[Vec<(usize, f64)>],
        stiffness: &[f64],
    ) -> Result<Self, FactorError> {
        let lost = FactorError::NotPositiveDefinite { column: factor.len() - 1 };
        let rows = ForwardRows::of(factor, trailing, rows)?;
        let mut all = rows.products(&rows)?;
        stiffness.iter().enumerate().for_each(|(i, stiffness)| all[(i, i)] += 1.0 / stiffness);
        let springs = stiffness.iter().filter(|&&stiffness| stiffness > 0.0).count();
        let pins = stiffness.len() - springs;
        let own = dense::matrix(springs, springs, |i, j| all[(i, j)])?;
        let coupling = dense::matrix(springs, pins, |i, k| all[(i, springs + k)])?;
        let Some(own) = Cholesky::of(own)? else { return Err(lost) };
        let mut across = coupling.clone();
        own.solve_in_place(across.as_mut());
        let mut left = dense::product(coupling.transpose(), across.as_ref())?;
        for i in 0..pins {
            (0..pins).for_each(|k| left[(i, k)] -= all[(springs + i, springs + k)]);
        }
        let flexible = stiffness[springs..].iter().fold(0.0, |most: f64, stiffness| most.max(-1.0 / stiffness));
        let pins = Cholesky::of(left)?.filter(|pins| pins.has_pivots_above(tolerances::WIDE_PIVOT * flexible));
        Ok(Self { rows, springs: own, across, pins: pins.ok_or(lost)? })
    }

    /// A forward-substituted vector, with what the springs take of it taken off.
    pub(crate) fn hold(&self, forward: &mut [f64]) {
        let mut force = self.rows.dot(forward);
        let count = force.len();
        self.solve_in_place(MatMut::from_column_major_slice_mut(&mut force, count, 1));
        force.iter_mut().for_each(|force| *force = -*force);
        self.rows.add(&force, forward);
    }

    /// By what the products of other rows with each other are less than without the springs.
    pub(super) fn held(&self, others: &ForwardRows) -> Result<Mat<f64>, OutOfMemory> {
        let across = self.rows.products(others)?;
        let mut force = across.clone();
        self.solve_in_place(force.as_mut());
        dense::product(across.transpose(), force.as_ref())
    }

    /// Forces of springs and pins, given the motions of their rows without them.
    fn solve_in_place(&self, moved: MatMut<'_, f64>) {
        let (mut springs, mut pins) = moved.split_at_row_mut(self.across.nrows());
        pins -= self.across.transpose() * &springs;
        self.pins.solve_in_place(pins.as_mut());
        pins *= -1.0;
        self.springs.solve_in_place(springs.as_mut());
        springs -= &self.across * &pins;
    }
}

/// Springs at single dofs that hold the motions which held dofs leave free.
pub(crate) fn pins(plate: &Plate, numbering: &Numbering, scale: &Scale) -> Springs {
    let motions = rigid_motions(plate, scale);
    let of_dof = |dof: usize| [0, 1, 2].map(|k| motions[k][dof] * if dof % 3 == 0 { 1.0 } else { scale.size });
    let product = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut known: Vec<[f64; 3]> = Vec::new();
    let mut pins = Springs::default();
    for free in [false, true] {
        let fits = |dof: &usize| (numbering.column[*dof] != HELD) == free && (!free || dof % 3 == 0);
        while known.len() < 3 {
            let rest = |dof: usize| {
                let mut rest = of_dof(dof);
                for earlier in &known {
                    let part = product(&rest, earlier);
                    (0..3).for_each(|k| rest[k] -= part * earlier[k]);
                }
                (dof, rest, product(&rest, &rest).sqrt())
            };
            let farthest = (0..plate.dof_count()).filter(fits).map(rest).max_by(|a, b| a.2.total_cmp(&b.2));
            let Some((dof, rest, size)) = farthest.filter(|found| found.2 > tolerances::LEVER) else { break };
            known.push(rest.map(|value| value / size));
            if free {
                pins.push_at(plate, dof, tolerances::PIN * scale.stiffness);
            }
        }
    }
    pins
}
