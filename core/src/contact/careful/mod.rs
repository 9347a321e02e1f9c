//! Solves where rounding decides: points that nearly repeat each other, plates that hardly anything holds.
//!
//! Proximal steps (Rockafellar 1976) regularize the problem without changing its answer: each solves an LCP past the
//! reactions that act already, in which increments of reaction meet a compliance and increments of deflection a
//! stiffness (`proximal`). `saddle` solves the equations of a contact state without condensing them, `floating` keeps
//! large rigid motions apart, `krylov` takes away what the regularization leaves, and `steps` goes from one contact set
//! to the next. docs/theory.md, section 6, says why.

mod floating;
mod krylov;
mod proximal;
mod saddle;
mod shears;
mod steps;

use super::active_set::Progress;
use super::problem::ContactProblem;
use super::refinement::Step;
use super::solution::{ContactSolution, Outcome};
use crate::element::DOFS;
use crate::residual::internal_magnitude;
use floating::{Floating, rigidity};
pub(super) use floating::{eliminated, extent, rigid_motions};
use saddle::Saddle;

/// Part of the plate's own stiffness that increments of deflection meet, all nodes together: so many times the root of
/// the part by which reactions yield, and at least the other. Much less would drown the rest of an LCP in how far a loose
/// plate goes.
const KEEPING: f64 = 100.0;
const LEAST_KEPT: f64 = 1e-3;

/// Part of the plate's own compliance where the contact set is given.
const PART_ON_A_SET: f64 = 1e-9;

/// Part of the deflection by which the load scales on the plate, below which no deflection counts.
const NIL: f64 = 1e-6;

/// Length of the residual of a solution, or units of rounding of the plate's own forces if that is more; still more is
/// left where a plate has yet to reach what holds it.
const SOLVED: f64 = 1e-9;
const ROUNDINGS: f64 = 4.0;

/// A contact problem with what increments of reaction meet.
struct Careful<'a> {
    problem: &'a ContactProblem,
    /// Compliance of every point's support, and at least what its increments meet.
    compliance: Vec<f64>,
    /// What a gap is measured by beside lengths: 1, or for a slope one over the plate's size.
    per_length: Vec<f64>,
    /// D/a².
    own_stiffness: f64,
    /// Stiffness that an increment of deflection meets at every node.
    bed: f64,
    /// A force whose rounding is none of the solution's fault.
    beside: f64,
}

impl ContactProblem {
    /// As [`ContactProblem::solve`], by proximal steps; without points of an active set.
    ///
    /// Increments of reaction meet at least `part` of the plate's own compliance. The steps begin with a contact set if
    /// there is one, and end where the equations of one set give the right signs; if none does, with the last step.
    /// `watch` sees every step and stops it by returning false.
    pub fn solve_carefully(
        &self,
        load: &[f64],
        held_value: &[f64],
        part: f64,
        closed: Option<&[bool]>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> ContactSolution {
        let careful = Careful::of(self, part, 0.0);
        careful.solve(load, self.at_rest(load.len(), held_value), closed.map(<[bool]>::to_vec), watch)
    }

    /// As [`ContactProblem::solve_on`], by the uncondensed equations; not solved where more is left than rounding, of the
    /// force `beside` too.
    pub(super) fn solve_carefully_on(
        &self,
        load: &[f64],
        held_value: &[f64],
        closed: &[bool],
        beside: f64,
    ) -> ContactSolution {
        let careful = Careful::of(self, PART_ON_A_SET, beside);
        let mut solution = self.at_rest(load.len(), held_value);
        solution.closed = closed.to_vec();
        let Some(saddle) = Saddle::of(&careful, closed) else {
            return solution.failed(Outcome::Unsolved);
        };
        let step = self.step(load, &solution);
        let floating = Floating::of(&careful, closed);
        let left = careful.refine(load, &saddle, floating.as_ref(), &step, &mut solution);
        solution.leave_open(&left.remaining);
        if careful.solved(load, &left, &solution) { solution.solved() } else { solution.failed(Outcome::Unsolved) }
    }
}

impl<'a> Careful<'a> {
    fn of(problem: &'a ContactProblem, part: f64, beside: f64) -> Self {
        assert!(problem.active.is_empty(), "all points are condensed");
        let constraints = &problem.constraints;
        let (_, size) = extent(&problem.plate);
        let own_stiffness = rigidity(&problem.plate) / (size * size);
        let turns = |row: &[f64; DOFS]| row.iter().step_by(3).all(|&value| value == 0.0);
        let per_length = |row| if turns(row) { 1.0 / size } else { 1.0 };
        let per_length: Vec<f64> = constraints.rows.coefficient.iter().map(per_length).collect();
        let least = per_length.iter().map(|unit| part * unit * unit / own_stiffness);
        let compliance = constraints.compliance.iter().zip(least).map(|(own, least)| own.max(least)).collect();
        let kept = (KEEPING * part.sqrt()).max(LEAST_KEPT);
        let bed = kept * own_stiffness / problem.plate.node_count() as f64;
        Self { problem, compliance, per_length, own_stiffness, bed, beside }
    }

    /// A length by which those of a plate that hardly deflects are measured; far less than the load would deflect it.
    fn least_length(&self, load: &[f64]) -> f64 {
        let (_, size) = extent(&self.problem.plate);
        let by_force = |(dof, f): (usize, &f64)| if dof % 3 == 0 { f.abs() } else { f.abs() / size };
        let springs = &self.problem.springs;
        let settled: f64 = springs.stiffness.iter().zip(&springs.base).map(|(k, base)| (k * base).abs()).sum();
        NIL * (load.iter().enumerate().map(by_force).sum::<f64>() + settled) / self.own_stiffness
    }

    /// Whether a residual is that of a solution.
    fn solved(&self, load: &[f64], step: &Step, solution: &ContactSolution) -> bool {
        let (plate, held) = (&self.problem.plate, &self.problem.held);
        let internal = internal_magnitude(plate, held, &solution.displacement);
        let force = self.problem.largest_force(load, solution).max(self.beside);
        let rounding = ROUNDINGS * f64::EPSILON * internal * (plate.dof_count() as f64).sqrt();
        self.length(load, step, solution) <= SOLVED.max(if force > 0.0 { rounding / force } else { 0.0 })
    }
}
