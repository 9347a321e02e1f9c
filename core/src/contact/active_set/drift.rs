//! Rigid motions of least energy of a plate on soft supports, for the shape that it has.

use super::descent::{Afloat, Descent};
use crate::contact::kkt::Floating;
use crate::contact::rigid::eliminated;
use crate::contact::tolerances;
use crate::double_double::DoubleDouble;
use crate::superposition::sum_in_order;

/// At most this many steps at a time.
const STEPS: usize = 100;

impl Descent<'_> {
    /// What springs and pushing points resist the three motions with.
    fn holding(&self, floating: &Floating) -> [[DoubleDouble; 3]; 3] {
        let pushing = |i: usize| if self.stretch[i] > 0.0 { self.factor.penalty.stiffness[i] } else { 0.0 };
        floating.holding(pushing, &self.problem.springs.stiffness)
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
        let Some(afloat) = self.afloat.take() else { return false };
        let holding = eliminated(self.holding(&afloat.floating), Default::default()).1;
        let soft = self.problem.base.firmer || holding < self.problem.scale.stiffness;
        if soft && self.drifted(&afloat) {
            self.balance();
        }
        self.afloat = Some(afloat);
        soft
    }

    fn drifted(&mut self, afloat: &Afloat) -> bool {
        let Afloat { floating, load, magnitude } = afloat;
        let stiffness = &self.problem.springs.stiffness;
        let all = self.factor.penalty.stiffness.iter().chain(stiffness).sum::<f64>();
        let mut moved = false;
        for _ in 0..STEPS {
            let (mut left, mut magnitude) = (*load, *magnitude);
            let mut push = |force: f64, arm: &[f64; 3]| {
                magnitude += force.abs();
                (0..3).for_each(|k| left[k].add_product(-force, arm[k]));
            };
            self.spring_forces().iter().zip(&floating.springs).for_each(|(force, arm)| push(*force, arm));
            let pushing = (0..self.stretch.len()).filter(|&i| self.stretch[i] > 0.0);
            pushing.for_each(|i| push(self.factor.penalty.stiffness[i] * self.stretch[i], &floating.points[i]));
            if left.iter().all(|sum| sum.value().abs() <= tolerances::newton::RESULTANT * magnitude) {
                break;
            }
            let mut matrix = self.holding(floating);
            (0..3).for_each(|k| matrix[k][k] += tolerances::newton::LEAST * all);
            let (step, _) = eliminated(matrix, left);
            let along = |arm: &[f64; 3]| (0..3).map(|k| arm[k] * step[k]).sum::<f64>();
            let change: Vec<f64> = floating.points.iter().map(along).collect();
            let springs = floating.springs.iter().zip(stiffness);
            let elastic = springs.map(|(arm, stiffness)| stiffness * along(arm).powi(2)).sum();
            let start = -sum_in_order(3, 3, |k| left[k].value() * step[k]);
            let length = self.least_energy(start, elastic, &change);
            if !(length > 0.0) {
                break;
            }
            let motion = floating.motion(step.map(|s| length * s));
            self.solution.displacement.add_rigid(&self.problem.plate, self.problem.scale.centre, motion);
            self.stretched();
            moved = true;
        }
        moved
    }
}
