//! Solves where rounding decides: points that nearly repeat each other, plates that hardly anything holds.
//!
//! Proximal steps (Rockafellar 1976) regularize the problem without changing its answer: each solves an LCP past the
//! reactions that act already, in which increments of reaction meet a compliance and increments of deflection a
//! stiffness (`subproblem`), and `steps` goes from one contact set to the next. docs/theory.md, section 6, says why.

mod steps;
mod subproblem;

use super::kkt::Regularized;
use super::problem::ContactProblem;
use super::solution::{ContactSolution, Progress};
use crate::cholesky::FactorError;
use steps::Steps;

impl ContactProblem {
    /// As [`ContactProblem::solve`], by proximal steps; without points of an active set.
    ///
    /// Increments of reaction meet at least `part` of the plate's own compliance. The steps begin with a contact set if
    /// there is one, and end where the equations of one set give the right signs; if none does, with the last step.
    /// `watch` sees every step and stops it by returning false.
    pub fn solve_by_proximal_steps(
        &self,
        load: &[f64],
        held_value: &[f64],
        part: f64,
        closed: Option<&[bool]>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        let steps = Steps { problem: self, regularized: Regularized::of(self, part), load };
        steps.run(self.at_rest(held_value), closed.map(<[bool]>::to_vec), watch)
    }
}
