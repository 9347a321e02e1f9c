//! What looks for the pieces of a load, where it begins, and whether points are on their pieces.

use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::{largest_force, lengths};
use crate::contact::scale::largest;
use crate::contact::solution::{ContactSolution, Watch};
use crate::contact::tolerances;

/// Where to begin: at a solution, with its factor if it has one of this problem.
pub(in crate::contact) struct Start<'a> {
    pub(in crate::contact) solution: &'a ContactSolution,
    /// Where the solution is known to balance a load.
    pub(in crate::contact) reference: Option<&'a Reference>,
}

/// One load's solution with the factor of its pieces, for loads not unlike it to begin with.
pub struct Reference {
    pub solution: ContactSolution,
    pub(super) load: Vec<f64>,
    /// How far the points have travelled beyond their shifts in it.
    pub(super) travel: Vec<f64>,
}

/// Looks for the pieces of one load, and solves on them.
pub(in crate::contact) trait SetFinder {
    /// The solution under a nodal load with the held dofs at `held_value`, both over all dofs; `watch` sees every step.
    fn find(
        &self,
        problem: &ContactProblem,
        load: &[f64],
        held_value: &[f64],
        start: Option<&Start<'_>>,
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
    // Without a load, reactions are what the plate's stiffness makes of gaps.
    let load = match problem.scale.largest(load) {
        0.0 => largest(&problem.delta) * largest(&problem.points.shift),
        load => load,
    };
    let force = tolerances::SIGN * largest_force(problem, &[], &solution.reaction).max(load);
    let lengths = lengths(problem, solution);
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
            true => (reaction[i], 1, force * points.arm[i]),
            false => (piece.travel - gap[i], 0, length(i)),
        };
        let above = low.is_none_or(|end| value >= end[axis] - allowed);
        above && high.is_none_or(|end| value <= end[axis] + allowed)
    })
}
