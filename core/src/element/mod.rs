//! Plate elements on the 8-node quadrilateral: 24 dofs, node by node (deflection w, slopes θx, θy).
//!
//! An element may carry the rotations of a centre node inside itself; they are condensed, so that the mesh never
//! sees them. Strains come as [κxx, κyy, 2κxy, γx, γy] with κ = sym ∇θ and γ = ∇w − θ.

pub mod mitc9;
pub mod q8r;
pub mod quadrature;
pub mod section;
pub mod shape;
pub mod thin;

use quadrature::{GAUSS_2, GAUSS_3, square};
pub use section::{Layered, Material, Section, Sections, Thickness};
use shape::{Shape, serendipity};
use std::sync::LazyLock;

/// Dofs that an element shows to the mesh.
pub const DOFS: usize = 24;
/// Dofs with the centre rotations behind them.
pub const ALL_DOFS: usize = 26;
/// Entries of the packed lower triangle, row by row.
pub const PACKED: usize = DOFS * (DOFS + 1) / 2;

/// Position of entry (i, j), i ≥ j, in a packed lower triangle.
#[inline]
pub fn packed(i: usize, j: usize) -> usize {
    if i >= j { i * (i + 1) / 2 + j } else { j * (j + 1) / 2 + i }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Bathe, Brezzi & Fortin (1989): mixed interpolation, free of locking.
    Mitc9,
    /// Hinton & Owen (1977): serendipity throughout, uniform 2×2 integration. Locks in thin plates.
    Q8r,
}

impl Kind {
    /// Where an element asks for its section: reference points of its stiffness, weights included, then those at which
    /// stress is sampled, without a weight; of q8r they are the same. ξ runs fastest in either.
    pub fn points(self) -> &'static [(f64, f64, f64)] {
        static MITC9: LazyLock<Vec<(f64, f64, f64)>> =
            LazyLock::new(|| square(GAUSS_3).chain(square(GAUSS_2).map(|(xi, eta, _)| (xi, eta, 0.0))).collect());
        static Q8R: LazyLock<Vec<(f64, f64, f64)>> = LazyLock::new(|| square(GAUSS_2).collect());
        match self {
            Self::Mitc9 => &MITC9,
            Self::Q8r => &Q8R,
        }
    }

    /// The first of the four points at which stress is sampled.
    pub fn first_sample(self) -> usize {
        self.points().len() - 4
    }
}

/// Coordinates, relative to the first node, of the eight nodes of one element.
#[derive(Clone, Copy, Debug)]
pub struct Geometry {
    pub at: [[f64; 2]; 8],
}

/// The map at one reference point.
pub struct Jacobian {
    pub shape: Shape<8>,
    /// ∂(x, y)/∂(ξ, η): rows ξ and η.
    pub tangent: [[f64; 2]; 2],
    /// ∂(ξ, η)/∂(x, y): inverse[a][b] takes a reference gradient's b-th part to the physical a-th.
    pub inverse: [[f64; 2]; 2],
    pub determinant: f64,
}

impl Geometry {
    pub fn jacobian(&self, xi: f64, eta: f64) -> Jacobian {
        self.jacobian_of(serendipity(xi, eta))
    }

    /// The map where the shape functions are known already.
    pub fn jacobian_of(&self, shape: Shape<8>) -> Jacobian {
        let mut t = [[0.0; 2]; 2];
        for i in 0..8 {
            for a in 0..2 {
                for b in 0..2 {
                    t[a][b] += shape.gradient[i][a] * self.at[i][b];
                }
            }
        }
        let determinant = t[0][0] * t[1][1] - t[0][1] * t[1][0];
        let inverse =
            [[t[1][1] / determinant, -t[0][1] / determinant], [-t[1][0] / determinant, t[0][0] / determinant]];
        Jacobian { shape, tangent: t, inverse, determinant }
    }
}

impl Jacobian {
    pub fn physical(&self, gradient: [f64; 2]) -> [f64; 2] {
        let inv = &self.inverse;
        [inv[0][0] * gradient[0] + inv[0][1] * gradient[1], inv[1][0] * gradient[0] + inv[1][1] * gradient[1]]
    }
}

/// Strain rows [κxx, κyy, 2κxy, γx, γy] over the dofs with the centre rotations last.
pub type StrainMatrix = [[f64; ALL_DOFS]; 5];

/// What brings the condensed centre rotations back: θ = compliance·m − coupling·u, m the couples that act on them.
#[derive(Clone, Debug, Default)]
pub struct Centre {
    pub coupling: [[f64; DOFS]; 2],
    pub compliance: [[f64; 2]; 2],
}

/// The stiffness that the mesh sees, and the centre behind it; a centre of zeros where the element has none.
pub struct Stiffness {
    /// Packed lower triangle, [`PACKED`] entries.
    pub packed: [f64; PACKED],
    pub centre: Centre,
}

/// Stiffness of one element.
pub fn stiffness(kind: Kind, geometry: &Geometry, material: &Material, sections: Sections) -> Stiffness {
    match (kind, sections) {
        (Kind::Mitc9, sections) => mitc9::stiffness(geometry, material, sections),
        (Kind::Q8r, Sections::Constant(h)) => q8r::stiffness(geometry, material, [h; 4]),
        (Kind::Q8r, Sections::Varying(h)) => q8r::stiffness(geometry, material, std::array::from_fn(|i| h[i])),
        (Kind::Q8r, Sections::Layered(s)) => q8r::layered_stiffness(geometry, std::array::from_fn(|i| s[i])),
    }
}

/// Strains at reference points.
pub fn strain_matrices<const N: usize>(kind: Kind, geometry: &Geometry, at: [(f64, f64); N]) -> [StrainMatrix; N] {
    match kind {
        Kind::Mitc9 => mitc9::strain_matrices(geometry, at),
        Kind::Q8r => at.map(|(xi, eta)| q8r::strain_matrix(geometry, xi, eta)),
    }
}

/// Adds bᵢᵀ C bⱼ for the first `count` dofs, i ≥ j.
fn add_energy(strain: &StrainMatrix, section: &Section, count: usize, mut add: impl FnMut(usize, usize, f64)) {
    for j in 0..count {
        let [m0, m1, m2] = section.moment([strain[0][j], strain[1][j], strain[2][j]]);
        let [q0, q1] = section.shear_force([strain[3][j], strain[4][j]]);
        for i in j..count {
            let bending = strain[0][i] * m0 + strain[1][i] * m1 + strain[2][i] * m2;
            add(i, j, bending + strain[3][i] * q0 + strain[4][i] * q1);
        }
    }
}

/// Values of the nine rotation functions at a reference point (the ninth is zero for an element without a centre).
pub fn rotation_functions(kind: Kind, xi: f64, eta: f64) -> [f64; 9] {
    match kind {
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
    let rule: [(f64, f64, f64); M] = std::array::from_fn(|i| kind.points()[i]);
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
