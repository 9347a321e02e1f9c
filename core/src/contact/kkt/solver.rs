//! The trait of solvers for a fixed contact state, and their result.

use crate::cholesky::FactorError;
use crate::contact::residual::Residual;

/// Solves the equations of one contact state after another.
pub(in crate::contact) trait Kkt {
    /// Prepares a contact state; false if it leaves a rigid motion free, or rigid points contradict each other.
    fn prepare(&mut self, pieces: &[u8]) -> Result<bool, FactorError>;

    /// The correction for a residual; `None` if the contact state leaves a rigid motion free.
    fn solve(&mut self, right: &Residual) -> Result<Option<Correction>, FactorError>;

    /// The rigid motions of plates without held dofs for a residual, with the increments of reaction they cause. They
    /// are applied before the rest of the correction, and added exactly.
    fn rigid(&self, _right: &Residual) -> Option<Correction> {
        None
    }

    /// Whether the forces that the next correction adds for the violations are rounding relative to a force.
    fn is_settled(&self, _right: &Residual, _force: f64) -> bool {
        true
    }
}

/// Rigid motions of the plates, nodal displacements (3n,) in addition, and increments of reaction (m,).
#[derive(Clone)]
pub(in crate::contact) struct Correction {
    /// (w, θx, θy) at the centre of each component; empty for solvers without rigid motions.
    pub(in crate::contact) rigid: Vec<[f64; 3]>,
    pub(in crate::contact) nodal: Vec<f64>,
    pub(in crate::contact) reaction: Vec<f64>,
}

impl Correction {
    /// A correction without separate rigid motions.
    pub(in crate::contact) fn of(nodal: Vec<f64>, reaction: Vec<f64>) -> Self {
        Self { rigid: Vec::new(), nodal, reaction }
    }
}
