//! What forces and lengths are compared with: the plate's own sizes, whatever units it is given in and wherever its
//! numbering begins.

use crate::plate::Plate;

/// A plate's sizes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Middle and size of the box around the plate.
    pub(super) centre: [f64; 2],
    pub(super) size: f64,
    /// Size of an element, in the mean of squares, as a power of two: the arm at which a nodal couple counts as a force.
    pub(super) arm: f64,
    /// D/a², about the plate's own stiffness under a point load.
    pub(super) stiffness: f64,
}

impl Scale {
    pub(super) fn of(plate: &Plate) -> Self {
        let over = |k: usize, choose: fn(f64, f64) -> f64, start: f64| {
            (0..plate.node_count()).map(|node| plate.point(node)[k]).fold(start, choose)
        };
        let least = [over(0, f64::min, f64::INFINITY), over(1, f64::min, f64::INFINITY)];
        let most = [over(0, f64::max, f64::NEG_INFINITY), over(1, f64::max, f64::NEG_INFINITY)];
        let centre = [0.5 * (least[0] + most[0]), 0.5 * (least[1] + most[1])];
        let size = f64::max(most[0] - least[0], most[1] - least[1]);
        let elements = plate.elements().len();
        let squares: f64 = (0..elements).map(|e| plate.geometry(e).size().powi(2)).sum();
        let arm = (0.5 * (squares / elements as f64).log2()).round().exp2();
        let rigidity = plate.materials.young() * plate.thickness.most().powi(3) / 12.0;
        Self { centre, size, arm, stiffness: rigidity / (size * size) }
    }

    /// Largest of nodal forces; a couple counts by the force that it is at the arm.
    pub(super) fn largest(&self, nodal: &[f64]) -> f64 {
        let of_couples = 1.0 / self.arm;
        let of_node = |f: &[f64]| f[0].abs().max(of_couples * f[1].abs().max(f[2].abs()));
        nodal.chunks_exact(3).fold(0.0, |most: f64, f| most.max(of_node(f)))
    }

    /// Sum of nodal forces, couples over the plate's size.
    pub(super) fn sum(&self, nodal: &[f64]) -> f64 {
        nodal.chunks_exact(3).map(|f| f[0].abs() + (f[1].abs() + f[2].abs()) / self.size).sum()
    }

    /// Length of nodal forces, couples as for the largest.
    pub(super) fn length(&self, nodal: &[f64]) -> f64 {
        let of_couples = 1.0 / self.arm;
        let square = |f: &[f64]| f[0] * f[0] + (of_couples * f[1]).powi(2) + (of_couples * f[2]).powi(2);
        nodal.chunks_exact(3).map(square).sum::<f64>().sqrt()
    }
}

/// The largest magnitude.
pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// The length of a vector.
pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
