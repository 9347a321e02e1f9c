//! What solves the equations of points on given pieces, and what it gives.

use crate::cholesky::FactorError;
use crate::contact::residual::Residual;

/// Solves the equations of one set of pieces after another.
pub(in crate::contact) trait Kkt {
    /// Makes ready for pieces; false where they do not hold the plate, or rigid ones contradict each other.
    fn prepare(&mut self, pieces: &[u8]) -> Result<bool, FactorError>;

    /// What residuals ask for; `None` where the pieces do not hold the plate.
    fn solve(&mut self, right: &Residual) -> Result<Option<Correction>, FactorError>;

    /// Where no dof holds a plate, the rigid motions that a residual asks for, and the increments of reaction that go with
    /// it: made first, and added exactly.
    fn rigid(&self, _right: &Residual) -> Option<Correction> {
        None
    }

    /// Whether the violations are rounding also in the forces that the next correction would make of them.
    fn is_settled(&self, _right: &Residual, _force: f64) -> bool {
        true
    }
}

/// Rigid motions of the plates, a motion of its nodes on top of it, and increments of reaction.
#[derive(Clone)]
pub(in crate::contact) struct Correction {
    /// Deflection and slopes at the middle of every component; empty of a solver without them.
    pub(in crate::contact) rigid: Vec<[f64; 3]>,
    pub(in crate::contact) nodal: Vec<f64>,
    pub(in crate::contact) reaction: Vec<f64>,
}

impl Correction {
    /// Without rigid motions apart.
    pub(in crate::contact) fn of(nodal: Vec<f64>, reaction: Vec<f64>) -> Self {
        Self { rigid: Vec::new(), nodal, reaction }
    }
}
