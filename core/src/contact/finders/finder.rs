//! What looks for the pieces of a load, where it begins, and whether points are on their pieces.

use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::{largest_force, lengths};
use crate::contact::scale::largest;
use crate::contact::solution::{ContactSolution, Watch};
use crate::contact::tolerances;

/// Looks for the pieces of one load, and solves on them.
pub(in crate::contact) trait SetFinder {
    /// The solution under a nodal load with the held dofs at `held_value`, both over all dofs, from another load's on if there
    /// is one; `watch` sees every step.
    fn find(
        &self,
        problem: &ContactProblem,
        load: &[f64],
        held_value: &[f64],
        start: Option<&ContactSolution>,
        watch: &mut Watch<'_>,
    ) -> Result<ContactSolution, FactorError>;
}

/// Whether every point is on its piece but for rounding; lengths up to `nil` are none.
pub(in crate::contact) fn signs_hold(
    problem: &ContactProblem,
    load: &[f64],
    nil: f64,
    solution: &ContactSolution,
) -> bool {
    let lengths = lengths(problem, solution);
    // Without a load, reactions are what the plate's stiffness makes of how far it moves.
    let load = match problem.scale.largest(load) {
        0.0 => largest(&problem.delta).max(problem.scale.stiffness) * largest(&lengths),
        load => load,
    };
    let force = tolerances::SIGN * largest_force(problem, &[], &solution.reaction).max(load);
    let length = |i: usize| (tolerances::SIGN * lengths[i]).max(nil / problem.points.arm[i]);
    are_on_their_pieces(problem, &solution.piece, &solution.reaction, &solution.gap, force, length)
}

/// Whether no point is beyond an end of its piece by more than a force, or more than its length.
pub(in crate::contact) fn are_on_their_pieces(
    problem: &ContactProblem,
    pieces: &[u8],
    reaction: &[f64],
    gap: &[f64],
    force: f64,
    length: impl Fn(usize) -> f64,
) -> bool {
    let points = &problem.points;
    (0..points.len()).all(|i| {
        let piece = points.piece(i, pieces[i]);
        let [low, high] = points.ends(i, pieces[i]);
        let (value, axis, allowed) = match piece.holds() {
            // Of a soft spring a travel of rounding tells more than a force.
            true => (reaction[i], 1, (force * points.arm[i]).min(length(i) * piece.slope)),
            false => (piece.travel - gap[i], 0, length(i)),
        };
        let above = low.is_none_or(|end| value >= end[axis] - allowed);
        above && high.is_none_or(|end| value <= end[axis] + allowed)
    })
}
