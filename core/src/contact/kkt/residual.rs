//! What is out of balance and what is left of the gaps, and by what they are measured.
//!
//! Inside the methods points stand in the problem's order, the condensed ones before those of the active set.

use crate::contact::condense::Work;
use crate::contact::problem::ContactProblem;
use crate::contact::scale::norm;
use crate::contact::solution::ContactSolution;
use crate::contact::tolerances;
use crate::displacement::Displacement;
use crate::residual::{internal_magnitudes, residual};

/// What is out of balance and what is left of the gaps.
#[derive(Clone, Default)]
pub(crate) struct Residual {
    /// f − Ku − Gᵀ·reaction at every dof; 0 where it is held.
    pub(crate) imbalance: Vec<f64>,
    /// distance − row·u + compliance·reaction of every point that has a reaction.
    pub(crate) remaining: Vec<f64>,
    /// Largest imbalance as a force.
    pub(crate) worst: f64,
}

/// What a residual is measured by: forces, couples, and what is left of the gap of every point.
pub(super) struct Sizes {
    pub(super) force: f64,
    couple: f64,
    gap: Vec<f64>,
}

impl ContactProblem {
    pub(crate) fn residual(&self, load: &[f64], solution: &ContactSolution) -> Residual {
        self.residual_of(self.imbalance(load, &solution.displacement, &solution.reaction), solution)
    }

    /// The residual from what is out of balance at every dof, those held included.
    pub(crate) fn residual_of(&self, mut imbalance: Vec<f64>, solution: &ContactSolution) -> Residual {
        self.release_held(&mut imbalance);
        let worst = self.scale.largest(&imbalance);
        Residual { imbalance, remaining: self.remaining(&solution.displacement, &solution.reaction), worst }
    }

    /// f − Ku − springs − Gᵀ·reaction at every dof: out of balance where free, the support's upward force where held.
    pub fn imbalance(&self, load: &[f64], displacement: &Displacement, reaction: &[f64]) -> Vec<f64> {
        let mut out = residual(&self.plate, &self.springs, load, displacement);
        let (condensed, active) = reaction.split_at(self.constraints.rows.len());
        self.take_off(condensed, &mut out);
        for (i, reaction) in active.iter().enumerate().filter(|(_, reaction)| **reaction != 0.0) {
            self.active.scatter(&self.plate, i, -reaction, &mut out);
        }
        out
    }

    /// distance − row·u + compliance·reaction, in double-double, of as many points as there are reactions.
    pub fn remaining(&self, displacement: &Displacement, reaction: &[f64]) -> Vec<f64> {
        let c = &self.constraints;
        let (condensed, active) = reaction.split_at(c.rows.len());
        let left = |(i, reaction): (usize, &f64)| {
            c.compliance[i] * reaction - c.rows.beyond(&self.plate, i, displacement, c.distance[i])
        };
        let mut remaining: Vec<f64> = condensed.iter().enumerate().map(left).collect();
        if !active.is_empty() {
            let overlap = self.active.overlap(&self.plate, displacement);
            let all = active.iter().zip(&self.active.compliance).zip(overlap);
            remaining.extend(all.map(|((reaction, compliance), overlap)| compliance * reaction - overlap));
        }
        remaining
    }

    /// Work of a load in each free rigid motion.
    pub(crate) fn work(&self, load: &[f64]) -> Work {
        let of = |motion: &Vec<f64>| {
            let terms = motion.iter().zip(load).map(|(u, f)| u * f);
            (terms.clone().sum::<f64>(), terms.map(f64::abs).sum::<f64>())
        };
        let (sum, size) = self.constraints.free_motions.iter().map(of).unzip();
        Work { sum, size }
    }

    /// Zeroes a nodal vector at the dofs held.
    pub(crate) fn release_held(&self, vector: &mut [f64]) {
        for (value, &held) in vector.iter_mut().zip(&self.held) {
            if held {
                *value = 0.0;
            }
        }
    }

    /// Largest force of a load and of reactions, of those that have a lever over that.
    pub(crate) fn largest_force(&self, load: &[f64], reaction: &[f64]) -> f64 {
        let reactions = reaction.iter().enumerate().map(|(i, r)| r.abs() / self.lever(i));
        reactions.fold(self.scale.largest(load), f64::max)
    }

    /// As [`ContactProblem::largest_force`], of forces that count at least; without a load also what bends the plate as far
    /// as closed points are away, beside which reactions of springs that just touch are rounding.
    fn acting(&self, load: &[f64], solution: &ContactSolution, least: f64) -> f64 {
        let force = self.largest_force(load, &solution.reaction).max(least);
        if force == 0.0 || load.iter().any(|&f| f != 0.0) {
            return force;
        }
        let reached = self.travels().zip(&solution.closed).enumerate().filter(|(_, (_, closed))| **closed);
        let farthest = reached.map(|(i, (travel, _))| travel.abs() * self.lever(i)).fold(0.0, f64::max);
        force.max(self.scale.stiffness * farthest)
    }

    /// By what what is left of a point's gap is a length: 1, or the plate's size where its row is of slopes.
    pub(crate) fn lever(&self, point: usize) -> f64 {
        self.levers.get(point).copied().unwrap_or(1.0)
    }

    /// How far every point is from its support.
    fn travels(&self) -> impl Iterator<Item = &f64> {
        self.constraints.distance.iter().chain(&self.active.distance)
    }

    /// What the gap of each point is measured by, the largest deflection or its own travel: a stop far away says nothing
    /// of what happens at others.
    pub(crate) fn lengths(&self, solution: &ContactSolution) -> Vec<f64> {
        let deflection = solution.displacement.hi.iter().step_by(3).fold(0.0, |size: f64, w| size.max(w.abs()));
        let travels = self.travels().take(solution.reaction.len());
        travels.enumerate().map(|(i, travel)| travel.abs().max(deflection / self.lever(i))).collect()
    }

    /// A length by which those of a plate that hardly deflects are measured; far less than the load would deflect it.
    pub(crate) fn least_length(&self, load: &[f64]) -> f64 {
        let springs = &self.springs;
        let settled: f64 = springs.stiffness.iter().zip(&springs.base).map(|(k, base)| (k * base).abs()).sum();
        tolerances::proximal::NIL * (self.scale.sum(load) + settled) / self.scale.stiffness
    }

    /// Rounding of what the plate's own forces are the sum of, as a force.
    pub(crate) fn rounding(&self, displacement: &Displacement) -> f64 {
        let mut internal = internal_magnitudes(&self.plate, displacement);
        self.release_held(&mut internal);
        f64::EPSILON * self.scale.largest(&internal)
    }

    /// By a solution, and a force whose rounding is none of its fault.
    pub(super) fn sizes(&self, load: &[f64], solution: &ContactSolution, least: f64) -> Sizes {
        let or_one = |size: f64| if size > 0.0 { size } else { 1.0 };
        let force = match self.acting(load, solution, least) {
            // Nothing acts and no point reacts: what the plate's own forces are the sum of.
            0.0 => or_one(self.rounding(&solution.displacement) / f64::EPSILON),
            force => force,
        };
        let nil = self.least_length(load);
        let length = |(i, length): (usize, f64)| or_one(length.max(nil / self.lever(i)));
        let gap = self.lengths(solution).into_iter().enumerate().map(length).collect();
        Sizes { force, couple: force * self.scale.arm, gap }
    }

    /// What is out of balance at every dof, then what is left of the gaps of closed points.
    pub(super) fn scaled(&self, step: &Residual, sizes: &Sizes, closed: &[bool]) -> Vec<f64> {
        let forces =
            step.imbalance.chunks(3).flat_map(|f| [f[0] / sizes.force, f[1] / sizes.couple, f[2] / sizes.couple]);
        let closed = (0..step.remaining.len()).filter(|&i| closed[i]);
        forces.chain(closed.map(|i| step.remaining[i] / sizes.gap[i])).collect()
    }

    /// Length of what is out of balance and left of closed gaps.
    pub(crate) fn length(&self, load: &[f64], step: &Residual, solution: &ContactSolution, least: f64) -> f64 {
        norm(&self.scaled(step, &self.sizes(load, solution, least), &solution.closed))
    }

    /// Whether a residual is that of a solution of its set's equations; where nothing acts there is nothing to miss.
    pub(crate) fn satisfies(&self, load: &[f64], step: &Residual, solution: &ContactSolution, least: f64) -> bool {
        let length = self.length(load, step, solution, least);
        let force = self.acting(load, solution, least);
        if length <= tolerances::SOLVED || force == 0.0 {
            return length.is_finite();
        }
        let roundings = tolerances::ROUNDINGS * (self.plate.dof_count() as f64).sqrt();
        length <= roundings * self.rounding(&solution.displacement) / force
    }
}
