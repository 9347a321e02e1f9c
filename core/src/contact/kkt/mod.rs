//! The linear equations of a fixed contact state, and their solvers.
//!
//! ```text
//! K   Gᵀ   Δu     imbalance
//! G  −C    Δr  =  violation      G: rows of points whose force depends on the travel, C: their compliance
//! ```
//!
//! A backend solves them with a regularized diagonal: −σ in the block of Δr, or +ρ in the block of Δu (Friedlander &
//! Orban 2012). [`refine`](super::refine) removes the effect of the regularization, and rounding. Backends differ in
//! the unknowns that they eliminate. [`Condensed`] eliminates all unknowns except those of the points. [`Factored`]
//! eliminates the forces of points, or no unknown if these forces are multiplier rows of its matrix.

mod batched_factor;
mod coarse;
mod condensed;
mod factored;
mod gradients;
mod penalized;
mod solver;

pub(super) use batched_factor::{Batched, SharedFactor, advance, alone};
pub(super) use coarse::CoarseLoad;
pub(super) use condensed::Condensed;
pub(super) use factored::{Direction, Factored};
pub(super) use gradients::{BEFORE_A_FACTOR, Equations, direction};
pub(super) use solver::{Correction, Kkt};
