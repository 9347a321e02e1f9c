//! Rigid motions of a plate that only springs and contact points hold, apart from everything else.
//!
//! Where what holds is soft beside the plate, eliminating K finds them to few digits, and adding them as doubles strains
//! the plate by their rounding. Here they follow from the three resultants alone, and are added exactly.

use super::regularized::Regularized;
use crate::contact::refinement::Residual;
use crate::contact::rigid::{eliminated, extent, rigid_motions};
use crate::double_double::DoubleDouble;
use crate::residual::Rows;

/// What the three rigid motions w, w + x and w + y about a centre, over a size, do at springs and contact points.
pub(super) struct Floating {
    size: f64,
    nodal: [Vec<f64>; 3],
    points: Vec<[f64; 3]>,
    /// Compliance of the points that are closed.
    compliance: Vec<Option<f64>>,
    /// What holds the three motions.
    matrix: [[DoubleDouble; 3]; 3],
}

impl Floating {
    /// Nothing where a dof is held, or springs and closed points hold the plate as firmly as it holds together.
    pub(super) fn of(regularized: &Regularized, closed: &[bool]) -> Option<Self> {
        let problem = regularized.problem;
        if problem.held.contains(&true) {
            return None;
        }
        let plate = &problem.plate;
        let (centre, size) = extent(plate);
        let nodal = rigid_motions(plate, centre, size);
        let arms = |rows: &Rows, row: usize| [0, 1, 2].map(|k| rows.dot(plate, row, &nodal[k]));
        let points: Vec<_> = (0..closed.len()).map(|row| arms(&problem.constraints.rows, row)).collect();
        let acting = |(i, &c): (usize, &f64)| (closed[i] && c > 0.0).then_some(c);
        let compliance: Vec<_> = regularized.compliance.iter().enumerate().map(acting).collect();
        let mut matrix = [[DoubleDouble::default(); 3]; 3];
        let mut hold = |arm: [f64; 3], stiffness: f64| {
            let scaled = arm.map(|a| stiffness.sqrt() * a);
            for j in 0..3 {
                for k in 0..3 {
                    matrix[j][k].add_product(scaled[j], scaled[k]);
                }
            }
        };
        for (row, &stiffness) in problem.springs.stiffness.iter().enumerate() {
            hold(arms(&problem.springs.rows, row), stiffness);
        }
        for (arm, c) in points.iter().zip(&compliance).filter_map(|(arm, c)| Some((arm, (*c)?))) {
            hold(*arm, 1.0 / c);
        }
        let softest = eliminated(matrix, Default::default()).1;
        (softest < regularized.own_stiffness).then_some(Self { size, nodal, points, compliance, matrix })
    }

    /// The rigid motion (deflection and slopes at the centre) that balances a step's resultants by springs and closed
    /// points alone, and the increments of reaction that go with it.
    pub(super) fn response(&self, step: &Residual) -> ([f64; 3], Vec<f64>) {
        let mut right = [0, 1, 2].map(|k| {
            let mut sum = DoubleDouble::default();
            self.nodal[k].iter().zip(&step.imbalance).for_each(|(u, f)| sum.add_product(*u, *f));
            sum
        });
        for (i, c) in self.compliance.iter().enumerate().filter_map(|(i, c)| Some((i, (*c)?))) {
            let root = 1.0 / c.sqrt();
            for k in 0..3 {
                right[k].add_product(root * self.points[i][k], root * step.remaining[i]);
            }
        }
        let ([w, sx, sy], _) = eliminated(self.matrix, right);
        let push = |(i, c): (usize, &Option<f64>)| {
            let arm = self.points[i];
            c.map_or(0.0, |c| (arm[0] * w + arm[1] * sx + arm[2] * sy - step.remaining[i]) / c)
        };
        ([w, sx / self.size, sy / self.size], self.compliance.iter().enumerate().map(push).collect())
    }
}
