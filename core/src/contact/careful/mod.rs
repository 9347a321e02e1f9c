//! Solves where rounding decides: points that nearly repeat each other, plates that hardly anything holds.
//!
//! Proximal steps (Rockafellar 1976) regularize the problem without changing its answer: each solves an LCP past the
//! reactions that act already, in which increments of reaction meet a compliance and increments of deflection a
//! stiffness. `saddle` solves the equations of a contact state without condensing them, `floating` keeps large rigid
//! motions apart, and `krylov` takes away what the regularization leaves. docs/theory.md, section 6, says why.

mod floating;
mod krylov;
mod saddle;

use super::active_set::Progress;
use super::problem::ContactProblem;
use super::refinement::Step;
use super::solution::{ContactSolution, Outcome};
use super::solve::{ROUNDING, STATES};
use crate::element::DOFS;
use crate::lcp::{Lcp, LcpStatus, LemkeOptions, lemke_from};
use crate::residual::internal_magnitude;
use floating::{Floating, extent, rigidity};
use krylov::Direction;
use rayon::prelude::*;
use saddle::Saddle;

/// Part of the plate's own stiffness that increments of deflection meet, all nodes together: what is much less would
/// drown the rest of an LCP in how far a loose plate goes.
const KEEPING: f64 = 1e-3;

/// So many steps let a plate afloat settle all the way on their contact set. Later ones, where sets come back, go only as
/// far as the resistance lets them.
const SETTLING: usize = 20;

/// Length of the residual of a solution, or units of rounding of the plate's own forces if that is more; still more is
/// left where a plate has yet to reach what holds it.
const SOLVED: f64 = 1e-9;
const ROUNDINGS: f64 = 4.0;

/// A contact problem with what increments of reaction meet.
struct Careful<'a> {
    problem: &'a ContactProblem,
    /// Compliance of every point's support, and at least what its increments meet.
    compliance: Vec<f64>,
    /// What a gap is measured by beside lengths: 1, or for a slope one over the plate's size.
    per_length: Vec<f64>,
    /// Stiffness that an increment of deflection meets at every node.
    bed: f64,
}

/// What one-sided points do to each other where the two-sided ones hold: the proximal step's M.
struct Proximal {
    held: Saddle,
    points: Vec<usize>,
    matrix: Vec<f64>,
}

impl ContactProblem {
    /// As [`ContactProblem::solve`], by proximal steps; without points of an active set.
    ///
    /// Increments of reaction meet at least `part` of the plate's own compliance. The steps begin with a contact set if
    /// there is one, and end where the equations of one set give the right signs; if none does, with the last step.
    /// `watch` sees every step and stops it by returning false.
    pub fn solve_carefully(
        &self,
        load: &[f64],
        held_value: &[f64],
        part: f64,
        closed: Option<&[bool]>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> ContactSolution {
        assert!(self.active.is_empty(), "all points are condensed");
        let (_, size) = extent(&self.plate);
        let own_stiffness = rigidity(&self.plate) / (size * size);
        let turns = |row: &[f64; DOFS]| row.iter().step_by(3).all(|&value| value == 0.0);
        let per_length = |row| if turns(row) { 1.0 / size } else { 1.0 };
        let per_length: Vec<f64> = self.constraints.rows.coefficient.iter().map(per_length).collect();
        let least = per_length.iter().map(|unit| part * unit * unit / own_stiffness);
        let compliance = self.constraints.compliance.iter().zip(least).map(|(own, least)| own.max(least)).collect();
        let bed = KEEPING * own_stiffness / self.plate.node_count() as f64;
        let careful = Careful { problem: self, compliance, per_length, bed };
        careful.solve(load, self.at_rest(load.len(), held_value), closed, watch)
    }
}

impl Careful<'_> {
    fn solve(
        &self,
        load: &[f64],
        at_rest: ContactSolution,
        mut first: Option<&[bool]>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> ContactSolution {
        let problem = self.problem;
        let mut near = at_rest;
        let mut step = problem.step(load, &near);
        let mut proximal = None;
        let mut state = None;
        let mut exact: Option<ContactSolution> = None;
        let mut before = near.closed.clone();
        for number in 0..STATES {
            near.closed = match first.take() {
                // A set that was solved for before may be right where rounding would have the LCP choose another.
                Some(set) => set.to_vec(),
                None => {
                    if proximal.is_none() {
                        proximal = self.proximal();
                    }
                    let posed = proximal.as_ref().map(|proximal| self.contact_set(proximal, &step, &mut near));
                    match posed.unwrap_or(Err(Outcome::Unsolved)) {
                        Ok(closed) => closed,
                        Err(outcome) => return exact.unwrap_or_else(|| near.failed(outcome)),
                    }
                }
            };
            let changed = before.iter().zip(&near.closed).filter(|(before, now)| before != now).count();
            before.clone_from(&near.closed);
            if number == 0 || changed > 0 {
                state = Saddle::of(self, &near.closed);
            }
            let Some(saddle) = &state else {
                return near.failed(Outcome::Unsolved);
            };
            if problem.release_open(&mut near) {
                step = problem.step(load, &near);
            }
            let floating = Floating::of(self, &near.closed);
            let settling = floating.as_ref().filter(|_| number < SETTLING);
            let direction = self.direction(load, saddle, &step, settling, &near);
            near.follow(problem, &direction, 1.0);
            near.corrections += 1;
            let mut next = problem.step(load, &near);
            let same = number > 0 && changed == 0;
            let further = if same { self.reach(load, &near, &direction, &step, &next) } else { 0.0 };
            if further > 1.0 && !self.solved(load, &next, &near) {
                near.follow(problem, &direction, further);
                next = problem.step(load, &near);
            }
            step = next;
            let left = self.length(load, &step, &near);
            if !watch(Progress { step: number + 1, changing: changed, residual: left }) {
                return near.failed(Outcome::Interrupted);
            }
            // A proximal step's reactions push; those that the equations of a set give need not.
            if exact.as_ref().is_none_or(|exact| exact.closed != near.closed) {
                let mut trial = near.clone();
                let left = self.refine(load, saddle, floating.as_ref(), &step, &mut trial);
                trial.leave_open(&left.remaining);
                let right = problem.signs_hold(load, 0.0, &trial) && self.solved(load, &left, &trial);
                let trial = trial.solved();
                if right {
                    return trial;
                }
                exact = Some(trial);
            }
            if same && left <= ROUNDING {
                break;
            }
        }
        near.leave_open(&step.remaining);
        near.solved()
    }

    /// Whether a residual is that of a solution.
    fn solved(&self, load: &[f64], step: &Step, solution: &ContactSolution) -> bool {
        let (plate, held) = (&self.problem.plate, &self.problem.held);
        let internal = internal_magnitude(plate, held, &solution.displacement);
        let force = self.problem.largest_force(load, solution);
        let rounding = ROUNDINGS * f64::EPSILON * internal * (plate.dof_count() as f64).sqrt();
        self.length(load, step, solution) <= SOLVED.max(if force > 0.0 { rounding / force } else { 0.0 })
    }

    /// How many times over a step that led from one residual to another may go on: while it leads down, no gap closes
    /// and no reaction pulls.
    ///
    /// What a second step in one set moves is what the regularization alone holds, so that it goes on as it began.
    fn reach(&self, load: &[f64], near: &ContactSolution, direction: &Direction, from: &Step, to: &Step) -> f64 {
        let left = self.length(load, to, near) / self.length(load, from, near);
        let mut reach = if left < 1.0 { left / (1.0 - left) } else { f64::INFINITY };
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

    /// `None` if what is two-sided contradicts itself beyond the arithmetic.
    fn proximal(&self) -> Option<Proximal> {
        let problem = self.problem;
        let two_sided = &problem.constraints.two_sided;
        let held = Saddle::of(self, two_sided)?;
        let points: Vec<usize> = (0..two_sided.len()).filter(|&i| !two_sided[i]).collect();
        let still = vec![0.0; two_sided.len()];
        // The matrix is symmetric, so that what a push does everywhere is a row.
        let mut matrix = vec![0.0; points.len() * points.len()];
        matrix.par_chunks_mut(points.len().max(1)).enumerate().for_each(|(at, row)| {
            let mut push = vec![0.0; problem.plate.dof_count()];
            problem.constraints.rows.scatter(&problem.plate, points[at], 1.0, &mut push);
            let (nodal, _) = held.response(problem, &push, &still);
            for (value, &other) in row.iter_mut().zip(&points) {
                *value = problem.constraints.rows.dot(&problem.plate, other, &nodal);
            }
            row[at] += self.compliance[points[at]];
        });
        Some(Proximal { held, points, matrix })
    }

    /// The contact set of one proximal step.
    fn contact_set(&self, proximal: &Proximal, step: &Step, near: &mut ContactSolution) -> Result<Vec<bool>, Outcome> {
        let problem = self.problem;
        let mut closed = problem.constraints.two_sided.clone();
        let points = &proximal.points;
        if points.is_empty() {
            return Ok(closed);
        }
        let (nodal, _) = proximal.held.response(problem, &step.imbalance, &step.remaining);
        let gap = |(row, &point): (usize, &usize)| {
            let acting = proximal.matrix[row * points.len()..].iter().zip(points);
            let pushed_by: f64 = acting.map(|(m, &other)| m * near.reaction[other]).sum();
            step.remaining[point] - problem.constraints.rows.dot(&problem.plate, point, &nodal) - pushed_by
        };
        let q: Vec<f64> = points.iter().enumerate().map(gap).collect();
        let basis: Vec<bool> = points.iter().map(|&point| near.closed[point]).collect();
        let found = Lcp::new(&proximal.matrix, &q).and_then(|lcp| lemke_from(&lcp, &LemkeOptions::default(), &basis));
        let Ok(found) = found else {
            return Err(Outcome::Unsolved);
        };
        near.pivots += found.pivots;
        match found.status {
            LcpStatus::Solved => {
                points.iter().zip(&found.basis).for_each(|(&point, &basic)| closed[point] = basic);
                Ok(closed)
            }
            LcpStatus::Ray => Err(Outcome::NoEquilibrium),
            LcpStatus::PivotLimit => Err(Outcome::Unsolved),
        }
    }
}
