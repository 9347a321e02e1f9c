//! Many points: a factor of K with the springs of some pieces, by which the equations of others are solved.

use super::floating::Held;
use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::system::System;
use crate::residual::twice_the_energy;
use std::sync::Arc;

/// A motion of the nodes and the forces that the factored matrix has for it.
#[derive(Clone, Default)]
pub(in crate::contact) struct Direction {
    pub(in crate::contact) nodal: Vec<f64>,
    pub(in crate::contact) force: Vec<f64>,
    /// Whether nothing resists it on the present pieces: then it has no length of its own.
    pub(in crate::contact) is_free: bool,
}

impl Direction {
    pub(in crate::contact) fn zeros(size: usize) -> Self {
        Self { nodal: vec![0.0; size], force: vec![0.0; size], is_free: false }
    }

    /// self ← beta·self + alpha·other
    pub(super) fn combine(&mut self, beta: f64, alpha: f64, other: &Self) {
        for (mine, others) in [(&mut self.nodal, &other.nodal), (&mut self.force, &other.force)] {
            mine.iter_mut().zip(others).for_each(|(a, b)| *a = beta * *a + alpha * b);
        }
    }
}

/// A factor, and the compliances in series with points that are stiffer than a limit.
pub(in crate::contact) struct Factored<'a> {
    pub(in crate::contact) problem: &'a ContactProblem,
    /// Stiffest springs, over the plate's stiffness in shear.
    pub(in crate::contact) limit: f64,
    /// σ of every point.
    pub(in crate::contact) series: Vec<f64>,
    /// The one that it was given, if not the problem's own.
    given: Option<&'a Arc<System>>,
    /// That of other pieces than the given one's, if it has come to some.
    own: Option<Arc<System>>,
    /// Whether others ask the factor that it was given too.
    shares: bool,
    /// The last direction that this factor has given, unless it shares.
    pub(super) last: Option<Direction>,
    /// What it has been prepared for.
    pub(super) pieces: Vec<u8>,
    pub(super) held: Option<Held<'a>>,
    /// Conjugate gradient steps, and matrices factored.
    pub(in crate::contact) gradients: usize,
    pub(in crate::contact) factorizations: usize,
}

impl<'a> Factored<'a> {
    pub(in crate::contact) fn new(
        problem: &'a ContactProblem,
        given: Option<&'a Arc<System>>,
        limit: f64,
        shares: bool,
    ) -> Self {
        let mut new = Self {
            problem,
            limit,
            series: Vec::new(),
            given,
            own: None,
            shares,
            last: None,
            pieces: Vec::new(),
            held: None,
            gradients: 0,
            factorizations: 0,
        };
        new.limit_to(limit);
        new
    }

    /// No spring stiffer than a limit, over the plate's stiffness in shear.
    pub(in crate::contact) fn limit_to(&mut self, limit: f64) {
        self.limit = limit;
        self.series = self.problem.series(limit);
    }

    pub(in crate::contact) fn system(&self) -> &System {
        self.kept().map_or(&self.problem.base, |system| system)
    }

    /// The factor at hand, if it is not the problem's own.
    pub(in crate::contact) fn kept(&self) -> Option<&Arc<System>> {
        self.own.as_ref().or(self.given)
    }

    /// Whether the next residual goes to a factor that others ask too.
    pub(super) fn shares(&self) -> bool {
        self.shares && self.own.is_none()
    }

    /// The springs that points have on pieces.
    pub(in crate::contact) fn slope(&self, i: usize, piece: u8) -> f64 {
        self.problem.points.piece(i, piece).in_series(self.series[i])
    }

    /// Factors the matrix of some pieces, with a little of the other points' springs where they do not hold the plate; as
    /// far as that succeeds.
    pub(in crate::contact) fn refactor(&mut self, pieces: &[u8]) -> Result<(), FactorError> {
        let problem = self.problem;
        let slenderness = problem.plate.slenderness();
        let least = problem.series(slenderness * slenderness / pieces.len() as f64);
        let a_little = |i: usize| problem.steepest(i).in_series(least[i]);
        for retains in [false, true] {
            let slope = |i: usize| match self.slope(i, pieces[i]) {
                0.0 if retains => a_little(i),
                slope => slope,
            };
            match problem.factored((0..pieces.len()).map(slope).collect()) {
                Ok(system) => {
                    self.own = Some(Arc::new(system));
                    self.last = None;
                    self.factorizations += 1;
                    return Ok(());
                }
                Err(FactorError::NotPositiveDefinite { .. }) => {}
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// vᵀKv with the springs of pieces, summed from squares: along a free motion a difference would be rounding.
    pub(super) fn curvature(&self, pieces: &[u8], vector: &[f64]) -> f64 {
        let spring = |i: usize| match self.slope(i, pieces[i]) {
            0.0 => 0.0,
            slope => slope * self.problem.points.dot(i, vector).powi(2),
        };
        twice_the_energy(&self.problem.plate, &self.problem.springs, vector)
            + (0..pieces.len()).map(spring).sum::<f64>()
    }

    /// Points whose springs the factor carries otherwise than pieces have them, and by how much.
    pub(in crate::contact) fn differing(&self, pieces: &[u8]) -> Vec<(usize, f64)> {
        let carried = &self.system().carried;
        let difference = |i: usize| self.slope(i, pieces[i]) - carried[i];
        (0..pieces.len()).map(|i| (i, difference(i))).filter(|&(_, d)| d != 0.0).collect()
    }

    /// Σ Δk r (r·v) over the points that differ.
    pub(super) fn difference(&self, differing: &[(usize, f64)], vector: &[f64]) -> Vec<f64> {
        let points = &self.problem.points;
        let mut out = vec![0.0; vector.len()];
        for &(i, stiffness) in differing {
            points.scatter(i, stiffness * points.dot(i, vector), &mut out);
        }
        self.problem.release_held(&mut out);
        out
    }

    /// The motion under an imbalance by the factor.
    pub(super) fn response(&self, imbalance: &[f64]) -> Result<Direction, FactorError> {
        let nodal = self.system().solve(imbalance)?;
        Ok(Direction { nodal, force: imbalance.to_vec(), is_free: false })
    }
}
