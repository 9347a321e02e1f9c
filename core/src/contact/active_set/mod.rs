//! One-sided points in any number: a semismooth Newton method on the sparse K (a primal–dual active set; Hintermüller,
//! Ito & Kunisch 2002), inside the method of multipliers (Rockafellar 1976) where supports are rigid or nearly so.
//!
//! It cannot cycle: for given multipliers the energy is convex and continuously differentiable, every Newton direction
//! is followed by an exact line search on it, and the multipliers are a proximal point iteration on the dual. Rigid
//! points begin on springs that bend the plate over many elements, and stiffen from stage to stage.
//! One factor, of K with the points closed that are expected to be, preconditions every direction; only where the set
//! turns out to be quite another one is it factored anew.

mod descent;
mod direction;
mod fixed;
mod floating;
mod line_search;
mod newton;
mod points;
mod push;
mod together;

pub use points::{ActivePoints, Softened};

use super::problem::{ContactProblem, Factored};
use super::refinement::Step;
use super::solution::{ContactSolution, Outcome};
use crate::cholesky::FactorError;
use crate::plate::Plate;
use descent::Descent;
use floating::Floating;
use newton::Newton;

/// One Newton step, to whoever watches.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    pub step: usize,
    /// Points that have opened or closed since the step before.
    pub changing: usize,
    /// Largest imbalance over the largest nodal force.
    pub residual: f64,
}

/// Stiffest springs that rigid points act through, over the plate's stiffness in shear: at the end, where multipliers
/// converge the faster the stiffer they are, and how much stiffer they become from stage to stage.
const STIFFEST: f64 = 1e4;
const STIFFER: f64 = 10.0;
/// Bending stiffness over that in shear of a wave of ten elements, over the square of thickness over element size.
const LONG_WAVE: f64 = 0.04;
/// At most this many Newton steps.
const NEWTON: usize = 500;
/// What conjugate gradients leave of the imbalance, while the set still changes and when it does not.
const LOOSE: f64 = 0.3;
/// Instead of the first after so many steps without the set settling: true Newton directions then need fewer.
const FIRM: f64 = 1e-3;
const PATIENT: usize = 8;
const TIGHT: f64 = 1e-8;
/// Imbalance, over the largest nodal force, at which the points are settled.
const SETTLED: f64 = 1e-13;
/// Times that imbalance from which points are looked at anew although some still change sides.
const NEARLY: f64 = 1e3;
/// Steps on one set that leave this part of the imbalance, one after another, that end it: what is left is rounding.
const SLOW: f64 = 0.8;
const STALLS: usize = 3;
/// So many on unchanged sets without a new least imbalance, up and down, end it as well.
const LASTING: usize = 12;
/// What rounding leaves at most, in the thinnest plates; where it stalls above, supports contradict each other.
const ROUNDING: f64 = 1e-3;
/// Imbalance, over the largest nodal force, up to which multipliers are renewed.
const BALANCED: f64 = 1e-3;
/// Change of the multipliers, over the largest force, at which the next stage begins.
const STEADY: f64 = 5e-2;

/// Where to begin: displacements over all dofs, reactions and states in the caller's order, and a factor, if not the
/// problem's own.
pub(super) struct Start<'a> {
    pub displacement: &'a [f64],
    pub reaction: &'a [f64],
    pub closed: &'a [bool],
    pub factored: Option<&'a Factored>,
    pub balanced: Option<Balanced<'a>>,
}

/// The load that a start is the solution of, the low-order part of its displacement, and how far the points overlap in it.
#[derive(Clone, Copy)]
pub(super) struct Balanced<'a> {
    load: &'a [f64],
    low: &'a [f64],
    overlap: &'a [f64],
}

/// One load's solution and the factor of its contact set, for loads not unlike it to begin with.
pub struct Reference {
    pub solution: ContactSolution,
    factored: Factored,
    load: Vec<f64>,
    overlap: Vec<f64>,
}

impl Reference {
    pub(super) fn start(&self) -> Start<'_> {
        Start {
            displacement: &self.solution.displacement.hi,
            reaction: &self.solution.reaction,
            closed: &self.solution.closed,
            factored: Some(&self.factored),
            balanced: Some(Balanced { load: &self.load, low: &self.solution.displacement.lo, overlap: &self.overlap }),
        }
    }
}

impl ContactProblem {
    /// The limit that the active set begins with: springs that bend the plate over many elements find the set in few
    /// steps.
    pub(super) fn first_limit(plate: &Plate, points: &ActivePoints) -> f64 {
        if points.is_empty() {
            return STIFFEST;
        }
        let slenderness = |e: usize| {
            let geometry = plate.geometry(e);
            let size = geometry.at.iter().flatten().fold(0.0, |most: f64, x| most.max(x.abs()));
            plate.thickness.first(plate.kind, e) / size
        };
        let thinnest = points.element.iter().map(|&e| slenderness(e)).fold(f64::INFINITY, f64::min);
        let limit = f64::min(LONG_WAVE * thinnest * thinnest, 1.0);
        let all_softer = points.softened(limit).softening.iter().all(|&s| s == 0.0);
        if all_softer { STIFFEST } else { limit }
    }

    /// Displacements, reactions and gaps under one load, beginning with those of a start if there is one; `watch` may
    /// stop it by returning false.
    pub(super) fn solve_active(
        &self,
        load: &[f64],
        held_value: &[f64],
        start: Option<&Start<'_>>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        let Some(mut newton) = self.newton(load, held_value, start, false)? else {
            return Ok(self.without_solution(held_value, Outcome::Unsolved));
        };
        let outcome = newton.run(watch)?;
        Ok(newton.ended(outcome))
    }

    /// Newton's method at its start, on a factor that others may share; `None` if two-sided points contradict each other.
    fn newton<'a>(
        &'a self,
        load: &'a [f64],
        held_value: &[f64],
        start: Option<&Start<'a>>,
        shares: bool,
    ) -> Result<Option<Newton<'a>>, FactorError> {
        let mut solution = self.at_rest(load.len(), held_value);
        let given = start.and_then(|start| start.factored).unwrap_or(&self.base);
        let Some(state) = given.condensed.state(self.constraints.two_sided.clone()) else {
            return Ok(None);
        };
        solution.closed.clone_from(&self.constraints.two_sided);
        let mut multiplier = vec![0.0; self.active.len()];
        if let Some(start) = start {
            solution.displacement.hi.copy_from_slice(start.displacement);
            for (multiplier, &i) in multiplier.iter_mut().zip(&self.order.active) {
                *multiplier = if start.closed[i] { start.reaction[i] } else { 0.0 };
            }
        }
        let limit = if start.is_some() { STIFFEST } else { self.first_limit };
        let mut descent = Descent {
            problem: self,
            load,
            given,
            limit,
            springs: self.active.softened(limit),
            own: None,
            shares,
            state,
            solution,
            stretch: vec![0.0; multiplier.len()],
            multiplier,
            step: Step::default(),
            imposed: None,
            floating: Floating::of(self, load),
            rounding: 0.0,
        };
        match start.and_then(|start| start.balanced) {
            Some(balanced) if self.constraints.rows.is_empty() => descent.depart(balanced),
            _ => descent.refine()?,
        }
        Ok(Some(Newton::new(descent, start.is_some())))
    }
}

impl ContactProblem {
    /// Solves one load and factors the contact set found; `None` where there is no active set, no solution, or the set
    /// does not hold the plate.
    pub fn reference(&self, load: &[f64], held_value: &[f64]) -> Result<Option<Reference>, FactorError> {
        let solution = self.solve(load, held_value, None, None, &mut |_| true)?;
        if self.active.is_empty() || solution.outcome != Outcome::Solved {
            return Ok(None);
        }
        let stiffness = self.active.softened(STIFFEST).stiffness;
        let closed = self.order.active.iter().map(|&i| solution.closed[i]);
        let carried = stiffness.iter().zip(closed).map(|(&k, closed)| if closed { k } else { 0.0 }).collect();
        match self.refactored(carried) {
            Ok(factored) => {
                let overlap = self.active.overlap(&self.plate, &solution.displacement);
                Ok(Some(Reference { solution, factored, load: load.to_vec(), overlap }))
            }
            Err(FactorError::NotPositiveDefinite { .. }) => Ok(None),
            Err(error) => Err(error),
        }
    }
}
