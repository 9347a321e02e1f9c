//! A solution in the making: where the plate and its points are, and what is out of balance there.

use crate::contact::kkt::{Afloat, Direction, Factored};
use crate::contact::problem::ContactProblem;
use crate::contact::residual::{Residual, rounding};
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;
use rayon::prelude::*;

/// Points that are worth a thread.
const PARALLEL: usize = 4096;

/// A solution in the making.
pub(super) struct Descent<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) load: &'a [f64],
    pub(super) kkt: Factored<'a>,
    pub(super) solution: ContactSolution,
    pub(super) multiplier: Vec<f64>,
    /// Travel beyond the shift, and series compliance times multiplier, of every point.
    pub(super) stretch: Vec<f64>,
    pub(super) residual: Residual,
    /// Where springs and points alone hold the plate.
    pub(super) afloat: Option<Afloat<'a>>,
    /// Rounding of the internal forces, below which an imbalance says nothing; absent until it is asked for after a balance.
    pub(super) rounding: Option<f64>,
    /// Conjugate gradient steps of solves before with the factor that this one began with.
    pub(super) spent: usize,
}

impl Descent<'_> {
    /// Force of a point.
    pub(super) fn force(&self, i: usize) -> f64 {
        self.force_at(i, self.stretch[i])
    }

    pub(super) fn force_at(&self, i: usize, stretch: f64) -> f64 {
        self.problem.points.force_at(i, self.kkt.series[i], stretch).0
    }

    pub(super) fn piece_at(&self, i: usize, stretch: f64) -> u8 {
        self.problem.points.piece_at(i, self.kkt.series[i], stretch)
    }

    /// The pieces that the points are on.
    pub(super) fn pieces(&self) -> Vec<u8> {
        let at = |i: usize| self.piece_at(i, self.stretch[i]);
        (0..self.stretch.len()).into_par_iter().with_min_len(PARALLEL).map(at).collect()
    }

    pub(super) fn largest_force(&self) -> f64 {
        let of = |i: usize| self.force(i).abs() / self.problem.points.arm[i];
        (0..self.stretch.len()).into_par_iter().with_min_len(PARALLEL).map(of).reduce(|| 0.0, f64::max)
    }

    /// Follows a direction to the least energy on it; what is out of balance then is known without the refined residual.
    pub(super) fn advance(&mut self, direction: &Direction, pieces: &[u8]) {
        let points = &self.problem.points;
        let mut change = points.change(&direction.nodal);
        if direction.is_free {
            // The rounding of plates that go together would stop them far away.
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
        let missed = |(i, stretch): (usize, &mut f64)| {
            let (moved, old) = (length * change[i], *stretch);
            *stretch = old + moved;
            let series = self.kkt.series[i];
            // What goes on with the stiffness that is carried stays in balance to the last bit.
            let (piece, next) = (points.piece_at(i, series, old), points.piece_at(i, series, *stretch));
            let increment = match piece == next {
                true => points.piece(i, piece).in_series(series) * moved,
                false => points.force_at(i, series, *stretch).0 - points.force_at(i, series, old).0,
            };
            carried[i] * moved - increment
        };
        let missed: Vec<f64> = self.stretch.par_iter_mut().enumerate().with_min_len(PARALLEL).map(missed).collect();
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

    pub(super) fn measure_stretches(&mut self) {
        let points = &self.problem.points;
        self.stretch = points.travel_from(&points.shift, &self.solution.displacement);
        for (i, stretch) in self.stretch.iter_mut().enumerate() {
            *stretch += self.kkt.series[i] * self.multiplier[i];
        }
    }

    /// Stretches and imbalance anew, in double-double.
    pub(super) fn balance(&mut self) {
        self.measure_stretches();
        let mut solution = std::mem::take(&mut self.solution);
        let forces = (0..self.stretch.len()).into_par_iter().with_min_len(PARALLEL).map(|i| self.force(i));
        solution.reaction = forces.collect();
        self.residual = Residual::of_forces(self.problem, self.load, &solution);
        self.solution = solution;
    }

    /// The solution with reactions, pieces and gaps.
    pub(super) fn ended(self) -> ContactSolution {
        let pieces = self.pieces();
        let (points, series) = (&self.problem.points, &self.kkt.series);
        let mut all = self.solution;
        (all.gradients, all.factorizations) = (self.kkt.gradients, self.kkt.factorizations);
        all.system = self.kkt.kept().cloned();
        all.spent = if self.kkt.factorizations == 0 { self.spent + self.kkt.gradients } else { 0 };
        for i in 0..pieces.len() {
            let piece = points.graph(i).piece(pieces[i]);
            all.reaction[i] = points.force_at(i, series[i], self.stretch[i]).0;
            let travel = self.stretch[i] - series[i] * self.multiplier[i];
            all.gap[i] = if piece.holds() { 0.0 } else { points.unit[i] * piece.travel - travel };
        }
        all.piece = pieces;
        all
    }

    /// Springs no stiffer than a limit, over the plate's stiffness in shear.
    pub(super) fn limit_to(&mut self, limit: f64) {
        self.kkt.limit_to(limit);
        self.balance();
    }

    /// Multipliers become the present forces; the largest change of one.
    pub(super) fn renew_multipliers(&mut self) -> f64 {
        let points = &self.problem.points;
        let mut largest: f64 = 0.0;
        for i in 0..points.len() {
            let series = self.kkt.series[i];
            if series == 0.0 {
                continue;
            }
            let force = self.force(i);
            let change = force - self.multiplier[i];
            self.stretch[i] += series * change;
            largest = largest.max(change.abs());
            self.multiplier[i] = force;
            let more = self.force(i) - force;
            if more != 0.0 {
                points.scatter(i, -more, &mut self.residual.imbalance);
            }
        }
        self.problem.release_held(&mut self.residual.imbalance);
        self.residual.worst = self.problem.scale.largest(&self.residual.imbalance);
        largest
    }
}
