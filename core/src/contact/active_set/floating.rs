//! Rigid motions of a plate that springs and points alone hold, where those that push are soft beside the plate.
//!
//! A factor's own rounding resists a rigid motion, and may do so more than a few points under the edge of a plate, or than
//! springs for which it had to be made firmer. Three equations in double-double have no such resistance: for the shape
//! that the plate has they find where it rests.

use super::descent::Descent;
use crate::contact::careful::{eliminated, extent, rigid_motions, rigidity};
use crate::contact::problem::ContactProblem;
use crate::double_double::DoubleDouble;
use crate::superposition::sum_in_order;

/// Part of D/a² below which what pushes is soft.
const SOFT: f64 = 1.0;
/// Stiffness that the motions meet, over that of all points together, so that those that nothing holds end at the next point.
const LEAST: f64 = 1e-16;
/// Resultants, over the forces that they are the sum of, that are rounding.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// At most this many steps at a time.
const STEPS: usize = 100;

/// What the motions w, w + x and w + y do at points and springs, and the load on them.
pub(super) struct Floating {
    centre: [f64; 2],
    size: f64,
    arms: Vec<[f64; 3]>,
    spring_arms: Vec<[f64; 3]>,
    load: [DoubleDouble; 3],
    magnitude: f64,
    /// D/a².
    own_stiffness: f64,
}

impl Floating {
    /// Nothing where a dof is held, or a point both ways.
    pub(super) fn of(problem: &ContactProblem, load: &[f64]) -> Option<Self> {
        if problem.held.contains(&true) || !problem.constraints.rows.is_empty() {
            return None;
        }
        let (plate, points) = (&problem.plate, &problem.active);
        let (centre, size) = extent(plate);
        let motions = rigid_motions(plate, centre, size);
        let arms = (0..points.len()).map(|i| [0, 1, 2].map(|k| points.dot(plate, i, &motions[k]))).collect();
        let springs = &problem.springs.rows;
        let spring_arms = (0..springs.len()).map(|i| [0, 1, 2].map(|k| springs.dot(plate, i, &motions[k]))).collect();
        let mut magnitude = 0.0;
        let load = [0, 1, 2].map(|k| {
            let mut sum = DoubleDouble::default();
            for (u, f) in motions[k].iter().zip(load) {
                sum.add_product(*u, *f);
                magnitude += (u * f).abs();
            }
            sum
        });
        Some(Self { centre, size, arms, spring_arms, load, magnitude, own_stiffness: rigidity(plate) / (size * size) })
    }
}

type Matrix = [[DoubleDouble; 3]; 3];

impl Descent<'_> {
    /// What springs and closed points resist the three motions with.
    fn holding(&self, floating: &Floating) -> Matrix {
        let mut matrix = Matrix::default();
        let mut hold = |arm: [f64; 3], stiffness: f64| {
            let scaled = arm.map(|a| stiffness.sqrt() * a);
            for j in 0..3 {
                for k in 0..=j {
                    matrix[j][k].add_product(scaled[j], scaled[k]);
                    matrix[k][j] = matrix[j][k];
                }
            }
        };
        let springs = floating.spring_arms.iter().zip(&self.problem.springs.stiffness);
        springs.for_each(|(arm, &stiffness)| hold(*arm, stiffness));
        let closed = (0..self.stretch.len()).filter(|&i| self.is_closed(i));
        closed.for_each(|i| hold(floating.arms[i], self.springs.stiffness[i]));
        matrix
    }

    /// Forces (s,) of the springs.
    fn spring_forces(&self) -> Vec<f64> {
        let springs = &self.problem.springs;
        let stretch = |i: usize| springs.rows.gap(&self.problem.plate, i, &self.solution.displacement, springs.base[i]);
        springs.stiffness.iter().enumerate().map(|(i, stiffness)| stiffness * stretch(i)).collect()
    }

    /// Where what holds is soft, moves the plate as it is bent to the least energy; whether it was.
    pub(super) fn drift(&mut self) -> bool {
        let Some(floating) = self.floating.take() else { return false };
        let holding = eliminated(self.holding(&floating), Default::default()).1;
        let soft = self.problem.base.firmer || holding < SOFT * floating.own_stiffness;
        if soft && self.drifted(&floating) {
            self.balance();
        }
        self.floating = Some(floating);
        soft
    }

    fn drifted(&mut self, floating: &Floating) -> bool {
        let all = self.springs.stiffness.iter().chain(&self.problem.springs.stiffness).sum::<f64>();
        let mut moved = false;
        for _ in 0..STEPS {
            let mut left = floating.load;
            let mut magnitude = floating.magnitude;
            let mut push = |force: f64, arm: &[f64; 3]| {
                magnitude += force.abs();
                (0..3).for_each(|k| left[k].add_product(-force, arm[k]));
            };
            self.spring_forces().iter().zip(&floating.spring_arms).for_each(|(force, arm)| push(*force, arm));
            let closed = (0..self.stretch.len()).filter(|&i| self.is_closed(i));
            closed.for_each(|i| push(self.springs.stiffness[i] * self.stretch[i], &floating.arms[i]));
            if left.iter().all(|sum| sum.value().abs() <= ROUNDING * magnitude) {
                break;
            }
            let mut matrix = self.holding(floating);
            (0..3).for_each(|k| matrix[k][k] += LEAST * all);
            let (step, _) = eliminated(matrix, left);
            let along = |arm: &[f64; 3]| (0..3).map(|k| arm[k] * step[k]).sum::<f64>();
            let change: Vec<f64> = floating.arms.iter().map(along).collect();
            let springs = floating.spring_arms.iter().zip(&self.problem.springs.stiffness);
            let elastic = springs.map(|(arm, stiffness)| stiffness * along(arm).powi(2)).sum();
            let start = -sum_in_order(3, 3, |k| left[k].value() * step[k]);
            let length = if self.imposed.is_some() { 1.0 } else { self.least_energy(start, elastic, &change) };
            if !(length > 0.0) {
                break;
            }
            let [w, sx, sy] = step.map(|s| length * s);
            let motion = [w, sx / floating.size, sy / floating.size];
            self.solution.displacement.add_rigid(&self.problem.plate, floating.centre, motion);
            self.stretched();
            moved = true;
        }
        moved
    }
}
