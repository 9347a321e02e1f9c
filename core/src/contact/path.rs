//! The path of a plate under f₀ + t f₁ as t grows from zero: piecewise linear, an event wherever points open or close.
//!
//! Condensed points go by parametric pivoting of their LCP. With an active set the path steps from event to event: on one
//! contact set everything is linear in t, and the next event is where the first reaction or gap falls to zero. Either way
//! each stretch of the path is drawn between two refined solutions on its contact set.
//!
//! Where a plate loses its hold but comes to rest on other points, it moves there under one load: the path has a stretch
//! at one t. All that is between the two states solves the problem too, since its solutions are convex.

mod line;
mod pivoting;
mod stepping;
mod trail;

use super::problem::ContactProblem;
use super::solution::{ContactSolution, Outcome};
use crate::cholesky::FactorError;
use trail::Trail;

/// The loads f₀ + t f₁ and the dofs held, over all dofs, and the largest t wanted; it may be infinite.
#[derive(Clone, Copy, Debug)]
pub struct PathLoad<'a> {
    pub start: &'a [f64],
    pub add: &'a [f64],
    pub held_value: &'a [f64],
    pub end: f64,
    /// Whether rounding is minded: event by event, every solution by proximal steps; without points of an active set.
    pub careful: bool,
}

/// Where the path is at its beginning, at an event, or at its end; a jump has a stop where it begins and one where it ends.
#[derive(Clone, Copy, Debug)]
pub struct Stop<'a> {
    pub t: f64,
    /// Points that open or close here; none at the beginning and at the end.
    pub switched: &'a [usize],
    /// What holds here; `closed` is the contact set from here on.
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
    /// The contact set after the last stop, or at t = 0, is beyond the arithmetic.
    Unsolved,
    /// Whoever watched wanted no more.
    Interrupted,
}

/// Part of the plate's own compliance that increments of reaction meet where rounding is minded.
const CAREFUL: f64 = 1e-9;

/// Events that a path may have.
pub const MOST_EVENTS: usize = 100_000;

/// Reactions and gaps of the wrong sign at the ends of a segment, over the largest of their kind, that are rounding.
const SIGN: f64 = 1e-9;

impl PathLoad<'_> {
    fn at(&self, t: f64) -> Vec<f64> {
        self.start.iter().zip(self.add).map(|(a, b)| a + t * b).collect()
    }

    /// Largest part of the load where the two that it is made of do not cancel, and both count.
    fn size(&self, t: f64) -> f64 {
        let largest = |f: &[f64]| f.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        largest(self.start) + self.span(t) * largest(self.add)
    }

    /// A step of t that changes the load about as much as there is of it.
    fn span(&self, t: f64) -> f64 {
        let size = |f: &[f64]| f.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        match size(self.start) / size(self.add) {
            span if span > 0.0 && span.is_finite() => span.max(t),
            _ => t.max(1.0),
        }
    }
}

impl ContactProblem {
    /// Follows the path, and shows every stop on it to `visit`, which may end it by returning false.
    ///
    /// The first stop is the solution at t = 0; if there is none, `visit` is not called.
    pub fn path(&self, load: &PathLoad, visit: &mut dyn FnMut(Stop) -> bool) -> Result<PathEnd, FactorError> {
        let first = if load.careful {
            self.solve_carefully(load.start, load.held_value, CAREFUL, None, &mut |_| true)
        } else {
            self.solve(load.start, load.held_value, None, None, &mut |_| true)?
        };
        match first.outcome {
            Outcome::Solved => {}
            Outcome::NoEquilibrium => return Ok(PathEnd::NoEquilibrium),
            _ => return Ok(PathEnd::Unsolved),
        }
        let mut trail = Trail::new(first, visit);
        if load.end <= 0.0 {
            return Ok(trail.stuck(0.0, PathEnd::Reached));
        }
        if self.active.is_empty() && !load.careful {
            self.pivot_along(load, &mut trail)
        } else {
            self.step_along(load, 0.0, &mut trail)
        }
    }
}
