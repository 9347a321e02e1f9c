//! Plate elements on the 8-node quadrilateral: 24 dofs, node by node (deflection w, slopes θx, θy).
//!
//! An element may carry the rotations of a centre node inside itself; they are condensed, so that the mesh never
//! sees them. Strains come as [κxx, κyy, 2κxy, γx, γy] with κ = sym ∇θ and γ = ∇w − θ.

pub mod mitc9;
pub mod q8r;
pub mod quadrature;
pub mod shape;
pub mod thin;

use quadrature::{GAUSS_2, GAUSS_3, square};
use shape::{Shape, serendipity};

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

/// Isotropic elasticity with a shear correction factor.
#[derive(Clone, Copy, Debug)]
pub struct Material {
    pub young: f64,
    pub poisson: f64,
    pub shear_factor: f64,
}

impl Material {
    /// D = Eh³/12(1−ν²).
    pub fn bending_rigidity(&self, thickness: f64) -> f64 {
        self.young * thickness.powi(3) / (12.0 * (1.0 - self.poisson * self.poisson))
    }

    /// S = κGh.
    pub fn shear_rigidity(&self, thickness: f64) -> f64 {
        self.shear_factor * self.young * thickness / (2.0 * (1.0 + self.poisson))
    }

    /// [mxx, myy, mxy] conjugate to [κxx, κyy, 2κxy].
    pub fn bending(&self, thickness: f64, curvature: [f64; 3]) -> [f64; 3] {
        let d = self.bending_rigidity(thickness);
        let nu = self.poisson;
        let [x, y, twist] = curvature;
        [d * (x + nu * y), d * (nu * x + y), d * 0.5 * (1.0 - nu) * twist]
    }
}

/// Coordinates, relative to the first node, and thickness at the eight nodes of one element.
#[derive(Clone, Copy, Debug)]
pub struct Geometry {
    pub at: [[f64; 2]; 8],
    pub thickness: [f64; 8],
}

/// The map at one reference point.
pub struct Jacobian {
    pub shape: Shape<8>,
    /// ∂(x, y)/∂(ξ, η): rows ξ and η.
    pub tangent: [[f64; 2]; 2],
    /// ∂(ξ, η)/∂(x, y): inverse[a][b] takes a reference gradient's b-th part to the physical a-th.
    pub inverse: [[f64; 2]; 2],
    pub determinant: f64,
    pub thickness: f64,
}

impl Geometry {
    pub fn jacobian(&self, xi: f64, eta: f64) -> Jacobian {
        self.jacobian_of(serendipity(xi, eta))
    }

    /// The map where the shape functions are known already.
    pub fn jacobian_of(&self, shape: Shape<8>) -> Jacobian {
        let mut t = [[0.0; 2]; 2];
        let mut thickness = 0.0;
        for i in 0..8 {
            for a in 0..2 {
                for b in 0..2 {
                    t[a][b] += shape.gradient[i][a] * self.at[i][b];
                }
            }
            thickness += shape.value[i] * self.thickness[i];
        }
        let determinant = t[0][0] * t[1][1] - t[0][1] * t[1][0];
        let inverse =
            [[t[1][1] / determinant, -t[0][1] / determinant], [-t[1][0] / determinant, t[0][0] / determinant]];
        Jacobian { shape, tangent: t, inverse, determinant, thickness }
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
pub fn stiffness(kind: Kind, geometry: &Geometry, material: &Material) -> Stiffness {
    match kind {
        Kind::Mitc9 => mitc9::stiffness(geometry, material),
        Kind::Q8r => q8r::stiffness(geometry, material),
    }
}

/// Strains at reference points.
pub fn strain_matrices<const N: usize>(kind: Kind, geometry: &Geometry, at: [(f64, f64); N]) -> [StrainMatrix; N] {
    match kind {
        Kind::Mitc9 => mitc9::strain_matrices(geometry, at),
        Kind::Q8r => at.map(|(xi, eta)| q8r::strain_matrix(geometry, xi, eta)),
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
pub fn curvature_load(kind: Kind, geometry: &Geometry, material: &Material, curvature: [f64; 3]) -> [f64; ALL_DOFS] {
    match kind {
        Kind::Mitc9 => curvature_load_by(kind, geometry, material, curvature, points::<3, 9>(GAUSS_3)),
        Kind::Q8r => curvature_load_by(kind, geometry, material, curvature, points::<2, 4>(GAUSS_2)),
    }
}

fn points<const N: usize, const M: usize>(rule: [(f64, f64); N]) -> [(f64, f64, f64); M] {
    let mut all = square(rule);
    std::array::from_fn(|_| all.next().expect("M = N²"))
}

fn curvature_load_by<const M: usize>(
    kind: Kind,
    geometry: &Geometry,
    material: &Material,
    curvature: [f64; 3],
    rule: [(f64, f64, f64); M],
) -> [f64; ALL_DOFS] {
    let mut load = [0.0; ALL_DOFS];
    let strains = strain_matrices(kind, geometry, rule.map(|(xi, eta, _)| (xi, eta)));
    for ((xi, eta, weight), strain) in rule.into_iter().zip(strains) {
        let jacobian = geometry.jacobian(xi, eta);
        let moment = material.bending(jacobian.thickness, [curvature[0], curvature[1], 2.0 * curvature[2]]);
        for (i, f) in load.iter_mut().enumerate() {
            let work: f64 = (0..3).map(|a| strain[a][i] * moment[a]).sum();
            *f += weight * jacobian.determinant * work;
        }
    }
    load
}
