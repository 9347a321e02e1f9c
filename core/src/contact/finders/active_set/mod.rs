//! Points in any number: a semismooth Newton method on the sparse K (a primal–dual active set; Hintermüller, Ito & Kunisch
//! 2002), inside the method of multipliers (Rockafellar 1976) where supports are rigid or nearly so.
//!
//! It cannot cycle: for given multipliers the energy is convex and continuously differentiable, every Newton direction
//! is followed by an exact line search on it, and the multipliers are a proximal point iteration on the dual. Rigid
//! points begin on springs that bend the plate over many elements, and stiffen from stage to stage.
//! One factor preconditions every direction; only where the pieces turn out to be quite others are they factored anew.

mod begin;
mod descent;
mod drift;
mod line_search;
mod newton;
mod together;

pub(in crate::contact) use together::solve_together;

use super::finder::{SetFinder, signs_hold};
use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::solution::{ContactSolution, Outcome, Watch};
use crate::contact::tolerances;
use begin::begun;
use newton::Next;
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
