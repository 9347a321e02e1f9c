//! A contact set that is given: the equations are linear, and points may pull or overlap.

use super::interface::Interface;
use super::penalized::Penalized;
use super::refinement::KktSolver;
use super::saddle::Regularized;
use crate::cholesky::FactorError;
use crate::contact::problem::{ContactProblem, Factored};
use crate::contact::solution::{ContactSolution, Outcome};
use crate::contact::tolerances;

/// How the equations of sets are solved, one after another.
#[derive(Default)]
pub(crate) struct OnSet {
    /// Whether by the uncondensed equations; without points of an active set.
    pub(crate) uncondensed: bool,
    /// Forces far below are rounding.
    pub(crate) least: f64,
    /// The factor that the last set of many points came to.
    pub(crate) own: Option<Factored>,
}

impl ContactProblem {
    /// Displacements, reactions and gaps under one load on a contact set that is given, signs as they come.
    pub fn solve_on(&self, load: &[f64], held_value: &[f64], closed: &[bool]) -> Result<ContactSolution, FactorError> {
        self.solve_on_set(load, held_value, closed, None, &mut OnSet::default())
    }

    /// As [`ContactProblem::solve_on`], beginning with an answer if there is one.
    pub(crate) fn solve_on_set(
        &self,
        load: &[f64],
        held_value: &[f64],
        closed: &[bool],
        start: Option<&ContactSolution>,
        how: &mut OnSet,
    ) -> Result<ContactSolution, FactorError> {
        let begun = start.is_some() || how.own.is_some();
        let (found, left) = self.refined_on(load, held_value, closed, start, how)?;
        if begun && left > tolerances::STALE {
            // Stiff springs may make a later factor less exact than the first one.
            let mut anew = OnSet { own: None, ..*how };
            let (again, less) = self.refined_on(load, held_value, closed, None, &mut anew)?;
            if less < left {
                *how = anew;
                return Ok(again);
            }
        }
        Ok(found)
    }

    /// The answer, and the length of what is left; infinite where there is none.
    fn refined_on(
        &self,
        load: &[f64],
        held_value: &[f64],
        closed: &[bool],
        start: Option<&ContactSolution>,
        how: &mut OnSet,
    ) -> Result<(ContactSolution, f64), FactorError> {
        let none = vec![0.0; closed.len()];
        let (reaction, gap, closed_in_place) = (none.clone(), none, self.in_place(closed));
        let mut solution = ContactSolution { reaction, gap, closed: closed_in_place, ..self.at_rest(held_value) };
        if let Some(start) = start {
            solution.displacement = start.displacement.clone();
            solution.reaction = self.in_place(&start.reaction);
            self.release_open(&mut solution);
        }
        let step = self.residual(load, &solution);
        let mut refine = |solver: &mut dyn KktSolver| self.refine(load, how.least, solver, step.clone(), &mut solution);
        let left = if how.uncondensed {
            let regularized = Regularized::of(self, tolerances::proximal::COMPLIANCE);
            regularized.on(closed)?.map(|mut on| refine(&mut on)).transpose()?
        } else if self.active.is_empty() {
            let with = &self.base;
            let state = with.condensed.state(closed.to_vec())?;
            let interface = state.as_ref().map(|state| Interface { problem: self, with, state, reduced: None });
            interface.map(|mut interface| refine(&mut interface)).transpose()?
        } else {
            let given = how.own.take();
            let penalized = Penalized::of(self, given.as_ref().unwrap_or(&self.base), &self.in_place(closed))?;
            let (left, own) = match penalized {
                Some(mut penalized) => (Some(refine(&mut penalized)?), penalized.factor.own),
                None => (None, None),
            };
            how.own = own.or(given);
            left
        };
        let Some(left) = left.flatten() else {
            return Ok((self.solution_in_order(solution).failed(Outcome::Unsolved), f64::INFINITY));
        };
        solution.leave_open(&left.remaining);
        let length = self.length(load, &left, &solution, how.least);
        let satisfied = self.satisfies(load, &left, &solution, how.least);
        let found = self.solution_in_order(solution);
        Ok(if satisfied { (found.solved(), length) } else { (found.failed(Outcome::Unsolved), f64::INFINITY) })
    }
}
