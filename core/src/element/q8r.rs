//! The 8-node serendipity plate element with uniform 2×2 integration (Hinton & Owen 1977).
//!
//! The first side of an element may be collapsed to a node c: [c, c, a, b, c, ca, ab, bc]. The map is singular at c
//! only, and all Gauss points are inside. Assembly sums the entries of the three positions of c.

use super::geometry::Geometry;
use super::matrices::{ALL_DOFS, Centre, DOFS, PACKED, Stiffness, StrainMatrix, add_energy, packed};
use super::quadrature::{GAUSS_2, square};
use super::section::Section;

/// Strain–displacement matrix at (ξ, η) for κ = sym ∇θ and γ = ∇w − θ, with the serendipity functions for w and θ.
pub fn strain_matrix(geometry: &Geometry, xi: f64, eta: f64) -> StrainMatrix {
    let jacobian = geometry.jacobian(xi, eta);
    let mut strain = [[0.0; ALL_DOFS]; 5];
    for i in 0..8 {
        let value = jacobian.shape.value[i];
        let [x, y] = jacobian.physical(jacobian.shape.gradient[i]);
        strain[0][3 * i + 1] = x;
        strain[1][3 * i + 2] = y;
        strain[2][3 * i + 1] = y;
        strain[2][3 * i + 2] = x;
        strain[3][3 * i] = x;
        strain[3][3 * i + 1] = -value;
        strain[4][3 * i] = y;
        strain[4][3 * i + 2] = -value;
    }
    strain
}

/// Element stiffness ∫ Bᵀ C B by the 2×2 Gauss rule; `sections` has the rigidities C at its points.
pub fn stiffness(geometry: &Geometry, sections: [Section; 4]) -> Stiffness {
    let mut full = [0.0; PACKED];
    for ((xi, eta, weight), section) in square(GAUSS_2).zip(sections) {
        let strain = strain_matrix(geometry, xi, eta);
        let scale = weight * geometry.jacobian(xi, eta).determinant;
        add_energy(&strain, &section, DOFS, |i, j, energy| full[packed(i, j)] += scale * energy);
    }
    Stiffness { packed: full, centre: Centre::default() }
}
