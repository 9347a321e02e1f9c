//! What a contact problem is answered with, and answers to begin with.

use super::problem::{ContactProblem, Factored};
use crate::displacement::Displacement;

/// One step of a solve, to whoever watches.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    pub step: usize,
    /// Points that have opened or closed since the step before.
    pub changing: usize,
    /// Largest imbalance over the largest nodal force.
    pub residual: f64,
}

/// How a contact problem ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Outcome {
    Solved,
    /// Lemke's ray: no reactions balance the load.
    NoEquilibrium,
    /// The pivot limit was reached, or the contact state is beyond the arithmetic.
    #[default]
    Unsolved,
    /// Whoever watched wanted no more.
    Interrupted,
}

/// Displacements, reactions and gaps; NaN unless solved.
#[derive(Clone, Debug, Default)]
pub struct ContactSolution {
    pub outcome: Outcome,
    pub displacement: Displacement,
    /// Force of every contact point, against its row.
    pub reaction: Vec<f64>,
    /// What is left of every gap; 0 where closed.
    pub gap: Vec<f64>,
    pub closed: Vec<bool>,
    pub pivots: usize,
    /// Newton steps of the active set, and steps of the interior point method.
    pub iterations: usize,
    /// Conjugate gradient steps in them.
    pub gradients: usize,
    /// Contact sets factored anew.
    pub factorizations: usize,
    /// Corrections made with the refined residual.
    pub corrections: usize,
}

impl ContactSolution {
    /// Solved, unless numbers beyond the arithmetic have made some of it NaN or infinite.
    pub(super) fn solved(self) -> Self {
        let d = &self.displacement;
        let finite = d.hi.iter().chain(&self.reaction).chain(&self.gap).all(|value| value.is_finite());
        if finite { Self { outcome: Outcome::Solved, ..self } } else { self.failed(Outcome::Unsolved) }
    }

    /// Goes a part of the way to another solution.
    pub(super) fn towards(&mut self, other: &Self, part: f64) {
        for i in 0..self.displacement.hi.len() {
            let (from, to) = (self.displacement.at(i), other.displacement.at(i));
            let sum = from + (to - from).times(part);
            (self.displacement.hi[i], self.displacement.lo[i]) = (sum.hi, sum.lo);
        }
        for (from, to) in self.reaction.iter_mut().zip(&other.reaction).chain(self.gap.iter_mut().zip(&other.gap)) {
            *from += part * (to - *from);
        }
    }

    /// Takes what is left of the gaps for those of open points.
    pub(super) fn leave_open(&mut self, remaining: &[f64]) {
        for (i, gap) in self.gap.iter_mut().enumerate() {
            *gap = if self.closed[i] { 0.0 } else { remaining[i] };
        }
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

/// Where to begin: at an answer in the caller's order, with a factor, if not the problem's own.
pub(super) struct Start<'a> {
    pub solution: &'a ContactSolution,
    pub factored: Option<&'a Factored>,
    /// Where the answer is known to balance a load.
    pub reference: Option<&'a Reference>,
}

/// One load's solution and the factor of its contact set, for loads not unlike it to begin with.
pub struct Reference {
    pub solution: ContactSolution,
    pub(super) factored: Factored,
    pub(super) load: Vec<f64>,
    /// How far the points of the active set overlap in it.
    pub(super) overlap: Vec<f64>,
}

impl Reference {
    pub(super) fn start(&self) -> Start<'_> {
        Start { solution: &self.solution, factored: Some(&self.factored), reference: Some(self) }
    }
}

impl ContactProblem {
    /// Without a load or a reaction, and with the condensed points alone.
    pub(super) fn at_rest(&self, held_value: &[f64]) -> ContactSolution {
        let m = self.constraints.rows.len();
        let displacement = held_at(&self.held, held_value);
        let closed = self.constraints.two_sided.clone();
        ContactSolution { displacement, reaction: vec![0.0; m], gap: vec![0.0; m], closed, ..Default::default() }
    }

    /// Why there is no answer, with numbers that are none for every point.
    pub(super) fn unanswered(&self, held_value: &[f64], outcome: Outcome) -> ContactSolution {
        let count = self.constraints.rows.len() + self.active.len();
        let (reaction, gap, closed) = (vec![0.0; count], vec![0.0; count], vec![false; count]);
        ContactSolution { reaction, gap, closed, ..self.at_rest(held_value) }.failed(outcome)
    }

    /// Values of every point in the problem's order, the condensed points before those of the active set.
    pub(super) fn in_place<T: Copy>(&self, values: &[T]) -> Vec<T> {
        self.order.condensed.iter().chain(&self.order.active).map(|&i| values[i]).collect()
    }

    /// Values of every point, given in the problem's order, in the caller's.
    pub(super) fn in_order<T: Copy>(&self, values: &[T]) -> Vec<T> {
        let mut ordered = values.to_vec();
        self.order.condensed.iter().chain(&self.order.active).zip(values).for_each(|(&i, &value)| ordered[i] = value);
        ordered
    }

    /// A solution of every point in the caller's order.
    pub(super) fn solution_in_order(&self, found: ContactSolution) -> ContactSolution {
        let (reaction, gap) = (self.in_order(&found.reaction), self.in_order(&found.gap));
        ContactSolution { reaction, gap, closed: self.in_order(&found.closed), ..found }
    }

    /// Takes back the reactions of points that are open now.
    pub(super) fn release_open(&self, solution: &mut ContactSolution) -> bool {
        let mut any = false;
        for (reaction, &closed) in solution.reaction.iter_mut().zip(&solution.closed) {
            if !closed && *reaction != 0.0 {
                *reaction = 0.0;
                any = true;
            }
        }
        any
    }
}

/// The held dofs at their values, the others at zero.
pub(super) fn held_at(held: &[bool], held_value: &[f64]) -> Displacement {
    let hi: Vec<f64> = held.iter().zip(held_value).map(|(&held, &value)| if held { value } else { 0.0 }).collect();
    Displacement { lo: vec![0.0; hi.len()], hi }
}

/// Points whose states differ.
pub(super) fn differing(one: &[bool], other: &[bool]) -> Vec<usize> {
    (0..one.len()).filter(|&i| one[i] != other[i]).collect()
}
