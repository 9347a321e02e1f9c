//! Plates on one-sided supports: min ½uᵀKu − fᵀu subject to Gu ≤ g.
//!
//! From the ground up: `tolerances`; `scale`, what forces and lengths are compared with; `condense`, from a plate on
//! constraints to a linear complementarity problem and back; `points`, as rows and of an active set; `problem`, the factor
//! that every load case shares; `solution`, what one is answered with and begins at; `rigid` motions; `kkt`, the equations
//! of one contact set, their solvers and their refinement. On these stand the methods that look for the closed set:
//! `active_set`, `proximal` where rounding decides, `interior_point`; and `solve`, from a load to displacements, reactions
//! and gaps, of condensed points by `lcp`. `path` follows a load that grows; `responses` and `combine` solve many
//! combinations of a few load cases at once.

mod active_set;
pub mod combine;
pub mod condense;
pub mod interior_point;
mod kkt;
mod lcp;
pub mod path;
mod points;
pub mod problem;
mod proximal;
pub mod responses;
mod rigid;
mod scale;
pub mod solution;
pub mod solve;
mod tolerances;

pub use combine::{Combined, CombinedCases};
pub use condense::{Condensed, Form};
pub use path::{PathEnd, PathLoad, Stop};
pub use points::Constraints;
pub use problem::ContactProblem;
pub use responses::Response;
pub use solution::{ContactSolution, Outcome, Progress, Reference};
