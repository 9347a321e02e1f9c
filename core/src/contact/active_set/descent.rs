//! A solution on its way: where the plate and its points are, and what is out of balance there.

use super::direction::Direction;
use super::floating::Floating;
use crate::cholesky::FactorError;
use crate::contact::condense::ContactState;
use crate::contact::points::Penalty;
use crate::contact::problem::{ContactProblem, Factored};
use crate::contact::refinement::Residual;
use crate::contact::solution::ContactSolution;
use crate::contact::start::Balanced;
use crate::residual::internal_magnitude;

/// A solution on its way.
pub(super) struct Descent<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) load: &'a [f64],
    /// Stiffest springs, over the plate's stiffness in shear.
    pub(super) limit: f64,
    pub(super) penalty: Penalty,
    /// The factor that it was given, and the one in its place, if any.
    pub(super) given: &'a Factored,
    pub(super) own: Option<Factored>,
    /// Whether others ask the factor that it was given too; there are no two-sided points then.
    pub(super) shares: bool,
    /// Two-sided points, held.
    pub(super) state: ContactState,
    pub(super) solution: ContactSolution,
    pub(super) multiplier: Vec<f64>,
    pub(super) stretch: Vec<f64>,
    pub(super) residual: Residual,
    /// Points that are closed whatever their stretch, and all others open, where the set is not to be found.
    pub(super) imposed: Option<Vec<bool>>,
    /// Where the points alone hold the plate.
    pub(super) floating: Option<Floating>,
    /// Rounding of the internal forces, below which an imbalance says nothing.
    pub(super) rounding: f64,
}

impl Descent<'_> {
    pub(super) fn factored(&self) -> &Factored {
        self.own.as_ref().unwrap_or(self.given)
    }

    /// Follows a direction to the least energy on it; what is out of balance then is known without the refined residual.
    pub(super) fn advance(&mut self, direction: &Direction, closed: &[bool]) {
        let (problem, points) = (self.problem, &self.problem.active);
        let change = points.change(&problem.plate, &direction.nodal);
        let length = if self.imposed.is_some() { 1.0 } else { self.line_search(direction, &change, closed) };
        for (dof, value) in direction.nodal.iter().enumerate() {
            self.solution.displacement.add(dof, length * value);
        }
        let mut loss: Vec<f64> = direction.force.iter().map(|f| -length * f).collect();
        let carried = self.own.as_ref().unwrap_or(self.given).carried.iter();
        for (i, &carried) in carried.enumerate() {
            let old = self.stretch[i];
            self.stretch[i] += length * change[i];
            let pushes = self.penalty.stiffness[i] * (self.pushing(i) - self.pushes(i, old));
            let factor = length * carried * change[i] - pushes;
            if factor != 0.0 {
                points.scatter(&problem.plate, i, factor, &mut loss);
            }
        }
        let steps: Vec<f64> = direction.reaction.iter().map(|r| -length * r).collect();
        problem.spread(&steps, &mut loss);
        for (total, increment) in self.solution.reaction.iter_mut().zip(&direction.reaction) {
            *total += length * increment;
        }
        problem.release_held(&mut loss);
        for (value, loss) in self.residual.imbalance.iter_mut().zip(&loss) {
            *value += loss;
        }
        self.residual.worst = self.residual.imbalance.iter().fold(0.0, |worst: f64, f| worst.max(f.abs()));
        self.solution.iterations += 1;
    }

    /// From the solution under another load, what is out of balance is what the loads differ by.
    pub(super) fn depart(&mut self, from: Balanced) {
        self.solution.displacement.lo.copy_from_slice(from.low);
        let softened = self.penalty.series.iter().zip(&self.multiplier);
        self.stretch = from.overlap.iter().zip(softened).map(|(overlap, (s, force))| overlap + s * force).collect();
        let imbalance = self.load.iter().zip(from.load).map(|(load, balanced)| load - balanced).collect();
        self.residual = self.problem.residual_of(imbalance, self.load, &self.solution);
    }

    /// Stretches and imbalance anew, in double-double; two-sided points are brought back to where they belong.
    pub(super) fn refine(&mut self) -> Result<(), FactorError> {
        self.balance();
        if !self.problem.constraints.rows.is_empty() {
            let with = self.own.as_ref().unwrap_or(self.given);
            let motion = self.problem.reduced(with, &self.residual, with.condensed.better_form())?;
            self.problem.correct(with, &self.state, motion, &mut self.solution)?;
            self.balance();
        }
        if self.imposed.is_some() && self.rounding > 0.0 {
            // One load on one set: the internal forces stay.
            return Ok(());
        }
        let (plate, held) = (&self.problem.plate, &self.problem.held);
        self.rounding = f64::EPSILON * internal_magnitude(plate, held, &self.solution.displacement);
        Ok(())
    }

    pub(super) fn stretched(&mut self) {
        self.stretch = self.problem.active.overlap(&self.problem.plate, &self.solution.displacement);
        for (i, stretch) in self.stretch.iter_mut().enumerate() {
            *stretch += self.penalty.series[i] * self.multiplier[i];
        }
    }

    pub(super) fn balance(&mut self) {
        self.stretched();
        let (problem, points) = (self.problem, &self.problem.active);
        let mut imbalance = problem.imbalance(self.load, &self.solution.displacement, &self.solution.reaction);
        for i in 0..points.len() {
            let pushing = self.pushing(i);
            if pushing != 0.0 {
                points.scatter(&problem.plate, i, -self.penalty.stiffness[i] * pushing, &mut imbalance);
            }
        }
        self.residual = problem.residual_of(imbalance, self.load, &self.solution);
    }

    /// The solution with every point in the caller's order.
    pub(super) fn in_order(self) -> ContactSolution {
        let order = &self.problem.order;
        let count = order.condensed.len() + order.active.len();
        let mut all = ContactSolution {
            reaction: vec![0.0; count],
            gap: vec![0.0; count],
            closed: vec![false; count],
            ..self.solution.clone()
        };
        for (at, &i) in order.condensed.iter().enumerate() {
            all.reaction[i] = self.solution.reaction[at];
            all.closed[i] = true;
        }
        for (at, &i) in order.active.iter().enumerate() {
            let stretch = self.stretch[at];
            all.reaction[i] = self.penalty.stiffness[at] * self.pushing(at);
            all.closed[i] = self.imposed.as_ref().map_or(stretch > 0.0, |closed| closed[at]);
            all.gap[i] = if all.closed[i] { 0.0 } else { self.penalty.series[at] * self.multiplier[at] - stretch };
        }
        all
    }
}
