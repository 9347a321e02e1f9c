//! Corrections of a solution in one contact state, by the double-double residual and the factor at hand.

use super::condense::{ContactState, Form, InterfaceResidual};
use super::problem::{ContactProblem, Factored};
use super::solution::ContactSolution;
use crate::cholesky::FactorError;
use crate::contact::tolerances;

/// At most this many corrections with one contact state.
const CORRECTIONS: usize = 8;

/// What is out of balance and what is left of the gaps.
#[derive(Clone, Default)]
pub(super) struct Residual {
    pub(super) imbalance: Vec<f64>,
    pub(super) remaining: Vec<f64>,
    pub(super) worst: f64,
    /// Work of the load in each free rigid motion, and the sum of the magnitudes it is made of.
    pub(super) work: Vec<f64>,
    pub(super) work_size: Vec<f64>,
}

/// An imbalance after forward substitution, and what it does at the contact points.
pub(super) struct Reduced {
    forward: Vec<f64>,
    pub(super) interface: InterfaceResidual,
}

impl ContactProblem {
    /// Corrects with one contact state for as long as the imbalance, or what is left of closed gaps, shrinks.
    pub(super) fn refine(
        &self,
        load: &[f64],
        state: &ContactState,
        mut step: Residual,
        reduced: Reduced,
        solution: &mut ContactSolution,
    ) -> Result<Residual, FactorError> {
        let mut reduced = Some(reduced);
        let mut first = true;
        for _ in 0..CORRECTIONS {
            let now = match reduced.take() {
                Some(reduced) => reduced,
                None => self.reduced(&self.base, &step, self.base.condensed.better_form())?,
            };
            let before = solution.clone();
            self.correct(&self.base, state, now, solution)?;
            let next = self.residual(load, solution);
            let (left_before, left) = (self.left_open(&step, solution), self.left_open(&next, solution));
            let closer = left < tolerances::PROGRESS * left_before;
            if !(first || next.worst < step.worst || closer) {
                *solution = before;
                return Ok(step);
            }
            let ended = !first && next.worst > tolerances::PROGRESS * step.worst && !closer;
            first = false;
            step = next;
            if ended || (left == 0.0 && step.worst <= tolerances::RESIDUAL * self.largest_force(load, solution)) {
                break;
            }
        }
        Ok(step)
    }

    /// What is left of closed gaps; 0 where that is rounding of the largest deflection or of the point's own travel.
    fn left_open(&self, step: &Residual, solution: &ContactSolution) -> f64 {
        let lengths = self.lengths(solution);
        let closed = (0..lengths.len()).filter(|&i| solution.closed[i]);
        let open = closed.filter(|&i| step.remaining[i].abs() > tolerances::RESIDUAL * lengths[i]);
        open.map(|i| step.remaining[i].abs()).fold(0.0, f64::max)
    }

    /// What a gap is measured by at each point, the largest deflection or its own travel: a stop far away says nothing
    /// of what happens at others.
    pub(super) fn lengths(&self, solution: &ContactSolution) -> Vec<f64> {
        let deflection = solution.displacement.hi.iter().step_by(3).fold(0.0, |size: f64, w| size.max(w.abs()));
        self.constraints.distance.iter().map(|travel| deflection.max(travel.abs())).collect()
    }

    /// One correction: the state's increments of reaction, the gaps they leave, and the motion that goes with them.
    pub(super) fn correct(
        &self,
        with: &Factored,
        state: &ContactState,
        reduced: Reduced,
        solution: &mut ContactSolution,
    ) -> Result<(), FactorError> {
        let (nodal, reaction) = self.respond(with, state, reduced)?;
        for (dof, value) in nodal.into_iter().enumerate() {
            solution.displacement.add(dof, value);
        }
        for (total, increment) in solution.reaction.iter_mut().zip(&reaction) {
            *total += increment;
        }
        solution.corrections += 1;
        Ok(())
    }

    /// Motion of the plate and increments of the reactions in one contact state.
    pub(super) fn respond(
        &self,
        with: &Factored,
        state: &ContactState,
        reduced: Reduced,
    ) -> Result<(Vec<f64>, Vec<f64>), FactorError> {
        let Reduced { mut forward, interface } = reduced;
        let leading = forward.len() - self.numbering.trailing;
        let mut reaction = Vec::new();
        if !with.condensed.is_empty() {
            let response = with.condensed.solve_state(state, &interface);
            if with.condensed.better_form() == Form::Stiffness {
                forward[leading..].copy_from_slice(&with.condensed.prescribing(&response.moved));
            } else {
                let carried = with.condensed.regularization.iter().zip(&response.moved).map(|(d, y)| d * y);
                let push: Vec<f64> = carried.zip(&response.reaction).map(|(c, r)| c - r).collect();
                let ahead = with.condensed.forwarded(&push);
                forward[leading..].iter_mut().zip(&ahead).for_each(|(total, push)| *total += push);
            }
            reaction = response.reaction;
        }
        with.factor.backward(&mut forward)?;
        Ok((self.scatter(&forward), reaction))
    }

    pub(super) fn residual(&self, load: &[f64], solution: &ContactSolution) -> Residual {
        self.residual_of(self.imbalance(load, &solution.displacement, &solution.reaction), load, solution)
    }

    /// The residual from what is out of balance at every dof, those held included.
    pub(super) fn residual_of(&self, mut imbalance: Vec<f64>, load: &[f64], solution: &ContactSolution) -> Residual {
        self.release_held(&mut imbalance);
        let worst = imbalance.iter().fold(0.0, |worst: f64, value| worst.max(value.abs()));
        let (work, work_size) = self.works(load);
        let remaining = self.remaining(&solution.displacement, &solution.reaction);
        Residual { imbalance, remaining, worst, work, work_size }
    }

    /// Work of a load in each free rigid motion, and the sum of the magnitudes it is made of.
    pub(super) fn works(&self, load: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let of = |reduced: &Vec<f64>| {
            let terms = reduced.iter().zip(load).map(|(u, f)| u * f);
            (terms.clone().sum::<f64>(), terms.map(f64::abs).sum::<f64>())
        };
        self.constraints.free_motions.iter().map(of).unzip()
    }

    /// Zeroes a nodal vector at the dofs held.
    pub(super) fn release_held(&self, vector: &mut [f64]) {
        for (value, &held) in vector.iter_mut().zip(&self.held) {
            if held {
                *value = 0.0;
            }
        }
    }

    pub(super) fn reduced(&self, with: &Factored, step: &Residual, form: Form) -> Result<Reduced, FactorError> {
        let mut forward = self.gather(&step.imbalance);
        with.factor.forward(&mut forward)?;
        let trailing = &forward[forward.len() - self.numbering.trailing..];
        let force = with.condensed.condensed_force(trailing);
        let needs_flexibility = form == Form::Dual || with.condensed.better_form() == Form::Dual;
        let displacement =
            if needs_flexibility && !with.condensed.is_empty() { with.condensed.moved(trailing) } else { Vec::new() };
        let (work, work_size, remaining) = (step.work.clone(), step.work_size.clone(), step.remaining.clone());
        Ok(Reduced { forward, interface: InterfaceResidual { displacement, force, work, work_size, remaining } })
    }

    pub(super) fn largest_force(&self, load: &[f64], solution: &ContactSolution) -> f64 {
        load.iter().chain(&solution.reaction).fold(0.0, |a, b| a.max(b.abs()))
    }
}
