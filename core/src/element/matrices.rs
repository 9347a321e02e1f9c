//! Types of element matrices, and the storage of their lower triangles.

use super::section::Section;

/// Number of dofs of an element that are dofs of the mesh: three at each of eight nodes.
pub const DOFS: usize = 24;
/// Number of dofs of an element including its two centre rotations, which come last.
pub const ALL_DOFS: usize = 26;
/// Number of entries in the packed lower triangle of an element matrix, which is stored row by row.
pub const PACKED: usize = DOFS * (DOFS + 1) / 2;

/// Index in a packed lower triangle of the entry (i, j) = (j, i) of a symmetric matrix.
#[inline]
pub fn packed(i: usize, j: usize) -> usize {
    if i >= j { i * (i + 1) / 2 + j } else { j * (j + 1) / 2 + i }
}

/// Strain–displacement matrix B: rows for [κxx, κyy, 2κxy, γx, γy], columns for all dofs, the two centre rotations
/// last.
pub type StrainMatrix = [[f64; ALL_DOFS]; 5];

/// Coefficients that recover the condensed centre rotations: θ = compliance·m − coupling·u, with m the couples on the
/// centre rotations and u the nodal dofs.
#[derive(Clone, Debug, Default)]
pub struct Centre<T = f64> {
    pub coupling: [[T; DOFS]; 2],
    pub compliance: [[T; 2]; 2],
}

/// Element stiffness with the centre rotations condensed, and the coefficients that recover these rotations. The
/// coefficients are zeros if the element has no centre node.
pub struct Stiffness<T = f64> {
    /// Packed lower triangle of the stiffness, with [`PACKED`] entries.
    pub packed: [T; PACKED],
    pub centre: Centre<T>,
}

/// Calls `add(i, j, bᵢᵀ C bⱼ)` for all dofs i ≥ j below `count`. bⱼ is column j of the strain matrix, C has the
/// rigidities of the section.
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
