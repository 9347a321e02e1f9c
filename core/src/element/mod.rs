//! Plate elements: the 8-node quadrilateral with 24 dofs, node by node (deflection w, slopes θx, θy), and the 6-node
//! triangle, stored as a quadrilateral with a collapsed side (`mitc7`).
//!
//! An element may have two rotations at a centre node inside; they are condensed and are no dofs of the mesh. Strains
//! are [κxx, κyy, 2κxy, γx, γy] with κ = sym ∇θ and γ = ∇w − θ.

pub mod geometry;
pub mod kind;
pub mod matrices;
pub mod mitc7;
pub mod mitc9;
pub mod number;
pub mod q8r;
pub mod quadrature;
pub mod section;
pub mod shape;
pub mod thin;

pub use geometry::{Geometry, Jacobian};
pub use kind::Kind;
pub use matrices::{ALL_DOFS, Centre, DOFS, PACKED, Stiffness, StrainMatrix, packed};
use mitc9::Apart;
use number::Lanes;
use pulp::{Arch, Simd, WithSimd};
pub use section::{Layered, Material, Materials, Section, Sections, Thickness};
use shape::serendipity;

/// Largest number of f64 values that a vector register holds.
const MOST_LANES: usize = 8;

/// Geometry, material and sections of an element.
pub type Made<'a> = (Geometry, &'a Material, Sections<'a>);

/// Computes the stiffness of each element and calls `put(index of the element, stiffness)`. Elements of kind mitc9 are
/// computed several at a time, one in each SIMD lane.
pub fn stiffness(kind: Kind, elements: &[Made], mut put: impl FnMut(usize, &Stiffness)) {
    if kind == Kind::Q8r {
        for (at, (geometry, material, sections)) in elements.iter().enumerate() {
            put(at, &q8r::stiffness(geometry, std::array::from_fn(|i| sections.at(i, material))));
        }
        return;
    }
    for triangle in [false, true] {
        let which: Vec<usize> = (0..elements.len()).filter(|&at| elements[at].0.triangle == triangle).collect();
        Arch::new().dispatch(SideBySide { triangle, which: &which, elements, put: &mut put });
    }
}

/// Computes the stiffness of the elements with the indices `which`, several at a time in SIMD lanes. All of them are
/// triangles, or all are quadrilaterals.
struct SideBySide<'a, P> {
    triangle: bool,
    which: &'a [usize],
    elements: &'a [Made<'a>],
    put: &'a mut P,
}

impl<P: FnMut(usize, &Stiffness)> WithSimd for SideBySide<'_, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { triangle, which, elements, put } = self;
        for which in which.chunks(S::F64_LANES) {
            // SIMD lanes without an element repeat the last element.
            let of = |lane: usize| &elements[which[lane.min(which.len() - 1)]];
            let zero = Lanes::of(simd, |_| 0.0);
            let mut geometry = Geometry { at: [[zero; 2]; 8], triangle };
            for i in 0..8 {
                for a in 0..2 {
                    geometry.at[i][a] = Lanes::of(simd, |lane| of(lane).0.at[i][a]);
                }
            }
            let section = |point: usize| {
                let mut each = [Section { bending: [[0.0; 3]; 3], shear: [[0.0; 2]; 2] }; MOST_LANES];
                for (lane, each) in each[..S::F64_LANES].iter_mut().enumerate() {
                    let (_, material, sections) = of(lane);
                    *each = sections.at(point, material);
                }
                let mut section = Section { bending: [[zero; 3]; 3], shear: [[zero; 2]; 2] };
                for a in 0..3 {
                    for b in 0..3 {
                        section.bending[a][b] = Lanes::of(simd, |lane| each[lane].bending[a][b]);
                    }
                }
                for a in 0..2 {
                    for b in 0..2 {
                        section.shear[a][b] = Lanes::of(simd, |lane| each[lane].shear[a][b]);
                    }
                }
                section
            };
            let all = mitc9::stiffness(&if triangle {
                mitc7::apart(&geometry, section)
            } else {
                Apart::of(&geometry, section)
            });
            let mut one = Stiffness { packed: [0.0; PACKED], centre: Centre::default() };
            for (lane, &at) in which.iter().enumerate() {
                for (to, value) in one.packed.iter_mut().zip(&all.packed) {
                    *to = value.lane(lane);
                }
                for a in 0..2 {
                    for (to, value) in one.centre.coupling[a].iter_mut().zip(&all.centre.coupling[a]) {
                        *to = value.lane(lane);
                    }
                    for b in 0..2 {
                        one.centre.compliance[a][b] = all.centre.compliance[a][b].lane(lane);
                    }
                }
                put(at, &one);
            }
        }
    }
}

/// Strain–displacement matrices of an element at the reference points `at`.
pub fn strain_matrices<const N: usize>(kind: Kind, geometry: &Geometry, at: [(f64, f64); N]) -> [StrainMatrix; N] {
    match kind {
        Kind::Mitc9 if geometry.triangle => mitc7::strain_matrices(geometry, at),
        Kind::Mitc9 => mitc9::strain_matrices(geometry, at),
        Kind::Q8r => at.map(|(xi, eta)| q8r::strain_matrix(geometry, xi, eta)),
    }
}

/// Values of the nine rotation functions at a reference point. The ninth value is zero if the element has no centre
/// node.
pub fn rotation_functions(kind: Kind, triangle: bool, xi: f64, eta: f64) -> [f64; 9] {
    match kind {
        Kind::Mitc9 if triangle => shape::bubbled(xi, eta).value,
        Kind::Mitc9 => shape::lagrange(xi, eta).value,
        Kind::Q8r => {
            let mut all = [0.0; 9];
            all[..8].copy_from_slice(&serendipity(xi, eta).value);
            all
        }
    }
}

/// Work-equivalent forces ∫ Bᵀ D κ⁰ of the stress-free curvature κ⁰ = `[κxx, κyy, κxy]`, over all dofs of an element
/// ([`ALL_DOFS`]).
pub fn curvature_load(
    kind: Kind,
    geometry: &Geometry,
    material: &Material,
    sections: Sections,
    curvature: [f64; 3],
) -> [f64; ALL_DOFS] {
    match kind {
        Kind::Mitc9 => curvature_load_by::<9>(kind, geometry, material, sections, curvature),
        Kind::Q8r => curvature_load_by::<4>(kind, geometry, material, sections, curvature),
    }
}

fn curvature_load_by<const M: usize>(
    kind: Kind,
    geometry: &Geometry,
    material: &Material,
    sections: Sections,
    curvature: [f64; 3],
) -> [f64; ALL_DOFS] {
    let mut load = [0.0; ALL_DOFS];
    let rule: [(f64, f64, f64); M] = std::array::from_fn(|i| kind.points_of(geometry.triangle)[i]);
    let strains = strain_matrices(kind, geometry, rule.map(|(xi, eta, _)| (xi, eta)));
    for (point, ((xi, eta, weight), strain)) in rule.into_iter().zip(strains).enumerate() {
        let determinant = geometry.jacobian(xi, eta).determinant;
        let moment = sections.at(point, material).moment([curvature[0], curvature[1], 2.0 * curvature[2]]);
        for (i, f) in load.iter_mut().enumerate() {
            let work: f64 = (0..3).map(|a| strain[a][i] * moment[a]).sum();
            *f += weight * determinant * work;
        }
    }
    load
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [[f64; 2]; 8] =
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5]];
    const COLLAPSED: [[f64; 2]; 8] =
        [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 1.0], [0.0, 0.5]];

    #[test]
    fn an_element_has_the_bits_that_it_has_alone() {
        let materials = [0.2, 0.3].map(|poisson| Material::isotropic(3.0, poisson, 5.0 / 6.0));
        let varying: [f64; 13] = std::array::from_fn(|k| 0.1 + 0.01 * k as f64);
        for kind in [Kind::Mitc9, Kind::Q8r] {
            let elements: Vec<Made> = (0..11)
                .map(|e| {
                    let triangle = kind == Kind::Mitc9 && e % 3 == 1;
                    let moved = |[x, y]: [f64; 2]| [x + 0.03 * e as f64 * y, y + 0.02 * e as f64 * x * y];
                    let at = if triangle { COLLAPSED } else { CORNERS }.map(moved);
                    let sections = if e % 2 == 0 { Sections::Constant(0.2) } else { Sections::Varying(&varying) };
                    (Geometry { at, triangle }, &materials[usize::from(e > 4)], sections)
                })
                .collect();
            let mut met = vec![0; elements.len()];
            stiffness(kind, &elements, |at, result| {
                met[at] += 1;
                let (geometry, material, sections) = &elements[at];
                let section = |point| sections.at(point, material);
                let alone = match kind {
                    Kind::Q8r => q8r::stiffness(geometry, std::array::from_fn(section)),
                    Kind::Mitc9 if geometry.triangle => mitc9::stiffness(&mitc7::apart(geometry, section)),
                    Kind::Mitc9 => mitc9::stiffness(&Apart::of(geometry, section)),
                };
                assert_eq!(alone.packed, result.packed);
                assert_eq!(alone.centre.coupling, result.centre.coupling);
                assert_eq!(alone.centre.compliance, result.centre.compliance);
            });
            assert_eq!(met, vec![1; elements.len()]);
        }
    }
}
