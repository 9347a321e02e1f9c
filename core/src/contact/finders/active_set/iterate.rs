//! Newton iterate: displacements, multipliers, augmented travels and residual.

use crate::contact::kkt::{CoarseLoad, Direction, Factored};
use crate::contact::problem::ContactProblem;
use crate::contact::residual::{Residual, rounding};
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;
use rayon::prelude::*;

/// Number of contact points that one parallel task handles.
const PARALLEL: usize = 4096;

/// Newton iterate.
pub(super) struct NewtonIterate<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) load: &'a [f64],
    pub(super) kkt: Factored<'a>,
    pub(super) solution: ContactSolution,
    pub(super) multiplier: Vec<f64>,
    /// Augmented travel s + σλ (m,) of each contact point: travel s, augmentation compliance σ, multiplier λ.
    pub(super) augmented_travel: Vec<f64>,
    pub(super) residual: Residual,
    /// Resultants of the load on plates without held dofs; `None` if every plate has a held dof, or a point has a
    /// linear law.
    pub(super) coarse_load: Option<CoarseLoad<'a>>,
    /// Rounding error of the internal nodal forces; computed on demand after each evaluation of the residual.
    pub(super) rounding: Option<f64>,
    /// Number of conjugate gradient steps of earlier solves with the factor from which this solve starts.
    pub(super) spent: usize,
}

impl NewtonIterate<'_> {
    /// Force of contact point i at its augmented travel.
    pub(super) fn force(&self, i: usize) -> f64 {
        self.force_at(i, self.augmented_travel[i])
    }

    pub(super) fn force_at(&self, i: usize, augmented_travel: f64) -> f64 {
        self.problem.points.force_at(i, self.kkt.series[i], augmented_travel).0
    }

    pub(super) fn piece_at(&self, i: usize, augmented_travel: f64) -> u8 {
        self.problem.points.piece_at(i, self.kkt.series[i], augmented_travel)
    }

    /// The present contact state (m,): the piece of the law on which each contact point is.
    pub(super) fn pieces(&self) -> Vec<u8> {
        let at = |i: usize| self.piece_at(i, self.augmented_travel[i]);
        (0..self.augmented_travel.len()).into_par_iter().with_min_len(PARALLEL).map(at).collect()
    }

    pub(super) fn largest_force(&self) -> f64 {
        let of = |i: usize| self.force(i).abs() / self.problem.points.arm[i];
        (0..self.augmented_travel.len()).into_par_iter().with_min_len(PARALLEL).map(of).reduce(|| 0.0, f64::max)
    }

    /// Moves the iterate along a direction to the point of least energy, and adds the changes of nodal and contact
    /// forces to the residual.
    pub(super) fn advance(&mut self, direction: &Direction, pieces: &[u8]) {
        let points = &self.problem.points;
        let mut change = points.change(&direction.nodal);
        if direction.is_free {
            // If plates move together, their relative displacement at a contact point is rounding. It counts as zero
            // here; otherwise this point would end the line search too early.
            let size = |i: usize| points.row(i).map(|(dof, c)| (c * direction.nodal[dof]).abs()).sum::<f64>();
            let is_rounding = |i: &usize| change[*i].abs() <= tolerances::newton::FREE * size(*i);
            let none: Vec<usize> = (0..change.len()).filter(is_rounding).collect();
            none.into_iter().for_each(|i| change[i] = 0.0);
        }
        let length = self.line_search(direction, &change, pieces);
        for (dof, value) in direction.nodal.iter().enumerate() {
            self.solution.displacement.add(dof, length * value);
        }
        self.solution.displacement.follow(self.problem.plate.bodies());
        let mut loss: Vec<f64> = direction.force.iter().map(|f| -length * f).collect();
        let carried = &self.kkt.system().carried;
        let missed = |(i, augmented_travel): (usize, &mut f64)| {
            let (moved, old) = (length * change[i], *augmented_travel);
            *augmented_travel = old + moved;
            let series = self.kkt.series[i];
            // If a point stays on its piece of the law, its change of force is stiffness · travel. Its difference from
            // the force of the factored spring is then exactly zero if the stiffnesses are equal.
            let (piece, next) = (points.piece_at(i, series, old), points.piece_at(i, series, *augmented_travel));
            let increment = match piece == next {
                true => points.piece(i, piece).in_series(series) * moved,
                false => points.force_at(i, series, *augmented_travel).0 - points.force_at(i, series, old).0,
            };
            carried[i] * moved - increment
        };
        let missed: Vec<f64> =
            self.augmented_travel.par_iter_mut().enumerate().with_min_len(PARALLEL).map(missed).collect();
        points.scatter_all(&missed, 1.0, &mut loss);
        self.problem.release_held(&mut loss);
        for (value, loss) in self.residual.imbalance.iter_mut().zip(&loss) {
            *value += loss;
        }
        self.residual.worst = self.problem.scale.largest(&self.residual.imbalance);
        self.solution.iterations += 1;
    }

    pub(super) fn rounding(&mut self) -> f64 {
        *self.rounding.get_or_insert_with(|| rounding(self.problem, &self.solution))
    }

    pub(super) fn measure_travels(&mut self) {
        let points = &self.problem.points;
        self.augmented_travel = points.travel_from(&points.shift, &self.solution.displacement);
        for (i, augmented_travel) in self.augmented_travel.iter_mut().enumerate() {
            *augmented_travel += self.kkt.series[i] * self.multiplier[i];
        }
    }

    /// Evaluates augmented travels and the residual in double-double.
    pub(super) fn balance(&mut self) {
        self.measure_travels();
        let mut solution = std::mem::take(&mut self.solution);
        let forces = (0..self.augmented_travel.len()).into_par_iter().with_min_len(PARALLEL).map(|i| self.force(i));
        solution.reaction = forces.collect();
        self.residual = Residual::of_forces(self.problem, self.load, &solution);
        self.solution = solution;
    }

    /// The present displacements and reactions as a solution on the contact state `piece` (m,).
    pub(super) fn on_pieces(&self, piece: Vec<u8>) -> ContactSolution {
        let reaction = (0..piece.len()).map(|i| self.force(i)).collect();
        ContactSolution { piece, reaction, ..self.solution.clone() }
    }

    /// Continues the iteration from an exact solution, with its reactions as multipliers.
    pub(super) fn continue_from(&mut self, exact: ContactSolution) {
        self.solution.displacement = exact.displacement;
        self.solution.corrections += exact.corrections;
        self.multiplier = exact.reaction;
        self.rounding = None;
        self.balance();
    }

    /// The solution at the end of the iteration, with reactions, gaps and pieces of the laws of the contact points.
    pub(super) fn ended(self) -> ContactSolution {
        let pieces = self.pieces();
        let (points, series) = (&self.problem.points, &self.kkt.series);
        let mut all = self.solution;
        (all.gradients, all.factorizations) = (self.kkt.gradients, self.kkt.factorizations);
        all.system = self.kkt.kept().cloned();
        all.spent = if self.kkt.factorizations == 0 { self.spent + self.kkt.gradients } else { 0 };
        for i in 0..pieces.len() {
            let piece = points.graph(i).piece(pieces[i]);
            all.reaction[i] = points.force_at(i, series[i], self.augmented_travel[i]).0;
            let travel = self.augmented_travel[i] - series[i] * self.multiplier[i];
            all.gap[i] = if piece.holds() { 0.0 } else { points.unit[i] * piece.travel - travel };
        }
        all.piece = pieces;
        all
    }

    /// Sets the penalty and evaluates the residual anew.
    pub(super) fn set_penalty(&mut self, limit: f64) {
        self.kkt.set_penalty(limit);
        self.balance();
    }

    /// Sets the multiplier of each contact point to its present force.
    pub(super) fn renew_multipliers(&mut self) {
        let points = &self.problem.points;
        for i in 0..points.len() {
            let series = self.kkt.series[i];
            if series == 0.0 {
                continue;
            }
            let force = self.force(i);
            let change = force - self.multiplier[i];
            self.augmented_travel[i] += series * change;
            self.multiplier[i] = force;
            let more = self.force(i) - force;
            if more != 0.0 {
                points.scatter(i, -more, &mut self.residual.imbalance);
            }
        }
        self.problem.release_held(&mut self.residual.imbalance);
        self.residual.worst = self.problem.scale.largest(&self.residual.imbalance);
    }
}
