//! The core of signorini: Reissner–Mindlin plates on supports that may act in one direction only. Arguments and results
//! are arrays.
//!
//! Signs: z and the deflection w point down; loads are positive down; a reaction is positive if it pushes the plate up;
//! moments are positive if they sag. Rotations are slopes, θx ≈ ∂w/∂x.

#![forbid(unsafe_code)]

pub mod assembly;
pub mod bodies;
pub mod cholesky;
pub mod components;
pub mod contact;
pub mod dense;
pub mod displacement;
pub mod double_double;
pub mod element;
pub mod fields;
pub mod lcp;
pub mod ordering;
pub mod plate;
pub mod residual;
pub mod rows;
pub mod stress;
pub mod superposition;
mod vectorized;
