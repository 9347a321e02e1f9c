//! From a load to displacements, reactions and gaps.

use super::active_set::{Progress, Reference, Start};
use super::condense::{ContactState, Drive, Form, PosedLcp};
use super::problem::{ContactProblem, Factored};
use crate::cholesky::FactorError;
use crate::lcp::{Lcp, LcpStatus, LemkeOptions, lemke, lemke_from};
use crate::residual::Displacement;

/// How a contact problem ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Solved,
    /// Lemke's ray: no reactions balance the load.
    NoEquilibrium,
    /// The pivot limit was reached, or the contact state is beyond the arithmetic.
    Unsolved,
    /// Whoever watched wanted no more.
    Interrupted,
}

/// Displacements, reactions and gaps; NaN unless solved.
#[derive(Clone, Debug)]
pub struct ContactSolution {
    pub outcome: Outcome,
    pub displacement: Displacement,
    /// Force of every contact point, against its row.
    pub reaction: Vec<f64>,
    /// What is left of every gap; 0 where closed.
    pub gap: Vec<f64>,
    pub closed: Vec<bool>,
    pub pivots: usize,
    /// Newton steps of the active set.
    pub iterations: usize,
    /// Conjugate gradient steps in them.
    pub gradients: usize,
    /// Contact sets factored anew.
    pub factorizations: usize,
    /// Corrections made with the refined residual.
    pub corrections: usize,
}

/// At most this many corrections with one contact state, and this many contact states.
const CORRECTIONS: usize = 8;
const STATES: usize = 60;
/// A correction that leaves more than this part of the imbalance before it ends the refinement.
const PROGRESS: f64 = 0.25;
/// An imbalance this small, relative to the largest nodal force, or a gap to the largest deflection, is rounding.
pub(super) const ROUNDING: f64 = 1e-15;
/// Reactions and gaps of the wrong sign, relative to the largest of their kind or of the load, that are rounding.
pub(super) const SIGN: f64 = 1e-11;

/// What is out of balance and what is left of the gaps.
#[derive(Default)]
pub(super) struct Step {
    pub(super) imbalance: Vec<f64>,
    pub(super) remaining: Vec<f64>,
    pub(super) worst: f64,
    /// Work of the load in each free rigid motion, and the sum of the magnitudes it is made of.
    pub(super) work: Vec<f64>,
    pub(super) work_size: Vec<f64>,
}

/// An imbalance after forward substitution, and what it does at the contact points.
pub(super) struct Motion {
    forward: Vec<f64>,
    drive: Drive,
}

impl ContactProblem {
    /// Solves for one nodal load with the held dofs at `held_value` (both vectors over all dofs).
    ///
    /// `form` chooses the unknowns of the LCP, see [`super::condense`]; the better conditioned one if `None`, and the
    /// other one where that is beyond the arithmetic. The
    /// solution is refined with the double-double residual; if that shows a point on the wrong side, the LCP is posed
    /// again with the refined figures. `watch` sees every step of an active set and stops it by returning false.
    pub fn solve(
        &self,
        load: &[f64],
        held_value: &[f64],
        form: Option<Form>,
        max_pivots: Option<usize>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        let solution = self.solve_beginning(load, held_value, form, max_pivots, None, watch)?;
        if solution.outcome == Outcome::Unsolved && form.is_none() && self.active.is_empty() {
            let other = if self.base.condensed.better_form() == Form::Dual { Form::Stiffness } else { Form::Dual };
            return self.solve_beginning(load, held_value, Some(other), max_pivots, None, watch);
        }
        Ok(solution)
    }

    /// As [`ContactProblem::solve`], beginning with the contact set, and for an active set with the displacement and the
    /// reactions, of an answer.
    pub(super) fn solve_from(
        &self,
        load: &[f64],
        held_value: &[f64],
        start: &Start<'_>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        self.solve_beginning(load, held_value, None, None, Some(start), watch)
    }

    /// As [`ContactProblem::solve`], beginning with the solution of another load.
    pub fn solve_near(
        &self,
        reference: &Reference,
        load: &[f64],
        held_value: &[f64],
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        self.solve_from(load, held_value, &reference.start(), watch)
    }

    fn solve_beginning(
        &self,
        load: &[f64],
        held_value: &[f64],
        form: Option<Form>,
        max_pivots: Option<usize>,
        start: Option<&Start<'_>>,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        if !self.active.is_empty() {
            return self.solve_active(load, held_value, start, watch);
        }
        let with = &self.base;
        let form = form.unwrap_or(with.condensed.better_form());
        let mut solution = self.at_rest(load.len(), held_value);
        let mut first = start.map(|start| start.closed);
        let mut step = self.step(load, &solution);
        let mut motion = self.motion(with, &step, form)?;
        let travel = motion.drive.displacement.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        for _ in 0..STATES {
            let (outcome, closed) = self.contact_state(&motion, &mut solution, form, max_pivots, first.take());
            if outcome != Outcome::Solved {
                return Ok(solution.failed(outcome));
            }
            let settled = closed == solution.closed && solution.corrections > 0;
            solution.closed = closed;
            if !settled {
                let Some(state) = self.base.condensed.state(solution.closed.clone()) else {
                    return Ok(solution.failed(Outcome::Unsolved));
                };
                if self.release_open(&mut solution) {
                    step = self.step(load, &solution);
                    motion = self.motion(with, &step, form)?;
                }
                step = self.refine(load, &state, step, motion, &mut solution)?;
            }
            for i in 0..solution.gap.len() {
                solution.gap[i] = if solution.closed[i] { 0.0 } else { step.remaining[i] };
            }
            if settled || self.signs_hold(load, travel, &solution) {
                return Ok(solution.solved());
            }
            motion = self.motion(with, &step, form)?;
        }
        Ok(solution.failed(Outcome::Unsolved))
    }

    /// The LCP that [`ContactProblem::solve`] poses first.
    pub fn lcp(&self, load: &[f64], held_value: &[f64], form: Option<Form>) -> Result<PosedLcp, FactorError> {
        let rest = self.at_rest(load.len(), held_value);
        let form = form.unwrap_or(self.base.condensed.better_form());
        let motion = self.motion(&self.base, &self.step(load, &rest), form)?;
        Ok(self.base.condensed.lcp(form, &motion.drive, &rest.reaction))
    }

    /// What there is to say where no solution was found.
    pub(super) fn without_solution(&self, held_value: &[f64], outcome: Outcome) -> ContactSolution {
        self.at_rest(self.plate.dof_count(), held_value).failed(outcome)
    }

    pub(super) fn at_rest(&self, dofs: usize, held_value: &[f64]) -> ContactSolution {
        let m = self.constraints.rows.len();
        let mut displacement = Displacement::zeros(dofs);
        for dof in 0..dofs {
            if self.held[dof] {
                displacement.hi[dof] = held_value[dof];
            }
        }
        ContactSolution {
            outcome: Outcome::Unsolved,
            displacement,
            reaction: vec![0.0; m],
            gap: vec![0.0; m],
            closed: self.constraints.two_sided.clone(),
            pivots: 0,
            iterations: 0,
            gradients: 0,
            factorizations: 0,
            corrections: 0,
        }
    }

    /// Poses the LCP from where the solution stands and solves it, beginning with a contact set if there is one.
    fn contact_state(
        &self,
        motion: &Motion,
        solution: &mut ContactSolution,
        form: Form,
        max_pivots: Option<usize>,
        first: Option<&[bool]>,
    ) -> (Outcome, Vec<bool>) {
        if self.constraints.two_sided.iter().all(|&t| t) {
            return (Outcome::Solved, self.constraints.two_sided.clone());
        }
        let posed = self.base.condensed.lcp(form, &motion.drive, &solution.reaction);
        let options = LemkeOptions { max_pivots, ..LemkeOptions::default() };
        let solved = Lcp::new(&posed.matrix, &posed.q).and_then(|lcp| match first {
            Some(closed) => lemke_from(&lcp, &options, &self.base.condensed.basis(&posed, closed)),
            None => lemke(&lcp, &options),
        });
        let Ok(found) = solved else {
            return (Outcome::Unsolved, Vec::new());
        };
        solution.pivots += found.pivots;
        match found.status {
            LcpStatus::Solved => (Outcome::Solved, self.base.condensed.closed_points(&posed, &found.basis)),
            LcpStatus::Ray => (Outcome::NoEquilibrium, Vec::new()),
            LcpStatus::PivotLimit => (Outcome::Unsolved, Vec::new()),
        }
    }

    /// Takes back the reactions of points that are open now.
    fn release_open(&self, solution: &mut ContactSolution) -> bool {
        let mut any = false;
        for (reaction, &closed) in solution.reaction.iter_mut().zip(&solution.closed) {
            if !closed && *reaction != 0.0 {
                *reaction = 0.0;
                any = true;
            }
        }
        any
    }

    /// Corrects with one contact state for as long as the imbalance, or what is left of closed gaps, shrinks.
    pub(super) fn refine(
        &self,
        load: &[f64],
        state: &ContactState,
        mut step: Step,
        motion: Motion,
        solution: &mut ContactSolution,
    ) -> Result<Step, FactorError> {
        let mut motion = Some(motion);
        let mut first = true;
        for _ in 0..CORRECTIONS {
            let now = match motion.take() {
                Some(motion) => motion,
                None => self.motion(&self.base, &step, self.base.condensed.better_form())?,
            };
            let before = solution.clone();
            self.correct(&self.base, state, now, solution)?;
            let next = self.step(load, solution);
            let (left_before, left) = (self.left_open(&step, solution), self.left_open(&next, solution));
            let closer = left < PROGRESS * left_before;
            if !(first || next.worst < step.worst || closer) {
                *solution = before;
                return Ok(step);
            }
            let ended = !first && next.worst > PROGRESS * step.worst && !closer;
            first = false;
            step = next;
            if ended || (left == 0.0 && step.worst <= ROUNDING * self.largest_force(load, solution)) {
                break;
            }
        }
        Ok(step)
    }

    /// What is left of closed gaps, over the largest deflection or travel; 0 where that is rounding.
    fn left_open(&self, step: &Step, solution: &ContactSolution) -> f64 {
        let largest = |size: f64, value: &f64| size.max(value.abs());
        let deflection = solution.displacement.hi.iter().step_by(3).fold(0.0, largest);
        let length = self.constraints.distance.iter().fold(deflection, largest);
        let closed = step.remaining.iter().zip(&solution.closed).filter(|(_, closed)| **closed);
        let left = closed.map(|(left, _)| left).fold(0.0, largest);
        if left <= ROUNDING * length { 0.0 } else { left / length }
    }

    /// One correction: the state's increments of reaction, the gaps they leave, and the motion that goes with them.
    pub(super) fn correct(
        &self,
        with: &Factored,
        state: &ContactState,
        motion: Motion,
        solution: &mut ContactSolution,
    ) -> Result<(), FactorError> {
        let (nodal, reaction) = self.respond(with, state, motion)?;
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
        motion: Motion,
    ) -> Result<(Vec<f64>, Vec<f64>), FactorError> {
        let Motion { mut forward, drive } = motion;
        let leading = forward.len() - self.numbering.trailing;
        let mut pushed = None;
        let mut reaction = Vec::new();
        if !with.condensed.is_empty() {
            let response = with.condensed.solve_state(state, &drive);
            if with.condensed.better_form() == Form::Stiffness {
                forward[leading..].copy_from_slice(&with.condensed.prescribing(&response.moved));
            } else {
                let carried = with.condensed.regularization.iter().zip(&response.moved).map(|(d, y)| d * y);
                let push: Vec<f64> = carried.zip(&response.reaction).map(|(c, r)| c - r).collect();
                let mut force = vec![0.0; self.plate.dof_count()];
                self.spread(&push, &mut force);
                pushed = Some(self.apply(with, &force)?);
            }
            reaction = response.reaction;
        }
        with.factor.backward(&mut forward)?;
        let mut nodal = self.scatter(&forward);
        for (value, push) in nodal.iter_mut().zip(pushed.unwrap_or_default()) {
            *value += push;
        }
        Ok((nodal, reaction))
    }

    pub(super) fn step(&self, load: &[f64], solution: &ContactSolution) -> Step {
        self.step_of(self.imbalance(load, &solution.displacement, &solution.reaction), load, solution)
    }

    /// The step from what is out of balance at every dof, those held included.
    pub(super) fn step_of(&self, mut imbalance: Vec<f64>, load: &[f64], solution: &ContactSolution) -> Step {
        self.release_held(&mut imbalance);
        let worst = imbalance.iter().fold(0.0, |worst: f64, value| worst.max(value.abs()));
        let (work, work_size) = self.works(load);
        let remaining = self.remaining(&solution.displacement, &solution.reaction);
        Step { imbalance, remaining, worst, work, work_size }
    }

    /// Work of a load in each free rigid motion, and the sum of the magnitudes it is made of.
    pub(super) fn works(&self, load: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let of = |motion: &Vec<f64>| {
            let terms = motion.iter().zip(load).map(|(u, f)| u * f);
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

    pub(super) fn motion(&self, with: &Factored, step: &Step, form: Form) -> Result<Motion, FactorError> {
        let mut forward = self.gather(&step.imbalance);
        with.factor.forward(&mut forward)?;
        let trailing = &forward[forward.len() - self.numbering.trailing..];
        let force = with.condensed.condensed_force(trailing);
        let needs_flexibility = form == Form::Dual || with.condensed.better_form() == Form::Dual;
        let displacement = if needs_flexibility && !with.condensed.is_empty() {
            let mut ordered = forward.clone();
            with.factor.backward(&mut ordered)?;
            self.at_points(&self.scatter(&ordered))
        } else {
            Vec::new()
        };
        let (work, work_size, remaining) = (step.work.clone(), step.work_size.clone(), step.remaining.clone());
        Ok(Motion { forward, drive: Drive { displacement, force, work, work_size, remaining } })
    }

    pub(super) fn largest_force(&self, load: &[f64], solution: &ContactSolution) -> f64 {
        load.iter().chain(&solution.reaction).fold(0.0, |a, b| a.max(b.abs()))
    }

    /// Largest nodal load; a couple counts by the force that it is at the size of the first element.
    fn largest_load(&self, load: &[f64]) -> f64 {
        let across = self.plate.geometry(0).at.iter().flatten().fold(0.0, |a: f64, b| a.max(b.abs()));
        let size = |(dof, f): (usize, &f64)| if dof % 3 == 0 { f.abs() } else { f.abs() / across };
        load.iter().enumerate().map(size).fold(0.0, f64::max)
    }

    /// Whether no reaction pulls and no gap is negative; `travel` is how far the load moves points that may move.
    fn signs_hold(&self, load: &[f64], travel: f64, solution: &ContactSolution) -> bool {
        let c = &self.constraints;
        let largest = |values: &[f64]| values.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        // Without a load, reactions are what the plate's stiffness makes of gaps.
        let load = match self.largest_load(load) {
            0.0 => largest(&c.regularization) * largest(&c.distance),
            load => load,
        };
        let force = SIGN * largest(&solution.reaction).max(load);
        let length = (SIGN * largest(&solution.gap).max(largest(&c.distance))).max(ROUNDING * travel);
        (0..c.two_sided.len()).all(|i| c.two_sided[i] || (solution.reaction[i] >= -force && solution.gap[i] >= -length))
    }
}

impl Motion {
    pub(super) fn into_drive(self) -> Drive {
        self.drive
    }
}

impl ContactSolution {
    /// Solved, unless numbers beyond the arithmetic have made some of it NaN or infinite.
    pub(super) fn solved(self) -> Self {
        let d = &self.displacement;
        let finite = d.hi.iter().chain(&self.reaction).chain(&self.gap).all(|value| value.is_finite());
        if finite { Self { outcome: Outcome::Solved, ..self } } else { self.failed(Outcome::Unsolved) }
    }

    /// Every number NaN, and why.
    pub(super) fn failed(mut self, outcome: Outcome) -> Self {
        let d = &mut self.displacement;
        for value in d.hi.iter_mut().chain(&mut d.lo).chain(&mut self.reaction).chain(&mut self.gap) {
            *value = f64::NAN;
        }
        self.closed.fill(false);
        Self { outcome, ..self }
    }
}
