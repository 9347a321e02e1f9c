//! Rigid motions of plates that only springs and contact points hold, apart from everything else.
//!
//! Where what holds is soft beside the plates, eliminating K gives them to few digits, and adding them as doubles strains
//! the plates by their rounding: a factor's own rounding may resist them more than a few points under an edge do. Here they
//! follow from the resultants on every plate alone, and are added exactly.

use super::points::Points;
use super::rigid::{Matrix, eliminated, rigid_motions};
use super::scale::Scale;
use crate::double_double::DoubleDouble;
use crate::plate::Plate;
use crate::rows::Springs;
use rayon::prelude::*;

/// Points that one thread takes at a time.
const CHUNK: usize = 8192;

/// What the three rigid motions w, w + x and w + y about the middle, over the plates' size, do of every plate that no dof
/// holds: n motions in all.
pub(super) struct Floating {
    size: f64,
    /// At every dof, those of the plate that it is of.
    pub(super) nodal: [Vec<f64>; 3],
    /// First motion of the plate that a node is of, and of each component of the mesh; nothing where a dof is held.
    of_node: Vec<Option<usize>>,
    of_component: Vec<Option<usize>>,
    count: usize,
    /// At every contact point and spring (.., n), one after the other.
    points: Vec<f64>,
    springs: Vec<f64>,
}

impl Floating {
    /// Nothing where a dof of every plate is held.
    pub(super) fn on(plate: &Plate, held: &[bool], scale: &Scale, points: &Points, springs: &Springs) -> Option<Self> {
        let components = plate.components();
        let mut of_component = vec![Some(0); components.count()];
        (0..held.len()).filter(|&dof| held[dof]).for_each(|dof| of_component[components.of(dof / 3)] = None);
        let mut count = 0;
        for first in of_component.iter_mut().flatten() {
            *first = count;
            count += 3;
        }
        if count == 0 {
            return None;
        }
        let of_node = (0..plate.node_count()).map(|node| of_component[components.of(node)]).collect();
        let nodal = rigid_motions(plate, scale);
        let mut floating =
            Self { size: scale.size, nodal, of_node, of_component, count, points: Vec::new(), springs: Vec::new() };
        floating.points = floating.arms(points.len(), |i| points.row(i));
        floating.springs = floating.arms(springs.rows.len(), |i| springs.rows.entries(plate, i));
        Some(floating)
    }

    /// How the motions move rows (.., n), one after the other.
    fn arms<R: Iterator<Item = (usize, f64)>>(&self, rows: usize, row: impl Fn(usize) -> R) -> Vec<f64> {
        let mut arms = vec![0.0; self.count * rows];
        for (i, arm) in arms.chunks_exact_mut(self.count).enumerate() {
            for (dof, coefficient) in row(i) {
                let Some(first) = self.of_node[dof / 3] else { continue };
                (0..3).for_each(|k| arm[first + k] += coefficient * self.nodal[k][dof]);
            }
        }
        arms
    }

    /// How the motions move a contact point (n,).
    pub(super) fn of_point(&self, i: usize) -> &[f64] {
        &self.points[self.count * i..self.count * (i + 1)]
    }

    /// How they move every spring (n,).
    pub(super) fn of_springs(&self) -> impl Iterator<Item = &[f64]> {
        self.springs.chunks_exact(self.count)
    }

    /// What springs and points hold the motions with (n, n), given the stiffness of both; that of open points is 0.
    pub(super) fn holding(&self, of_points: impl Fn(usize) -> f64 + Sync, of_springs: &[f64]) -> Matrix {
        let n = self.count;
        let zeros = || vec![vec![DoubleDouble::default(); n]; n];
        let holds = |held: &mut Matrix, arm: &[f64], stiffness: f64| {
            let root = stiffness.sqrt();
            for j in (0..n).filter(|&j| arm[j] != 0.0) {
                (0..=j).for_each(|k| held[j][k].add_product(root * arm[j], root * arm[k]));
            }
        };
        // Chunk by chunk, in their order, so that the sum is the same on any number of threads.
        let of_chunk = |(chunk, arms): (usize, &[f64])| {
            let mut held = zeros();
            let stiffness = arms.chunks_exact(n).enumerate().map(|(i, arm)| (arm, of_points(CHUNK * chunk + i)));
            stiffness.filter(|(_, k)| *k > 0.0).for_each(|(arm, k)| holds(&mut held, arm, k));
            held
        };
        let chunks: Vec<Matrix> = self.points.par_chunks(CHUNK * n).enumerate().map(of_chunk).collect();
        let mut matrix = zeros();
        self.of_springs().zip(of_springs).for_each(|(arm, &stiffness)| holds(&mut matrix, arm, stiffness));
        for held in chunks {
            (0..n).for_each(|j| (0..=j).for_each(|k| matrix[j][k] = matrix[j][k] + held[j][k]));
        }
        (0..n).for_each(|j| (0..j).for_each(|k| matrix[k][j] = matrix[j][k]));
        matrix
    }

    /// The softest that they hold a motion.
    pub(super) fn softest(&self, of_points: impl Fn(usize) -> f64 + Sync, of_springs: &[f64]) -> f64 {
        eliminated(self.holding(of_points, of_springs), vec![DoubleDouble::default(); self.count]).least
    }

    /// Resultants of nodal forces (n,).
    pub(super) fn resultants(&self, nodal: &[f64]) -> Vec<DoubleDouble> {
        let mut sums = vec![DoubleDouble::default(); self.count];
        for (dof, &force) in nodal.iter().enumerate() {
            let Some(first) = self.of_node[dof / 3] else { continue };
            (0..3).for_each(|k| sums[first + k].add_product(self.nodal[k][dof], force));
        }
        sums
    }

    /// The motion (deflection and slopes at the middle) of every component, of amounts of the motions.
    pub(super) fn motion(&self, amount: &[f64]) -> Vec<[f64; 3]> {
        let of = |first: usize| [amount[first], amount[first + 1] / self.size, amount[first + 2] / self.size];
        self.of_component.iter().map(|first| first.map_or([0.0; 3], of)).collect()
    }
}
