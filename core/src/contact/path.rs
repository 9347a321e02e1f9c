//! The path of a plate under f₀ + t f₁ as t grows from zero: piecewise linear, an event wherever points open or close.
//!
//! Condensed points go by parametric pivoting of their LCP. With an active set the path steps from event to event: on one
//! contact set everything is linear in t, and the next event is where the first reaction or gap falls to zero. Either way
//! each stretch of the path is drawn between two refined solutions on its contact set.

mod stepping;

use super::condense::{Drive, Form};
use super::problem::{ContactProblem, Factored};
use super::refinement::Step;
use super::solution::{ContactSolution, Outcome};
use crate::cholesky::FactorError;
use crate::lcp::{Lcp, ParametricEnd, ParametricPath, parametric};
use crate::residual::Displacement;

/// The loads f₀ + t f₁ and the dofs held, over all dofs, and the largest t wanted; it may be infinite.
#[derive(Clone, Copy, Debug)]
pub struct PathLoad<'a> {
    pub start: &'a [f64],
    pub add: &'a [f64],
    pub held_value: &'a [f64],
    pub end: f64,
}

/// Where the path is at its beginning, at an event, or at its end.
#[derive(Clone, Copy, Debug)]
pub struct Stop<'a> {
    pub t: f64,
    /// Points that open or close here; none at the beginning and at the end.
    pub switched: &'a [usize],
    /// What holds here; `closed` is the contact set from here on.
    pub solution: &'a ContactSolution,
}

/// How a path ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathEnd {
    /// At the t asked for.
    Reached,
    /// With no more events, however large t; the last stop is only one more point of the last segment.
    Unbounded,
    /// No reactions balance the load from the last stop on.
    NoEquilibrium,
    /// More events than [`MOST_EVENTS`].
    TooMany,
    /// The contact set after the last stop, or at t = 0, is beyond the arithmetic.
    Unsolved,
    /// Whoever watched wanted no more.
    Interrupted,
}

/// Events that a path may have.
pub const MOST_EVENTS: usize = 100_000;

/// Reactions and gaps of the wrong sign at the ends of a segment, over the largest of their kind, that are rounding.
const SIGN: f64 = 1e-9;
/// Travel, over the largest deflection or gap, within which events are one.
const SAME: f64 = 1e-11;
/// How far, over a segment's length, its refined end may be from where pivoting saw it.
const MOVED: f64 = 1e-3;

/// The bases of the LCP along a path, and the contact set of each.
type Pivoted = (ParametricPath, Vec<Vec<bool>>);

/// The plate on one contact set at two loads of the path, between and beyond which it is linear.
struct Line {
    at: [f64; 2],
    ends: [ContactSolution; 2],
    /// Sizes of reactions and of gaps.
    force: f64,
    length: f64,
}

impl Line {
    /// What counts for a point: its reaction where closed, else its gap, at an end and over the largest of its kind.
    fn value(&self, end: usize, i: usize) -> f64 {
        let solution = &self.ends[end];
        let (value, size) =
            if solution.closed[i] { (solution.reaction[i], self.force) } else { (solution.gap[i], self.length) };
        if size > 0.0 { value / size } else { 0.0 }
    }

    /// Largest change of the deflection between two t.
    fn travel(&self, from: f64, to: f64) -> f64 {
        let [a, b] = &self.ends;
        let change = |i: usize| (b.displacement.at(i) - a.displacement.at(i)).value().abs();
        let whole = (0..a.displacement.hi.len()).step_by(3).map(change).fold(0.0, f64::max);
        whole * (to - from) / (self.at[1] - self.at[0])
    }

    fn part(&self, t: f64) -> f64 {
        (t - self.at[0]) / (self.at[1] - self.at[0])
    }

    fn at(&self, t: f64) -> ContactSolution {
        let part = self.part(t);
        let [a, b] = &self.ends;
        let between = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a + part * (b - a)).collect();
        let mut displacement = Displacement::zeros(a.displacement.hi.len());
        for i in 0..displacement.hi.len() {
            let (from, to) = (a.displacement.at(i), b.displacement.at(i));
            let sum = from + (to - from).times(part);
            (displacement.hi[i], displacement.lo[i]) = (sum.hi, sum.lo);
        }
        let (reaction, gap) = (between(&a.reaction, &b.reaction), between(&a.gap, &b.gap));
        ContactSolution { displacement, reaction, gap, ..a.clone() }
    }
}

impl PathLoad<'_> {
    fn at(&self, t: f64) -> Vec<f64> {
        self.start.iter().zip(self.add).map(|(a, b)| a + t * b).collect()
    }

    /// A step of t that changes the load about as much as there is of it.
    fn span(&self, t: f64) -> f64 {
        let size = |f: &[f64]| f.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        match (size(self.start) / size(self.add)).max(t) {
            span if span > 0.0 && span.is_finite() => span,
            _ => 1.0,
        }
    }
}

/// Points whose states differ.
fn differing(one: &[bool], other: &[bool]) -> Vec<usize> {
    (0..one.len()).filter(|&i| one[i] != other[i]).collect()
}

impl ContactProblem {
    /// Displacements, reactions and gaps under one load on a contact set that is given, signs as they come.
    pub fn solve_on(&self, load: &[f64], held_value: &[f64], closed: &[bool]) -> Result<ContactSolution, FactorError> {
        self.on(load, held_value, closed, None, &mut None)
    }

    fn on(
        &self,
        load: &[f64],
        held_value: &[f64],
        closed: &[bool],
        start: Option<&ContactSolution>,
        own: &mut Option<Factored>,
    ) -> Result<ContactSolution, FactorError> {
        if !self.active.is_empty() {
            return self.solve_active_on(load, held_value, closed, start, own);
        }
        let mut solution = self.at_rest(load.len(), held_value);
        let Some(state) = self.base.condensed.state(closed.to_vec()) else {
            return Ok(solution.failed(Outcome::Unsolved));
        };
        let step = self.step(load, &solution);
        let motion = self.motion(&self.base, &step, self.base.condensed.better_form())?;
        let step = self.refine(load, &state, step, motion, &mut solution)?;
        for i in 0..closed.len() {
            solution.gap[i] = if closed[i] { 0.0 } else { step.remaining[i] };
        }
        let outcome = if step.worst.is_finite() { Outcome::Solved } else { Outcome::Unsolved };
        Ok(ContactSolution { outcome, closed: closed.to_vec(), ..solution })
    }

    /// `None` where the set leaves the plate free.
    fn line(
        &self,
        load: &PathLoad,
        closed: &[bool],
        at: [f64; 2],
        start: Option<&ContactSolution>,
        own: &mut Option<Factored>,
    ) -> Result<Option<Line>, FactorError> {
        let from = self.on(&load.at(at[0]), load.held_value, closed, start, own)?;
        if from.outcome != Outcome::Solved {
            return Ok(None);
        }
        let to = self.on(&load.at(at[1]), load.held_value, closed, Some(&from), own)?;
        if to.outcome != Outcome::Solved {
            return Ok(None);
        }
        let largest = |values: &[f64]| values.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        // Couples have another unit: the load counts only where no point reacts.
        let force = match largest(&from.reaction).max(largest(&to.reaction)) {
            0.0 => largest(&load.at(at[1])),
            force => force,
        };
        let deflection =
            |of: &ContactSolution| of.displacement.hi.iter().step_by(3).fold(0.0, |m: f64, w| m.max(w.abs()));
        let length = [&from, &to].map(|end| largest(&end.gap).max(deflection(end))).into_iter().fold(0.0, f64::max);
        Ok(Some(Line { at, ends: [from, to], force, length }))
    }

    /// Follows the path, and shows every stop on it to `visit`, which may end it by returning false.
    ///
    /// The first stop is the solution at t = 0; if there is none, `visit` is not called.
    pub fn path(&self, load: &PathLoad, visit: &mut dyn FnMut(Stop) -> bool) -> Result<PathEnd, FactorError> {
        let first = self.solve(load.start, load.held_value, None, None, &mut |_| true)?;
        match first.outcome {
            Outcome::Solved => {}
            Outcome::NoEquilibrium => return Ok(PathEnd::NoEquilibrium),
            _ => return Ok(PathEnd::Unsolved),
        }
        if load.end <= 0.0 {
            let on = visit(Stop { t: 0.0, switched: &[], solution: &first });
            return Ok(if on { PathEnd::Reached } else { PathEnd::Interrupted });
        }
        if !self.active.is_empty() {
            return self.step_along(load, first, visit);
        }
        let Some((found, sets)) = self.pivoted(load, &first.closed)? else {
            return Ok(PathEnd::Unsolved);
        };
        let set_at = |k: usize| sets.get(k).unwrap_or(&first.closed).clone();
        let mut shown = ContactSolution { closed: set_at(0), ..first.clone() };
        let (mut t, mut before) = (0.0, None);
        for (k, segment) in found.segments.iter().enumerate() {
            let far = if segment.to.is_finite() { segment.to } else { segment.from + load.span(segment.from) };
            let line = self.line(load, &sets[k], [segment.from, far], None, &mut None)?;
            let next = sets.get(k + 1);
            let to = line.as_ref().map_or(far, |line| {
                let leaving = next.map_or(Vec::new(), |next| differing(next, &sets[k]));
                line.root(&leaving).unwrap_or(far).max(t)
            });
            if next.is_some() && line.as_ref().is_some_and(|line| line.travel(t, to) <= SAME * line.length) {
                continue;
            }
            let switched = before.map_or(Vec::new(), |before| differing(&sets[k], before));
            before = Some(&sets[k]);
            shown = line.as_ref().map_or(shown, |line| line.at(t));
            shown.closed.clone_from(&sets[k]);
            if !visit(Stop { t, switched: &switched, solution: &shown }) {
                return Ok(PathEnd::Interrupted);
            }
            let Some(line) = line.filter(|line| self.signs_hold_on(line)) else {
                return Ok(PathEnd::Unsolved);
            };
            t = to;
            if t >= load.end || next.is_none() {
                let endless = segment.to.is_infinite();
                t = if endless && load.end.is_finite() { load.end } else { t.min(load.end) };
                let on = visit(Stop { t, switched: &[], solution: &line.at(t) });
                return Ok(match found.end {
                    _ if !on => PathEnd::Interrupted,
                    _ if endless && load.end.is_infinite() => PathEnd::Unbounded,
                    _ if t >= load.end => PathEnd::Reached,
                    ParametricEnd::Infeasible => PathEnd::NoEquilibrium,
                    _ => PathEnd::Unsolved,
                });
            }
        }
        // Equilibrium ends where it begins.
        visit(Stop { t, switched: &[], solution: &shown });
        Ok(if found.end == ParametricEnd::Infeasible { PathEnd::NoEquilibrium } else { PathEnd::Unsolved })
    }

    /// The bases of the LCP along the path, and the contact set of each; in the other form where one stops.
    fn pivoted(&self, load: &PathLoad, closed: &[bool]) -> Result<Option<Pivoted>, FactorError> {
        let mut best = None;
        let better = self.base.condensed.better_form();
        for form in [better, if better == Form::Dual { Form::Stiffness } else { Form::Dual }] {
            let rest = self.at_rest(load.start.len(), load.held_value);
            let posed =
                self.base.condensed.lcp(form, &self.drive(&self.step(load.start, &rest), form)?, &rest.reaction);
            let still = vec![0.0; load.add.len()];
            let rate = self.without_travel(load.add, &still);
            let along = self.base.condensed.lcp(form, &self.drive(&rate, form)?, &rest.reaction).q;
            let basis = self.base.condensed.basis(&posed, closed);
            let solved = Lcp::new(&posed.matrix, &posed.q).and_then(|lcp| parametric(&lcp, &along, &basis, load.end));
            let Ok(found) = solved else { continue };
            let set = |basis: &Vec<bool>| self.base.condensed.closed_points(&posed, basis);
            let sets = found.segments.iter().map(|segment| set(&segment.basis)).collect();
            let stopped = found.end == ParametricEnd::Stopped;
            best = Some((found, sets));
            if !stopped {
                break;
            }
        }
        Ok(best)
    }

    fn drive(&self, step: &Step, form: Form) -> Result<Drive, FactorError> {
        Ok(self.motion(&self.base, step, form)?.drive)
    }

    /// A load by itself: no gaps, nothing held elsewhere than at zero.
    fn without_travel(&self, load: &[f64], still: &[f64]) -> Step {
        let rest = self.at_rest(load.len(), still);
        let mut imbalance = load.to_vec();
        self.release_held(&mut imbalance);
        let step = self.step_of(imbalance, load, &rest);
        Step { remaining: vec![0.0; rest.reaction.len()], ..step }
    }

    fn signs_hold_on(&self, line: &Line) -> bool {
        let one_sided = |i: &usize| !self.constraints.two_sided[*i];
        (0..self.constraints.two_sided.len())
            .filter(one_sided)
            .all(|i| line.value(0, i) > -SIGN && line.value(1, i) > -SIGN)
    }
}

impl Line {
    /// Where the points that switch at the end of a segment reach zero; `None` if that is not near its end.
    fn root(&self, switched: &[usize]) -> Option<f64> {
        let fall = |&i: &usize| self.value(0, i) - self.value(1, i);
        let first = switched.iter().copied().max_by(|a, b| fall(a).total_cmp(&fall(b)))?;
        let beyond = self.value(1, first) / fall(&first);
        (beyond.abs() < MOVED).then(|| self.at[1] + beyond * (self.at[1] - self.at[0]))
    }
}
