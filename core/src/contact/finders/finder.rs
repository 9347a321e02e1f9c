//! The trait of methods that find the contact state, and the feasibility test of a state.

use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::residual::{largest_force, lengths};
use crate::contact::scale::largest;
use crate::contact::solution::{ContactSolution, Watch};
use crate::contact::tolerances;

/// Finds the contact state of one load and its solution.
pub(in crate::contact) trait SetFinder {
    /// Solves for a nodal load (3n,) with the held dofs at `held_value` (3n,), from the solution of another load if
    /// given; `watch` is called after every step.
    fn find(
        &self,
        problem: &ContactProblem,
        load: &[f64],
        held_value: &[f64],
        start: Option<&ContactSolution>,
        watch: &mut Watch<'_>,
    ) -> Result<ContactSolution, FactorError>;
}

/// Whether every point is within the bounds of its piece, up to rounding; lengths up to `least_length` count as zero.
pub(in crate::contact) fn signs_are_feasible(
    problem: &ContactProblem,
    load: &[f64],
    least_length: f64,
    solution: &ContactSolution,
) -> bool {
    points_beyond(problem, load, least_length, solution).is_empty()
}

/// The points beyond the bounds of their piece by more than rounding, each with the piece beyond that bound.
pub(in crate::contact) fn points_beyond(
    problem: &ContactProblem,
    load: &[f64],
    least_length: f64,
    solution: &ContactSolution,
) -> Vec<(usize, u8)> {
    let lengths = lengths(problem, solution);
    // Without load, the reference force is the stiffness times the displacement.
    let load = match problem.scale.largest(load) {
        0.0 => largest(&problem.delta).max(problem.scale.stiffness) * largest(&lengths),
        load => load,
    };
    let force = tolerances::SIGN * largest_force(problem, &[], &solution.reaction).max(load);
    let length = |i: usize| (tolerances::SIGN * lengths[i]).max(least_length / problem.points.arm[i]);
    beyond(problem, &solution.piece, &solution.reaction, &solution.gap, force, length).collect()
}

/// Whether no point exceeds the bounds of its piece by more than a force, or by more than its length.
pub(in crate::contact) fn is_feasible(
    problem: &ContactProblem,
    pieces: &[u8],
    reaction: &[f64],
    gap: &[f64],
    force: f64,
    length: impl Fn(usize) -> f64,
) -> bool {
    beyond(problem, pieces, reaction, gap, force, length).next().is_none()
}

/// Points beyond a bound of their piece, each with the piece beyond that bound.
fn beyond(
    problem: &ContactProblem,
    pieces: &[u8],
    reaction: &[f64],
    gap: &[f64],
    force: f64,
    length: impl Fn(usize) -> f64,
) -> impl Iterator<Item = (usize, u8)> {
    let points = &problem.points;
    (0..points.len()).filter_map(move |i| {
        let piece = points.piece(i, pieces[i]);
        let [low, high] = points.ends(i, pieces[i]);
        let (value, axis, allowed) = match piece.holds() {
            // For a soft spring the tolerance of travel is the stricter one.
            true => (reaction[i], 1, (force * points.arm[i]).min(length(i) * piece.slope)),
            false => (piece.travel - gap[i], 0, length(i)),
        };
        if low.is_some_and(|end| !(value >= end[axis] - allowed)) {
            return Some((i, pieces[i] - 1));
        }
        high.is_some_and(|end| !(value <= end[axis] + allowed)).then(|| (i, pieces[i] + 1))
    })
}
