//! A stretch of the path: the plate on one contact set, linear in t.

use super::load::PathLoad;
use crate::cholesky::FactorError;
use crate::contact::kkt::OnSet;
use crate::contact::problem::ContactProblem;
use crate::contact::solution::{ContactSolution, Outcome, differing};
use crate::contact::tolerances;
use crate::residual::{Displacement, Springs, residual};

/// The plate on one contact set at two loads of the path, between and beyond which it is linear.
pub(super) struct Line {
    pub at: [f64; 2],
    pub ends: [ContactSolution; 2],
    /// Sizes of reactions and of gaps.
    pub force: f64,
    pub length: f64,
    /// Change of a reaction, over their size, that rounding alone may bring between the two ends.
    still: f64,
}

impl Line {
    /// What counts for a point: its reaction where closed, else its gap, at an end and over the largest of its kind.
    pub fn value(&self, end: usize, i: usize) -> f64 {
        let solution = &self.ends[end];
        let (value, size) =
            if solution.closed[i] { (solution.reaction[i], self.force) } else { (solution.gap[i], self.length) };
        if size > 0.0 { value / size } else { 0.0 }
    }

    /// How much a point's value falls from one end to the other; nothing where that is no more than rounding.
    pub fn fall(&self, i: usize) -> f64 {
        let fall = self.value(0, i) - self.value(1, i);
        let still = if self.ends[0].closed[i] { self.still } else { tolerances::path::STILL };
        if fall.abs() > still { fall } else { 0.0 }
    }

    /// Largest change of the deflection between two t.
    pub fn travel(&self, from: f64, to: f64) -> f64 {
        let [a, b] = &self.ends;
        let change = |i: usize| (b.displacement.at(i) - a.displacement.at(i)).value().abs();
        let whole = (0..a.displacement.hi.len()).step_by(3).map(change).fold(0.0, f64::max);
        whole * (to - from) / (self.at[1] - self.at[0])
    }

    fn part(&self, t: f64) -> f64 {
        (t - self.at[0]) / (self.at[1] - self.at[0])
    }

    pub fn at(&self, t: f64) -> ContactSolution {
        let mut solution = self.ends[0].clone();
        solution.towards(&self.ends[1], self.part(t));
        solution
    }

    /// Where the points that switch at the end of a segment reach zero; `None` if none does near its end.
    pub fn root(&self, switched: &[usize]) -> Option<f64> {
        let near =
            switched.iter().copied().filter(|&i| self.value(1, i).abs() < tolerances::path::MOVED * self.fall(i));
        let first = near.max_by(|&a, &b| self.fall(a).total_cmp(&self.fall(b)))?;
        Some(self.at[1] + self.value(1, first) / self.fall(first) * (self.at[1] - self.at[0]))
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// The largest deflection or gap.
fn largest_length(of: &ContactSolution) -> f64 {
    of.displacement.hi.iter().step_by(3).fold(largest(&of.gap), |most, w| most.max(w.abs()))
}

/// The solution with another contact set, if it stands on that too: points that differ neither press nor part.
pub(super) fn standing_on(solution: &ContactSolution, set: &[bool]) -> Option<ContactSolution> {
    let (force, length) =
        (tolerances::path::NOTHING * largest(&solution.reaction), tolerances::path::NOTHING * largest_length(solution));
    let idle = |&i: &usize| solution.reaction[i].abs() <= force && solution.gap[i].abs() <= length;
    let differing = differing(&solution.closed, set);
    differing.iter().all(idle).then(|| {
        let mut same = ContactSolution { closed: set.to_vec(), ..solution.clone() };
        for i in differing {
            (same.reaction[i], same.gap[i]) = (0.0, 0.0);
        }
        same
    })
}

impl ContactProblem {
    /// `None` where the set leaves the plate free.
    pub(super) fn line(
        &self,
        load: &PathLoad,
        closed: &[bool],
        at: [f64; 2],
        start: Option<&ContactSolution>,
        how: &mut OnSet,
    ) -> Result<Option<Line>, FactorError> {
        let loads = at.map(|t| load.at(t));
        how.least = f64::max(self.scale.largest(&loads[0]), self.scale.largest(&loads[1]));
        let from = self.solve_on_set(&loads[0], load.held_value, closed, start, how)?;
        if from.outcome != Outcome::Solved {
            return Ok(None);
        }
        self.line_from(load, from, at, how)
    }

    /// The line on the contact set of a solution, which holds at the first of two t.
    pub(super) fn line_from(
        &self,
        load: &PathLoad,
        from: ContactSolution,
        at: [f64; 2],
        how: &mut OnSet,
    ) -> Result<Option<Line>, FactorError> {
        let loads = at.map(|t| load.at(t));
        how.least = f64::max(self.scale.largest(&loads[0]), self.scale.largest(&loads[1]));
        let to = self.solve_on_set(&loads[1], load.held_value, &from.closed, Some(&from), how)?;
        if to.outcome != Outcome::Solved {
            return Ok(None);
        }
        // A load that hardly presses on the points says nothing of what they do.
        let force = match largest(&from.reaction).max(largest(&to.reaction)) {
            0.0 => self.scale.largest(&loads[1]),
            force => force.max(tolerances::path::UNSEEN * load.size(at[0])),
        };
        let length = f64::max(largest_length(&from), largest_length(&to));
        let rounding = f64::max(self.unbalanced(&from), self.unbalanced(&to));
        let still = tolerances::path::STILL.max(tolerances::path::SHARE * rounding / force);
        Ok(Some(Line { at, ends: [from, to], force, length, still }))
    }

    /// Largest resultant of the plate's own forces, couples over its size: rounding, since it has none.
    fn unbalanced(&self, solution: &ContactSolution) -> f64 {
        let (plate, dofs) = (&self.plate, self.held.len());
        let own = residual(plate, &Springs::default(), &vec![0.0; dofs], &solution.displacement);
        let (middle, size) = (self.scale.centre, self.scale.size);
        let work = |motion: [f64; 3]| {
            let mut rigid = Displacement::zeros(dofs);
            rigid.add_rigid(plate, middle, motion);
            rigid.hi.iter().zip(&own).map(|(u, f)| u * f).sum::<f64>().abs()
        };
        [[1.0, 0.0, 0.0], [0.0, 1.0 / size, 0.0], [0.0, 0.0, 1.0 / size]].map(work).into_iter().fold(0.0, f64::max)
    }

    /// Whether no reaction pulls and no gap is negative between two t.
    pub(super) fn signs_hold_on(&self, line: &Line, from: f64, to: f64) -> bool {
        let parts = [line.part(from), line.part(to)];
        let holds = |i: usize| {
            let (begin, end) = (line.value(0, i), line.value(1, i));
            parts.iter().all(|part| begin + part * (end - begin) > -tolerances::path::SIGN)
        };
        self.one_sided().all(holds)
    }

    /// Contact points that may open, in the caller's order.
    pub(super) fn one_sided(&self) -> impl Iterator<Item = usize> + '_ {
        let condensed = self.order.condensed.iter().zip(&self.constraints.two_sided);
        let of_lcp = condensed.filter(|(_, two_sided)| !**two_sided).map(|(&i, _)| i);
        of_lcp.chain(self.order.active.iter().copied())
    }
}
