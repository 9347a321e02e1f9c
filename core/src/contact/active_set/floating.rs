//! Rigid motions of a plate that rests on its points alone, where those that push are soft beside the plate.
//!
//! A factor's own rounding resists a rigid motion, and may do so more than a few points under the edge of a plate. Three
//! equations in double-double have no such resistance: for the shape that the plate has they find where it rests.

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

/// What the motions w, w + x and w + y do at the points, and the load on them.
pub(super) struct Floating {
    centre: [f64; 2],
    size: f64,
    arms: Vec<[f64; 3]>,
    load: [DoubleDouble; 3],
    magnitude: f64,
    /// D/a².
    own_stiffness: f64,
}

impl Floating {
    /// Nothing where anything but the points of the active set holds the plate.
    pub(super) fn of(problem: &ContactProblem, load: &[f64]) -> Option<Self> {
        let springs = problem.springs.stiffness.iter().any(|&k| k != 0.0);
        if springs || problem.held.contains(&true) || !problem.constraints.rows.is_empty() {
            return None;
        }
        let (plate, points) = (&problem.plate, &problem.active);
        let (centre, size) = extent(plate);
        let motions = rigid_motions(plate, centre, size);
        let arms = (0..points.len()).map(|i| [0, 1, 2].map(|k| points.dot(plate, i, &motions[k]))).collect();
        let mut magnitude = 0.0;
        let load = [0, 1, 2].map(|k| {
            let mut sum = DoubleDouble::default();
            for (u, f) in motions[k].iter().zip(load) {
                sum.add_product(*u, *f);
                magnitude += (u * f).abs();
            }
            sum
        });
        Some(Self { centre, size, arms, load, magnitude, own_stiffness: rigidity(plate) / (size * size) })
    }
}

type Matrix = [[DoubleDouble; 3]; 3];

impl Descent<'_> {
    /// What the points that push resist the three motions with.
    fn holding(&self, floating: &Floating) -> Matrix {
        let mut matrix = Matrix::default();
        for i in (0..self.stretch.len()).filter(|&i| self.stretch[i] > 0.0) {
            let scaled = floating.arms[i].map(|a| self.springs.stiffness[i].sqrt() * a);
            for j in 0..3 {
                for k in 0..=j {
                    matrix[j][k].add_product(scaled[j], scaled[k]);
                    matrix[k][j] = matrix[j][k];
                }
            }
        }
        matrix
    }

    /// Where what pushes is soft, moves the plate as it is bent to the least energy; whether it was.
    pub(super) fn drift(&mut self) -> bool {
        let Some(floating) = self.floating.take() else { return false };
        let soft = eliminated(self.holding(&floating), Default::default()).1 < SOFT * floating.own_stiffness;
        if soft && self.drifted(&floating) {
            self.balance();
        }
        self.floating = Some(floating);
        soft
    }

    fn drifted(&mut self, floating: &Floating) -> bool {
        let all = self.springs.stiffness.iter().sum::<f64>();
        let mut moved = false;
        for _ in 0..STEPS {
            let mut left = floating.load;
            let mut magnitude = floating.magnitude;
            for i in (0..self.stretch.len()).filter(|&i| self.stretch[i] > 0.0) {
                let force = self.springs.stiffness[i] * self.stretch[i];
                magnitude += force;
                (0..3).for_each(|k| left[k].add_product(-force, floating.arms[i][k]));
            }
            if left.iter().all(|sum| sum.value().abs() <= ROUNDING * magnitude) {
                break;
            }
            let mut matrix = self.holding(floating);
            (0..3).for_each(|k| matrix[k][k] += LEAST * all);
            let (step, _) = eliminated(matrix, left);
            let along = |i: usize| (0..3).map(|k| floating.arms[i][k] * step[k]).sum::<f64>();
            let change: Vec<f64> = (0..self.stretch.len()).map(along).collect();
            let start = -sum_in_order(3, 3, |k| left[k].value() * step[k]);
            let length = self.least_energy(start, 0.0, &change);
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
