//! The load of a path, its stops and its ends.

use crate::contact::solution::ContactSolution;

/// The loads f₀ + t f₁ and the dofs held, over all dofs, and the largest t wanted; it may be infinite.
#[derive(Clone, Copy, Debug)]
pub struct PathLoad<'a> {
    pub start: &'a [f64],
    pub add: &'a [f64],
    pub held_value: &'a [f64],
    pub end: f64,
}

/// Where the path is at its beginning, at an event, or at its end; a jump has a stop where it begins and one where it ends.
#[derive(Clone, Copy)]
pub struct Stop<'a> {
    pub t: f64,
    /// Points that go to another piece here; none at the beginning and at the end.
    pub switched: &'a [usize],
    /// What holds here; `piece` are the pieces from here on.
    pub solution: &'a ContactSolution,
}

/// How a path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// At the t asked for.
    Reached,
    /// With no more events, however large t; the last stop is only one more point of the last segment.
    Unbounded,
    /// No reactions balance the load from the last stop on.
    NoEquilibrium,
    /// More events than [`MOST_EVENTS`].
    TooMany,
    /// The pieces after the last stop, or at t = 0, is beyond the arithmetic.
    Unsolved,
    /// Whoever watched wanted no more.
    Interrupted,
}

/// Events that a path may have.
pub const MOST_EVENTS: usize = 100_000;

impl PathLoad<'_> {
    pub(super) fn at(&self, t: f64) -> Vec<f64> {
        self.start.iter().zip(self.add).map(|(a, b)| a + t * b).collect()
    }
}
