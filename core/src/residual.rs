//! The residual f − Ku of nodal equilibrium for displacements u in double-double.
//!
//! The rigid motion of each element (deflection and slopes of its first node) is subtracted in double-double before the
//! product with the element matrix. So large rigid motions of thin plates cost no digits. In very thin elements, the
//! rounding of the matrix would act as a bending stiffness; the forces of these elements are computed from strains
//! (`element::thin`).

use crate::displacement::Displacement;
use crate::double_double::DoubleDouble;
use crate::element::{DOFS, packed};
use crate::plate::Plate;
use crate::rows::Springs;
use crate::superposition::sum_in_order;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// The residual f − Ku − Σ k g (g·u − base) at each dof (3n,). At a held dof the residual is minus the support force.
/// Entries of followers are added to those of their leaders.
pub fn residual(plate: &Plate, springs: &Springs, load: &[f64], displacement: &Displacement) -> Vec<f64> {
    let forces = each_moving_element(plate, displacement, |e| nodal_force(plate, e, displacement));
    let mut out = load.to_vec();
    scatter(plate, &forces, -1.0, &mut out);
    let stretch = |row: usize| springs.rows.beyond(plate, row, displacement, springs.base[row]);
    let stretches: Vec<f64> = (0..springs.rows.len()).into_par_iter().with_min_len(1024).map(stretch).collect();
    for (row, stretch) in stretches.into_iter().enumerate() {
        springs.rows.scatter(plate, row, -springs.stiffness[row] * stretch, &mut out);
    }
    plate.bodies().gather(&mut out);
    out
}

/// Nodal forces K_e u of element e in the frames of its nodes. Their resultant is zero.
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

/// uᵀKu of plate and springs for a vector u (3n,) of doubles. The rigid motion of each element is subtracted first, so
/// that large rigid motions cost no digits.
pub fn twice_the_energy(plate: &Plate, springs: &Springs, vector: &[f64]) -> f64 {
    const CHUNK: usize = 1024;
    let slopes = |node: usize| {
        let [p, q] = [vector[3 * node + 1], vector[3 * node + 2]];
        plate.frame(node).map_or([p, q], |[c, s]| [c * p - s * q, s * p + c * q])
    };
    // The strains of thin elements are computed from displacements in double-double.
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

/// Σ |K_e| |u_e| at each dof (3n,), with u_e the displacements of an element without its rigid motion. Thin elements
/// add the magnitudes of the terms of their forces from strains. ε times the sum bounds the rounding errors of
/// [`residual`].
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
    plate.bodies().gather_magnitudes(&mut sum);
    sum
}

/// `force(e)` of every element e, computed in parallel. The list is empty if all displacements are zero.
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

/// Adds `factor` times the nodal forces of all elements to `out` (3n,), in the order of the elements.
fn scatter(plate: &Plate, forces: &[[f64; DOFS]], factor: f64, out: &mut [f64]) {
    for (nodes, force) in plate.elements().iter().zip(forces) {
        for (i, &node) in nodes.iter().enumerate() {
            for a in 0..3 {
                out[3 * node + a] += factor * force[3 * i + a];
            }
        }
    }
}

/// |K_e| · `strained`, with the magnitudes `strained` of an element's displacements and K_e given by its packed lower
/// triangle.
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

/// The gaps distance − g·u (m,) of contact points, summed in double-double. `coefficients` (m + q, 24) has the m rows
/// g, each in one element, then q continuations of rows in further elements. `further` (q,), ascending, has the row
/// number of each continuation. `elements` (m + q,) has the elements of rows and continuations.
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

/// K_e u of an element, summed in double-double; `lower` is the packed lower triangle of K_e.
fn internal_force(lower: &[f64], displacement: &[f64; DOFS]) -> [f64; DOFS] {
    Arch::new().dispatch(InternalForce { lower, displacement })
}

struct InternalForce<'a> {
    lower: &'a [f64],
    displacement: &'a [f64; DOFS],
}

impl WithSimd for InternalForce<'_> {
    type Output = [f64; DOFS];

    /// Sums the terms of the product K_e u, with one row of K_e in each SIMD lane.
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
            // Displacements of pure bending: their internal forces are far smaller than the shear terms, which cancel.
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
