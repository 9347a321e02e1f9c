//! Contact points as rows, and one-sided ones in any number as piecewise linear springs.

use crate::displacement::Displacement;
use crate::element::{DOFS, packed};
use crate::plate::Plate;
use crate::rows::{Rows, Springs};
use crate::vectorized::vectorized;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Contact points: row_i·u + gap_i − compliance_i·reaction_i = distance_i.
#[derive(Clone, Debug, Default)]
pub struct Constraints {
    pub rows: Rows,
    /// Free travel before the point acts.
    pub distance: Vec<f64>,
    /// Inverse stiffness of the support; 0 is rigid.
    pub compliance: Vec<f64>,
    /// An equation rather than an inequality.
    pub two_sided: Vec<bool>,
    /// Stiffness that the factor carries at the point so that K̃ is regular; 0 for most.
    pub regularization: Vec<f64>,
    /// Rigid motions over all dofs that springs, held dofs and two-sided points leave free.
    pub free_motions: Vec<Vec<f64>>,
}

/// One-sided points: force δ⟨s⟩₊ against their row, with s = w(point) − distance + series·multiplier.
///
/// A support that is stiffer than a limit acts through a spring that is as stiff as the limit and a multiplier: its law
/// stays exact, and the equations stay about as well conditioned as the plate's.
/// A point hangs on the eight deflections of one element, so that its row is eight numbers; a footprint's on those of some.
#[derive(Clone, Debug, Default)]
pub struct ActivePoints {
    pub element: Vec<usize>,
    pub value: Vec<[f64; 8]>,
    pub distance: Vec<f64>,
    /// Inverse stiffness of the support; 0 is rigid.
    pub compliance: Vec<f64>,
    /// The plate's own stiffness there, which its shear makes.
    pub shear: Vec<f64>,
    /// What footprints, few of the points, have in further elements.
    pub further: BTreeMap<usize, Vec<(usize, [f64; 8])>>,
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

    pub fn push(&mut self, plate: &Plate, rows: &Rows, row: usize, distance: f64, compliance: f64) {
        let values = |row: &[f64; DOFS]| std::array::from_fn(|node| row[3 * node]);
        let lower = plate.element_stiffness(rows.element[row]);
        if let Some(further) = rows.further.get(&row) {
            self.further.insert(self.len(), further.iter().map(|(e, row)| (*e, values(row))).collect());
        }
        self.element.push(rows.element[row]);
        self.value.push(values(&rows.coefficient[row]));
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
            vectorized(
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
            let mut add = |element: usize, values: &[f64; 8]| {
                for (&node, &value) in plate.elements()[element].iter().zip(values) {
                    let (hi, lo) = (displacement.hi[3 * node], displacement.lo[3 * node]);
                    let product = hi * value;
                    let error = hi.mul_add(value, -product);
                    let sum = high + product;
                    let part = sum - high;
                    low += (high - (sum - part)) + (product - part) + error + lo * value;
                    high = sum;
                }
            };
            add(self.element[i], &self.value[i]);
            self.elsewhere(i).for_each(|(element, values)| add(*element, values));
            *out = high + low;
        }
    }

    /// What a point has in further elements.
    fn elsewhere(&self, i: usize) -> impl Iterator<Item = &(usize, [f64; 8])> {
        self.further.get(&i).into_iter().flatten()
    }

    fn entries<'a>(&'a self, plate: &'a Plate, i: usize) -> impl Iterator<Item = (usize, f64)> + 'a {
        let of_element = |e: usize, values: &'a [f64; 8]| {
            plate.elements()[e].iter().zip(values).map(|(&node, &value)| (node, value))
        };
        let further = self.elsewhere(i).flat_map(move |(e, values)| of_element(*e, values));
        of_element(self.element[i], &self.value[i]).chain(further)
    }

    /// w(point) of a nodal vector (m,).
    pub fn change(&self, plate: &Plate, vector: &[f64]) -> Vec<f64> {
        (0..self.len()).into_par_iter().with_min_len(4096).map(|i| self.dot(plate, i, vector)).collect()
    }

    pub fn dot(&self, plate: &Plate, i: usize, vector: &[f64]) -> f64 {
        self.entries(plate, i).map(|(n, v)| v * vector[3 * n]).sum()
    }

    pub fn scatter(&self, plate: &Plate, i: usize, factor: f64, vector: &mut [f64]) {
        for (node, value) in self.entries(plate, i) {
            vector[3 * node] += factor * value;
        }
    }

    /// Adds the row of a point to others, over all dofs of its elements.
    pub fn push_row(&self, i: usize, rows: &mut Rows) {
        let over_dofs = |values: &[f64; 8]| std::array::from_fn(|j| if j % 3 == 0 { values[j / 3] } else { 0.0 });
        if let Some(further) = self.further.get(&i) {
            rows.further.insert(rows.len(), further.iter().map(|(e, values)| (*e, over_dofs(values))).collect());
        }
        rows.element.push(self.element[i]);
        rows.coefficient.push(over_dofs(&self.value[i]));
    }

    /// Σ k v vᵀ of every element's points over its eight deflections, as packed lower triangles; empty without points.
    /// Footprints are left out: see [`ActivePoints::add_footprint_springs`].
    pub fn stiffness_by_element(&self, plate: &Plate, stiffness: &[f64]) -> Vec<[f64; 36]> {
        if self.is_empty() {
            return Vec::new();
        }
        let mut out = vec![[0.0; 36]; plate.elements().len()];
        for i in (0..self.len()).filter(|i| !self.further.contains_key(i)) {
            let (sum, v) = (&mut out[self.element[i]], &self.value[i]);
            for a in 0..8 {
                for b in 0..=a {
                    sum[packed(a, b)] += stiffness[i] * v[a] * v[b];
                }
            }
        }
        out
    }

    /// Adds the springs of points that hang on several elements, those of no stiffness too: K keeps its pattern.
    pub fn add_footprint_springs(&self, stiffness: &[f64], springs: &mut Springs) {
        let mut rows = Rows::default();
        for (at, &i) in self.further.keys().enumerate() {
            self.push_row(i, &mut rows);
            springs.push(&rows, at, stiffness[i], 0.0);
        }
    }
}
