//! From a load to displacements, reactions and gaps.

use super::condense::{Form, PosedLcp};
use super::kkt::{Interface, Reduced};
use super::problem::ContactProblem;
use super::solution::{ContactSolution, Outcome, Progress, pivoting};
use super::start::{Reference, Start};
use crate::cholesky::FactorError;
use crate::contact::tolerances;
use crate::lcp::{Lcp, LcpStatus, LemkeOptions, lemke_watched};

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
        max_pivots: Option<usize>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        self.solve_beginning(load, held_value, form, max_pivots, None, watch)
    }

    /// As [`ContactProblem::solve`], beginning with the contact set, and for an active set with the displacement and the
    /// reactions, of an answer.
    pub(super) fn solve_from(
        &self,
        load: &[f64],
        held_value: &[f64],
        start: &Start<'_>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        self.solve_beginning(load, held_value, None, None, Some(start), watch)
    }

    /// As [`ContactProblem::solve`], beginning with the solution of another load.
    pub fn solve_near(
        &self,
        reference: &Reference,
        load: &[f64],
        held_value: &[f64],
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        self.solve_from(load, held_value, &reference.start(), watch)
    }

    fn solve_beginning(
        &self,
        load: &[f64],
        held_value: &[f64],
        form: Option<Form>,
        max_pivots: Option<usize>,
        start: Option<&Start<'_>>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        if !self.active.is_empty() {
            return self.solve_active(load, held_value, start, watch);
        }
        let with = &self.base;
        let form = form.unwrap_or(with.condensed.better_form());
        let mut solution = self.at_rest(held_value);
        let mut first = start.map(|start| start.closed);
        let mut step = self.residual(load, &solution);
        let mut reduced = self.reduced(with, &step, form)?;
        let travel = reduced.interface.displacement.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        for _ in 0..STATES {
            let (outcome, closed) = self.contact_state(&reduced, &mut solution, form, max_pivots, first.take(), watch);
            if outcome != Outcome::Solved {
                return Ok(solution.failed(outcome));
            }
            let settled = closed == solution.closed && solution.corrections > 0;
            solution.closed = closed;
            if !settled {
                let Some(state) = self.base.condensed.state(solution.closed.clone()) else {
                    return Ok(solution.failed(Outcome::Unsolved));
                };
                if self.release_open(&mut solution) {
                    step = self.residual(load, &solution);
                    reduced = self.reduced(with, &step, form)?;
                }
                let with = &self.base;
                let mut interface = Interface { problem: self, with, state: &state, reduced: Some(reduced) };
                let Some(left) = self.refine(load, 0.0, &mut interface, step, &mut solution)? else {
                    return Ok(solution.failed(Outcome::Unsolved));
                };
                step = left;
            }
            solution.leave_open(&step.remaining);
            if settled || self.signs_hold(load, tolerances::RESIDUAL * travel, &solution) {
                return Ok(solution.solved());
            }
            reduced = self.reduced(with, &step, form)?;
        }
        Ok(solution.failed(Outcome::Unsolved))
    }

    /// The LCP that [`ContactProblem::solve`] poses first.
    pub fn lcp(&self, load: &[f64], held_value: &[f64], form: Option<Form>) -> Result<PosedLcp, FactorError> {
        let rest = self.at_rest(held_value);
        let form = form.unwrap_or(self.base.condensed.better_form());
        let reduced = self.reduced(&self.base, &self.residual(load, &rest), form)?;
        Ok(self.base.condensed.lcp(form, &reduced.interface, &rest.reaction))
    }

    /// Poses the LCP from where the solution stands and solves it, beginning with a contact set if there is one.
    pub(super) fn contact_state(
        &self,
        reduced: &Reduced,
        solution: &mut ContactSolution,
        form: Form,
        max_pivots: Option<usize>,
        first: Option<&[bool]>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> (Outcome, Vec<bool>) {
        if self.constraints.two_sided.iter().all(|&t| t) {
            return (Outcome::Solved, self.constraints.two_sided.clone());
        }
        let posed = self.base.condensed.lcp(form, &reduced.interface, &solution.reaction);
        let covering = self.covering(&posed.point, &posed.gap_is_z);
        let options = LemkeOptions { covering: Some(&covering), max_pivots };
        let basis = first.map(|closed| self.base.condensed.basis(&posed, closed));
        let solved = Lcp::new(&posed.matrix, &posed.q)
            .and_then(|lcp| lemke_watched(&lcp, &options, basis.as_deref(), &mut pivoting(watch)));
        let Ok(found) = solved else {
            return (Outcome::Unsolved, Vec::new());
        };
        solution.pivots += found.pivots;
        match found.status {
            LcpStatus::Solved => (Outcome::Solved, self.base.condensed.closed_points(&posed, &found.basis)),
            LcpStatus::Ray => (Outcome::NoEquilibrium, Vec::new()),
            LcpStatus::PivotLimit => (Outcome::Unsolved, Vec::new()),
            LcpStatus::Interrupted => (Outcome::Interrupted, Vec::new()),
        }
    }

    /// A covering vector (k,) for rows of the points, of which w is the reaction where z is the gap: a force and the length
    /// by which it bends the plate, so that Lemke's path does not depend on units.
    pub(super) fn covering(&self, points: &[usize], gap_is_z: &[bool]) -> Vec<f64> {
        let power_of_two = |x: f64| x.log2().round().exp2();
        let root = power_of_two(self.scale.stiffness.sqrt());
        let rows = points.iter().zip(gap_is_z);
        rows.map(|(&i, gap_is_z)| {
            let lever = power_of_two(self.lever(i));
            if *gap_is_z { root * lever } else { 1.0 / (root * lever) }
        })
        .collect()
    }

    /// Whether no reaction pulls and no gap is negative, points in the problem's order; lengths up to `nil` are none.
    pub(super) fn signs_hold(&self, load: &[f64], nil: f64, solution: &ContactSolution) -> bool {
        let c = &self.constraints;
        let largest = |values: &[f64]| values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        // Without a load, reactions are what the plate's stiffness makes of gaps.
        let load = match self.scale.largest(load) {
            0.0 => largest(&c.regularization) * largest(&c.distance),
            load => load,
        };
        let force = tolerances::SIGN * self.largest_force(&[], &solution.reaction).max(load);
        let length = self.lengths(solution);
        let pushes = |i: usize| solution.reaction[i] >= -force * self.lever(i);
        let opens = |i: usize| solution.gap[i] >= -(tolerances::SIGN * length[i]).max(nil / self.lever(i));
        let mut one_sided = (0..solution.reaction.len()).filter(|&i| c.two_sided.get(i) != Some(&true));
        one_sided.all(|i| pushes(i) && opens(i))
    }
}
