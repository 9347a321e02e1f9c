//! Every tolerance of the linear complementarity solvers. The problem is scaled to entries of about 1 first, so that all
//! are relative; ε is 2.2e-16.

/// A pivot must exceed this times the larger of 1 and its column's largest entry, below which an entry counts as zero:
/// what some 10⁵ ε of elimination leave of a zero, and less than what holds a plate that floats on soft supports.
pub(super) const PIVOT: f64 = 1e-11;

/// A pivot this small relative to its column is recomputed from the problem itself before it is used: √ε, beyond which
/// half its digits may be rounding.
pub(super) const DOUBTFUL_PIVOT: f64 = 1e-8;

/// Two ratios are equal if, at the smaller, the other's basic variable is within this of zero, relative to the larger of
/// 1 and the variable's value before the step: ten times what counts as a pivot, so that no step divides by less.
pub(super) const TIE: f64 = 10.0 * PIVOT;

/// Steps of the parameter, relative to the larger of 1 and itself, that are none.
pub(super) const SAME_EVENT: f64 = TIE;

/// A basis is infeasible if one of its variables is below minus this, relative to the largest z for a z, and for w_i to
/// |q_i| + Σ_j |M_ij z_j| + √(|M_ii| Σ_j |q_j z_j|), whose root bounds |(Mz)_i| for a semidefinite M. What is above, but
/// negative, is rounding and becomes zero. As small as a pivot may be: both are rounding of the same elimination.
pub(super) const FEASIBILITY: f64 = PIVOT;

/// The figures of an [`InfeasibilityProof`](super::InfeasibilityProof) at which the ray of a warm start is believed. That
/// of a cold start needs none.
pub(super) const PROOF: f64 = TIE;
