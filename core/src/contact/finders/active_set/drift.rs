//! Rigid motions of least energy of plates on soft supports, for the shapes that they have.

use super::descent::Descent;
use crate::contact::kkt::Afloat;
use crate::contact::rigid::eliminated;
use crate::contact::tolerances;

/// At most this many steps at a time.
const STEPS: usize = 100;

impl Descent<'_> {
    /// What a point resists with.
    fn resistance(&self, i: usize) -> f64 {
        self.problem.points.force_at(i, self.kkt.series[i], self.stretch[i]).1
    }

    /// Where what holds is soft, moves the plate as it is bent to the least energy; whether it was.
    pub(super) fn drift(&mut self) -> bool {
        let Some(afloat) = self.afloat.take() else { return false };
        let softest = afloat.floating.softest(|i| self.resistance(i), &self.problem.springs.stiffness);
        let soft = softest < self.problem.scale.stiffness;
        if soft && self.drifted(&afloat) {
            self.balance();
        }
        self.afloat = Some(afloat);
        soft
    }

    fn drifted(&mut self, afloat: &Afloat<'_>) -> bool {
        let Afloat { floating, load, magnitude } = afloat;
        let (springs, points) = (&self.problem.springs, self.problem.points.len());
        let all = (0..points).map(|i| self.problem.steepest(i).in_series(self.kkt.series[i])).sum::<f64>()
            + springs.stiffness.iter().sum::<f64>();
        let mut moved = false;
        for _ in 0..STEPS {
            let (mut resultant, mut magnitude) = (load.clone(), *magnitude);
            let mut push = |force: f64, arm: &[f64]| {
                magnitude += force.abs();
                resultant.iter_mut().zip(arm).for_each(|(sum, arm)| sum.add_product(-force, *arm));
            };
            for (i, (stiffness, arm)) in springs.stiffness.iter().zip(floating.of_springs()).enumerate() {
                let u = &self.solution.displacement;
                push(stiffness * springs.rows.beyond(&self.problem.plate, i, u, springs.base[i]), arm);
            }
            (0..points).for_each(|i| push(self.force(i), floating.of_point(i)));
            let rounding = tolerances::newton::RESULTANT * magnitude;
            if resultant.iter().all(|sum| sum.value().abs() <= rounding) {
                break;
            }
            let mut matrix = floating.holding(|i| self.resistance(i), &springs.stiffness);
            let mut found = eliminated(matrix.clone(), resultant.clone());
            if found.unbalanced > rounding {
                (0..matrix.len()).for_each(|k| matrix[k][k] += tolerances::newton::LEAST * all);
                found = eliminated(matrix, resultant.clone());
            }
            let step = found.unknown;
            // Plates that go together press nothing between them: what is left of the sum is rounding.
            let along = |arm: &[f64]| {
                let terms = arm.iter().zip(&step).map(|(arm, step)| arm * step);
                let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), term: f64| (sum + term, size + term.abs()));
                if sum.abs() > tolerances::newton::FREE * size { sum } else { 0.0 }
            };
            let change: Vec<f64> = (0..points).map(|i| along(floating.of_point(i))).collect();
            let elastic = floating.of_springs().zip(&springs.stiffness).map(|(arm, k)| k * along(arm).powi(2)).sum();
            let start = -resultant.iter().zip(&step).map(|(sum, step)| sum.value() * step).sum::<f64>();
            let length = self.least_energy(start, elastic, &change);
            if !(length > 0.0) {
                break;
            }
            let motion = floating.motion(&step.iter().map(|s| length * s).collect::<Vec<_>>());
            self.solution.displacement.add_rigid(&self.problem.plate, self.problem.scale.centre, &motion);
            self.measure_stretches();
            moved = true;
        }
        moved
    }
}
