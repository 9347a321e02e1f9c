//! Rigid motions of a plate that only springs and contact points hold, apart from everything else.
//!
//! Where what holds is soft beside the plate, eliminating K gives them to few digits, and adding them as doubles strains
//! the plate by their rounding: a factor's own rounding may resist them more than a few points under an edge do. Here they
//! follow from the three resultants alone, and are added exactly.

use super::points::Points;
use super::rigid::{eliminated, rigid_motions};
use super::scale::Scale;
use crate::double_double::DoubleDouble;
use crate::plate::Plate;
use crate::rows::Springs;
use rayon::prelude::*;

pub(super) type Matrix = [[DoubleDouble; 3]; 3];

/// Points that one thread takes at a time.
const CHUNK: usize = 8192;

/// What the three rigid motions w, w + x and w + y about the middle, over the plate's size, do.
pub(super) struct Floating {
    pub(super) size: f64,
    /// At every dof.
    pub(super) nodal: [Vec<f64>; 3],
    /// At every contact point and spring.
    pub(super) points: Vec<[f64; 3]>,
    pub(super) springs: Vec<[f64; 3]>,
}

impl Floating {
    /// Nothing where a dof is held.
    pub(super) fn on(plate: &Plate, held: &[bool], scale: &Scale, points: &Points, springs: &Springs) -> Option<Self> {
        if held.contains(&true) {
            return None;
        }
        let nodal = rigid_motions(plate, scale);
        let of_points = (0..points.len()).map(|i| [0, 1, 2].map(|k| points.dot(i, &nodal[k]))).collect();
        let rows = &springs.rows;
        let of_springs = (0..rows.len()).map(|i| [0, 1, 2].map(|k| rows.dot(plate, i, &nodal[k]))).collect();
        Some(Self { size: scale.size, nodal, points: of_points, springs: of_springs })
    }

    /// What springs and points hold the motions with, given the stiffness of both; that of open points is 0.
    pub(super) fn holding(&self, of_points: impl Fn(usize) -> f64 + Sync, of_springs: &[f64]) -> Matrix {
        let holds = |held: &mut Matrix, arm: &[f64; 3], stiffness: f64| {
            let scaled = arm.map(|a| stiffness.sqrt() * a);
            for j in 0..3 {
                (0..=j).for_each(|k| held[j][k].add_product(scaled[j], scaled[k]));
            }
        };
        // Chunk by chunk, in their order, so that the sum is the same on any number of threads.
        let of_chunk = |(chunk, arms): (usize, &[[f64; 3]])| {
            let mut held = Matrix::default();
            let stiffness = arms.iter().enumerate().map(|(i, arm)| (arm, of_points(CHUNK * chunk + i)));
            stiffness.filter(|(_, k)| *k > 0.0).for_each(|(arm, k)| holds(&mut held, arm, k));
            held
        };
        let chunks: Vec<Matrix> = self.points.par_chunks(CHUNK).enumerate().map(of_chunk).collect();
        let mut matrix = Matrix::default();
        self.springs.iter().zip(of_springs).for_each(|(arm, &stiffness)| holds(&mut matrix, arm, stiffness));
        for held in chunks {
            (0..3).for_each(|j| (0..=j).for_each(|k| matrix[j][k] = matrix[j][k] + held[j][k]));
        }
        (0..3).for_each(|j| (0..j).for_each(|k| matrix[k][j] = matrix[j][k]));
        matrix
    }

    /// The softest that they hold a motion.
    pub(super) fn softest(&self, of_points: impl Fn(usize) -> f64 + Sync, of_springs: &[f64]) -> f64 {
        eliminated(self.holding(of_points, of_springs), Default::default()).1
    }

    /// Resultants of nodal forces.
    pub(super) fn resultants(&self, nodal: &[f64]) -> [DoubleDouble; 3] {
        [0, 1, 2].map(|k| {
            let mut sum = DoubleDouble::default();
            self.nodal[k].iter().zip(nodal).for_each(|(u, f)| sum.add_product(*u, *f));
            sum
        })
    }

    /// The motion (deflection and slopes at the middle) of amounts of the three.
    pub(super) fn motion(&self, [w, x, y]: [f64; 3]) -> [f64; 3] {
        [w, x / self.size, y / self.size]
    }
}
