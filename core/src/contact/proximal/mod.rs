//! Solves where rounding decides: points that nearly repeat each other, plates that hardly anything holds.
//!
//! Proximal steps (Rockafellar 1976) regularize the problem without changing its answer: each solves an LCP past the
//! reactions that act already, in which increments of reaction meet a compliance and increments of deflection a
//! stiffness (`subproblem`). Here they go from one contact set to the next, until the equations of one give the right signs.
//! docs/theory.md, section 6, says why.

mod subproblem;

use super::kkt::{Correction, Regularized, Residual, Uncondensed};
use super::problem::ContactProblem;
use super::solution::{ContactSolution, Outcome, Progress};
use crate::cholesky::FactorError;
use crate::contact::tolerances;
use subproblem::Subproblem;

/// At most this many proximal steps.
const STEPS: usize = 60;

/// What the equations of a contact set give, signs as they come.
struct OnSet {
    solution: ContactSolution,
    /// Whether nothing but rounding is left of the equations.
    within_rounding: bool,
}

/// Proximal steps under one load.
struct Steps<'a> {
    problem: &'a ContactProblem,
    regularized: Regularized<'a>,
    load: &'a [f64],
}

impl ContactProblem {
    /// As [`ContactProblem::solve`], by proximal steps; without points of an active set.
    ///
    /// Increments of reaction meet at least `part` of the plate's own compliance. The steps begin with a contact set if
    /// there is one, and end where the equations of one set give the right signs; if none does, with the last step.
    /// `watch` sees every step and stops it by returning false.
    pub fn solve_by_proximal_steps(
        &self,
        load: &[f64],
        held_value: &[f64],
        part: f64,
        closed: Option<&[bool]>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        let steps = Steps { problem: self, regularized: Regularized::of(self, part), load };
        steps.run(self.at_rest(held_value), closed.map(<[bool]>::to_vec), watch)
    }
}

impl Steps<'_> {
    fn run(
        &self,
        at_rest: ContactSolution,
        mut given: Option<Vec<bool>>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        let &Self { problem, load, ref regularized } = self;
        let mut near = at_rest;
        let mut step = problem.residual(load, &near);
        let mut subproblem = None;
        let mut equations = None;
        let mut on_set: Option<OnSet> = None;
        let mut before = near.closed.clone();
        for number in 0..STEPS {
            // A set that was solved for before may be right where rounding would have the LCP choose another.
            let chosen = match given.take() {
                Some(set) => Ok(set),
                None => Subproblem::contact_set(&mut subproblem, regularized, &step, &mut near, watch)?,
            };
            near.closed = match chosen {
                Ok(closed) => closed,
                Err(outcome) => return Ok(on_set.map_or_else(|| near.failed(outcome), |on_set| on_set.solution)),
            };
            let changing = before.iter().zip(&near.closed).filter(|(before, now)| before != now).count();
            let same = number > 0 && changing == 0;
            before.clone_from(&near.closed);
            if !same {
                equations = regularized.on(&near.closed)?;
            }
            let Some(equations) = &mut equations else {
                return Ok(near.failed(Outcome::Unsolved));
            };
            if problem.release_open(&mut near) {
                step = problem.residual(load, &near);
            }
            let Some(direction) = problem.correction(load, equations, &step, &near)? else {
                return Ok(near.failed(Outcome::Unsolved));
            };
            near.follow(problem, &direction, 1.0);
            let mut next = problem.residual(load, &near);
            if same {
                given = self.go_on(&mut near, on_set.as_ref(), &direction, &step, &next);
                next = problem.residual(load, &near);
            }
            step = next;
            let left = problem.length(load, &step, &near, 0.0);
            if !watch(Progress { step: number + 1, changing, residual: left }) {
                return Ok(near.failed(Outcome::Interrupted));
            }
            // A proximal step's reactions push; those that the equations of a set give need not.
            if on_set.as_ref().is_none_or(|on_set| on_set.solution.closed != near.closed) {
                let tried = self.on_set(&near, equations, &step)?;
                let nil = tolerances::SIGN * problem.least_length(load);
                if problem.signs_hold(load, nil, &tried.solution) && tried.within_rounding {
                    return Ok(tried.solution);
                }
                on_set = Some(tried);
            }
        }
        near.leave_open(&step.remaining);
        Ok(near.solved())
    }

    /// The solution of the equations of the contact set that a solution has, beginning there.
    fn on_set(
        &self,
        near: &ContactSolution,
        equations: &mut Uncondensed,
        from: &Residual,
    ) -> Result<OnSet, FactorError> {
        let (problem, load) = (self.problem, self.load);
        let mut solution = near.clone();
        let Some(left) = problem.refine(load, 0.0, equations, from.clone(), &mut solution)? else {
            return Ok(OnSet { solution: solution.failed(Outcome::Unsolved), within_rounding: false });
        };
        solution.leave_open(&left.remaining);
        let within_rounding = problem.satisfies(load, &left, &solution, 0.0);
        Ok(OnSet { solution: solution.solved(), within_rounding })
    }

    /// Goes on after a second step in one set: towards what its equations give, or as far as the step leads. The set to
    /// go on with, where a point stops the way.
    fn go_on(
        &self,
        near: &mut ContactSolution,
        on_set: Option<&OnSet>,
        direction: &Correction,
        from: &Residual,
        to: &Residual,
    ) -> Option<Vec<bool>> {
        if let Some(on_set) = on_set.filter(|on_set| on_set.within_rounding) {
            let (part, stopped_by) = self.part_of_the_way(near, to, &on_set.solution);
            near.towards(&on_set.solution, part);
            // A proximal step would let go of the point, or take it up, only when it is far beyond.
            return stopped_by.map(|point| {
                let mut set = near.closed.clone();
                set[point] = !set[point];
                set
            });
        }
        if !self.problem.satisfies(self.load, to, near, 0.0) {
            near.follow(self.problem, direction, self.reach(near, direction, from, to));
        }
        None
    }

    /// How far one may go to the solution of a contact set's equations, and the point whose gap closes or whose reaction
    /// ends there.
    fn part_of_the_way(&self, near: &ContactSolution, step: &Residual, to: &ContactSolution) -> (f64, Option<usize>) {
        let mut part = (1.0_f64, None);
        for i in (0..near.closed.len()).filter(|&i| !self.problem.constraints.two_sided[i]) {
            let (from, to) =
                if near.closed[i] { (near.reaction[i], to.reaction[i]) } else { (step.remaining[i], to.gap[i]) };
            let stop = from.max(0.0) / (from.max(0.0) - to);
            if to < 0.0 && stop < part.0 {
                part = (stop, Some(i));
            }
        }
        part
    }

    /// How many times over a step may go on: while it leads down, no gap closes and no reaction pulls.
    ///
    /// What a second step in one set moves is what the regularization alone holds, so that it goes on as it began.
    fn reach(&self, near: &ContactSolution, direction: &Correction, from: &Residual, to: &Residual) -> f64 {
        let motion = direction.motion(self.problem);
        // What is out of balance and what is left of gaps, by the motion and the reactions that answer them.
        let work = |step: &Residual| {
            let of_forces = motion.iter().zip(&step.imbalance).map(|(u, f)| u * f).sum::<f64>();
            of_forces - direction.reaction.iter().zip(&step.remaining).map(|(r, gap)| r * gap).sum::<f64>()
        };
        let (left, lost) = (work(to), work(from) - work(to));
        let mut reach = if lost > 0.0 { left.max(0.0) / lost } else { f64::INFINITY };
        for i in (0..near.closed.len()).filter(|&i| !self.problem.constraints.two_sided[i]) {
            let (now, lost) = if near.closed[i] {
                (near.reaction[i], -direction.reaction[i])
            } else {
                (to.remaining[i], from.remaining[i] - to.remaining[i])
            };
            if lost > 0.0 {
                reach = reach.min(now.max(0.0) / lost);
            }
        }
        if reach.is_finite() { reach } else { 0.0 }
    }
}
