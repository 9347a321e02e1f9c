//! Rigid motions of a plate that only springs and contact points hold, apart from everything else.
//!
//! Where what holds is soft beside the plate, eliminating K finds them to few digits, and adding them as doubles strains
//! the plate by their rounding: a factor's own rounding may resist them more than a few points under an edge do. Here they
//! follow from the three resultants alone, and are added exactly.

use super::refinement::Correction;
use super::residual::Residual;
use crate::contact::problem::ContactProblem;
use crate::contact::rigid::{eliminated, rigid_motions};
use crate::double_double::DoubleDouble;

type Matrix = [[DoubleDouble; 3]; 3];

/// What the three rigid motions w, w + x and w + y about the middle, over the plate's size, do.
pub(crate) struct Floating {
    pub(crate) size: f64,
    /// At every dof.
    pub(crate) nodal: [Vec<f64>; 3],
    /// At every contact point and spring.
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) springs: Vec<[f64; 3]>,
}

impl Floating {
    /// Nothing where a dof is held.
    pub(crate) fn of(problem: &ContactProblem) -> Option<Self> {
        if problem.held.contains(&true) {
            return None;
        }
        let plate = &problem.plate;
        let nodal = rigid_motions(plate, &problem.scale);
        let rows = &problem.constraints.rows;
        let condensed = (0..rows.len()).map(|i| [0, 1, 2].map(|k| rows.dot(plate, i, &nodal[k])));
        let active = (0..problem.active.len()).map(|i| [0, 1, 2].map(|k| problem.active.dot(plate, i, &nodal[k])));
        let points = condensed.chain(active).collect();
        let rows = &problem.springs.rows;
        let springs = (0..rows.len()).map(|i| [0, 1, 2].map(|k| rows.dot(plate, i, &nodal[k]))).collect();
        Some(Self { size: problem.scale.size, nodal, points, springs })
    }

    /// What springs and points hold the motions with, given the stiffness of both; that of open points is 0.
    pub(crate) fn holding(&self, of_points: impl Fn(usize) -> f64, of_springs: &[f64]) -> Matrix {
        let mut matrix = Matrix::default();
        let mut hold = |arm: &[f64; 3], stiffness: f64| {
            let scaled = arm.map(|a| stiffness.sqrt() * a);
            for j in 0..3 {
                for k in 0..=j {
                    matrix[j][k].add_product(scaled[j], scaled[k]);
                    matrix[k][j] = matrix[j][k];
                }
            }
        };
        self.springs.iter().zip(of_springs).for_each(|(arm, &stiffness)| hold(arm, stiffness));
        let points = self.points.iter().enumerate().map(|(i, arm)| (arm, of_points(i)));
        points.filter(|(_, stiffness)| *stiffness > 0.0).for_each(|(arm, stiffness)| hold(arm, stiffness));
        matrix
    }

    /// Resultants of nodal forces.
    pub(crate) fn resultants(&self, nodal: &[f64]) -> [DoubleDouble; 3] {
        [0, 1, 2].map(|k| {
            let mut sum = DoubleDouble::default();
            self.nodal[k].iter().zip(nodal).for_each(|(u, f)| sum.add_product(*u, *f));
            sum
        })
    }

    /// The motion (deflection and slopes at the middle) of amounts of the three.
    pub(crate) fn motion(&self, [w, x, y]: [f64; 3]) -> [f64; 3] {
        [w, x / self.size, y / self.size]
    }
}

/// What holds a plate afloat in one contact set.
pub(crate) struct Held {
    floating: Floating,
    /// Compliance of the points that are closed.
    compliance: Vec<Option<f64>>,
    matrix: Matrix,
}

impl Held {
    /// Given the compliance that increments of every point's reaction meet; nothing where a dof is held, or springs and
    /// closed points hold the plate as firmly as it holds together.
    pub(crate) fn by(problem: &ContactProblem, compliance: &[f64], closed: &[bool]) -> Option<Self> {
        let floating = Floating::of(problem)?;
        let acting = |(&c, &closed): (&f64, &bool)| (closed && c > 0.0).then_some(c);
        let compliance: Vec<_> = compliance.iter().zip(closed).map(acting).collect();
        let matrix = floating.holding(|i| compliance[i].map_or(0.0, |c| 1.0 / c), &problem.springs.stiffness);
        let softest = eliminated(matrix, Default::default()).1;
        (problem.base.firmer || softest < problem.scale.stiffness).then_some(Self { floating, compliance, matrix })
    }

    /// The rigid motion that balances a step's resultants by springs and closed points alone, and the increments of reaction
    /// that go with it.
    pub(super) fn response(&self, step: &Residual) -> Correction {
        let Self { floating, compliance, matrix } = self;
        let mut right = floating.resultants(&step.imbalance);
        for (i, c) in compliance.iter().enumerate().filter_map(|(i, c)| Some((i, (*c)?))) {
            let root = 1.0 / c.sqrt();
            for k in 0..3 {
                right[k].add_product(root * floating.points[i][k], root * step.remaining[i]);
            }
        }
        let (amount, _) = eliminated(*matrix, right);
        let along = |arm: &[f64; 3]| (0..3).map(|k| arm[k] * amount[k]).sum::<f64>();
        let push =
            |(i, c): (usize, &Option<f64>)| c.map_or(0.0, |c| (along(&floating.points[i]) - step.remaining[i]) / c);
        let reaction = compliance.iter().enumerate().map(push).collect();
        Correction { rigid: floating.motion(amount), nodal: vec![0.0; step.imbalance.len()], reaction }
    }
}
