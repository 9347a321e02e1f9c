//! The linear equations of a fixed contact state, and their solvers.
//!
//! ```text
//! K   Gᵀ   Δu     imbalance
//! G  −C    Δr  =  violation      G: rows of points whose force depends on the travel, C: their compliance
//! ```
//!
//! A backend solves them with a regularized diagonal, −σ below or +ρ above (Friedlander & Orban 2012);
//! [`refine`](super::refine) removes its effect and rounding. Backends differ in what they eliminate: [`Condensed`]
//! everything but the points; [`Factored`] the forces of points, or nothing where these are multiplier rows of its
//! matrix.

mod coarse;
mod condensed;
mod factored;
mod gradients;
mod penalized;
mod solver;

pub(super) use coarse::CoarseLoad;
pub(super) use condensed::Condensed;
pub(super) use factored::{Direction, Factored};
pub(super) use gradients::{BEFORE_A_FACTOR, Gradients};
pub(super) use solver::{Correction, Kkt};
