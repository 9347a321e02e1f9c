//! Rows g of supports, with coefficients over the dofs of elements, and springs that act along such rows.

use crate::displacement::Displacement;
use crate::double_double::DoubleDouble;
use crate::element::DOFS;
use crate::plate::Plate;
use std::collections::BTreeMap;

/// A table of rows g of elastic supports and contact points. Row i has coefficients over the dofs of one element, in
/// nodal frames. If the plate has rigid bodies, the coefficients are over the dofs of the leaders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rows {
    pub element: Vec<usize>,
    pub coefficient: Vec<[f64; DOFS]>,
    /// Coefficients of row i in further elements, if the row connects two plates or averages over a footprint. Each dof
    /// appears once in a row.
    pub further: BTreeMap<usize, Vec<(usize, [f64; DOFS])>>,
}

impl Rows {
    pub fn len(&self) -> usize {
        self.element.len()
    }

    pub fn is_empty(&self) -> bool {
        self.element.is_empty()
    }

    /// Replaces the coefficients at nodes that follow a leader by coefficients at the leader, in all rows.
    pub fn onto_leaders(mut self, plate: &Plate) -> Self {
        if plate.bodies().is_empty() {
            return self;
        }
        for (row, (&e, own)) in self.element.iter().zip(&mut self.coefficient).enumerate() {
            plate.onto_leaders(e, own);
            let Some(further) = self.further.get_mut(&row) else { continue };
            further.iter_mut().for_each(|(e, own)| plate.onto_leaders(*e, own));
            // If a dof occurs in several elements of the row, its coefficients are summed in the first of these
            // elements.
            let mut place: BTreeMap<usize, (usize, usize)> = BTreeMap::new();
            for piece in 0..=further.len() {
                let nodes = plate.leading(if piece == 0 { e } else { further[piece - 1].0 });
                for (local, &node) in nodes.iter().enumerate() {
                    let first = *place.entry(node).or_insert((piece, local));
                    for k in (0..3).filter(|_| first.0 != piece) {
                        let part = std::mem::take(&mut further[piece - 1].1[3 * local + k]);
                        let to = if first.0 == 0 { &mut *own } else { &mut further[first.0 - 1].1 };
                        to[3 * first.1 + k] += part;
                    }
                }
            }
        }
        self
    }

    /// Appends row number `row` of the table `other`.
    pub fn push_from(&mut self, other: &Self, row: usize) {
        if let Some(further) = other.further.get(&row) {
            self.further.insert(self.len(), further.clone());
        }
        self.element.push(other.element[row]);
        self.coefficient.push(other.coefficient[row]);
    }

    /// The two elements of a row; `None` if the row has dofs of one element or of more than two.
    pub fn pair(&self, row: usize) -> Option<[u32; 2]> {
        match self.further.get(&row)?[..] {
            [(second, _)] => Some([self.element[row] as u32, second as u32]),
            _ => None,
        }
    }

    /// The pairs (dof, coefficient) of a row, without zero coefficients.
    pub fn entries<'a>(&'a self, plate: &'a Plate, row: usize) -> impl Iterator<Item = (usize, f64)> + 'a {
        let of_element = |element: usize, coefficient: &'a [f64; DOFS]| {
            let nodes = plate.leading(element);
            let entry = move |(j, &c): (usize, &f64)| (3 * nodes[j / 3] + j % 3, c);
            coefficient.iter().enumerate().filter(|(_, c)| **c != 0.0).map(entry)
        };
        let further = self.further.get(&row).into_iter().flatten();
        of_element(self.element[row], &self.coefficient[row]).chain(further.flat_map(move |(e, c)| of_element(*e, c)))
    }

    /// g·u − `offset` for row g of the table, summed in double-double.
    pub fn beyond(&self, plate: &Plate, row: usize, displacement: &Displacement, offset: f64) -> f64 {
        let mut sum = DoubleDouble::from(-offset);
        self.entries(plate, row).for_each(|(dof, c)| {
            sum.add_product(c, displacement.hi[dof]);
            sum.lo += c * displacement.lo[dof];
        });
        sum.value()
    }

    /// g·v for row g of the table and a vector v (3n,) of doubles.
    pub fn dot(&self, plate: &Plate, row: usize, vector: &[f64]) -> f64 {
        self.entries(plate, row).map(|(dof, c)| c * vector[dof]).sum()
    }

    /// Adds `factor` · g, for row g of the table, to a nodal vector (3n,).
    pub fn scatter(&self, plate: &Plate, row: usize, factor: f64, vector: &mut [f64]) {
        self.entries(plate, row).for_each(|(dof, c)| vector[dof] += factor * c);
    }
}

/// Linear springs. Spring i acts along row g_i with the force `stiffness_i` (g_i·u − `base_i`).
#[derive(Clone, Debug, Default)]
pub struct Springs {
    pub rows: Rows,
    pub stiffness: Vec<f64>,
    pub base: Vec<f64>,
}

impl Springs {
    /// Appends a spring that acts along row number `row` of the table `rows`.
    pub fn push(&mut self, rows: &Rows, row: usize, stiffness: f64, base: f64) {
        self.rows.push_from(rows, row);
        self.stiffness.push(stiffness);
        self.base.push(base);
    }
}
