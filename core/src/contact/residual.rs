//! Residual of the equations of a contact state in double-double, and the reference sizes by which it is divided.

use super::error::SolveError;
use super::interface::{Form, Interface, ReducedLoad};
use super::points::Points;
use super::problem::ContactProblem;
use super::scale::norm;
use super::solution::ContactSolution;
use super::tolerances;
use crate::cholesky::FactorError;
use crate::element::packed;
use crate::residual::{internal_magnitudes, residual};

/// Residual of nodal equilibrium and of the laws of contact points.
#[derive(Clone, Default)]
pub(super) struct Residual {
    /// Residual of equilibrium f − Ku − Gᵀr (3n,); zero at held dofs.
    pub(super) imbalance: Vec<f64>,
    /// Residual of the laws s₀ − g·u + (r − r₀)/k (m,): distance in travel from each point to the line of its piece.
    /// (s₀, r₀) is a point on this line and k its slope.
    pub(super) violation: Vec<f64>,
    /// Largest magnitude of the nodal forces in `imbalance`; couples are divided by the element size.
    pub(super) worst: f64,
}

impl Residual {
    pub(super) fn of(problem: &ContactProblem, load: &[f64], solution: &ContactSolution) -> Self {
        Self::from(problem, load, solution, &solution.piece)
    }

    /// The residual of a solution on the contact state `pieces` instead of its own contact state.
    pub(super) fn from(problem: &ContactProblem, load: &[f64], solution: &ContactSolution, pieces: &[u8]) -> Self {
        Self { violation: violation(problem, solution, pieces), ..Self::of_forces(problem, load, solution) }
    }

    /// The residual of equilibrium alone; `violation` is empty.
    pub(super) fn of_forces(problem: &ContactProblem, load: &[f64], solution: &ContactSolution) -> Self {
        let mut imbalance = residual(&problem.plate, &problem.springs, load, &solution.displacement);
        problem.points.scatter_all(&solution.reaction, -1.0, &mut imbalance);
        problem.release_held(&mut imbalance);
        let worst = problem.scale.largest(&imbalance);
        Self { imbalance, violation: Vec::new(), worst }
    }

    /// Residuals divided by their reference sizes: first equilibrium (3n values), then the laws of those points whose
    /// force depends on the travel.
    pub(super) fn scaled(&self, problem: &ContactProblem, sizes: &Sizes, pieces: &[u8]) -> Vec<f64> {
        let couple = sizes.force * problem.scale.arm;
        let forces = self.imbalance.chunks(3).flat_map(|f| [f[0] / sizes.force, f[1] / couple, f[2] / couple]);
        let holding = (0..pieces.len()).filter(|&i| problem.points.graph(i).piece(pieces[i]).holds());
        forces.chain(holding.map(|i| self.violation[i] / sizes.travel[i])).collect()
    }

    /// Whether the residual of a solution is small enough to accept the solution. If no force acts, every finite
    /// residual is accepted. The reference force is at least `least`.
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
    /// The solution, or an error if its residual is too large or one of its numbers is NaN or infinite.
    pub(super) fn require_solved(
        self,
        problem: &ContactProblem,
        load: &[f64],
        residual: &Residual,
        least: f64,
    ) -> Result<Self, SolveError> {
        if residual.is_solved(problem, load, &self, least) { self.require_finite() } else { Err(SolveError::Unsolved) }
    }

    /// Sets the gaps of points on horizontal pieces to the residuals of their laws; other gaps become 0.
    pub(super) fn measure_gaps(&mut self, points: &Points, residual: &Residual) {
        for (i, gap) in self.gap.iter_mut().enumerate() {
            *gap = if points.piece(i, self.piece[i]).holds() { 0.0 } else { residual.violation[i] };
        }
    }
}

/// Reference sizes by which a residual is divided: one force, and a travel (m,) for each contact point.
pub(super) struct Sizes {
    pub(super) force: f64,
    travel: Vec<f64>,
}

impl Sizes {
    /// Reference sizes for the residual of a solution; the reference force is at least `least`.
    pub(super) fn of(problem: &ContactProblem, load: &[f64], solution: &ContactSolution, least: f64) -> Self {
        let or_one = |size: f64| if size > 0.0 { size } else { 1.0 };
        let force = match acting(problem, load, solution, least) {
            // Without load and reactions, the reference force is the largest sum of the magnitudes of the internal
            // forces at a node.
            0.0 => or_one(rounding(problem, solution) / f64::EPSILON),
            force => force,
        };
        let least_length = least_length(problem, load);
        let length = |(i, length): (usize, f64)| or_one(length.max(least_length / problem.points.arm[i]));
        Self { force, travel: lengths(problem, solution).into_iter().enumerate().map(length).collect() }
    }
}

impl ContactProblem {
    /// The residual forces of a solution, condensed onto the contact points by forward substitution.
    pub(super) fn reduced(
        &self,
        interface: &Interface,
        residual: &Residual,
        form: Form,
    ) -> Result<ReducedLoad, FactorError> {
        let mut forward = self.pattern.gather(&residual.imbalance);
        self.base.factor.forward(&mut forward)?;
        Ok(interface.reduced(form, forward, &residual.violation)?)
    }
}

/// For each point (m,), s₀ − g·u + (r − r₀)/k on the piece of its law that `pieces` gives, see [`Residual::violation`].
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

/// Largest magnitude of the nodal forces `load` and of the reactions; couples are divided by a reference length.
pub(super) fn largest_force(problem: &ContactProblem, load: &[f64], reaction: &[f64]) -> f64 {
    let forces = reaction.iter().zip(&problem.points.arm).map(|(reaction, arm)| reaction.abs() / arm);
    forces.fold(problem.scale.largest(load), f64::max)
}

/// Reference force of a solution, at least `least`. Without load it is also at least the plate's stiffness times the
/// largest reference travel of points whose force depends on the travel. Reactions of springs that just touch are
/// rounding relative to this force.
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

/// Reference travel (m,) of each contact point: the largest deflection of a node, or the magnitude of gap plus
/// settlement of the point if that is larger. A point with a large gap does not change the reference of other points.
pub(super) fn lengths(problem: &ContactProblem, solution: &ContactSolution) -> Vec<f64> {
    let deflection = solution.displacement.hi.iter().step_by(3).fold(0.0, |size: f64, w| size.max(w.abs()));
    let shifts = problem.points.shift.iter().zip(&problem.points.arm);
    shifts.map(|(shift, arm)| shift.abs().max(deflection / arm)).collect()
}

/// Smallest reference length: `NIL` times the sum of the forces, divided by the stiffness D/a² of the plate. It decides
/// only if the plate hardly deflects.
pub(super) fn least_length(problem: &ContactProblem, load: &[f64]) -> f64 {
    let springs = &problem.springs;
    let settled: f64 = springs.stiffness.iter().zip(&springs.base).map(|(k, base)| (k * base).abs()).sum();
    tolerances::NIL * (problem.scale.sum(load) + settled) / problem.scale.stiffness
}

/// Rounding error of the largest internal nodal force; couples are divided by the element size.
pub(super) fn rounding(problem: &ContactProblem, solution: &ContactSolution) -> f64 {
    let mut internal = internal_magnitudes(&problem.plate, &solution.displacement);
    problem.release_held(&mut internal);
    f64::EPSILON * problem.scale.largest(&internal)
}

/// Largest force with which an element can resist the prescribed displacements `held_value` (3n,). If no load acts,
/// this force is the reference for rounding.
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
