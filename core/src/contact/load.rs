//! The load for one solve of a contact problem.

use super::error::{SolveError, require_length};
use super::problem::ContactProblem;

/// A load: nodal forces (3n,), and the prescribed values (3n,) of held dofs.
#[derive(Clone, Copy, Debug)]
pub struct Load<'a> {
    pub nodal: &'a [f64],
    pub held_value: &'a [f64],
}

impl Load<'_> {
    pub(super) fn require_lengths(&self, problem: &ContactProblem) -> Result<(), SolveError> {
        let dofs = problem.plate.dof_count();
        require_length("the load", self.nodal.len(), dofs)?;
        require_length("held_value", self.held_value.len(), dofs)
    }
}
