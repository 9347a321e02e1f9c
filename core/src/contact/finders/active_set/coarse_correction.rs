//! Coarse-space correction: if the supports are soft, the energy is minimised over the rigid motions of the plates,
//! without a change of their bending.

use super::iterate::NewtonIterate;
use crate::contact::kkt::CoarseLoad;
use crate::contact::rigid::eliminated;
use crate::contact::tolerances;

/// Largest number of Newton steps by which the energy is minimised over the rigid motions.
const STEPS: usize = 100;

impl NewtonIterate<'_> {
    /// Tangent stiffness of contact point i at its augmented travel s + σλ.
    fn resistance(&self, i: usize) -> f64 {
        self.problem.points.force_at(i, self.kkt.series[i], self.augmented_travel[i]).1
    }

    /// Minimises the energy over rigid motions if the supports are soft relative to the plate; returns whether they are
    /// soft.
    pub(super) fn coarse_correction(&mut self) -> bool {
        let Some(coarse_load) = self.coarse_load.take() else { return false };
        let softest = coarse_load.rigid_space.softest(|i| self.resistance(i), &self.problem.springs.stiffness);
        let soft = softest < self.problem.scale.stiffness;
        if soft && self.minimise_rigid_energy(&coarse_load) {
            self.balance();
        }
        self.coarse_load = Some(coarse_load);
        soft
    }

    fn minimise_rigid_energy(&mut self, coarse_load: &CoarseLoad<'_>) -> bool {
        let CoarseLoad { rigid_space, load, magnitude } = coarse_load;
        let (springs, points) = (&self.problem.springs, self.problem.points.len());
        let all = (0..points).map(|i| self.problem.points.steepest(i).in_series(self.kkt.series[i])).sum::<f64>()
            + springs.stiffness.iter().sum::<f64>();
        let mut moved = false;
        for _ in 0..STEPS {
            let (mut resultant, mut magnitude) = (load.clone(), *magnitude);
            let mut push = |force: f64, arm: &[f64]| {
                magnitude += force.abs();
                resultant.iter_mut().zip(arm).for_each(|(sum, arm)| sum.add_product(-force, *arm));
            };
            for (i, (stiffness, arm)) in springs.stiffness.iter().zip(rigid_space.of_springs()).enumerate() {
                let u = &self.solution.displacement;
                push(stiffness * springs.rows.beyond(&self.problem.plate, i, u, springs.base[i]), arm);
            }
            (0..points).for_each(|i| push(self.force(i), rigid_space.of_point(i)));
            let rounding = tolerances::newton::RESULTANT * magnitude;
            if resultant.iter().all(|sum| sum.value().abs() <= rounding) {
                break;
            }
            let mut matrix = rigid_space.projected_stiffness(|i| self.resistance(i), &springs.stiffness);
            let mut found = eliminated(matrix.clone(), resultant.clone());
            if found.unbalanced > rounding {
                (0..matrix.len()).for_each(|k| matrix[k][k] += tolerances::newton::LEAST * all);
                found = eliminated(matrix, resultant.clone());
            }
            let step = found.unknown;
            // Σ arm·step is the displacement of a spring or point (`arm`: its row of GR) under the rigid motions
            // `step`. If it is only rounding, as between plates that move together, it counts as zero.
            let along = |arm: &[f64]| {
                let terms = arm.iter().zip(&step).map(|(arm, step)| arm * step);
                let (sum, size) = terms.fold((0.0, 0.0), |(sum, size), term: f64| (sum + term, size + term.abs()));
                if sum.abs() > tolerances::newton::FREE * size { sum } else { 0.0 }
            };
            let change: Vec<f64> = (0..points).map(|i| along(rigid_space.of_point(i))).collect();
            let elastic = rigid_space.of_springs().zip(&springs.stiffness).map(|(arm, k)| k * along(arm).powi(2)).sum();
            let start = -resultant.iter().zip(&step).map(|(sum, step)| sum.value() * step).sum::<f64>();
            let length = self.least_energy(start, elastic, &change);
            if !(length > 0.0) {
                break;
            }
            let motion = rigid_space.motion(&step.iter().map(|s| length * s).collect::<Vec<_>>());
            self.solution.displacement.add_rigid(&self.problem.plate, self.problem.scale.centre, &motion);
            self.measure_travels();
            moved = true;
        }
        moved
    }
}
