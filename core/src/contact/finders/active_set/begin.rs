//! How Newton's method begins: at rest, or at the solution under another load.

use super::descent::Descent;
use super::newton::Newton;
use crate::cholesky::FactorError;
use crate::contact::kkt::{Afloat, BEFORE_A_FACTOR, Factored};
use crate::contact::problem::ContactProblem;
use crate::contact::residual::Residual;
use crate::contact::solution::ContactSolution;
use crate::contact::system::System;
use crate::contact::tolerances;
use std::sync::Arc;

/// Newton's method at its start, on a factor that others may share.
pub(super) fn begun<'a>(
    problem: &'a ContactProblem,
    load: &'a [f64],
    held_value: &[f64],
    start: Option<&'a ContactSolution>,
    shares: bool,
) -> Result<Newton<'a>, FactorError> {
    let limit = if start.is_some() { tolerances::newton::STIFFEST } else { problem.first_limit };
    let mut kkt = Factored::new(problem, start.and_then(|start| system_of(problem, start)), limit, shares);
    let mut solution = problem.at_rest(held_value);
    let mut multiplier = vec![0.0; problem.points.len()];
    let mut spent = 0;
    if let Some(start) = start {
        solution.displacement.clone_from(&start.displacement);
        multiplier.copy_from_slice(&start.reaction);
        spent = start.spent;
        // A factor that has the springs of these pieces is not made twice.
        if !shares && spent >= BEFORE_A_FACTOR && !kkt.differing(&start.piece).is_empty() {
            kkt.refactor(&start.piece)?;
        }
    }
    let mut descent = Descent {
        problem,
        load,
        kkt,
        solution,
        stretch: vec![0.0; multiplier.len()],
        multiplier,
        residual: Residual::default(),
        afloat: Afloat::under(problem, load),
        rounding: None,
        spent,
    };
    descent.balance();
    Ok(Newton::new(descent, start.is_some(), held_value))
}

/// The factor that a start has for a problem.
pub(super) fn system_of<'a>(problem: &ContactProblem, start: &'a ContactSolution) -> Option<&'a Arc<System>> {
    start.system.as_ref().filter(|system| Arc::ptr_eq(&system.blueprint, &problem.blueprint))
}
