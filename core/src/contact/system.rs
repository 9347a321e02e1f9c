//! K with the springs of some points, factored.

use super::points::Points;
use super::tolerances;
use crate::assembly::{Assembly, Border, HELD, Numbering};
use crate::bodies::Bodies;
use crate::cholesky::{Analysis, Factor, FactorError};
use crate::element::Kind;
use crate::plate::Plate;
use crate::rows::Springs;
use std::collections::HashSet;
use std::sync::{Arc, OnceLock};

/// Whose row a border is.
#[derive(Clone, Copy)]
enum Owner {
    Spring(usize),
    Point(usize),
    /// Shear that the matrix of a thin element lacks, and its compliance.
    Shear(f64),
}

/// What every factor of a plate has in common: its columns, and which rows are borders.
///
/// Springs over the deflections of one or two elements may be summed with their matrices. Those of all other rows stay outside
/// K, their forces as unknowns, and the matrix is quasi-definite.
pub(super) struct Blueprint {
    pub(super) numbering: Numbering,
    owners: Vec<Owner>,
    /// Of every point, whether its row is a border.
    is_border: Vec<bool>,
    /// Borders without a force.
    absent: Vec<Border>,
    /// Springs over one element or two.
    narrow: Springs,
    bodies: Arc<Bodies>,
    analysis: OnceLock<Analysis>,
}

/// A factor of K and of the springs that it carries.
pub(super) struct System {
    pub(super) factor: Factor,
    /// Slope of the spring that it has at every point.
    pub(super) carried: Vec<f64>,
    pub(super) blueprint: Arc<Blueprint>,
}

impl Blueprint {
    /// With the dofs marked `trailing` last. `bordered` says whose springs may come and go.
    pub(super) fn new(
        plate: &Plate,
        held: &[bool],
        springs: &Springs,
        points: &Points,
        trailing: &[bool],
        bordered: impl Fn(usize) -> bool,
    ) -> Self {
        let mut narrow = Springs::default();
        let (mut owners, mut absent) = (Vec::new(), Vec::new());
        let mut pairs = points.pairs().to_vec();
        pairs.extend(springs.rows.further.keys().filter_map(|&row| springs.rows.pair(row)));
        pairs.sort_unstable();
        pairs.dedup();
        for (row, &stiffness) in springs.stiffness.iter().enumerate() {
            if springs.rows.further.contains_key(&row) && springs.rows.pair(row).is_none() {
                owners.push(Owner::Spring(row));
                absent.push(Border::new(springs.rows.entries(plate, row), f64::INFINITY));
            } else {
                narrow.push(&springs.rows, row, stiffness, springs.base[row]);
            }
        }
        for i in (0..points.len()).filter(|&i| bordered(i)) {
            owners.push(Owner::Point(i));
            absent.push(Border::new(points.row(i), f64::INFINITY));
        }
        for e in 0..plate.elements().len() {
            let dofs = plate.leading(e).iter().flat_map(|&node| 3 * node..3 * node + 3);
            for (row, compliance) in plate.shear_springs(e) {
                owners.push(Owner::Shear(compliance));
                absent.push(Border::new(dofs.clone().zip(row), f64::INFINITY));
            }
        }
        let numbering = Numbering::with_borders(plate, &pairs, held, trailing, &absent);
        let is_border = (0..points.len()).map(bordered).collect();
        Self { numbering, owners, is_border, absent, narrow, bodies: plate.bodies().clone(), analysis: OnceLock::new() }
    }

    /// The factor with slopes of springs at the points, every dof stiffer by `firmer` of its own. One that takes more than
    /// `room`, in bytes, is refused before it is begun.
    pub(super) fn factored(
        self: &Arc<Self>,
        plate: &Plate,
        springs: &Springs,
        points: &Points,
        carried: Vec<f64>,
        firmer: f64,
        room: usize,
    ) -> Result<System, FactorError> {
        let compliance = |owner: &Owner| match *owner {
            Owner::Spring(row) => 1.0 / springs.stiffness[row],
            Owner::Point(i) => 1.0 / carried[i],
            Owner::Shear(compliance) => compliance,
        };
        let border = |(owner, absent): (&Owner, &Border)| Border { compliance: compliance(owner), ..absent.clone() };
        let borders: Vec<Border> = self.owners.iter().zip(&self.absent).map(border).collect();
        let of_elements = |(&slope, &is_border): (&f64, &bool)| if is_border { 0.0 } else { slope };
        let of_elements: Vec<f64> = carried.iter().zip(&self.is_border).map(of_elements).collect();
        let bedding = points.bedding(plate, &of_elements);
        let matrix = Assembly::new(plate, &self.narrow, &bedding, &self.numbering).bordered(&borders).firmer(firmer);
        let analysis = match self.analysis.get() {
            Some(analysis) => analysis,
            None => {
                let made = Analysis::new(&matrix)?;
                self.analysis.get_or_init(|| made)
            }
        };
        analysis.require_room(room)?;
        let factor = analysis.factorize(&matrix)?;
        // Points that are not carried need not hold the plate, and elements of q8r bend in some shapes without resistance.
        if carried.contains(&0.0) || plate.kind == Kind::Q8r {
            let (column, part) = factor.weakest_pivot();
            if part < tolerances::LOOSE_PIVOT {
                return Err(FactorError::NotPositiveDefinite { column });
            }
        }
        Ok(System { factor, carried, blueprint: self.clone() })
    }

    /// A nodal load in elimination order, without the dofs held.
    pub(super) fn gather(&self, load: &[f64]) -> Vec<f64> {
        self.numbering.dof.iter().map(|&dof| load.get(dof).copied().unwrap_or(0.0)).collect()
    }

    /// A motion in elimination order as a nodal one; dofs held are zero.
    pub(super) fn scatter(&self, ordered: &[f64], dofs: usize) -> Vec<f64> {
        let mut out = vec![0.0; dofs];
        for (&dof, &value) in self.numbering.dof.iter().zip(ordered).filter(|(dof, _)| **dof < dofs) {
            out[dof] = value;
        }
        self.bodies.follow(&mut out);
        out
    }

    /// The columns of borders.
    pub(super) fn borders(&self, dofs: usize) -> HashSet<usize> {
        let columns = self.numbering.dof.iter().enumerate();
        columns.filter(|(_, dof)| **dof >= dofs).map(|(column, _)| column).collect()
    }

    /// Rows of points by columns.
    pub(super) fn rows(&self, points: &Points) -> Vec<Vec<(usize, f64)>> {
        let row = |i| points.row(i).map(|(dof, coefficient)| (self.numbering.column[dof], coefficient));
        (0..points.len()).map(|i| row(i).filter(|entry| entry.0 != HELD).collect()).collect()
    }
}

impl System {
    /// The motion of the nodes under nodal forces.
    pub(super) fn solve(&self, force: &[f64]) -> Result<Vec<f64>, FactorError> {
        let mut ordered = self.blueprint.gather(force);
        self.factor.forward(&mut ordered)?;
        self.factor.backward(&mut ordered)?;
        Ok(self.blueprint.scatter(&ordered, force.len()))
    }
}
