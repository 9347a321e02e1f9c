//! The backend for many points: a factor of K with the springs of one contact state preconditions the equations of
//! others.

use super::batched_factor::SharedFactor;
use super::coarse::CoarseSolver;
use crate::cholesky::FactorError;
use crate::contact::backend::Augmentation;
use crate::contact::problem::ContactProblem;
use crate::contact::system::System;
use crate::residual::twice_the_energy;
use std::sync::Arc;

/// A displacement `nodal` (3n,), and the product `force` of the factored matrix with it.
#[derive(Clone, Default)]
pub(in crate::contact) struct Direction {
    pub(in crate::contact) nodal: Vec<f64>,
    pub(in crate::contact) force: Vec<f64>,
    /// Whether no support resists the displacement in the present contact state; the equations then do not determine
    /// its length.
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

/// A factor of K with springs at the contact points, and the augmentation compliances for a penalty.
pub(in crate::contact) struct Factored<'a> {
    pub(in crate::contact) problem: &'a ContactProblem,
    pub(in crate::contact) augmentation: &'a Augmentation,
    /// Penalty: largest spring stiffness divided by the reference stiffness of the plate.
    pub(in crate::contact) limit: f64,
    /// Compliance σ (m,) in series with each point, 1/(penalty · reference stiffness) in the method of multipliers.
    pub(in crate::contact) series: Vec<f64>,
    /// The factor given at the start; `None` for the factor of the problem.
    given: Option<&'a Arc<System>>,
    /// A factor made later, for another contact state.
    own: Option<Arc<System>>,
    /// The given factor, if several loads share it.
    shared: Option<SharedFactor>,
    /// Last conjugate gradient direction with the present factor; `None` if the factor is shared.
    pub(super) last: Option<Direction>,
    /// The contact state for which the solver is prepared.
    pub(super) pieces: Vec<u8>,
    pub(super) coarse: Option<CoarseSolver<'a>>,
    /// Number of conjugate gradient steps and number of factorizations since the start.
    pub(in crate::contact) gradients: usize,
    pub(in crate::contact) factorizations: usize,
}

impl<'a> Factored<'a> {
    pub(in crate::contact) fn new(
        problem: &'a ContactProblem,
        augmentation: &'a Augmentation,
        given: Option<&'a Arc<System>>,
        limit: f64,
        shared: Option<SharedFactor>,
    ) -> Self {
        let mut new = Self {
            problem,
            augmentation,
            limit,
            series: Vec::new(),
            given,
            own: None,
            shared,
            last: None,
            pieces: Vec::new(),
            coarse: None,
            gradients: 0,
            factorizations: 0,
        };
        new.set_penalty(limit);
        new
    }

    /// Sets the penalty, and σ of each point.
    pub(in crate::contact) fn set_penalty(&mut self, limit: f64) {
        self.limit = limit;
        self.series = self.augmentation.series(&self.problem.points, limit);
    }

    /// Whether some point has an augmentation compliance.
    pub(in crate::contact) fn is_augmented(&self) -> bool {
        self.series.iter().any(|&series| series > 0.0)
    }

    pub(in crate::contact) fn system(&self) -> &System {
        self.kept().map_or(&self.problem.base, |system| system)
    }

    /// The present factor; `None` if it is the factor of the problem.
    pub(in crate::contact) fn kept(&self) -> Option<&Arc<System>> {
        self.own.as_ref().or(self.given)
    }

    /// Whether the next solve uses a shared factor.
    pub(super) fn shares(&self) -> bool {
        self.shared.is_some() && self.own.is_none()
    }

    /// Stiffness of a point on a piece of its law, in series with the point's augmentation compliance σ.
    pub(in crate::contact) fn slope(&self, i: usize, piece: u8) -> f64 {
        self.problem.points.piece(i, piece).in_series(self.series[i])
    }

    /// Factors K with the springs of a contact state. If this matrix is singular, soft springs are added at points
    /// whose force does not depend on the travel. If that matrix is singular too, the old factor stays.
    pub(in crate::contact) fn refactor(&mut self, pieces: &[u8]) -> Result<(), FactorError> {
        let problem = self.problem;
        let slenderness = problem.plate.slenderness();
        let least = slenderness * slenderness / pieces.len() as f64;
        let a_little = self.augmentation.slopes(&problem.points, |i| problem.points.steepest(i), least);
        for retains in [false, true] {
            let slope = |i: usize| match self.slope(i, pieces[i]) {
                0.0 if retains => a_little[i],
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

    /// vᵀKv with the springs of a contact state, computed as a sum of squares: along a free rigid motion a difference
    /// would be rounding.
    pub(super) fn curvature(&self, pieces: &[u8], vector: &[f64]) -> f64 {
        let spring = |i: usize| match self.slope(i, pieces[i]) {
            0.0 => 0.0,
            slope => slope * self.problem.points.dot(i, vector).powi(2),
        };
        twice_the_energy(&self.problem.plate, &self.problem.springs, vector)
            + (0..pieces.len()).map(spring).sum::<f64>()
    }

    /// The contact points whose spring in the factor differs from that of the contact state, each with the difference
    /// of stiffness.
    pub(in crate::contact) fn differing(&self, pieces: &[u8]) -> Vec<(usize, f64)> {
        let carried = &self.system().carried;
        let difference = |i: usize| self.slope(i, pieces[i]) - carried[i];
        (0..pieces.len()).map(|i| (i, difference(i))).filter(|&(_, d)| d != 0.0).collect()
    }

    /// Nodal forces Σ Δk g (g·v) (3n,) under the displacements v = `vector`: sum over the points `differing`, with row
    /// g of G and difference Δk of stiffness.
    pub(super) fn difference(&self, differing: &[(usize, f64)], vector: &[f64]) -> Vec<f64> {
        let points = &self.problem.points;
        let mut out = vec![0.0; vector.len()];
        for &(i, stiffness) in differing {
            points.scatter(i, stiffness * points.dot(i, vector), &mut out);
        }
        self.problem.release_held(&mut out);
        out
    }

    /// The displacements under the nodal forces `imbalance` (3n,), by the present factor.
    pub(super) async fn response(&self, imbalance: &[f64]) -> Result<Direction, FactorError> {
        let nodal = match &self.shared {
            Some(factor) if self.shares() => factor.solve(imbalance).await,
            _ => self.system().solve(imbalance)?,
        };
        Ok(Direction { nodal, force: imbalance.to_vec(), is_free: false })
    }
}
