//! Elimination of the points: what the factor of K contains besides the plate.

use super::graph::Piece;
use super::interface::{Interface, LcpTemplate};
use super::points::Points;
use super::scale::Scale;
use super::tolerances;
use crate::element::packed;
use crate::plate::Plate;
use std::sync::{Arc, OnceLock};

/// The method for which the plate is factored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Lemke's algorithm: all points are condensed; for few points.
    Lemke,
    /// The semismooth Newton method: any number of points, springs in the factor.
    ActiveSet,
    /// The semismooth Newton method on the saddle-point system: the force of each point is an unknown of the factor.
    /// Springs may be nearly as stiff as rigid supports, so that nearly dependent points keep their digits.
    Saddle,
}

/// The factored plate of each method.
#[derive(Clone)]
pub(super) enum Backend {
    /// K with the stiffness δ of some points; all points are condensed. The LCP of each form is made on demand.
    Condensed { interface: Arc<Interface>, templates: Arc<[OnceLock<LcpTemplate>; 2]> },
    /// K with springs at the points.
    Penalised(Arc<Augmentation>),
    /// K with the forces of all points as unknowns.
    SaddlePoint(Arc<Augmentation>),
}

/// Compliances in series with stiff points: the augmented Lagrangian of the Newton method.
pub(super) struct Augmentation {
    /// Stiffness of the plate at each point (m,), to which penalties are relative.
    stiffness: Vec<f64>,
    /// First penalty of the Newton method.
    pub(super) first_penalty: f64,
}

impl Augmentation {
    /// Penalties relative to the shear stiffness of the elements; the first one bends the plate over many elements, so
    /// that the contact state settles in few steps.
    pub(super) fn of_penalties(plate: &Plate, points: &Points) -> Self {
        let mut new = Self { stiffness: shear_at(plate, points), first_penalty: tolerances::newton::STIFFEST };
        let slenderness = |e: usize| plate.thickness.first(plate.kind, e) / plate.geometry(e).size();
        let thinnest = points.least_at(slenderness);
        let limit = f64::min(tolerances::newton::LONG_WAVE * thinnest * thinnest, 1.0);
        let softened = new.series(points, limit);
        if !(0..points.len()).all(|i| points.is_straight(i) || softened[i] == 0.0) {
            new.first_penalty = limit;
        }
        new
    }

    /// Compliances of the saddle-point system, relative to the compliance of the plate.
    pub(super) fn of_saddle_point(points: &Points, scale: &Scale) -> Self {
        let stiffest = scale.stiffness / (tolerances::COMPLIANCE * tolerances::newton::STIFFEST);
        let stiffness = points.arm.iter().map(|arm| stiffest * arm * arm).collect();
        Self { stiffness, first_penalty: tolerances::newton::STIFFEST }
    }

    /// The penalty of the next stage of the Newton method: three stages in geometric progression.
    pub(super) fn next_penalty(&self, penalty: f64) -> f64 {
        let stiffest = tolerances::newton::STIFFEST;
        if penalty == self.first_penalty { (penalty * stiffest).sqrt() } else { stiffest }
    }

    /// Compliance σ in series with each point (m,), so that none is stiffer than the penalty times the stiffness of the
    /// plate. A point with a linear law has the largest penalty from the start.
    pub(super) fn series(&self, points: &Points, penalty: f64) -> Vec<f64> {
        let of = |i: usize| {
            let penalty = if points.is_straight(i) { tolerances::newton::STIFFEST } else { penalty };
            let least = 1.0 / (penalty * self.stiffness[i]);
            if points.steepest(i).compliance() < least { least } else { 0.0 }
        };
        (0..points.len()).map(of).collect()
    }

    /// Stiffness (m,) of all points on given pieces, in series with σ of a penalty.
    pub(super) fn slopes(&self, points: &Points, piece: impl Fn(usize) -> Piece, penalty: f64) -> Vec<f64> {
        let series = self.series(points, penalty);
        (0..points.len()).map(|i| piece(i).in_series(series[i])).collect()
    }
}

/// Largest diagonal stiffness of an element at the dofs of each row of G.
fn shear_at(plate: &Plate, points: &Points) -> Vec<f64> {
    let mut largest = vec![0.0_f64; plate.dof_count()];
    for e in 0..plate.elements().len() {
        let lower = plate.element_stiffness(e);
        for (local, node) in plate.leading(e).iter().enumerate() {
            for k in 0..3 {
                let at = packed(3 * local + k, 3 * local + k);
                largest[3 * node + k] = largest[3 * node + k].max(lower[at]);
            }
        }
    }
    let of = |i: usize| points.row(i).fold(0.0, |most: f64, (dof, _)| most.max(largest[dof]));
    (0..points.len()).map(of).collect()
}
