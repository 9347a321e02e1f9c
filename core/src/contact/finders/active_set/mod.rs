//! Semismooth Newton method on the sparse K for any number of points (a primal–dual active set; Hintermüller, Ito &
//! Kunisch 2002), inside the method of multipliers (Rockafellar 1976) for rigid or nearly rigid supports.
//!
//! It cannot cycle: for given multipliers the energy is convex and continuously differentiable, each Newton direction
//! is followed by a line search, and the multiplier updates are a proximal point iteration on the dual problem. With
//! the first penalty the plate bends over many elements; the penalty grows from stage to stage. One factor
//! preconditions every direction; a new factor is made when the contact state has changed much.

mod batch;
mod coarse_correction;
mod exact_sets;
mod iterate;
mod line_search;
mod newton;

pub(in crate::contact) use batch::solve_together;

use super::feasibility::beyond_rounding;
use crate::cholesky::FactorError;
use crate::contact::backend::Augmentation;
use crate::contact::error::SolveError;
use crate::contact::fixed_state::{kkt, solve_on};
use crate::contact::kkt::alone;
use crate::contact::load::Load;
use crate::contact::problem::ContactProblem;
use crate::contact::solution::{ContactSolution, Watch};
use crate::contact::tolerances;
use newton::{Start, newton};
use std::sync::Arc;

/// Solves one load by the Newton method, from rest or from the solution of another load.
pub(in crate::contact) fn by_active_set(
    problem: &ContactProblem,
    augmentation: &Augmentation,
    load: &Load,
    start: Option<&ContactSolution>,
    watch: &mut Watch<'_>,
) -> Result<ContactSolution, SolveError> {
    let start = Start { problem, augmentation, load: *load, solution: start, shared: None };
    let (solution, fell_short) = alone(newton(start, watch))?;
    if !fell_short {
        return Ok(solution);
    }
    let exact = match solve_on(problem, &mut *kkt(problem), load, &solution.piece, None, 0.0) {
        Ok(exact) if beyond_rounding(problem, load.nodal, 0.0, &exact).is_empty() => exact,
        Err(error) if !error.is_of_load() => return Err(error),
        _ => return Ok(solution),
    };
    let corrections = solution.corrections + exact.corrections;
    let ContactSolution { displacement, reaction, gap, .. } = exact;
    Ok(ContactSolution { displacement, reaction, gap, corrections, ..solution })
}

/// Solves one load and factors K with the springs of its contact state, for warm starts of other loads. `None` if this
/// contact state leaves a rigid motion free.
pub(in crate::contact) fn solved_and_factored(
    problem: &ContactProblem,
    augmentation: &Augmentation,
    load: &Load,
    watch: &mut Watch<'_>,
) -> Result<Option<ContactSolution>, SolveError> {
    let solution = by_active_set(problem, augmentation, load, None, watch)?;
    let piece = |i: usize| problem.points.piece(i, solution.piece[i]);
    match problem.factored(augmentation.slopes(&problem.points, piece, tolerances::newton::STIFFEST)) {
        Ok(system) => Ok(Some(ContactSolution { system: Some(Arc::new(system)), spent: 0, ..solution })),
        Err(FactorError::NotPositiveDefinite { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}
