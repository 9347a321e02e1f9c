//! The contact points alone: a plate condensed onto them, and the complementarity problem that is then posed. The one
//! module that speaks both languages: outside, `reaction` and `gap`; inside, z, w, M, q.
//!
//! With increments Δs = GΔu of travel and Δr of reaction, a factor of K̃ = K + Gᵀ diag(δ) G, with the contact dofs last,
//! knows the plate at its contact points in two ways:
//!
//! - *stiffness*: SΔs + Δr = f̂, S the Schur complement of K (that of K̃ less δ). It needs rows that pick single dofs, and
//!   is the better conditioned of the two on long rigid lines of thin plates.
//! - *flexibility*: (I − P̃δ)Δs + P̃Δr = d with P̃ = GK̃⁻¹Gᵀ and d = GK̃⁻¹f. δ = 0 gives the paper's dual.
//!
//! Either is AΔs + RΔr = b. On a piece a point has one unknown x, its force past the piece's first vertex where it holds,
//! else its travel, and one column, A/k + R or A. An elastic point whose whole slope the factor carries has a column of
//! one entry.

mod condensed;
mod forward_rows;
mod motions;
mod on_pieces;
mod posed;
mod schur;

pub use condensed::Form;
pub(super) use condensed::{AtPoints, Interface, Reduced};
pub(super) use motions::{FreeMotions, Work};
pub(super) use on_pieces::OnPieces;
pub use posed::{PosedLcp, VertexRow};
