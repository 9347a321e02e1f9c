//! Rigid motions of a plate that springs and points alone hold, where those that push are soft beside the plate.
//!
//! A factor's own rounding resists a rigid motion, and may do so more than a few points under the edge of a plate, or than
//! springs for which it had to be made firmer. Three equations in double-double have no such resistance: for the shape
//! that the plate has they find where it rests.

use crate::contact::problem::ContactProblem;
use crate::contact::rigid::{extent, rigid_motions, rigidity};
use crate::double_double::DoubleDouble;

/// What the motions w, w + x and w + y do at points and springs, and the load on them.
pub(super) struct Floating {
    pub(super) centre: [f64; 2],
    pub(super) size: f64,
    pub(super) arms: Vec<[f64; 3]>,
    pub(super) spring_arms: Vec<[f64; 3]>,
    pub(super) load: [DoubleDouble; 3],
    pub(super) magnitude: f64,
    /// D/a².
    pub(super) own_stiffness: f64,
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
