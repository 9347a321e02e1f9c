//! Plates on one-sided supports: min ½uᵀKu − fᵀu subject to Gu ≤ g.
//!
//! `condense` turns this into a linear complementarity problem and back; `problem` holds the factor that every load
//! case shares; `solve` goes from a load to displacements, reactions and gaps, corrected by `refinement`, `careful` where
//! rounding decides, `path` along a load that grows; `responses` and `combine` do so for many combinations of a few load cases at once.

pub mod active_set;
mod careful;
pub mod combine;
pub mod condense;
pub mod interior_point;
pub mod path;
pub mod problem;
pub mod refinement;
pub mod responses;
pub mod solution;
pub mod solve;

pub use active_set::{Progress, Reference};
pub use combine::{Combined, CombinedCases, Verdict};
pub use condense::{Condensed, Form};
pub use path::{PathEnd, PathLoad, Stop};
pub use problem::{Constraints, ContactProblem};
pub use responses::Response;
pub use solution::{ContactSolution, Outcome};
