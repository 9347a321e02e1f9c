//! The equations of points on given pieces, and what solves them.
//!
//! ```text
//! K   Gᵀ   Δu     out of balance
//! G  −C    Δr  =  gap violation      rows and columns of points that hold, C their compliance
//! ```
//!
//! A backend solves them with something added to the diagonal, −σ below or ρ above, which keeps them regular (Friedlander
//! & Orban 2012); [`refine`](super::refine) takes back what that and rounding leave. The backends differ in what they eliminate:
//! [`Condensed`] everything but the points; [`Factored`] the forces of points, or, where they are borders of its matrix, nothing.

mod condensed;
mod factored;
mod floating;
mod gradients;
mod penalized;
mod solver;

pub(super) use condensed::Condensed;
pub(super) use factored::{Direction, Factored};
pub(super) use floating::Afloat;
pub(super) use gradients::{BEFORE_A_FACTOR, Gradients};
pub(super) use solver::{Correction, Kkt};
