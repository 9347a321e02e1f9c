//! Exact solutions on one contact state after another. All points beyond the bounds of their pieces are exchanged at
//! once, while their number falls (Júdice & Pires 1994).

use crate::cholesky::FactorError;
use crate::contact::finders::finder::points_beyond;
use crate::contact::kkt::Factored;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::least_length;
use crate::contact::solution::{ContactSolution, Outcome, Progress, Watch};
use crate::contact::tolerances;

/// Solves on the contact state of `start`, then on those that follow; `None` if the number of points beyond their
/// pieces stops falling above zero.
pub(super) fn exact_sets(
    problem: &ContactProblem,
    kkt: &mut Factored<'_>,
    load: &[f64],
    held_value: &[f64],
    start: &ContactSolution,
    watch: &mut Watch<'_>,
) -> Result<Option<ContactSolution>, FactorError> {
    let least_length = tolerances::SIGN * least_length(problem, load);
    let (mut pieces, mut fewest, mut corrections) = (start.piece.clone(), usize::MAX, 0);
    for step in start.iterations.. {
        let solution = problem.solve_with(kkt, load, held_value, &pieces, Some(start), 0.0)?;
        corrections += solution.corrections;
        if solution.outcome != Outcome::Solved {
            break;
        }
        let beyond = points_beyond(problem, load, least_length, &solution);
        if beyond.is_empty() {
            return Ok(Some(ContactSolution { corrections, ..solution }));
        }
        if beyond.len() >= fewest || !watch(Progress { step, changing: beyond.len(), residual: 0.0 }) {
            break;
        }
        fewest = beyond.len();
        beyond.into_iter().for_each(|(i, piece)| pieces[i] = piece);
    }
    Ok(None)
}
