//! What a solver of a contact set's equations leaves, taken away with the residual in double-double.
//!
//! Corrections are taken as they come while each leaves little of the one before (Wilkinson 1963); where what was added
//! to the equations makes that slow, they become directions of generalized conjugate residuals (Eisenstat, Elman & Schultz
//! 1983; refinement by a Krylov method as of Carson & Higham 2017).

use super::residual::Residual;
use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::scale::{dot, norm};
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;
use crate::displacement::Displacement;

/// At most this many corrections.
const CORRECTIONS: usize = 80;
/// Directions that together leave more than this part of the residual end it.
const LAST: usize = 10;

/// A solver of one contact set's equations.
pub(crate) trait KktSolver {
    /// What a residual asks for; `None` where the set does not hold the plate.
    fn correction(&mut self, step: &Residual) -> Result<Option<Correction>, FactorError>;

    /// Where no dof holds the plate, the rigid motion that a residual asks for, and the increments of reaction that go with
    /// it: made first, and added exactly.
    fn rigid(&self, _step: &Residual) -> Option<Correction> {
        None
    }

    /// Whether what is left of the gaps is rounding in the forces too that the next correction would make of it.
    fn is_settled(&self, _step: &Residual, _force: f64) -> bool {
        true
    }
}

/// A rigid motion of the plate, a motion of its nodes on top of it, and increments of reaction.
#[derive(Clone)]
pub(crate) struct Correction {
    /// Deflection and slopes at the middle of the plate.
    pub(crate) rigid: [f64; 3],
    pub(crate) nodal: Vec<f64>,
    pub(crate) reaction: Vec<f64>,
}

/// A direction and the residual that it takes away, which is of length 1 and orthogonal to all others.
struct Taken {
    direction: Correction,
    change: Vec<f64>,
}

impl ContactProblem {
    /// What a residual asks for: a rigid motion, if one comes first, and then what a solver makes of what that leaves.
    pub(crate) fn correction(
        &self,
        load: &[f64],
        solver: &mut dyn KktSolver,
        step: &Residual,
        solution: &ContactSolution,
    ) -> Result<Option<Correction>, FactorError> {
        let Some(mut rigid) = solver.rigid(step) else { return solver.correction(step) };
        let mut afloat = solution.clone();
        afloat.follow(self, &rigid, 1.0);
        let Some(rest) = solver.correction(&self.residual(load, &afloat))? else { return Ok(None) };
        rigid.nodal = rest.nodal;
        rigid.reaction.iter_mut().zip(&rest.reaction).for_each(|(total, increment)| *total += increment);
        Ok(Some(rigid))
    }

    /// Refines a solution on its contact set, from its residual on, and returns what is left; `None` where the set does
    /// not hold the plate. Forces far below `least` are rounding.
    pub(crate) fn refine(
        &self,
        load: &[f64],
        least: f64,
        solver: &mut dyn KktSolver,
        mut step: Residual,
        solution: &mut ContactSolution,
    ) -> Result<Option<Residual>, FactorError> {
        let mut sizes = None;
        let mut lengths = Vec::new();
        let mut taken: Vec<Taken> = Vec::new();
        let mut rounding = None;
        for _ in 0..CORRECTIONS {
            let Some(mut direction) = self.correction(load, solver, &step, solution)? else {
                // What rests already need not be held.
                let left = self.scaled(&step, &self.sizes(load, solution, least), &solution.closed);
                return Ok(is_within(&left, tolerances::newton::SETTLED).then_some(step));
            };
            let mut trial = solution.clone();
            trial.follow(self, &direction, 1.0);
            let next = self.residual(load, &trial);
            // Before the first correction nothing may have moved that tells how large things are.
            let sizes = sizes.get_or_insert_with(|| self.sizes(load, &trial, least));
            let residual = self.scaled(&step, sizes, &solution.closed);
            let after = self.scaled(&next, sizes, &solution.closed);
            let (before, length) = (norm(&residual), norm(&after));
            if lengths.is_empty() {
                lengths.push(before);
            }
            if taken.is_empty() && length <= tolerances::PROGRESS * before {
                (*solution, step) = (trial, next);
                lengths.push(length);
                if is_within(&after, tolerances::RESIDUAL) && solver.is_settled(&step, sizes.force) {
                    break;
                }
                continue;
            }
            let own = *rounding.get_or_insert_with(|| self.rounding(&trial.displacement) / sizes.force);
            if is_within(&residual, own.max(tolerances::RESIDUAL)) {
                if length < before {
                    (*solution, step) = (trial, next);
                }
                break;
            }
            let mut change: Vec<f64> = residual.iter().zip(&after).map(|(before, after)| before - after).collect();
            // Twice, since what is left of nearly parallel vectors is rounding the first time.
            for earlier in taken.iter().chain(&taken) {
                let part = dot(&change, &earlier.change);
                subtract(&mut change, part, &earlier.change);
                direction.subtract(part, &earlier.direction);
            }
            let size = norm(&change);
            if !(size > 0.0 && size.is_finite()) {
                break;
            }
            change.iter_mut().for_each(|value| *value /= size);
            direction.divide(size);
            let mut trial = solution.clone();
            trial.follow(self, &direction, dot(&residual, &change));
            let next = self.residual(load, &trial);
            let left = self.scaled(&next, sizes, &solution.closed);
            let length = norm(&left);
            if length.is_nan() || length >= before {
                if taken.is_empty() {
                    break;
                }
                // Directions that have lost what they are orthogonal to.
                taken.clear();
                continue;
            }
            (*solution, step) = (trial, next);
            taken.push(Taken { direction, change });
            lengths.push(length);
            let slow = lengths.len() > LAST && length > tolerances::SLOW * lengths[lengths.len() - 1 - LAST];
            if slow || is_within(&left, tolerances::RESIDUAL) {
                break;
            }
        }
        Ok(Some(step))
    }
}

impl ContactSolution {
    /// Goes along a correction.
    pub(crate) fn follow(&mut self, problem: &ContactProblem, direction: &Correction, length: f64) {
        if direction.rigid != [0.0; 3] {
            let rigid = direction.rigid.map(|motion| length * motion);
            self.displacement.add_rigid(&problem.plate, problem.scale.centre, rigid);
        }
        for (dof, value) in direction.nodal.iter().enumerate() {
            self.displacement.add(dof, length * value);
        }
        for (total, increment) in self.reaction.iter_mut().zip(&direction.reaction) {
            *total += length * increment;
        }
        self.corrections += 1;
    }
}

impl Correction {
    /// Without a rigid motion apart.
    pub(crate) fn of(nodal: Vec<f64>, reaction: Vec<f64>) -> Self {
        Self { rigid: [0.0; 3], nodal, reaction }
    }

    /// The motion of all nodes (3n).
    pub(crate) fn motion(&self, problem: &ContactProblem) -> Vec<f64> {
        let mut all = Displacement { hi: self.nodal.clone(), lo: vec![0.0; self.nodal.len()] };
        all.add_rigid(&problem.plate, problem.scale.centre, self.rigid);
        all.hi
    }

    fn subtract(&mut self, part: f64, other: &Self) {
        subtract(&mut self.rigid, part, &other.rigid);
        subtract(&mut self.nodal, part, &other.nodal);
        subtract(&mut self.reaction, part, &other.reaction);
    }

    fn divide(&mut self, by: f64) {
        let all = self.rigid.iter_mut().chain(&mut self.nodal).chain(&mut self.reaction);
        all.for_each(|value| *value /= by);
    }
}

fn is_within(scaled: &[f64], limit: f64) -> bool {
    scaled.iter().all(|value| value.abs() <= limit)
}

fn subtract(from: &mut [f64], part: f64, what: &[f64]) {
    for (value, what) in from.iter_mut().zip(what) {
        *value -= part * what;
    }
}
