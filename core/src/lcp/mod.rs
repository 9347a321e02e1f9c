//! Linear complementarity: find z, w with w = Mz + q, w ≥ 0, z ≥ 0, zᵀw = 0.
//!
//! The module does not depend on plates. M is any square matrix, stored as a dense row-major array.
//!
//! | file | content |
//! |---|---|
//! | `problem` | the problem, its solution and statuses, and the verification of a solution |
//! | `lemke` | Lemke's algorithm, from the slack basis or from a given complementary basis |
//! | `family` | many problems with one M |
//! | `parametric` | every basis of w = Mz + q + t d as t grows |
//! | `scaling` | scaling by powers of two, so that tolerances are relative |
//! | `pivoting` | principal pivotal transforms and the basic solution of a complementary basis |
//! | `tableau` | the condensed tableau and its delayed updates |
//! | `kernels` | inner loops, compiled for the widest registers of the machine |
//! | `tolerances` | every tolerance and its reference value |
//! | `ratio_test` | the choice of the leaving variable: the lexicographic ratio test |

mod family;
mod kernels;
mod lemke;
mod parametric;
mod pivoting;
mod problem;
mod ratio_test;
mod scaling;
mod tableau;
mod tolerances;

pub use family::{LcpBasis, LcpFamily};
pub use lemke::{LemkeOptions, default_max_pivots, lemke, lemke_from, lemke_watched};
pub use parametric::{ParametricEnd, ParametricPath, ParametricSegment, parametric};
pub use problem::{InfeasibilityProof, Lcp, LcpError, LcpSolution, LcpStatus, Residuals};
