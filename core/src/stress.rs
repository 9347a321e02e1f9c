//! Moments and shears, computed from displacements.
//!
//! Moments and shears are sampled at the 2×2 Gauss points, where derivatives of quadratic elements converge one order
//! faster (Barlow 1976). The samples are extrapolated bilinearly to the nodes and averaged over the elements at a node
//! (Hinton & Campbell 1974). Across a jump of the section they are not averaged (`Plate::stress_nodes`). In triangles
//! moments are sampled at three points and extrapolated linearly; the shear of a triangle is its mean.

use crate::displacement::Displacement;
use crate::double_double::DoubleDouble;
use crate::element::quadrature::GAUSS_2;
use crate::element::{self, ALL_DOFS, DOFS, Kind, Section, StrainMatrix, mitc7, shape::NODES};
use crate::plate::Plate;
use crate::vectorized::vectorized;
use rayon::prelude::*;

/// [mx, my, mxy, qx, qy] at a point: moments M = −D(κ − κ⁰), positive if they sag, and shears Q = S(∇w − θ). In rigid
/// bodies all are zero.
pub type Stress = [f64; 5];

/// [`Stress`] at the four sample points of element e: the 2×2 Gauss points of a quadrilateral, ξ running fastest. A
/// triangle has three samples near its corners and one at the centroid.
///
/// `curvature` is the stress-free curvature κ⁰ = [κxx, κyy, κxy]; `couples` are the couples on the two centre
/// rotations.
pub fn at_gauss_points(
    plate: &Plate,
    e: usize,
    displacement: &Displacement,
    curvature: [f64; 3],
    couples: [f64; 2],
) -> [Stress; 4] {
    Samples::of(plate, e).stress(plate, e, displacement, curvature, couples)
}

/// Strain–displacement matrices and sections at N points of one element.
struct Samples<const N: usize = 4> {
    strain: [StrainMatrix; N],
    sections: [Section; N],
}

impl Samples {
    fn of(plate: &Plate, e: usize) -> Self {
        let mut samples = Self::from(plate, e, plate.kind.first_sample());
        if plate.is_triangle(e) {
            let mean = mitc7::mean_shear(&plate.geometry(e));
            samples.strain.iter_mut().for_each(|strain| strain[3..].copy_from_slice(&mean));
        }
        samples
    }
}

impl<const N: usize> Samples<N> {
    /// Samples at N consecutive points of [`Kind::points`] of element e, from number `first` on.
    fn from(plate: &Plate, e: usize, first: usize) -> Self {
        let geometry = plate.geometry(e);
        let points = &plate.kind.points_of(geometry.triangle)[first..];
        let points: [(f64, f64); N] = std::array::from_fn(|i| (points[i].0, points[i].1));
        let sections = plate.sections(e);
        Self {
            strain: element::strain_matrices(plate.kind, &geometry, points),
            sections: std::array::from_fn(|i| sections.at(first + i, plate.materials.at(e))),
        }
    }

    fn stress(
        &self,
        plate: &Plate,
        e: usize,
        displacement: &Displacement,
        curvature: [f64; 3],
        couples: [f64; 2],
    ) -> [Stress; N] {
        if plate.is_rigid(e) {
            return [[0.0; 5]; N];
        }
        let strains = vectorized(
            #[inline(always)]
            || self.strains(plate, e, &displacement.stripped(plate, e), couples),
        );
        let mut out = [[0.0; 5]; N];
        for ((stress, strain), section) in out.iter_mut().zip(strains).zip(&self.sections) {
            let elastic = [strain[0] - curvature[0], strain[1] - curvature[1], strain[2] - 2.0 * curvature[2]];
            let [mx, my, mxy] = section.moment(elastic);
            let [qx, qy] = section.shear_force([strain[3], strain[4]]);
            *stress = [-mx, -my, -mxy, qx, qy];
        }
        out
    }

    /// Strains [κxx, κyy, 2κxy, γx, γy] at each sample, from displacements `stripped` without rigid motion. Shear
    /// strains are computed in double-double, since they are differences of large terms in thin plates.
    #[inline(always)]
    fn strains(&self, plate: &Plate, e: usize, stripped: &[DoubleDouble; DOFS], couples: [f64; 2]) -> [[f64; 5]; N] {
        let dot = |row: &[f64], values: &[DoubleDouble], from: f64| {
            let mut sum = DoubleDouble::from(from);
            for (&c, value) in row.iter().zip(values) {
                sum.add_product_fused(c, value.hi);
                sum.lo += c * value.lo;
            }
            sum
        };
        let mut all = [DoubleDouble::default(); ALL_DOFS];
        all[..DOFS].copy_from_slice(stripped);
        let inner = plate.centre(e);
        for a in 0..2 {
            let own = inner.compliance[a][0] * couples[0] + inner.compliance[a][1] * couples[1];
            all[DOFS + a] = -dot(&inner.coupling[a], stripped, -own);
        }
        let plain = all.map(DoubleDouble::value);
        let strain = |row: &[f64; ALL_DOFS], is_shear: bool| match is_shear {
            true => dot(row, &all, 0.0).value(),
            false => row.iter().zip(&plain).map(|(b, u)| b * u).sum(),
        };
        std::array::from_fn(|i| std::array::from_fn(|k| strain(&self.strain[i][k], k >= 3)))
    }
}

/// [`Stress`] of element e at the integration points of its stiffness: nine points, or four for q8r.
pub fn at_integration_points(plate: &Plate, e: usize, of: &Strained) -> Vec<Stress> {
    let couples = [of.couples[2 * e], of.couples[2 * e + 1]];
    match plate.kind {
        Kind::Mitc9 => Samples::<9>::from(plate, e, 0).stress(plate, e, of.displacement, of.curvature, couples).into(),
        Kind::Q8r => Samples::<4>::from(plate, e, 0).stress(plate, e, of.displacement, of.curvature, couples).into(),
    }
}

/// Strain–displacement matrices of element e at its integration points, over its nodal dofs in nodal frames. The centre
/// rotations are condensed.
pub fn strain_rows(plate: &Plate, e: usize) -> Vec<[[f64; DOFS]; 5]> {
    let condensed = |strain: &StrainMatrix| {
        strain.map(|row| {
            let coupling = &plate.centre(e).coupling;
            let mut out = std::array::from_fn(|j| row[j] - coupling[0][j] * row[DOFS] - coupling[1][j] * row[DOFS + 1]);
            plate.into_frames(e, &mut out);
            out
        })
    };
    match plate.kind {
        Kind::Mitc9 => Samples::<9>::from(plate, e, 0).strain.iter().map(condensed).collect(),
        Kind::Q8r => Samples::<4>::from(plate, e, 0).strain.iter().map(condensed).collect(),
    }
}

/// Displacements u, stress-free curvature κ⁰ = [κxx, κyy, κxy], and couples on the centre rotations, two for each
/// element.
pub struct Strained<'a> {
    pub displacement: &'a Displacement,
    pub curvature: [f64; 3],
    pub couples: &'a [f64],
}

/// Mean [`Stress`] at each stress node, for each of several displacements. Strain matrices are computed once for all.
pub fn smoothed_together(plate: &Plate, all: &[Strained]) -> Vec<Vec<Stress>> {
    let sampled: Vec<Vec<[Stress; 4]>> = (0..plate.elements().len())
        .into_par_iter()
        .with_min_len(64)
        .map(|e| {
            let samples = Samples::of(plate, e);
            let of = |s: &Strained| {
                samples.stress(plate, e, s.displacement, s.curvature, [s.couples[2 * e], s.couples[2 * e + 1]])
            };
            all.iter().map(of).collect()
        })
        .collect();
    (0..all.len()).into_par_iter().map(|k| carried_to_nodes(plate, |e| sampled[e][k])).collect()
}

/// Mean [`Stress`] at each stress node, and at the four sample points of each element.
pub fn smoothed(
    plate: &Plate,
    displacement: &Displacement,
    curvature: [f64; 3],
    couples: &[f64],
) -> (Vec<Stress>, Vec<[Stress; 4]>) {
    let sampled: Vec<[Stress; 4]> = (0..plate.elements().len())
        .into_par_iter()
        .with_min_len(256)
        .map(|e| at_gauss_points(plate, e, displacement, curvature, [couples[2 * e], couples[2 * e + 1]]))
        .collect();
    let nodal = carried_to_nodes(plate, |e| sampled[e]);
    (nodal, sampled)
}

/// Mean stress at each stress node: samples of an element are extrapolated to its nodes and averaged over the elements
/// at a node.
fn carried_to_nodes(plate: &Plate, sampled: impl Fn(usize) -> [Stress; 4]) -> Vec<Stress> {
    let of_squares: [[f64; 4]; 8] = std::array::from_fn(|i| bilinear(NODES[i][0], NODES[i][1]));
    let (elements, count) = plate.stress_nodes();
    let mut nodal = vec![[0.0; 5]; count];
    let mut meeting = vec![0u32; count];
    for (e, nodes) in elements.iter().enumerate() {
        let samples = sampled(e);
        let weights = if plate.is_triangle(e) { &ON_TRIANGLES } else { &of_squares };
        for (&node, weights) in nodes.iter().zip(weights).filter(|(_, weights)| **weights != [0.0; 4]) {
            meeting[node] += 1;
            for (sample, weight) in samples.iter().zip(weights) {
                for a in 0..5 {
                    nodal[node][a] += weight * sample[a];
                }
            }
        }
    }
    for (stress, &count) in nodal.iter_mut().zip(&meeting) {
        for value in stress {
            *value /= f64::from(count.max(1));
        }
    }
    nodal
}

/// Weights of the four samples of a triangle in the linear extrapolation to its eight node positions. The fourth sample
/// has the weight 0. The rows of positions 3 and 6, which repeat the third corner, are zero.
const ON_TRIANGLES: [[f64; 4]; 8] = {
    let (own, other, beside, across) = (5.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0);
    [
        [own, other, other, 0.0],
        [other, own, other, 0.0],
        [other, other, own, 0.0],
        [0.0; 4],
        [beside, beside, across, 0.0],
        [across, beside, beside, 0.0],
        [0.0; 4],
        [beside, across, beside, 0.0],
    ]
};

/// Values at (ξ, η) of the four bilinear functions, each of which is 1 at one of the 2×2 Gauss points and 0 at the
/// others.
fn bilinear(xi: f64, eta: f64) -> [f64; 4] {
    let g = GAUSS_2[1].0;
    let [x, y] = [xi / g, eta / g];
    [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]].map(|[a, b]| 0.25 * (1.0 + a * x) * (1.0 + b * y))
}
