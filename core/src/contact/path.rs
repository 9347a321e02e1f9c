//! The path of a plate under f₀ + t f₁ as t grows from zero: piecewise linear, an event wherever points open or close.
//!
//! Condensed points go by parametric pivoting of their LCP. With an active set the path steps from event to event: on one
//! contact set everything is linear in t, and the next event is where the first reaction or gap falls to zero. Either way
//! each stretch of the path is drawn between two refined solutions on its contact set.
//!
//! Where a plate loses its hold but comes to rest on other points, it moves there under one load: the path has a stretch
//! at one t. All that is between the two states solves the problem too, since its solutions are convex.

mod follower;
mod line;
mod load;
mod pivoting;
mod stepping;
mod trail;

use super::problem::ContactProblem;
use super::solution::{Outcome, Progress};
use crate::cholesky::FactorError;
use follower::Follower;
pub use load::{PathEnd, PathLoad, Stop};
use trail::Trail;

impl ContactProblem {
    /// Follows the path, and shows every stop on it to `visit`, which may end it by returning false, as `watch` may between
    /// them, which sees the steps of all solves.
    ///
    /// The first stop is the solution at t = 0; if there is none, `visit` is not called.
    pub fn path(
        &self,
        load: &PathLoad,
        visit: &mut dyn FnMut(Stop) -> bool,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<PathEnd, FactorError> {
        let mut follower = Follower::new(self, load, watch);
        let end = follower.follow(visit)?;
        Ok(if follower.interrupted { PathEnd::Interrupted } else { end })
    }
}

impl Follower<'_> {
    fn follow(&mut self, visit: &mut dyn FnMut(Stop) -> bool) -> Result<PathEnd, FactorError> {
        let first = self.solution(0.0, None)?;
        match first.outcome {
            Outcome::Solved => {}
            Outcome::NoEquilibrium => return Ok(PathEnd::NoEquilibrium),
            _ => return Ok(PathEnd::Unsolved),
        }
        let mut trail = Trail::new(first, visit);
        if self.load.end <= 0.0 {
            return Ok(trail.end(0.0, None, PathEnd::Reached));
        }
        if self.problem.active.is_empty() && !self.load.proximal {
            self.pivot_along(&mut trail)
        } else {
            self.step_along(0.0, &mut trail)
        }
    }
}
