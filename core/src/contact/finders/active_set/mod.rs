//! Semismooth Newton method on the sparse K for any number of points (a primal–dual active set; Hintermüller, Ito &
//! Kunisch 2002), inside the method of multipliers (Rockafellar 1976) for rigid or nearly rigid supports.
//!
//! It cannot cycle: for given multipliers the energy is convex and continuously differentiable, each Newton direction
//! is followed by a line search, and the multiplier updates are a proximal point iteration on the dual. Rigid points
//! start with springs that bend the plate over many elements; the penalty grows from stage to stage. One factor
//! preconditions every direction; a new one is made where the contact state has changed much.

mod batch;
mod coarse_correction;
mod exact_sets;
mod iterate;
mod line_search;
mod newton;
mod start;

pub(in crate::contact) use batch::solve_together;

use super::finder::{SetFinder, signs_are_feasible};
use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::solution::{ContactSolution, Outcome, Watch};
use crate::contact::tolerances;
use exact_sets::exact_sets;
use newton::Next;
use start::new_newton;
use std::sync::Arc;

/// The Newton method, from rest or from the solution of another load.
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
        let mut newton = new_newton(problem, load, held_value, start, false)?;
        let outcome = loop {
            match newton.go_on(None, watch)? {
                Next::Solve(_) => unreachable!("the factor is not shared"),
                Next::Settled => {
                    let start = newton.offer();
                    let exact = exact_sets(problem, &mut newton.iterate.kkt, load, held_value, &start, watch)?;
                    let Some(ContactSolution { displacement, reaction, gap, piece, corrections, .. }) = exact else {
                        continue;
                    };
                    let solution = newton.ended(Outcome::Solved);
                    return Ok(ContactSolution { displacement, reaction, gap, piece, corrections, ..solution });
                }
                Next::End(outcome) => break outcome,
            }
        };
        let fell_short = newton.fell_short;
        let solution = newton.ended(outcome);
        if !fell_short {
            return Ok(solution);
        }
        let exact = problem.solve_on(load, held_value, &solution.piece)?;
        if exact.outcome != Outcome::Solved || !signs_are_feasible(problem, load, 0.0, &exact) {
            return Ok(solution);
        }
        let corrections = solution.corrections + exact.corrections;
        let ContactSolution { displacement, reaction, gap, .. } = exact;
        Ok(ContactSolution { displacement, reaction, gap, corrections, ..solution })
    }
}

/// Solves one load and factors its contact state, for warm starts; `None` where there is no solution, or where the
/// state does not hold the plate.
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
