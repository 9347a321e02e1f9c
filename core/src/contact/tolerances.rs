//! Every tolerance of the contact problem, with its reference quantity and the reason for its value. ε = 2.2e-16.
//!
//! Iteration limits are beside their loops. Tolerances of the linear complementarity solvers are in `lcp`.

/// Residual at convergence, relative to the largest force (equilibrium) or the largest deflection (laws). A
/// double-double sum that is rounded to a double has an error of a few ε.
pub(super) const RESIDUAL: f64 = 1e-15;

/// Relative tolerance for reactions and gaps of the wrong sign: smaller ones are rounding. Reactions are relative to
/// the largest reaction or to the load, gaps to the largest deflection. 10⁵ ε: the elimination of thin plates amplifies
/// rounding by 10⁵.
pub(super) const SIGN: f64 = 1e-11;

/// Largest ratio of successive residual norms at which refinement continues with single corrections. A correction with
/// a larger ratio gains less than two bits and is not worth its cost.
pub(super) const PROGRESS: f64 = 0.25;

/// Largest residual of an accepted solution for a fixed contact state, relative to the reference forces and travels.
pub(super) const SOLVED: f64 = 1e-9;

/// A residual above the tolerance `SOLVED` is accepted up to this multiple of √(3n) times the rounding of the internal
/// forces, with n nodes. Such residuals occur in a plate that has not reached its supports yet.
pub(super) const ROUNDINGS: f64 = 4.0;

/// Refinement by conjugate residuals stops if the last ten directions together leave more than this fraction of the
/// residual.
pub(super) const SLOW: f64 = 0.7;

/// Smallest reference deflection, relative to the sum of the forces divided by the plate stiffness D/a².
pub(super) const NIL: f64 = 1e-6;

/// Smallest pivot, relative to the largest pivot, of a small matrix in double-double. A smaller pivot belongs to an
/// unconstrained rigid motion. 10¹⁰ ε²: distances with an error ε give a pivot of about ε².
pub(super) const HELD: f64 = 1e-22;

/// Largest residual at which a response to a load case or contact point needs no further correction, relative to the
/// largest nodal force. Sums of responses are refined again.
pub(super) const RESPONSE: f64 = 1e-13;

/// Rounding error of a sum, relative to the sum of the magnitudes of its terms.
pub(super) const SUM: f64 = 4.0 * f64::EPSILON;

/// Compliance in series with rigid points in the saddle-point system, relative to the compliance a²/D of the plate. The
/// value is about √ε: a smaller compliance loses digits in the factor, a larger one slows refinement.
pub(super) const COMPLIANCE: f64 = 1e-9;

/// Smallest ratio of a pivot to its diagonal entry in a factor of K. With a smaller ratio K counts as singular: the
/// factored springs leave a rigid motion free, or elements q8r form a mechanism. Plates without free motions had ratios
/// of at least 1e-9, slender and soft plates included.
pub(super) const LOOSE_PIVOT: f64 = 1e-13;

/// Relative increase of the diagonal of K if only springs hold the plate and they are too soft for its factor. The
/// value is several roundings, so that every pivot is positive.
pub(super) const DIAGONAL_SHIFT: f64 = 64.0 * f64::EPSILON;

/// The diagonal of K is increased if the softest projected stiffness is less than this multiple of the stiffness that
/// the increase adds. Fewer than three digits of so soft a stiffness are above the rounding of the factor.
pub(super) const SHIFT_BELOW: f64 = 1e3;

/// Tolerances of the condensation onto the contact points.
pub(super) mod interface {
    /// Largest relative difference of the stiffness δ in the factor and the stiffness of a contact point at which they
    /// count as equal: both have a few rounding errors.
    pub(crate) const ABSORBED: f64 = 1e-12;

    /// Entries of q and M in the LCP below this relative size count as zero. Reactions are relative to the load, gaps
    /// to the largest displacement, other entries to the terms of their sums. 10⁴ ε: elimination amplifies rounding by
    /// 10⁴.
    pub(crate) const POSED: f64 = 1e-12;

    /// Rounding error of the sum of stiffness times gap over all condensed points, relative to the sum of the
    /// magnitudes.
    pub(crate) const POSED_SUM: f64 = 1e-14;

    /// Smallest ratio of a diagonal entry of M after the projection off the free rigid motions to the same entry before
    /// it. An entry with a smaller ratio has lost half its digits and counts as zero.
    pub(crate) const PROJECTED: f64 = 1e-6;
}

/// Tolerances of the semismooth Newton method: steps, directions, and penalties of rigid points.
pub(super) mod newton {
    /// Largest penalty, relative to the shear stiffness of an element. With a larger penalty multipliers converge
    /// faster, but residuals lose more digits.
    pub(crate) const STIFFEST: f64 = 1e4;

    /// First penalty, relative to the shear stiffness of an element, divided by (thickness/element size)². The first
    /// penalty is then the ratio of bending to shear stiffness for a wave about thirty elements long.
    pub(crate) const LONG_WAVE: f64 = 0.01;

    /// Relative tolerance of conjugate gradients while the contact state changes. A rough direction suffices to find
    /// the next change.
    pub(crate) const LOOSE: f64 = 0.3;

    /// Relative tolerance of conjugate gradients after several Newton steps in which the contact state changed.
    /// Accurate directions then reduce the number of further steps.
    pub(crate) const FIRM: f64 = 1e-3;

    /// Relative tolerance of conjugate gradients on an unchanged contact state: half the digits of a double. Refinement
    /// gives the other half.
    pub(crate) const TIGHT: f64 = 1e-8;

    /// Residual of the Newton method at convergence, relative to the largest force: 500 ε.
    pub(crate) const SETTLED: f64 = 1e-13;

    /// Multipliers are updated while some points still change their piece of the law, if the residual is at most this
    /// multiple of the residual at convergence, `SETTLED`.
    pub(crate) const NEARLY: f64 = 1e3;

    /// Largest ratio of successive residuals on an unchanged contact state that counts as progress. A larger ratio
    /// means that the residual is mostly rounding.
    pub(crate) const SLOW: f64 = 0.8;

    /// Largest residual, relative to the largest force, of a solution that is accepted when the residual stops falling.
    /// It occurs in the thinnest plates. A larger residual means that supports contradict each other.
    pub(crate) const STALLED: f64 = 1e-3;

    /// Largest residual, relative to the largest force, at which multipliers are updated. An update needs equilibrium.
    pub(crate) const BALANCED: f64 = 1e-3;

    /// Largest slope of the energy at the end of a line search, relative to the slope at its start.
    pub(crate) const FLAT: f64 = 1e-3;

    /// Largest curvature of the energy along a free rigid motion, relative to the curvature with the factored matrix.
    /// 500 ε: the rounding of the sum of squares.
    pub(crate) const FREE: f64 = 1e-13;

    /// Smallest ratio of the curvature of the energy to the curvature with the factored matrix at which it is computed
    /// as a difference. The difference then keeps ten digits. Smaller curvatures are sums of squares.
    pub(crate) const PLAIN: f64 = 1e-6;

    /// Stiffness added to unconstrained rigid motions, relative to the sum of all stiffnesses of points and springs. It
    /// makes the equations of such a motion regular; the motion ends at the next contact point.
    pub(crate) const LEAST: f64 = 1e-16;

    /// Rounding of a resultant, relative to the sum of the magnitudes of the forces in it.
    pub(crate) const RESULTANT: f64 = 8.0 * f64::EPSILON;
}

/// Tolerances of load paths. Reactions are relative to the largest reaction, gaps to the largest deflection or to the
/// gap of the same point without load.
pub(super) mod path {
    /// Relative tolerance for reactions and gaps of the wrong sign at the ends of a segment: smaller ones are rounding.
    /// It is a hundred times the tolerance for a single solution, since each segment starts from the end of the
    /// previous segment.
    pub(crate) const SIGN: f64 = 1e-9;

    /// Largest difference in t of events that count as one event, relative to a step of t. If t increases by less, the
    /// path makes no progress.
    pub(crate) const SAME_EVENT: f64 = 1e-9;

    /// Two events of pivoting count as one event if the plate moves by less than this between them, relative to the
    /// largest deflection.
    pub(crate) const SAME_PLACE: f64 = 1e-10;

    /// On a path without initial load a step of t has the length t, or 1 if t is at most this value: because of rounding
    /// an event at t = 0 may have a t of this size.
    pub(crate) const NO_LOAD: f64 = 1e-9;

    /// A path without initial load changes its unit of t if the plate moves by its least gap at a smaller t than this.
    /// The value is 10⁵ times [`NO_LOAD`] and [`SAME_EVENT`].
    pub(crate) const FAR_BELOW: f64 = 1e-4;

    /// Distances in t beyond an event, relative to a step of t that doubles the load. A solve at these t finds the
    /// contact state after the event if moving points to adjacent pieces of their laws does not find it.
    pub(crate) const BEYOND: [f64; 5] = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11];

    /// The path jumps at an event if the reaction or gap of a point that changes its piece of the law changes by more
    /// than this, relative to its reference size.
    pub(crate) const JUMP: f64 = 1e-9;

    /// Largest difference in t between an event computed from refined solutions and the same event located by pivoting,
    /// relative to the length of the segment.
    pub(crate) const MOVED: f64 = 1e-3;

    /// Term added to the tolerance `MOVED` for the t of an event, relative to a step of t that doubles the load.
    /// Pivoting locates events of nearly parallel points to about 1e-7 of this step.
    pub(crate) const SEEN: f64 = 1e-6;

    /// Least difference in t of the two solutions of a line, relative to a step that doubles the load: the change between
    /// nearer solutions would be rounding.
    pub(crate) const SHORT: f64 = 1e-3;

    /// A reaction or gap that changes by less than this along a segment of a path, relative to its reference size, counts
    /// as constant.
    pub(crate) const STILL: f64 = 1e-10;

    /// A segment without events is long enough to detect a gap that closes if the plate moves along it by at least this
    /// fraction of the largest gap.
    pub(crate) const COUNTS: f64 = 0.1;

    /// Largest factor by which a segment without events is extended in t. A motion of the plate that needs a larger
    /// factor is nearly rounding.
    pub(crate) const LONGER: f64 = 1e12;

    /// Reactions and gaps below this, relative to their reference size, count as zero at the common end of two pieces
    /// of a law.
    pub(crate) const NOTHING: f64 = 1e-14;

    /// Smallest reference force of reactions on a path, relative to the largest nodal force of the load. The tolerance
    /// [`SIGN`] times this force is then the rounding of the nodal force.
    pub(crate) const UNSEEN: f64 = 1e-7;
}
