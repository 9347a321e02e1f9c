//! A plate on its supports, factored once.

use super::active_set::SoftPoints;
use super::condense::Condensed;
use crate::assembly::{HELD, Numbering, assemble};
use crate::cholesky::{Analysis, Factor, FactorError};
use crate::plate::Plate;
use crate::residual::{Displacement, Rows, Springs, residual};
use std::sync::Arc;
use std::time::Instant;

/// Contact points: row_i·u + gap_i − compliance_i·reaction_i = distance_i.
#[derive(Clone, Debug, Default)]
pub struct Constraints {
    pub rows: Rows,
    /// Free travel before the point acts.
    pub distance: Vec<f64>,
    /// Inverse stiffness of the support; 0 is rigid.
    pub compliance: Vec<f64>,
    /// An equation rather than an inequality.
    pub two_sided: Vec<bool>,
    /// Stiffness that the factor carries at the point so that K̃ is regular; 0 for most.
    pub regularization: Vec<f64>,
    /// Rigid motions over all dofs that springs, held dofs and two-sided points leave free.
    pub free_motions: Vec<Vec<f64>>,
}

/// Positions, in the caller's order, of the points of the LCP and of the soft ones.
#[derive(Clone, Debug, Default)]
pub struct PointOrder {
    pub hard: Vec<usize>,
    pub soft: Vec<usize>,
}

/// Seconds of each stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seconds {
    pub order: f64,
    pub assemble: f64,
    pub factor: f64,
    pub condense: f64,
}

pub struct ContactProblem {
    pub plate: Arc<Plate>,
    pub springs: Springs,
    pub held: Vec<bool>,
    /// Points that the LCP is about.
    pub constraints: Constraints,
    /// Points of the active set, and where both kinds stand in the caller's order.
    pub soft: SoftPoints,
    pub order: PointOrder,
    pub numbering: Numbering,
    pub factor: Factor,
    pub condensed: Condensed,
    pub seconds: Seconds,
}

impl ContactProblem {
    /// Orders with the contact dofs last, assembles, factors, and condenses onto the contact points.
    pub fn new(
        plate: Arc<Plate>,
        springs: Springs,
        held: Vec<bool>,
        constraints: Constraints,
        soft: &[bool],
    ) -> Result<Self, FactorError> {
        let clock = Instant::now();
        let (constraints, soft, point_order) = split(constraints, soft);
        let rows = &constraints.rows;
        let mut trailing = vec![false; plate.dof_count()];
        for row in 0..rows.len() {
            for (dof, _) in rows.entries(&plate, row) {
                trailing[dof] = true;
            }
        }
        let numbering = Numbering::new(&plate, &held, &trailing);
        let order = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let matrix = assemble(
            &plate,
            &with_regularization(&springs, &constraints),
            &soft.stiffness_by_element(&plate),
            &numbering,
        );
        let assemble = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let factor = Analysis::new(&matrix)?.factorize(&matrix)?;
        drop(matrix);
        let factoring = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let first = numbering.len() - numbering.trailing;
        let entries: Vec<Vec<(usize, f64)>> = (0..rows.len())
            .map(|row| {
                rows.entries(&plate, row)
                    .filter(|&(dof, _)| numbering.column[dof] != HELD)
                    .map(|(dof, c)| (numbering.column[dof] - first, c))
                    .collect()
            })
            .collect();
        let moves = |motion: &Vec<f64>| (0..rows.len()).map(|row| rows.dot(&plate, row, motion)).collect();
        let condensed = Condensed::new(
            factor.trailing_block(numbering.trailing),
            entries,
            constraints.regularization.clone(),
            constraints.compliance.clone(),
            constraints.two_sided.clone(),
            &constraints.free_motions.iter().map(moves).collect::<Vec<_>>(),
        );
        let condense = clock.elapsed().as_secs_f64();
        let seconds = Seconds { order, assemble, factor: factoring, condense };
        Ok(Self { plate, springs, held, constraints, soft, order: point_order, numbering, factor, condensed, seconds })
    }

    /// A nodal load in elimination order, without the dofs held.
    pub fn gather(&self, load: &[f64]) -> Vec<f64> {
        self.numbering.dof.iter().map(|&dof| load[dof]).collect()
    }

    /// A vector in elimination order as a nodal one; dofs held are zero.
    pub fn scatter(&self, ordered: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; self.plate.dof_count()];
        for (&dof, &value) in self.numbering.dof.iter().zip(ordered) {
            out[dof] = value;
        }
        out
    }

    /// K̃⁻¹ times a nodal load.
    pub fn apply_inverse(&self, load: &[f64]) -> Result<Vec<f64>, FactorError> {
        let mut ordered = self.gather(load);
        self.factor.forward(&mut ordered)?;
        self.factor.backward(&mut ordered)?;
        Ok(self.scatter(&ordered))
    }

    /// row_i·vector for every contact point.
    pub fn at_points(&self, vector: &[f64]) -> Vec<f64> {
        (0..self.constraints.rows.len()).map(|i| self.constraints.rows.dot(&self.plate, i, vector)).collect()
    }

    /// Adds Gᵀ·factor to a nodal vector.
    pub fn spread(&self, factor: &[f64], vector: &mut [f64]) {
        for (i, &value) in factor.iter().enumerate() {
            if value != 0.0 {
                self.constraints.rows.scatter(&self.plate, i, value, vector);
            }
        }
    }

    /// f − Ku − springs − Gᵀ·reaction at every dof: out of balance where free, the support's upward force where held.
    pub fn imbalance(&self, load: &[f64], displacement: &Displacement, reaction: &[f64]) -> Vec<f64> {
        let mut out = residual(&self.plate, &self.springs, load, displacement);
        self.take_soft_forces(displacement, &mut out);
        let downward: Vec<f64> = reaction.iter().map(|r| -r).collect();
        self.spread(&downward, &mut out);
        out
    }

    /// distance − row·u + compliance·reaction: what is left of each gap, in double-double.
    pub fn remaining(&self, displacement: &Displacement, reaction: &[f64]) -> Vec<f64> {
        let c = &self.constraints;
        (0..c.rows.len())
            .map(|i| c.compliance[i] * reaction[i] - c.rows.gap(&self.plate, i, displacement, c.distance[i]))
            .collect()
    }
}

pub(super) fn with_regularization(springs: &Springs, constraints: &Constraints) -> Springs {
    let mut all = springs.clone();
    for (i, &delta) in constraints.regularization.iter().enumerate() {
        if delta > 0.0 {
            all.rows.element.push(constraints.rows.element[i]);
            all.rows.coefficient.push(constraints.rows.coefficient[i]);
            all.stiffness.push(delta);
            all.base.push(0.0);
        }
    }
    all
}

/// Takes the points marked soft out of the LCP's; none is if there are no marks.
fn split(constraints: Constraints, soft: &[bool]) -> (Constraints, SoftPoints, PointOrder) {
    let mut hard = Constraints { free_motions: constraints.free_motions, ..Constraints::default() };
    let mut taken = SoftPoints::default();
    let mut order = PointOrder::default();
    for (i, &coefficient) in constraints.rows.coefficient.iter().enumerate() {
        if soft.get(i) == Some(&true) {
            taken.element.push(constraints.rows.element[i]);
            taken.value.push(std::array::from_fn(|node| coefficient[3 * node]));
            taken.stiffness.push(1.0 / constraints.compliance[i]);
            taken.distance.push(constraints.distance[i]);
            order.soft.push(i);
        } else {
            hard.rows.element.push(constraints.rows.element[i]);
            hard.rows.coefficient.push(coefficient);
            hard.distance.push(constraints.distance[i]);
            hard.compliance.push(constraints.compliance[i]);
            hard.two_sided.push(constraints.two_sided[i]);
            hard.regularization.push(constraints.regularization[i]);
            order.hard.push(i);
        }
    }
    (hard, taken, order)
}
