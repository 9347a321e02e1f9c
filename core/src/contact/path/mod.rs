//! The path of solutions under the load f₀ + t f₁ for growing t ≥ 0. It is piecewise linear, with an event wherever
//! contact points change their piece of the law.
//!
//! For condensed points, parametric pivoting of their LCP traces the path. The Newton method traces it from event to
//! event. On one contact state everything is linear in t, and the next event is the first t at which a point reaches an
//! end of its piece. Each segment is interpolated between two refined solutions.
//!
//! If a plate loses a support and moves to other points, it moves at constant load: the path has a segment at one t, a
//! jump. All states between the ends of the jump are solutions too, since the solution set is convex.

mod line;
mod load;
mod pivoting;
mod recorder;
mod stepping;
mod tracer;

pub use load::{PathEnd, PathLoad, Stop};
