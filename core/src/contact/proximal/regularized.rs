//! A contact problem in which increments of reaction meet a compliance, and those of deflection a stiffness.

use crate::contact::problem::ContactProblem;
use crate::contact::refinement::Residual;
use crate::contact::rigid::{extent, rigidity};
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;
use crate::element::DOFS;
use crate::residual::internal_magnitude;

/// A contact problem with what increments of reaction meet.
pub(super) struct Regularized<'a> {
    pub(super) problem: &'a ContactProblem,
    /// Compliance of every point's support, and at least what its increments meet.
    pub(super) compliance: Vec<f64>,
    /// What a gap is measured by beside lengths: 1, or for a slope one over the plate's size.
    pub(super) per_length: Vec<f64>,
    /// D/a².
    pub(super) own_stiffness: f64,
    /// Stiffness that an increment of deflection meets at every node.
    pub(super) bed: f64,
    /// A force whose rounding is none of the solution's fault.
    pub(super) beside: f64,
}

impl<'a> Regularized<'a> {
    pub(super) fn of(problem: &'a ContactProblem, part: f64, beside: f64) -> Self {
        assert!(problem.active.is_empty(), "all points are condensed");
        let constraints = &problem.constraints;
        let (_, size) = extent(&problem.plate);
        let own_stiffness = rigidity(&problem.plate) / (size * size);
        let turns = |row: &[f64; DOFS]| row.iter().step_by(3).all(|&value| value == 0.0);
        let per_length = |row| if turns(row) { 1.0 / size } else { 1.0 };
        let per_length: Vec<f64> = constraints.rows.coefficient.iter().map(per_length).collect();
        let least = per_length.iter().map(|unit| part * unit * unit / own_stiffness);
        let compliance = constraints.compliance.iter().zip(least).map(|(own, least)| own.max(least)).collect();
        let kept = (tolerances::proximal::STIFFNESS * part.sqrt()).max(tolerances::proximal::LEAST_STIFFNESS);
        let bed = kept * own_stiffness / problem.plate.node_count() as f64;
        Self { problem, compliance, per_length, own_stiffness, bed, beside }
    }

    /// A length by which those of a plate that hardly deflects are measured; far less than the load would deflect it.
    pub(super) fn least_length(&self, load: &[f64]) -> f64 {
        let (_, size) = extent(&self.problem.plate);
        let by_force = |(dof, f): (usize, &f64)| if dof % 3 == 0 { f.abs() } else { f.abs() / size };
        let springs = &self.problem.springs;
        let settled: f64 = springs.stiffness.iter().zip(&springs.base).map(|(k, base)| (k * base).abs()).sum();
        tolerances::proximal::NIL * (load.iter().enumerate().map(by_force).sum::<f64>() + settled) / self.own_stiffness
    }

    /// Whether a residual is that of a solution.
    pub(super) fn solved(&self, load: &[f64], step: &Residual, solution: &ContactSolution) -> bool {
        let (plate, held) = (&self.problem.plate, &self.problem.held);
        let internal = internal_magnitude(plate, held, &solution.displacement);
        let force = self.problem.largest_force(load, solution).max(self.beside);
        let rounding = tolerances::proximal::ROUNDINGS * f64::EPSILON * internal * (plate.dof_count() as f64).sqrt();
        self.length(load, step, solution)
            <= tolerances::proximal::SOLVED.max(if force > 0.0 { rounding / force } else { 0.0 })
    }
}
