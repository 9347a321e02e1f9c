//! Solves where rounding decides: points that nearly repeat each other, plates that hardly anything holds.
//!
//! Subproblem steps (Rockafellar 1976) regularize the problem without changing its answer: each solves an LCP past the
//! reactions that act already, in which increments of reaction meet a compliance and increments of deflection a
//! stiffness (`proximal`). `saddle` solves the equations of a contact state without condensing them, `floating` keeps
//! large rigid motions apart, `krylov` takes away what the regularization leaves, and `steps` goes from one contact set
//! to the next. docs/theory.md, section 6, says why.

mod floating;
mod krylov;
mod regularized;
mod saddle;
mod shears;
mod steps;
mod subproblem;

use super::problem::ContactProblem;
use super::solution::{ContactSolution, Outcome, Progress};
use crate::contact::tolerances;
use floating::Floating;
use regularized::Regularized;
use saddle::Saddle;

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
    ) -> ContactSolution {
        let regularized = Regularized::of(self, part, 0.0);
        regularized.solve(load, self.at_rest(load.len(), held_value), closed.map(<[bool]>::to_vec), watch)
    }

    /// As [`ContactProblem::solve_on`], by the uncondensed equations; not solved where more is left than rounding, of the
    /// force `beside` too.
    pub(super) fn solve_on_by_proximal_steps(
        &self,
        load: &[f64],
        held_value: &[f64],
        closed: &[bool],
        beside: f64,
    ) -> ContactSolution {
        let regularized = Regularized::of(self, tolerances::proximal::COMPLIANCE, beside);
        let mut solution = self.at_rest(load.len(), held_value);
        solution.closed = closed.to_vec();
        let Some(saddle) = Saddle::of(&regularized, closed) else {
            return solution.failed(Outcome::Unsolved);
        };
        let step = self.residual(load, &solution);
        let floating = Floating::of(&regularized, closed);
        let left = regularized.refine(load, &saddle, floating.as_ref(), &step, &mut solution);
        solution.leave_open(&left.remaining);
        if regularized.solved(load, &left, &solution) { solution.solved() } else { solution.failed(Outcome::Unsolved) }
    }
}
