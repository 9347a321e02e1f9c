//! The factor by which an active set finds its directions: the one it was given, or that of its own set.

use super::refinement::Correction;
use crate::cholesky::FactorError;
use crate::contact::condense::ContactState;
use crate::contact::points::Penalty;
use crate::contact::problem::{ContactProblem, Factored};
use crate::residual::twice_the_energy;

/// A displacement, the force that the factored matrix has for it, and what it adds to two-sided points' reactions.
#[derive(Clone, Default)]
pub(crate) struct Direction {
    pub nodal: Vec<f64>,
    pub force: Vec<f64>,
    pub reaction: Vec<f64>,
    /// Whether the closed points let the plate move along it freely: then it has no length of its own.
    pub free: bool,
}

impl Direction {
    pub(crate) fn zeros(size: usize, reactions: usize) -> Self {
        Self { nodal: vec![0.0; size], force: vec![0.0; size], reaction: vec![0.0; reactions], free: false }
    }

    /// self ← beta·self + alpha·other
    pub(super) fn combine(&mut self, beta: f64, alpha: f64, other: &Self) {
        for (mine, others) in
            [(&mut self.nodal, &other.nodal), (&mut self.force, &other.force), (&mut self.reaction, &other.reaction)]
        {
            mine.iter_mut().zip(others).for_each(|(a, b)| *a = beta * *a + alpha * b);
        }
    }
}

/// A factor of K with the springs of some points, and the springs that closed points have.
pub(crate) struct ActiveFactor<'a> {
    pub(crate) problem: &'a ContactProblem,
    /// Stiffest springs, over the plate's stiffness in shear.
    pub(crate) limit: f64,
    pub(crate) penalty: Penalty,
    given: &'a Factored,
    /// That of its own set, if it has come to one.
    pub(super) own: Option<Factored>,
    /// Two-sided points, held.
    state: ContactState,
    /// Whether others ask the factor that it was given too; there are no two-sided points then.
    shares: bool,
    /// The last direction that this factor has found, unless it shares.
    pub(super) last: Option<Direction>,
    /// Conjugate gradient steps, and sets factored anew.
    pub(crate) gradients: usize,
    pub(crate) factorizations: usize,
}

impl<'a> ActiveFactor<'a> {
    /// `None` if two-sided points contradict each other.
    pub(crate) fn of(
        problem: &'a ContactProblem,
        given: &'a Factored,
        limit: f64,
        shares: bool,
    ) -> Result<Option<Self>, FactorError> {
        let Some(state) = given.condensed.state(problem.constraints.two_sided.clone())? else { return Ok(None) };
        let penalty = problem.active.penalized(limit);
        let (own, last) = (None, None);
        Ok(Some(Self { problem, limit, penalty, given, own, state, shares, last, gradients: 0, factorizations: 0 }))
    }

    pub(crate) fn factored(&self) -> &Factored {
        self.own.as_ref().unwrap_or(self.given)
    }

    /// Whether the next residual goes to a factor that others ask too.
    pub(super) fn shares(&self) -> bool {
        self.shares && self.own.is_none()
    }

    /// Factors a set, with a little of the open points if it does not hold the plate; as far as that succeeds.
    pub(super) fn refactor(&mut self, closed: &[bool]) -> Result<(), FactorError> {
        let points = &self.problem.active;
        let nothing = vec![0.0; closed.len()];
        let slenderness = self.problem.plate.slenderness();
        let retained = points.penalized(slenderness * slenderness / closed.len() as f64).stiffness;
        for of_open in [nothing, retained] {
            let full = closed.iter().zip(&self.penalty.stiffness).zip(&of_open);
            let carried = full.map(|((&c, &k), &open)| if c { k } else { open }).collect();
            match self.problem.refactored(carried) {
                Ok(found) => {
                    let Some(state) = found.condensed.state(self.problem.constraints.two_sided.clone())? else {
                        continue;
                    };
                    self.state = state;
                    self.own = Some(found);
                    self.last = None;
                    self.factorizations += 1;
                    return Ok(());
                }
                Err(FactorError::NotPositiveDefinite { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// vᵀKv with the springs of closed points, summed from squares: along a free motion a difference would be rounding.
    pub(super) fn curvature(&self, closed: &[bool], vector: &[f64]) -> f64 {
        let (points, plate) = (&self.problem.active, &self.problem.plate);
        let spring = |i: usize| self.penalty.stiffness[i] * points.dot(plate, i, vector).powi(2);
        twice_the_energy(plate, &self.problem.springs, vector)
            + (0..closed.len()).filter(|&i| closed[i]).map(spring).sum::<f64>()
    }

    /// Points whose springs the factor carries otherwise than the set has them, and by how much.
    pub(super) fn differing(&self, closed: &[bool]) -> Vec<(usize, f64)> {
        let carried = &self.factored().carried;
        let full = &self.penalty.stiffness;
        let difference = |i: usize| if closed[i] { full[i] } else { 0.0 } - carried[i];
        (0..closed.len()).map(|i| (i, difference(i))).filter(|&(_, d)| d != 0.0).collect()
    }

    /// Σ Δk r (r·v) over the points that differ.
    pub(super) fn difference(&self, differing: &[(usize, f64)], vector: &[f64]) -> Vec<f64> {
        let (points, plate) = (&self.problem.active, &self.problem.plate);
        let mut out = vec![0.0; vector.len()];
        for &(i, stiffness) in differing {
            let pull = stiffness * points.dot(plate, i, vector);
            points.scatter(plate, i, pull, &mut out);
        }
        self.problem.release_held(&mut out);
        out
    }

    /// The motion under an imbalance by the factor, with what is left of the two-sided points' gaps taken up, and the force
    /// it has for that.
    pub(crate) fn response(&self, imbalance: &[f64], remaining: &[f64]) -> Result<Direction, FactorError> {
        let problem = self.problem;
        let with = self.factored();
        let reduced = problem.reduced(with, imbalance, remaining, with.condensed.better_form())?;
        let Correction { nodal, reaction, .. } = problem.respond(with, &self.state, reduced)?;
        let mut force = imbalance.to_vec();
        problem.take_off(&reaction, &mut force);
        problem.release_held(&mut force);
        Ok(Direction { nodal, force, reaction, free: false })
    }
}
