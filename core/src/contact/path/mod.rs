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

pub use load::{PathEnd, PathLoad, Stop};
