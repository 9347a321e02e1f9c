//! A set of many points: their reactions are eliminated into K as springs, which a step of the method of multipliers
//! (Rockafellar 1976) takes the excess of back.

use super::active_factor::ActiveFactor;
use super::floating::Held;
use super::refinement::{Correction, KktSolver};
use super::residual::Residual;
use crate::cholesky::FactorError;
use crate::contact::problem::{ContactProblem, Factored};
use crate::contact::tolerances;

/// The factor with conjugate gradients, and one set of the active points.
pub(super) struct Penalized<'a> {
    pub(super) factor: ActiveFactor<'a>,
    closed: Vec<bool>,
    held: Option<Held>,
}

impl<'a> Penalized<'a> {
    /// `closed` is of all points, in the problem's order; `None` if two-sided points contradict each other.
    pub(super) fn of(
        problem: &'a ContactProblem,
        given: &'a Factored,
        closed: &[bool],
    ) -> Result<Option<Self>, FactorError> {
        let Some(factor) = ActiveFactor::of(problem, given, tolerances::newton::STIFFEST, false)? else {
            return Ok(None);
        };
        let softened = problem.active.compliance.iter().zip(&factor.penalty.series).map(|(c, s)| c + s);
        let compliance: Vec<f64> = problem.constraints.compliance.iter().copied().chain(softened).collect();
        // Beside rigid two-sided points the three equations are not all that holds.
        let alone = problem.constraints.rows.is_empty();
        let held = if alone { Held::by(problem, &compliance, closed) } else { None };
        Ok(Some(Self { factor, closed: closed[problem.constraints.rows.len()..].to_vec(), held }))
    }
}

impl KktSolver for Penalized<'_> {
    fn correction(&mut self, step: &Residual) -> Result<Option<Correction>, FactorError> {
        let Self { factor, closed, .. } = self;
        let (problem, points) = (factor.problem, &factor.problem.active);
        let (two_sided, left) = step.remaining.split_at(problem.constraints.rows.len());
        let pushing: Vec<usize> = (0..closed.len()).filter(|&i| closed[i]).collect();
        let mut imbalance = step.imbalance.clone();
        for &i in &pushing {
            points.scatter(&problem.plate, i, factor.penalty.stiffness[i] * left[i], &mut imbalance);
        }
        problem.release_held(&mut imbalance);
        let mut all = Correction::of(vec![0.0; imbalance.len()], vec![0.0; step.remaining.len()]);
        if !two_sided.is_empty() {
            let first = factor.response(&imbalance, two_sided)?;
            imbalance = factor.difference(&factor.differing(closed), &first.nodal);
            imbalance.iter_mut().for_each(|force| *force = -*force);
            all.nodal = first.nodal;
            all.reaction[..two_sided.len()].copy_from_slice(&first.reaction);
        }
        let mut gradients = factor.gradients(closed, imbalance.clone(), tolerances::newton::TIGHT, 0.0);
        let found = factor.direction(&mut gradients, &imbalance, None)?;
        let direction = found.expect("no one else asks the factor");
        if direction.free {
            return Ok(None);
        }
        all.nodal.iter_mut().zip(&direction.nodal).for_each(|(total, part)| *total += part);
        all.reaction.iter_mut().zip(&direction.reaction).for_each(|(total, part)| *total += part);
        let moved = points.change(&problem.plate, &all.nodal);
        for &i in &pushing {
            all.reaction[two_sided.len() + i] = factor.penalty.stiffness[i] * (moved[i] - left[i]);
        }
        Ok(Some(all))
    }

    fn rigid(&self, step: &Residual) -> Option<Correction> {
        self.held.as_ref().map(|held| held.response(step))
    }

    fn is_settled(&self, step: &Residual, force: f64) -> bool {
        let left = &step.remaining[self.factor.problem.constraints.rows.len()..];
        let penalty = &self.factor.penalty;
        // A support's own law is exact; what was put in series with it is not.
        let softened = (0..left.len()).filter(|&i| self.closed[i] && penalty.series[i] > 0.0);
        softened.map(|i| penalty.stiffness[i] * left[i].abs()).all(|push| push <= tolerances::newton::SETTLED * force)
    }
}
