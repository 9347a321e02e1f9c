//! Whether all points are within the bounds of their pieces.

use crate::contact::backend::Backend;
use crate::contact::points::PointState;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::{largest_force, lengths};
use crate::contact::scale::largest;
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;

/// Whether every point is within the bounds of its piece, up to rounding; lengths up to `least_length` count as zero.
pub(in crate::contact) fn signs_are_feasible(
    problem: &ContactProblem,
    load: &[f64],
    least_length: f64,
    solution: &ContactSolution,
) -> bool {
    let lengths = lengths(problem, solution);
    // Without load, the reference force is the stiffness times the displacement.
    let stiffness = match &problem.backend {
        Backend::Condensed { interface, .. } => largest(&interface.delta).max(problem.scale.stiffness),
        Backend::Penalised(_) | Backend::SaddlePoint(_) => problem.scale.stiffness,
    };
    let load = match problem.scale.largest(load) {
        0.0 => stiffness * largest(&lengths),
        load => load,
    };
    let force = tolerances::SIGN * largest_force(problem, &[], &solution.reaction).max(load);
    let length = |i: usize| (tolerances::SIGN * lengths[i]).max(least_length / problem.points.arm[i]);
    is_feasible(problem, |i| solution.state(i), force, length)
}

/// Whether no point exceeds the bounds of its piece by more than a force, or by more than its length.
pub(in crate::contact) fn is_feasible(
    problem: &ContactProblem,
    state: impl Fn(usize) -> PointState,
    force: f64,
    length: impl Fn(usize) -> f64,
) -> bool {
    let points = &problem.points;
    (0..points.len()).all(|i| {
        let (state, length) = (state(i), length(i));
        let piece = points.piece(i, state.piece);
        // For a soft spring the tolerance of travel is the stricter one.
        let allowed = if piece.holds() { (force * points.arm[i]).min(length * piece.slope) } else { length };
        let is_inside = |is_upper| points.signed_distance(i, state, is_upper).is_none_or(|inside| inside >= -allowed);
        is_inside(false) && is_inside(true)
    })
}
