//! The trait of solvers for a fixed contact state, and the correction that such a solver returns.

use crate::cholesky::FactorError;
use crate::contact::residual::Residual;

/// Solves the linear equations of one contact state after another.
pub(in crate::contact) trait Kkt {
    /// Prepares the solver for a contact state. Returns false if the state leaves a rigid motion free, or if rigid
    /// points contradict each other.
    fn prepare(&mut self, pieces: &[u8]) -> Result<bool, FactorError>;

    /// The correction that removes a residual; `None` if the contact state leaves a rigid motion free.
    fn solve(&mut self, right: &Residual) -> Result<Option<Correction>, FactorError>;

    /// The rigid motions of plates without held dofs that balance a residual, and the increments of reaction that these
    /// motions cause. They precede the rest of the correction and are added without rounding.
    fn rigid(&self, _right: &Residual) -> Option<Correction> {
        None
    }

    /// Whether the forces by which the next correction would remove the violations are rounding relative to `force`.
    fn is_settled(&self, _right: &Residual, _force: f64) -> bool {
        true
    }
}

/// Increment of a solution: rigid motions of the plates, nodal displacements (3n,) in addition to these motions, and
/// increments of reaction (m,).
#[derive(Clone)]
pub(in crate::contact) struct Correction {
    /// Rigid motion (w, θx, θy) of each component, at the centre of the plate; empty if the solver has no rigid
    /// motions.
    pub(in crate::contact) rigid: Vec<[f64; 3]>,
    pub(in crate::contact) nodal: Vec<f64>,
    pub(in crate::contact) reaction: Vec<f64>,
}

impl Correction {
    /// Makes a correction without separate rigid motions.
    pub(in crate::contact) fn of(nodal: Vec<f64>, reaction: Vec<f64>) -> Self {
        Self { rigid: Vec::new(), nodal, reaction }
    }
}
