//! Types of element matrices.

use super::section::Section;

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

/// Strain rows [κxx, κyy, 2κxy, γx, γy] over the dofs with the centre rotations last.
pub type StrainMatrix = [[f64; ALL_DOFS]; 5];

/// Recovery of the condensed centre rotations: θ = compliance·m − coupling·u, with m the couples on them.
#[derive(Clone, Debug, Default)]
pub struct Centre<T = f64> {
    pub coupling: [[T; DOFS]; 2],
    pub compliance: [[T; 2]; 2],
}

/// The stiffness that the mesh sees, and the centre behind it; a centre of zeros where the element has none.
pub struct Stiffness<T = f64> {
    /// Packed lower triangle, [`PACKED`] entries.
    pub packed: [T; PACKED],
    pub centre: Centre<T>,
}

/// Adds bᵢᵀ C bⱼ for the first `count` dofs, i ≥ j.
pub(super) fn add_energy(
    strain: &StrainMatrix,
    section: &Section,
    count: usize,
    mut add: impl FnMut(usize, usize, f64),
) {
    for j in 0..count {
        let [m0, m1, m2] = section.moment([strain[0][j], strain[1][j], strain[2][j]]);
        let [q0, q1] = section.shear_force([strain[3][j], strain[4][j]]);
        for i in j..count {
            let bending = strain[0][i] * m0 + strain[1][i] * m1 + strain[2][i] * m2;
            add(i, j, bending + strain[3][i] * q0 + strain[4][i] * q1);
        }
    }
}
