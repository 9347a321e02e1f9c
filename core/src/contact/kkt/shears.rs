//! Thin elements with their shear forces as unknowns, R the tied shears and F the forces that they take:
//!
//! ```text
//! bending   Rᵀ     u     f
//! R       −F⁻¹     q  =  0
//! ```
//!
//! Condensed, RᵀFR drowns the bending in its rounding; here the equations only come near those of a plate that cannot
//! shear, F⁻¹ = 0, which are as good as any. The centre rotations are unknown too: without them bending would be
//! condensed onto shear.

use crate::assembly::{HELD, Numbering};
use crate::element::thin::SHEARS;
use crate::element::{ALL_DOFS, DOFS};
use crate::plate::Plate;

/// The part of thin elements in the equations.
pub(super) struct Shears {
    /// Lower triangle, with rows and columns; several may have one place.
    pub(super) entries: Vec<(usize, usize, f64)>,
    /// What the unknowns inside are to be multiplied by.
    pub(super) unit: Vec<f64>,
    /// Stiffness of the free dofs, with shear as stiff as bending: by which to scale them.
    pub(super) stiffness: Vec<f64>,
}

impl Shears {
    /// Of all thin elements, their unknowns beginning with the row `first`.
    pub(super) fn of(plate: &Plate, numbering: &Numbering, first: usize) -> Self {
        let mut shears = Self { entries: Vec::new(), unit: Vec::new(), stiffness: vec![0.0; numbering.len()] };
        for e in (0..plate.elements().len()).filter(|&e| plate.is_thin(e)) {
            shears.add(plate, numbering, e, first + shears.unit.len());
        }
        shears
    }

    fn add(&mut self, plate: &Plate, numbering: &Numbering, e: usize, inside: usize) {
        let mixed = plate.mixed(e);
        let nodes = &plate.elements()[e];
        let place: [usize; ALL_DOFS] =
            std::array::from_fn(
                |j| {
                    if j < DOFS { numbering.column[3 * nodes[j / 3] + j % 3] } else { inside + j - DOFS }
                },
            );
        let of_shear = inside + ALL_DOFS - DOFS;
        let mut push = |row: usize, column: usize, value: f64| {
            if row != HELD && column != HELD && value != 0.0 {
                self.entries.push((row.max(column), row.min(column), value));
            }
        };
        let mut stiffness = [0.0; ALL_DOFS];
        for i in 0..ALL_DOFS {
            (0..=i).for_each(|j| push(place[i], place[j], mixed.bending[i][j]));
            stiffness[i] = mixed.bending[i][i];
        }
        for t in 0..SHEARS {
            for (j, &c) in mixed.rows[t].iter().enumerate() {
                push(of_shear + t, place[j], c);
                stiffness[j] += mixed.unit[t] * c * c;
            }
            (0..=t).for_each(|s| push(of_shear + t, of_shear + s, -mixed.compliance[t][s]));
        }
        for (&column, k) in place[..DOFS].iter().zip(stiffness).filter(|(column, _)| **column != HELD) {
            self.stiffness[column] += k;
        }
        self.unit.extend(stiffness[DOFS..].iter().map(|k| 1.0 / k.sqrt()));
        self.unit.extend(mixed.unit.map(f64::sqrt));
    }
}
