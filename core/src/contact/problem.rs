//! A plate on its supports, factored once.

use super::graph::Piece;
use super::interface::Interface;
use super::points::Points;
use super::rigid::nearest_motions;
use super::rigid_body_space::RigidBodySpace;
use super::scale::Scale;
use super::solution::ContactSolution;
use super::system::{KktPattern, System};
use super::tolerances;
use crate::cholesky::FactorError;
use crate::displacement::Displacement;
use crate::double_double::DoubleDouble;
use crate::element::{Kind, packed};
use crate::plate::Plate;
use crate::rows::Springs;
use std::sync::Arc;
use std::time::Instant;

/// Seconds of each stage.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seconds {
    pub order: f64,
    pub factor: f64,
    pub condense: f64,
}

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

/// Input of a contact problem.
pub struct Supported {
    pub springs: Springs,
    /// Whether each dof has a prescribed value (3n,).
    pub held: Vec<bool>,
    pub points: Points,
    /// Stiffness δ (m,) that the factor includes at condensed points, so that it is regular; 0 for most.
    pub delta: Vec<f64>,
    /// Rigid motions (3n,) that springs, held dofs and two-sided points leave free.
    pub free_motions: Vec<Vec<f64>>,
}

/// A plate on its supports, factored once.
#[derive(Clone)]
pub struct ContactProblem {
    pub plate: Arc<Plate>,
    pub springs: Springs,
    pub held: Vec<bool>,
    pub points: Points,
    pub seconds: Seconds,
    pub(super) method: Method,
    pub(super) delta: Vec<f64>,
    pub(super) free_motions: Vec<Vec<f64>>,
    pub(super) scale: Scale,
    pub(super) pattern: Arc<KktPattern>,
    pub(super) base: Arc<System>,
    /// The condensed plate; `None` for the Newton method.
    pub(super) interface: Option<Arc<Interface>>,
    /// Shear stiffness of the plate at each point; empty where points are condensed.
    shear: Vec<f64>,
    /// First penalty of the Newton method.
    pub(super) first_penalty: f64,
    /// Rigid motions of plates without held dofs.
    pub(super) rigid_space: Option<Arc<RigidBodySpace>>,
    /// Relative shift of the diagonal in every factor.
    diagonal_shift: f64,
}

impl ContactProblem {
    /// Orders, factors and condenses. A factor of more than `room` bytes is refused before it is begun.
    pub fn new(plate: Arc<Plate>, on: Supported, method: Method, room: usize) -> Result<Self, FactorError> {
        let Supported { springs, held, mut points, delta, free_motions } = on;
        let clock = Instant::now();
        let scale = Scale::of(&plate);
        points.set_arm(scale.size);
        let condensed = method == Method::Lemke;
        let mut trailing = vec![false; plate.dof_count()];
        let last = (0..points.len()).filter(|&i| condensed && points.is_narrow(i));
        last.flat_map(|i| points.row(i)).for_each(|(dof, _)| trailing[dof] = true);
        let is_multiplier_row = |i: usize| match method {
            Method::Lemke => delta[i] > 0.0 && !points.is_bedding(i),
            Method::ActiveSet => !points.is_bedding(i),
            Method::Saddle => true,
        };
        let pattern = Arc::new(KktPattern::new(&plate, &held, &springs, &points, &trailing, is_multiplier_row));
        let order = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let (mut shear, mut first_penalty) = (Vec::new(), tolerances::newton::STIFFEST);
        let mut carried = delta.clone();
        if !condensed {
            if method == Method::ActiveSet {
                shear = shear_at(&plate, &points);
                first_penalty = initial_penalty(&plate, &points, &shear);
            } else {
                let stiffest = scale.stiffness / (tolerances::COMPLIANCE * tolerances::newton::STIFFEST);
                shear = points.arm.iter().map(|arm| stiffest * arm * arm).collect();
            }
            let series = series(&points, &shear, first_penalty);
            carried = (0..points.len()).map(|i| steepest(&points, i).in_series(series[i])).collect();
        }
        let rigid_space = RigidBodySpace::on(&plate, &held, &scale, &points, &springs).map(Arc::new);
        let softest = rigid_space.as_ref().map(|rigid_space| rigid_space.softest(|i| carried[i], &springs.stiffness));
        // Springs as stiff as the plate need no diagonal shift.
        let diagonal_shift =
            softest.filter(|&softest| softest < scale.stiffness).map_or(0.0, |softest| needed_shift(&plate, softest));
        let base = Arc::new(pattern.factored(&plate, &springs, &points, carried, diagonal_shift, room)?);
        let factor = clock.elapsed().as_secs_f64();

        let clock = Instant::now();
        let interface = if condensed {
            let moves = |motion: &Vec<f64>| (0..points.len()).map(|i| points.dot(i, motion)).collect();
            let moves: Vec<Vec<f64>> = free_motions.iter().map(moves).collect();
            let (rows, multiplier_rows) = (pattern.rows(&points), pattern.multiplier_rows(plate.dof_count()));
            let last = pattern.numbering.trailing;
            Some(Arc::new(Interface::on(&base.factor, last, &rows, &multiplier_rows, delta.clone(), &moves)?))
        } else {
            None
        };
        let seconds = Seconds { order, factor, condense: clock.elapsed().as_secs_f64() };
        Ok(Self {
            plate,
            springs,
            held,
            points,
            seconds,
            method,
            delta,
            free_motions,
            scale,
            pattern,
            base,
            interface,
            shear,
            first_penalty,
            rigid_space,
            diagonal_shift,
        })
    }

    /// The same problem with other shifts (m,) of its points. It shares the factor.
    pub fn with_shift(&self, shift: Vec<f64>) -> Self {
        let mut moved = self.clone();
        moved.points.shift = shift;
        moved
    }

    /// K̃⁻¹ times a nodal load.
    pub fn apply_inverse(&self, load: &[f64]) -> Result<Vec<f64>, FactorError> {
        self.base.solve(load)
    }

    /// Number of entries of the factor, and of its multiplications and additions.
    pub fn factor_size(&self) -> (usize, f64) {
        (self.base.factor.entries(), self.base.factor.flops())
    }

    pub fn is_condensed(&self) -> bool {
        self.interface.is_some()
    }

    pub(super) fn interface(&self) -> &Interface {
        self.interface.as_ref().expect("the points are condensed")
    }

    /// The plate without load: held dofs at their values, and each plate moved by the nearest rigid motion, which
    /// strains it least.
    pub(super) fn at_rest(&self, held_value: &[f64]) -> ContactSolution {
        let mut displacement = self.carried_along(held_value);
        for dof in (0..self.held.len()).filter(|&dof| self.held[dof]) {
            (displacement.hi[dof], displacement.lo[dof]) = (held_value[dof], 0.0);
        }
        displacement.follow(self.plate.bodies());
        let none = vec![0.0; self.points.len()];
        let piece = self.points.first_pieces();
        ContactSolution { displacement, reaction: none.clone(), gap: none, piece, ..ContactSolution::default() }
    }

    /// The rigid motions nearest to the prescribed values. Two passes, so that only the straining part is missing.
    fn carried_along(&self, held_value: &[f64]) -> Displacement {
        let mut displacement = Displacement::zeros(self.plate.dof_count());
        for _ in 0..2 {
            let missed = self.missed(held_value, &displacement);
            let Some(motions) = nearest_motions(&self.plate, &self.scale, &self.held, &missed) else { break };
            displacement.add_rigid(&self.plate, self.scale.centre, &motions);
        }
        displacement
    }

    /// Prescribed values minus these rigid motions.
    pub(super) fn strained(&self, held_value: &[f64]) -> Vec<f64> {
        self.missed(held_value, &self.carried_along(held_value))
    }

    fn missed(&self, held_value: &[f64], displacement: &Displacement) -> Vec<f64> {
        let of = |dof: usize| (DoubleDouble::from(held_value[dof]) - displacement.at(dof)).value();
        (0..self.held.len()).map(|dof| if self.held[dof] { of(dof) } else { 0.0 }).collect()
    }

    /// The factor with other springs at the points.
    pub(super) fn factored(&self, carried: Vec<f64>) -> Result<System, FactorError> {
        let Self { plate, springs, points, .. } = self;
        self.pattern.factored(plate, springs, points, carried, self.diagonal_shift, usize::MAX)
    }

    /// Compliance in series with every point so that none is stiffer than a limit.
    pub(super) fn series(&self, limit: f64) -> Vec<f64> {
        series(&self.points, &self.shear, limit)
    }

    /// The penalty after a stage of the Newton method: there are three, in geometric progression.
    pub(super) fn next_penalty(&self, limit: f64) -> f64 {
        let stiffest = tolerances::newton::STIFFEST;
        if limit == self.first_penalty { (limit * stiffest).sqrt() } else { stiffest }
    }

    pub(super) fn steepest(&self, i: usize) -> Piece {
        steepest(&self.points, i)
    }

    pub(super) fn steepest_pieces(&self) -> Vec<u8> {
        (0..self.points.len()).map(|i| self.points.graph(i).steepest()).collect()
    }

    /// Sets a nodal vector to zero at held dofs.
    pub(super) fn release_held(&self, vector: &mut [f64]) {
        for (value, _) in vector.iter_mut().zip(&self.held).filter(|(_, held)| **held) {
            *value = 0.0;
        }
    }
}

fn steepest(points: &Points, i: usize) -> Piece {
    points.piece(i, points.graph(i).steepest())
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

/// Compliance σ in series with each point, so that none is stiffer than the penalty times the shear stiffness of the
/// plate. A point with a linear law has the largest penalty from the start.
fn series(points: &Points, shear: &[f64], limit: f64) -> Vec<f64> {
    let of = |i: usize| {
        let limit = if points.is_straight(i) { tolerances::newton::STIFFEST } else { limit };
        let least = 1.0 / (limit * shear[i]);
        if steepest(points, i).compliance() < least { least } else { 0.0 }
    };
    (0..points.len()).map(of).collect()
}

/// First penalty of the Newton method: springs that bend the plate over many elements find the contact state in few
/// steps.
fn initial_penalty(plate: &Plate, points: &Points, shear: &[f64]) -> f64 {
    let slenderness = |e: usize| plate.thickness.first(plate.kind, e) / plate.geometry(e).size();
    let thinnest = points.least_at(slenderness);
    let limit = f64::min(tolerances::newton::LONG_WAVE * thinnest * thinnest, 1.0);
    let softened = series(points, shear, limit);
    let all_softer = (0..points.len()).all(|i| points.is_straight(i) || softened[i] == 0.0);
    if all_softer { tolerances::newton::STIFFEST } else { limit }
}

/// Relative diagonal shift where springs alone hold the plate, from the softest projected stiffness; 0 where that is
/// above the rounding of the factor. Iterative refinement removes its effect.
fn needed_shift(plate: &Plate, softest: f64) -> f64 {
    let diagonal = |e: usize| (0..8).map(|node| plate.element_stiffness(e)[packed(3 * node, 3 * node)]).sum::<f64>();
    let all: f64 = (0..plate.elements().len()).map(diagonal).sum();
    let added = tolerances::DIAGONAL_SHIFT * all;
    if plate.kind == Kind::Mitc9 && softest < tolerances::SHIFT_BELOW * added {
        tolerances::DIAGONAL_SHIFT
    } else {
        0.0
    }
}
