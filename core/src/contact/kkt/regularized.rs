//! What increments of reaction and of deflection meet where rounding decides: a compliance and a stiffness.

use crate::contact::problem::ContactProblem;
use crate::contact::tolerances;

/// A contact problem with what increments meet.
pub(crate) struct Regularized<'a> {
    pub(crate) problem: &'a ContactProblem,
    /// Compliance of every point's support, and at least what its increments meet.
    pub(crate) compliance: Vec<f64>,
    /// Stiffness that an increment of deflection meets at every node.
    pub(super) bed: f64,
}

impl<'a> Regularized<'a> {
    /// Increments of reaction meet at least `part` of the plate's own compliance.
    pub(crate) fn of(problem: &'a ContactProblem, part: f64) -> Self {
        assert!(problem.active.is_empty(), "all points are condensed");
        let stiffness = problem.scale.stiffness;
        let least = |i: usize| part / (problem.lever(i) * problem.lever(i) * stiffness);
        let own = problem.constraints.compliance.iter().enumerate();
        let compliance = own.map(|(i, own)| own.max(least(i))).collect();
        let kept = (tolerances::proximal::STIFFNESS * part.sqrt()).max(tolerances::proximal::LEAST_STIFFNESS);
        Self { problem, compliance, bed: kept * stiffness / problem.plate.node_count() as f64 }
    }
}
