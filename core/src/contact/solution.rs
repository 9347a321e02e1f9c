//! The solution of a contact problem, and the progress of a solve.

use super::error::SolveError;
use super::points::{PointState, Points};
use super::system::System;
use crate::displacement::Displacement;
use std::sync::Arc;

/// Progress of a solve after one step, for the callback.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    pub step: usize,
    /// Number of points that changed their piece in this step.
    pub changing: usize,
    /// Largest nodal residual divided by the largest nodal force.
    pub residual: f64,
}

/// Callback after every step; it returns false to cancel the solve.
pub type Watch<'a> = dyn FnMut(Progress) -> bool + 'a;

/// Displacements, reactions and gaps of one load.
#[derive(Clone, Default)]
pub struct ContactSolution {
    pub displacement: Displacement,
    /// Reaction r (m,): Ku + Gᵀr = f.
    pub reaction: Vec<f64>,
    /// Travel (m,) from each point to the reference vertex of its horizontal piece; 0 on other pieces.
    pub gap: Vec<f64>,
    /// Piece of each point (m,).
    pub piece: Vec<u8>,
    pub pivots: usize,
    /// Number of Newton steps.
    pub iterations: usize,
    /// Number of conjugate gradient steps in all Newton steps.
    pub gradients: usize,
    /// Number of factorizations after the first one.
    pub factorizations: usize,
    /// Number of steps of iterative refinement.
    pub corrections: usize,
    /// Last factor of the Newton method, for a warm start.
    pub(super) system: Option<Arc<System>>,
    /// Number of conjugate gradient steps with this factor. When they have cost as much as a factorization, the next
    /// solve factors its contact state.
    pub(super) spent: usize,
}

impl ContactSolution {
    /// Returns an error if some number is NaN or infinite.
    pub(super) fn require_finite(self) -> Result<Self, SolveError> {
        let mut numbers = self.displacement.hi.iter().chain(&self.reaction).chain(&self.gap);
        if numbers.all(|value| value.is_finite()) { Ok(self) } else { Err(SolveError::Unsolved) }
    }

    /// Sets the pieces (m,). A point on a horizontal piece gets the force of that piece.
    pub(super) fn put_on(&mut self, points: &Points, pieces: Vec<u8>) {
        for (i, reaction) in self.reaction.iter_mut().enumerate() {
            let piece = points.piece(i, pieces[i]);
            if !piece.holds() {
                *reaction = piece.force;
            }
        }
        self.piece = pieces;
    }

    pub(super) fn state(&self, i: usize) -> PointState {
        PointState { piece: self.piece[i], reaction: self.reaction[i], gap: self.gap[i] }
    }

    /// Moves the solution linearly towards `other`, by `part` of the difference.
    pub(super) fn towards(&mut self, other: &Self, part: f64) {
        for i in 0..self.displacement.hi.len() {
            let (from, to) = (self.displacement.at(i), other.displacement.at(i));
            let sum = from + (to - from).times(part);
            (self.displacement.hi[i], self.displacement.lo[i]) = (sum.hi, sum.lo);
        }
        for (from, to) in self.reaction.iter_mut().zip(&other.reaction).chain(self.gap.iter_mut().zip(&other.gap)) {
            *from += part * (to - *from);
        }
    }
}

/// Points at which two contact states differ.
pub(super) fn differing(one: &[u8], other: &[u8]) -> Vec<usize> {
    (0..one.len()).filter(|&i| one[i] != other[i]).collect()
}
