//! The factor of K with springs at some contact points, and the sparsity pattern of this factor.

use super::points::Points;
use super::tolerances;
use crate::assembly::{Assembly, HELD, MultiplierRow, Numbering};
use crate::bodies::Bodies;
use crate::cholesky::{Analysis, Factor, FactorError};
use crate::element::Kind;
use crate::plate::Plate;
use crate::rows::Springs;
use std::collections::HashSet;
use std::sync::{Arc, OnceLock};

/// The source of a multiplier row. Its unknown is the force of a spring, of a contact point, or of shear in a thin
/// element.
#[derive(Clone, Copy)]
enum RowKind {
    Spring(usize),
    Point(usize),
    /// A shear force of a thin element; the number is its compliance 1/k.
    Shear(f64),
}

/// The sparsity pattern that all factors of a problem share: numbering of columns, and multiplier rows.
///
/// Springs on the deflections of one or two elements can be assembled with the element matrices. Every other spring has
/// a multiplier row: the spring force is an unknown, and the matrix is quasi-definite.
pub(super) struct KktPattern {
    pub(super) numbering: Numbering,
    kinds: Vec<RowKind>,
    /// For each contact point, whether its force is an unknown of the factor (a multiplier row).
    is_multiplier_row: Vec<bool>,
    /// All multiplier rows, each with infinite compliance, so that it has no force; each factorization sets the
    /// compliances.
    absent: Vec<MultiplierRow>,
    /// The elastic supports (springs) whose rows have dofs of one or two elements.
    narrow: Springs,
    bodies: Arc<Bodies>,
    analysis: OnceLock<Analysis>,
}

/// A factor of K with springs at contact points.
pub(super) struct System {
    pub(super) factor: Factor,
    /// Stiffness (m,) of the spring that K has at each contact point in this factor.
    pub(super) carried: Vec<f64>,
    pub(super) pattern: Arc<KktPattern>,
}

impl KktPattern {
    /// Makes the pattern. Dofs marked `trailing` (3n,) get the last columns of the factor. `has_multiplier(i)` is true
    /// if contact point i has a multiplier row.
    pub(super) fn new(
        plate: &Plate,
        held: &[bool],
        springs: &Springs,
        points: &Points,
        trailing: &[bool],
        has_multiplier: impl Fn(usize) -> bool,
    ) -> Self {
        let mut narrow = Springs::default();
        let (mut kinds, mut absent) = (Vec::new(), Vec::new());
        let mut pairs = points.pairs().to_vec();
        pairs.extend(springs.rows.further.keys().filter_map(|&row| springs.rows.pair(row)));
        pairs.sort_unstable();
        pairs.dedup();
        for (row, &stiffness) in springs.stiffness.iter().enumerate() {
            if springs.rows.further.contains_key(&row) && springs.rows.pair(row).is_none() {
                kinds.push(RowKind::Spring(row));
                absent.push(MultiplierRow::new(springs.rows.entries(plate, row), f64::INFINITY));
            } else {
                narrow.push(&springs.rows, row, stiffness, springs.base[row]);
            }
        }
        for i in (0..points.len()).filter(|&i| has_multiplier(i)) {
            kinds.push(RowKind::Point(i));
            absent.push(MultiplierRow::new(points.row(i), f64::INFINITY));
        }
        for e in 0..plate.elements().len() {
            let dofs = plate.leading(e).iter().flat_map(|&node| 3 * node..3 * node + 3);
            for (row, compliance) in plate.shear_springs(e) {
                kinds.push(RowKind::Shear(compliance));
                absent.push(MultiplierRow::new(dofs.clone().zip(row), f64::INFINITY));
            }
        }
        let numbering = Numbering::with_multiplier_rows(plate, &pairs, held, trailing, &absent);
        let is_multiplier_row = (0..points.len()).map(has_multiplier).collect();
        Self {
            numbering,
            kinds,
            is_multiplier_row,
            absent,
            narrow,
            bodies: plate.bodies().clone(),
            analysis: OnceLock::new(),
        }
    }

    /// Factors K with springs of stiffness `carried` (m,) at the contact points. The diagonal of K is increased by the
    /// relative amount `diagonal_shift`. A factor of more than `room` bytes is refused before it is begun.
    pub(super) fn factored(
        self: &Arc<Self>,
        plate: &Plate,
        springs: &Springs,
        points: &Points,
        carried: Vec<f64>,
        diagonal_shift: f64,
        room: usize,
    ) -> Result<System, FactorError> {
        let compliance = |kind: &RowKind| match *kind {
            RowKind::Spring(row) => 1.0 / springs.stiffness[row],
            RowKind::Point(i) => 1.0 / carried[i],
            RowKind::Shear(compliance) => compliance,
        };
        let multiplier_row = |(kind, absent): (&RowKind, &MultiplierRow)| MultiplierRow {
            compliance: compliance(kind),
            ..absent.clone()
        };
        let multiplier_rows: Vec<MultiplierRow> = self.kinds.iter().zip(&self.absent).map(multiplier_row).collect();
        let of_elements = |(&slope, &is_multiplier_row): (&f64, &bool)| if is_multiplier_row { 0.0 } else { slope };
        let of_elements: Vec<f64> = carried.iter().zip(&self.is_multiplier_row).map(of_elements).collect();
        let bedding = points.bedding(plate, &of_elements);
        let matrix = Assembly::new(plate, &self.narrow, &bedding, &self.numbering)
            .has_multiplier(&multiplier_rows)
            .diagonal_shift(diagonal_shift);
        let analysis = match self.analysis.get() {
            Some(analysis) => analysis,
            None => {
                let made = Analysis::new(&matrix)?;
                self.analysis.get_or_init(|| made)
            }
        };
        analysis.require_room(room)?;
        let factor = analysis.factorize(&matrix)?;
        // A contact point without a spring may leave a rigid motion free, and elements q8r have zero-energy modes. In
        // these cases the smallest pivot decides whether the matrix is regular.
        if carried.contains(&0.0) || plate.kind == Kind::Q8r {
            let (column, part) = factor.weakest_pivot();
            if part < tolerances::LOOSE_PIVOT {
                return Err(FactorError::NotPositiveDefinite { column });
            }
        }
        Ok(System { factor, carried, pattern: self.clone() })
    }

    /// Whether exactly those contact points have a multiplier row for which `has_multiplier(i)` is true.
    pub(super) fn has_multiplier_rows(&self, has_multiplier: impl Fn(usize) -> bool) -> bool {
        self.is_multiplier_row.iter().enumerate().all(|(i, &own)| own == has_multiplier(i))
    }

    /// Arranges a nodal load (3n,) by column of the factor; held dofs have no column.
    pub(super) fn gather(&self, load: &[f64]) -> Vec<f64> {
        self.numbering.dof.iter().map(|&dof| load.get(dof).copied().unwrap_or(0.0)).collect()
    }

    /// Arranges displacements by column of the factor as nodal vector (3n,); held dofs are zero.
    pub(super) fn scatter(&self, ordered: &[f64], dofs: usize) -> Vec<f64> {
        let mut out = vec![0.0; dofs];
        for (&dof, &value) in self.numbering.dof.iter().zip(ordered).filter(|(dof, _)| **dof < dofs) {
            out[dof] = value;
        }
        self.bodies.follow(&mut out);
        out
    }

    /// The columns of the factor that belong to multiplier rows.
    pub(super) fn multiplier_rows(&self, dofs: usize) -> HashSet<usize> {
        let columns = self.numbering.dof.iter().enumerate();
        columns.filter(|(_, dof)| **dof >= dofs).map(|(column, _)| column).collect()
    }

    /// The rows of G, each a list of (column of the factor, coefficient), without held dofs.
    pub(super) fn rows(&self, points: &Points) -> Vec<Vec<(usize, f64)>> {
        let row = |i| points.row(i).map(|(dof, coefficient)| (self.numbering.column[dof], coefficient));
        (0..points.len()).map(|i| row(i).filter(|entry| entry.0 != HELD).collect()).collect()
    }
}

impl System {
    /// Displacements (3n,) under nodal forces (3n,), with held dofs at zero.
    pub(super) fn solve(&self, force: &[f64]) -> Result<Vec<f64>, FactorError> {
        let mut ordered = self.pattern.gather(force);
        self.factor.forward(&mut ordered)?;
        self.factor.backward(&mut ordered)?;
        Ok(self.pattern.scatter(&ordered, force.len()))
    }
}
