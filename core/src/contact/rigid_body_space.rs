//! Rigid motions R of plates without held dofs, solved for as separate unknowns (coarse space of FETI, Farhat & Roux
//! 1991).
//!
//! If springs are soft relative to the plate, elimination of K gives only a few digits of the rigid motions. Adding
//! these motions in double precision would strain the plate by rounding. Therefore they are computed from the
//! resultants on each plate, and added in double-double.

use super::points::Points;
use super::rigid::{Matrix, eliminated, rigid_motions};
use super::scale::Scale;
use crate::double_double::DoubleDouble;
use crate::plate::Plate;
use crate::rows::Springs;
use rayon::prelude::*;

/// Number of contact points that one parallel task handles.
const CHUNK: usize = 8192;

/// The rigid motions R of all plates without a held dof: three for each plate, n in total. Lengths in R are divided by
/// the size of the plate.
pub(super) struct RigidBodySpace {
    size: f64,
    /// Three nodal vectors: at each dof, the values of the three rigid motions of the plate that has the dof.
    pub(super) nodal: [Vec<f64>; 3],
    /// For each node, and for each connected component of the mesh, the index in R of the first motion of its plate.
    /// `None` if the plate has a held dof.
    of_node: Vec<Option<usize>>,
    of_component: Vec<Option<usize>>,
    count: usize,
    /// Displacements GR (m, k) of m contact points in the k rigid motions R, stored row by row; `springs` are those of
    /// the springs.
    points: Vec<f64>,
    springs: Vec<f64>,
}

impl RigidBodySpace {
    /// Makes the space of rigid motions; `None` if every plate has a held dof.
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
        let mut rigid_space =
            Self { size: scale.size, nodal, of_node, of_component, count, points: Vec::new(), springs: Vec::new() };
        rigid_space.points = rigid_space.arms(points.len(), |i| points.row(i));
        rigid_space.springs = rigid_space.arms(springs.rows.len(), |i| springs.rows.entries(plate, i));
        Some(rigid_space)
    }

    /// Product (rows, n) of sparse rows with the rigid motions R, stored row by row.
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

    /// Row i (n,) of GR for the contact points: displacement of point i in each of the n rigid motions R.
    pub(super) fn of_point(&self, i: usize) -> &[f64] {
        &self.points[self.count * i..self.count * (i + 1)]
    }

    /// Rows of GR for the springs, each (n,): displacement of a spring in each of the n rigid motions.
    pub(super) fn of_springs(&self) -> impl Iterator<Item = &[f64]> {
        self.springs.chunks_exact(self.count)
    }

    /// Projected stiffness RᵀGᵀkGR (n, n). k is `of_points(i)` for contact point i (0 if the point is open) and
    /// `of_springs` for the springs.
    pub(super) fn projected_stiffness(&self, of_points: impl Fn(usize) -> f64 + Sync, of_springs: &[f64]) -> Matrix {
        let n = self.count;
        let zeros = || vec![vec![DoubleDouble::default(); n]; n];
        let holds = |held: &mut Matrix, arm: &[f64], stiffness: f64| {
            let root = stiffness.sqrt();
            for j in (0..n).filter(|&j| arm[j] != 0.0) {
                (0..=j).for_each(|k| held[j][k].add_product(root * arm[j], root * arm[k]));
            }
        };
        // Chunks are added in order, so that the sum does not depend on the number of threads.
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

    /// Smallest nonzero pivot of the projected stiffness: the stiffness against the softest rigid motion.
    pub(super) fn softest(&self, of_points: impl Fn(usize) -> f64 + Sync, of_springs: &[f64]) -> f64 {
        eliminated(self.projected_stiffness(of_points, of_springs), vec![DoubleDouble::default(); self.count]).least
    }

    /// Resultants Rᵀf (n,) of nodal forces f (3n,) on the plates.
    pub(super) fn resultants(&self, nodal: &[f64]) -> Vec<DoubleDouble> {
        let mut sums = vec![DoubleDouble::default(); self.count];
        for (dof, &force) in nodal.iter().enumerate() {
            let Some(first) = self.of_node[dof / 3] else { continue };
            (0..3).for_each(|k| sums[first + k].add_product(self.nodal[k][dof], force));
        }
        sums
    }

    /// The rigid motion (w, θx, θy at the centre) of each connected component of the mesh, from the amounts (n,) of the
    /// motions R.
    pub(super) fn motion(&self, amount: &[f64]) -> Vec<[f64; 3]> {
        let of = |first: usize| [amount[first], amount[first + 1] / self.size, amount[first + 2] / self.size];
        self.of_component.iter().map(|first| first.map_or([0.0; 3], of)).collect()
    }
}
