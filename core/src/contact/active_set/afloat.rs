//! A plate afloat, and the load on it.

use crate::contact::kkt::Floating;
use crate::contact::problem::ContactProblem;
use crate::double_double::DoubleDouble;

/// A plate that only springs and points hold, and the load on its rigid motions.
pub(super) struct Afloat {
    pub(super) floating: Floating,
    pub(super) load: [DoubleDouble; 3],
    pub(super) magnitude: f64,
}

impl Afloat {
    /// Nothing where a dof is held, or a point both ways.
    pub(super) fn under(problem: &ContactProblem, load: &[f64]) -> Option<Self> {
        let floating = Floating::of(problem).filter(|_| problem.constraints.rows.is_empty())?;
        let terms = floating.nodal.iter().flat_map(|motion| motion.iter().zip(load).map(|(u, f)| (u * f).abs()));
        Some(Self { magnitude: terms.sum(), load: floating.resultants(load), floating })
    }
}
