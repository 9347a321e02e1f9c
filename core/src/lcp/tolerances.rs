//! Every tolerance of the linear complementarity solvers. The problem is scaled to entries of about 1 first, so that all
//! are relative; ε is 2.2e-16.

/// Smallest pivot, relative to the larger of 1 and its column's largest entry; smaller entries count as zero. It
/// exceeds the rounding of a zero, some 10⁵ ε of elimination, and is smaller than the stiffness of soft supports of a
/// floating plate.
pub(super) const PIVOT: f64 = 1e-11;

/// Relative size of a pivot that is recomputed from the problem before it is used: √ε; half the digits of a smaller one
/// may be rounding.
pub(super) const DOUBTFUL_PIVOT: f64 = 1e-8;

/// Relative tolerance for equal ratios: at the smaller ratio, the basic variable of the other is this near to zero,
/// relative to the larger of 1 and its value before the step. Ten times the smallest pivot, so that no step divides by
/// less.
pub(super) const TIE: f64 = 10.0 * PIVOT;

/// Relative tolerance for a zero step of the parameter, relative to the larger of 1 and itself.
pub(super) const SAME_EVENT: f64 = TIE;

/// Relative tolerance for negative basic variables: relative to the largest z for a z, and for w_i to |q_i| + Σ_j |M_ij
/// z_j| + √(|M_ii| Σ_j |q_j z_j|), whose root bounds |(Mz)_i| for a semidefinite M. Smaller negative values are
/// rounding and become zero. Equal to the smallest pivot: both are rounding of the same elimination.
pub(super) const FEASIBILITY: f64 = PIVOT;

/// The figures of an [`InfeasibilityProof`](super::InfeasibilityProof) at which the ray of a warm start is believed. That
/// of a cold start needs none.
pub(super) const PROOF: f64 = TIE;
