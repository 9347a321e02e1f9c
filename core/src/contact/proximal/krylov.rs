//! What a proximal step leaves, taken away by generalized conjugate residuals (Eisenstat, Elman & Schultz 1983), in
//! refinement by a Krylov method as of Carson & Higham (2017). The residuals are the double-double ones, the regularized
//! equations of one contact state the preconditioner.

use super::floating::Floating;
use super::regularized::Regularized;
use super::saddle::Saddle;
use crate::contact::problem::ContactProblem;
use crate::contact::refinement::Residual;
use crate::contact::rigid::{extent, rigid_part};
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;
use crate::plate::Plate;
use crate::residual::Displacement;

/// At most this many directions.
const DIRECTIONS: usize = 80;
/// Directions that together leave more than this part of the residual end it.
const LAST: usize = 10;

/// A rigid motion of the plate, a motion of its nodes on top of it, and increments of reaction.
pub(super) struct Direction {
    /// Deflection and slopes at the middle of the plate.
    rigid: [f64; 3],
    nodal: Vec<f64>,
    pub(super) reaction: Vec<f64>,
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

impl Regularized<'_> {
    /// What yielded taken back in one contact state.
    pub(super) fn refine(
        &self,
        load: &[f64],
        saddle: &Saddle,
        floating: Option<&Floating>,
        from: &Residual,
        solution: &mut ContactSolution,
    ) -> Residual {
        let problem = self.problem;
        let mut step = from.clone();
        let sizes = self.sizes(load, solution);
        let mut residual = self.scaled(&step, &sizes, solution);
        let mut lengths = vec![norm(&residual)];
        let mut taken: Vec<Taken> = Vec::new();
        for _ in 0..DIRECTIONS {
            if residual.iter().all(|r| r.abs() <= tolerances::RESIDUAL) {
                break;
            }
            let mut direction = self.direction(load, saddle, &step, floating, solution);
            let mut trial = solution.clone();
            trial.follow(problem, &direction, 1.0);
            let after = self.scaled(&problem.residual(load, &trial), &sizes, solution);
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
            solution.follow(problem, &direction, dot(&residual, &change));
            solution.corrections += 1;
            let next = problem.residual(load, solution);
            let left = self.scaled(&next, &sizes, solution);
            let length = norm(&left);
            if length.is_nan() || length >= lengths[lengths.len() - 1] {
                *solution = before;
                if taken.is_empty() {
                    break;
                }
                // Directions that have lost what they are orthogonal to.
                taken.clear();
                continue;
            }
            (step, residual) = (next, left);
            taken.push(Taken { direction, change });
            lengths.push(length);
            if lengths.len() > LAST && length > tolerances::proximal::PROGRESS * lengths[lengths.len() - 1 - LAST] {
                break;
            }
        }
        step
    }

    /// What a residual asks for: of a plate that nothing holds firmly a rigid motion first, to be added exactly, then what
    /// the state's equations make of the rest.
    pub(super) fn direction(
        &self,
        load: &[f64],
        saddle: &Saddle,
        step: &Residual,
        floating: Option<&Floating>,
        solution: &ContactSolution,
    ) -> Direction {
        let problem = self.problem;
        let (rigid, reaction) = match floating {
            Some(floating) => floating.response(step),
            None => {
                let (nodal, reaction) = saddle.response(problem, &step.imbalance, &step.remaining);
                if problem.held.contains(&true) {
                    return Direction { rigid: [0.0; 3], nodal, reaction };
                }
                (rigid_part(&problem.plate, &nodal), reaction)
            }
        };
        let mut direction = Direction { rigid, nodal: vec![0.0; problem.plate.dof_count()], reaction };
        let mut afloat = solution.clone();
        afloat.follow(problem, &direction, 1.0);
        let step = problem.residual(load, &afloat);
        let (nodal, reaction) = saddle.response(problem, &step.imbalance, &step.remaining);
        direction.nodal = nodal;
        direction.reaction.iter_mut().zip(&reaction).for_each(|(total, increment)| *total += increment);
        direction
    }

    /// Length of what is out of balance and left of closed gaps.
    pub(super) fn length(&self, load: &[f64], step: &Residual, solution: &ContactSolution) -> f64 {
        norm(&self.scaled(step, &self.sizes(load, solution), solution))
    }

    fn sizes(&self, load: &[f64], solution: &ContactSolution) -> Sizes {
        let or_one = |size: f64| if size > 0.0 { size } else { 1.0 };
        let force = or_one(self.problem.largest_force(load, solution).max(self.beside));
        let lengths = self.problem.lengths(solution).into_iter().zip(&self.per_length);
        let least = self.least_length(load);
        let gap = lengths.map(|(length, unit)| or_one(length.max(least)) * unit).collect();
        Sizes { force, couple: force * self.problem.across(), gap }
    }

    /// What is out of balance at every dof, then what is left of the gaps of closed points.
    fn scaled(&self, step: &Residual, sizes: &Sizes, solution: &ContactSolution) -> Vec<f64> {
        let forces =
            step.imbalance.chunks(3).flat_map(|f| [f[0] / sizes.force, f[1] / sizes.couple, f[2] / sizes.couple]);
        let closed = (0..step.remaining.len()).filter(|&i| solution.closed[i]);
        forces.chain(closed.map(|i| step.remaining[i] / sizes.gap[i])).collect()
    }
}

impl ContactSolution {
    pub(super) fn follow(&mut self, problem: &ContactProblem, direction: &Direction, length: f64) {
        if direction.rigid != [0.0; 3] {
            let (centre, _) = extent(&problem.plate);
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
    /// The motion of all nodes (3n).
    pub(super) fn motion(&self, plate: &Plate) -> Vec<f64> {
        let mut all = Displacement { hi: self.nodal.clone(), lo: vec![0.0; self.nodal.len()] };
        all.add_rigid(plate, extent(plate).0, self.rigid);
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
