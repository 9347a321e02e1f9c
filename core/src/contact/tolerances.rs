//! Every tolerance of the contact problem: its reference quantity and the reason for its value. ε = 2.2e-16.
//!
//! Iteration limits stand beside their loops. Tolerances of the linear complementarity solvers stand in `lcp`.

/// Relative residual at convergence: of forces to the largest force, of lengths to the largest deflection. A sum in
/// double-double that is rounded to a double has an error of a few ε.
pub(super) const RESIDUAL: f64 = 1e-15;

/// Reactions and gaps of the wrong sign, relative to the largest of their kind or to the load, that count as rounding:
/// 10⁵ ε, the amplification by the elimination of thin plates.
pub(super) const SIGN: f64 = 1e-11;

/// Largest ratio of successive residual norms at which refinement continues: a gain of two bits costs more than it
/// brings.
pub(super) const PROGRESS: f64 = 0.25;

/// Largest scaled residual of an accepted solution for a fixed contact state.
pub(super) const SOLVED: f64 = 1e-9;

/// Accepted residual as a multiple of the rounding of the internal forces, where that exceeds the bound above. A plate
/// that has not reached its supports yet has a larger residual.
pub(super) const ROUNDINGS: f64 = 4.0;

/// Refinement by conjugate residuals stops when ten directions together reduce the residual by less than this factor.
pub(super) const SLOW: f64 = 0.7;

/// Smallest deflection that counts, relative to the load divided by the plate stiffness D/a².
pub(super) const NIL: f64 = 1e-6;

/// Relative tolerance for pivots in double-double: a smaller one belongs to an unconstrained rigid motion. 10¹⁰ ε², the
/// rounding of the arms.
pub(super) const HELD: f64 = 1e-22;

/// Relative residual at which a response needs no further correction, relative to the largest nodal force. Sums of
/// responses are corrected again.
pub(super) const RESPONSE: f64 = 1e-13;

/// Rounding error of a sum, relative to the sum of the magnitudes of its terms.
pub(super) const SUM: f64 = 4.0 * f64::EPSILON;

/// Compliance in series with rigid points in the saddle-point form, relative to the compliance of the plate: √ε, the
/// geometric mean of the two rounding errors that it balances.
pub(super) const COMPLIANCE: f64 = 1e-9;

/// Relative tolerance for pivots: with a smaller one, relative to its diagonal entry, the matrix is singular. The
/// factored springs need not hold the plate, and q8r has mechanisms. The smallest pivot of a plate that is held was
/// 1e-9, slender and soft plates included.
pub(super) const LOOSE_PIVOT: f64 = 1e-13;

/// Relative diagonal shift of K where springs alone hold the plate and are too soft for its factor: several roundings,
/// so that every pivot is positive.
pub(super) const DIAGONAL_SHIFT: f64 = 64.0 * f64::EPSILON;

/// Least ratio of the spring stiffness of a rigid motion to the stiffness that the diagonal shift adds to it: three
/// digits above the rounding of the factor.
pub(super) const SHIFT_BELOW: f64 = 1e3;

/// Condensation onto the contact points.
pub(super) mod interface {
    /// Relative tolerance for the equality of the factored stiffness δ and the stiffness of a point: both have a few
    /// rounding errors.
    pub(crate) const ABSORBED: f64 = 1e-12;

    /// Relative tolerance for zeros of q and M: of reactions to the load, of gaps to the largest displacement, of other
    /// entries to their terms. 10⁴ ε of elimination.
    pub(crate) const POSED: f64 = 1e-12;

    /// Rounding of a sum of stiffness times gap over all condensed points, relative to its terms.
    pub(crate) const POSED_SUM: f64 = 1e-14;

    /// Smallest ratio of a projected diagonal stiffness to the original one that is significant: half the digits.
    pub(crate) const PROJECTED: f64 = 1e-6;
}

/// Semismooth Newton method: steps, directions, penalties of rigid points.
pub(super) mod newton {
    /// Largest penalty, relative to the shear stiffness of an element. Multipliers converge faster with a larger
    /// penalty, and residuals lose as many digits.
    pub(crate) const STIFFEST: f64 = 1e4;

    /// First penalty over (h/element size)²: the ratio of bending to shear stiffness of a wave of twenty elements.
    pub(crate) const LONG_WAVE: f64 = 0.01;

    /// Relative tolerance of conjugate gradients while the contact state changes: the next change needs no more.
    pub(crate) const LOOSE: f64 = 0.3;

    /// Relative tolerance after several Newton steps in which the contact state changes: accurate Newton directions
    /// then reduce the number of steps.
    pub(crate) const FIRM: f64 = 1e-3;

    /// Relative tolerance on an unchanged contact state: half the digits; refinement gives the other half.
    pub(crate) const TIGHT: f64 = 1e-8;

    /// Residual relative to the largest force at convergence: 500 ε.
    pub(crate) const SETTLED: f64 = 1e-13;

    /// Multiple of `SETTLED` at which multipliers are updated, although some points still change their piece.
    pub(crate) const NEARLY: f64 = 1e3;

    /// Smallest ratio of successive residuals, on an unchanged contact state, that shows stagnation by rounding.
    pub(crate) const SLOW: f64 = 0.8;

    /// Largest relative residual that rounding explains, in the thinnest plates. A larger one means that supports
    /// contradict each other.
    pub(crate) const STALLED: f64 = 1e-3;

    /// Largest residual, relative to the largest force, at which multipliers are updated: an update needs an
    /// equilibrium.
    pub(crate) const BALANCED: f64 = 1e-3;

    /// Slope of the energy at the end of a line search, relative to the slope at its start.
    pub(crate) const FLAT: f64 = 1e-3;

    /// Relative tolerance for the curvature of a free rigid motion, relative to that of the factored matrix: 500 ε, the
    /// rounding of the sum of squares.
    pub(crate) const FREE: f64 = 1e-13;

    /// Smallest curvature, relative to that of the factored matrix, for the difference formula, which then keeps ten
    /// digits.
    pub(crate) const PLAIN: f64 = 1e-6;

    /// Stiffness added to unconstrained rigid motions, relative to the sum of all point stiffnesses. With it such a
    /// motion ends at the next contact point.
    pub(crate) const LEAST: f64 = 1e-16;

    /// Rounding of a resultant relative to the sum of the magnitudes of its forces.
    pub(crate) const RESULTANT: f64 = 8.0 * f64::EPSILON;
}

/// Load paths. Reactions are relative to the largest reaction, gaps to the largest deflection or to their own free
/// travel.
pub(super) mod path {
    /// Reactions and gaps of the wrong sign at the ends of a segment that count as rounding: a hundred times the value
    /// for one solution, since a segment starts from the end of the one before.
    pub(crate) const SIGN: f64 = 1e-9;

    /// Relative tolerance for coincident events, relative to a step. A path that advances by less makes no progress.
    pub(crate) const SAME_EVENT: f64 = 1e-9;

    /// Displacement relative to the largest deflection within which events of pivots coincide.
    pub(crate) const SAME_PLACE: f64 = 1e-10;

    /// Smallest t that sets the length of a step. An event at t = 0 has a t of this size by rounding.
    pub(crate) const NO_LOAD: f64 = 1e-9;

    /// Smallest t, at which the plate moves by its least gap, without a change of unit: 10⁵ times [`NO_LOAD`] and
    /// [`SAME_EVENT`].
    pub(crate) const FAR_BELOW: f64 = 1e-4;

    /// Distances behind an event, relative to a step, at which a solve finds the contact state where switching fails.
    pub(crate) const BEYOND: [f64; 5] = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11];

    /// Smallest relative change of reaction or gap that makes a switching point jump.
    pub(crate) const JUMP: f64 = 1e-9;

    /// Largest difference between the refined end of a segment and the end from pivoting, relative to the length of the
    /// segment.
    pub(crate) const MOVED: f64 = 1e-3;

    /// Additional difference, relative to a step that doubles the load: pivots locate events of nearly parallel points
    /// to about 1e-7 of it.
    pub(crate) const SEEN: f64 = 1e-6;

    /// Least length of a line, relative to such a step.
    pub(crate) const SHORT: f64 = 1e-3;

    /// Relative tolerance for a constant reaction or gap over a line.
    pub(crate) const STILL: f64 = 1e-10;

    /// Smallest displacement over a line without events, relative to the largest gap; with a smaller one the line may
    /// be too short.
    pub(crate) const COUNTS: f64 = 0.1;

    /// Largest factor by which such a line is lengthened: a motion much smaller relative to its gap is nearly rounding.
    pub(crate) const LONGER: f64 = 1e12;

    /// Relative tolerance for zero reactions and gaps.
    pub(crate) const NOTHING: f64 = 1e-14;

    /// Smallest resultant relative to its terms that serves as a scale: with it [`SIGN`] equals their rounding.
    pub(crate) const UNSEEN: f64 = 1e-7;
}
