//! The load of a path, the stops that are reported, and how a path ends.

use crate::contact::error::{SolveError, require_length};
use crate::contact::problem::ContactProblem;
use crate::contact::solution::ContactSolution;

/// The load f₀ + t f₁ with f₀ = `start` and f₁ = `add` (3n,), the prescribed values (3n,) of held dofs, and the largest
/// load factor t, `end`, which may be infinite.
#[derive(Clone, Copy, Debug)]
pub struct PathLoad<'a> {
    pub start: &'a [f64],
    pub add: &'a [f64],
    pub held_value: &'a [f64],
    pub end: f64,
}

/// A stop on the path: its start, an event, or its end. A jump has one stop before and one stop after it, at the same
/// t.
#[derive(Clone, Copy)]
pub struct Stop<'a> {
    pub t: f64,
    /// Points that change their piece of the law at this stop. The list is empty at the start and at the end of the
    /// path.
    pub switched: &'a [usize],
    /// The solution at this stop; its `piece` is the contact state after the stop.
    pub solution: &'a ContactSolution,
}

/// How a path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// The path reached the requested largest t.
    Reached,
    /// There is no further event for t → ∞. The last stop is a solution on the last segment at some larger t.
    Unbounded,
    /// No reactions balance the load beyond the last stop.
    NoEquilibrium,
    /// The path has more events than [`MOST_EVENTS`].
    TooMany,
    /// The contact state at t = 0, or after the last stop, is numerically singular.
    Unsolved,
    /// The callback cancelled the path.
    Interrupted,
}

/// Largest number of events on a path.
pub const MOST_EVENTS: usize = 100_000;

impl PathLoad<'_> {
    pub(super) fn require_lengths(&self, problem: &ContactProblem) -> Result<(), SolveError> {
        let dofs = problem.plate.dof_count();
        require_length("the load", self.start.len(), dofs)?;
        require_length("the load to be added", self.add.len(), dofs)?;
        require_length("held_value", self.held_value.len(), dofs)
    }

    pub(super) fn at(&self, t: f64) -> Vec<f64> {
        self.start.iter().zip(self.add).map(|(a, b)| a + t * b).collect()
    }
}
