//! Linear complementarity: find z, w with w = Mz + q, w ≥ 0, z ≥ 0, zᵀw = 0.
//!
//! The module is independent of plates. M is any square matrix, dense and row-major.
//!
//! | file | holds |
//! |---|---|
//! | `problem` | the problem, its solution and statuses, and the verification of a solution |
//! | `lemke` | Lemke's algorithm, cold or from a given complementary basis |
//! | `family` | many problems with one M |
//! | `parametric` | every basis of w = Mz + q + t d as t grows |
//! | `scaling` | the powers of two that make tolerances relative |
//! | `pivoting` | principal pivotal transforms and the freshly solved basic solution |
//! | `tableau` | the condensed tableau and its delayed updates |
//! | `kernels` | inner loops, compiled for the widest registers of the machine |
//! | `tolerances` | every tolerance, and what it is relative to |
//! | `ratio_test` | which variable leaves: the lexicographic rule and its tolerances |

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
