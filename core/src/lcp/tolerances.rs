//! Tolerances of the linear complementarity solvers. They are relative, because the problem is scaled to entries of
//! about 1; ε is 2.2e-16.

/// Smallest pivot, relative to the larger of 1 and its column's largest entry; smaller entries count as zero. It
/// exceeds the rounding error of a zero after elimination, some 10⁵ ε. It is smaller than the relative stiffness of
/// soft supports of a free plate.
pub(super) const PIVOT: f64 = 1e-11;

/// A pivot of smaller relative size is doubtful: the value is √ε, and half of its digits may be rounding errors. The
/// tableau is recomputed before such a pivot is used.
pub(super) const DOUBTFUL_PIVOT: f64 = 1e-8;

/// Relative tolerance for equal ratios. Two rows are tied if, at the smaller ratio, the other row's basic variable is
/// zero within this tolerance, relative to the larger of 1 and its value before the step. It is ten times the smallest
/// pivot.
pub(super) const TIE: f64 = 10.0 * PIVOT;

/// Relative tolerance for a zero step of the parameter t, relative to the larger of 1 and t.
pub(super) const SAME_EVENT: f64 = TIE;

/// Relative tolerance for negative basic variables. The reference of z_i is the largest z; the reference of w_i is
/// |q_i| + Σ_j |M_ij z_j| + √(|M_ii| Σ_j |q_j z_j|), whose root bounds |(Mz)_i| for a semidefinite M. Negative values
/// within the tolerance become zero. It equals the smallest pivot, because both result from the rounding of the same
/// elimination.
pub(super) const FEASIBILITY: f64 = PIVOT;

/// Tolerance for the [`InfeasibilityProof`](super::InfeasibilityProof) of a ray from a warm start. A ray from a cold
/// start needs no proof.
pub(super) const PROOF: f64 = TIE;
