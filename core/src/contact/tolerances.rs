//! Every tolerance of the contact problem, what it is relative to, and why it has its value. ε is 2.2e-16.
//!
//! Numbers of steps stand beside the loops that they limit; those of the linear complementarity solvers in `lcp`.

/// A residual this small, over the largest force, or over the largest deflection where it is a length, is rounding: what
/// a sum in double-double leaves when it has become a double, a few ε.
pub(super) const RESIDUAL: f64 = 1e-15;

/// Reactions and gaps of the wrong sign, over the largest of their kind or the load, that are rounding: 10⁵ ε, by which
/// the elimination of thin plates magnifies it.
pub(super) const SIGN: f64 = 1e-11;

/// A correction that leaves more than this part of the residual before it is the last: two bits are not worth a solve.
pub(super) const PROGRESS: f64 = 0.25;

/// Residual of a solution of a set's equations, over what each of its entries is measured by.
pub(super) const SOLVED: f64 = 1e-9;

/// Units of rounding of the plate's own forces that a solution may leave if that is more: still more is left where a
/// plate has yet to reach what holds it.
pub(super) const ROUNDINGS: f64 = 4.0;

/// Ten directions that together leave more than this part of the residual are the last.
pub(super) const SLOW: f64 = 0.7;

/// Part of the deflection by which the load scales on the plate, below which no deflection counts.
pub(super) const NIL: f64 = 1e-6;

/// A pivot, in double-double, below this part of the largest is rounding of the lever arms: nothing holds that motion.
/// 10¹⁰ times the square of ε.
pub(super) const HELD: f64 = 1e-22;

/// Residual, over the largest nodal force, of a response that is not worth another correction: sums of responses add no
/// digits to it.
pub(super) const RESPONSE: f64 = 1e-13;

/// What rounding leaves of a sum, over the magnitudes of its terms.
pub(super) const SUM: f64 = 4.0 * f64::EPSILON;

/// Part of the plate's own compliance that is put in series with rigid points where nothing is eliminated: the root of what
/// tells points apart that double precision can.
pub(super) const COMPLIANCE: f64 = 1e-9;

/// A pivot below this part of its diagonal entry is rounding: the points that are carried need not hold the plate, nor the
/// supports a mechanism of q8r. Of what holds, slender and soft plates included, the least seen was 1e-9.
pub(super) const LOOSE_PIVOT: f64 = 1e-13;

/// Part of its own by which a dof is stiffer in a factor that springs alone keep from being singular, and then not by
/// enough for its arithmetic: several roundings, so that every pivot is positive.
pub(super) const FIRMER: f64 = 64.0 * f64::EPSILON;

/// Over what that adds to a rigid motion, how softly springs hold it at least in a factor without it: three digits more
/// than the factor's own rounding.
pub(super) const FIRM_BELOW: f64 = 1e3;

/// Condensation onto the contact points.
pub(super) mod interface {
    /// A point whose stiffness the factor carries to this part of it is carried whole: both are rounded a few times.
    pub(crate) const ABSORBED: f64 = 1e-12;

    /// A posed reaction this small, relative to the load, is zero: the load is balanced without it. So is a gap, relative
    /// to the largest move, and a lever, relative to the moves it is made of: 10⁴ ε of elimination.
    pub(crate) const POSED: f64 = 1e-12;

    /// Rounding of a sum of stiffnesses times gaps over as many points as are condensed.
    pub(crate) const POSED_SUM: f64 = 1e-14;

    /// A stiffness of which the projection leaves less than this part was rounding: half the digits.
    pub(crate) const PROJECTED: f64 = 1e-6;
}

/// The active set: Newton steps, their directions and the penalties of rigid points.
pub(super) mod newton {
    /// Stiffest penalty, over the plate's stiffness in shear, at the end: multipliers converge the faster the stiffer it is,
    /// and residuals lose as many digits.
    pub(crate) const STIFFEST: f64 = 1e4;

    /// How much stiffer the penalty becomes from stage to stage.
    pub(crate) const STIFFER: f64 = 10.0;

    /// Bending stiffness over that in shear of a wave of ten elements, over the square of thickness over element size:
    /// the first penalty.
    pub(crate) const LONG_WAVE: f64 = 0.04;

    /// What conjugate gradients leave of the residual while the set still changes: its next change needs no more.
    pub(crate) const LOOSE: f64 = 0.3;

    /// The same after some steps without the set settling: true Newton directions then need fewer.
    pub(crate) const FIRM: f64 = 1e-3;

    /// The same where the set does not change: half the digits, the refined residual brings the others.
    pub(crate) const TIGHT: f64 = 1e-8;

    /// Residual, over the largest force, at which the points are settled: 500 ε.
    pub(crate) const SETTLED: f64 = 1e-13;

    /// Times that from which points are looked at anew although some still change sides.
    pub(crate) const NEARLY: f64 = 1e3;

    /// Steps on one set that leave this part of the residual tell that the rest is rounding.
    pub(crate) const SLOW: f64 = 0.8;

    /// What rounding leaves at most of the largest force, in the thinnest plates; where it stalls above, supports
    /// contradict each other.
    pub(crate) const STALLED: f64 = 1e-3;

    /// Residual, over the largest force, up to which multipliers are renewed: they follow an equilibrium.
    pub(crate) const BALANCED: f64 = 1e-3;

    /// Change of the multipliers, over the largest force, at which the next stage begins.
    pub(crate) const STEADY: f64 = 5e-2;

    /// Slope of the energy that ends a line search, over the slope at its start.
    pub(crate) const FLAT: f64 = 1e-3;

    /// Curvature along a direction, over that of the factored matrix, below which the plate is taken to be free along it:
    /// 500 ε, which the sum of squares leaves of nothing.
    pub(crate) const FREE: f64 = 1e-13;

    /// Curvature, over that of the factored matrix, from which on what cancels in its sum does not matter: ten digits are
    /// left.
    pub(crate) const PLAIN: f64 = 1e-6;

    /// Stiffness that these motions meet, over that of all points together, so that those that nothing holds end at the
    /// next point.
    pub(crate) const LEAST: f64 = 1e-16;

    /// Resultants, over the forces that they are the sum of, that are rounding.
    pub(crate) const RESULTANT: f64 = 8.0 * f64::EPSILON;
}

/// Load paths. Reactions count over the largest, gaps over the largest deflection or their own travel.
pub(super) mod path {
    /// Of the wrong sign at the ends of a segment, they are rounding: a hundred times that of one solution, since a
    /// segment goes on from the end of the one before.
    pub(crate) const SIGN: f64 = 1e-9;

    /// Events nearer than this part of a step are one, and a path that goes no farther stands still.
    pub(crate) const SAME_EVENT: f64 = 1e-9;

    /// Travel, over the largest deflection, within which events of pivots are one.
    pub(crate) const SAME_PLACE: f64 = 1e-10;

    /// Of a unit of what is added, so little says nothing of how far to step: an event at no load that rounding leaves there.
    pub(crate) const NO_LOAD: f64 = 1e-9;

    /// Part of t = 1 below which a plate that moves by its least gap needs a smaller unit: a hundred thousand times more than
    /// [`NO_LOAD`] and than what is one event.
    pub(crate) const FAR_BELOW: f64 = 1e-4;

    /// How far beyond an event, over a step, a solve tells the contact set after it where switching does not.
    pub(crate) const BEYOND: [f64; 5] = [1e-3, 1e-5, 1e-7, 1e-9, 1e-11];

    /// With more than this a point that switches jumps instead.
    pub(crate) const JUMP: f64 = 1e-9;

    /// How far, over a segment's length, its refined end may be from where pivoting saw it.
    pub(crate) const MOVED: f64 = 1e-3;

    /// How far beside that, over a step that changes the load by as much as there is of it: pivots see where points nearly
    /// alike switch to 1e-7 or so of it.
    pub(crate) const SEEN: f64 = 1e-6;

    /// The least length of a line, over such a step.
    pub(crate) const SHORT: f64 = 1e-3;

    /// Reactions and gaps that change by less over a line stay.
    pub(crate) const STILL: f64 = 1e-10;

    /// A line without events that moves the plate by less than this part of the largest gap may be too short.
    pub(crate) const COUNTS: f64 = 0.1;

    /// Times that it is made longer at most: a motion much smaller over its gap is nearly rounding.
    pub(crate) const LONGER: f64 = 1e12;

    /// Reactions and gaps that are none.
    pub(crate) const NOTHING: f64 = 1e-14;

    /// Part of the loads that a load is the sum of which, as a scale, turns [`SIGN`] into their rounding.
    pub(crate) const UNSEEN: f64 = 1e-7;
}

/// The interior point method, in units in which every dof has the stiffness 1.
pub(super) mod interior_point {
    /// Relative duality gap and residuals asked for; where rounding keeps them larger, the last iterate is taken.
    pub(crate) const GAP: f64 = 1e-11;

    /// Stiffness added to the dofs: less than Clarabel's own 1e-8, which a thin plate's bending is as soft as.
    pub(crate) const REGULARIZATION: f64 = 1e-10;

    /// So little added needs refinement for as long as each step leaves less than the one before by this factor: Clarabel's
    /// own, to a fifth, ends the last iterations before a proof of infeasibility is sharp.
    pub(crate) const REFINING: f64 = 1.5;

    /// Residuals of a proof of infeasibility, over the magnitudes they are made of, up to which it is believed: √ε.
    pub(crate) const PROOF: f64 = 1e-8;

    /// What it must prove, over the magnitudes that is made of: so much more that the residuals could not undo it.
    pub(crate) const MARGIN: f64 = 1e-6;
}
