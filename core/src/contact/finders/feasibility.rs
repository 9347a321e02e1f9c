//! Finds contact points that are beyond an end of their present piece of the law.

use crate::contact::backend::Backend;
use crate::contact::points::PointState;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::{largest_force, lengths};
use crate::contact::scale::largest;
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;

/// The contact points that are beyond a bound of their piece of the law by more than rounding, each with the number of
/// the adjacent piece beyond this bound. Travels up to `least_length` count as zero.
pub(super) fn beyond_rounding(
    problem: &ContactProblem,
    load: &[f64],
    least_length: f64,
    solution: &ContactSolution,
) -> Vec<(usize, u8)> {
    let lengths = lengths(problem, solution);
    // Without load, the reference force is the largest stiffness times the largest reference travel.
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
    beyond(problem, |i| solution.state(i), force, length).collect()
}

/// The contact points that are beyond a bound of their piece of the law by more than `force`, or by more than
/// `length(i)` in travel. Each comes with the number of the adjacent piece beyond this bound.
pub(in crate::contact) fn beyond(
    problem: &ContactProblem,
    state: impl Fn(usize) -> PointState,
    force: f64,
    length: impl Fn(usize) -> f64,
) -> impl Iterator<Item = (usize, u8)> {
    let points = &problem.points;
    (0..points.len()).filter_map(move |i| {
        let (state, length) = (state(i), length(i));
        let piece = points.piece(i, state.piece);
        // For a soft spring, the tolerance is its force at the travel `length`, if this force is less than `force`.
        let allowed = if piece.holds() { (force * points.arm[i]).min(length * piece.slope) } else { length };
        let is_outside = |is_upper| points.signed_distance(i, state, is_upper).is_some_and(|d| !(d >= -allowed));
        if is_outside(false) { Some((i, state.piece - 1)) } else { is_outside(true).then_some((i, state.piece + 1)) }
    })
}
