//! A set's equations with nothing eliminated, for where rounding decides.

use super::floating::Held;
use super::refinement::{Correction, KktSolver};
use super::residual::Residual;
use super::saddle::{Regularized, Saddle};
use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::rigid::rigid_part;

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
    fn correction(&mut self, step: &Residual) -> Result<Option<Correction>, FactorError> {
        Ok(Some(self.saddle.response(self.problem, &step.imbalance, &step.remaining)))
    }

    /// By its resultants where nothing holds the plate firmly, else by the equations.
    fn rigid(&self, step: &Residual) -> Option<Correction> {
        let problem = self.problem;
        if let Some(held) = &self.held {
            return Some(held.response(step));
        }
        if problem.held.contains(&true) {
            return None;
        }
        let found = self.saddle.response(problem, &step.imbalance, &step.remaining);
        let rigid = rigid_part(&problem.plate, &problem.scale, &found.nodal);
        Some(Correction { rigid, nodal: vec![0.0; found.nodal.len()], ..found })
    }
}
