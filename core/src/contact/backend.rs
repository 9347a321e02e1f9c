//! The methods that find the contact state, the factored stiffness matrix that each method needs, and the penalties of
//! the Newton method.

use super::graph::Piece;
use super::interface::{Interface, LcpTemplate};
use super::points::Points;
use super::scale::Scale;
use super::tolerances;
use crate::element::packed;
use crate::plate::Plate;
use std::sync::{Arc, OnceLock};

/// The method that finds the contact state. Each method needs another factored stiffness matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Lemke's algorithm, for few contact points: the stiffness matrix is condensed onto the contact points.
    Lemke,
    /// The semismooth Newton method, for any number of contact points: the factored matrix includes a spring at each
    /// contact point.
    ActiveSet,
    /// The semismooth Newton method on the saddle-point system: the force of each contact point is an unknown of the
    /// factored matrix. Springs may be nearly as stiff as rigid supports: the forces of points with nearly dependent
    /// rows of G then keep their digits.
    Saddle,
}

/// The factored stiffness matrix that a method needs.
#[derive(Clone)]
pub(super) enum Backend {
    /// Factor of K̃ = K + Gᵀ diag(δ) G, condensed onto all contact points; δ are spring stiffnesses of the points.
    /// `templates` holds the LCP in stiffness and in dual form; each is made when it is first needed.
    Condensed { interface: Arc<Interface>, templates: Arc<[OnceLock<LcpTemplate>; 2]> },
    /// Factor of K with a spring at each contact point.
    Penalised(Arc<Augmentation>),
    /// Factor of the saddle-point system, in which the forces of all contact points are unknowns.
    SaddlePoint(Arc<Augmentation>),
}

/// The augmented Lagrangian of the Newton method: each stiff contact point has an augmentation compliance σ in series.
pub(super) struct Augmentation {
    /// Reference stiffness (m,) of the plate at each contact point; σ = 1/(penalty · reference stiffness).
    stiffness: Vec<f64>,
    /// Penalty of the first stage of the Newton method.
    pub(super) first_penalty: f64,
}

impl Augmentation {
    /// Makes the augmentation with the shear stiffness of the elements as reference stiffness. The first penalty is so
    /// small that contact forces bend the plate over many elements; the contact state then settles in few steps.
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

    /// Makes the augmentation for the saddle-point system. At the largest penalty σ is `COMPLIANCE` times the
    /// compliance of the plate.
    pub(super) fn of_saddle_point(points: &Points, scale: &Scale) -> Self {
        let stiffest = scale.stiffness / (tolerances::COMPLIANCE * tolerances::newton::STIFFEST);
        let stiffness = points.arm.iter().map(|arm| stiffest * arm * arm).collect();
        Self { stiffness, first_penalty: tolerances::newton::STIFFEST }
    }

    /// The penalty of the stage that follows the stage with `penalty`. The penalties of the three stages are a
    /// geometric progression.
    pub(super) fn next_penalty(&self, penalty: f64) -> f64 {
        let stiffest = tolerances::newton::STIFFEST;
        if penalty == self.first_penalty { (penalty * stiffest).sqrt() } else { stiffest }
    }

    /// Augmentation compliance σ (m,) of each contact point: 1/σ is the penalty times the reference stiffness. Points
    /// softer than 1/σ have σ = 0. Points with a linear law have the largest penalty from the start.
    pub(super) fn series(&self, points: &Points, penalty: f64) -> Vec<f64> {
        let of = |i: usize| {
            let penalty = if points.is_straight(i) { tolerances::newton::STIFFEST } else { penalty };
            let least = 1.0 / (penalty * self.stiffness[i]);
            if points.steepest(i).compliance() < least { least } else { 0.0 }
        };
        (0..points.len()).map(of).collect()
    }

    /// Stiffness (m,) of each contact point on the piece `piece(i)` of its law, in series with the augmentation
    /// compliance σ for `penalty`.
    pub(super) fn slopes(&self, points: &Points, piece: impl Fn(usize) -> Piece, penalty: f64) -> Vec<f64> {
        let series = self.series(points, penalty);
        (0..points.len()).map(|i| piece(i).in_series(series[i])).collect()
    }
}

/// For each row of G (m,), the largest diagonal entry of an element stiffness matrix at a dof of the row.
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
