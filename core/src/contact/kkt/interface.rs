//! A set's equations condensed onto the contact points: one forward and one backward substitution a correction.

use super::refinement::{Correction, KktSolver};
use super::residual::Residual;
use crate::cholesky::FactorError;
use crate::contact::condense::{ContactState, Form, InterfaceResidual};
use crate::contact::problem::{ContactProblem, Factored};

/// An imbalance after forward substitution, and what it does at the contact points.
pub(crate) struct Reduced {
    forward: Vec<f64>,
    pub(crate) interface: InterfaceResidual,
}

/// The factor and one contact state of its condensed points.
pub(crate) struct Interface<'a> {
    pub(crate) problem: &'a ContactProblem,
    pub(crate) with: &'a Factored,
    pub(crate) state: &'a ContactState,
    /// The first residual, if it has been reduced before.
    pub(crate) reduced: Option<Reduced>,
}

impl KktSolver for Interface<'_> {
    fn correction(&mut self, step: &Residual) -> Result<Option<Correction>, FactorError> {
        let reduced = match self.reduced.take() {
            Some(reduced) => reduced,
            None => {
                let form = self.with.condensed.better_form();
                self.problem.reduced(self.with, &step.imbalance, &step.remaining, form)?
            }
        };
        self.problem.respond(self.with, self.state, reduced).map(Some)
    }
}

impl ContactProblem {
    pub(crate) fn reduced(
        &self,
        with: &Factored,
        imbalance: &[f64],
        remaining: &[f64],
        form: Form,
    ) -> Result<Reduced, FactorError> {
        let mut forward = self.gather(imbalance);
        with.forward(&mut forward)?;
        let interface = with.condensed.interface(form, &forward, remaining)?;
        Ok(Reduced { forward, interface })
    }

    /// Motion of the plate and increments of the reactions in one contact state.
    pub(super) fn respond(
        &self,
        with: &Factored,
        state: &ContactState,
        reduced: Reduced,
    ) -> Result<Correction, FactorError> {
        let Reduced { mut forward, interface } = reduced;
        let mut reaction = Vec::new();
        if !with.condensed.is_empty() {
            let response = with.condensed.solve_state(state, &interface)?;
            match &with.condensed.stiffness {
                Some(stiffness) => stiffness.prescribe(&response.moved, &mut forward),
                None => {
                    let carried = with.condensed.regularization.iter().zip(&response.moved).map(|(d, y)| d * y);
                    let push: Vec<f64> = carried.zip(&response.reaction).map(|(c, r)| c - r).collect();
                    with.push(&push, &mut forward)?;
                }
            }
            reaction = response.reaction;
        }
        with.backward(&mut forward)?;
        Ok(Correction::of(self.scatter(&forward), reaction))
    }
}
