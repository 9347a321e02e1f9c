//! Elastic one-sided points in any number: a semismooth Newton method on the sparse K (a primal–dual active set).
//!
//! The factor carries every such point closed, K̃ = K + Σ k r rᵀ. Where a set is open, Newton's matrix is K̃ less its
//! springs, and conjugate gradients preconditioned with the one factor solve it in a few steps (Hintermüller, Ito &
//! Kunisch 2002 for the method; Gould, Hribar & Nocedal 2001 for the preconditioner with rigid points held).
//!
//! Among soft points alone it cannot cycle: the energy is convex and continuously differentiable in them, and every
//! Newton direction is followed by an exact line search on it. Rigid points stay with the LCP; the two are solved in
//! turn, which usually settles but need not.

use super::condense::ContactState;
use super::problem::ContactProblem;
use super::solve::{ContactSolution, Step};
use crate::cholesky::FactorError;
use crate::double_double::DoubleDouble;
use crate::element::packed;
use crate::plate::Plate;
use crate::residual::Displacement;
use rayon::prelude::*;

/// Elastic one-sided points that stay out of the LCP: force k⟨w(point) − distance⟩₊ up or, turned round, down.
///
/// A point hangs on the eight deflections of one element, so that its row is eight numbers.
#[derive(Clone, Debug, Default)]
pub struct SoftPoints {
    pub element: Vec<usize>,
    pub value: Vec<[f64; 8]>,
    pub stiffness: Vec<f64>,
    pub distance: Vec<f64>,
}

/// At most this many Newton steps, and conjugate gradient steps in each.
const NEWTON: usize = 100;
const GRADIENTS: usize = 2000;
/// Conjugate gradients end when rᵀz has fallen by the square of this, while the set still changes and when it does not.
const LOOSE: f64 = 1e-2;
const TIGHT: f64 = 1e-9;
/// Imbalance, over the largest nodal force, at which an unchanged set is settled.
const SETTLED: f64 = 1e-13;
/// Steps on one set that hardly shrink the imbalance, one after another, that end it: what is left is rounding.
const STALLS: usize = 3;
/// Curvature along a direction, over that of K̃, below which the plate is taken to be free along it.
const FREE: f64 = 1e-13;

impl SoftPoints {
    pub fn len(&self) -> usize {
        self.element.len()
    }

    pub fn is_empty(&self) -> bool {
        self.element.is_empty()
    }

    /// w(point) − distance (m,), in double-double.
    pub fn stretch(&self, plate: &Plate, displacement: &Displacement) -> Vec<f64> {
        let one = |i: usize| {
            let mut sum = DoubleDouble::from(-self.distance[i]);
            for (&node, &value) in plate.elements()[self.element[i]].iter().zip(&self.value[i]) {
                sum = sum + displacement.at(3 * node).times(value);
            }
            sum.value()
        };
        (0..self.len()).into_par_iter().with_min_len(1024).map(one).collect()
    }

    /// w(point) of a nodal vector (m,).
    fn change(&self, plate: &Plate, vector: &[f64]) -> Vec<f64> {
        (0..self.len()).into_par_iter().with_min_len(4096).map(|i| self.dot(plate, i, vector)).collect()
    }

    fn dot(&self, plate: &Plate, i: usize, vector: &[f64]) -> f64 {
        plate.elements()[self.element[i]].iter().zip(&self.value[i]).map(|(&n, v)| v * vector[3 * n]).sum()
    }

    fn scatter(&self, plate: &Plate, i: usize, factor: f64, vector: &mut [f64]) {
        for (&node, value) in plate.elements()[self.element[i]].iter().zip(&self.value[i]) {
            vector[3 * node] += factor * value;
        }
    }

    /// Σ k v vᵀ of every element's points over its eight deflections, as packed lower triangles; empty without points.
    pub fn stiffness_by_element(&self, plate: &Plate) -> Vec<[f64; 36]> {
        if self.is_empty() {
            return Vec::new();
        }
        let mut out = vec![[0.0; 36]; plate.elements().len()];
        for i in 0..self.len() {
            let (sum, v) = (&mut out[self.element[i]], &self.value[i]);
            for a in 0..8 {
                for b in 0..=a {
                    sum[packed(a, b)] += self.stiffness[i] * v[a] * v[b];
                }
            }
        }
        out
    }
}

/// A direction, and what K̃ makes of it.
struct Direction {
    nodal: Vec<f64>,
    force: Vec<f64>,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl ContactProblem {
    /// Lets the soft points open and close until they agree with the displacements, rigid points staying as they are.
    ///
    /// Returns what is still out of balance.
    pub(super) fn settle_soft(
        &self,
        load: &[f64],
        state: &ContactState,
        mut step: Step,
        solution: &mut ContactSolution,
    ) -> Result<Step, FactorError> {
        let mut last: Option<Vec<bool>> = None;
        let mut stalled = 0;
        for _ in 0..NEWTON {
            let stretch = self.soft.stretch(&self.plate, &solution.displacement);
            let open: Vec<bool> = stretch.iter().map(|&s| s <= 0.0).collect();
            let same = last.as_ref() == Some(&open);
            if same && step.worst <= SETTLED * self.largest_force(load, solution) {
                return Ok(step);
            }
            let tolerance = if same { TIGHT } else { LOOSE };
            let direction = self.newton_direction(state, &step, &open, tolerance, &mut solution.gradients)?;
            let length = self.line_search(&direction, &step, &stretch);
            for (dof, value) in direction.nodal.iter().enumerate() {
                solution.displacement.add(dof, length * value);
            }
            solution.iterations += 1;
            let before = step.worst;
            step = self.step(load, solution);
            if !self.condensed.is_empty() {
                let motion = self.motion(&step, self.condensed.better_form())?;
                self.correct(state, motion, solution)?;
                step = self.step(load, solution);
            }
            stalled = if same && step.worst > 0.5 * before { stalled + 1 } else { 0 };
            if stalled == STALLS {
                return Ok(step);
            }
            last = Some(open);
        }
        Ok(step)
    }

    /// Conjugate gradients on K̃ less the springs of open points, with the constraint preconditioner of the state.
    fn newton_direction(
        &self,
        state: &ContactState,
        step: &Step,
        open: &[bool],
        tolerance: f64,
        steps: &mut usize,
    ) -> Result<Direction, FactorError> {
        let size = step.imbalance.len();
        let mut total = Direction { nodal: vec![0.0; size], force: vec![0.0; size] };
        let mut residual = step.imbalance.clone();
        let mut along = self.precondition(state, &residual)?;
        let mut product = dot(&residual, &along.nodal);
        let enough = tolerance * tolerance * product;
        let mut ahead = Direction { nodal: along.nodal.clone(), force: along.force.clone() };
        for _ in 0..GRADIENTS {
            *steps += 1;
            let released = self.released(open, &ahead.nodal);
            let stiff = dot(&ahead.nodal, &ahead.force);
            let curvature = stiff - dot(&ahead.nodal, &released);
            if !(curvature > FREE * stiff) {
                // Free along this direction: the line search goes as far as the next points.
                if dot(&total.nodal, &step.imbalance) <= 0.0 {
                    total = ahead;
                }
                break;
            }
            let alpha = product / curvature;
            for i in 0..size {
                total.nodal[i] += alpha * ahead.nodal[i];
                total.force[i] += alpha * ahead.force[i];
                residual[i] -= alpha * (ahead.force[i] - released[i]);
            }
            along = self.precondition(state, &residual)?;
            let next = dot(&residual, &along.nodal);
            if !(next > enough) {
                break;
            }
            let beta = next / product;
            product = next;
            for i in 0..size {
                ahead.nodal[i] = along.nodal[i] + beta * ahead.nodal[i];
                ahead.force[i] = along.force[i] + beta * ahead.force[i];
            }
        }
        Ok(total)
    }

    /// The motion under a residual with K̃ and the closed points of the state held, and the force K̃ has for it.
    fn precondition(&self, state: &ContactState, residual: &[f64]) -> Result<Direction, FactorError> {
        let still = Step {
            imbalance: residual.to_vec(),
            remaining: vec![0.0; self.constraints.rows.len()],
            worst: 0.0,
            work_size: vec![0.0; self.constraints.free_motions.len()],
        };
        let motion = self.motion(&still, self.condensed.better_form())?;
        let (nodal, reaction) = self.respond(state, motion)?;
        let mut force: Vec<f64> =
            residual.iter().zip(&self.held).map(|(&r, &held)| if held { 0.0 } else { r }).collect();
        let back: Vec<f64> = reaction.iter().map(|r| -r).collect();
        self.spread(&back, &mut force);
        for (f, &held) in force.iter_mut().zip(&self.held) {
            if held {
                *f = 0.0;
            }
        }
        Ok(Direction { nodal, force })
    }

    /// Σ k r (r·v) over the open points.
    fn released(&self, open: &[bool], vector: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; vector.len()];
        for (i, &open) in open.iter().enumerate() {
            if open {
                let pull = self.soft.stiffness[i] * self.soft.dot(&self.plate, i, vector);
                self.soft.scatter(&self.plate, i, pull, &mut out);
            }
        }
        for (value, &held) in out.iter_mut().zip(&self.held) {
            if held {
                *value = 0.0;
            }
        }
        out
    }

    /// Where the energy along a direction is least: its slope is piecewise linear and grows.
    fn line_search(&self, direction: &Direction, step: &Step, stretch: &[f64]) -> f64 {
        let change = self.soft.change(&self.plate, &direction.nodal);
        let k = &self.soft.stiffness;
        let all_springs: f64 = k.iter().zip(&change).map(|(k, c)| k * c * c).sum();
        let elastic = f64::max(dot(&direction.nodal, &direction.force) - all_springs, 0.0);
        let start = -dot(&direction.nodal, &step.imbalance);
        let slope = |t: f64| -> f64 {
            let springs: f64 = (0..change.len())
                .into_par_iter()
                .with_min_len(4096)
                .map(|i| k[i] * ((stretch[i] + t * change[i]).max(0.0) - stretch[i].max(0.0)) * change[i])
                .sum();
            start + t * elastic + springs
        };
        let (mut low, mut high) = (0.0, 1.0);
        if !(start < 0.0) {
            return 0.0;
        }
        let mut at_high = slope(high);
        if at_high.abs() <= 1e-3 * start.abs() {
            return 1.0;
        }
        let mut doublings = 0;
        while at_high < 0.0 && doublings < 200 {
            (low, high) = (high, 2.0 * high);
            at_high = slope(high);
            doublings += 1;
        }
        let mut at_low = slope(low);
        for _ in 0..60 {
            // Regula falsi, kept off the ends.
            let part = (at_low / (at_low - at_high)).clamp(0.05, 0.95);
            let middle = low + part * (high - low);
            let value = slope(middle);
            if value.abs() <= 1e-3 * start.abs() {
                return middle;
            }
            if value < 0.0 {
                (low, at_low) = (middle, value);
            } else {
                (high, at_high) = (middle, value);
            }
        }
        low
    }

    /// Forces of the soft points on the plate, taken off a nodal vector.
    pub(super) fn take_soft_forces(&self, displacement: &Displacement, nodal: &mut [f64]) {
        for (i, stretch) in self.soft.stretch(&self.plate, displacement).into_iter().enumerate() {
            if stretch > 0.0 {
                self.soft.scatter(&self.plate, i, -self.soft.stiffness[i] * stretch, nodal);
            }
        }
    }
}
