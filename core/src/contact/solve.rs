//! From a load to displacements, reactions and gaps.

use super::condense::{Form, PosedLcp, Work};
use super::kkt::{Interface, Reduced};
use super::problem::ContactProblem;
use super::scale::largest;
use super::solution::{ContactSolution, Outcome, Progress, Start};
use crate::cholesky::FactorError;
use crate::contact::tolerances;

/// At most this many contact states.
const STATES: usize = 60;

impl ContactProblem {
    /// Solves for one nodal load with the held dofs at `held_value` (both vectors over all dofs).
    ///
    /// `form` chooses the unknowns of the LCP, see [`super::condense`]; the better conditioned one if `None`. The
    /// solution is refined with the double-double residual; if that shows a point on the wrong side, the LCP is posed
    /// again with the refined figures. `watch` sees every step of an active set and stops it by returning false.
    pub fn solve(
        &self,
        load: &[f64],
        held_value: &[f64],
        form: Option<Form>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        self.solve_from(load, held_value, form, None, watch)
    }

    /// As [`ContactProblem::solve`], beginning with the contact set, and for an active set with the displacement and the
    /// reactions, of an answer if there is one.
    pub(super) fn solve_from(
        &self,
        load: &[f64],
        held_value: &[f64],
        form: Option<Form>,
        start: Option<&Start<'_>>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        if !self.active.is_empty() {
            return self.solve_active(load, held_value, start, watch);
        }
        let with = &self.base;
        let form = form.unwrap_or(with.condensed.better_form());
        let mut solution = self.at_rest(held_value);
        let mut first = start.map(|start| &start.solution.closed[..]);
        let mut step = self.residual(load, &solution);
        let work = self.work(load);
        let mut reduced = self.reduced(with, &step.imbalance, &step.remaining, form)?;
        let travel = largest(&reduced.interface.displacement);
        for _ in 0..STATES {
            let closed = match self.contact_set(&reduced, &work, &mut solution, form, first.take(), watch)? {
                Ok(closed) => closed,
                Err(outcome) => return Ok(solution.failed(outcome)),
            };
            let settled = closed == solution.closed && solution.corrections > 0;
            solution.closed = closed;
            if !settled {
                let Some(state) = with.condensed.state(solution.closed.clone())? else {
                    return Ok(solution.failed(Outcome::Unsolved));
                };
                if self.release_open(&mut solution) {
                    step = self.residual(load, &solution);
                    reduced = self.reduced(with, &step.imbalance, &step.remaining, form)?;
                }
                let mut interface = Interface { problem: self, with, state: &state, reduced: Some(reduced) };
                let Some(left) = self.refine(load, 0.0, &mut interface, step, &mut solution)? else {
                    return Ok(solution.failed(Outcome::Unsolved));
                };
                step = left;
            }
            solution.leave_open(&step.remaining);
            if settled || self.signs_hold(load, tolerances::RESIDUAL * travel, &solution) {
                // A set whose equations only rounding keeps regular has no solution. What settlements leave by rounding,
                // where nothing else acts, is none of its fault.
                let size = |dof: usize| if dof % 3 == 0 { 1.0 } else { self.scale.size };
                let moved =
                    held_value.iter().enumerate().fold(0.0, |most: f64, (dof, v)| most.max(v.abs() * size(dof)));
                let least = f64::EPSILON * self.scale.stiffness * moved;
                let satisfied = self.satisfies(load, &step, &solution, least);
                return Ok(if satisfied { solution.solved() } else { solution.failed(Outcome::Unsolved) });
            }
            reduced = self.reduced(with, &step.imbalance, &step.remaining, form)?;
        }
        Ok(solution.failed(Outcome::Unsolved))
    }

    /// The LCP that [`ContactProblem::solve`] poses first.
    pub fn lcp(&self, load: &[f64], held_value: &[f64], form: Option<Form>) -> Result<PosedLcp, FactorError> {
        let rest = self.at_rest(held_value);
        let form = form.unwrap_or(self.base.condensed.better_form());
        let step = self.residual(load, &rest);
        let reduced = self.reduced(&self.base, &step.imbalance, &step.remaining, form)?;
        Ok(self.base.condensed.lcp(form, &reduced.interface, &self.work(load), &rest.reaction)?)
    }

    /// Poses the LCP from where the solution stands and solves it, beginning with a contact set if there is one; the set
    /// found, or why there is none.
    fn contact_set(
        &self,
        reduced: &Reduced,
        work: &Work,
        solution: &mut ContactSolution,
        form: Form,
        first: Option<&[bool]>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Result<Vec<bool>, Outcome>, FactorError> {
        if self.constraints.two_sided.iter().all(|&t| t) {
            return Ok(Ok(self.constraints.two_sided.clone()));
        }
        let condensed = &self.base.condensed;
        let posed = condensed.lcp(form, &reduced.interface, work, &solution.reaction)?;
        let basis = first.map(|closed| condensed.basis(&posed, closed));
        let found = self.solve_lcp(&posed, basis.as_deref(), &mut solution.pivots, watch)?;
        Ok(found.map(|basis| condensed.closed_points(&posed, &basis)))
    }

    /// Whether no reaction pulls and no gap is negative, points in the problem's order; lengths up to `nil` are none.
    pub(super) fn signs_hold(&self, load: &[f64], nil: f64, solution: &ContactSolution) -> bool {
        let c = &self.constraints;
        // Without a load, reactions are what the plate's stiffness makes of gaps.
        let load = match self.scale.largest(load) {
            0.0 => largest(&c.regularization) * largest(&c.distance),
            load => load,
        };
        let force = tolerances::SIGN * self.largest_force(&[], &solution.reaction).max(load);
        let lengths = self.lengths(solution);
        let length = |i: usize| (tolerances::SIGN * lengths[i]).max(nil / self.lever(i));
        self.push_and_open(&solution.reaction, &solution.gap, force, length)
    }

    /// Whether no one-sided point pulls by more than a force, or overlaps by more than its length.
    pub(super) fn push_and_open(
        &self,
        reaction: &[f64],
        gap: &[f64],
        force: f64,
        length: impl Fn(usize) -> f64,
    ) -> bool {
        let mut one_sided = (0..reaction.len()).filter(|&i| self.constraints.two_sided.get(i) != Some(&true));
        one_sided.all(|i| reaction[i] >= -force * self.lever(i) && gap[i] >= -length(i))
    }
}
