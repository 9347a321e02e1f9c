//! Newton's direction for one set of closed points, by conjugate gradients on K with their springs, preconditioned with
//! a factor that carries the springs of another set.
//!
//! Gould, Hribar & Nocedal (2001) for the preconditioner with two-sided points held.

use super::descent::Descent;
use super::direction::{Direction, dot};
use crate::cholesky::FactorError;
use crate::contact::refinement::Residual;
use crate::contact::tolerances;
use crate::residual::twice_the_energy;

/// Conjugate gradients on their way to a direction.
pub(super) struct ConjugateGradients {
    closed: Vec<bool>,
    /// Points whose springs the factor carries otherwise than the set has them, and by how much.
    differing: Vec<(usize, f64)>,
    tolerance: f64,
    /// Length of the residual that ends them.
    enough: f64,
    /// Whether a factor of the set is to take over after so many steps, or else the direction is taken as it is.
    patient: bool,
    most: usize,
    steps: usize,
    residual: Vec<f64>,
    total: Direction,
    ahead: Direction,
    /// Of the last residual and its preconditioned one.
    product: f64,
}

impl ConjugateGradients {
    /// What is to be preconditioned next.
    pub(super) fn residual(&self) -> &[f64] {
        &self.residual
    }
}

/// What a step of conjugate gradients came to.
pub(super) enum Followed {
    On,
    /// There have been too many; a factor of the set would be better.
    Impatient,
    Found(Direction),
}

/// Conjugate gradients take this many steps before a factor of the present set, which costs about as much, replaces them;
/// where a factor is asked together with others, so that a step costs a part of that, so many times as many.
const PATIENCE: usize = 10;
const SHARED: usize = 3;
/// At most this many where it cannot be factored.
const GRADIENTS: usize = 500;

impl Descent<'_> {
    /// Begins to seek the direction whose residual is `tolerance` of the imbalance, or rounding.
    pub(super) fn gradients(&self, closed: &[bool], tolerance: f64, patient: bool) -> ConjugateGradients {
        let most = match (patient, self.shares()) {
            (true, true) => SHARED * PATIENCE,
            (true, false) => PATIENCE,
            (false, _) => GRADIENTS,
        };
        let residual = self.residual.imbalance.clone();
        let (size, reactions) = (residual.len(), self.solution.reaction.len());
        ConjugateGradients {
            closed: closed.to_vec(),
            differing: self.differing(closed),
            tolerance,
            enough: f64::max(tolerance * dot(&residual, &residual).sqrt(), self.rounding),
            patient,
            most,
            steps: 0,
            residual,
            total: Direction::zeros(size, reactions),
            ahead: Direction::zeros(size, reactions),
            product: f64::INFINITY,
        }
    }

    /// The same direction from a factor of its set, as far as that can be factored.
    pub(super) fn refactored(&mut self, gradients: ConjugateGradients) -> Result<ConjugateGradients, FactorError> {
        if self.refactor(&gradients.closed)? {
            self.solution.factorizations += 1;
        }
        Ok(self.gradients(&gradients.closed, gradients.tolerance, false))
    }

    /// The direction whose residual is `tolerance` of the imbalance, or rounding; the set is factored if that takes long.
    pub(super) fn direction(&mut self, closed: &[bool], tolerance: f64) -> Result<Direction, FactorError> {
        let mut gradients = self.gradients(closed, tolerance, true);
        loop {
            let along = self.precondition(&gradients.residual)?;
            match self.follow(&mut gradients, along) {
                Followed::On => {}
                Followed::Impatient => gradients = self.refactored(gradients)?,
                Followed::Found(direction) => return Ok(direction),
            }
        }
    }

    /// Factors the present set, with a little of the open points if it does not hold the plate; whether that succeeded.
    fn refactor(&mut self, closed: &[bool]) -> Result<bool, FactorError> {
        let points = &self.problem.active;
        let nothing = vec![0.0; closed.len()];
        let slenderness = self.problem.plate.slenderness();
        let retained = points.penalized(slenderness * slenderness / closed.len() as f64).stiffness;
        for of_open in [nothing, retained] {
            let full = closed.iter().zip(&self.penalty.stiffness).zip(&of_open);
            let carried = full.map(|((&c, &k), &open)| if c { k } else { open }).collect();
            match self.problem.refactored(carried) {
                Ok(found) => {
                    let Some(state) = found.condensed.state(self.problem.constraints.two_sided.clone()) else {
                        continue;
                    };
                    self.state = state;
                    self.own = Some(found);
                    return Ok(true);
                }
                Err(FactorError::NotPositiveDefinite { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(false)
    }

    /// One step of conjugate gradients, with the motion that the factor has for the residual.
    pub(super) fn follow(&mut self, gradients: &mut ConjugateGradients, mut along: Direction) -> Followed {
        gradients.steps += 1;
        self.solution.gradients += 1;
        if gradients.differing.is_empty() {
            return Followed::Found(along);
        }
        let next = dot(&gradients.residual, &along.nodal);
        if !(next > 0.0) {
            return Followed::Found(std::mem::take(&mut gradients.total));
        }
        let ahead = &mut gradients.ahead;
        ahead.renew(next / gradients.product, &along);
        gradients.product = next;
        let difference = self.difference(&gradients.differing, &ahead.nodal);
        let stiff = dot(&ahead.nodal, &ahead.force);
        let mut curvature = stiff + dot(&ahead.nodal, &difference);
        if !(curvature > tolerances::newton::PLAIN * stiff) {
            curvature = self.curvature(&gradients.closed, &ahead.nodal);
        }
        if !(curvature > tolerances::newton::FREE * stiff) {
            // The line search goes as far as the next points, before which no other direction balances the load.
            along = std::mem::take(ahead);
            along.free = true;
            return Followed::Found(along);
        }
        let alpha = next / curvature;
        gradients.total.add(alpha, ahead);
        for (residual, (force, difference)) in gradients.residual.iter_mut().zip(ahead.force.iter().zip(&difference)) {
            *residual -= alpha * (force + difference);
        }
        if dot(&gradients.residual, &gradients.residual).sqrt() <= gradients.enough {
            return Followed::Found(std::mem::take(&mut gradients.total));
        }
        match (gradients.steps == gradients.most, gradients.patient) {
            (false, _) => Followed::On,
            (true, true) => Followed::Impatient,
            (true, false) => Followed::Found(std::mem::take(&mut gradients.total)),
        }
    }

    /// vᵀKv with the springs of closed points, summed from squares: along a free motion a difference would be rounding.
    fn curvature(&self, closed: &[bool], vector: &[f64]) -> f64 {
        let (points, plate) = (&self.problem.active, &self.problem.plate);
        let spring = |i: usize| self.penalty.stiffness[i] * points.dot(plate, i, vector).powi(2);
        twice_the_energy(plate, &self.problem.springs, vector)
            + (0..closed.len()).filter(|&i| closed[i]).map(spring).sum::<f64>()
    }

    /// Points whose springs the factor carries otherwise than the set has them, and by how much.
    fn differing(&self, closed: &[bool]) -> Vec<(usize, f64)> {
        let carried = &self.factored().carried;
        let full = &self.penalty.stiffness;
        let difference = |i: usize| if closed[i] { full[i] } else { 0.0 } - carried[i];
        (0..closed.len()).map(|i| (i, difference(i))).filter(|&(_, d)| d != 0.0).collect()
    }

    /// Σ Δk r (r·v) over the points that differ.
    fn difference(&self, differing: &[(usize, f64)], vector: &[f64]) -> Vec<f64> {
        let (points, plate) = (&self.problem.active, &self.problem.plate);
        let mut out = vec![0.0; vector.len()];
        for &(i, stiffness) in differing {
            let pull = stiffness * points.dot(plate, i, vector);
            points.scatter(plate, i, pull, &mut out);
        }
        self.problem.release_held(&mut out);
        out
    }

    /// Whether the next residual goes to a factor that others ask too.
    pub(super) fn shares(&self) -> bool {
        self.shares && self.own.is_none()
    }

    /// What K̃⁻¹ times a residual, in elimination order, moves; there are no two-sided points.
    pub(super) fn preconditioned(&self, residual: &[f64], solved: &[f64]) -> Direction {
        let (nodal, force) = (self.problem.scatter(solved), residual.to_vec());
        Direction { nodal, force, reaction: Vec::new(), free: false }
    }

    /// The motion under a residual by the factor, two-sided points held, and the force it has for that.
    pub(super) fn precondition(&self, residual: &[f64]) -> Result<Direction, FactorError> {
        let problem = self.problem;
        let still = Residual {
            imbalance: residual.to_vec(),
            remaining: vec![0.0; problem.constraints.rows.len()],
            worst: 0.0,
            work: vec![0.0; problem.constraints.free_motions.len()],
            work_size: vec![0.0; problem.constraints.free_motions.len()],
        };
        let with = self.factored();
        let motion = problem.reduced(with, &still, with.condensed.better_form())?;
        let (nodal, reaction) = problem.respond(with, &self.state, motion)?;
        let mut force = still.imbalance;
        let back: Vec<f64> = reaction.iter().map(|r| -r).collect();
        problem.spread(&back, &mut force);
        problem.release_held(&mut force);
        Ok(Direction { nodal, force, reaction, free: false })
    }
}
