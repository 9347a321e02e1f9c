//! A plate on springs so soft that its factor is firmer than they are: the rigid motions of least energy, apart from what
//! bends it. The two hardly act on each other, so that Newton directions of a load without resultants settle the rest.

use super::Descent;
use super::direction::Direction;
use crate::contact::careful::{eliminated, extent, rigid_motions};
use crate::double_double::DoubleDouble;
use crate::residual::Displacement;

/// At most this many sets of closed points.
const SETS: usize = 60;
/// Part of the stiffness of points that are open with which they count, so that no motion is free.
const OPEN: f64 = 1e-9;

impl Descent<'_> {
    pub(super) fn is_afloat(&self) -> bool {
        let problem = self.problem;
        problem.base.firmer && problem.constraints.rows.is_empty()
    }

    /// Moves the plate as a rigid body to where its energy is least.
    pub(super) fn move_rigidly(&mut self) {
        let (plate, points) = (&self.problem.plate, &self.problem.active);
        let (centre, size) = extent(plate);
        let nodal = rigid_motions(plate);
        let arms: Vec<[f64; 3]> =
            (0..points.len()).map(|i| [0, 1, 2].map(|k: usize| points.dot(plate, i, &nodal[k]))).collect();
        for _ in 0..SETS {
            let closed: Vec<bool> = (0..points.len()).map(|i| self.is_closed(i)).collect();
            let mut matrix = [[DoubleDouble::default(); 3]; 3];
            let mut hold = |arm: [f64; 3], stiffness: f64| {
                let scaled = arm.map(|a| stiffness.sqrt() * a);
                for j in 0..3 {
                    for k in 0..3 {
                        matrix[j][k].add_product(scaled[j], scaled[k]);
                    }
                }
            };
            let springs = &self.problem.springs;
            for (row, &stiffness) in springs.stiffness.iter().enumerate() {
                hold([0, 1, 2].map(|k: usize| springs.rows.dot(plate, row, &nodal[k])), stiffness);
            }
            for (i, arm) in arms.iter().enumerate() {
                hold(*arm, self.springs.stiffness[i] * if closed[i] { 1.0 } else { OPEN });
            }
            let right = [0, 1, 2].map(|k: usize| {
                let mut sum = DoubleDouble::default();
                nodal[k].iter().zip(&self.step.imbalance).for_each(|(u, f)| sum.add_product(*u, *f));
                sum
            });
            let ([w, sx, sy], _) = eliminated(matrix, right);
            let motion = [w, sx / size, sy / size];
            let mut moved = Displacement::zeros(self.load.len());
            moved.add_rigid(plate, centre, motion);
            let mut direction = Direction::zeros(self.load.len(), self.solution.reaction.len());
            direction.nodal = moved.hi;
            let length = match self.imposed {
                Some(_) => 1.0,
                None => self.line_search(&direction, &points.change(plate, &direction.nodal), &closed),
            };
            self.solution.displacement.add_rigid(plate, centre, motion.map(|part| length * part));
            self.balance();
            if (0..points.len()).all(|i| self.is_closed(i) == closed[i]) {
                break;
            }
        }
    }

    fn is_closed(&self, i: usize) -> bool {
        self.imposed.as_ref().map_or(self.stretch[i] > 0.0, |closed| closed[i])
    }
}
