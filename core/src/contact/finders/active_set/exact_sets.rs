//! Exact solutions for one fixed contact state after another. All points beyond the bounds of their pieces of the laws
//! change to the adjacent pieces at once, as long as the number of such points falls (Júdice & Pires 1994).

use crate::contact::error::SolveError;
use crate::contact::finders::feasibility::beyond_rounding;
use crate::contact::fixed_state::solve_on;
use crate::contact::kkt::Factored;
use crate::contact::load::Load;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::least_length;
use crate::contact::solution::{ContactSolution, Progress, Watch};
use crate::contact::tolerances;

/// Solves on the contact state of `start`, then on the states in which points beyond their pieces of the laws have
/// changed to the adjacent pieces. `None` if the number of such points stops falling before it is zero.
pub(super) fn exact_sets(
    problem: &ContactProblem,
    kkt: &mut Factored<'_>,
    load: &Load,
    start: &ContactSolution,
    watch: &mut Watch<'_>,
) -> Result<Option<ContactSolution>, SolveError> {
    let least_length = tolerances::SIGN * least_length(problem, load.nodal);
    let (mut pieces, mut fewest, mut corrections) = (start.piece.clone(), usize::MAX, 0);
    for step in start.iterations.. {
        let solution = match solve_on(problem, kkt, load, &pieces, Some(start), 0.0) {
            Err(error) if error.is_of_load() => break,
            solution => solution?,
        };
        corrections += solution.corrections;
        let beyond = beyond_rounding(problem, load.nodal, least_length, &solution);
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
