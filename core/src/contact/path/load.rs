//! The load of a path, its stops and its end.

use crate::contact::error::{SolveError, require_length};
use crate::contact::problem::ContactProblem;
use crate::contact::solution::ContactSolution;

/// The load f₀ + t f₁ (3n,), prescribed values (3n,), and the largest t, which may be infinite.
#[derive(Clone, Copy, Debug)]
pub struct PathLoad<'a> {
    pub start: &'a [f64],
    pub add: &'a [f64],
    pub held_value: &'a [f64],
    pub end: f64,
}

/// A stop: the start of the path, an event, or its end; a jump has one stop before and one after it.
#[derive(Clone, Copy)]
pub struct Stop<'a> {
    pub t: f64,
    /// Points that change their piece here; empty at the start and at the end.
    pub switched: &'a [usize],
    /// The solution here; `piece` is the contact state from here on.
    pub solution: &'a ContactSolution,
}

/// How a path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// At the requested t.
    Reached,
    /// Without further events for t → ∞; the last stop is another point of the last segment.
    Unbounded,
    /// No reactions balance the load beyond the last stop.
    NoEquilibrium,
    /// More events than [`MOST_EVENTS`].
    TooMany,
    /// The contact state after the last stop, or at t = 0, is numerically singular.
    Unsolved,
    /// Cancelled by the callback.
    Interrupted,
}

/// Largest number of events of a path.
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
