//! The path of a plate under the load f₀ + t f₁ for growing t ≥ 0: piecewise linear, with an event wherever points
//! change their piece.
//!
//! Condensed points: parametric pivoting of their LCP. Newton method: from event to event, since everything is linear
//! in t on one contact state, and the next event is the first zero of a reaction or gap. Each segment is interpolated
//! between two refined solutions.
//!
//! Where a plate loses a support and comes to rest on other points, it moves at constant load: the path has a segment
//! at one t. All states between its ends solve the problem too, since the solution set is convex.

mod line;
mod load;
mod pivoting;
mod recorder;
mod stepping;
mod tracer;

pub use load::{PathEnd, PathLoad, Stop};
