//! Points in any number: a semismooth Newton method on the sparse K (a primal–dual active set; Hintermüller, Ito & Kunisch
//! 2002), inside the method of multipliers (Rockafellar 1976) where supports are rigid or nearly so.
//!
//! It cannot cycle: for given multipliers the energy is convex and continuously differentiable, every Newton direction
//! is followed by an exact line search on it, and the multipliers are a proximal point iteration on the dual. Rigid
//! points begin on springs that bend the plate over many elements, and stiffen from stage to stage.
//! One factor preconditions every direction; only where the pieces turn out to be quite others are they factored anew.

mod descent;
mod drift;
mod line_search;
mod newton;
mod together;

pub(in crate::contact) use together::solve_together;

use super::finder::{SetFinder, signs_hold};
use crate::cholesky::FactorError;
use crate::contact::kkt::{Afloat, BEFORE_A_FACTOR, Factored};
use crate::contact::problem::ContactProblem;
use crate::contact::residual::Residual;
use crate::contact::solution::{ContactSolution, Outcome, Watch};
use crate::contact::system::System;
use crate::contact::tolerances;
use descent::Descent;
use newton::{Newton, Next};
use std::sync::Arc;

/// Newton's method, from rest or from another load's solution.
pub(in crate::contact) struct ActiveSet;

impl SetFinder for ActiveSet {
    fn find(
        &self,
        problem: &ContactProblem,
        load: &[f64],
        held_value: &[f64],
        start: Option<&ContactSolution>,
        watch: &mut Watch<'_>,
    ) -> Result<ContactSolution, FactorError> {
        let mut newton = begun(problem, load, held_value, start, false)?;
        let Next::End(outcome) = newton.go_on(None, watch)? else { unreachable!("the factor is not shared") };
        let fell_short = newton.fell_short;
        let solution = newton.ended(outcome);
        if !fell_short {
            return Ok(solution);
        }
        let exact = problem.solve_on(load, held_value, &solution.piece)?;
        if exact.outcome != Outcome::Solved || !signs_hold(problem, load, 0.0, &exact) {
            return Ok(solution);
        }
        let corrections = solution.corrections + exact.corrections;
        let ContactSolution { displacement, reaction, gap, .. } = exact;
        Ok(ContactSolution { displacement, reaction, gap, corrections, ..solution })
    }
}

/// Newton's method at its start, on a factor that others may share.
fn begun<'a>(
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
        if !shares && spent >= BEFORE_A_FACTOR {
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
fn system_of<'a>(problem: &ContactProblem, start: &'a ContactSolution) -> Option<&'a Arc<System>> {
    start.system.as_ref().filter(|system| Arc::ptr_eq(&system.blueprint, &problem.blueprint))
}

/// Solves one load and factors its pieces, for others to begin with; `None` where there is no solution, or they do not
/// hold the plate.
pub(in crate::contact) fn solved_and_factored(
    problem: &ContactProblem,
    load: &[f64],
    held_value: &[f64],
    watch: &mut Watch<'_>,
) -> Result<Option<ContactSolution>, FactorError> {
    let solution = ActiveSet.find(problem, load, held_value, None, watch)?;
    if solution.outcome != Outcome::Solved {
        return Ok(None);
    }
    let series = problem.series(tolerances::newton::STIFFEST);
    let slope = |i: usize| problem.points.piece(i, solution.piece[i]).in_series(series[i]);
    match problem.factored((0..series.len()).map(slope).collect()) {
        Ok(system) => Ok(Some(ContactSolution { system: Some(Arc::new(system)), spent: 0, ..solution })),
        Err(FactorError::NotPositiveDefinite { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}
