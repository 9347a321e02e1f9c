//! One-sided points in any number, as piecewise linear springs.

use crate::element::{DOFS, packed};
use crate::plate::Plate;
use crate::residual::Displacement;
use pulp::Arch;
use rayon::prelude::*;

/// One-sided points: force δ⟨s⟩₊ against their row, with s = w(point) − distance + series·multiplier.
///
/// A support that is stiffer than a limit acts through a spring that is as stiff as the limit and a multiplier: its law
/// stays exact, and the equations stay about as well conditioned as the plate's.
/// A point hangs on the eight deflections of one element, so that its row is eight numbers.
#[derive(Clone, Debug, Default)]
pub struct ActivePoints {
    pub element: Vec<usize>,
    pub value: Vec<[f64; 8]>,
    pub distance: Vec<f64>,
    /// Inverse stiffness of the support; 0 is rigid.
    pub compliance: Vec<f64>,
    /// The plate's own stiffness there, which its shear makes.
    pub shear: Vec<f64>,
}

/// What the equations see of the points.
#[derive(Clone, Debug, Default)]
pub struct Penalty {
    /// δ = 1/(compliance + series).
    pub stiffness: Vec<f64>,
    /// Compliance put in series with a support that is stiffer than the limit; 0 for the others.
    pub series: Vec<f64>,
}

impl ActivePoints {
    pub fn len(&self) -> usize {
        self.element.len()
    }

    pub fn is_empty(&self) -> bool {
        self.element.is_empty()
    }

    pub fn push(&mut self, plate: &Plate, element: usize, row: &[f64; DOFS], distance: f64, compliance: f64) {
        let lower = plate.element_stiffness(element);
        self.element.push(element);
        self.value.push(std::array::from_fn(|node| row[3 * node]));
        self.distance.push(distance);
        self.compliance.push(compliance);
        self.shear.push((0..8).fold(0.0, |most: f64, node| most.max(lower[packed(3 * node, 3 * node)])));
    }

    /// No support stiffer than `limit` times the plate's own stiffness in shear.
    pub fn penalized(&self, limit: f64) -> Penalty {
        let series = |i: usize| {
            let least = 1.0 / (limit * self.shear[i]);
            if self.compliance[i] < least { least } else { 0.0 }
        };
        let series: Vec<f64> = (0..self.len()).map(series).collect();
        let stiffness = series.iter().zip(&self.compliance).map(|(s, c)| 1.0 / (s + c)).collect();
        Penalty { stiffness, series }
    }

    /// w(point) − distance (m,), in double-double.
    pub fn overlap(&self, plate: &Plate, displacement: &Displacement) -> Vec<f64> {
        let mut out = vec![0.0; self.len()];
        out.par_chunks_mut(1024).enumerate().for_each(|(chunk, out)| {
            Arch::new().dispatch(
                #[inline(always)]
                || self.overlap_from(1024 * chunk, plate, displacement, out),
            );
        });
        out
    }

    #[inline(always)]
    fn overlap_from(&self, first: usize, plate: &Plate, displacement: &Displacement, out: &mut [f64]) {
        for (i, out) in (first..).zip(out) {
            let (mut high, mut low) = (-self.distance[i], 0.0);
            for (&node, &value) in plate.elements()[self.element[i]].iter().zip(&self.value[i]) {
                let (hi, lo) = (displacement.hi[3 * node], displacement.lo[3 * node]);
                let product = hi * value;
                let error = hi.mul_add(value, -product);
                let sum = high + product;
                let part = sum - high;
                low += (high - (sum - part)) + (product - part) + error + lo * value;
                high = sum;
            }
            *out = high + low;
        }
    }

    /// w(point) of a nodal vector (m,).
    pub fn change(&self, plate: &Plate, vector: &[f64]) -> Vec<f64> {
        (0..self.len()).into_par_iter().with_min_len(4096).map(|i| self.dot(plate, i, vector)).collect()
    }

    pub fn dot(&self, plate: &Plate, i: usize, vector: &[f64]) -> f64 {
        plate.elements()[self.element[i]].iter().zip(&self.value[i]).map(|(&n, v)| v * vector[3 * n]).sum()
    }

    pub fn scatter(&self, plate: &Plate, i: usize, factor: f64, vector: &mut [f64]) {
        for (&node, value) in plate.elements()[self.element[i]].iter().zip(&self.value[i]) {
            vector[3 * node] += factor * value;
        }
    }

    /// Σ k v vᵀ of every element's points over its eight deflections, as packed lower triangles; empty without points.
    pub fn stiffness_by_element(&self, plate: &Plate, stiffness: &[f64]) -> Vec<[f64; 36]> {
        if self.is_empty() {
            return Vec::new();
        }
        let mut out = vec![[0.0; 36]; plate.elements().len()];
        for i in 0..self.len() {
            let (sum, v) = (&mut out[self.element[i]], &self.value[i]);
            for a in 0..8 {
                for b in 0..=a {
                    sum[packed(a, b)] += stiffness[i] * v[a] * v[b];
                }
            }
        }
        out
    }
}
