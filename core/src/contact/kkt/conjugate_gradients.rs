//! Newton's direction for one set of closed points, by conjugate gradients on K with their springs, preconditioned with
//! a factor that carries the springs of another set.
//!
//! Gould, Hribar & Nocedal (2001) for the preconditioner with two-sided points held. From one Newton step to the next few
//! points change sides, so that the last direction can be deflated (Saad, Yeung, Erhel & Guyomarc'h 2000): conjugate
//! gradients go on from set to set instead of beginning anew.

use super::active_factor::{ActiveFactor, Direction};
use crate::cholesky::FactorError;
use crate::contact::scale::{Scale, dot};
use crate::contact::tolerances;

/// Conjugate gradients on their way to a direction.
pub(crate) struct ConjugateGradients {
    closed: Vec<bool>,
    /// Points whose springs the factor carries otherwise than the set has them, and by how much.
    differing: Vec<(usize, f64)>,
    /// Length of the residual that ends them.
    enough: f64,
    /// Whether a factor of the set is to take over after so many steps, or else the direction is taken as it is.
    patient: bool,
    most: usize,
    steps: usize,
    /// What is to be preconditioned next.
    pub(crate) residual: Vec<f64>,
    total: Direction,
    ahead: Direction,
    deflated: Option<Deflated>,
    /// Of the last residual and its preconditioned one.
    product: f64,
}

/// The direction before the first, the force that the present set has for it, and its curvature.
struct Deflated {
    direction: Direction,
    force: Vec<f64>,
    curvature: f64,
}

/// What a step of conjugate gradients came to.
enum Followed {
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

impl ActiveFactor<'_> {
    /// Begins to seek the direction that leaves `tolerance` of an imbalance, or no more than `rounding`.
    pub(crate) fn gradients(
        &self,
        closed: &[bool],
        imbalance: Vec<f64>,
        tolerance: f64,
        rounding: f64,
    ) -> ConjugateGradients {
        let most = if self.shares() { SHARED * PATIENCE } else { PATIENCE };
        let (size, reactions) = (imbalance.len(), self.problem.constraints.rows.len());
        ConjugateGradients {
            closed: closed.to_vec(),
            differing: self.differing(closed),
            enough: f64::max(tolerance * length(&self.problem.scale, &imbalance), rounding),
            patient: true,
            most,
            steps: 0,
            residual: imbalance,
            total: Direction::zeros(size, reactions),
            ahead: Direction::zeros(size, reactions),
            deflated: None,
            product: f64::INFINITY,
        }
    }

    /// Goes along the last direction as far as that leads down, and then keeps to directions conjugate to it.
    pub(crate) fn deflate(&mut self, gradients: &mut ConjugateGradients) {
        let last = self.last.take().filter(|_| !gradients.differing.is_empty());
        let Some(mut direction) = last else { return };
        direction.reaction.fill(0.0);
        let mut force = self.difference(&gradients.differing, &direction.nodal);
        force.iter_mut().zip(&direction.force).for_each(|(total, force)| *total += force);
        let curvature = dot(&direction.nodal, &force);
        if !(curvature > tolerances::newton::PLAIN * dot(&direction.nodal, &direction.force)) {
            return;
        }
        let alpha = dot(&gradients.residual, &direction.nodal) / curvature;
        gradients.total.combine(1.0, alpha, &direction);
        gradients.residual.iter_mut().zip(&force).for_each(|(residual, force)| *residual -= alpha * force);
        gradients.deflated = Some(Deflated { direction, force, curvature });
    }

    /// Goes on to the direction under an imbalance, at first with what a shared factor has answered; `None` where that is to
    /// be asked. The set is factored if it takes long.
    pub(crate) fn direction(
        &mut self,
        gradients: &mut ConjugateGradients,
        imbalance: &[f64],
        mut answer: Option<Vec<f64>>,
    ) -> Result<Option<Direction>, FactorError> {
        loop {
            let along = match answer.take() {
                // Beside two-sided points no factor is shared.
                Some(solved) => Direction {
                    nodal: self.problem.scatter(&solved),
                    force: gradients.residual.clone(),
                    ..Direction::default()
                },
                None if self.shares() => return Ok(None),
                None => self.response(&gradients.residual, &vec![0.0; self.problem.constraints.rows.len()])?,
            };
            match self.follow(gradients, along) {
                Followed::On => {}
                Followed::Impatient => {
                    self.refactor(&gradients.closed)?;
                    let anew = self.gradients(&gradients.closed, imbalance.to_vec(), 0.0, gradients.enough);
                    *gradients = ConjugateGradients { patient: false, most: GRADIENTS, ..anew };
                }
                Followed::Found(direction) => return Ok(Some(direction)),
            }
        }
    }

    /// One step of conjugate gradients, with the motion that the factor has for the residual.
    fn follow(&mut self, gradients: &mut ConjugateGradients, mut along: Direction) -> Followed {
        gradients.steps += 1;
        self.gradients += 1;
        if gradients.differing.is_empty() {
            self.last = (!self.shares()).then(|| along.clone());
            return Followed::Found(along);
        }
        // What two-sided points take of the residual would stay in it and drown the rest (Gould, Hribar & Nocedal 2001,
        // section 6): it is their reactions' from now on.
        gradients.residual.copy_from_slice(&along.force);
        for (all, part) in gradients.total.reaction.iter_mut().zip(&mut along.reaction) {
            *all += std::mem::take(part);
        }
        let next = dot(&gradients.residual, &along.nodal);
        if !(next > 0.0) {
            return Followed::Found(std::mem::take(&mut gradients.total));
        }
        if let Some(Deflated { direction, force, curvature }) = &gradients.deflated {
            along.combine(1.0, -dot(&along.nodal, force) / curvature, direction);
        }
        let ahead = &mut gradients.ahead;
        ahead.combine(next / gradients.product, 1.0, &along);
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
        gradients.total.combine(1.0, alpha, ahead);
        for (residual, (force, difference)) in gradients.residual.iter_mut().zip(ahead.force.iter().zip(&difference)) {
            *residual -= alpha * (force + difference);
        }
        if length(&self.problem.scale, &gradients.residual) <= gradients.enough {
            self.last = (!self.shares()).then(|| std::mem::take(&mut gradients.ahead));
            return Followed::Found(std::mem::take(&mut gradients.total));
        }
        match (gradients.steps == gradients.most, gradients.patient) {
            (false, _) => Followed::On,
            (true, true) => Followed::Impatient,
            (true, false) => Followed::Found(std::mem::take(&mut gradients.total)),
        }
    }
}

/// Of nodal forces, a couple as the force that it is at the arm.
fn length(scale: &Scale, nodal: &[f64]) -> f64 {
    let of_couples = 1.0 / scale.arm;
    let square = |f: &[f64]| f[0] * f[0] + (of_couples * f[1]).powi(2) + (of_couples * f[2]).powi(2);
    nodal.chunks_exact(3).map(square).sum::<f64>().sqrt()
}
