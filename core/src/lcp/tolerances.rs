//! Tolerances of the linear complementarity solvers. They are relative to 1, because the problem is scaled to entries
//! of about 1. ε is 2.2e-16.

/// Smallest pivot, relative to the larger of 1 and the largest entry of its column. Smaller entries count as zero. The
/// value is more than the rounding error of a zero after elimination, about 10⁵ ε, and less than the relative stiffness
/// of soft supports of a free plate.
pub(super) const PIVOT: f64 = 1e-11;

/// A pivot of smaller relative size than this is doubtful: since the value is √ε, half of its digits may be rounding
/// errors. The tableau is recomputed before such a pivot is used, unless it was recomputed shortly before.
pub(super) const DOUBTFUL_PIVOT: f64 = 1e-8;

/// Relative tolerance for equal ratios. Two rows are tied if, at the smaller ratio, the basic variable of the other row
/// is zero within this tolerance, relative to the larger of 1 and its value before the step. The tolerance is ten times
/// the smallest pivot.
pub(super) const TIE: f64 = 10.0 * PIVOT;

/// A step of the parameter t counts as zero if it is smaller than this, relative to the larger of 1 and t.
pub(super) const SAME_EVENT: f64 = TIE;

/// Relative tolerance for negative basic variables. The reference of z_i is the largest z. The reference of w_i is
/// |q_i| + Σ_j |M_ij z_j| + √(|M_ii| Σ_j |q_j z_j|); for a semidefinite M the root bounds |(Mz)_i|. Negative values
/// within the tolerance become zero. It equals the smallest pivot, because both result from the rounding of the same
/// elimination.
pub(super) const FEASIBILITY: f64 = PIVOT;

/// Relative tolerance for the [`InfeasibilityProof`](super::InfeasibilityProof) of a ray from a warm start. A ray from
/// a cold start needs no proof.
pub(super) const PROOF: f64 = TIE;
