//! The rigid motions of least energy of a plate on soft supports, for the shape that it has.

use super::descent::Descent;
use super::floating::Floating;
use crate::contact::rigid::eliminated;
use crate::contact::tolerances;
use crate::double_double::DoubleDouble;
use crate::superposition::sum_in_order;

/// At most this many steps at a time.
const STEPS: usize = 100;

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
        closed.for_each(|i| hold(floating.arms[i], self.penalty.stiffness[i]));
        matrix
    }

    /// Forces (s,) of the springs.
    fn spring_forces(&self) -> Vec<f64> {
        let springs = &self.problem.springs;
        let stretch =
            |i: usize| springs.rows.beyond(&self.problem.plate, i, &self.solution.displacement, springs.base[i]);
        springs.stiffness.iter().enumerate().map(|(i, stiffness)| stiffness * stretch(i)).collect()
    }

    /// Where what holds is soft, moves the plate as it is bent to the least energy; whether it was.
    pub(super) fn drift(&mut self) -> bool {
        let Some(floating) = self.floating.take() else { return false };
        let holding = eliminated(self.holding(&floating), Default::default()).1;
        let soft = self.problem.base.firmer || holding < tolerances::newton::SOFT * floating.own_stiffness;
        if soft && self.drifted(&floating) {
            self.balance();
        }
        self.floating = Some(floating);
        soft
    }

    fn drifted(&mut self, floating: &Floating) -> bool {
        let all = self.penalty.stiffness.iter().chain(&self.problem.springs.stiffness).sum::<f64>();
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
            closed.for_each(|i| push(self.penalty.stiffness[i] * self.stretch[i], &floating.arms[i]));
            if left.iter().all(|sum| sum.value().abs() <= tolerances::newton::RESULTANT * magnitude) {
                break;
            }
            let mut matrix = self.holding(floating);
            (0..3).for_each(|k| matrix[k][k] += tolerances::newton::LEAST * all);
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
