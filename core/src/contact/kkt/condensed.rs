//! Everything but the points is eliminated: one forward and one backward substitution a solve.

use super::floating::Held;
use super::solver::{Correction, Kkt};
use crate::cholesky::FactorError;
use crate::contact::interface::{OnPieces, Reduced};
use crate::contact::problem::ContactProblem;
use crate::contact::residual::Residual;

/// The factor, and the equations of its points on pieces.
pub(in crate::contact) struct Condensed<'a> {
    problem: &'a ContactProblem,
    on: Option<OnPieces>,
    /// Where springs alone hold the plate.
    held: Option<Held<'a>>,
    /// The next residual, if it has been reduced before.
    pub(in crate::contact) reduced: Option<Reduced>,
}

impl<'a> Condensed<'a> {
    pub(in crate::contact) fn new(problem: &'a ContactProblem) -> Self {
        let held = if problem.points.is_empty() { Held::by(problem, Vec::new()) } else { None };
        Self { problem, on: None, held, reduced: None }
    }
}

impl Kkt for Condensed<'_> {
    fn prepare(&mut self, pieces: &[u8]) -> Result<bool, FactorError> {
        self.on = self.problem.interface().on_pieces(&self.problem.points, pieces)?;
        Ok(self.on.is_some())
    }

    fn solve(&mut self, right: &Residual) -> Result<Option<Correction>, FactorError> {
        let Some(on) = &self.on else { return Ok(None) };
        let interface = self.problem.interface();
        let Reduced { mut forward, at_points } = match self.reduced.take() {
            Some(reduced) => reduced,
            None => self.problem.reduced(right, interface.better_form())?,
        };
        let mut reaction = Vec::new();
        if interface.len() > 0 {
            let response = interface.solve_on(on, &at_points)?;
            interface.follow(&response, &mut forward)?;
            reaction = response.reaction;
        }
        self.problem.base.factor.backward(&mut forward)?;
        let nodal = self.problem.blueprint.scatter(&forward, self.problem.plate.dof_count());
        Ok(Some(Correction::of(nodal, reaction)))
    }

    fn rigid(&self, right: &Residual) -> Option<Correction> {
        self.held.as_ref().map(|held| held.response(right))
    }
}
