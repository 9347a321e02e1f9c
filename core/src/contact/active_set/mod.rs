//! One-sided points in any number: a semismooth Newton method on the sparse K (a primal–dual active set; Hintermüller,
//! Ito & Kunisch 2002), inside the method of multipliers (Rockafellar 1976) where supports are rigid or nearly so.
//!
//! It cannot cycle: for given multipliers the energy is convex and continuously differentiable, every Newton direction
//! is followed by an exact line search on it, and the multipliers are a proximal point iteration on the dual. Rigid
//! points begin on springs that bend the plate over many elements, and stiffen from stage to stage.
//! One factor, of K with the points closed that are expected to be, preconditions every direction; only where the set
//! turns out to be quite another one is it factored anew.

mod descent;
mod drift;
mod line_search;
mod newton;
mod together;

use super::kkt::{ActiveFactor, Residual};
use super::points::ActivePoints;
use super::problem::ContactProblem;
use super::solution::{ContactSolution, Outcome, Progress, Reference, Start};
use crate::cholesky::FactorError;
use crate::contact::tolerances;
use crate::plate::Plate;
use descent::{Afloat, Descent};
use newton::{Newton, Next};

impl ContactProblem {
    /// The limit that the active set begins with: springs that bend the plate over many elements find the set in few
    /// steps.
    pub(super) fn first_limit(plate: &Plate, points: &ActivePoints) -> f64 {
        if points.is_empty() {
            return tolerances::newton::STIFFEST;
        }
        let slenderness = |e: usize| plate.thickness.first(plate.kind, e) / plate.geometry(e).size();
        let thinnest = points.element.iter().map(|&e| slenderness(e)).fold(f64::INFINITY, f64::min);
        let limit = f64::min(tolerances::newton::LONG_WAVE * thinnest * thinnest, 1.0);
        let all_softer = points.penalized(limit).series.iter().all(|&s| s == 0.0);
        if all_softer { tolerances::newton::STIFFEST } else { limit }
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
            return Ok(self.unanswered(held_value, Outcome::Unsolved));
        };
        let Next::End(outcome) = newton.go_on(None, watch)? else { unreachable!("the factor is not shared") };
        let fell_short = newton.fell_short;
        let found = newton.ended(outcome);
        if !fell_short {
            return Ok(found);
        }
        let exact = self.solve_on(load, held_value, &found.closed)?;
        let (reaction, gap) = (self.in_place(&exact.reaction), self.in_place(&exact.gap));
        let in_place = ContactSolution { reaction, gap, ..exact.clone() };
        if exact.outcome != Outcome::Solved || !self.signs_hold(load, 0.0, &in_place) {
            return Ok(found);
        }
        let ContactSolution { iterations, gradients, factorizations, .. } = found;
        let corrections = found.corrections + exact.corrections;
        Ok(ContactSolution { iterations, gradients, factorizations, corrections, ..exact })
    }

    /// Newton's method at its start, on a factor that others may share; `None` if two-sided points contradict each other.
    fn newton<'a>(
        &'a self,
        load: &'a [f64],
        held_value: &[f64],
        start: Option<&Start<'a>>,
        shares: bool,
    ) -> Result<Option<Newton<'a>>, FactorError> {
        let limit = if start.is_some() { tolerances::newton::STIFFEST } else { self.first_limit };
        let given = start.and_then(|start| start.factored).unwrap_or(&self.base);
        let Some(factor) = ActiveFactor::of(self, given, limit, shares)? else {
            return Ok(None);
        };
        let mut solution = self.at_rest(held_value);
        let mut multiplier = vec![0.0; self.active.len()];
        if let Some(Start { solution: start, .. }) = start {
            solution.displacement.hi.copy_from_slice(&start.displacement.hi);
            for (multiplier, &i) in multiplier.iter_mut().zip(&self.order.active) {
                *multiplier = if start.closed[i] { start.reaction[i] } else { 0.0 };
            }
        }
        let mut descent = Descent {
            problem: self,
            load,
            factor,
            solution,
            stretch: vec![0.0; multiplier.len()],
            multiplier,
            residual: Residual::default(),
            afloat: Afloat::under(self, load),
            rounding: Some(0.0),
        };
        match start.and_then(|start| start.reference) {
            Some(reference) if self.constraints.rows.is_empty() => descent.depart(reference),
            _ => descent.refine()?,
        }
        Ok(Some(Newton::new(descent, start.is_some())))
    }

    /// As [`ContactProblem::solve`], beginning with the solution of another load.
    pub fn solve_near(
        &self,
        reference: &Reference,
        load: &[f64],
        held_value: &[f64],
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        self.solve_active(load, held_value, Some(&reference.start()), watch)
    }

    /// Solves one load and factors the contact set found; `None` where there is no active set, no solution, or the set
    /// does not hold the plate. `watch` as for [`ContactProblem::solve`].
    pub fn reference(
        &self,
        load: &[f64],
        held_value: &[f64],
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Option<Reference>, FactorError> {
        let solution = self.solve(load, held_value, None, watch)?;
        if self.active.is_empty() || solution.outcome != Outcome::Solved {
            return Ok(None);
        }
        let stiffness = self.active.penalized(tolerances::newton::STIFFEST).stiffness;
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
