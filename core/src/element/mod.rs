//! Plate elements on the 8-node quadrilateral: 24 dofs, node by node (deflection w, slopes θx, θy); and on the 6-node
//! triangle, written as a quadrilateral with a collapsed side (`mitc7`).
//!
//! An element may carry the rotations of a centre node inside itself; they are condensed, so that the mesh never
//! sees them. Strains come as [κxx, κyy, 2κxy, γx, γy] with κ = sym ∇θ and γ = ∇w − θ.

pub mod geometry;
pub mod kind;
pub mod matrices;
pub mod mitc7;
pub mod mitc9;
pub mod q8r;
pub mod quadrature;
pub mod section;
pub mod shape;
pub mod thin;

pub use geometry::{Geometry, Jacobian};
pub use kind::Kind;
pub use matrices::{ALL_DOFS, Centre, DOFS, PACKED, Stiffness, StrainMatrix, packed};
pub use section::{Layered, Material, Materials, Section, Sections, Thickness};
use shape::serendipity;

/// Stiffness of one element.
pub fn stiffness(kind: Kind, geometry: &Geometry, material: &Material, sections: Sections) -> Stiffness {
    match kind {
        Kind::Mitc9 if geometry.triangle => mitc7::stiffness(geometry, material, sections),
        Kind::Mitc9 => mitc9::stiffness(geometry, material, sections),
        Kind::Q8r => q8r::stiffness(geometry, std::array::from_fn(|i| sections.at(i, material))),
    }
}

/// Strains at reference points.
pub fn strain_matrices<const N: usize>(kind: Kind, geometry: &Geometry, at: [(f64, f64); N]) -> [StrainMatrix; N] {
    match kind {
        Kind::Mitc9 if geometry.triangle => mitc7::strain_matrices(geometry, at),
        Kind::Mitc9 => mitc9::strain_matrices(geometry, at),
        Kind::Q8r => at.map(|(xi, eta)| q8r::strain_matrix(geometry, xi, eta)),
    }
}

/// Values of the nine rotation functions at a reference point (the ninth is zero for an element without a centre).
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

/// Work-equivalent forces of the stress-free curvature `[κxx, κyy, κxy]` over [`ALL_DOFS`]: ∫ Bᵀ D κ⁰.
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
