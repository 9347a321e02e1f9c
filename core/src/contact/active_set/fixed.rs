//! A contact set that is given: the equations are linear, and points may pull or overlap.

use super::descent::Descent;
use super::direction::Direction;
use super::floating::Floating;
use super::newton::{NEWTON, STALLS};
use crate::cholesky::FactorError;
use crate::contact::problem::{ContactProblem, Factored};
use crate::contact::refinement::Residual;
use crate::contact::solution::{ContactSolution, Outcome};
use crate::contact::tolerances;

impl ContactProblem {
    /// As [`ContactProblem::solve_on`], beginning with an answer if there is one; `own` is the factor that an earlier
    /// call came to, and becomes that of this one. Forces far below `least` are rounding.
    pub(in crate::contact) fn solve_active_on(
        &self,
        load: &[f64],
        held_value: &[f64],
        closed: &[bool],
        start: Option<&ContactSolution>,
        own: &mut Option<Factored>,
        least: f64,
    ) -> Result<ContactSolution, FactorError> {
        let given: Vec<bool> = self.order.active.iter().map(|&i| closed[i]).collect();
        let begun = start.is_some() || own.is_some();
        let (found, left) = self.settled_on(load, held_value, &given, start, own, least)?;
        if begun && left > tolerances::newton::STALLED_ON_SET {
            // Where stiff springs make the later factor less exact than the first one.
            let mut anew = None;
            let (again, less) = self.settled_on(load, held_value, &given, None, &mut anew, least)?;
            if less < left {
                *own = anew;
                return Ok(again);
            }
        }
        Ok(found)
    }

    /// The answer, and its imbalance over the largest force; infinite where there is none.
    fn settled_on(
        &self,
        load: &[f64],
        held_value: &[f64],
        given: &[bool],
        start: Option<&ContactSolution>,
        own: &mut Option<Factored>,
        least: f64,
    ) -> Result<(ContactSolution, f64), FactorError> {
        let mut solution = self.at_rest(load.len(), held_value);
        let mut multiplier = vec![0.0; given.len()];
        if let Some(start) = start {
            solution.displacement = start.displacement.clone();
            for (at, &i) in self.order.condensed.iter().enumerate() {
                solution.reaction[at] = start.reaction[i];
            }
            for (at, &i) in self.order.active.iter().enumerate() {
                multiplier[at] = if given[at] { start.reaction[i] } else { 0.0 };
            }
        }
        let with = own.as_ref().unwrap_or(&self.base);
        let Some(state) = with.condensed.state(self.constraints.two_sided.clone()) else {
            return Ok((self.without_solution(held_value, Outcome::Unsolved), f64::INFINITY));
        };
        let mut descent = Descent {
            problem: self,
            load,
            limit: tolerances::newton::STIFFEST,
            penalty: self.active.penalized(tolerances::newton::STIFFEST),
            given: with,
            shares: false,
            own: None,
            state,
            solution,
            stretch: vec![0.0; given.len()],
            multiplier,
            residual: Residual::default(),
            rounding: 0.0,
            imposed: Some(given.to_vec()),
            floating: Floating::of(self, load),
        };
        let (outcome, left) = descent.settle(given, least)?;
        let factored = descent.own.take();
        let found = descent.in_order();
        if factored.is_some() {
            *own = factored;
        }
        let solved = outcome == Outcome::Solved;
        Ok(if solved { (ContactSolution { outcome, ..found }, left) } else { (found.failed(outcome), f64::INFINITY) })
    }
}

impl Descent<'_> {
    /// Steps on the given set until what is out of balance is rounding; also what that is, over the largest force.
    fn settle(&mut self, closed: &[bool], least: f64) -> Result<(Outcome, f64), FactorError> {
        self.refine()?;
        let (mut before, mut stalled) = (f64::INFINITY, 0);
        for _ in 0..NEWTON {
            if self.problem.base.firmer {
                self.drift();
            }
            let force = self.problem.largest_force(self.load, &self.solution).max(self.largest_push()).max(least);
            let balanced = self.residual.worst <= tolerances::newton::BALANCED * force;
            if balanced {
                self.renew_multipliers();
            }
            let worst = self.residual.worst;
            let unsolved = (Outcome::Unsolved, f64::INFINITY);
            if !worst.is_finite() {
                return Ok(unsolved);
            }
            if balanced && worst <= tolerances::newton::SETTLED * force {
                return Ok((Outcome::Solved, worst / force));
            }
            stalled = if worst > tolerances::newton::SLOW * before { stalled + 1 } else { 0 };
            if stalled == STALLS {
                return Ok(if worst <= tolerances::newton::STALLED * force {
                    (Outcome::Solved, worst / force)
                } else {
                    unsolved
                });
            }
            before = worst;
            let direction: Direction = self.direction(closed, tolerances::newton::TIGHT)?;
            if direction.free {
                return Ok(unsolved);
            }
            self.advance(&direction, closed);
            self.refine()?;
        }
        Ok((Outcome::Unsolved, f64::INFINITY))
    }
}
