//! Solver of a fixed contact state on the condensed plate: each solve takes one forward and one backward substitution.

use super::coarse::CoarseSolver;
use super::solver::{Correction, Kkt};
use crate::cholesky::FactorError;
use crate::contact::interface::{Interface, OnPieces, ReducedLoad};
use crate::contact::problem::ContactProblem;
use crate::contact::residual::Residual;

/// The condensed equations of one contact state.
pub(in crate::contact) struct Condensed<'a> {
    problem: &'a ContactProblem,
    interface: &'a Interface,
    on: Option<OnPieces>,
    /// Solver for the rigid motions of plates that only springs hold; `None` if there are contact points.
    coarse: Option<CoarseSolver<'a>>,
    /// The condensed residual for the next solve; `None` if it must be computed.
    pub(in crate::contact) reduced: Option<ReducedLoad>,
}

impl<'a> Condensed<'a> {
    pub(in crate::contact) fn new(problem: &'a ContactProblem, interface: &'a Interface) -> Self {
        let coarse = if problem.points.is_empty() { CoarseSolver::by(problem, Vec::new()) } else { None };
        Self { problem, interface, on: None, coarse, reduced: None }
    }
}

impl Kkt for Condensed<'_> {
    fn prepare(&mut self, pieces: &[u8]) -> Result<bool, FactorError> {
        self.on = self.interface.on_pieces(&self.problem.points, pieces)?;
        Ok(self.on.is_some())
    }

    fn solve(&mut self, right: &Residual) -> Result<Option<Correction>, FactorError> {
        let Some(on) = &self.on else { return Ok(None) };
        let interface = self.interface;
        let ReducedLoad { mut forward, rhs } = match self.reduced.take() {
            Some(reduced) => reduced,
            None => self.problem.reduced(interface, right, interface.better_form())?,
        };
        let mut reaction = Vec::new();
        if interface.len() > 0 {
            let response = interface.solve_on(on, &rhs)?;
            interface.follow(&response, &mut forward)?;
            reaction = response.reaction;
        }
        self.problem.base.factor.backward(&mut forward)?;
        let nodal = self.problem.pattern.scatter(&forward, self.problem.plate.dof_count());
        Ok(Some(Correction::of(nodal, reaction)))
    }

    fn rigid(&self, right: &Residual) -> Option<Correction> {
        self.coarse.as_ref().map(|coarse| coarse.response(right))
    }
}
