//! Corrections where increments of reaction yield: the preconditioner is the contact state's system with a compliance at
//! its points, and what that leaves is taken away by generalized conjugate residuals (Eisenstat, Elman & Schultz 1983),
//! in refinement by a Krylov method as of Carson & Higham (2017). The residuals are the double-double ones.

use super::condense::ContactState;
use super::floating::Floating;
use super::problem::ContactProblem;
use super::refinement::{Motion, Step};
use super::solution::ContactSolution;
use super::solve::ROUNDING;
use crate::cholesky::FactorError;

/// At most this many directions.
const DIRECTIONS: usize = 80;
/// Directions that together leave more than this part of the residual end it.
const LAST: usize = 10;
const PROGRESS: f64 = 0.7;

/// A rigid motion of the plate, a motion of its nodes on top of it, and increments of reaction.
struct Direction {
    rigid: [f64; 3],
    nodal: Vec<f64>,
    reaction: Vec<f64>,
}

/// A direction and the residual that it takes away, which is of length 1 and orthogonal to all others.
struct Taken {
    direction: Direction,
    change: Vec<f64>,
}

/// What a residual is measured by: forces, couples, and what is left of the gap of every point.
struct Sizes {
    force: f64,
    couple: f64,
    gap: Vec<f64>,
}

impl ContactProblem {
    /// As [`ContactProblem::refine`], for a problem whose increments of reaction yield.
    pub(super) fn refine_yielding(
        &self,
        load: &[f64],
        state: &ContactState,
        motion: Motion,
        solution: &mut ContactSolution,
    ) -> Result<Step, FactorError> {
        self.correct(&self.base, state, motion, solution)?;
        let mut step = self.step(load, solution);
        let sizes = self.sizes(load, solution);
        let mut residual = self.residual(&step, &sizes, solution);
        let mut lengths = vec![norm(&residual)];
        let floating = Floating::of(self, &solution.closed);
        let centre = floating.as_ref().map_or([0.0; 2], |floating| floating.centre);
        let mut taken: Vec<Taken> = Vec::new();
        while taken.len() < DIRECTIONS && residual.iter().any(|r| r.abs() > ROUNDING) {
            let mut direction = self.direction_of(load, state, &step, floating.as_ref(), solution)?;
            let mut trial = solution.clone();
            trial.follow(self, centre, &direction, 1.0);
            let after = self.residual(&self.step(load, &trial), &sizes, solution);
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
            let before = solution.clone();
            solution.follow(self, centre, &direction, dot(&residual, &change));
            solution.corrections += 1;
            let next = self.step(load, solution);
            let left = self.residual(&next, &sizes, solution);
            let length = norm(&left);
            if length.is_nan() || length >= lengths[lengths.len() - 1] {
                *solution = before;
                break;
            }
            (step, residual) = (next, left);
            taken.push(Taken { direction, change });
            lengths.push(length);
            if lengths.len() > LAST && length > PROGRESS * lengths[lengths.len() - 1 - LAST] {
                break;
            }
        }
        Ok(step)
    }

    /// What a residual asks for: of a plate that floats a rigid motion first, then what the factor makes of the rest.
    fn direction_of(
        &self,
        load: &[f64],
        state: &ContactState,
        step: &Step,
        floating: Option<&Floating>,
        solution: &ContactSolution,
    ) -> Result<Direction, FactorError> {
        let form = self.base.condensed.better_form();
        let Some(floating) = floating else {
            let (nodal, reaction) = self.respond(&self.base, state, self.motion(&self.base, step, form)?)?;
            return Ok(Direction { rigid: [0.0; 3], nodal, reaction });
        };
        let (rigid, reaction) = floating.response(step);
        let mut direction = Direction { rigid, nodal: vec![0.0; self.plate.dof_count()], reaction };
        let mut afloat = solution.clone();
        afloat.follow(self, floating.centre, &direction, 1.0);
        let motion = self.motion(&self.base, &self.step(load, &afloat), form)?;
        let (nodal, reaction) = self.respond(&self.base, state, motion)?;
        direction.nodal = nodal;
        direction.reaction.iter_mut().zip(&reaction).for_each(|(total, increment)| *total += increment);
        Ok(direction)
    }

    fn sizes(&self, load: &[f64], solution: &ContactSolution) -> Sizes {
        let largest = |size: f64, value: &f64| size.max(value.abs());
        let deflection = solution.displacement.hi.iter().step_by(3).fold(0.0, largest);
        let length = self.constraints.distance.iter().fold(deflection, largest);
        let or_one = |size: f64| if size > 0.0 { size } else { 1.0 };
        let force = or_one(self.largest_force(load, solution));
        // Points yield by the square of what they measure: deflections more than slopes.
        let yielding = self.constraints.yielding.as_deref().unwrap_or_default();
        let most = yielding.iter().fold(0.0, largest);
        let gap = yielding.iter().map(|y| or_one(length) * (y / most).sqrt()).collect();
        Sizes { force, couple: force * self.across(), gap }
    }

    /// What is out of balance at every dof, then what is left of the gaps of closed points.
    fn residual(&self, step: &Step, sizes: &Sizes, solution: &ContactSolution) -> Vec<f64> {
        let forces =
            step.imbalance.chunks(3).flat_map(|f| [f[0] / sizes.force, f[1] / sizes.couple, f[2] / sizes.couple]);
        let closed = (0..step.remaining.len()).filter(|&i| solution.closed[i]);
        forces.chain(closed.map(|i| step.remaining[i] / sizes.gap[i])).collect()
    }
}

impl ContactSolution {
    fn follow(&mut self, problem: &ContactProblem, centre: [f64; 2], direction: &Direction, length: f64) {
        if direction.rigid != [0.0; 3] {
            self.displacement.add_rigid(&problem.plate, centre, direction.rigid.map(|motion| length * motion));
        }
        for (dof, value) in direction.nodal.iter().enumerate() {
            self.displacement.add(dof, length * value);
        }
        for (total, increment) in self.reaction.iter_mut().zip(&direction.reaction) {
            *total += length * increment;
        }
    }
}

impl Direction {
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

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

fn subtract(from: &mut [f64], part: f64, what: &[f64]) {
    for (value, what) in from.iter_mut().zip(what) {
        *value -= part * what;
    }
}
