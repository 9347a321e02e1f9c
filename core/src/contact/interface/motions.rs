//! Free rigid motions in the LCP. They are imposed on M and q exactly, since elimination leaves a rounding error.
//!
//! Let N be the displacements of the points under the free motions, J the rows whose z is a gap, and O the rows whose z
//! is a reaction. A motion z_J = N_J changes every gap and no reaction: M_JJ N_J = 0 and M_OJ N_J = N_O. The reactions
//! on the first pieces balance the load: N_Jᵀq_J plus the work of the reactions at z = w = 0 is the work of the load.
//! With rounding in these equations, marginal equilibrium would be decided at random.

use super::condensed::{CondensedRhs, Interface};
use super::vertices::Vertices;
use crate::contact::points::Points;
use crate::contact::scale::largest;
use crate::contact::tolerances;
use crate::dense::{self, OutOfMemory};
use faer::linalg::matmul::matmul;
use faer::linalg::solvers::Solve;
use faer::{Accum, Mat, MatRef};

/// Work of a load in each free rigid motion (`sum`), and the sum of the magnitudes of the terms of this work (`size`).
/// Internal forces do no work in a rigid motion.
#[derive(Clone, Debug, Default)]
pub struct Work {
    pub sum: Vec<f64>,
    pub size: Vec<f64>,
}

impl Work {
    pub(in crate::contact) fn of(motions: &[Vec<f64>], load: &[f64]) -> Self {
        let of = |motion: &Vec<f64>| {
            let terms = motion.iter().zip(load).map(|(u, f)| u * f);
            (terms.clone().sum::<f64>(), terms.map(f64::abs).sum::<f64>())
        };
        let (sum, size) = motions.iter().map(of).unzip();
        Self { sum, size }
    }
}

/// Data for imposing the free rigid motions on M and q; they do not depend on the load.
pub(super) struct FreeMotions {
    /// `moves` is N_J, the displacements under the free rigid motions at the LCP rows J whose z is a gap. `dual` is
    /// WN_J(N_JᵀWN_J)⁻¹ with W = diag(δ), δ the stiffnesses of the points in the factor, or W = I if δ = 0 for some row
    /// of J.
    moves: Mat<f64>,
    dual: Mat<f64>,
    /// Contact point of each LCP row whose z is a gap (rows J), then of each row whose z is a reaction (rows O).
    paired: Vec<usize>,
    /// Work, in each free rigid motion, of the reactions that the points have at z = w = 0 in the LCP.
    known: Vec<f64>,
    /// Σ_c |M_rc| for each LCP row r whose z is a gap, over the columns c whose z is a gap, before the free rigid
    /// motions are imposed on M.
    held: Vec<f64>,
    /// Whether M_JJ, the block of M for rows whose z is a gap, is projected off the free rigid motions. If M is the
    /// Schur complement S, it is not: without projection S keeps more digits of its soft modes.
    projected: bool,
    /// For each point the first piece of whose law is between two horizontal pieces: (row of the upper end, row of the
    /// lower end, length of the piece). These two rows of M differ only in sign.
    mirrored: Vec<(usize, usize, f64)>,
}

impl Interface {
    /// Imposes the free rigid motions on M, with N, J, O as defined at the top of this file: M_JJ ← QM_JJQᵀ with Q = I
    /// − WN_J(N_JᵀWN_J)⁻¹N_Jᵀ. M_OJ gets the least change for which M_OJ N_J = N_O.
    pub(super) fn impose_motions(
        &self,
        points: &Points,
        vertices: &Vertices,
        matrix: &mut [f64],
    ) -> Result<FreeMotions, OutOfMemory> {
        let free = self.moves.ncols();
        let rows = &vertices.rows;
        let order = rows.len();
        let (inside, paired) = (vertices.gaps(), vertices.paired());
        let moves = |r: usize, k: usize| self.moves[(rows[r].point, k)];
        let n = Mat::from_fn(inside, free, moves);
        let sum = |r: usize| matrix[r * order..r * order + inside].iter().map(|m| m.abs()).sum();
        let held = (0..inside).map(sum).collect();
        let projected = paired > inside || self.stiffness.is_none();
        let reference = vertices.reference_forces(points);
        let known = (0..free).map(|k| (0..self.len()).map(|i| self.moves[(i, k)] * reference[i]).sum()).collect();
        let mirrored = vertices.mirrored(points);
        let of_rows = rows[..paired].iter().map(|row| row.point).collect();
        let mut motions = FreeMotions { dual: n.clone(), moves: n, paired: of_rows, known, held, projected, mirrored };
        if free == 0 {
            return Ok(motions);
        }
        // The projection has as weights the stiffnesses δ of the points in the factor, so that the correction of an
        // entry at a soft point is not larger than the entry.
        let carried = |r: usize| self.delta[rows[r].point];
        let all_carried = (0..inside).all(|r| carried(r) > 0.0);
        let weight = |r: usize| if all_carried { carried(r) } else { 1.0 };
        let n = &motions.moves;
        let weighted = Mat::from_fn(inside, free, |r, k| weight(r) * n[(r, k)]);
        let gram = n.transpose() * &weighted;
        motions.dual = gram.partial_piv_lu().solve(weighted.transpose()).transpose().to_owned();
        if !projected {
            return Ok(motions);
        }
        let (n, dual) = (&motions.moves, &motions.dual);
        let mut within = dense::matrix(inside, inside, |r, c| matrix[r * order + c])?;
        let before: Vec<f64> = (0..inside).map(|r| within[(r, r)].abs()).collect();
        let across = n.transpose() * &within;
        subtract_product(&mut within, dual, across.as_ref());
        let along = &within * n;
        subtract_product(&mut within, &along, dual.transpose());
        // If the projection reduces a diagonal entry of M to rounding, its row and column count as zero.
        let loose: Vec<bool> = (0..inside)
            .map(|r| inside == free || within[(r, r)] <= tolerances::interface::PROJECTED * before[r])
            .collect();
        let outside = paired - inside;
        let mut across = dense::matrix(outside, inside, |r, c| matrix[(inside + r) * order + c])?;
        let moved = Mat::from_fn(outside, free, |r, k| moves(inside + r, k));
        let missed = &across * n - &moved;
        subtract_product(&mut across, &missed, dual.transpose());
        for r in 0..outside {
            for c in 0..inside {
                let size: f64 = (0..free).map(|k| (moved[(r, k)] * dual[(c, k)]).abs()).sum();
                if across[(r, c)].abs() <= tolerances::interface::POSED * size {
                    across[(r, c)] = 0.0;
                }
            }
        }
        for r in 0..inside {
            for c in 0..inside {
                let even = 0.5 * (within[(r, c)] + within[(c, r)]);
                matrix[r * order + c] = if loose[r] || loose[c] { 0.0 } else { even };
            }
            for c in 0..outside {
                matrix[(inside + c) * order + r] = across[(c, r)];
                matrix[r * order + inside + c] = -across[(c, r)];
            }
        }
        for &(row, earlier, _) in &motions.mirrored {
            (0..order).for_each(|c| matrix[row * order + c] = -matrix[earlier * order + c]);
            // Only LCP rows at an end of the first piece of a law depend on the unknown x (force or travel) of their
            // point. Rows of further vertices depend on z of the vertex before them.
            for r in (0..order).filter(|&r| rows[r].is_next()) {
                matrix[r * order + row] = -matrix[r * order + earlier];
            }
        }
        Ok(motions)
    }

    /// Displacements `travel` (m,) of the points minus the nearest free rigid motion in least squares. A free motion
    /// causes no reactions.
    pub(super) fn without_rigid_motion(&self, travel: &[f64]) -> Vec<f64> {
        let n = &self.moves;
        if n.ncols() == 0 {
            return travel.to_vec();
        }
        let column = Mat::from_fn(travel.len(), 1, |i, _| travel[i]);
        let motion = (n.transpose() * n).partial_piv_lu().solve(n.transpose() * &column);
        let rest = column - n * motion;
        (0..travel.len()).map(|i| rest[(i, 0)]).collect()
    }
}

impl FreeMotions {
    /// Changes q so that the reactions on the first pieces of the laws balance the load in the free rigid motions.
    /// Entries that are only rounding become zero.
    pub(super) fn balance(&self, q: &mut [f64], right: &CondensedRhs, work: &Work) {
        self.balance_past(q, right, work, &self.known, 1.0);
    }

    /// Changes the increment of q so that the increments of reaction balance the increment of load in the free rigid
    /// motions.
    pub(super) fn balance_increment(&self, q: &mut [f64], right: &CondensedRhs, work: &Work) {
        self.balance_past(q, right, work, &vec![0.0; self.known.len()], 0.0);
    }

    fn balance_past(&self, q: &mut [f64], right: &CondensedRhs, work: &Work, known: &[f64], lengths: f64) {
        let (inside, free) = (self.moves.nrows(), self.moves.ncols());
        let moved = largest(&right.displacement);
        let length = moved.max(largest(&right.violation));
        for (gap, &point) in q[inside..self.paired.len()].iter_mut().zip(&self.paired[inside..]) {
            // A large gap of one point changes the tolerance for a zero gap at this point only.
            if gap.abs() <= tolerances::interface::POSED * moved.max(right.violation[point].abs()) {
                *gap = 0.0;
            }
        }
        if free == 0 {
            return;
        }
        let done = |k: usize| known[k] + (0..inside).map(|r| self.moves[(r, k)] * q[r]).sum::<f64>();
        let missing: Vec<f64> = (0..free).map(|k| work.sum[k] - done(k)).collect();
        for r in 0..inside {
            if self.projected {
                q[r] += (0..free).map(|k| self.dual[(r, k)] * missing[k]).sum::<f64>();
            }
            let size: f64 = (0..free).map(|k| self.dual[(r, k)].abs() * work.size[k]).sum();
            let rounding =
                tolerances::interface::POSED * size + tolerances::interface::POSED_SUM * self.held[r] * length;
            if q[r].abs() <= rounding {
                q[r] = 0.0;
            }
        }
        for &(row, earlier, length) in &self.mirrored {
            q[row] = lengths * length - q[earlier];
        }
    }
}

/// from ← from − left · right, where `right` has only a few rows.
fn subtract_product(from: &mut Mat<f64>, left: &Mat<f64>, right: MatRef<'_, f64>) {
    let parallelism = dense::parallelism(from.nrows());
    matmul(from.as_mut(), Accum::Add, left, right, -1.0, parallelism);
}
