//! Start of the Newton method: at rest, or at the solution of another load.

use super::iterate::NewtonIterate;
use super::newton::Newton;
use crate::cholesky::FactorError;
use crate::contact::backend::Augmentation;
use crate::contact::kkt::{BEFORE_A_FACTOR, CoarseLoad, Factored};
use crate::contact::load::Load;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::Residual;
use crate::contact::solution::ContactSolution;
use crate::contact::system::System;
use crate::contact::tolerances;
use std::sync::Arc;

/// Makes the Newton iteration of a load. If `shares`, several loads use the same factor.
pub(super) fn new_newton<'a>(
    problem: &'a ContactProblem,
    augmentation: &'a Augmentation,
    load: &Load<'a>,
    start: Option<&'a ContactSolution>,
    shares: bool,
) -> Result<Newton<'a>, FactorError> {
    let Load { nodal: load, held_value } = *load;
    let limit = if start.is_some() { tolerances::newton::STIFFEST } else { augmentation.first_penalty };
    let mut kkt =
        Factored::new(problem, augmentation, start.and_then(|start| system_of(problem, start)), limit, shares);
    let mut solution = problem.at_rest(held_value);
    let mut multiplier = vec![0.0; problem.points.len()];
    let mut spent = 0;
    if let Some(start) = start {
        solution.displacement.clone_from(&start.displacement);
        multiplier.copy_from_slice(&start.reaction);
        spent = start.spent;
        // A factor that already has the springs of these pieces is not made again.
        if !shares && spent >= BEFORE_A_FACTOR && !kkt.differing(&start.piece).is_empty() {
            kkt.refactor(&start.piece)?;
        }
    }
    let mut iterate = NewtonIterate {
        problem,
        load,
        kkt,
        solution,
        augmented_travel: vec![0.0; multiplier.len()],
        multiplier,
        residual: Residual::default(),
        coarse_load: CoarseLoad::under(problem, load),
        rounding: None,
        spent,
    };
    iterate.balance();
    Ok(Newton::new(iterate, start.is_some(), held_value))
}

/// The factor of a warm start, if it fits the problem.
pub(super) fn system_of<'a>(problem: &ContactProblem, start: &'a ContactSolution) -> Option<&'a Arc<System>> {
    start.system.as_ref().filter(|system| Arc::ptr_eq(&system.pattern, &problem.pattern))
}
