//! What a contact problem is answered with.

use super::points::Points;
use super::system::System;
use crate::displacement::Displacement;
use std::sync::Arc;

/// One step of a solve, to whoever watches.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    pub step: usize,
    /// Points that are on another piece than in the step before.
    pub changing: usize,
    /// Largest imbalance over the largest nodal force.
    pub residual: f64,
}

/// Sees every step of a solve, and ends it by returning false.
pub type Watch<'a> = dyn FnMut(Progress) -> bool + 'a;

/// How a contact problem ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outcome {
    Solved,
    /// No reactions balance the load, or gaps contradict each other.
    NoEquilibrium,
    /// A limit of steps was reached, or the pieces are beyond the arithmetic.
    #[default]
    Unsolved,
    /// Whoever watched wanted no more.
    Interrupted,
}

/// Displacements, reactions and gaps; NaN unless solved.
#[derive(Clone, Default)]
pub struct ContactSolution {
    pub outcome: Outcome,
    pub displacement: Displacement,
    /// Force of every contact point, against its row.
    pub reaction: Vec<f64>,
    /// Travel from every point to the vertex of its piece, where that is flat; 0 where it holds.
    pub gap: Vec<f64>,
    /// The piece that every point is on.
    pub piece: Vec<u8>,
    pub pivots: usize,
    /// Newton steps of the active set, and steps of the interior point method.
    pub iterations: usize,
    /// Conjugate gradient steps in them.
    pub gradients: usize,
    /// Matrices factored for other pieces than the problem's own.
    pub factorizations: usize,
    /// Corrections made with the refined residual.
    pub corrections: usize,
    /// The factor that an active set came to, for solves that begin with this one.
    pub(super) system: Option<Arc<System>>,
    /// Conjugate gradient steps with it; as many as cost a factor make the next solve factor these pieces.
    pub(super) spent: usize,
}

impl ContactSolution {
    /// Solved, unless numbers beyond the arithmetic have made some of it NaN or infinite.
    pub(super) fn solved(self) -> Self {
        let d = &self.displacement;
        let finite = d.hi.iter().chain(&self.reaction).chain(&self.gap).all(|value| value.is_finite());
        if finite { Self { outcome: Outcome::Solved, ..self } } else { self.failed(Outcome::Unsolved) }
    }

    /// Every number NaN, and why.
    pub(super) fn failed(mut self, outcome: Outcome) -> Self {
        let d = &mut self.displacement;
        for value in d.hi.iter_mut().chain(&mut d.lo).chain(&mut self.reaction).chain(&mut self.gap) {
            *value = f64::NAN;
        }
        self.piece.fill(0);
        Self { outcome, ..self }
    }

    /// Puts the points on pieces: on flat ones their forces are known.
    pub(super) fn put_on(&mut self, points: &Points, pieces: Vec<u8>) {
        for (i, reaction) in self.reaction.iter_mut().enumerate() {
            let piece = points.piece(i, pieces[i]);
            if !piece.holds() {
                *reaction = piece.force;
            }
        }
        self.piece = pieces;
    }

    /// Goes a part of the way to another solution.
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

/// Points whose pieces differ.
pub(super) fn differing(one: &[u8], other: &[u8]) -> Vec<usize> {
    (0..one.len()).filter(|&i| one[i] != other[i]).collect()
}
