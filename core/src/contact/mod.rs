//! Plates on supports that may hold one way only: min ½uᵀKu − fᵀu + Σ energies of the points' laws.
//!
//! From the ground up: `tolerances`; `graph`, the law of a point; `points`, rows and laws; `scale`, what forces and lengths
//! are compared with; `system`, K with springs, factored; `interface`, the plate condensed onto its points; `residual`;
//! `kkt`, the equations on given pieces and their solvers; `refine`; `finders` of the pieces; `problem`, what all loads
//! share; `solve`. On these stand `path`, a load that grows, and `responses` and `combine`, many combinations of a few load cases.

mod combine;
mod finders;
mod floating;
mod graph;
mod interface;
mod kkt;
mod path;
mod points;
mod problem;
mod refine;
mod residual;
mod responses;
mod rigid;
mod scale;
mod solution;
mod solve;
mod system;
mod tolerances;

pub use combine::{Combined, CombinedCases};
pub use graph::{Graph, GraphError, Piece};
pub use interface::{Form, PosedLcp, VertexRow};
pub use path::{PathEnd, PathLoad, Stop};
pub use points::Points;
pub use problem::{ContactProblem, Method, Seconds, Supported};
pub use responses::Response;
pub use solution::{ContactSolution, Outcome, Progress, Watch};
