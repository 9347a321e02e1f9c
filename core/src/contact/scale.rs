//! Reference forces and lengths, computed from the plate's dimensions and rigidity. Comparisons relative to them do not
//! depend on units or numbering.

use crate::plate::Plate;

/// Reference sizes for all plates of a problem together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Centre of the bounding box of the plates (`centre`), and its longer side a (`size`).
    pub(super) centre: [f64; 2],
    pub(super) size: f64,
    /// Root-mean-square element size, rounded to a power of two. A nodal couple divided by this arm counts as a force.
    pub(super) arm: f64,
    /// D/a², force/length: of the order of the stiffness of the plate under a point load.
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

    /// Largest magnitude of nodal forces (3n,); couples are divided by the element size.
    pub(super) fn largest(&self, nodal: &[f64]) -> f64 {
        let of_couples = 1.0 / self.arm;
        let of_node = |f: &[f64]| f[0].abs().max(of_couples * f[1].abs().max(f[2].abs()));
        nodal.chunks_exact(3).fold(0.0, |most: f64, f| most.max(of_node(f)))
    }

    /// Sum of the magnitudes of nodal forces (3n,); couples are divided by the plate size.
    pub(super) fn sum(&self, nodal: &[f64]) -> f64 {
        nodal.chunks_exact(3).map(|f| f[0].abs() + (f[1].abs() + f[2].abs()) / self.size).sum()
    }

    /// Euclidean norm of nodal forces (3n,); couples are divided by the element size.
    pub(super) fn length(&self, nodal: &[f64]) -> f64 {
        let of_couples = 1.0 / self.arm;
        let square = |f: &[f64]| f[0] * f[0] + (of_couples * f[1]).powi(2) + (of_couples * f[2]).powi(2);
        nodal.chunks_exact(3).map(square).sum::<f64>().sqrt()
    }
}

/// Largest magnitude of `values`; 0 for an empty list.
pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Euclidean norm of a vector.
pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
