//! Newton's direction for one set of closed points, by conjugate gradients on K with their springs, preconditioned with
//! a factor that carries the springs of another set.
//!
//! Gould, Hribar & Nocedal (2001) for the preconditioner with two-sided points held.

use super::Descent;
use crate::cholesky::FactorError;
use crate::contact::refinement::Step;
use crate::residual::twice_the_energy;

/// A displacement, the force that the factored matrix has for it, and what it adds to two-sided points' reactions.
pub(super) struct Direction {
    pub nodal: Vec<f64>,
    pub force: Vec<f64>,
    pub reaction: Vec<f64>,
    /// Whether the closed points let the plate move along it freely: then it has no length of its own.
    pub free: bool,
}

/// Curvature along a direction, over that of the factored matrix, below which the plate is taken to be free along it.
const FREE: f64 = 1e-13;
/// Curvature, over that of the factored matrix, from which on what cancels in its sum does not matter.
pub(super) const PLAIN: f64 = 1e-6;
/// Conjugate gradients take this many steps before a factor of the present set, which costs about as much, replaces them;
/// where a factor is asked together with others, so that a step costs a part of that, so many times as many.
const PATIENCE: usize = 10;
const SHARED: usize = 3;
/// At most this many where it cannot be factored.
const GRADIENTS: usize = 500;

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

impl Direction {
    pub(super) fn zeros(size: usize, reactions: usize) -> Self {
        Self { nodal: vec![0.0; size], force: vec![0.0; size], reaction: vec![0.0; reactions], free: false }
    }

    /// self·beta + other
    fn renew(&mut self, beta: f64, other: &Self) {
        for (mine, new) in
            [(&mut self.nodal, &other.nodal), (&mut self.force, &other.force), (&mut self.reaction, &other.reaction)]
        {
            for (a, b) in mine.iter_mut().zip(new) {
                *a = beta * *a + b;
            }
        }
    }

    fn add(&mut self, alpha: f64, other: &Self) {
        for (mine, new) in
            [(&mut self.nodal, &other.nodal), (&mut self.force, &other.force), (&mut self.reaction, &other.reaction)]
        {
            for (a, b) in mine.iter_mut().zip(new) {
                *a += alpha * b;
            }
        }
    }
}

impl Descent<'_> {
    /// The direction whose residual is `tolerance` of the imbalance, or rounding; the present set is factored if that takes long.
    pub(super) async fn direction(&mut self, closed: &[bool], tolerance: f64) -> Result<Direction, FactorError> {
        let patience = if self.desk.is_some() && self.own.is_none() { SHARED * PATIENCE } else { PATIENCE };
        if let Some(found) = self.conjugate_gradients(closed, tolerance, Some(patience)).await? {
            return Ok(found);
        }
        if self.refactor(closed)? {
            self.solution.factorizations += 1;
        }
        let found = self.conjugate_gradients(closed, tolerance, None).await?;
        Ok(found.unwrap_or_else(|| unreachable!("without patience there is an answer")))
    }

    /// Factors the present set, with a little of the open points if it does not hold the plate; whether that succeeded.
    fn refactor(&mut self, closed: &[bool]) -> Result<bool, FactorError> {
        let points = &self.problem.active;
        let nothing = vec![0.0; closed.len()];
        let slenderness = self.problem.plate.slenderness();
        let retained = points.softened(slenderness * slenderness / closed.len() as f64).stiffness;
        for of_open in [nothing, retained] {
            let full = closed.iter().zip(&self.springs.stiffness).zip(&of_open);
            let carried = full.map(|((&c, &k), &open)| if c { k } else { open }).collect();
            match self.problem.refactored(carried) {
                Ok(found) => {
                    let Some(state) = found.condensed.state(self.problem.constraints.two_sided.clone()) else {
                        continue;
                    };
                    self.state = state;
                    self.own = Some(found);
                    return Ok(true);
                }
                Err(FactorError::NotPositiveDefinite { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(false)
    }

    /// `None` if patience, where there is a way out, ends first.
    async fn conjugate_gradients(
        &mut self,
        closed: &[bool],
        tolerance: f64,
        patience: Option<usize>,
    ) -> Result<Option<Direction>, FactorError> {
        let differing = self.differing(closed);
        let mut steps = 1;
        let mut along = self.precondition(&self.step.imbalance).await?;
        if differing.is_empty() {
            self.solution.gradients += 1;
            return Ok(Some(along));
        }
        let size = along.nodal.len();
        let mut residual = self.step.imbalance.clone();
        let enough = f64::max(tolerance * dot(&residual, &residual).sqrt(), self.rounding);
        let mut total = Direction::zeros(size, along.reaction.len());
        let mut ahead = Direction::zeros(size, along.reaction.len());
        let mut product = f64::INFINITY;
        loop {
            let next = dot(&residual, &along.nodal);
            if !(next > 0.0) {
                break;
            }
            ahead.renew(next / product, &along);
            product = next;
            let difference = self.difference(&differing, &ahead.nodal);
            let stiff = dot(&ahead.nodal, &ahead.force);
            let mut curvature = stiff + dot(&ahead.nodal, &difference);
            if !(curvature > PLAIN * stiff) {
                curvature = self.curvature(closed, &ahead.nodal);
            }
            if !(curvature > FREE * stiff) {
                // The line search goes as far as the next points, before which no other direction balances the load.
                total = ahead;
                total.free = true;
                break;
            }
            let alpha = product / curvature;
            total.add(alpha, &ahead);
            for i in 0..size {
                residual[i] -= alpha * (ahead.force[i] + difference[i]);
            }
            if dot(&residual, &residual).sqrt() <= enough {
                break;
            }
            if steps == patience.unwrap_or(GRADIENTS) {
                self.solution.gradients += steps;
                return Ok(if patience.is_some() { None } else { Some(total) });
            }
            along = self.precondition(&residual).await?;
            steps += 1;
        }
        self.solution.gradients += steps;
        Ok(Some(total))
    }

    /// vᵀKv with the springs of closed points, summed from squares: along a free motion a difference would be rounding.
    fn curvature(&self, closed: &[bool], vector: &[f64]) -> f64 {
        let (points, plate) = (&self.problem.active, &self.problem.plate);
        let spring = |i: usize| self.springs.stiffness[i] * points.dot(plate, i, vector).powi(2);
        twice_the_energy(plate, &self.problem.springs, vector)
            + (0..closed.len()).filter(|&i| closed[i]).map(spring).sum::<f64>()
    }

    /// Points whose springs the factor carries otherwise than the set has them, and by how much.
    fn differing(&self, closed: &[bool]) -> Vec<(usize, f64)> {
        let carried = &self.factored().carried;
        let full = &self.springs.stiffness;
        let difference = |i: usize| if closed[i] { full[i] } else { 0.0 } - carried[i];
        (0..closed.len()).map(|i| (i, difference(i))).filter(|&(_, d)| d != 0.0).collect()
    }

    /// Σ Δk r (r·v) over the points that differ.
    fn difference(&self, differing: &[(usize, f64)], vector: &[f64]) -> Vec<f64> {
        let (points, plate) = (&self.problem.active, &self.problem.plate);
        let mut out = vec![0.0; vector.len()];
        for &(i, stiffness) in differing {
            let pull = stiffness * points.dot(plate, i, vector);
            points.scatter(plate, i, pull, &mut out);
        }
        self.problem.release_held(&mut out);
        out
    }

    /// The motion under a residual by the factor, two-sided points held, and the force it has for that.
    async fn precondition(&self, residual: &[f64]) -> Result<Direction, FactorError> {
        let problem = self.problem;
        if let (Some(desk), None) = (self.desk, &self.own) {
            let solved = desk.solve(problem.gather(residual)).await;
            return Ok(Direction {
                nodal: problem.scatter(&solved),
                force: residual.to_vec(),
                reaction: Vec::new(),
                free: false,
            });
        }
        let still = Step {
            imbalance: residual.to_vec(),
            remaining: vec![0.0; problem.constraints.rows.len()],
            worst: 0.0,
            work: vec![0.0; problem.constraints.free_motions.len()],
            work_size: vec![0.0; problem.constraints.free_motions.len()],
        };
        let with = self.factored();
        let motion = problem.motion(with, &still, with.condensed.better_form())?;
        let (nodal, reaction) = problem.respond(with, &self.state, motion)?;
        let mut force = still.imbalance;
        let back: Vec<f64> = reaction.iter().map(|r| -r).collect();
        problem.spread(&back, &mut force);
        problem.release_held(&mut force);
        Ok(Direction { nodal, force, reaction, free: false })
    }
}
