//! A solution on its way: where the plate and its points are, and what is out of balance there.

use crate::cholesky::FactorError;
use crate::contact::kkt::{ActiveFactor, Correction, Direction, Floating, Residual};
use crate::contact::problem::ContactProblem;
use crate::contact::solution::{ContactSolution, Reference};
use crate::double_double::DoubleDouble;

/// A solution on its way.
pub(super) struct Descent<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) load: &'a [f64],
    pub(super) factor: ActiveFactor<'a>,
    pub(super) solution: ContactSolution,
    pub(super) multiplier: Vec<f64>,
    pub(super) stretch: Vec<f64>,
    pub(super) residual: Residual,
    /// Where springs and points alone hold the plate.
    pub(super) afloat: Option<Afloat>,
    /// Rounding of the internal forces, below which an imbalance says nothing; absent until it is asked for after a refinement.
    pub(super) rounding: Option<f64>,
}

impl Descent<'_> {
    /// Follows a direction to the least energy on it; what is out of balance then is known without the refined residual.
    pub(super) fn advance(&mut self, direction: &Direction, closed: &[bool]) {
        let (problem, points) = (self.problem, &self.problem.active);
        let change = points.change(&problem.plate, &direction.nodal);
        let length = self.line_search(direction, &change, closed);
        for (dof, value) in direction.nodal.iter().enumerate() {
            self.solution.displacement.add(dof, length * value);
        }
        let mut loss: Vec<f64> = direction.force.iter().map(|f| -length * f).collect();
        for (i, &carried) in self.factor.factored().carried.iter().enumerate() {
            let (moved, old) = (length * change[i], self.stretch[i]);
            self.stretch[i] += moved;
            // What pushes on with the stiffness that is carried stays in balance to the last bit.
            let pushes = if old > 0.0 && self.stretch[i] > 0.0 { moved } else { self.pushing(i) - old.max(0.0) };
            let factor = carried * moved - self.factor.penalty.stiffness[i] * pushes;
            if factor != 0.0 {
                points.scatter(&problem.plate, i, factor, &mut loss);
            }
        }
        let steps: Vec<f64> = direction.reaction.iter().map(|r| length * r).collect();
        problem.take_off(&steps, &mut loss);
        self.solution.reaction.iter_mut().zip(&steps).for_each(|(total, step)| *total += step);
        problem.release_held(&mut loss);
        for (value, loss) in self.residual.imbalance.iter_mut().zip(&loss) {
            *value += loss;
        }
        self.residual.worst = problem.scale.largest(&self.residual.imbalance);
        self.solution.iterations += 1;
    }

    /// From the solution under another load, what is out of balance is what the loads differ by.
    pub(super) fn depart(&mut self, from: &Reference) {
        self.solution.displacement.lo.copy_from_slice(&from.solution.displacement.lo);
        let softened = self.factor.penalty.series.iter().zip(&self.multiplier);
        self.stretch = from.overlap.iter().zip(softened).map(|(overlap, (s, force))| overlap + s * force).collect();
        let imbalance = self.load.iter().zip(&from.load).map(|(load, balanced)| load - balanced).collect();
        self.residual = self.problem.residual_of(imbalance, &self.solution);
    }

    /// Stretches and imbalance anew, in double-double; two-sided points are brought back to where they belong.
    pub(super) fn refine(&mut self) -> Result<(), FactorError> {
        self.balance();
        if !self.problem.constraints.rows.is_empty() {
            let (solution, residual) = (self.solution.clone(), self.residual.clone());
            self.correct(&residual.imbalance, &residual.remaining)?;
            if !(self.residual.worst <= residual.worst) {
                // The factor's set is another one: only the gaps then, what is out of balance is for the directions.
                self.solution = solution;
                self.correct(&vec![0.0; self.load.len()], &residual.remaining)?;
            }
        }
        self.rounding = None;
        Ok(())
    }

    /// Follows what the factor has for an imbalance and for what is left of two-sided points' gaps.
    fn correct(&mut self, imbalance: &[f64], remaining: &[f64]) -> Result<(), FactorError> {
        let found = self.factor.response(imbalance, remaining)?;
        self.solution.follow(self.problem, &Correction::of(found.nodal, found.reaction), 1.0);
        self.balance();
        Ok(())
    }

    pub(super) fn rounding(&mut self) -> f64 {
        *self.rounding.get_or_insert_with(|| self.problem.rounding(&self.solution.displacement))
    }

    pub(super) fn stretched(&mut self) {
        self.stretch = self.problem.active.overlap(&self.problem.plate, &self.solution.displacement);
        for (i, stretch) in self.stretch.iter_mut().enumerate() {
            *stretch += self.factor.penalty.series[i] * self.multiplier[i];
        }
    }

    pub(super) fn balance(&mut self) {
        self.stretched();
        let (problem, points) = (self.problem, &self.problem.active);
        let mut imbalance = problem.imbalance(self.load, &self.solution.displacement, &self.solution.reaction);
        for i in 0..points.len() {
            let pushing = self.pushing(i);
            if pushing != 0.0 {
                points.scatter(&problem.plate, i, -self.factor.penalty.stiffness[i] * pushing, &mut imbalance);
            }
        }
        self.residual = problem.residual_of(imbalance, &self.solution);
    }

    /// The solution with every point in the caller's order.
    pub(super) fn in_order(self) -> ContactSolution {
        let problem = self.problem;
        let Self { factor, stretch, multiplier, solution: mut all, .. } = self;
        (all.gradients, all.factorizations) = (factor.gradients, factor.factorizations);
        for (i, &stretch) in stretch.iter().enumerate() {
            all.reaction.push(factor.penalty.stiffness[i] * stretch.max(0.0));
            all.closed.push(stretch > 0.0);
            all.gap.push(if stretch > 0.0 { 0.0 } else { factor.penalty.series[i] * multiplier[i] - stretch });
        }
        problem.solution_in_order(all)
    }

    pub(super) fn pushing(&self, i: usize) -> f64 {
        self.stretch[i].max(0.0)
    }

    pub(super) fn largest_push(&self) -> f64 {
        let k = &self.factor.penalty.stiffness;
        (0..k.len()).fold(0.0, |most: f64, i| most.max(k[i] * self.pushing(i)))
    }

    /// Points of the active set that push.
    pub(super) fn pushing_points(&self) -> Vec<bool> {
        self.stretch.iter().map(|&stretch| stretch > 0.0).collect()
    }

    /// Springs no stiffer than a limit, over the plate's stiffness in shear.
    pub(super) fn penalize(&mut self, limit: f64) {
        self.factor.limit = limit;
        self.factor.penalty = self.problem.active.penalized(limit);
        self.balance();
    }

    /// Multipliers become the present forces; the largest change of one.
    pub(super) fn renew_multipliers(&mut self) -> f64 {
        let (problem, points) = (self.problem, &self.problem.active);
        let mut any = false;
        let mut largest: f64 = 0.0;
        for i in 0..points.len() {
            if self.factor.penalty.series[i] > 0.0 {
                let old = self.pushing(i);
                let force = self.factor.penalty.stiffness[i] * old;
                self.stretch[i] += self.factor.penalty.series[i] * (force - self.multiplier[i]);
                largest = largest.max((force - self.multiplier[i]).abs());
                self.multiplier[i] = force;
                let more = self.factor.penalty.stiffness[i] * (self.pushing(i) - old);
                points.scatter(&problem.plate, i, -more, &mut self.residual.imbalance);
                any = true;
            }
        }
        if any {
            problem.release_held(&mut self.residual.imbalance);
            self.residual.worst = problem.scale.largest(&self.residual.imbalance);
        }
        largest
    }
}

/// A plate that only springs and points hold, and the load on its rigid motions.
pub(super) struct Afloat {
    pub(super) floating: Floating,
    pub(super) load: [DoubleDouble; 3],
    pub(super) magnitude: f64,
}

impl Afloat {
    /// Nothing where a dof is held, or a point both ways.
    pub(super) fn under(problem: &ContactProblem, load: &[f64]) -> Option<Self> {
        let floating = Floating::of(problem).filter(|_| problem.constraints.rows.is_empty())?;
        let terms = floating.nodal.iter().flat_map(|motion| motion.iter().zip(load).map(|(u, f)| (u * f).abs()));
        Some(Self { magnitude: terms.sum(), load: floating.resultants(load), floating })
    }
}
