//! Preconditioned conjugate gradients for the equations of a contact state; the preconditioner is a factor with the
//! springs of another state.
//!
//! Few points change their piece from one Newton step to the next, so that the last direction is deflated (Saad, Yeung,
//! Erhel & Guyomarc'h 2000) and the method continues from state to state.

use super::factored::{Direction, Factored};
use crate::cholesky::FactorError;
use crate::contact::backend::Backend;
use crate::contact::scale::dot;
use crate::contact::tolerances;

/// State of the conjugate gradient iteration.
pub(in crate::contact) struct Gradients {
    pieces: Vec<u8>,
    /// Points whose factored spring differs from that of the contact state, and the difference.
    differing: Vec<(usize, f64)>,
    /// Norm of the residual at which the iteration ends.
    enough: f64,
    /// Whether the contact state is factored, and the iteration restarted, after `most` steps; otherwise the direction
    /// is returned as it is.
    may_refactor: bool,
    most: usize,
    steps: usize,
    /// The residual (3n,), to which the factor is applied next.
    pub(in crate::contact) residual: Vec<f64>,
    total: Direction,
    ahead: Direction,
    deflated: Option<Deflated>,
    /// Dot product of the last residual and its preconditioned residual.
    product: f64,
}

/// The deflated direction, the product of the present matrix with it, and its curvature.
struct Deflated {
    direction: Direction,
    force: Vec<f64>,
    curvature: f64,
}

/// Number of conjugate gradient steps before a new factorization, which costs about as much. With a shared factor a
/// step is cheaper, and the number is `SHARED` times as large. The saddle-point method uses no conjugate gradients
/// before it, since springs differ too much.
pub(in crate::contact) const BEFORE_A_FACTOR: usize = 10;
const SHARED: usize = 3;
/// Largest number of steps if the contact state cannot be factored.
const MOST: usize = 500;

impl Gradients {
    /// Starts the iteration for an imbalance; it ends at the relative `tolerance` or at `rounding`.
    pub(in crate::contact) fn begin(
        kkt: &Factored,
        pieces: &[u8],
        imbalance: Vec<f64>,
        tolerance: f64,
        rounding: f64,
    ) -> Self {
        let size = imbalance.len();
        Self {
            pieces: pieces.to_vec(),
            differing: kkt.differing(pieces),
            enough: f64::max(tolerance * kkt.problem.scale.length(&imbalance), rounding),
            may_refactor: true,
            most: match kkt.problem.backend {
                Backend::SaddlePoint(_) => 0,
                _ if kkt.shares() => SHARED * BEFORE_A_FACTOR,
                _ => BEFORE_A_FACTOR,
            },
            steps: 0,
            residual: imbalance,
            total: Direction::zeros(size),
            ahead: Direction::zeros(size),
            deflated: None,
            product: f64::INFINITY,
        }
    }

    /// Minimises along the last direction, then uses only directions conjugate to it.
    pub(in crate::contact) fn deflate(&mut self, kkt: &mut Factored) {
        let Some(direction) = kkt.last.take().filter(|_| !self.differing.is_empty()) else { return };
        let mut force = kkt.difference(&self.differing, &direction.nodal);
        force.iter_mut().zip(&direction.force).for_each(|(total, force)| *total += force);
        let curvature = dot(&direction.nodal, &force);
        if !(curvature > tolerances::newton::PLAIN * dot(&direction.nodal, &direction.force)) {
            return;
        }
        let alpha = dot(&self.residual, &direction.nodal) / curvature;
        self.total.combine(1.0, alpha, &direction);
        self.residual.iter_mut().zip(&force).for_each(|(residual, force)| *residual -= alpha * force);
        self.deflated = Some(Deflated { direction, force, curvature });
    }

    /// Iterates to the direction for an imbalance. With a shared factor, `answer` is the product of its inverse with
    /// `residual`; `None` asks for the next answer. The contact state is factored if the iteration is slow.
    pub(in crate::contact) fn go_on(
        &mut self,
        kkt: &mut Factored,
        imbalance: &[f64],
        mut answer: Option<Vec<f64>>,
    ) -> Result<Option<Direction>, FactorError> {
        loop {
            if self.steps == self.most && !self.differing.is_empty() || self.may_refactor && self.is_far(kkt) {
                if !self.may_refactor {
                    return Ok(Some(std::mem::take(&mut self.total)));
                }
                self.refactor(kkt, imbalance)?;
            }
            let along = match answer.take() {
                Some(nodal) => Direction { nodal, force: self.residual.clone(), is_free: false },
                None if kkt.shares() => return Ok(None),
                None => kkt.response(&self.residual)?,
            };
            if let Some(direction) = self.follow(kkt, along) {
                return Ok(Some(direction));
            }
        }
    }

    /// Whether more stiff points differ than there are steps; each takes about one step. With the first penalty their
    /// springs are soft relative to the plate and take fewer.
    fn is_far(&self, kkt: &Factored) -> bool {
        let augmented = self.differing.iter().filter(|(i, _)| kkt.series[*i] > 0.0).count();
        augmented > self.most && kkt.limit > kkt.augmentation.first_penalty
    }

    /// Factors the contact state and restarts.
    fn refactor(&mut self, kkt: &mut Factored, imbalance: &[f64]) -> Result<(), FactorError> {
        kkt.refactor(&self.pieces)?;
        let anew = Self::begin(kkt, &self.pieces, imbalance.to_vec(), 0.0, self.enough);
        *self = Self { may_refactor: false, most: MOST, ..anew };
        Ok(())
    }

    /// Makes one step with the preconditioned residual `along`; returns the direction after the last step.
    fn follow(&mut self, kkt: &mut Factored, mut along: Direction) -> Option<Direction> {
        self.steps += 1;
        kkt.gradients += 1;
        if self.differing.is_empty() {
            kkt.last = (!kkt.shares()).then(|| along.clone());
            return Some(along);
        }
        let next = dot(&self.residual, &along.nodal);
        if !(next > 0.0) {
            return Some(std::mem::take(&mut self.total));
        }
        if let Some(Deflated { direction, force, curvature }) = &self.deflated {
            along.combine(1.0, -dot(&along.nodal, force) / curvature, direction);
        }
        let ahead = &mut self.ahead;
        ahead.combine(next / self.product, 1.0, &along);
        self.product = next;
        let difference = kkt.difference(&self.differing, &ahead.nodal);
        let stiff = dot(&ahead.nodal, &ahead.force);
        let mut curvature = stiff + dot(&ahead.nodal, &difference);
        if !(curvature > tolerances::newton::PLAIN * stiff) {
            curvature = kkt.curvature(&self.pieces, &ahead.nodal);
        }
        if !(curvature > tolerances::newton::FREE * stiff) {
            // No direction balances the load until the next points come into contact. The line search ends there.
            let mut free = std::mem::take(ahead);
            free.is_free = true;
            return Some(free);
        }
        let alpha = next / curvature;
        self.total.combine(1.0, alpha, ahead);
        for (residual, (force, difference)) in self.residual.iter_mut().zip(ahead.force.iter().zip(&difference)) {
            *residual -= alpha * (force + difference);
        }
        if kkt.problem.scale.length(&self.residual) <= self.enough {
            kkt.last = (!kkt.shares()).then(|| std::mem::take(&mut self.ahead));
            return Some(std::mem::take(&mut self.total));
        }
        None
    }
}
