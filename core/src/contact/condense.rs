//! The contact points alone: from a plate on constraints to an LCP and back. The one module that speaks both languages:
//! outside, `reaction` and `gap`; inside, z, w, M, q.
//!
//! Constraints read Gu + gap − C·reaction = g. A factor of K̃ = K + Gᵀ diag(δ) G, with the contact dofs last, knows
//! the plate at its contact points in two ways:
//!
//! - *stiffness*: reaction = f̂ − S y at contact displacements y = Gu, with S the Schur complement of K (that of K̃ less
//!   δ). The unknown of the LCP is the gap, M = (S⁻¹ + C)⁻¹; all points are taken closed first. It needs rows that pick
//!   single dofs, and is the better conditioned of the two on long rigid lines of thin plates.
//! - *flexibility*: P̃ = G K̃⁻¹ Gᵀ, and (I − P̃δ)·gap = B·reaction − s̃ with B = P̃(I − δC) + C and
//!   s̃ = G K̃⁻¹f + P̃δg − g. δ = 0 gives the paper's dual, gap = (P + C)·reaction − s, whose unknown is the reaction.
//!   Exchanging reaction and gap on a set J is a principal pivot: where the plate is free to move, J holds its rigid
//!   motions and has δ > 0. A compliant point whose whole stiffness is in the factor, δ = 1/C, is the simplest: its
//!   column of B is C alone, so that M = δ − δP̃δ.
//!
//! Two-sided points have no gap and a reaction of either sign; they are eliminated from the LCP.

mod condensed;
mod flexibility;
mod forward_rows;
mod rigid;
mod schur;
mod stiffness;
mod wide_springs;

pub(super) use condensed::picks_single_dofs;
pub use condensed::{Condensed, ContactState, Form, InterfaceResidual, PosedLcp, Work};
pub(super) use rigid::FreeMotions;
pub(super) use wide_springs::{WideSprings, pins};
