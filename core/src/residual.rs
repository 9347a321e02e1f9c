//! The refined residual: nodal forces out of balance, from displacements carried as double-doubles.
//!
//! Each element's rigid motion (its first node's deflection and rotations) is stripped in double-double before the
//! element matrix multiplies what is left, so that a thin plate's large rigid part costs no digits. Of elements so thin
//! that rounding of the matrix itself would resist bending, the strains are formed instead (`element::thin`).

use crate::double_double::DoubleDouble;
use crate::element::{DOFS, packed};
use crate::plate::Plate;
use crate::superposition::sum_in_order;
use crate::vectorized::vectorized;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A displacement with its low-order part.
#[derive(Clone, Debug, Default)]
pub struct Displacement {
    pub hi: Vec<f64>,
    pub lo: Vec<f64>,
}

impl Displacement {
    pub fn zeros(len: usize) -> Self {
        Self { hi: vec![0.0; len], lo: vec![0.0; len] }
    }

    pub fn at(&self, i: usize) -> DoubleDouble {
        DoubleDouble { hi: self.hi[i], lo: self.lo[i] }
    }

    pub fn add(&mut self, i: usize, increment: f64) {
        let mut sum = self.at(i);
        sum += increment;
        (self.hi[i], self.lo[i]) = (sum.hi, sum.lo);
    }

    /// Adds the rigid motion w + sx (x − cx) + sy (y − cy), which strains nothing, not even by rounding.
    pub fn add_rigid(&mut self, plate: &Plate, centre: [f64; 2], [w, sx, sy]: [f64; 3]) {
        let add = |to: &mut Self, i: usize, what: DoubleDouble| {
            let sum = to.at(i) + what;
            (to.hi[i], to.lo[i]) = (sum.hi, sum.lo);
        };
        for node in 0..plate.node_count() {
            let point = plate.point(node);
            let along = |slope: f64, k: usize| {
                DoubleDouble::from(slope).times_sum(DoubleDouble::from(point[k]) - DoubleDouble::from(centre[k]))
            };
            add(self, 3 * node, DoubleDouble::from(w) + along(sx, 0) + along(sy, 1));
            let slopes = match plate.frame(node) {
                Some([c, s]) => {
                    // Turned back by `slopes`, whose c² + s² is 1 to rounding only.
                    let square = DoubleDouble::from(c).times(c) + DoubleDouble::from(s).times(s);
                    let excess = (square - DoubleDouble::from(1.0)).value();
                    let turned = |a: f64, b: f64| {
                        let sum = DoubleDouble::from(c).times(a) + DoubleDouble::from(s).times(b);
                        sum - sum.times(excess)
                    };
                    [turned(sx, sy), turned(sy, -sx)]
                }
                None => [DoubleDouble::from(sx), DoubleDouble::from(sy)],
            };
            for (k, slope) in slopes.into_iter().enumerate() {
                add(self, 3 * node + 1 + k, slope);
            }
        }
    }

    /// θx, θy of a node, out of its frame.
    fn slopes(&self, plate: &Plate, node: usize) -> [DoubleDouble; 2] {
        let [p, q] = [self.at(3 * node + 1), self.at(3 * node + 2)];
        match plate.frame(node) {
            Some([c, s]) => [p.times(c) - q.times(s), p.times(s) + q.times(c)],
            None => [p, q],
        }
    }

    /// The element's displacements in x and y with its first node's rigid motion taken off.
    pub fn strained(&self, plate: &Plate, e: usize) -> [f64; DOFS] {
        self.stripped(plate, e).map(DoubleDouble::value)
    }

    /// As [`Displacement::strained`], with all digits.
    pub fn stripped(&self, plate: &Plate, e: usize) -> [DoubleDouble; DOFS] {
        vectorized(
            #[inline(always)]
            || self.stripped_fused(plate, e),
        )
    }

    #[inline(always)]
    fn stripped_fused(&self, plate: &Plate, e: usize) -> [DoubleDouble; DOFS] {
        let nodes = &plate.elements()[e];
        let first = plate.point(nodes[0]);
        let origin = self.at(3 * nodes[0]);
        let slope = self.slopes(plate, nodes[0]);
        let mut out = [DoubleDouble::default(); DOFS];
        for i in 1..8 {
            let point = plate.point(nodes[i]);
            // Where the nodes are to the last bit: a rigid motion must not strain by what their differences round off.
            let along =
                |k: usize| slope[k].times_sum_fused(DoubleDouble::from(point[k]) - DoubleDouble::from(first[k]));
            let rigid = along(0) + along(1);
            out[3 * i] = self.at(3 * nodes[i]) - origin - rigid;
            let here = self.slopes(plate, nodes[i]);
            out[3 * i + 1] = here[0] - slope[0];
            out[3 * i + 2] = here[1] - slope[1];
        }
        out
    }
}

/// Rows over single elements (elastic supports, contact points), in the nodes' frames.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    pub element: Vec<usize>,
    pub coefficient: Vec<[f64; DOFS]>,
    /// What rows, few of them, have in further elements: means over footprints. No dof stands twice in a row.
    pub further: BTreeMap<usize, Vec<(usize, [f64; DOFS])>>,
}

impl Rows {
    pub fn len(&self) -> usize {
        self.element.len()
    }

    pub fn is_empty(&self) -> bool {
        self.element.is_empty()
    }

    /// Puts a row of another table behind the others.
    pub fn push_from(&mut self, other: &Self, row: usize) {
        if let Some(further) = other.further.get(&row) {
            self.further.insert(self.len(), further.clone());
        }
        self.element.push(other.element[row]);
        self.coefficient.push(other.coefficient[row]);
    }

    /// The dof and coefficient pairs of one row, zeros left out.
    pub fn entries<'a>(&'a self, plate: &'a Plate, row: usize) -> impl Iterator<Item = (usize, f64)> + 'a {
        let of_element = |element: usize, coefficient: &'a [f64; DOFS]| {
            let nodes = &plate.elements()[element];
            let entry = move |(j, &c): (usize, &f64)| (3 * nodes[j / 3] + j % 3, c);
            coefficient.iter().enumerate().filter(|(_, c)| **c != 0.0).map(entry)
        };
        let further = self.further.get(&row).into_iter().flatten();
        of_element(self.element[row], &self.coefficient[row]).chain(further.flat_map(move |(e, c)| of_element(*e, c)))
    }

    /// Row times displacement, minus `offset`, in double-double.
    pub fn beyond(&self, plate: &Plate, row: usize, displacement: &Displacement, offset: f64) -> f64 {
        let mut sum = DoubleDouble::from(-offset);
        self.entries(plate, row).for_each(|(dof, c)| {
            sum.add_product(c, displacement.hi[dof]);
            sum.lo += c * displacement.lo[dof];
        });
        sum.value()
    }

    /// Row times a vector of doubles.
    pub fn dot(&self, plate: &Plate, row: usize, vector: &[f64]) -> f64 {
        self.entries(plate, row).map(|(dof, c)| c * vector[dof]).sum()
    }

    /// Adds `factor` times the row to a nodal vector.
    pub fn scatter(&self, plate: &Plate, row: usize, factor: f64, vector: &mut [f64]) {
        self.entries(plate, row).for_each(|(dof, c)| vector[dof] += factor * c);
    }
}

/// Linear springs: stiffness k_i on row i, whose base sits at `base_i`.
#[derive(Clone, Debug, Default)]
pub struct Springs {
    pub rows: Rows,
    pub stiffness: Vec<f64>,
    pub base: Vec<f64>,
}

impl Springs {
    /// Puts a spring on a row of some table behind the others.
    pub fn push(&mut self, rows: &Rows, row: usize, stiffness: f64, base: f64) {
        self.rows.push_from(rows, row);
        self.stiffness.push(stiffness);
        self.base.push(base);
    }

    /// Puts a spring on a single dof behind the others.
    pub fn push_at(&mut self, plate: &Plate, dof: usize, stiffness: f64) {
        let place = |nodes: &[usize; 8]| nodes.iter().position(|&node| node == dof / 3);
        let found = plate.elements().iter().enumerate().find_map(|(e, nodes)| Some((e, place(nodes)?)));
        let (element, local) = found.expect("every node has an element");
        let mut row = [0.0; DOFS];
        row[3 * local + dof % 3] = 1.0;
        self.rows.element.push(element);
        self.rows.coefficient.push(row);
        self.stiffness.push(stiffness);
        self.base.push(0.0);
    }

    /// Those over single elements, and those over several that have a stiffness.
    pub fn narrow_and_wide(&self) -> (Self, Self) {
        let (mut narrow, mut wide) = (Self::default(), Self::default());
        for (row, &stiffness) in self.stiffness.iter().enumerate() {
            match self.rows.further.contains_key(&row) {
                false => narrow.push(&self.rows, row, stiffness, self.base[row]),
                true if stiffness > 0.0 => wide.push(&self.rows, row, stiffness, self.base[row]),
                true => {}
            }
        }
        (narrow, wide)
    }
}

/// f − K u − Σ k r (r·u − base) at every dof, those held included (there it is minus the support's force).
pub fn residual(plate: &Plate, springs: &Springs, load: &[f64], displacement: &Displacement) -> Vec<f64> {
    let forces = each_moving_element(plate, displacement, |e| nodal_force(plate, e, displacement));
    let mut out = load.to_vec();
    scatter(plate, &forces, -1.0, &mut out);
    let stretch = |row: usize| springs.rows.beyond(plate, row, displacement, springs.base[row]);
    let stretches: Vec<f64> = (0..springs.rows.len()).into_par_iter().with_min_len(1024).map(stretch).collect();
    for (row, stretch) in stretches.into_iter().enumerate() {
        springs.rows.scatter(plate, row, -springs.stiffness[row] * stretch, &mut out);
    }
    out
}

/// What an element's nodes do to it, in their frames, at some displacements: K_e u without a resultant.
pub fn nodal_force(plate: &Plate, e: usize, displacement: &Displacement) -> [f64; DOFS] {
    let mut force = if plate.is_thin(e) {
        plate.strains(e, &displacement.stripped(plate, e)).nodal()
    } else {
        internal_force(plate.element_stiffness(e), &displacement.strained(plate, e))
    };
    plate.balance(e, &mut force);
    plate.into_frames(e, &mut force);
    force
}

/// uᵀKu of plate and springs for a vector of doubles, as a sum of squares that no rigid motion cancels in.
pub fn twice_the_energy(plate: &Plate, springs: &Springs, vector: &[f64]) -> f64 {
    const CHUNK: usize = 1024;
    let slopes = |node: usize| {
        let [p, q] = [vector[3 * node + 1], vector[3 * node + 2]];
        plate.frame(node).map_or([p, q], |[c, s]| [c * p - s * q, s * p + c * q])
    };
    // Thin elements alone ask for it.
    let exact = match plate.has_thin() {
        true => Displacement { hi: vector.to_vec(), lo: vec![0.0; vector.len()] },
        false => Displacement::default(),
    };
    let one = |e: usize| {
        if plate.is_thin(e) {
            return plate.strains(e, &exact.stripped(plate, e)).twice_the_energy();
        }
        let nodes = &plate.elements()[e];
        let at = plate.geometry(e).at;
        let (origin, slope) = (vector[3 * nodes[0]], slopes(nodes[0]));
        let mut strained = [0.0; DOFS];
        for i in 1..8 {
            let here = slopes(nodes[i]);
            strained[3 * i] = vector[3 * nodes[i]] - origin - slope[0] * at[i][0] - slope[1] * at[i][1];
            strained[3 * i + 1] = here[0] - slope[0];
            strained[3 * i + 2] = here[1] - slope[1];
        }
        let lower = plate.element_stiffness(e);
        let mut sum = 0.0;
        for i in 0..DOFS {
            let row = &lower[packed(i, 0)..packed(i, i)];
            let across: f64 = row.iter().zip(&strained).map(|(k, u)| k * u).sum();
            sum += strained[i] * (2.0 * across + lower[packed(i, i)] * strained[i]);
        }
        sum
    };
    let plate_alone = sum_in_order(plate.elements().len(), CHUNK, one);
    let spring = |row: usize| springs.stiffness[row] * springs.rows.dot(plate, row, vector).powi(2);
    plate_alone.max(0.0) + (0..springs.rows.len()).map(spring).sum::<f64>()
}

/// Σ|K_e||u_e| at every dof, of thin elements what their strains take: what rounding in [`residual`] is relative to.
pub fn internal_magnitudes(plate: &Plate, displacement: &Displacement) -> Vec<f64> {
    let parts = each_moving_element(plate, displacement, |e| {
        let stripped = displacement.stripped(plate, e);
        if plate.is_thin(e) {
            plate.strains(e, &stripped).magnitude()
        } else {
            magnitude(plate.element_stiffness(e), &stripped.map(|u| u.value().abs()))
        }
    });
    let mut sum = vec![0.0; plate.dof_count()];
    scatter(plate, &parts, 1.0, &mut sum);
    sum
}

/// Nodal forces of all elements, computed side by side; of none at rest, where there is nothing to sum.
fn each_moving_element(
    plate: &Plate,
    displacement: &Displacement,
    force: impl Fn(usize) -> [f64; DOFS] + Sync + Send,
) -> Vec<[f64; DOFS]> {
    const CHUNK: usize = 1024;
    let moving = displacement.hi.iter().any(|&u| u != 0.0);
    let count = if moving { plate.elements().len() } else { 0 };
    (0..count).into_par_iter().with_min_len(CHUNK).map(force).collect()
}

/// Adds `factor` times nodal forces, in the order of the elements.
fn scatter(plate: &Plate, forces: &[[f64; DOFS]], factor: f64, out: &mut [f64]) {
    for (nodes, force) in plate.elements().iter().zip(forces) {
        for (i, &node) in nodes.iter().enumerate() {
            for a in 0..3 {
                out[3 * node + a] += factor * force[3 * i + a];
            }
        }
    }
}

/// |K_e| times magnitudes of displacements.
fn magnitude(lower: &[f64], strained: &[f64; DOFS]) -> [f64; DOFS] {
    let mut part = [0.0; DOFS];
    for i in 0..DOFS {
        let mut across = 0.0;
        for j in 0..i {
            let k = lower[packed(i, 0) + j].abs();
            across += k * strained[j];
            part[j] += k * strained[i];
        }
        part[i] += across + lower[packed(i, i)].abs() * strained[i];
    }
    part
}

/// distance − row·u for rows over the dofs of elements, their coefficients (m + q, 24) one after the other, in
/// double-double; the last q are what rows `further` (q,), in ascending order, have in further elements.
pub fn openings(
    plate: &Plate,
    elements: &[usize],
    coefficients: &[f64],
    further: &[usize],
    distance: &[f64],
    displacement: &Displacement,
) -> Vec<f64> {
    let less = |mut sum: DoubleDouble, at: usize| {
        let nodes = &plate.elements()[elements[at]];
        let row = &coefficients[DOFS * at..DOFS * (at + 1)];
        for (j, &c) in row.iter().enumerate().filter(|(_, c)| **c != 0.0) {
            sum = sum - displacement.at(3 * nodes[j / 3] + j % 3).times(c);
        }
        sum
    };
    let m = distance.len();
    let one = |row: usize| {
        let first = further.partition_point(|&owner| owner < row);
        let own = further[first..].iter().take_while(|&&owner| owner == row).count();
        let start = less(DoubleDouble::from(distance[row]), row);
        (first..first + own).fold(start, |sum, at| less(sum, m + at)).value()
    };
    (0..m).into_par_iter().with_min_len(1024).map(one).collect()
}

/// K_e u, summed in double-double.
fn internal_force(lower: &[f64], displacement: &[f64; DOFS]) -> [f64; DOFS] {
    Arch::new().dispatch(InternalForce { lower, displacement })
}

struct InternalForce<'a> {
    lower: &'a [f64],
    displacement: &'a [f64; DOFS],
}

impl WithSimd for InternalForce<'_> {
    type Output = [f64; DOFS];

    /// Sums of all rows side by side, so that none waits for itself.
    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; DOFS] {
        let mut whole = [[0.0; DOFS]; DOFS];
        for i in 0..DOFS {
            for j in 0..=i {
                let value = self.lower[packed(i, j)];
                (whole[j][i], whole[i][j]) = (value, value);
            }
        }
        let (mut high, mut low) = ([0.0; DOFS], [0.0; DOFS]);
        let (high_parts, low_parts) = (S::as_mut_simd_f64s(&mut high).0, S::as_mut_simd_f64s(&mut low).0);
        for (column, u) in whole.iter().zip(self.displacement) {
            let u = simd.splat_f64s(*u);
            for ((h, l), k) in high_parts.iter_mut().zip(low_parts.iter_mut()).zip(S::as_simd_f64s(column).0) {
                let product = simd.mul_f64s(*k, u);
                let error = simd.mul_add_f64s(*k, u, simd.neg_f64s(product));
                let sum = simd.add_f64s(*h, product);
                let part = simd.sub_f64s(sum, *h);
                let carried = simd.add_f64s(simd.sub_f64s(*h, simd.sub_f64s(sum, part)), simd.sub_f64s(product, part));
                *h = sum;
                *l = simd.add_f64s(*l, simd.add_f64s(carried, error));
            }
        }
        std::array::from_fn(|i| high[i] + low[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::PACKED;

    #[test]
    fn a_rigid_motion_strains_nothing_whatever_its_size() {
        let points = [[0.1, 0.7], [1.3, 0.6], [1.7, 1.9], [0.3, 1.4], [0.7, 0.65], [1.5, 1.2], [1.0, 1.7], [0.2, 1.1]];
        let frames = (0..8).map(|i| [(0.3 * f64::from(i)).cos(), (0.3 * f64::from(i)).sin()]).collect();
        let material = crate::element::Material::isotropic(1e11, 0.3, 5.0 / 6.0);
        let kind = crate::element::Kind::Mitc9;
        let thickness = crate::element::Thickness::Constant(0.01);
        let plate =
            Plate::new(points.to_vec(), vec![[0, 1, 2, 3, 4, 5, 6, 7]], thickness, material, kind, Some(frames));
        let plate = plate.unwrap();
        let mut displacement = Displacement::zeros(24);
        displacement.add_rigid(&plate, [0.37, 1.1], [1e3 / 3.0, 70.0 / 3.0, -1e2 / 7.0]);
        let strained = displacement.strained(&plate, 0);
        assert!(strained.iter().all(|u| u.abs() < 1e-28), "{strained:?}");
        assert!(displacement.hi.iter().any(|u| u.abs() > 300.0));
    }

    #[test]
    fn sums_side_by_side_have_the_bits_of_sums_one_by_one() {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 33) as f64 / (1u64 << 30) as f64 - 1.0
        };
        let lower: Vec<f64> = (0..PACKED).map(|_| next()).collect();
        let displacement: [f64; DOFS] = std::array::from_fn(|_| next());
        let one_by_one: [f64; DOFS] = std::array::from_fn(|i| {
            let mut sum = DoubleDouble::default();
            (0..DOFS).for_each(|j| sum.add_product(lower[packed(i, j)], displacement[j]));
            sum.value()
        });
        assert_eq!(internal_force(&lower, &displacement), one_by_one);
    }

    #[test]
    fn forces_of_a_plate_have_no_resultant() {
        let points = [[0.0, 0.0], [5.0, 0.0], [5.0, 0.8], [0.0, 0.8], [2.5, 0.0], [5.0, 0.4], [2.5, 0.8], [0.0, 0.4]];
        let material = crate::element::Material::isotropic(3e10, 0.2, 5.0 / 6.0);
        for (kind, thickness) in [(crate::element::Kind::Mitc9, 0.07), (crate::element::Kind::Q8r, 0.003)] {
            let thickness = crate::element::Thickness::Constant(thickness);
            let plate = Plate::new(points.to_vec(), vec![[0, 1, 2, 3, 4, 5, 6, 7]], thickness, material, kind, None);
            let plate = plate.unwrap();
            // A curvature, whose internal forces are far less than the shears that cancel in them.
            let bent = |[x, y]: [f64; 2]| [0.5 * x * x + 0.2 * x * y, x + 0.2 * y, 0.2 * x];
            let hi = points.iter().flat_map(|&point| bent(point)).collect();
            let displacement = Displacement { hi, lo: vec![0.0; 24] };
            let forces = residual(&plate, &Springs::default(), &[0.0; 24], &displacement);
            let largest = forces.iter().fold(0.0, |size: f64, f| size.max(f.abs()));
            let sums = points.iter().zip(forces.chunks(3)).fold([0.0; 3], |sum, (point, f)| {
                [sum[0] + f[0], sum[1] + f[1] + point[0] * f[0], sum[2] + f[2] + point[1] * f[0]]
            });
            assert!(
                largest > 0.0 && sums.iter().all(|s| s.abs() <= 20.0 * f64::EPSILON * largest),
                "{sums:?} {largest}"
            );
        }
    }
}
