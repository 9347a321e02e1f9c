//! Every tolerance of the contact problem, with its reference quantity and the reason for its value. ε = 2.2e-16.
//!
//! Iteration limits stand beside their loops, tolerances of the linear complementarity solvers in `lcp`.

/// Relative residual at convergence: forces relative to the largest force, lengths to the largest deflection. A
/// double-double sum that is rounded to a double has an error of a few ε.
pub(super) const RESIDUAL: f64 = 1e-15;

/// Reactions and gaps of the wrong sign up to this value count as rounding. Reactions are relative to the largest
/// reaction or to the load, gaps to the largest deflection. 10⁵ ε: the elimination of thin plates amplifies rounding by
/// 10⁵.
pub(super) const SIGN: f64 = 1e-11;

/// Largest ratio of successive residual norms at which refinement continues. A correction that gains less than two bits
/// is not worth its cost.
pub(super) const PROGRESS: f64 = 0.25;

/// Largest scaled residual of an accepted solution for a fixed contact state.
pub(super) const SOLVED: f64 = 1e-9;

/// An accepted residual may also be this multiple of √(3n) times the rounding of the internal forces. A plate that has
/// not reached its supports yet has a larger residual.
pub(super) const ROUNDINGS: f64 = 4.0;

/// Refinement by conjugate residuals stops if the last ten directions together leave more than this part of the
/// residual.
pub(super) const SLOW: f64 = 0.7;

/// Smallest reference deflection, relative to the load divided by the plate stiffness D/a².
pub(super) const NIL: f64 = 1e-6;

/// Relative tolerance for pivots of small matrices in double-double. A smaller pivot belongs to an unconstrained rigid
/// motion. 10¹⁰ ε²: lever arms with an error ε give a pivot of about ε².
pub(super) const HELD: f64 = 1e-22;

/// Residual at which a response needs no further correction, relative to the largest nodal force. Sums of responses are
/// corrected again.
pub(super) const RESPONSE: f64 = 1e-13;

/// Rounding error of a sum, relative to the sum of the magnitudes of its terms.
pub(super) const SUM: f64 = 4.0 * f64::EPSILON;

/// Compliance in series with rigid points in the saddle-point form, relative to the compliance a²/D of the plate. It is
/// of the order of √ε: a smaller one loses digits in the factor, a larger one slows refinement.
pub(super) const COMPLIANCE: f64 = 1e-9;

/// Relative tolerance for pivots: the matrix is singular if a pivot divided by its diagonal entry is smaller. This
/// occurs where the factored springs leave a rigid motion free, and in mechanisms of q8r. Plates without free motions
/// had pivots of at least 1e-9, slender and soft plates included.
pub(super) const LOOSE_PIVOT: f64 = 1e-13;

/// Relative diagonal shift of K where springs alone hold the plate and are too soft for its factor. It is several
/// roundings, so that every pivot is positive.
pub(super) const DIAGONAL_SHIFT: f64 = 64.0 * f64::EPSILON;

/// The diagonal shift is applied where the softest projected stiffness is less than this multiple of the stiffness that
/// the shift adds. Such a stiffness has less than three digits above the rounding of the factor.
pub(super) const SHIFT_BELOW: f64 = 1e3;

/// Condensation onto the contact points.
pub(super) mod interface {
    /// Relative tolerance for the equality of the factored stiffness δ and the stiffness of a point: both have a few
    /// rounding errors.
    pub(crate) const ABSORBED: f64 = 1e-12;

    /// Relative tolerance for zeros of q and M: reactions relative to the load, gaps to the largest displacement, other
    /// entries to their terms. 10⁴ ε: elimination amplifies rounding by 10⁴.
    pub(crate) const POSED: f64 = 1e-12;

    /// Rounding of a sum of stiffness times gap over all condensed points, relative to the sum of magnitudes.
    pub(crate) const POSED_SUM: f64 = 1e-14;

    /// Smallest significant ratio of a diagonal entry after the projection to the entry before: half the digits.
    pub(crate) const PROJECTED: f64 = 1e-6;
}

/// Semismooth Newton method: steps, directions, and penalties of rigid points.
pub(super) mod newton {
    /// Largest penalty, relative to the shear stiffness of an element. With a larger penalty multipliers converge
    /// faster, and residuals lose as many digits.
    pub(crate) const STIFFEST: f64 = 1e4;

    /// First penalty divided by (h/element size)²: the ratio of bending to shear stiffness for a wave of twenty
    /// elements.
    pub(crate) const LONG_WAVE: f64 = 0.01;

    /// Relative tolerance of conjugate gradients while the contact state changes: a rough direction suffices to find
    /// the next change.
    pub(crate) const LOOSE: f64 = 0.3;

    /// Relative tolerance of conjugate gradients after several Newton steps in which the contact state changes:
    /// accurate directions then reduce the number of steps.
    pub(crate) const FIRM: f64 = 1e-3;

    /// Relative tolerance of conjugate gradients on an unchanged contact state: half the digits. Refinement gives the
    /// other half.
    pub(crate) const TIGHT: f64 = 1e-8;

    /// Residual at convergence, relative to the largest force: 500 ε.
    pub(crate) const SETTLED: f64 = 1e-13;

    /// Multiple of `SETTLED` at which multipliers are updated although some points still change their piece.
    pub(crate) const NEARLY: f64 = 1e3;

    /// Smallest ratio of successive residuals on an unchanged contact state that counts as stagnation by rounding.
    pub(crate) const SLOW: f64 = 0.8;

    /// Largest relative residual that rounding explains; it occurs in the thinnest plates. A larger residual means that
    /// supports contradict each other.
    pub(crate) const STALLED: f64 = 1e-3;

    /// Largest residual, relative to the largest force, at which multipliers are updated: an update needs equilibrium.
    pub(crate) const BALANCED: f64 = 1e-3;

    /// Slope of the energy at the end of a line search, relative to the slope at its start.
    pub(crate) const FLAT: f64 = 1e-3;

    /// Curvature of a free rigid motion, relative to the curvature with the factored matrix: 500 ε, the rounding of the
    /// sum of squares.
    pub(crate) const FREE: f64 = 1e-13;

    /// Smallest curvature, relative to the curvature with the factored matrix, that is computed as a difference. The
    /// difference then keeps ten digits.
    pub(crate) const PLAIN: f64 = 1e-6;

    /// Stiffness added to unconstrained rigid motions, relative to the sum of all stiffnesses of points and springs.
    /// With it such a motion ends at the next contact point.
    pub(crate) const LEAST: f64 = 1e-16;

    /// Rounding of a resultant relative to the sum of the magnitudes of its forces.
    pub(crate) const RESULTANT: f64 = 8.0 * f64::EPSILON;
}

/// Load paths. Reactions are relative to the largest reaction, gaps to the largest deflection or to their own free
/// travel.
pub(super) mod path {
    /// Reactions and gaps of the wrong sign up to this value count as rounding at the ends of a segment. It is a
    /// hundred times the value for one solution, since each segment starts from the end of the previous one.
    pub(crate) const SIGN: f64 = 1e-9;

    /// Relative tolerance for coincident events, relative to a step of t. A path that advances by less makes no
    /// progress.
    pub(crate) const SAME_EVENT: f64 = 1e-9;

    /// Events of pivoting coincide if the plate moves by less than this between them, relative to the largest
    /// deflection.
    pub(crate) const SAME_PLACE: f64 = 1e-10;

    /// Smallest t that sets the length of a step. By rounding, an event at t = 0 may have a t of this size.
    pub(crate) const NO_LOAD: f64 = 1e-9;

    /// The unit of t is changed if the plate moves by its least gap within a smaller t than this. It is 10⁵ times
    /// [`NO_LOAD`] and [`SAME_EVENT`].
    pub(crate) const FAR_BELOW: f64 = 1e-4;

    /// Steps of t past an event, relative to a step that doubles the load. Where exchanging pieces fails, a solve there
    /// finds the contact state.
    pub(crate) const BEYOND: [f64; 5] = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11];

    /// Smallest relative difference of reaction or gap of a switching point at which the path has a jump.
    pub(crate) const JUMP: f64 = 1e-9;

    /// Largest difference in t between an event from refined solutions and the event from pivoting, relative to the
    /// length of the segment.
    pub(crate) const MOVED: f64 = 1e-3;

    /// Additional difference, relative to a step that doubles the load. Pivoting locates events of nearly parallel
    /// points to about 1e-7 of this step.
    pub(crate) const SEEN: f64 = 1e-6;

    /// Least length of a line in t, relative to a step that doubles the load.
    pub(crate) const SHORT: f64 = 1e-3;

    /// Relative tolerance for a reaction or gap that is constant over a line.
    pub(crate) const STILL: f64 = 1e-10;

    /// Displacement over a line without events, relative to the largest gap, at which the line is long enough to detect
    /// that the gap closes.
    pub(crate) const COUNTS: f64 = 0.1;

    /// Largest factor by which such a line is lengthened. A smaller motion relative to the gap is nearly rounding.
    pub(crate) const LONGER: f64 = 1e12;

    /// Relative tolerance for zero reactions and gaps.
    pub(crate) const NOTHING: f64 = 1e-14;

    /// Smallest reference force, relative to the sum of the magnitudes of the load: a tolerance of [`SIGN`] times it
    /// equals the rounding of that sum.
    pub(crate) const UNSEEN: f64 = 1e-7;
}
