//! The plate condensed onto its contact points, and its linear complementarity problem. Only this module uses both
//! vocabularies: `reaction` and `gap` of mechanics, and z, w, M, q of the LCP.
//!
//! With increments Δs = GΔu of travel and Δr of reaction, a factor of K̃ = K + Gᵀ diag(δ) G, with the contact dofs
//! last, gives the plate at its contact points in two forms:
//!
//! - *stiffness*: SΔs + Δr = f̂, with S the Schur complement of K (that of K̃ minus δ). It needs rows that select
//!   single dofs, and it is the better conditioned form on long rigid lines of thin plates.
//!
//! - *flexibility*: (I − P̃δ)Δs + P̃Δr = d with P̃ = GK̃⁻¹Gᵀ and d = GK̃⁻¹f. δ = 0 gives the dual form of
//!   docs/theory.md.
//!
//! Both forms read AΔs + RΔr = b. A point on a piece has one unknown x: its force if this depends on the travel,
//! otherwise its travel. The column of x is A/k + R for a force, with k the slope of the piece, and A for a travel. A
//! point whose whole stiffness is in the factor has a column with one entry.

mod condensed;
mod forward_rows;
mod lcp_template;
mod motions;
mod on_pieces;
mod schur;
mod vertices;

pub use condensed::Form;
pub(super) use condensed::{CondensedRhs, Interface, ReducedLoad};
pub use lcp_template::LcpTemplate;
pub(super) use motions::Work;
pub(super) use on_pieces::OnPieces;
pub use vertices::{VertexRow, Vertices};
