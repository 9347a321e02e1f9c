//! Contact of plates on one-sided supports: min ½uᵀKu − fᵀu + Σ ψᵢ(gᵢᵀu), with ψᵢ the energy of the law of point i.
//!
//! Modules in order of dependence: `tolerances`; `error`; `graph`, the law of a point; `points`, rows and laws;
//! `scale`, reference forces and lengths; `rigid` and `rigid_body_space`, rigid motions; `system`, K with springs,
//! factored; `solution`; `interface`, the plate condensed onto its contact points; `backend`, the factored plate of
//! each method; `problem`, data shared by all loads; `load`; `residual`; `kkt`, the linear equations of a fixed contact
//! state and their solvers; `refine`, iterative refinement; `fixed_state`; `finders`, methods that find the contact
//! state; `solve`. Built on these: `path`, a load f₀ + t f₁; `responses` and `combine`, linear combinations of load
//! cases.

mod backend;
mod combine;
mod error;
mod finders;
mod fixed_state;
mod graph;
mod interface;
mod kkt;
mod load;
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

pub use backend::Method;
pub use combine::{Combined, CombinedCases};
pub use error::SolveError;
pub use graph::{Graph, GraphError, Piece};
pub use interface::{Form, LcpTemplate, VertexRow, Vertices};
pub use load::Load;
pub use path::{PathEnd, PathLoad, Stop};
pub use points::{PointLaws, Points};
pub use problem::{ContactProblem, Seconds, Supported};
pub use responses::Response;
pub use solution::{ContactSolution, Progress, Watch};
pub use solve::Settings;
