//! Solution of a contact problem for a fixed contact state.

use super::backend::Backend;
use super::error::SolveError;
use super::kkt::{Condensed, Factored, Kkt};
use super::load::Load;
use super::problem::ContactProblem;
use super::refine::refine;
use super::residual::Residual;
use super::solution::ContactSolution;
use super::tolerances;

/// Makes the solver of the linear equations of a fixed contact state that belongs to the backend of the problem.
pub(super) fn kkt(problem: &ContactProblem) -> Box<dyn Kkt + '_> {
    match &problem.backend {
        Backend::Condensed { interface, .. } => Box::new(Condensed::new(problem, interface)),
        Backend::Penalised(augmentation) | Backend::SaddlePoint(augmentation) => {
            Box::new(Factored::new(problem, augmentation, None, tolerances::newton::STIFFEST, None))
        }
    }
}

/// Solves one load on the contact state `pieces` (m,), starting from the solution `start` if it is given. Points of the
/// result may be beyond the bounds of their pieces of the laws. Forces far below `least` count as rounding.
pub(super) fn solve_on(
    problem: &ContactProblem,
    kkt: &mut dyn Kkt,
    load: &Load,
    pieces: &[u8],
    start: Option<&ContactSolution>,
    least: f64,
) -> Result<ContactSolution, SolveError> {
    let mut solution = problem.at_rest(load.held_value);
    if let Some(start) = start {
        solution.displacement.clone_from(&start.displacement);
        solution.reaction.clone_from(&start.reaction);
    }
    if !kkt.prepare(pieces)? {
        return Err(SolveError::Unsolved);
    }
    solution.put_on(&problem.points, pieces.to_vec());
    let residual = Residual::of(problem, load.nodal, &solution);
    let last = refine(problem, load.nodal, least, kkt, residual, &mut solution)?.ok_or(SolveError::Unsolved)?;
    solution.measure_gaps(&problem.points, &last);
    solution.require_solved(problem, load.nodal, &last, least)
}
