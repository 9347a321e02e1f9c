//! A set's equations with nothing eliminated, for where rounding decides.

use super::floating::{Held, after_rigid};
use super::refinement::{Correction, KktSolver};
use super::residual::Residual;
use super::saddle::{Regularized, Saddle};
use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::rigid::rigid_part;
use crate::contact::solution::ContactSolution;

/// The saddle-point equations of one contact set.
pub(crate) struct Uncondensed<'a> {
    problem: &'a ContactProblem,
    saddle: Saddle,
    held: Option<Held>,
}

impl<'a> Regularized<'a> {
    /// `None` if the equations are singular.
    pub(crate) fn on(&self, closed: &[bool]) -> Result<Option<Uncondensed<'a>>, FactorError> {
        let Some(saddle) = Saddle::of(self, closed)? else { return Ok(None) };
        let held = Held::by(self.problem, &self.compliance, closed);
        Ok(Some(Uncondensed { problem: self.problem, saddle, held }))
    }
}

impl KktSolver for Uncondensed<'_> {
    /// Of a plate that no dof holds a rigid motion first, by its resultants where nothing holds it firmly, else by the
    /// equations, and in either case added exactly; then what the equations make of the rest.
    fn correction(
        &mut self,
        load: &[f64],
        step: &Residual,
        solution: &ContactSolution,
    ) -> Result<Option<Correction>, FactorError> {
        let problem = self.problem;
        let solved = |step: &Residual| self.saddle.response(problem, &step.imbalance, &step.remaining);
        let solver = |step: &Residual| Ok(Some(solved(step)));
        if let Some(held) = &self.held {
            return after_rigid(problem, load, held.response(step), solution, solver);
        }
        let found = solved(step);
        if problem.held.contains(&true) {
            return Ok(Some(found));
        }
        let rigid = rigid_part(&problem.plate, &problem.scale, &found.nodal);
        let rigid = Correction { rigid, nodal: vec![0.0; found.nodal.len()], ..found };
        after_rigid(problem, load, rigid, solution, solver)
    }
}
