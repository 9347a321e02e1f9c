//! The solution of a contact problem, and the progress of a solve.

use super::error::SolveError;
use super::points::{PointState, Points};
use super::system::System;
use crate::displacement::Displacement;
use std::sync::Arc;

/// Progress of a solve after one step, as it is passed to the callback.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    pub step: usize,
    /// Number of contact points that changed their piece of the law in this step.
    pub changing: usize,
    /// Newton method: largest nodal force of the residual, divided by the largest force. Lemke's algorithm: artificial
    /// variable, divided by its first value.
    pub residual: f64,
}

/// Callback that is called after every step; it returns false to cancel the solve.
pub type Watch<'a> = dyn FnMut(Progress) -> bool + 'a;

/// Displacements, reactions, gaps and contact state under one load.
#[derive(Clone, Default)]
pub struct ContactSolution {
    pub displacement: Displacement,
    /// Reaction r (m,) of each contact point, with Ku + Gᵀr = f.
    pub reaction: Vec<f64>,
    /// Travel (m,) from each point on a horizontal piece of its law to the reference vertex of this piece; 0 on other
    /// pieces.
    pub gap: Vec<f64>,
    /// For each point (m,), the number of the piece of its law on which the point is.
    pub piece: Vec<u8>,
    pub pivots: usize,
    /// Number of Newton steps of the solve.
    pub iterations: usize,
    /// Number of conjugate gradient steps, summed over all Newton steps.
    pub gradients: usize,
    /// Number of factorizations during the solve, without the factorization of the problem itself.
    pub factorizations: usize,
    /// Number of corrections by iterative refinement.
    pub corrections: usize,
    /// Last factor of the Newton method. The solve of another load can start with this factor.
    pub(super) system: Option<Arc<System>>,
    /// Number of conjugate gradient steps with the factor `system`. If these steps have cost as much as a
    /// factorization, the next solve first factors K with the springs of this contact state.
    pub(super) spent: usize,
}

impl ContactSolution {
    /// The solution, or an error if one of its numbers is NaN or infinite.
    pub(super) fn require_finite(self) -> Result<Self, SolveError> {
        let mut numbers = self.displacement.hi.iter().chain(&self.reaction).chain(&self.gap);
        if numbers.all(|value| value.is_finite()) { Ok(self) } else { Err(SolveError::Unsolved) }
    }

    /// Sets the contact state `pieces` (m,). The reaction of a point on a horizontal piece of its law becomes the force
    /// of this piece.
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

    /// Moves displacements, reactions and gaps by the fraction `part` towards those of the solution `other`.
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

/// Indices of the points that are on different pieces of their laws in two contact states.
pub(super) fn differing(one: &[u8], other: &[u8]) -> Vec<usize> {
    (0..one.len()).filter(|&i| one[i] != other[i]).collect()
}
