//! What a solution leaves of the equations on its pieces, in double-double, and what that is measured by.

use super::interface::{Form, Reduced};
use super::points::Points;
use super::problem::ContactProblem;
use super::scale::norm;
use super::solution::ContactSolution;
use super::tolerances;
use crate::cholesky::FactorError;
use crate::element::packed;
use crate::residual::{internal_magnitudes, residual};

/// What is out of balance, and by how much points are off their pieces.
#[derive(Clone, Default)]
pub(super) struct Residual {
    /// Nodal forces that nothing balances; zero at the dofs held.
    pub(super) imbalance: Vec<f64>,
    /// Travel from every point to its piece, r being the force: s₀ − row·u + (r − r₀)/k.
    pub(super) violation: Vec<f64>,
    /// Largest imbalance as a force.
    pub(super) worst: f64,
}

impl Residual {
    pub(super) fn of(problem: &ContactProblem, load: &[f64], solution: &ContactSolution) -> Self {
        Self::from(problem, load, solution, &solution.piece)
    }

    /// With violations of other pieces than the solution's.
    pub(super) fn from(problem: &ContactProblem, load: &[f64], solution: &ContactSolution, pieces: &[u8]) -> Self {
        Self { violation: violation(problem, solution, pieces), ..Self::of_forces(problem, load, solution) }
    }

    /// Of the forces alone.
    pub(super) fn of_forces(problem: &ContactProblem, load: &[f64], solution: &ContactSolution) -> Self {
        let mut imbalance = residual(&problem.plate, &problem.springs, load, &solution.displacement);
        problem.points.scatter_all(&solution.reaction, -1.0, &mut imbalance);
        problem.release_held(&mut imbalance);
        let worst = problem.scale.largest(&imbalance);
        Self { imbalance, violation: Vec::new(), worst }
    }

    /// What is out of balance, then the violations of points that hold, each over its size.
    pub(super) fn scaled(&self, problem: &ContactProblem, sizes: &Sizes, pieces: &[u8]) -> Vec<f64> {
        let couple = sizes.force * problem.scale.arm;
        let forces = self.imbalance.chunks(3).flat_map(|f| [f[0] / sizes.force, f[1] / couple, f[2] / couple]);
        let holding = (0..pieces.len()).filter(|&i| problem.points.graph(i).piece(pieces[i]).holds());
        forces.chain(holding.map(|i| self.violation[i] / sizes.travel[i])).collect()
    }

    /// Whether it is that of a solution of the equations; where nothing acts there is nothing to miss.
    pub(super) fn is_solved(
        &self,
        problem: &ContactProblem,
        load: &[f64],
        solution: &ContactSolution,
        least: f64,
    ) -> bool {
        let sizes = Sizes::of(problem, load, solution, least);
        let length = norm(&self.scaled(problem, &sizes, &solution.piece));
        let force = acting(problem, load, solution, least);
        if length <= tolerances::SOLVED || force == 0.0 {
            return length.is_finite();
        }
        let roundings = tolerances::ROUNDINGS * (problem.plate.dof_count() as f64).sqrt();
        length <= roundings * rounding(problem, solution) / force
    }
}

impl ContactSolution {
    /// Takes what a residual says of the travels for the gaps.
    pub(super) fn measure_gaps(&mut self, points: &Points, residual: &Residual) {
        for (i, gap) in self.gap.iter_mut().enumerate() {
            *gap = if points.piece(i, self.piece[i]).holds() { 0.0 } else { residual.violation[i] };
        }
    }
}

/// What a residual is measured by: forces, and the travel of every point.
pub(super) struct Sizes {
    pub(super) force: f64,
    travel: Vec<f64>,
}

impl Sizes {
    /// By a solution, and a force whose rounding is none of its fault.
    pub(super) fn of(problem: &ContactProblem, load: &[f64], solution: &ContactSolution, least: f64) -> Self {
        let or_one = |size: f64| if size > 0.0 { size } else { 1.0 };
        let force = match acting(problem, load, solution, least) {
            // Nothing acts and no point reacts: what the plate's own forces are the sum of.
            0.0 => or_one(rounding(problem, solution) / f64::EPSILON),
            force => force,
        };
        let nil = least_length(problem, load);
        let length = |(i, length): (usize, f64)| or_one(length.max(nil / problem.points.arm[i]));
        Self { force, travel: lengths(problem, solution).into_iter().enumerate().map(length).collect() }
    }
}

impl ContactProblem {
    /// A residual after forward substitution, and what it does at the points.
    pub(super) fn reduced(&self, residual: &Residual, form: Form) -> Result<Reduced, FactorError> {
        let mut forward = self.blueprint.gather(&residual.imbalance);
        self.base.factor.forward(&mut forward)?;
        Ok(self.interface().reduced(form, forward, &residual.violation)?)
    }
}

/// s₀ − row·u + (r − r₀)/k of every point on a piece.
fn violation(problem: &ContactProblem, solution: &ContactSolution, pieces: &[u8]) -> Vec<f64> {
    let points = &problem.points;
    let on: Vec<_> = pieces.iter().enumerate().map(|(i, &piece)| points.piece(i, piece)).collect();
    let from: Vec<f64> = on.iter().map(|piece| piece.travel).collect();
    let mut travel = points.travel_from(&from, &solution.displacement);
    for ((travel, piece), reaction) in travel.iter_mut().zip(&on).zip(&solution.reaction) {
        *travel = piece.compliance() * (reaction - piece.force) - *travel;
    }
    travel
}

/// Largest force of a load and of reactions.
pub(super) fn largest_force(problem: &ContactProblem, load: &[f64], reaction: &[f64]) -> f64 {
    let forces = reaction.iter().zip(&problem.points.arm).map(|(reaction, arm)| reaction.abs() / arm);
    forces.fold(problem.scale.largest(load), f64::max)
}

/// The same, of forces that count at least; without a load also what bends the plate as far as it moves, or points that hold
/// are away, beside which reactions of springs that just touch are rounding.
fn acting(problem: &ContactProblem, load: &[f64], solution: &ContactSolution, least: f64) -> f64 {
    let force = largest_force(problem, load, &solution.reaction).max(least);
    if force == 0.0 || load.iter().any(|&f| f != 0.0) {
        return force;
    }
    let points = &problem.points;
    let holding = (0..points.len()).filter(|&i| points.piece(i, solution.piece[i]).holds());
    let lengths = lengths(problem, solution);
    let farthest = holding.map(|i| lengths[i] * points.arm[i]).fold(0.0, f64::max);
    force.max(problem.scale.stiffness * farthest)
}

/// What the travel of each point is measured by, the largest deflection or its own shift: a stop far away says nothing of
/// what happens at others.
pub(super) fn lengths(problem: &ContactProblem, solution: &ContactSolution) -> Vec<f64> {
    let deflection = solution.displacement.hi.iter().step_by(3).fold(0.0, |size: f64, w| size.max(w.abs()));
    let shifts = problem.points.shift.iter().zip(&problem.points.arm);
    shifts.map(|(shift, arm)| shift.abs().max(deflection / arm)).collect()
}

/// A length by which those of a plate that hardly deflects are measured; far less than the load would deflect it.
pub(super) fn least_length(problem: &ContactProblem, load: &[f64]) -> f64 {
    let springs = &problem.springs;
    let settled: f64 = springs.stiffness.iter().zip(&springs.base).map(|(k, base)| (k * base).abs()).sum();
    tolerances::NIL * (problem.scale.sum(load) + settled) / problem.scale.stiffness
}

/// Rounding of what the plate's own forces are the sum of, as a force.
pub(super) fn rounding(problem: &ContactProblem, solution: &ContactSolution) -> f64 {
    let mut internal = internal_magnitudes(&problem.plate, &solution.displacement);
    problem.release_held(&mut internal);
    f64::EPSILON * problem.scale.largest(&internal)
}

/// Largest force with which an element could resist what held dofs are held at: what rounding is relative to where nothing
/// else acts.
pub(super) fn force_of_settlements(problem: &ContactProblem, held_value: &[f64]) -> f64 {
    let size = |dof: usize| if dof % 3 == 0 { 1.0 } else { problem.scale.size };
    let moved = held_value.iter().enumerate().fold(0.0, |most: f64, (dof, v)| most.max(v.abs() * size(dof)));
    if moved == 0.0 {
        return 0.0;
    }
    let of_element = |e: usize| {
        let lower = problem.plate.element_stiffness(e);
        (0..8).fold(0.0, |most: f64, node| most.max(lower[packed(3 * node, 3 * node)]))
    };
    moved * (0..problem.plate.elements().len()).map(of_element).fold(0.0, f64::max)
}
