//! Contact of plates on one-sided supports: min ½uᵀKu − fᵀu + Σ ψᵢ(gᵢᵀu), with ψᵢ the energy of the law of point i.
//!
//! Modules in order of dependence: `tolerances`; `graph`, the law of a point; `points`, rows and laws; `scale`,
//! reference forces and lengths; `system`, K with springs, factored; `interface`, the plate condensed onto its contact
//! points; `residual`; `kkt`, the linear equations of a fixed contact state and their solvers; `refine`, iterative
//! refinement; `finders`, methods that find the contact state; `problem`, data shared by all loads; `solve`. Built on
//! these: `path`, a load f₀ + t f₁; `responses` and `combine`, linear combinations of load cases.

mod combine;
mod finders;
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
mod rigid_body_space;
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
